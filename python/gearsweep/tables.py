"""Results for pandas and xarray."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import pandas
    import xarray

    from .results import Result


def to_pandas(result: Result) -> pandas.DataFrame:
    """A row for each combination of the dimensions in `result.rows`."""
    import pandas

    sizes = _sizes(result)
    shape = tuple(sizes[dim] for dim in result.rows)
    columns = {}
    for dim in result.rows:
        if dim in result.labels:
            columns[dim] = _spread(np.array(result.labels[dim]), (dim,), result.rows, shape)
    for name, dims in result.dims.items():
        if dims and set(dims) <= set(result.rows):
            columns[name] = _spread(_named(result, name), dims, result.rows, shape)
    table = pandas.DataFrame(columns)
    table.attrs = _about(result) | {'units': {name: result.units[name] for name in columns if name in result.units}}
    return table


def to_xarray(result: Result) -> xarray.Dataset:
    """All arrays; what lies along a dimension alone and has its names is its coordinate."""
    import xarray

    arrays = {
        name: (dims, getattr(result, name), {'units': result.units[name]}) for name, dims in result.dims.items() if dims
    }
    labels = {dim: names for dim, names in result.labels.items() if dim in _sizes(result)}
    return xarray.Dataset(arrays, coords=labels, attrs=_about(result))


def _named(result: Result, name: str) -> np.ndarray:
    """The values, in words where the result has words for them."""
    return getattr(result, f'{name}_name', getattr(result, name))


def _spread(values: np.ndarray, dims: tuple, rows: tuple, shape: tuple) -> np.ndarray:
    """The values for each row, first dimension outermost."""
    order = [dims.index(dim) for dim in rows if dim in dims]
    place = tuple(size if dim in dims else 1 for dim, size in zip(rows, shape))
    return np.broadcast_to(values.transpose(order).reshape(place), shape).reshape(-1)


def _sizes(result: Result) -> dict[str, int]:
    return {dim: n for name, dims in result.dims.items() for dim, n in zip(dims, np.shape(getattr(result, name)))}


def _about(result: Result) -> dict:
    """Single numbers, the case and the version."""
    numbers = {name: getattr(result, name) for name, dims in result.dims.items() if not dims}
    return numbers | {'case': str(result.case), 'version': result.version}
