"""Tip reliefs that different methods lead to."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from ..study import Study
from ..table import Table
from .look import ACCENT, BLUE, GREEN, GREY, ORANGE, PURPLE, VERMILION, canvas, legends_above
from .reliefs import study_of, table_of

#: What a method is called in a legend, with its colour and mark.
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
    """Static transmission error or dynamic factor over the amount of relief, with the relief that each method leads to.

    A method's mark stands at its relief of the pinion; the curve has the fractions of the case for both gears.

    Parameters
    ----------
    curve : Study or Table
        A study, or its table `relief_curve`.
    ax : Axes, optional
        Where to draw; otherwise a figure is made.
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
    # Bounds are of the dynamic factor alone. What was found along the curve lies on it.
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


def plot_relief_flank(flank: Study | Table, ax: Axes | None = None, *, member: str = 'pinion') -> Axes:
    """Relief over the diameter of a flank, a curve for each method, with the given diameters as dots.

    Parameters
    ----------
    flank : Study or Table
        A study, or its table `relief_flank`.
    ax : Axes, optional
        Where to draw; otherwise a figure is made.
    member : str
        'pinion' or 'gear'.

    Returns
    -------
    Axes

    Raises
    ------
    ValueError
        There is no such gear.
    """
    if member not in ('pinion', 'gear'):
        raise ValueError(f'member = {member!r}: must be pinion or gear')
    flank = table_of(flank, 'relief_flank')
    with canvas(ax) as ax:
        curves = []
        for name in list(dict.fromkeys(flank.method)):
            if name == 'none':
                continue
            here = (flank.method == name) & (flank.member == member)
            label, color, mark = METHODS[name]
            curves += ax.plot(flank.diameter_mm[here], flank.relief_um[here], color=color, marker=mark, markersize=3,
                              markerfacecolor='none', label=label)  # fmt: skip
        legends_above(ax, ('', curves))
        ax.set_xlabel(f'Diameter of the {member} (mm)')
        ax.set_ylabel('Relief (µm)')
    return ax
