"""One result of several studies in one picture."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes

from ..core.study import Study
from ..core.table import Table
from ..core.texts import escaped
from .look import canvas, legends_above, line_styles

#: Axis labels of columns whose names are not enough.
NAMES = {'rpm': 'Speed of the pinion', 's': 'Path coordinate s', 'relief_um': 'Tip relief', 'ste_um': 'Static transmission error'}
UNITS = {'': '–', 's': 'base pitches'}


def compare(studies: Mapping[str, Study], table: str, column: str, ax: Axes | None = None, **where: float | str) -> Axes:
    """Draws a column of a table of several studies, a curve for each, over the index column that varies; harmonics as bars.

    Parameters
    ----------
    studies : mapping of str to Study
        What the legend calls each study, and the study.
    table, column : str
        What is drawn, such as 'sweep' and 'dynamic_factor'.
    ax : Axes, optional
        Axes to draw into; otherwise a figure is made.
    **where : float or str
        Values of other index columns, as in `relief_um=0`; the closest that a table has.

    Returns
    -------
    Axes

    Raises
    ------
    ValueError
        Not exactly one index column of a table varies.

    Examples
    --------
    >>> import gearsweep
    >>> case = gearsweep.Case("&pair module_mm = 3 face_width_mm = 20 / &pinion teeth = 21 / &gear teeth = 34 /"
    ...                       "&load torque_nm = 100 / &mesh model = 'weber' /")
    >>> studies = {f'{x} degrees': gearsweep.run(case.changed(pair={'pressure_angle_deg': x}), 'mesh') for x in (20, 25)}
    >>> ax = gearsweep.plots.compare(studies, 'mesh', 'ste_um')
    >>> ax.get_ylabel(), len(ax.lines)
    ('Static transmission error (µm)', 2)
    """
    with canvas(ax) as ax:
        for i, ((name, study), look) in enumerate(zip(studies.items(), line_styles(len(studies)))):
            part = study[table].at(**where)
            varying = [index for index in part._index if len(np.unique(part._read(index))) > 1]
            if len(varying) != 1:
                known = f'; say a value of all but one of {", ".join(varying)}' if varying else ''
                raise ValueError(f'{table} of {name}: one index column must vary, not {len(varying)}{known}')
            x, y = part._read(varying[0]), part._read(column)
            if varying[0] == 'harmonic':  # 0 is the mean
                width = 0.84 / max(2, len(studies))
                shift = width * (i - (len(studies) - 1) / 2)
                ax.bar(x[x > 0] + shift, y[x > 0], 0.94 * width, color=look['color'], label=escaped(str(name)))
            else:
                ax.plot(x, y, label=escaped(str(name)), **look)
            ax.set_xlabel(labelled(part, varying[0]))
            ax.set_ylabel(labelled(part, column))
        legends_above(ax, ('', ax.get_legend_handles_labels()[0]))
    return ax


def labelled(table: Table, column: str) -> str:
    """Axis label with name and unit of a column."""
    unit, words = table.units[column], column.split('_')
    letters = re.sub(r'\W', '', unit.lower())
    for n in range(1, len(words)):
        if ''.join(words[-n:]) == letters:
            words = words[:-n]
            break
    name = NAMES.get(column) or ' '.join(words).capitalize()
    return f'{name} ({UNITS.get(column if column in UNITS else unit, unit.replace("um", "µm"))})'
