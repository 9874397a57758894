"""Look of all pictures: sizes, fonts, colours, lines, legends."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from typing import Any

import matplotlib
import matplotlib.style
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.font_manager import FontProperties, fontManager
from matplotlib.patheffects import withStroke
from matplotlib.transforms import ScaledTranslation

MM = 1 / 25.4
COLUMN = 85 * MM  #: width of a journal's column, inches
PAGE = 175 * MM  #: width of its page

INK = '#222222'
GREY = '#767676'
FAINT = '#c8c8c8'
ACCENT = '#1f5f8b'

# Colours of kinds, distinguishable with any kind of colour vision (Okabe and Ito 2008, Color universal design; wine and pale grey
# for the least frequent kinds, which differ most from each other).
BLUE, ORANGE, SKY, WINE, PALE = '#0072B2', '#E69F00', '#56B4E9', '#882255', '#999999'
YELLOW, GREEN, VERMILION, PURPLE = '#F0E442', '#009E73', '#D55E00', '#CC79A7'

# The first four fonts have equal metrics, so that pictures have the same layout; the last is part of matplotlib.
FONTS = ('Arial', 'Helvetica', 'Liberation Sans', 'Nimbus Sans', 'DejaVu Sans')

STYLE = {
    'axes.edgecolor': INK,
    'axes.labelcolor': INK,
    'axes.labelpad': 3,
    'axes.labelsize': 8,
    'axes.linewidth': 0.6,
    'axes.spines.right': False,
    'axes.spines.top': False,
    'axes.titlepad': 4,
    'axes.titlesize': 8,
    'figure.dpi': 150,
    'font.size': 7.5,
    'legend.fontsize': 7.5,
    'legend.frameon': False,
    'legend.title_fontsize': 7.5,
    'lines.linewidth': 1.1,
    'lines.markersize': 4,
    'pdf.fonttype': 42,
    'savefig.dpi': 300,
    'svg.hashsalt': 'gearsweep',
    'text.color': INK,
    'xtick.color': INK,
    'xtick.labelsize': 7.5,
    'xtick.major.size': 2.5,
    'xtick.major.width': 0.6,
    'ytick.color': INK,
    'ytick.labelsize': 7.5,
    'ytick.major.size': 2.5,
    'ytick.major.width': 0.6,
}

#: Curves of a family range from dark to light, so that they differ in grey print too.
DASHES = ('-', (0, (6, 2)), (0, (6, 1.5, 1, 1.5)), (0, (1, 1.2)), (0, (6, 1.5, 1, 1.5, 1, 1.5)), (0, (2.5, 1.5)))

#: Style of a line that does not belong to the family of curves, and of marks.
ASIDE: dict[str, Any] = {'color': INK, 'linewidth': 0.7, 'linestyle': (0, (2, 2))}
FINE: dict[str, Any] = {'linewidth': 0.6, 'alpha': 0.6}  #: style of static values, and of rules of thumb
HOLLOW: dict[str, Any] = {'linestyle': '', 'markersize': 3, 'markerfacecolor': 'white', 'markeredgewidth': 0.7}
CROSS: dict[str, Any] = {'linestyle': '', 'marker': 'x', 'markersize': 3, 'markeredgewidth': 0.8}
PUBLISHED: dict[str, Any] = {**HOLLOW, 'marker': 'o', 'markersize': 5, 'markeredgewidth': 1.1, 'markerfacecolor': 'none'}

#: Outline of letters over lines.
HALO = [withStroke(linewidth=1.8, foreground='white')]

#: Part of the axes above which an estimated error is drawn.
VISIBLE = 0.005


def style() -> AbstractContextManager:
    """Applies the look of the pictures: `with gearsweep.plots.style():` around figures of one's own."""
    installed = {font.name for font in fontManager.ttflist}
    fonts = {'font.family': [name for name in FONTS if name in installed]}
    return matplotlib.style.context([STYLE, fonts], after_reset=True)


