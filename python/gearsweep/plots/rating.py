"""The dynamic factor of ISO 6336 by its Methods A and B."""

from __future__ import annotations

from typing import Any

from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ..study import Study
from ..table import Table
from .look import FINE, GREY, canvas
from .over_speed import curve
from .reliefs import Reliefs, table_of

#: The mark of a single speed.
BY_B: dict[str, Any] = {'marker': 'D', 'markersize': 4, 'markerfacecolor': 'white'}


def plot_rating(dynamic: Study | Table, ax: Axes | None = None) -> Axes:
    """Dynamic factor over speed by Method A, from the motion, and, fine, by Method B, for each relief; at a single speed as a dot and a hollow diamond.

    Parameters
    ----------
    dynamic : Study or Table
        A study, or its table `dynamic_factors`.
    ax : Axes, optional
        Where to draw; otherwise a figure is made.

    Returns
    -------
    Axes
    """
    dynamic = table_of(dynamic, 'dynamic_factors')
    reliefs = Reliefs(dynamic.case)
    with canvas(ax) as ax:
        for by_a, by_b, look in zip(dynamic.dynamic_factor_a, dynamic.dynamic_factor_b, reliefs.styles):
            curve(ax, dynamic.rpm, by_a, look)
            curve(ax, dynamic.rpm, by_b, {**look, **FINE, **BY_B})
        dots: tuple[dict[str, Any], ...] = ({'marker': 'o', 'markersize': 2.5}, BY_B) if len(dynamic.rpm) == 1 else ({}, {})
        methods = [Line2D([], [], color=GREY, label='Method A: motion', **dots[0]), Line2D([], [], color=GREY, label='Method B', **FINE, **dots[1])]
        reliefs.legend(ax, methods)
        ax.set_xlabel('Speed of the pinion (1/min)')
        ax.set_ylabel('Dynamic factor $K_v$ (–)')
    return ax
