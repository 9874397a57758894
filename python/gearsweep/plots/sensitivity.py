"""Change of the dynamic factor with each number of the motion."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from ..core.names import NUMBERS
from ..core.study import Study
from ..core.table import Table
from .look import ACCENT, INK, canvas
from .reliefs import table_of


def plot_sensitivity(
    sensitivity: Study | Table, ax: Axes | None = None, *, rpm: float | None = None, relief_um: float | None = None
) -> Axes:
    """Draws the change of the dynamic factor, in per cent, for a change of each number by one per cent: a bar for each, the
    longest on top.

    Numbers without a derivative are omitted.

    Parameters
    ----------
    sensitivity : Study or Table
        A study, or its table `sensitivity`.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.
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
        ax.locator_params(axis='x', nbins=3)  # space between signed numbers with three digits
        ax.axvline(0, color=INK, linewidth=0.6)
        ax.set_title(f'{rpm:g} 1/min, tip relief {relief_um:g} µm')
        ax.set_ylabel('Input')
        ax.set_xlabel('Change of DF for 1 % more (%)')
    return ax
