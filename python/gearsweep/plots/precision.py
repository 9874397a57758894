"""Error against run time, for the quantities of the case."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import NullFormatter

from ..core.study import Study
from ..core.table import Table
from .look import ASIDE, BLUE, GREY, HOLLOW, INK, ORANGE, SKY, WINE, canvas, legends_above
from .reliefs import study_of

#: Titles of the panels, and their names in the column quantity.
PANELS = {
    'Dynamic factor': ('dynamic_factor',),
    'Harmonics of the static transmission error': ('ste_harmonic',),
    'Finite elements': ('natural_frequency', 'root_tension', 'pair_stiffness'),
}
COLOURS = (BLUE, ORANGE, SKY, WINE)
MARKS = ('o', 's', '^', 'D')


def plot_precision(precision: Study | Table, ax: Axes | None = None, *, quantities: Sequence[str] = ('dynamic_factor',),
                   title: str = '') -> Axes:  # fmt: skip
    """Draws the relative error over run time, a curve for each method; open marks are the method's own estimates.

    For several speeds, reliefs, harmonics or modes the largest error is drawn. The horizontal line is the estimated error of the
    reference; errors below it have no meaning.

    Parameters
    ----------
    precision : Study or Table
        A study, or its table `precision`.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.
    quantities : sequence of str
        Words of the column `quantity`, such as 'dynamic_factor'.
    title : str
        Above the legend.

    Returns
    -------
    Axes
    """
    study = study_of(precision)
    shown, reference = study.precision, study.precision_finest
    curves = [
        (quantity, method)
        for quantity in quantities
        for method in dict.fromkeys(shown.method[shown.quantity == quantity])
    ]  # fmt: skip
    with canvas(ax) as ax:
        ax.set_xscale('log')
        ax.set_yscale('log')
        ax.xaxis.set_minor_formatter(NullFormatter())
        ax.yaxis.set_minor_formatter(NullFormatter())
        for (quantity, method), colour, mark in zip(curves, COLOURS, MARKS):
            mine = (shown.quantity == quantity) & (shown.method == method)
            seconds, error, estimate = worst(shown, mine)
            label = method if len(quantities) == 1 else quantity.replace('_', ' ')
            ax.plot(seconds, error, color=colour, marker=mark, markersize=3, label=label)
            if np.isfinite(estimate).any():
                style = HOLLOW | {'linestyle': (0, (2, 2)), 'linewidth': 0.7}
                ax.plot(seconds, estimate, color=colour, marker=mark, **style)
        for quantity, colour in zip(quantities, COLOURS):
            known = reference.error_estimate[reference.quantity == quantity]
            if np.isfinite(known).any():
                ax.axhline(max(np.nanmax(known), 1e-17), color=colour if len(quantities) > 1 else GREY, linewidth=0.5, zorder=0)
        ax.set_xlabel('Run time (s)')
        ax.set_ylabel('Relative error (–)')
        estimates = Line2D([], [], color=INK, marker='o', **(HOLLOW | {'linestyle': ASIDE['linestyle'], 'linewidth': 0.7}))
        limit = Line2D([], [], color=GREY, linewidth=0.7)
        estimates.set_label('estimate')
        limit.set_label('reference')
        legends_above(ax, (title, [*ax.get_legend_handles_labels()[0], estimates, limit]))
    return ax


def worst(shown: Table, mine: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Returns, for each resolution, mean run time, largest error and largest estimate; NaN if none is known."""
    levels = np.unique(shown.resolution[mine])
    found = np.full((3, len(levels)), np.nan)
    for i, level in enumerate(levels):
        mask = mine & (shown.resolution == level)
        found[0, i] = shown.run_time_s[mask].mean()
        for k, column in enumerate((shown.error, shown.error_estimate), start=1):
            if np.isfinite(column[mask]).any():
                # An error of 0 has no place on a logarithmic axis.
                found[k, i] = max(np.nanmax(column[mask]), 1e-17)
    return found[0], found[1], found[2]
