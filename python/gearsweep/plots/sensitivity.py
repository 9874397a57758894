"""How much the dynamic factor changes with each number of the motion."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from .._names import NUMBERS
from ..study import Study
from ..table import Table
from .look import ACCENT, INK, canvas
from .reliefs import table_of


def plot_sensitivity(
    sensitivity: Study | Table, ax: Axes | None = None, *, rpm: float | None = None, relief_um: float | None = None
) -> Axes:
    """By how many per cent the dynamic factor grows where each number grows by one per cent: a bar for each, the longest on top.

    Numbers by which there is no derivative are left out.

    Parameters
    ----------
    sensitivity : Study or Table
        A study, or its table `sensitivity`.
    ax : Axes, optional
        Where to draw; otherwise a figure is made.
    rpm : float, optional
        The speed; otherwise the first.
    relief_um : float, optional
        The relief; otherwise the first.

    Returns
    -------
    Axes
    """
    table = table_of(sensitivity, 'sensitivity')
    rpm = table.rpm[0] if rpm is None else rpm
    relief_um = table.relief_um[0] if relief_um is None else relief_um
    rows = np.flatnonzero((table.rpm == rpm) & (table.relief_um == relief_um) & np.isfinite(table.relative_slope))
    rows = rows[np.argsort(np.abs(table.relative_slope[rows]), kind='stable')]
    with canvas(ax) as ax:
        ax.barh(np.arange(len(rows)), table.relative_slope[rows], height=0.6, color=ACCENT)
        ax.set_yticks(np.arange(len(rows)), [NUMBERS[name] for name in table.number[rows]])
        ax.locator_params(axis='x', nbins=3)  # signed numbers with three digits stand apart
        ax.axvline(0, color=INK, linewidth=0.6)
        ax.set_title(f'{rpm:g} 1/min, tip relief {relief_um:g} µm')
        ax.set_ylabel('Input')
        ax.set_xlabel('Change of DF for 1 % more (%)')
    return ax
