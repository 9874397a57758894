"""What happens between the flanks along the path of contact: pressure, sliding, temperature, film, friction."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ..study import Study
from ..table import Table, one_of
from .along_path import finish
from .look import FINE, GREY, canvas
from .reliefs import Reliefs, paths, table_of

#: Columns of the table `flank` that `plot_flank` shows, with their labels.
QUANTITIES = {
    'pressure_mpa': 'Hertz pressure (MPa)',
    'shear_stress_mpa': 'Largest shear stress (MPa)',
    'sliding_m_s': 'Sliding speed (m/s)',
    'specific_sliding': 'Specific sliding (–)',
    'flash_temperature_k': 'Flash temperature (K)',
    'film_thickness_um': 'Film thickness (µm)',
    'friction_power_w': 'Friction power (W)',
}

#: Neither the load nor the relief changes these.
GEOMETRIC = ('sliding_m_s', 'specific_sliding')


def plot_flank(
    flank: Study | Table, ax: Axes | None = None, *, quantity: str = 'pressure_mpa', rpm: float | None = None
) -> Axes:
    """Pressure, sliding, flash temperature, film or friction power along the path of contact of one pair, at one speed.

    Fine lines are for the static load where there is that of a motion too.

    Parameters
    ----------
    flank : Study or Table
        A study, or its table `flank`.
    ax : Axes, optional
        Where to draw; otherwise a figure is made.
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
    rpm = one_of(flank.rpm, rpm, 'rpm')
    if quantity not in QUANTITIES:
        raise ValueError(f"quantity = '{quantity}': must be one of {', '.join(QUANTITIES)}")
    here = np.isclose(flank.rpm, rpm) & np.isfinite(flank.s)
    with canvas(ax) as ax:
        draw = _kinematics if quantity in GEOMETRIC else _loads
        more = draw(ax, flank, here, quantity)
        finish(ax, flank, QUANTITIES[quantity], more)
        ax.set_xlabel(f'Path coordinate s at {rpm:g} 1/min (base pitches)')
    return ax


def _kinematics(ax: Axes, flank: Table, here: np.ndarray, quantity: str) -> list[Line2D]:
    """One curve, or one of either flank, as no load changes it."""
    columns = [quantity] if quantity in flank.units else ['pinion_specific_sliding', 'gear_specific_sliding']
    order = np.flatnonzero(here)[np.argsort(flank.s[here], kind='stable')]
    looks: list[dict[str, Any]] = [{'color': GREY}, {'color': GREY, 'linestyle': (0, (5, 1.5))}]
    for column, look in zip(columns, looks):
        ax.plot(flank.s[order], flank[column][order], **look)
    ax.axhline(0, color=GREY, linewidth=0.4, zorder=0)
    if len(columns) == 1:
        return []
    return [Line2D([], [], label=name, **look) for name, look in zip(('pinion', 'gear'), looks)]


def _loads(ax: Axes, flank: Table, here: np.ndarray, quantity: str) -> list[Line2D]:
    """A curve for each relief, of a motion and, fine, static."""
    reliefs = Reliefs(flank.case)
    is_dynamic = (flank.loading == 'dynamic')[here]
    values = flank[quantity]
    for s, value, relief, dynamic in paths(flank.s[here], values[here], flank.relief_um[here], is_dynamic):
        fine = FINE if is_dynamic.any() and not dynamic[0] else {}
        ax.plot(s, value, **{**reliefs.style(relief[0]), **fine})
    ax.set_ylim(0, 3 * np.nanmedian(values[here]) if quantity == 'film_thickness_um' else None)  # without load it has no end
    if not is_dynamic.any():
        return []
    return [Line2D([], [], color=GREY, label='motion'), Line2D([], [], color=GREY, label='static load', **FINE)]
