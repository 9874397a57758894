"""Flank contact along the path of contact: pressure, sliding, temperature, film, friction."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ..core.study import Study
from ..core.table import Table, select_value
from .along_path import finish
from .look import FINE, GREY, canvas
from .reliefs import Reliefs, paths, table_of

#: Columns of the table `flank` for `plot_flank`, with their labels.
QUANTITIES = {
    'pressure_mpa': 'Hertz pressure (MPa)',
    'shear_stress_mpa': 'Largest shear stress (MPa)',
    'sliding_m_s': 'Sliding speed (m/s)',
    'specific_sliding': 'Specific sliding (–)',
    'flash_temperature_k': 'Flash temperature (K)',
    'film_thickness_um': 'Film thickness (µm)',
    'friction_power_w': 'Friction power (W)',
}

#: Quantities that depend neither on the load nor on the relief.
GEOMETRIC = ('sliding_m_s', 'specific_sliding')


def plot_flank(
    flank: Study | Table, ax: Axes | None = None, *, quantity: str = 'pressure_mpa', rpm: float | None = None
) -> Axes:
    """Draws pressure, sliding, flash temperature, film or friction power along the path of contact of one pair, at one speed.

    Fine lines are for the static load, if the table also has that of a motion.

    Parameters
    ----------
    flank : Study or Table
        A study, or its table `flank`.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.
    quantity : str
        A column of the table, of those in `QUANTITIES`; `specific_sliding` for both flanks.
    rpm : float, optional
        One of the case's speeds in `&flank`; otherwise the first.

    Returns
    -------
    Axes

    Raises
    ------
    ValueError
        The case has no such speed, or there is no such quantity.
    """
    flank = table_of(flank, 'flank')
    rpm = select_value(flank.rpm, rpm, 'rpm')
    if quantity not in QUANTITIES:
        raise ValueError(f"quantity = '{quantity}': must be one of {', '.join(QUANTITIES)}")
    mask = np.isclose(flank.rpm, rpm) & np.isfinite(flank.s)
    with canvas(ax) as ax:
        draw = _kinematics if quantity in GEOMETRIC else _loads
        more = draw(ax, flank, mask, quantity)
        finish(ax, flank, QUANTITIES[quantity], more)
        ax.set_xlabel(f'Path coordinate s at {rpm:g} 1/min (base pitches)')
    return ax


def _kinematics(ax: Axes, flank: Table, mask: np.ndarray, quantity: str) -> list[Line2D]:
    """Draws a quantity that does not depend on the load: one curve, or one for each flank."""
    columns = [quantity] if quantity in flank.units else ['pinion_specific_sliding', 'gear_specific_sliding']
    order = np.flatnonzero(mask)[np.argsort(flank.s[mask], kind='stable')]
    styles: list[dict[str, Any]] = [{'color': GREY}, {'color': GREY, 'linestyle': (0, (5, 1.5))}]
    for column, look in zip(columns, styles):
        ax.plot(flank.s[order], flank[column][order], **look)
    ax.axhline(0, color=GREY, linewidth=0.4, zorder=0)
    if len(columns) == 1:
        return []
    return [Line2D([], [], label=name, **look) for name, look in zip(('pinion', 'gear'), styles)]


def _loads(ax: Axes, flank: Table, mask: np.ndarray, quantity: str) -> list[Line2D]:
    """Draws a curve for each relief, of a motion and, fine, static."""
    reliefs = Reliefs(flank.case)
    is_dynamic = (flank.loading == 'dynamic')[mask]
    values = flank[quantity]
    for s, value, relief, dynamic in paths(flank.s[mask], values[mask], flank.relief_um[mask], is_dynamic):
        fine = FINE if is_dynamic.any() and not dynamic[0] else {}
        ax.plot(s, value, **{**reliefs.style(relief[0]), **fine})
    ax.set_ylim(0, 3 * np.nanmedian(values[mask]) if quantity == 'film_thickness_um' else None)  # unbounded without load
    if not is_dynamic.any():
        return []
    return [Line2D([], [], color=GREY, label='motion'), Line2D([], [], color=GREY, label='static load', **FINE)]
