"""Dynamic factor and transmission error over speed, and the largest dynamic factor over relief."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ..study import Study
from ..table import Table
from .look import ACCENT, CROSS, GREY, HOLLOW, INK, MM, PAGE, PUBLISHED, VISIBLE, canvas, legends_above, over_speeds
from .reliefs import Reals, Reliefs, table_of

#: Marks of points that have an answer, but not a plain one.
MARKS = {'marginal': 'o', 'subharmonic': 'D', 'inexact': '^'}

#: What `plot_dte_sweep` shows.
DTE_LABELS = {'dte_rms_um': 'DTE, rms (µm)', 'dte_peak_to_peak_um': 'DTE, peak to peak (µm)'}


def plot_sweep(sweep: Study | Table, ax: Axes | None = None, *, points: Sequence[Sequence[float]] = ()) -> Axes:
    """Dynamic factor over speed, a curve for each relief.

    A speed without an answer is a gap, with a cross at the lower edge in the colour of the curve. Points that
    are marginal, subharmonic or inexact have marks of their own. A band shows the estimated error where it is
    wide enough to be seen. Where the speed rising leads to another motion than the speed falling, the larger is
    drawn, and the other dotted.

    Parameters
    ----------
    sweep : Study or Table
        A study, or its table `sweep`.
    ax : Axes, optional
        Where to draw; otherwise a figure is made.
    points : sequence of (rpm, dynamic factor) or (rpm, dynamic factor, relief in um)
        Published values, drawn as circles.

    Returns
    -------
    Axes
    """
    sweep = table_of(sweep, 'sweep')
    reliefs = Reliefs(sweep.case)
    with canvas(ax, height=80 * MM, width=PAGE) as ax:
        for i, look in enumerate(reliefs.styles):
            curve(ax, sweep.rpm, sweep.dynamic_factor[i], look)
        others = _other_direction(ax, sweep, reliefs)
        _error_bands(ax, sweep.rpm, sweep.dynamic_factor, sweep.error_estimate, reliefs)
        circles = [(*point[:2], reliefs.style(point[2])['color'] if len(point) > 2 else INK) for point in points]
        more = _published(ax, circles) + others + _status_marks(ax, sweep, reliefs)
        missing = np.isnan(sweep.dynamic_factor)
        words = ', '.join(dict.fromkeys(sweep.status[missing]))
        rows = [(sweep.rpm[gaps], look['color']) for gaps, look in zip(missing, reliefs.styles)]
        reliefs.legend(ax, more + crosses(ax, rows, f'no answer: {words}'))
        over_speeds(ax, sweep.rpm)
        ax.set_ylabel('Dynamic factor (–)')
    return ax


def plot_dte_sweep(sweep: Study | Table, ax: Axes | None = None, *, quantity: str = 'dte_rms_um') -> Axes:
    """Dynamic transmission error over speed, a curve for each relief, as gear dynamics are measured.

    Where the speed rising leads to another motion than the speed falling, that of the larger dynamic factor counts. A speed without
    an answer is a gap. A band shows the estimated error where it is wide enough to be seen.

    Parameters
    ----------
    sweep : Study or Table
        A study, or its table `sweep`.
    ax : Axes, optional
        Where to draw; otherwise a figure is made.
    quantity : {'dte_rms_um', 'dte_peak_to_peak_um'}
        Root mean square of what it differs from its mean, or largest less least.

    Returns
    -------
    Axes
    """
    sweep = table_of(sweep, 'sweep')
    reliefs = Reliefs(sweep.case)
    with canvas(ax, height=80 * MM, width=PAGE) as ax:
        for value, look in zip(sweep[quantity], reliefs.styles):
            curve(ax, sweep.rpm, value, look)
        _error_bands(ax, sweep.rpm, sweep[quantity], sweep.dte_error_estimate_um, reliefs)
        reliefs.legend(ax, [])
        over_speeds(ax, sweep.rpm)
        ax.set_ylabel(DTE_LABELS[quantity])
        ax.set_ylim(bottom=0)
    return ax


def plot_optimum(curve_of: Study | Table, ax: Axes | None = None, *, points: Sequence[Sequence[float]] = ()) -> Axes:
    """Largest dynamic factor over all speeds against the relief, its least value marked.

    Reliefs at which some speeds have no answer are hollow; those at which none has one are a gap, with a cross
    at the lower edge. Triangles, which no line joins, are reliefs that a few speeds showed not to be the best.

    Parameters
    ----------
    curve_of : Study or Table
        A study, or its table `optimum_curve`.
    ax : Axes, optional
        Where to draw; otherwise a figure is made.
    points : sequence of (relief in um, dynamic factor)
        Published values, drawn as circles.

    Returns
    -------
    Axes
    """
    tried = table_of(curve_of, 'optimum_curve')
    bounds = tried.at_least == 1
    relief, worst, whole = tried.relief_um, tried.worst_dynamic_factor, (tried.points_without_answer == 0) & ~bounds
    with canvas(ax) as ax:
        curve(ax, relief, np.where(bounds, np.nan, worst), {'color': ACCENT})
        ax.plot(relief[whole], worst[whole], 'o', color=ACCENT, markersize=2.5)
        more = _published(ax, [(*point[:2], INK) for point in points])
        some = ~whole & ~bounds & np.isfinite(worst)
        if some.any():
            ax.plot(relief[some], worst[some], marker='o', markeredgecolor=ACCENT, **HOLLOW)
            more.append(Line2D([], [], marker='o', markeredgecolor=ACCENT, label='some speeds without answer', **HOLLOW))
        if bounds.any():
            look: dict[str, Any] = {'marker': '^', 'color': ACCENT, 'linestyle': '', 'markersize': 4}
            ax.plot(relief[bounds], worst[bounds], **look)
            more.append(Line2D([], [], label='at least, from some speeds', **look))
        more += crosses(ax, [(relief[np.isnan(worst)], ACCENT)], 'no answer')
        legends_above(ax, ('', more))
        if 'optimum' in tried.study and np.isfinite(tried.study.optimum.relief_um):
            _best(ax, tried.study.optimum)
        ax.set_xlabel('Tip relief (µm)')
        ax.set_ylabel('Largest dynamic factor (–)')
    return ax


def curve(ax: Axes, x: Reals, y: Reals, look: dict[str, Any]) -> None:
    """A line, with a dot, or the mark of its look, where a point has no neighbour to be joined to."""
    known = np.concatenate(([False], np.isfinite(y), [False]))
    alone = known[1:-1] & ~known[:-2] & ~known[2:]
    ax.plot(x, y, **{'marker': 'o', 'markersize': 2.5, **look}, markevery=np.flatnonzero(alone).tolist())


def _other_direction(ax: Axes, sweep: Table, reliefs: Reliefs) -> list[Line2D]:
    """What is met in the other direction, where that is another motion; the entry in the legend."""
    if 'direction' not in sweep or not (sweep.direction != 'both').any():
        return []
    for direction, factor, look in zip(sweep.direction, sweep.other_dynamic_factor, reliefs.styles):
        apart = direction != 'both'
        curve(ax, sweep.rpm, np.where(apart, factor, np.nan), {**look, 'linestyle': ':', 'linewidth': 1})
    return [Line2D([], [], color=GREY, linestyle=':', linewidth=1, label='in the other direction')]


def _error_bands(ax: Axes, rpm: Reals, values: Reals, estimates: Reals, reliefs: Reliefs) -> None:
    """The estimated error, where it is wide enough to be seen."""
    visible = VISIBLE * np.ptp(ax.get_ylim())
    for value, estimate, look in zip(values, estimates, reliefs.styles):
        if np.any(estimate > visible):
            ax.fill_between(rpm, value - estimate, value + estimate, color=look['color'], alpha=0.25, linewidth=0)


def _published(ax: Axes, circles: list[tuple]) -> list[Line2D]:
    """Circles (x, y, colour); the entry in the legend."""
    for x, y, color in circles:
        ax.plot(x, y, **PUBLISHED, markeredgecolor=color, zorder=5, clip_on=False)
    return [Line2D([], [], **PUBLISHED, markeredgecolor=INK, label='published')] if circles else []


def _status_marks(ax: Axes, sweep: Table, reliefs: Reliefs) -> list[Line2D]:
    """Marks on the curves, no closer than can be told apart, unless all points are alike; entries in the legend."""
    entries = []
    for status, mark in MARKS.items():
        there = sweep.status == status
        if not there.any():
            continue
        if there[np.isfinite(sweep.dynamic_factor)].all():
            return [Line2D([], [], linestyle='', label=f'all {status}')]
        for factor, here, look in zip(sweep.dynamic_factor, there, reliefs.styles):
            edge = {'marker': mark, 'markeredgecolor': look['color']}
            ax.plot(sweep.rpm[here], factor[here], **HOLLOW, **edge, markevery=0.03, zorder=3)
        entries.append(Line2D([], [], marker=mark, markeredgecolor=GREY, label=status, **HOLLOW))
    return entries


def crosses(ax: Axes, rows: list[tuple[Reals, Any]], label: str) -> list[Line2D]:
    """Below the curves a row of crosses for each (x, colour) that has any; the entry in the legend."""
    rows = [row for row in rows if row[0].size]
    if not rows:
        return []
    height = min(0.035, 0.25 / len(rows))
    bottom, top = ax.get_ylim()
    ax.set_ylim(top - (top - bottom) / (1 - height * len(rows)), top)
    for i, (x, color) in enumerate(reversed(rows)):
        y = np.full(x.size, height * (i + 0.5))
        ax.plot(x, y, **CROSS, markeredgecolor=color, transform=ax.get_xaxis_transform())
    return [Line2D([], [], **CROSS, markeredgecolor=GREY, label=label)]


def _best(ax: Axes, optimum: Table) -> None:
    """The optimum, named, with its uncertainty where that shows."""
    x, y = optimum.relief_um, optimum.worst_dynamic_factor
    left, right = ax.get_xlim()
    if optimum.within_um > VISIBLE * (right - left):
        ax.errorbar(x, y, xerr=optimum.within_um, color=INK, linewidth=0.8, capsize=2)
    ax.plot(x, y, 'D', color=INK, markersize=4, zorder=4)
    side = 'left' if x < left + 0.25 * (right - left) else 'right' if x > right - 0.25 * (right - left) else 'center'
    bottom, top = ax.get_ylim()
    ax.set_ylim(min(bottom, y - 0.25 * (top - y)), top)
    words = f'{x:.4g} µm\n{y:.4g} at {optimum.rpm:.0f} 1/min'
    ax.annotate(words, (x, y), (0, -5), textcoords='offset points', ha=side, va='top')
