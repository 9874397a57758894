"""Dynamic factor and transmission error over speed, and the largest dynamic factor over relief."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ..core.study import Study
from ..core.table import Table
from .look import ACCENT, CROSS, GREY, HOLLOW, INK, MM, PAGE, PUBLISHED, VISIBLE, canvas, legends_above, over_speeds
from .over_torque import JUDGED
from .reliefs import Reals, Reliefs, table_of

#: Marks of points that converged with a remark.
MARKS = {'marginal': 'o', 'subharmonic': 'D', 'inexact': '^'}

#: Number of points up to which each has a dot, as a line alone would suggest values between them.
SPARSE = 12

#: Quantities of `plot_dte_sweep`.
DTE_LABELS = {'dte_rms_um': 'DTE, rms (µm)', 'dte_peak_to_peak_um': 'DTE, peak to peak (µm)'}


def plot_sweep(sweep: Study | Table, ax: Axes | None = None, *, points: Sequence[Sequence[float]] = ()) -> Axes:
    """Draws the dynamic factor over speed, a curve for each relief.

    A speed without a converged result is a gap, with a cross at the lower edge in the colour of the curve. Points that are marginal,
    subharmonic or inexact have marks of their own. Unconnected hollow squares are lower bounds from motions that do not repeat. A
    band shows the estimated error if it is wide enough to be seen. If rising and falling speed lead to different motions, the
    larger is drawn as a line, and the other dotted.

    Parameters
    ----------
    sweep : Study or Table
        A study, or its table `sweep`.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.
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
        more = _published(ax, circles) + others + _status_marks(ax, sweep, reliefs) + _seen(ax, sweep, 'seen_dynamic_factor', reliefs)
        missing = np.isnan(sweep.dynamic_factor)
        words = ', '.join(dict.fromkeys(sweep.status[missing]))
        rows = [(sweep.rpm[gaps], look['color']) for gaps, look in zip(missing, reliefs.styles)]
        reliefs.legend(ax, more + crosses(ax, rows, f'no answer: {words}'))
        over_speeds(ax, sweep.rpm)
        ax.set_ylabel('Dynamic factor (–)')
    return ax