@contextmanager
def canvas(ax: Axes | None, height: float = 60 * MM, width: float = COLUMN) -> Iterator[Axes]:
    """Returns the axes passed, or those of a new figure with this look."""
    if ax is not None:
        yield ax
        return
    from matplotlib import pyplot

    with style():
        yield pyplot.subplots(figsize=(width, height), layout='constrained')[1]


def line_styles(n: int) -> list[dict[str, Any]]:
    """Returns colour and dashes of each of n curves."""
    shades = matplotlib.colormaps['viridis'](np.linspace(0, 0.78, n)) if n > 1 else [ACCENT]
    return [{'color': shade, 'linestyle': DASHES[i % len(DASHES)]} for i, shade in enumerate(shades)]


def legends_above(ax: Axes, *parts: tuple[str, Sequence[Artist]], gap: float = 0) -> None:
    """Places legends without frames on top of each other, each (title, entries), the last `gap` lines above the axes."""
    letter = FontProperties(size=matplotlib.rcParams['legend.fontsize']).get_size_in_points() / 72  # inches
    width = ax.bbox.width / ax.figure.dpi / letter
    for title, handles in reversed(parts):
        if not handles:
            continue
        if before := ax.get_legend():
            ax.add_artist(before).set_clip_on(False)  # kept, and included in the layout
        widest = max(len(str(handle.get_label())) for handle in handles)
        columns = min(len(handles), max(1, int(width / (3.6 + 0.6 * widest))))
        ax.legend(
            handles=[handle for column in range(columns) for handle in handles[column::columns]],
            title=title,
            loc='lower left',
            bbox_to_anchor=(0, 1),
            bbox_transform=ax.transAxes + ScaledTranslation(0, gap * letter, ax.figure.dpi_scale_trans),
            ncols=columns,
            alignment='left',
            borderaxespad=0.2,
            borderpad=0,
            columnspacing=1.2,
            handlelength=2.0,
            handletextpad=0.4,
            labelspacing=0.3,
        )
        gap += 0.3 + 1.3 * (-(-len(handles) // columns) + bool(title))


def names_above(ax: Axes, names: list[tuple[float, float, str, str]]) -> float:
    """Writes vertical names (x, y, words, colour) above the axes, ascending, each joined to its point, moved apart where they
    would overlap; returns their height in lines of words.
    """
    gap = 9.5 / (72 * ax.bbox.width / ax.figure.dpi) * ax.get_xlim()[1]
    places = np.array([x for x, *_ in names], float)
    for _ in range(100):  # two that are too close move apart
        for k in range(1, len(places)):
            places[k - 1 : k + 1] += max(0.0, gap - places[k] + places[k - 1]) / 2 * np.array([-1, 1])
    arrow = {'arrowstyle': '-', 'color': FAINT, 'linewidth': 0.5, 'shrinkA': 0, 'shrinkB': 0}
    for (x, y, words, color), place in zip(names, places):
        ax.annotate(words, (x, y), (place, 1.03), 'data', ax.get_xaxis_transform(), rotation=90, ha='center', va='bottom',
                    color=color, annotation_clip=False, arrowprops=arrow)  # fmt: skip
    return 0.55 * max(len(words) for _, _, words, _ in names) + 1


def over_speeds(ax: Axes, rpm: Any) -> None:
    """Labels an axis of speeds; a single speed is in the middle and has the only tick."""
    ax.set_xlabel('Speed of the pinion (1/min)')
    speeds = np.unique(rpm)
    if len(speeds) == 1:
        ax.set_xlim(0.8 * speeds[0], 1.2 * speeds[0])
        ax.set_xticks(speeds, [f'{speeds[0]:g}'])


def in_khz(frequency_hz: float) -> str:
    """Formats a frequency for pictures."""
    return f'{frequency_hz / 1000:.4g} kHz'


def in_mm(ax: Axes) -> None:
    """Sets axes of a shape in mm, to the same scale."""
    ax.set_aspect('equal')
    ax.set_xlabel('x (mm)')
    ax.set_ylabel('y (mm)')
