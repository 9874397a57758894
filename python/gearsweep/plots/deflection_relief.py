"""Tip reliefs by different methods."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from ..core.study import Study
from ..core.table import Table
from .look import ACCENT, BLUE, GREEN, GREY, ORANGE, PURPLE, VERMILION, canvas, legends_above
from .reliefs import study_of, table_of

#: Name of a method in a legend, with its colour and mark.
METHODS = {
    'none': ('none', GREY, 'x'),
    'markovic_vrcan': ('Marković, Vrcan', BLUE, 'o'),
    'whole_flattening': ('all flattening', ORANGE, 's'),
    'finite_elements': ('finite elements', GREEN, 'D'),
    'transmission_error': ('least STE', VERMILION, '^'),
    'dynamic_factor': ('least DF', PURPLE, 'v'),
}
LABELS = {'ste_range_um': 'Peak-to-peak STE (µm)', 'worst_dynamic_factor': 'Largest dynamic factor (–)'}


def plot_deflection_relief(curve: Study | Table, ax: Axes | None = None, *, quantity: str = 'ste_range_um') -> Axes:
    """Draws static transmission error or dynamic factor over the amount of relief, with the relief of each method.

    A method's mark is at its relief of the pinion; the curve has the fractions of the case for both gears.

    Parameters
    ----------
    curve : Study or Table
        A study, or its table `relief_curve`.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.
    quantity : str
        'ste_range_um' or 'worst_dynamic_factor'.

    Returns
    -------
    Axes

    Raises
    ------
    ValueError
        There is no such quantity.
    """
    if quantity not in LABELS:
        raise ValueError(f'quantity = {quantity!r}: must be one of {", ".join(LABELS)}')
    curve = table_of(curve, 'relief_curve')
    methods = study_of(curve).deflection_relief
    # Bounds are of the dynamic factor alone. Values found along the curve are on it.
    known, found = (curve.at_least == 0) | (quantity == 'ste_range_um'), np.isin(methods.method, list(METHODS)[-2:])
    places = np.concatenate((curve.relief_um[known], methods.pinion_relief_um[found]))
    values = np.concatenate((curve[quantity][known], methods[quantity][found]))
    order = np.argsort(places, kind='stable')
    with canvas(ax) as ax:
        ax.plot(places[order], values[order], color=ACCENT, zorder=1)
        marks = []
        for name, relief, value in zip(methods.method, methods.pinion_relief_um, methods[quantity]):
            label, color, mark = METHODS[name]
            marks += ax.plot(relief, value, mark, color=color, markerfacecolor='none', markersize=5, label=label, zorder=2)
        legends_above(ax, ('', marks))
        ax.set_xlabel("Relief at the pinion's tip (µm)")
        ax.set_ylabel(LABELS[quantity])
    return ax


def plot_relief_flank(flank: Study | Table, ax: Axes | None = None, *, gear: str = 'pinion') -> Axes:
    """Draws the relief over the diameter of a flank, a curve for each method, with the stated diameters as dots.

    Parameters
    ----------
    flank : Study or Table
        A study, or its table `relief_flank`.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.
    gear : str
        'pinion' or 'gear'.

    Returns
    -------
    Axes

    Raises
    ------
    ValueError
        There is no such gear.
    """
    if gear not in ('pinion', 'gear'):
        raise ValueError(f'gear = {gear!r}: must be pinion or gear')
    flank = table_of(flank, 'relief_flank')
    with canvas(ax) as ax:
        curves = []
        for name in list(dict.fromkeys(flank.method)):
            if name == 'none':
                continue
            mask = (flank.method == name) & (flank.gear == gear)
            label, color, mark = METHODS[name]
            curves += ax.plot(flank.diameter_mm[mask], flank.relief_um[mask], color=color, marker=mark, markersize=3,
                              markerfacecolor='none', label=label)  # fmt: skip
        legends_above(ax, ('', curves))
        ax.set_xlabel(f'Diameter of the {gear} (mm)')
        ax.set_ylabel('Relief (µm)')
    return ax