def plot_dte_sweep(sweep: Study | Table, ax: Axes | None = None, *, quantity: str = 'dte_rms_um') -> Axes:
    """Draws the dynamic transmission error over speed, a curve for each relief, as gear dynamics are measured.

    If rising and falling speed lead to different motions, that of the larger dynamic factor is drawn. A speed without a converged
    result is a gap; hollow squares are values observed in motions that do not repeat. A band shows the estimated error if it is wide
    enough to be seen.

    Parameters
    ----------
    sweep : Study or Table
        A study, or its table `sweep`.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.
    quantity : {'dte_rms_um', 'dte_peak_to_peak_um'}
        Root mean square about the mean, or largest less least value.

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
        reliefs.legend(ax, _seen(ax, sweep, f'seen_{quantity}', reliefs))
        over_speeds(ax, sweep.rpm)
        ax.set_ylabel(DTE_LABELS[quantity])
        ax.set_ylim(bottom=0)
    return ax


def plot_optimum(curve_of: Study | Table, ax: Axes | None = None, *, points: Sequence[Sequence[float]] = ()) -> Axes:
    """Draws the criterion over the relief, over all speeds and torques: its least value is marked.

    Reliefs with some speeds that did not converge are hollow; those with no converged speed are a gap, with a cross at the lower
    edge. Unconnected triangles are lower bounds: a few speeds showed that these reliefs are not the best, and the other speeds were
    not computed.

    Parameters
    ----------
    curve_of : Study or Table
        A study, or its table `optimum_curve`.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.
    points : sequence of (relief in um, dynamic factor)
        Published values, drawn as circles.

    Returns
    -------
    Axes
    """
    tried = table_of(curve_of, 'optimum_curve')
    column, label, _ = JUDGED[str(np.ravel(tried.study.optimum.judged)[0])]
    relief, worst = tried.relief_um, tried[column]
    bounds = tried.at_least == 1 if 'at_least' in tried else np.zeros(len(relief), bool)
    complete = ~bounds & (tried.points_without_answer == 0 if 'points_without_answer' in tried else True)
    with canvas(ax) as ax:
        curve(ax, relief, np.where(bounds, np.nan, worst), {'color': ACCENT})
        ax.plot(relief[complete], worst[complete], 'o', color=ACCENT, markersize=2.5)
        more = _published(ax, [(*point[:2], INK) for point in points])
        some = ~complete & ~bounds & np.isfinite(worst)
        if some.any():
            ax.plot(relief[some], worst[some], marker='o', markeredgecolor=ACCENT, **HOLLOW)
            more.append(Line2D([], [], marker='o', markeredgecolor=ACCENT, label='some speeds without answer', **HOLLOW))
        if bounds.any():
            look: dict[str, Any] = {'marker': '^', 'color': ACCENT, 'linestyle': '', 'markersize': 4}
            ax.plot(relief[bounds], worst[bounds], **look)
            more.append(Line2D([], [], label='lower bound: not the best, not searched further', **look))
        more += crosses(ax, [(relief[np.isnan(worst)], ACCENT)], 'no answer')
        legends_above(ax, ('', more))
        if np.isfinite(tried.study.optimum.relief_um):
            _best(ax, tried.study.optimum, column)
        ax.set_xlabel('Tip relief (µm)')
        ax.set_ylabel(label)
    return ax


def curve(ax: Axes, x: Reals, y: Reals, look: dict[str, Any]) -> None:
    """Draws a line, with a dot or its own mark at points without a neighbour; at all points if they are few."""
    known = np.concatenate(([False], np.isfinite(y), [False]))
    alone = known[1:-1] & ~known[:-2] & ~known[2:]
    marked = known[1:-1] if len(known) - 2 <= SPARSE else alone
    ax.plot(x, y, **{'marker': 'o', 'markersize': 2.5, **look}, markevery=np.flatnonzero(marked).tolist())


def _other_direction(ax: Axes, sweep: Table, reliefs: Reliefs) -> list[Line2D]:
    """Draws the result of the other direction, if it is another motion; returns the entry for the legend."""
    if 'direction' not in sweep or not (sweep.direction != 'both').any():
        return []
    for direction, factor, look in zip(sweep.direction, sweep.other_dynamic_factor, reliefs.styles):
        apart = direction != 'both'
        curve(ax, sweep.rpm, np.where(apart, factor, np.nan), {**look, 'linestyle': ':', 'linewidth': 1})
    return [Line2D([], [], color=GREY, linestyle=':', linewidth=1, label='in the other direction')]


def _seen(ax: Axes, sweep: Table, column: str, reliefs: Reliefs) -> list[Line2D]:
    """Draws the largest values of motions that do not repeat, if the table has them; returns the entry for the legend."""
    if column not in sweep or not np.isfinite(sweep[column]).any():
        return []
    look: dict[str, Any] = {**HOLLOW, 'marker': 's'}
    for value, style in zip(sweep[column], reliefs.styles):
        ax.plot(sweep.rpm, value, **look, markeredgecolor=style['color'], zorder=3)
    return [Line2D([], [], **look, markeredgecolor=GREY, label='seen, at least')]


def _error_bands(ax: Axes, rpm: Reals, values: Reals, estimates: Reals, reliefs: Reliefs) -> None:
    """Draws the estimated error, if it is wide enough to be seen."""
    visible = VISIBLE * np.ptp(ax.get_ylim())
    for value, estimate, look in zip(values, estimates, reliefs.styles):
        if np.any(estimate > visible):
            ax.fill_between(rpm, value - estimate, value + estimate, color=look['color'], alpha=0.25, linewidth=0)


def _published(ax: Axes, circles: list[tuple]) -> list[Line2D]:
    """Draws circles (x, y, colour); returns the entry for the legend."""
    for x, y, color in circles:
        ax.plot(x, y, **PUBLISHED, markeredgecolor=color, zorder=5, clip_on=False)
    return [Line2D([], [], **PUBLISHED, markeredgecolor=INK, label='published')] if circles else []


def _status_marks(ax: Axes, sweep: Table, reliefs: Reliefs) -> list[Line2D]:
    """Draws marks on the curves, with a least distance, unless all points are alike; returns entries for the legend."""
    entries = []
    for status, mark in MARKS.items():
        marked = sweep.status == status
        if not marked.any():
            continue
        if marked[np.isfinite(sweep.dynamic_factor)].all():
            return [Line2D([], [], linestyle='', label=f'all {status}')]
        for factor, mask, look in zip(sweep.dynamic_factor, marked, reliefs.styles):
            edge = {'marker': mark, 'markeredgecolor': look['color']}
            ax.plot(sweep.rpm[mask], factor[mask], **HOLLOW, **edge, markevery=0.03, zorder=3)
        entries.append(Line2D([], [], marker=mark, markeredgecolor=GREY, label=status, **HOLLOW))
    return entries


def crosses(ax: Axes, rows: list[tuple[Reals, Any]], label: str) -> list[Line2D]:
    """Draws below the curves a row of crosses for each (x, colour) that has any; returns the entry for the legend."""
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


def _best(ax: Axes, optimum: Table, column: str) -> None:
    """Marks the optimum with its name, and with its uncertainty if that is visible."""
    x, y = optimum.relief_um, optimum[column]
    left, right = ax.get_xlim()
    if optimum.within_um > VISIBLE * (right - left):
        ax.errorbar(x, y, xerr=optimum.within_um, color=INK, linewidth=0.8, capsize=2)
    ax.plot(x, y, 'D', color=INK, markersize=4, zorder=4)
    side = 'left' if x < left + 0.25 * (right - left) else 'right' if x > right - 0.25 * (right - left) else 'center'
    bottom, top = ax.get_ylim()
    ax.set_ylim(min(bottom, y - 0.25 * (top - y)), top)
    words = f'{x:.4g} µm\n{y:.4g}' + (f' at {optimum.rpm:.0f} 1/min' if column == 'worst_dynamic_factor' and optimum.over_torques == 'worst' else '')
    ax.annotate(words, (x, y), (0, -5), textcoords='offset points', ha=side, va='top')
