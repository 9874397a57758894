"""Root stress while the load passes over a tooth: over time at one speed, and its largest over speed."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ..core.study import Study
from ..core.table import Table, select_value
from .look import FINE, GREY, canvas, over_speeds
from .over_speed import curve
from .reliefs import Reliefs, table_of


def plot_transient(
    transient: Study | Table, ax: Axes | None = None, *, rpm: float | None = None, tangent_deg: float | None = None
) -> Axes:
    """Draws the stress along both fillets at one point over time while the load passes; fine lines are for the same load at
    rest.

    Parameters
    ----------
    transient : Study or Table
        A study, or its table `transient`.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.
    rpm : float, optional
        One of the case's speeds in `&transient`; otherwise the first.
    tangent_deg : float, optional
        One of the case's points of the fillets in `&transient`; otherwise the first.

    Returns
    -------
    Axes

    Raises
    ------
    ValueError
        The case has no such speed or point.
    """
    table = table_of(transient, 'transient')
    rpm = select_value(table.rpm, rpm, 'rpm')
    tangent = select_value(table.tangent_deg, tangent_deg, 'tangent_deg')
    reliefs = Reliefs(table.case)
    with canvas(ax) as ax:
        for relief in dict.fromkeys(table.relief_um):
            for side in ('drive', 'coast'):
                mask = np.isclose(table.rpm, rpm) & np.isclose(table.tangent_deg, tangent) & (table.side == side)
                mask &= table.relief_um == relief
                curve(ax, table.time_ms[mask], table.sigma_mpa[mask], reliefs.style(relief))
                curve(ax, table.time_ms[mask], table.static_mpa[mask], {**reliefs.style(relief), **FINE})
        ax.axhline(0, color=GREY, linewidth=0.4, zorder=0)
        reliefs.legend(ax, [Line2D([], [], color=GREY, label='motion'), Line2D([], [], color=GREY, label='at rest', **FINE)])
        ax.set_xlabel(f'Time at {rpm:g} 1/min (ms)')
        ax.set_ylabel(f'Stress at the {tangent:g}° tangents (MPa)')
    return ax


def plot_transient_peaks(peaks: Study | Table, ax: Axes | None = None) -> Axes:
    """Draws the largest tension and compression of the fillets over speed, for each relief; fine lines are for the load at rest.

    Parameters
    ----------
    peaks : Study or Table
        A study, or its table `transient_peaks`.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.

    Returns
    -------
    Axes
    """
    peaks = table_of(peaks, 'transient_peaks')
    reliefs = Reliefs(peaks.case)
    order = np.argsort(peaks.rpm)
    with canvas(ax) as ax:
        for i, relief in enumerate(peaks.relief_um):
            for column in ('tension_mpa', 'compression_mpa'):
                curve(ax, peaks.rpm[order], peaks[column][i][order], reliefs.style(relief))
                if len(order) < 20:
                    ax.plot(peaks.rpm, peaks[column][i], 'o', color=reliefs.style(relief)['color'], markersize=2.5)
                curve(ax, peaks.rpm[order], peaks[f'static_{column}'][i][order], {**reliefs.style(relief), **FINE})
        ax.axhline(0, color=GREY, linewidth=0.4, zorder=0)
        reliefs.legend(ax, [Line2D([], [], color=GREY, label='motion'), Line2D([], [], color=GREY, label='at rest', **FINE)])
        over_speeds(ax, peaks.rpm)
        ax.set_ylabel('Largest root stress (MPa)')
    return ax
