"""All attracting motions: over the speed, and the starts that lead to each."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.lines import Line2D

from ..core.study import Study
from ..core.table import Table
from .kinds import KINDS, in_words
from .look import (
    BLUE,
    FAINT,
    GREEN,
    HOLLOW,
    INK,
    MM,
    ORANGE,
    PAGE,
    PURPLE,
    SKY,
    VERMILION,
    WINE,
    YELLOW,
    canvas,
    legends_above,
    over_speeds,
)
from .reliefs import study_of

#: Ratio of the largest to the smallest dynamic factor above which their axis is logarithmic.
WIDE = 10
UNREACHED: dict[str, Any] = {'color': 'none', 'markeredgecolor': INK, 'markeredgewidth': 0.6}

#: Colours of the motions at one speed, the one with most starts first; further ones are black.
HUES = (BLUE, ORANGE, SKY, WINE, YELLOW, GREEN, VERMILION, PURPLE)


def plot_attractors(attractors: Study | Table, ax: Axes | None = None, *, relief_um: float | None = None) -> Axes:
    """Draws the dynamic factors of all attracting motions over speed, for one relief.

    Each motion is a point, larger if more starts lead to it, in the colour of the number of mesh periods after which it repeats.
    The motion that a sweep by single speeds finds has an outline. Motions that no start reaches are hollow. If dynamic factors
    differ widely, their axis is logarithmic.

    Parameters
    ----------
    attractors : Study or Table
        A study, or its table `attractors`.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.
    relief_um : float, optional
        The relief; otherwise the first.

    Returns
    -------
    Axes
    """
    study = study_of(attractors)
    found = study.attractors
    relief_um = study.attractor_points.relief_um[0] if relief_um is None else relief_um
    points = study.attractor_points.at(relief_um=relief_um)
    shown = dict(zip(np.atleast_1d(points.rpm), np.atleast_1d(points.each_motion)))
    mask = found.relief_um == relief_um
    with canvas(ax, height=80 * MM, width=PAGE) as ax:
        entries = []
        for kind, color in KINDS.items():
            if isinstance(kind, str):
                continue
            mine = mask & (np.minimum(found.mesh_periods, 3) == kind)
            if not mine.any():
                continue
            drawn = [found.motion[i] == shown[found.rpm[i]] for i in np.flatnonzero(mine)]
            reached = found.starts[mine] > 0
            edges = [INK if one else 'none' if some else color for one, some in zip(drawn, reached)]
            faces = [color if some else 'none' for some in reached]
            sizes = np.where(reached, 2 + 25 * found.share[mine], 6)
            ax.scatter(found.rpm[mine], found.dynamic_factor[mine], sizes, faces, edgecolors=edges, linewidths=0.6)
            label = in_words(kind, found.mesh_periods[mine])
            entries.append(Line2D([], [], linestyle='', marker='o', color=color, label=label))
        outline: dict[str, Any] = {'marker': 'o', 'color': 'none', 'markeredgecolor': INK, 'markeredgewidth': 0.6}
        entries.append(Line2D([], [], linestyle='', label='shown by a sweep', **outline))
        if (found.starts[mask] == 0).any():
            entries.append(Line2D([], [], linestyle='', marker='o', markersize=3, label='no start reaches it', **UNREACHED))
        legends_above(ax, (f'Tip relief {relief_um:g} µm', entries))
        factor = found.dynamic_factor[mask & np.isfinite(found.dynamic_factor)]
        if factor.size and factor.max() > WIDE * factor.min():
            ax.set_yscale('log')
        if not mask.any():
            ax.set_xlim(np.min(points.rpm), np.max(points.rpm) + 1)
        over_speeds(ax, points.rpm)
        ax.set_ylabel('Dynamic factor (–)')
    return ax


def plot_basins(basins: Study | Table, ax: Axes | None = None, *, rpm: float | None = None, relief_um: float | None = None) -> Axes:
    """Draws the starts that lead to each attracting motion at one speed and relief, in a colour for each motion.

    Marks are the motions themselves, as a new pair enters, at their places among the starts. Light grey: no motion
    captured the start.

    Parameters
    ----------
    basins : Study or Table
        A study, or its table `basins`.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.
    rpm : float, optional
        The speed of the pinion; otherwise the first of those with most motions.
    relief_um : float, optional
        The relief; otherwise the first.

    Returns
    -------
    Axes
    """
    study = study_of(basins)
    relief_um = study.basins.relief_um[0] if relief_um is None else relief_um
    points = study.attractor_points.at(relief_um=relief_um)
    rpm = points.rpm[np.argmax(points.motions)] if rpm is None else rpm
    starts, found = study.basins.at(relief_um=relief_um, rpm=rpm), study.attractors
    mask = np.flatnonzero((found.relief_um == relief_um) & (found.rpm == rpm))
    across = round(np.sqrt(starts.motion.size))
    grid = starts.dte_um.reshape(across, across), starts.dte_rate_mm_s.reshape(across, across)
    most = len(HUES)
    with canvas(ax, height=95 * MM) as ax:
        shades = ListedColormap([FAINT, *HUES, INK])
        norm = BoundaryNorm(np.arange(-0.5, most + 2), most + 2)
        motion = np.minimum(starts.motion, most + 1).reshape(across, across)
        ax.pcolormesh(*grid, motion, cmap=shades, norm=norm, shading='nearest', rasterized=True)
        for limits, values in ((ax.set_xlim, grid[0]), (ax.set_ylim, grid[1])):
            half = (values.max() - values.min()) / max(1, across - 1) / 2
            limits(values.min() - half, values.max() + half)
        entries = []
        for i in mask:
            color = HUES[found.motion[i] - 1] if found.motion[i] <= most else INK
            mark: dict[str, Any] = {**HOLLOW, 'marker': 'o', 'markersize': 5, 'markerfacecolor': color, 'markeredgecolor': INK}
            ax.plot(found.dte_um[i], found.dte_rate_mm_s[i], **mark)
            if found.motion[i] <= most:
                label = f'DF {found.dynamic_factor[i]:.3f}, {100 * found.share[i]:.0f} %'
                if found.mesh_periods[i] > 1:
                    label += f', {found.mesh_periods[i]} periods'
                entries.append(Line2D([], [], label=label, **mark))
        legends_above(ax, (f'{rpm:g} 1/min, tip relief {relief_um:g} µm', entries))
        ax.set_xlabel('Transmission error as a pair enters (µm)')
        ax.set_ylabel('Its rate of change (mm/s)')
    return ax
