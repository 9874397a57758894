"""The variants of a plan as a function of their values, for packages that choose the values themselves."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .._library import Error, PartialWarning

if TYPE_CHECKING:
    from .plan import Plan

Reals = NDArray[np.float64]


def function(plan: Plan, take: str | Sequence[str], executor: Any, axis: int, seconds: float | None) -> Callable[[Reals], Reals]:
    """f(X) as `Plan.function` describes it."""
    from .plan import Plan
    from .run import TRIED, NoResult, run

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
            if len(rows) > TRIED:  # others may have one
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
