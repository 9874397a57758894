"""Stability over speed and damping, branches of the steady motion, and the motion once a mesh period."""

from __future__ import annotations

import itertools

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, TwoSlopeNorm
from matplotlib.lines import Line2D

from ..core.study import Study
from ..core.table import Table
from .kinds import KINDS, in_words
from .look import ASIDE, CROSS, FAINT, GREY, HALO, HOLLOW, INK, MM, PAGE, canvas, legends_above, line_styles, over_speeds
from .over_speed import crosses, curve
from .reliefs import Reals, study_of

#: Colours from fast decay to slow decay, white at 1, then growth.
SHADES = LinearSegmentedColormap.from_list(
    'multiplier', [(0, '#5f7d9c'), (0.5, '#ffffff'), (0.5, '#f3c1b2'), (0.75, '#c9503c'), (1, '#7a1f12')]
)

#: Number of speeds and damping ratios below which a map is interpolated linearly.
FINEST = 160

#: Distance from 1 within which a modulus is rounding, as without damping.
NEUTRAL = 1e-7


def plot_stability(stability: Study | Table, ax: Axes | None = None) -> Axes:
    """Draws the largest Floquet multiplier over speed and damping, with the tongues of instability.

    In the tongues, which have an outline, the motion with all pairs in contact is unstable. The point at the top
    of a tongue is the damping ratio that closes it; the dashed line is that of the case. Grey: the speed is too low for a result.

    Parameters
    ----------
    stability : Study or Table
        A study, or its table `stability`.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.

    Returns
    -------
    Axes
    """
    study = study_of(stability)
    shown = study.stability
    rpm, damping = shown.rpm, shown.damping_ratio
    with canvas(ax, height=80 * MM, width=PAGE) as ax:
        ax.set_facecolor(FAINT)
        most = max(1.01, np.nanmax(shown.floquet_modulus, initial=1))
        norm = TwoSlopeNorm(1 + NEUTRAL, 0, most)
        across, up = (-(-FINEST // len(places)) for places in (rpm, damping))
        modulus = between(between(shown.floquet_modulus, across).T, up)
        shades = ax.pcolormesh(between(rpm, across), between(damping, up), modulus, cmap=SHADES, norm=norm, shading='nearest', rasterized=True)
        ax.set_xlim(rpm[0], rpm[-1])
        ax.set_ylim(damping.min(), damping.max())
        if 'tongues' in study:
            for tongue in study.tongues.tongue:
                ax.plot(*outline(study, tongue), color=INK, linewidth=0.7)
            _closings(ax, study.tongues)
        ratio = study.case.get('dynamics', 'damping_ratio', 0)
        if damping.min() < ratio < damping.max():
            ax.axhline(ratio, **ASIDE)
            legends_above(ax, ('', [Line2D([], [], **ASIDE, label=f'damping ratio of the case, {ratio:g}')]))
        bar = ax.figure.colorbar(shades, ax=ax, label='Largest multiplier (–)', pad=0.02, aspect=30)
        bar.set_ticks([*np.linspace(0, 1, 5), *np.linspace(1, most, 5)[1:]])
        bar.ax.yaxis.set_major_formatter('{x:.2f}')
        bar.outline.set_linewidth(0.6)
        ax.set_xlabel('Speed of the pinion (1/min)')
        ax.set_ylabel('Damping ratio (–)')
    return ax


def between(values: Reals, times: int) -> Reals:
    """Interpolates values linearly along the first axis: `times` steps instead of one."""
    places = np.arange((len(values) - 1) * times + 1) / times
    low = places.astype(int)
    part = (places - low).reshape(-1, *[1] * (values.ndim - 1))
    following = values[np.minimum(low + 1, len(values) - 1)]
    return np.where(part == 0, values[low], (1 - part) * values[low] + part * following)  # also next to unknown values


def outline(study: Study, tongue: int) -> tuple[Reals, Reals]:
    """Returns speeds and damping ratios around a tongue, including its top if it closes."""
    edge, closing = study.tongue_edges.at(tongue=tongue), study.tongues.at(tongue=tongue)
    is_open = np.isfinite(edge.lower_rpm)
    damping = edge.damping_ratio[is_open]
    top = [] if np.isnan(closing.closing_damping_ratio) else [(closing.closing_rpm, closing.closing_damping_ratio)]
    sides = [*zip(edge.lower_rpm[is_open], damping), *top, *zip(edge.upper_rpm[is_open][::-1], damping[::-1])]
    speeds, ratios = np.array(sides).reshape(-1, 2).T
    return speeds, ratios


def _closings(ax: Axes, tongues: Table) -> None:
    """Marks the points where tongues close, with the damping ratio if there is space: from the highest speed on."""
    left, right = ax.get_xlim()
    bottom, top = ax.get_ylim()
    room = 30 / (72 * ax.bbox.width / ax.figure.dpi) * (right - left)  # for 30 points
    last = np.inf
    for rpm, ratio in zip(tongues.closing_rpm, tongues.closing_damping_ratio):
        if not (left < rpm < right and bottom < ratio < top):
            continue
        ax.plot(rpm, ratio, 'o', color=INK, markersize=2.5, zorder=4)
        if last - rpm > room and min(right - rpm, rpm - left) > room / 2 and 0.02 * top < ratio < 0.93 * top:
            ax.annotate(f'{ratio:.3g}', (rpm, ratio), (0, 4), textcoords='offset points', ha='center', path_effects=HALO)
            last = rpm


def plot_hysteresis(hysteresis: Study | Table, ax: Axes | None = None, *, relief_um: float | None = None) -> Axes:
    """Draws the dynamic factor over speed on a slow run up and on one down, for one relief.

    Arrows are jumps, with their speed if there is space; hollow marks are period doublings or halvings, plus signs the beginning or
    end of periodic motion. A speed without a result is a gap, with a cross at the lower edge. Dotted lines are runs at a finite
    rate, if the case requests them.

    Parameters
    ----------
    hysteresis : Study or Table
        A study, or its table `hysteresis`.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.
    relief_um : float, optional
        The relief; otherwise the first.

    Returns
    -------
    Axes
    """
    study = study_of(hysteresis)
    relief_um = study.hysteresis.relief_um[0] if relief_um is None else relief_um
    runs, every = study.hysteresis.at(relief_um=relief_um), study.hysteresis_changes
    changes = every.at(relief_um=relief_um) if relief_um in every.relief_um else None
    styles = line_styles(2)
    with canvas(ax, height=80 * MM, width=PAGE) as ax:
        for way, look in zip(runs.direction, styles):
            curve(ax, *branch(runs, changes, way), look)
        more = []
        if changes is not None:
            _arrows(ax, runs, changes, styles)
            more = _changes(ax, changes, styles)
        missing = np.isnan(runs.dynamic_factor)
        words = ', '.join(dict.fromkeys(runs.status[missing]))
        rows = [(runs.rpm[gaps], look['color']) for gaps, look in zip(missing, styles)]
        ways = [Line2D([], [], label=f'speed goes {way}', **look) for way, look in zip(runs.direction, styles)]
        if 'hysteresis_ramps' in study:
            more += _ramps(ax, study, relief_um, styles)
        legends_above(ax, (f'Tip relief {relief_um:g} µm', ways + more + crosses(ax, rows, f'no answer: {words}')))
        over_speeds(ax, runs.rpm)
        ax.set_ylabel('Dynamic factor (–)')
    return ax


def _ramps(ax: Axes, study: Study, relief_um: float, styles: list[dict]) -> list[Line2D]:
    """Draws the runs at a finite rate; returns their entry for the legend."""
    ramps = study.hysteresis_ramps.at(relief_um=relief_um)
    for factor, look in zip(ramps.dynamic_factor, styles):
        ax.plot(ramps.rpm, factor, color=look['color'], linestyle=':', linewidth=0.9)
    rate = float(study.case.get('hysteresis', 'ramp_rpm_s'))
    return [Line2D([], [], color=GREY, label=f'at {rate:g} 1/min a second', linestyle=':', linewidth=0.9)]


def branch(runs: Table, changes: Table | None, way: str) -> tuple[Reals, Reals]:
    """Returns speeds and dynamic factors of a run, ascending, with those before and after each change, cut at jumps."""
    points = dict(zip(runs.rpm, runs.at(direction=way).dynamic_factor))
    if changes is not None:
        for i in np.flatnonzero(changes.direction == way):
            before, after = changes.rpm_before[i], changes.rpm_after[i]
            points |= {before: changes.dynamic_factor_before[i], after: changes.dynamic_factor_after[i]}
            if leaps(runs, changes)[i]:
                points[(before + after) / 2] = np.nan
    return tuple(np.array(sorted(points.items())).T)


def leaps(runs: Table, changes: Table) -> np.ndarray:
    """Selects the changes that look like jumps, also with a change of period."""
    height = np.abs(changes.dynamic_factor_after - changes.dynamic_factor_before)
    return (changes.kind == 'jump') | (height > 0.02 * np.nanmax(runs.dynamic_factor, initial=0))


def _changes(ax: Axes, changes: Table, styles: list[dict]) -> list[Line2D]:
    """Draws marks where the motion changes; returns entries for the legend."""
    marks = {
        'doubling': ('period doubles', {**HOLLOW, 'marker': 'D'}),
        'halving': ('period halves', {**HOLLOW, 'marker': 's'}),
    }
    other = ('to or from no answer', {**CROSS, 'marker': '+', 'markersize': 5})
    entries = {}
    for i, kind in enumerate(changes.kind):
        if kind == 'jump':
            continue
        color = styles[int(changes.direction[i] == 'down')]['color']
        point = changes.rpm_before[i], changes.dynamic_factor_before[i]
        if np.isnan(point[1]):
            point = changes.rpm_after[i], changes.dynamic_factor_after[i]
        label, mark = marks.get(kind, other)
        ax.plot(*point, markeredgecolor=color, **mark, zorder=4)
        entries[label] = Line2D([], [], markeredgecolor=GREY, label=label, **mark)
    return list(entries.values())


def _arrows(ax: Axes, runs: Table, changes: Table, styles: list[dict]) -> None:
    """Draws jumps as arrows, with their speeds if there is space, the largest first."""
    ax.autoscale_view()  # fixes the positions
    jumps = np.flatnonzero(leaps(runs, changes))
    rpm = changes.rpm_before[jumps]
    factor = np.column_stack((changes.dynamic_factor_before, changes.dynamic_factor_after))[jumps]
    up = changes.direction[jumps] == 'up'
    for x, (before, after), rises in zip(rpm, factor, up):
        arrow = {'arrowstyle': '-|>', 'color': styles[int(not rises)]['color'], 'linewidth': 0.8, 'mutation_scale': 7}
        ax.annotate('', (x, after), (x, before), arrowprops={**arrow, 'shrinkA': 0, 'shrinkB': 0})
    points = 72 / ax.figure.dpi * ax.transData.transform(np.column_stack((np.repeat(rpm, 2), factor.ravel()))).reshape(-1, 2, 2)
    # Boxes (left, bottom, right, top) in points: of arrows, and of the speeds already drawn.
    occupied = [(left - 3, low - 2, left + 3, high + 2) for (left, low), (_, high) in np.sort(points, axis=1)]
    for k in np.argsort(-np.abs(np.diff(factor, axis=1)[:, 0])):
        for part, left in itertools.product((0.5, 0.3, 0.7, 0.15, 0.85), (up[k], not up[k])):
            x, y = points[k, 0, 0], points[k, :, 1] @ (1 - part, part)
            box = (x - 30 if left else x + 3, y - 5, x - 3 if left else x + 30, y + 5)
            if all(box[2] <= other[0] or other[2] <= box[0] or box[3] <= other[1] or other[3] <= box[1]
                   for m, other in enumerate(occupied) if m != k):  # fmt: skip
                ax.annotate(f'{rpm[k]:.0f}', (rpm[k], factor[k] @ (1 - part, part)), (-4 if left else 4, 0), textcoords='offset points',
                            ha='right' if left else 'left', va='center', path_effects=HALO)  # fmt: skip
                occupied.append(box)
                break


def plot_poincare(poincare: Study | Table, ax: Axes | None = None, *, relief_um: float | None = None) -> Axes:
    """Draws the transmission error once a mesh period over speed, a colour for each kind of motion, for one relief.

    A speed has one point if the motion repeats with the mesh, n points if it repeats after n periods, and a cloud if it is chaotic.
    Undecided motions neither repeat nor are certainly chaotic within the mesh periods kept.

    Parameters
    ----------
    poincare : Study or Table
        A study, or its table `poincare`.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.
    relief_um : float, optional
        The relief; otherwise the first.

    Returns
    -------
    Axes
    """
    study = study_of(poincare)
    relief_um = study.poincare.relief_um[0] if relief_um is None else relief_um
    seen, motion = study.poincare.at(relief_um=relief_um), study.lyapunov.at(relief_um=relief_um)
    kind = np.minimum(motion.mesh_periods, 3).astype(object)
    kind[motion.status == 'chaotic'] = 'chaotic'
    kind[np.isin(motion.status, ['transient', 'aperiodic'])] = 'undecided'
    size = 1.1 if seen.rpm.size > 150 else 2
    with canvas(ax, height=80 * MM, width=PAGE) as ax:
        entries = []
        for name, color in KINDS.items():
            chosen = kind == name
            if not chosen.any():
                continue
            dte = seen.dte_um[chosen]
            rpm = np.broadcast_to(seen.rpm[chosen, None], dte.shape)
            ax.plot(rpm.ravel(), dte.ravel(), 'o', color=color, markersize=size, markeredgewidth=0, rasterized=True)
            label = in_words(name, motion.mesh_periods[chosen])
            entries.append(Line2D([], [], linestyle='', marker='o', markersize=2.5, color=color, label=label))
        legends_above(ax, (f'Tip relief {relief_um:g} µm', entries))
        over_speeds(ax, seen.rpm)
        ax.set_ylabel('Transmission error as a pair enters (µm)')
    return ax
