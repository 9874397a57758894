"""Reads a store: its arrays, the variants that failed, and the case of a variant."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import numpy as np

from .._library import Error
from ..case import Case
from . import store as stores
from .inputs import Key, case_with
from .status import Status
from .store import STATUS, Store

if TYPE_CHECKING:
    import pandas
    import xarray


def open(path: str | os.PathLike) -> xarray.Dataset:
    """What is in a store, also while it is written: inputs, outputs and `status` over the dimension `variant`.

    Values are read from the files when they are asked for. `attrs` have the plan as it is told to the store.

    Raises
    ------
    Error
        There is no such store.
    """
    return dataset(stores.read(path))


def dataset(kept: Store) -> xarray.Dataset:
    """The arrays of a store as a Dataset."""
    import xarray
    from xarray.core import indexing

    class Lazy(xarray.backends.BackendArray):
        """Values that are read when they are asked for, with an `Error` where they are damaged."""

        def __init__(self, name: str):
            self.name, self.shape, self.dtype = name, kept.group[name].shape, kept.group[name].dtype

        def __getitem__(self, key: indexing.ExplicitIndexer) -> np.ndarray:
            return indexing.explicit_indexing_adapter(key, self.shape, indexing.IndexingSupport.OUTER, lambda at: kept.values(self.name, at))

    def variable(name: str) -> xarray.Variable:
        array = kept.group[name]
        values = indexing.MemoryCachedArray(indexing.LazilyIndexedArray(Lazy(name)))
        return xarray.Variable(array.metadata.dimension_names, values, dict(array.attrs))

    about = kept.about
    plan = about['plan']
    names = [*about['names'], *(one['name'] for one in kept.outputs()), STATUS]
    along = {name: (name, kept.along(name), {'units': one['unit']}) for name, one in about['coordinates'].items()}
    data = xarray.Dataset({name: variable(name) for name in names}, along)
    if not kept.path:
        data = data.load()
    data.attrs = {'store': kept.path, 'mark': about['mark'], 'kind': plan['kind'], 'seed': plan['seed'], 'version': plan['version'],
                  'OpenBLAS kernel': plan['OpenBLAS kernel'], 'inputs': list(about['names'])}  # fmt: skip
    return data


def failures(path: str | os.PathLike) -> pandas.DataFrame:
    """The variants that are done but have no plain result, those in part too: variant, status, message, and the values of the keys.

    Raises
    ------
    Error
        There is no such store.
    """
    import pandas

    kept = stores.read(path)
    status = kept.status()
    bad = np.flatnonzero((status != Status.PENDING) & (status != Status.OK))
    rows = [
        {'variant': int(at), 'status': Status(status[at]).name.lower(), 'message': message}
        | {key.name: key.written(value) for key, value in zip(_keys(kept), values)}
        for at, message, values in zip(bad, _messages(kept, bad), _values(kept, bad))
    ]
    return pandas.DataFrame(rows, columns=['variant', 'status', 'message', *kept.about['names']])


def case_of(path: str | os.PathLike, variant: int) -> Case:
    """The case of a variant that is done, to look at it alone.

    Raises
    ------
    Error
        There is no such store or variant, or it is not done.
    """
    kept = stores.read(path)
    if isinstance(variant, bool) or not isinstance(variant, (int, np.integer)):
        raise Error(f'variant {variant!r}: must be a whole number')
    if not 0 <= variant < kept.n or not kept.status()[variant]:
        raise Error(f'{kept.path}: variant {variant} is not there')
    base = Case(kept.about['plan']['case'], kept.about['folder'])
    return case_with(base, _keys(kept), _values(kept, np.array([variant]))[0])


def _keys(kept: Store) -> list[Key]:
    return [Key(one['group'], one['key'], one['whole'], None if one['choices'] is None else tuple(one['choices']))
            for one in kept.about['keys']]  # fmt: skip


def _values(kept: Store, at: np.ndarray) -> np.ndarray:
    return np.column_stack([kept.values(name, at) for name in kept.about['names']]) if at.size else np.empty((0, 0))


def _messages(kept: Store, at: np.ndarray) -> list[str]:
    return [stores.message(row) for row in kept.values(stores.MESSAGE, at)] if at.size else []


def counts(data: xarray.Dataset) -> dict[str, int]:
    """How many variants have which status."""
    status = data.status.values
    return {one.name.lower(): int((status == one).sum()) for one in Status if (status == one).any()}
