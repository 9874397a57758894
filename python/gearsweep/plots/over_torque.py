"""Results of the search for the best relief over torque and relief."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ..core.study import Study
from ..core.table import Table
from .look import ASIDE, INK, canvas, legends_above, line_styles
from .reliefs import study_of, table_of

#: Criteria: column, axis label, and words.
JUDGED = {
    'dynamic_factor': ('worst_dynamic_factor', 'Largest dynamic factor (–)', 'largest dynamic factor'),
    'ste_peak_to_peak': ('ste_peak_to_peak_um', 'Peak-to-peak STE (µm)', 'peak-to-peak STE'),
    'mesh_harmonic': ('mesh_harmonic_um', 'Harmonic of the STE (µm)', 'harmonic of the STE'),
    'dte_rms': ('dte_rms_um', 'DTE, rms over the speeds (µm)', 'rms of the DTE'),
}

#: Number of reliefs, in about equal steps, with a curve in addition to the best.
CURVES = 6


def plot_torques(found: Study | Table, ax: Axes | None = None, *, quantity: str | None = None) -> Axes:
    """Draws transmission error or dynamic factor over torque, a curve for each of some reliefs; the best relief has the thick
    line.

    Parameters
    ----------
    found : Study or Table
        A study, or its table `optimum_map`.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.
    quantity : str, optional
        'dynamic_factor', 'ste_peak_to_peak', 'mesh_harmonic' or 'dte_rms'; otherwise what was judged.

    Returns
    -------
    Axes

    Raises
    ------
    ValueError
        The study has no such quantity.
    """
    table, values, label = _chosen(found, quantity)
    relief, torque, order = table.relief_um, table.torque_nm, np.argsort(table.torque_nm)
    best = study_of(found).optimum.relief_um
    steps = np.linspace(0, relief.max(), CURVES + 1)
    # A curve close to that of the best would hide it.
    places = np.unique([np.abs(relief - place).argmin() for place in steps if not abs(place - best) < steps[1] / 4])
    with canvas(ax) as ax:
        handles = []
        for place, look in zip(places, line_styles(len(places))):
            handles += ax.plot(torque[order], values[place, order], marker='o', markersize=2.5, label=f'{relief[place]:.3g}', **look)
        if np.isfinite(best):
            place = np.abs(relief - best).argmin()
            handles += ax.plot(torque[order], values[place, order], color=INK, linewidth=2, marker='o', markersize=3, label=f'{best:.4g} (best)')
        legends_above(ax, ('Tip relief (µm)', handles))
        ax.set_ylim(bottom=0 if 'µm' in label else None)
        ax.set_xlabel('Torque on the pinion (N m)')
        ax.set_ylabel(label)
    return ax


def plot_optimum_map(found: Study | Table, ax: Axes | None = None, *, quantity: str | None = None) -> Axes:
    """Draws transmission error or dynamic factor over torque and relief, with the best relief and, as dots, the best at each
    torque.

    Parameters
    ----------
    found : Study or Table
        A study, or its table `optimum_map`.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.
    quantity : str, optional
        As in `plot_torques`.

    Returns
    -------
    Axes

    Raises
    ------
    ValueError
        The study has no such quantity, or one torque only.
    """
    table, values, label = _chosen(found, quantity)
    order = np.argsort(table.torque_nm)
    relief, torque, values = table.relief_um, table.torque_nm[order], values[:, order]
    if len(torque) < 2:
        raise ValueError('a map needs several torques (&load torques_nm)')
    best = study_of(found).optimum.relief_um
    with canvas(ax) as ax:
        shades = ax.contourf(torque, relief, np.ma.masked_invalid(values), levels=14, cmap='viridis')
        marks = [Line2D([], [], **ASIDE, label=f'best, {best:.4g} µm')] if np.isfinite(best) else []
        if marks:
            ax.axhline(best, **ASIDE)
        known = np.isfinite(values).any(axis=0)
        least = relief[np.argmin(np.where(np.isfinite(values[:, known]), values[:, known], np.inf), axis=0)]
        marks += ax.plot(torque[known], least, 'o', color='white', markeredgecolor=INK, markersize=4, clip_on=False, zorder=4, label='best computed at each torque')
        bar = ax.figure.colorbar(shades, ax=ax, label=label, pad=0.02, aspect=30)
        bar.outline.set_linewidth(0.6)
        legends_above(ax, ('', marks))
        ax.set_xlabel('Torque on the pinion (N m)')
        ax.set_ylabel('Tip relief (µm)')
    return ax


def _chosen(found: Study | Table, quantity: str | None) -> tuple[Table, np.ndarray, str]:
    """Returns the map, its values (relief, torque) without mere bounds, and the label of their axis."""
    table = table_of(found, 'optimum_map')
    quantity = quantity or str(np.ravel(study_of(found).optimum.judged)[0])
    names = [name for name, (column, *_) in JUDGED.items() if column in table]
    if quantity not in names:
        raise ValueError(f'quantity = {quantity!r}: must be one of {", ".join(names)}')
    column, label, _ = JUDGED[quantity]
    values = table[column]
    if quantity == 'dynamic_factor':
        values = np.where(table.at_least == 0, values, np.nan)
    return table, values, label
