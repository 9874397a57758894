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

from ..case import Case
from ..study import Study
from ..table import Table
from .look import CROSS, GREY, legends_above, line_styles

Reals = NDArray[np.float64]
Integers = NDArray[np.int64]


def table_of(result: Study | Table, name: str) -> Table:
    """The table of this name of a study, or the table that is given."""
    return result[name] if isinstance(result, Study) else result


def study_of(result: Study | Table) -> Study:
    """The study, or that of the table, which is given."""
    return result if isinstance(result, Study) else result.study


class Reliefs:
    """The reliefs (um) that a case lists, each with its line style."""

    def __init__(self, case: Case):
        self.amounts = np.atleast_1d(case.get('relief', 'amount_um', 0))
        self.styles = line_styles(len(self.amounts))

    def index(self, relief: float) -> int:
        """Which of them this is, from 0."""
        return int(np.abs(self.amounts - relief).argmin())

    def style(self, relief: float) -> dict[str, Any]:
        return self.styles[self.index(relief)]

    def legend(self, ax: Axes, more: Sequence[Artist], gap: float = 0, *, filled: bool = False) -> None:
        """Names the reliefs, as lines or as filled, unless there is none; and the marks in `more`."""
        handles = [
            Patch(color=look['color'], label=f'{amount:g}') if filled else Line2D([], [], label=f'{amount:g}', **look)
            for amount, look in zip(self.amounts, self.styles)
        ]
        legends_above(ax, ('Tip relief (µm)', handles if self.amounts.any() else []), ('', more), gap=gap)


def unanswered(amounts: Sequence[str]) -> list[Artist]:
    """What a legend says of the reliefs (µm) without an answer, which have no curve."""
    if not amounts:
        return []
    return [Line2D([], [], **CROSS, markeredgecolor=GREY, label=f'no answer: {", ".join(amounts)} µm')]


def paths(s: Reals, *columns: Reals) -> list[tuple[Reals, ...]]:
    """Rows of several paths after each other, cut where the path coordinate starts anew."""
    if not s.size:
        return []
    starts = np.flatnonzero(np.diff(s) < -0.5 * np.ptp(s)) + 1
    return list(zip(*(np.split(column, starts) for column in (s, *columns))))
