"""The dynamic factor of ISO 6336 by its Methods A and B."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ..core.study import Study
from ..core.table import Table
from .look import ACCENT, FAINT, FINE, GREY, canvas, legends_above, over_speeds
from .over_speed import curve
from .reliefs import Reliefs, table_of


def plot_rating(dynamic: Study | Table, ax: Axes | None = None) -> Axes:
    """Draws the dynamic factor over speed for each relief: by Method A, from the motion, and as a thin line by Method B.

    A single speed is drawn as bars over the reliefs.

    Parameters
    ----------
    dynamic : Study or Table
        A study, or its table `dynamic_factors`.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.

    Returns
    -------
    Axes
    """
    dynamic = table_of(dynamic, 'dynamic_factors')
    reliefs = Reliefs(dynamic.case)
    methods = [(dynamic.dynamic_factor_a, 'Method A: motion', {}), (dynamic.dynamic_factor_b, 'Method B', FINE)]
    with canvas(ax) as ax:
        ax.set_ylabel('Dynamic factor $K_v$ (–)')
        if len(dynamic.rpm) == 1:
            places = np.arange(len(reliefs.amounts))
            for (values, name, _), shift, color in zip(methods, (-0.2, 0.2), (ACCENT, FAINT)):
                ax.bar_label(ax.bar(places + shift, values[:, 0], 0.38, color=color, label=name), fmt='%.3f', fontsize=7)
            ax.margins(y=0.1)
            legends_above(ax, ('', ax.get_legend_handles_labels()[0]))
            ax.set_xticks(places, [f'{amount:g}' for amount in reliefs.amounts])
            ax.set_xlabel(f'Tip relief at {dynamic.rpm[0]:g} 1/min (µm)')
            return ax
        for values, _, more in methods:
            if (values == values[0]).all():  # like Method B if relief has no effect
                curve(ax, dynamic.rpm, values[0], {'color': GREY, **more})
                continue
            for factor, look in zip(values, reliefs.styles):
                curve(ax, dynamic.rpm, factor, {**look, **more})
        reliefs.legend(ax, [Line2D([], [], color=GREY, label=name, **more) for _, name, more in methods])
        over_speeds(ax, dynamic.rpm)
    return ax
