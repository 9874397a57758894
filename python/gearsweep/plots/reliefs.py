"""Curves for the reliefs of a case: the same order, colours and dashes in all pictures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from ..core.case import Case
from ..core.study import Study
from ..core.table import Table
from .look import CROSS, GREY, legends_above, line_styles

Reals = NDArray[np.float64]
Integers = NDArray[np.int64]


def table_of(result: Study | Table, name: str) -> Table:
    """Returns the table with this name of a study, or the table that was passed."""
    return result[name] if isinstance(result, Study) else result


def study_of(result: Study | Table) -> Study:
    """Returns the study that was passed, or that of the table."""
    return result if isinstance(result, Study) else result.study


class Reliefs:
    """Reliefs (um) of a case, each with its line style."""

    def __init__(self, case: Case):
        self.amounts = np.atleast_1d(case.get('relief', 'amount_um', 0))
        self.styles = line_styles(len(self.amounts))

    def index(self, relief: float) -> int:
        """Returns the index of a relief, from 0."""
        return int(np.abs(self.amounts - relief).argmin())

    def style(self, relief: float) -> dict[str, Any]:
        return self.styles[self.index(relief)]

    def legend(self, ax: Axes, more: Sequence[Artist], gap: float = 0, *, filled: bool = False) -> None:
        """Adds the legend of the reliefs, as lines or as areas, unless there is none; and the marks in `more`."""
        handles = [
            Patch(color=look['color'], label=f'{amount:g}') if filled else Line2D([], [], label=f'{amount:g}', **look)
            for amount, look in zip(self.amounts, self.styles)
        ]
        legends_above(ax, ('Tip relief (µm)', handles if self.amounts.any() else []), ('', more), gap=gap)


def unanswered(amounts: Sequence[str]) -> list[Artist]:
    """Legend entry for reliefs (µm) without a converged result."""
    if not amounts:
        return []
    return [Line2D([], [], **CROSS, markeredgecolor=GREY, label=f'no answer: {", ".join(amounts)} µm')]


def paths(s: Reals, *columns: Reals) -> list[tuple[Reals, ...]]:
    """Splits the rows of successive paths where the path coordinate restarts."""
    if not s.size:
        return []
    starts = np.flatnonzero(np.diff(s) < -0.5 * np.ptp(s)) + 1
    return list(zip(*(np.split(column, starts) for column in (s, *columns))))
