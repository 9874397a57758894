"""The variants of a plan as a function of their values, for packages that choose the values themselves."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.library import Error, PartialWarning
from .plan import Plan
from .run import TRIED, NoResult, run

Reals = NDArray[np.float64]


def function(
    plan: Plan, take: str | Sequence[str], executor: Any = None, *, axis: int = 0, seconds: float | None = None
) -> Callable[[Reals], Reals]:
    """Returns the variants as a function f(X) of the values of `names`, for SALib, SciPy, OpenTURNS and optuna.

    Parameters
    ----------
    take : 'table.column' or several
        A number of each variant, or several.
    executor
        As of `run`.
    axis : {0, 1}
        X has a row for each variant, as SALib and OpenTURNS have it, and f(X) too; 1: a column, as `scipy.stats.sobol_indices`.
    seconds : float, optional
        As of `run`.

    Returns
    -------
    callable
        f(X) of shape (n,), or (n, k) of several columns; with axis 1 (n,) or (k, n). A single row gives a single value. Variants
        without a number are NaN, and a `PartialWarning` reports their number.
    """
    names = [take] if isinstance(take, str) else list(take)
    if axis not in (0, 1):
        raise Error(f'axis = {axis}: must be 0 or 1')

    def answer(x: Reals) -> Reals:
        x = np.asarray(x, float)
        rows = np.atleast_2d(x) if axis == 0 or x.ndim < 2 else x.T
        if rows.ndim != 2 or rows.shape[1] != len(plan.inputs):
            raise Error(f'f(X): X of shape {x.shape}: must have {len(plan.inputs)} values for each variant: {", ".join(plan.names)}')
        table = Plan(plan.base, 'table', plan.inputs, len(rows), values=rows)
        try:
            data = run(table, names, executor=executor, seconds=seconds)
            found = np.column_stack([_scalar(data[name]) for name in names])
        except NoResult:
            if len(rows) > TRIED:  # later ones may have one
                raise
            found = np.full((len(rows), len(names)), np.nan)
        if missing := int(np.isnan(found).any(axis=1).sum()):
            warnings.warn(f'{missing} of {len(rows)} variants have no number', PartialWarning, stacklevel=2)
        found = found[:, 0] if isinstance(take, str) else found if axis == 0 else found.T
        return found[..., 0] if x.ndim < 2 else found

    return answer


def _scalar(column: Any) -> Reals:
    if column.ndim != 1:
        raise Error(f'{column.name}: has {column[0].size} numbers for each variant; a function has one')
    return column.values
