"""Gears with individual tooth errors: over speed, over the revolution, by orders, by assembly."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from ..core.study import Study
from ..core.table import Table, select_value
from .look import ACCENT, ASIDE, FAINT, FINE, GREY, HALO, HOLLOW, INK, MM, PAGE, canvas, legends_above, names_above, over_speeds
from .over_speed import crosses, curve
from .reliefs import Reliefs, study_of, table_of

#: Number of pairs of gears and assemblies from which a band omits the outermost.
MANY = 20
#: Number of mesh periods drawn of a long turn, about the pair with the largest load.
MOST_PERIODS, PART = 100, 25
#: Number of the largest orders drawn besides the mesh orders, if there are many.
MOST_ORDERS, LARGEST = 100, 40
#: Number of named sidebands, and twice the number of named shaft orders; range of the scales below the largest amplitude.
NAMED, DEPTH = 4, 1e4
NOMINAL: dict[str, Any] = {'color': INK, 'linestyle': (0, (4, 1.5)), 'linewidth': 0.9}
AT_REST: dict[str, Any] = {**HOLLOW, 'marker': 'o', 'markersize': 2.5, 'markeredgecolor': INK, 'markeredgewidth': 0.5}
NATURAL: dict[str, Any] = {'linewidth': 0.9, 'linestyle': (0, (3, 3))}


def plot_as_built(result: Study | Table, ax: Axes | None = None, *, relief_um: float | None = None) -> Axes:
    """Draws the dynamic factor over speed of gears as built, for one relief, and dashed that of gears without deviations.

    For several pairs of gears and assemblies: the median, in a band from the 5th to the 95th percentile, or with fewer than 20 from
    the least to the largest. A cross at the lower edge: some did not converge at this speed, and only the others are included.

    Parameters
    ----------
    result : Study or Table
        A study, or its table `as_built`.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.
    relief_um : float, optional
        One of the case's reliefs; otherwise the first.

    Returns
    -------
    Axes

    Raises
    ------
    ValueError
        The case has no such relief.
    """
    table = table_of(result, 'as_built')
    relief, i, color = _relief(table, relief_um)
    factor = table.dynamic_factor[i].reshape(-1, len(table.rpm))  # a row for each pair of gears and assembly
    missing = np.isnan(factor)
    known = ~missing.all(axis=0)
    band = np.full((3, len(table.rpm)), np.nan)
    outer = 5 if len(factor) >= MANY else 0
    band[:, known] = np.nanpercentile(factor[:, known], (outer, 50, 100 - outer), axis=0)
    with canvas(ax, height=80 * MM, width=PAGE) as ax:
        entries: list[Artist] = [Line2D([], [], label='as built', color=color)]
        if len(factor) > 1:
            ax.fill_between(table.rpm, band[0], band[2], color=color, alpha=0.25, linewidth=0 if len(table.rpm) > 1 else 4)
            entries = [Line2D([], [], label=f'median of {len(factor)} as built', color=color),
                       Patch(color=color, alpha=0.25, linewidth=0, label='5 to 95 %' if outer else 'least to largest')]  # fmt: skip
        curve(ax, table.rpm, band[1], {'color': color})
        curve(ax, table.rpm, table.nominal_factor[i, 0, 0], NOMINAL)
        words = ', '.join(dict.fromkeys(table.status[i].reshape(factor.shape)[missing]))
        gaps = crosses(ax, [(table.rpm[missing.any(axis=0)], color)], f'no answer: {words}')
        legends_above(ax, (f'Tip relief {relief:g} µm', [*entries, Line2D([], [], label='nominal', **NOMINAL), *gaps]))
        over_speeds(ax, table.rpm)
        ax.set_ylabel('Dynamic factor (–)')
    return ax


def plot_turn(result: Study | Table, ax: Axes | None = None, *, relief_um: float | None = None, rpm: float | None = None) -> Axes:
    """Draws the transmission error over the revolution in motion and, fine, at rest; vertical lines are revolutions of the
    pinion.

    Of a turn of more than 100 mesh periods, 25 are drawn, with the largest load of a pair of teeth in their middle.
    Of a study or its table `as_built_turn`, at one of its speeds (by default the first). If the motion did not converge, only the
    static error is drawn. Otherwise like `plot_as_built`.
    """
    table = table_of(result, 'as_built_turn')
    relief, _, color = _relief(table, relief_um)
    mine = np.isclose(table.relief_um, relief)
    speeds = np.unique(table.rpm[mine & (table.rpm > 0)])
    speed = select_value(speeds, rpm, 'rpm') if speeds.size else None
    part = _part(table.study, int(np.ceil(table.tau[mine].max())), relief, speed)
    with canvas(ax, height=50 * MM, width=PAGE) as ax:
        for one, look in ((0.0, {**FINE, 'label': 'at rest'}), (speed, {'label': 'in motion'})):
            if one is not None:
                mask = mine & np.isclose(table.rpm, one) & (part[0] <= table.tau) & (table.tau <= part[1])
                ax.plot(table.tau[mask], table.transmission_error_um[mask], color=color, **look)
        curves = ax.lines[:]
        _turns(ax, table.study, part)
        ax.set_ylabel('Transmission error (µm)')
        legends_above(ax, (_title(table, relief, speed, part), curves))
    return ax


def plot_turn_loads(result: Study | Table, ax: Axes | None = None, *, relief_um: float | None = None, rpm: float | None = None) -> Axes:
    """Draws the largest load of each pair of teeth over the static load, a bar at the mesh period in which the pair enters; the
    largest has the numbers of its teeth. Of a turn of more than 100 mesh periods, 25 are drawn, about the largest.
    Of a study or its table `as_built_loads`; otherwise like `plot_turn`.
    """
    table = table_of(result, 'as_built_loads')
    relief, speed, mask = _point(table, relief_um, rpm)
    part = _part(table.study, len(table.pair[mask]), relief, speed)
    mask = mask & (part[0] < table.pair) & (table.pair <= part[1])
    pair, ratio = table.pair[mask], table.load_ratio[mask]
    k = int(np.argmax(ratio))
    with canvas(ax, height=50 * MM, width=PAGE) as ax:
        # One collection for all bars.
        edges = np.add.outer(pair - 1.0, (0.08, 0.92)).ravel()
        ax.stairs(np.insert(ratio, range(1, len(ratio)), 0.0), edges, fill=True, color=_relief(table, relief)[2])
        ax.axhline(1, **ASIDE, path_effects=HALO)
        side = 'left' if k < 0.25 * len(pair) else 'right' if k > 0.75 * len(pair) else 'center'
        ax.annotate(f'{ratio[k]:.4g}, pinion tooth {table.pinion_tooth[mask][k]} on gear tooth {table.gear_tooth[mask][k]}',
                    (pair[k] - 0.5, ratio[k]), (0, 2), textcoords='offset points', ha=side)  # fmt: skip
        _turns(ax, table.study, part)
        ax.set_ylim(0, 1.2 * ratio.max())
        ax.set_ylabel('Load over static load (–)')
        legends_above(ax, (_title(table, relief, speed, part), [Line2D([], [], **ASIDE, label='static load')]))
    return ax


def plot_orders(result: Study | Table, ax: Axes | None = None, *, relief_um: float | None = None, rpm: float | None = None) -> Axes:
    """Draws the amplitudes of the orders of the dynamic transmission error as stems and, hollow, of the static one; orders of
    the mesh, the largest sidebands and shaft orders have names. Of more than 100 orders those of the mesh and the 40
    largest others are drawn. Of a study or its table `as_built_orders`; otherwise like `plot_turn`.
    """
    table = table_of(result, 'as_built_orders')
    relief, speed, mask = _point(table, relief_um, rpm)
    answered = np.isfinite(table.dte_amplitude_um[mask]).all()
    mask, of = np.flatnonzero(mask), ''
    if len(mask) > MOST_ORDERS:
        others = mask[[not _is_of(name, 2) for name in table.order_name[mask]]]
        height = table['dte_amplitude_um' if answered else 'ste_amplitude_um'][others]
        mask = np.setdiff1d(mask, others[np.argsort(-height, kind='stable')[LARGEST:]])
        of = f'\nMesh orders, and the {LARGEST} largest of {len(others)} others'
    order, dynamic, static = (table[column][mask] for column in ('order', 'dte_amplitude_um', 'ste_amplitude_um'))
    height = dynamic if answered else static
    names = [name.replace('-', '−') for name in table.order_name[mask]]
    mesh, of_mesh = (np.array([_is_of(name, *lengths) for name in names]) for lengths in ((2,), (2, 5)))
    falling = np.argsort(-height, kind='stable')
    named = (mesh, of_mesh & ~mesh, ~of_mesh)
    named_orders = sorted(k for these, most in zip(named, (None, NAMED, NAMED // 2)) for k in falling[these[falling]][:most])
    with canvas(ax, height=80 * MM, width=PAGE) as ax:
        ax.set_yscale('log')
        for these, color, width in ((~mesh, GREY, 1.1), (mesh, ACCENT, 2.0)):
            ax.vlines(order[these], 0, dynamic[these], color=color, linewidth=width)
        ax.plot(order, static, **AT_REST)
        shown = np.fmax(dynamic, static)
        ax.set_ylim(max(min(height.min(), static.min()) / 2, shown.max() / DEPTH), 2 * shown.max())
        ax.set_xlim(0, order.max() + 1)
        lines = names_above(ax, [(order[k], height[k], names[k], ACCENT if mesh[k] else INK) for k in named_orders])
        entries = [Line2D([], [], color=ACCENT, linewidth=2, label='mesh'), Line2D([], [], color=GREY, label='other'),
                   Line2D([], [], **AT_REST, label='at rest')]  # fmt: skip
        legends_above(ax, (_title(table, relief, speed if answered else None) + of, entries), gap=lines)
        ax.set_xlabel('Order (cycles a turn of the pinion)')
        ax.set_ylabel('Amplitude of the TE (µm)')
    return ax


def plot_waterfall(result: Study | Table, ax: Axes | None = None) -> Axes:
    """Draws the amplitude of the dynamic transmission error over speed and order, in colours of its logarithm, for the first
    relief. Orders of the mesh are named at the side; on the dashed curve an order has the natural frequency. Of a study or
    its table `as_built_waterfall`.
    """
    study, table = study_of(result), table_of(result, 'as_built_waterfall')
    amplitude, rpm = table.dte_amplitude_um.T, table.rpm
    if len(rpm) == 1:  # the largest width of a column
        amplitude, rpm = np.repeat(amplitude, 2, axis=1), rpm * np.array([0.9, 1.1])
    top = np.max(amplitude, initial=0, where=np.isfinite(amplitude)) or 1.0
    norm = LogNorm(max(np.min(amplitude, initial=top, where=amplitude > 0), top / DEPTH), top)
    teeth = int(study.case.get('pinion', 'teeth'))
    mesh = range(teeth, int(table.order.max()) + 1, teeth)
    with canvas(ax, height=90 * MM, width=PAGE) as ax:
        ax.set_facecolor(FAINT)
        shades = ax.pcolormesh(rpm, table.order, amplitude, cmap='viridis', norm=norm, shading='nearest', rasterized=True)
        over_speeds(ax, table.rpm)
        ends = ax.get_xlim(), ax.get_ylim()
        if 'motion' in study:
            speeds = np.linspace(max(ends[0][0], 1e-3 * ends[0][1]), ends[0][1], 400)
            ax.plot(speeds, 60 * study.motion.natural_frequency_hz / speeds, color='white', **NATURAL)
            title = f'Tip relief {study.as_built.relief_um[0]:g} µm' if 'as_built' in study else ''
            legends_above(ax, (title, [Line2D([], [], color=GREY, label='natural frequency', **NATURAL)]))
        ax.set(xlim=ends[0], ylim=ends[1])
        ax.set_yticks([1, *mesh], ['1', *(f'mesh {k}: {order}' for k, order in enumerate(mesh, 1))])
        bar = ax.figure.colorbar(shades, ax=ax, label='Amplitude of the DTE (µm)', pad=0.02, aspect=30)
        bar.outline.set_linewidth(0.6)
        ax.set_ylabel('Order (cycles a turn of the pinion)')
    return ax


def plot_assemblies(result: Study | Table, ax: Axes | None = None, *, relief_um: float | None = None, draw: int | None = None) -> Axes:
    """Draws the largest dynamic factor over the speeds of each assembly of one pair of gears (by default the first). Best and worst
    are named by the gear's tooth that enters at A with the pinion's stated one. If there is only one assembly, it draws each pair.
    Dashed: without deviations. Of a study or its table `as_built_worst`; otherwise like `plot_as_built`."""
    table = table_of(result, 'as_built_worst')
    relief, i, color = _relief(table, relief_um)
    pair = select_value(table.draw, draw, 'draw')
    title = f'Tip relief {relief:g} µm'
    what, number, factor = 'Pair of gears', table.draw, table.dynamic_factor[i, :, 0]
    names = [f'pair of gears {one}' for one in number]
    if len(table.assembly) > 1:
        at = i, np.abs(table.draw - pair).argmin()
        what, number, factor = 'Assembly', table.assembly, table.dynamic_factor[at]
        names = [f'assembly {one}\n(gear tooth {tooth:g} first)' for one, tooth in zip(number, table.first_gear_tooth[at])]
        title += f', pair of gears {pair:g} of {len(table.draw)}'
    with canvas(ax) as ax:
        ax.axhline(table.nominal_factor[i, 0, 0], **NOMINAL)
        ax.plot(number, factor, 'o', color=color, markersize=3)
        known = np.flatnonzero(np.isfinite(factor))
        for word, rise, va in (('worst', 4, 'bottom'), ('best', -4, 'top'))[: known.size]:
            k = known[(np.argmax if word == 'worst' else np.argmin)(factor[known])]
            part = (number[k] - number[0]) / max(1, number[-1] - number[0])
            ax.plot(number[k], factor[k], 'D', color=INK, markersize=4)
            ax.annotate(f'{word}: {names[k]}, {factor[k]:.3f}', (number[k], factor[k]), (0, rise), textcoords='offset points', va=va,
                        ha='left' if part < 0.2 else 'right' if part > 0.8 else 'center', path_effects=HALO)  # fmt: skip
        ax.margins(y=0.35)
        ax.set_xlim(number[0] - 1, number[-1] + 1)
        ax.xaxis.set_major_locator(MaxNLocator(integer=True))
        legends_above(ax, (title, [Line2D([], [], label='nominal', **NOMINAL)]))
        ax.set_xlabel(f'{what} (–)')
        ax.set_ylabel('Largest dynamic factor (–)')
    return ax


def _relief(table: Table, wanted: float | None) -> tuple[float, int, Any]:
    """Returns the requested relief, its index in the table, and its colour."""
    relief = select_value(table.relief_um, wanted, 'relief_um')
    amounts = np.array(list(dict.fromkeys(table.relief_um)))
    return relief, int(np.abs(amounts - relief).argmin()), Reliefs(table.case).style(relief)['color']


def _point(table: Table, relief_um: float | None, rpm: float | None) -> tuple[float, float, Any]:
    """Returns the requested relief and speed, and their rows.

    Raises
    ------
    ValueError
        The table has no such point, or none at all.
    """
    relief = select_value(table.relief_um, relief_um, 'relief_um')
    mine = np.isclose(table.relief_um, relief)
    speed = select_value(table.rpm[mine], rpm, 'rpm')
    return relief, speed, mine & np.isclose(table.rpm, speed)


def _is_of(name: str, *lengths: int) -> bool:
    """True if an order is a mesh order whose name has one of these numbers of words."""
    return name.startswith('mesh') and len(name.split()) in lengths


def _part(study: Study, periods: int, relief: float, rpm: float | None) -> tuple[int, int, int]:
    """Returns the first and the last mesh period to be drawn, and their number in the turn: all, or those about the largest load."""
    if periods <= MOST_PERIODS:
        return 0, periods, periods
    middle = 0.0
    if rpm is not None:
        loads = study.as_built_loads
        mask = np.isclose(loads.relief_um, relief) & np.isclose(loads.rpm, rpm)
        middle = loads.pair[mask][loads.load_ratio[mask].argmax()] - 0.5
    first = int(np.clip(middle - PART / 2, 0, periods - PART))
    return first, first + PART, periods


def _title(table: Table, relief: float, rpm: float | None, part: tuple[int, int, int] | None = None) -> str:
    """Returns relief and speed and, if there are several, the pair of gears and the assembly as a title; below it the part of the turn."""
    parts = [f'Tip relief {relief:g} µm', 'no answer in motion' if rpm is None else f'{rpm:g} 1/min']
    case = table.case
    if case.get('deviations', 'draws', 1) > 1:
        parts.append(f'pair of gears {case.get("as_built", "turn_draw")}')
    if case.get('deviations', 'assembly') == 'all':
        parts.append(f'assembly {case.get("as_built", "turn_assembly")}')
    if part and part[1] - part[0] < part[2]:
        about = '' if rpm is None else ', about the largest load'
        return f'{", ".join(parts)}\nMesh periods {part[0]} to {part[1]} of {part[2]}{about}'
    return ', '.join(parts)


def _turns(ax: Axes, study: Study, part: tuple[int, int, int]) -> None:
    """Labels an axis of mesh periods, and marks the revolutions of the pinion."""
    for turn in range(0, part[1] + 1, int(study.case.get('pinion', 'teeth'))):
        if turn >= part[0]:
            ax.axvline(turn, color=FAINT, linewidth=0.5, zorder=0)
    ax.set_xlim(part[:2])
    ax.set_xlabel('Time (mesh periods)')
