"""Reads a store: its arrays, the variants that failed, and the case of a variant."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import numpy as np

from ..core.case import Case
from ..core.library import Error
from . import store as stores
from .inputs import Key, case_with
from .status import Status
from .store import STATUS, Store

if TYPE_CHECKING:
    import pandas
    import xarray


def open(path: str | os.PathLike) -> xarray.Dataset:
    """Opens a store, also while it is written: outputs and `status` over the dimension `variant`, with the varied keys as
    coordinates. The attributes of `status` explain its integers.

    Values are read from the files on access. `attrs` have the plan as stored.

    Raises
    ------
    Error
        There is no such store.
    """
    return dataset(stores.read(path))


def dataset(store: Store) -> xarray.Dataset:
    """Builds a Dataset of the arrays of a store."""
    import xarray
    from xarray.core import indexing

    class Lazy(xarray.backends.BackendArray):
        """Values that are read on access, with an `Error` if they are damaged."""

        def __init__(self, name: str):
            self.name, self.shape, self.dtype = name, store.group[name].shape, store.group[name].dtype

        def __getitem__(self, key: indexing.ExplicitIndexer) -> np.ndarray:
            return indexing.explicit_indexing_adapter(key, self.shape, indexing.IndexingSupport.OUTER, lambda at: store.values(self.name, at))

    def variable(name: str) -> xarray.Variable:
        array = store.group[name]
        values = indexing.MemoryCachedArray(indexing.LazilyIndexedArray(Lazy(name)))
        return xarray.Variable(array.metadata.dimension_names, values, dict(array.attrs))

    about = store.about
    plan = about['plan']
    names = [*(one['name'] for one in store.outputs()), STATUS]
    keys = {name: variable(name) for name in about['names']}
    along = {name: (name, store.along(name), {'units': one['unit']}) for name, one in about['coordinates'].items()}
    data = xarray.Dataset({name: variable(name) for name in names}, keys | along)
    if not store.path:
        data = data.load()
    data.attrs = {'store': store.path, 'mark': about['mark'], 'kind': plan['kind'], 'seed': plan['seed'], 'version': plan['version'],
                  'OpenBLAS kernel': plan['OpenBLAS kernel'], 'inputs': list(about['names'])}  # fmt: skip
    return data


def failures(path: str | os.PathLike) -> pandas.DataFrame:
    """Returns the variants without a complete result: variant, status, message, and the values of the keys.

    Raises
    ------
    Error
        There is no such store.
    """
    import pandas

    store = stores.read(path)
    status = store.status()
    bad = np.flatnonzero((status != Status.PENDING) & (status != Status.OK))
    messages = [stores.message(row) for row in store.values(stores.MESSAGE, bad)] if bad.size else []
    rows = [
        {'variant': int(at), 'status': Status(status[at]).name.lower(), 'message': message}
        | {key.name: key.formatted(value) for key, value in zip(_keys(store), values)}
        for at, message, values in zip(bad, messages, _values(store, bad))
    ]
    return pandas.DataFrame(rows, columns=['variant', 'status', 'message', *store.about['names']])


def case_of(path: str | os.PathLike, variant: int) -> Case:
    """Returns the case of a finished variant, for a run of its own.

    Raises
    ------
    Error
        There is no such store or variant, or it is not finished.
    """
    store = stores.read(path)
    if isinstance(variant, bool) or not isinstance(variant, (int, np.integer)):
        raise Error(f'variant {variant!r}: must be a whole number')
    if not 0 <= variant < store.n or not store.status()[variant]:
        raise Error(f'{store.path}: variant {variant} is not there')
    base = Case(store.about['plan']['case'], store.about['folder'])
    return case_with(base, _keys(store), _values(store, np.array([variant]))[0])


def _keys(store: Store) -> list[Key]:
    return [Key(one['group'], one['key'], one['whole'], None if one['choices'] is None else tuple(one['choices']))
            for one in store.about['keys']]  # fmt: skip


def _values(store: Store, at: np.ndarray) -> np.ndarray:
    return np.column_stack([store.values(name, at) for name in store.about['names']]) if at.size else np.empty((0, 0))


def counts(data: xarray.Dataset) -> dict[str, int]:
    """Counts the variants by status."""
    status = data.status.values
    return {one.name.lower(): int((status == one).sum()) for one in Status if (status == one).any()}
