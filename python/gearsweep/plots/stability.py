"""Stability over speed and damping, branches of the steady motion, and the motion seen once a mesh period."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, TwoSlopeNorm
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from ..maps import Hysteresis, StabilityMap, Strobe
from ..results import Reals, Status
from .look import ACCENT, ASIDE, CROSS, FAINT, GREY, HALO, HOLLOW, INK, MM, PAGE, canvas, legends_above, line_styles
from .over_speed import crosses, curve

#: From what dies out at once to what just dies out, at 1 white; from there on, what grows.
SHADES = LinearSegmentedColormap.from_list(
    'multiplier', [(0, '#5f7d9c'), (0.5, '#ffffff'), (0.5, '#f3c1b2'), (0.75, '#c9503c'), (1, '#7a1f12')]
)

#: Above 1 by this is rounding, as without damping.
NEUTRAL = 1e-7

#: Motions that repeat with the mesh, after two periods, after more; chaos; what is not known.
KINDS = {1: ACCENT, 2: '#c9772b', 3: '#3f8f5f', 'chaotic': '#8c2d55', 'undecided': GREY}


def plot_stability(stability: StabilityMap, ax: Axes | None = None) -> Axes:
    """Largest Floquet multiplier over speed and damping, with the tongues of instability.

    In the tongues, which have an outline, the motion with all pairs in contact is unstable. The point at the top
    of a tongue is the damping ratio that closes it; the dashed line is that of the case. Grey: the speed is too
    low to tell.

    Parameters
    ----------
    stability : StabilityMap
        From `gearsweep.stability_map`.
    ax : Axes, optional
        Where to draw; otherwise a figure is made.

    Returns
    -------
    Axes
    """
    rpm, damping = stability.rpm, stability.damping_ratio
    with canvas(ax, height=80 * MM, width=PAGE) as ax:
        ax.set_facecolor(FAINT)
        most = max(1.01, np.nanmax(stability.modulus, initial=1))
        norm = TwoSlopeNorm(1 + NEUTRAL, 0, most)
        shades = ax.pcolormesh(rpm, damping, stability.modulus.T, cmap=SHADES, norm=norm, shading='nearest', rasterized=True)
        ax.set_xlim(rpm[0], rpm[-1])
        ax.set_ylim(damping.min(), damping.max())
        for n in range(stability.closing_ratio.size):
            ax.plot(*outline(stability, n), color=INK, linewidth=0.7)
        _closings(ax, stability)
        ratio = stability.case.get('dynamics', 'damping_ratio')
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


def outline(stability: StabilityMap, n: int) -> tuple[Reals, Reals]:
    """Speeds and damping ratios around tongue n, over its top where it closes."""
    edge, closing = stability.edge_rpm[:, :, n], stability.closing_ratio[n]
    order = np.argsort(stability.damping_ratio)
    order = order[np.isfinite(edge[0, order])]
    damping = stability.damping_ratio[order]
    top = [] if np.isnan(closing) else [(stability.closing_rpm[n], closing)]
    sides = [*zip(edge[0, order], damping), *top, *zip(edge[1, order[::-1]], damping[::-1])]
    return tuple(np.array(sides).reshape(-1, 2).T)


def _closings(ax: Axes, stability: StabilityMap) -> None:
    """Marks where tongues close, and tells the damping ratio where there is room: from the highest speed on."""
    left, right = ax.get_xlim()
    bottom, top = ax.get_ylim()
    room = 30 / (72 * ax.bbox.width / ax.figure.dpi) * (right - left)  # for 30 points
    last = np.inf
    for rpm, ratio in zip(stability.closing_rpm, stability.closing_ratio):
        if not (left < rpm < right and bottom < ratio < top):
            continue
        ax.plot(rpm, ratio, 'o', color=INK, markersize=2.5, zorder=4)
        if last - rpm > room and min(right - rpm, rpm - left) > room / 2 and 0.02 * top < ratio < 0.93 * top:
            ax.annotate(f'{ratio:.3g}', (rpm, ratio), (0, 4), textcoords='offset points', ha='center', path_effects=HALO)
            last = rpm


def plot_hysteresis(hysteresis: Hysteresis, ax: Axes | None = None) -> Axes:
    """Dynamic factor over speed on a slow run up and on one down.

    Arrows are jumps, with their speed where there is room; hollow marks tell where the period doubles or halves,
    plus signs where periodic motion ends or begins. A speed without an answer is a gap, with a cross at the lower
    edge.

    Parameters
    ----------
    hysteresis : Hysteresis
        From `gearsweep.hysteresis`.
    ax : Axes, optional
        Where to draw; otherwise a figure is made.

    Returns
    -------
    Axes
    """
    looks = line_styles(2)
    with canvas(ax, height=80 * MM, width=PAGE) as ax:
        for way, look in enumerate(looks):
            curve(ax, *branch(hysteresis, way), look)
        _arrows(ax, hysteresis, looks)
        more = _changes(ax, hysteresis, looks)
        missing = hysteresis.status >= Status.UNSTABLE
        words = ', '.join(Status(status).name.lower() for status in np.unique(hysteresis.status[missing]))
        rows = [(hysteresis.rpm[gaps], look['color']) for gaps, look in zip(missing, looks)]
        ways = [Line2D([], [], label=f'speed goes {way}', **look) for way, look in zip(hysteresis.labels['direction'], looks)]
        legends_above(ax, ('', ways + more + crosses(ax, rows, f'no answer: {words}')))
        ax.set_xlabel('Speed of the pinion (1/min)')
        ax.set_ylabel('Dynamic factor (–)')
    return ax


def branch(hysteresis: Hysteresis, way: int) -> tuple[Reals, Reals]:
    """Speeds and dynamic factors of a run, ascending, with those before and after each change, cut at jumps."""
    points = dict(zip(hysteresis.rpm, hysteresis.dynamic_factor[way]))
    for i in np.flatnonzero(hysteresis.change_direction == (1, -1)[way]):
        points |= zip(hysteresis.change_rpm[i], hysteresis.change_factor[i])
        if leaps(hysteresis)[i]:
            points[hysteresis.change_rpm[i].mean()] = np.nan
    return tuple(np.array(sorted(points.items())).T)


def leaps(hysteresis: Hysteresis) -> NDArray[np.bool_]:
    """Which changes are jumps to the eye, also such as double the period on the way."""
    before, after = hysteresis.change_factor.T
    return (hysteresis.change_name == 'jump') | (np.abs(after - before) > 0.02 * np.nanmax(hysteresis.dynamic_factor, initial=0))


def _changes(ax: Axes, hysteresis: Hysteresis, looks: list[dict]) -> list[Line2D]:
    """Marks where the motion changes; entries in the legend."""
    marks = {
        'doubling': ('period doubles', {**HOLLOW, 'marker': 'D'}),
        'halving': ('period halves', {**HOLLOW, 'marker': 's'}),
    }
    other = ('to or from no answer', {**CROSS, 'marker': '+', 'markersize': 5})
    entries = {}
    changes = zip(hysteresis.change_name, hysteresis.change_direction, hysteresis.change_rpm, hysteresis.change_factor)
    for name, direction, rpm, factor in changes:
        if name == 'jump':
            continue
        color = looks[int(direction < 0)]['color']
        at = int(np.isnan(factor[0]))
        label, mark = marks.get(name, other)
        ax.plot(rpm[at], factor[at], markeredgecolor=color, **mark, zorder=4)
        entries[label] = Line2D([], [], markeredgecolor=GREY, label=label, **mark)
    return list(entries.values())


def _arrows(ax: Axes, hysteresis: Hysteresis, looks: list[dict]) -> None:
    """Jumps, the largest first, with their speed on the side from which they come, unless another stands there."""
    taken = []
    ax.autoscale_view()  # so that places are known
    height = np.diff(hysteresis.change_factor)[:, 0]
    for i in sorted(np.flatnonzero(leaps(hysteresis)), key=lambda i: -abs(height[i])):
        rpm, factor, up = hysteresis.change_rpm[i, 0], hysteresis.change_factor[i], hysteresis.change_direction[i] > 0
        arrow = {'arrowstyle': '-|>', 'color': looks[int(not up)]['color'], 'linewidth': 0.8, 'mutation_scale': 7}
        ax.annotate('', (rpm, factor[1]), (rpm, factor[0]), arrowprops={**arrow, 'shrinkA': 0, 'shrinkB': 0})
        x, y = 72 / ax.figure.dpi * ax.transData.transform((rpm, factor.mean()))  # in points
        x -= 32 * up
        if all(abs(x - other[0]) > 32 or abs(y - other[1]) > 10 for other in taken):
            place = {'xytext': (-3 if up else 3, 0), 'textcoords': 'offset points', 'ha': 'right' if up else 'left'}
            ax.annotate(f'{rpm:.0f}', (rpm, factor.mean()), **place, va='center', path_effects=HALO)
            taken.append((x, y))


def plot_strobe(strobe: Strobe, ax: Axes | None = None) -> Axes:
    """The transmission error once a mesh period over speed, a colour for each kind of motion.

    One point at a speed where the motion repeats with the mesh, n points where it repeats after n periods, a
    cloud where it is chaotic; undecided is what neither repeats nor is surely chaotic within what was kept.

    Parameters
    ----------
    strobe : Strobe
        From `gearsweep.strobe`.
    ax : Axes, optional
        Where to draw; otherwise a figure is made.

    Returns
    -------
    Axes
    """
    kind = np.minimum(strobe.periods, 3).astype(object)
    kind[strobe.status == Status.CHAOTIC] = 'chaotic'
    kind[strobe.status == Status.APERIODIC] = 'undecided'
    size = 1.2 if strobe.rpm.size > 150 else 2.5
    with canvas(ax, height=80 * MM, width=PAGE) as ax:
        entries = []
        for name, color in KINDS.items():
            there = kind == name
            if not there.any():
                continue
            x = strobe.x_um[:, there]
            rpm = np.broadcast_to(strobe.rpm[there], x.shape)
            ax.plot(rpm.ravel(), x.ravel(), '.', color=color, markersize=size, markeredgewidth=0, rasterized=True)
            entries.append(Line2D([], [], linestyle='', marker='.', color=color, label=_words(name, strobe.periods[there])))
        legends_above(ax, ('', entries))
        ax.set_xlabel('Speed of the pinion (1/min)')
        ax.set_ylabel('Transmission error as a pair enters (µm)')
    return ax


def _words(kind: int | str, periods: np.ndarray) -> str:
    if isinstance(kind, str):
        return kind
    if kind == 1:
        return 'repeats with the mesh'
    least, most = periods.min(), periods.max()
    return f'after {most} periods' if least == most else f'after {least} to {most} periods'
