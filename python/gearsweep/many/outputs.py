"""What is taken of each variant: columns of tables, and numbers that the caller's own function makes of a study."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._library import Error
from ..study import Study
from ..table import ROW, Table, meant

Reals = NDArray[np.float64]
Reduce = Callable[[Study], Mapping[str, Any]]
OTHER_INDEX = 'table {}: the values of {} are not those of the other variants; take another column, or give reduce'


@dataclass(frozen=True)
class Output:
    """A column that is taken, without the dimensions that have one place only.

    Attributes
    ----------
    name : str
        'table.column', or what `reduce` calls it.
    dims : tuple of str
    shape : tuple of int
    unit, meaning : str
    """

    name: str
    dims: tuple[str, ...]
    shape: tuple[int, ...]
    unit: str = ''
    meaning: str = ''


@dataclass(frozen=True)
class Taken:
    """All that is taken of a study.

    Attributes
    ----------
    columns : tuple of Output
        Of tables.
    reduced : tuple of Output
        Of `reduce`.
    coordinates : dict
        By dimension: the table that it is first told of, its values, which must be those of each table that has it in each variant, and
        their unit.
    """

    columns: tuple[Output, ...]
    reduced: tuple[Output, ...]
    coordinates: dict[str, tuple[str, NDArray[Any], str]]

    def of(self, study: Study, numbers: Mapping[str, Reals]) -> dict[str, Reals]:
        """The numbers of a variant, with those that `reduce` gives.

        Raises
        ------
        Error
            Its results have other index columns than those of the first.
        """
        found = {}
        for table, column, dim in self._indexed():
            if not np.array_equal(study[table][column], self.coordinates[dim][1]):
                raise Error(OTHER_INDEX.format(table, column))
        for one in self.columns:
            table, _, column = one.name.partition('.')
            found[one.name] = _shaped(one, study[table][column])
        if set(numbers) != {one.name for one in self.reduced}:
            raise Error(f'reduce: gives {", ".join(sorted(numbers))}; of the first variant it gave other numbers')
        return found | {one.name: _shaped(one, numbers[one.name]) for one in self.reduced}

    def same(self, other: Taken) -> bool:
        """Are these columns of the same shapes, over the same index values?"""
        return (self.columns, self.reduced, [*self.coordinates]) == (other.columns, other.reduced, [*other.coordinates]) and all(
            np.array_equal(one[1], two[1]) for one, two in zip(self.coordinates.values(), other.coordinates.values())
        )

    def _indexed(self) -> list[tuple[str, str, str]]:
        """Table, index column and dimension of all that is taken, each once: tables may share a dimension."""
        return list(dict.fromkeys((one.name.partition('.')[0], dim.rpartition('.')[2], dim) for one in self.columns for dim in one.dims))

    def indices(self) -> dict[str, Reals] | None:
        """By 'table.column', the index columns of what is taken with a value for each of its rows; None where one has words."""
        found = {}
        for one in self.columns:
            for at, dim in enumerate(one.dims):
                values = self.coordinates[dim][1]
                if values.dtype.kind not in 'iuf':
                    return None
                along = values.astype(float).reshape([-1 if axis == at else 1 for axis in range(len(one.dims))])
                found[f'{one.name.partition(".")[0]}.{dim.rpartition(".")[2]}'] = np.broadcast_to(along, one.shape).ravel()
        return found


def _shaped(one: Output, values: Any) -> Reals:
    found = np.asarray(values, float)
    if found.size != math.prod(one.shape):
        raise Error(f'{one.name}: has {found.size} numbers, of the other variants {math.prod(one.shape)}')
    return found.reshape(one.shape)


def taken(study: Study, take: Sequence[str], numbers: Mapping[str, Reals]) -> Taken:
    """What the columns 'table.column' are like, and the numbers that `reduce` gives, by the study of one variant.

    Raises
    ------
    Error
        There is no such column, or it has words, or as many rows as come out.
    """
    coordinates: dict[str, tuple[str, NDArray[Any], str]] = {}
    columns = tuple(_column(study, name, coordinates) for name in take)
    reduced = tuple(Output(name, tuple(f'{name}.{at}' for at in range(one.ndim)), one.shape) for name, one in numbers.items())
    return Taken(columns, reduced, coordinates)


def _column(study: Study, name: str, coordinates: dict[str, tuple[str, NDArray[Any], str]]) -> Output:
    table_name, _, column = name.partition('.')
    if table_name not in study:
        raise Error(f"take: {name}: the case has no table {table_name}{meant(table_name, study.tables)}; the case asks for {', '.join(study.case.tasks)}")
    table = study[table_name]
    if column not in table:
        raise Error(f'take: {name}: the table {table_name} has no column {column}{meant(column, table)}')
    values = np.asarray(table[column])
    if values.dtype.kind == 'U':
        raise Error(f'take: {name}: has words; take a column of numbers, or give reduce')
    dims = table.dims[column]
    if ROW in dims:
        raise Error(f'take: {name}: the table {table_name} has as many rows as come out of a variant; give reduce, which makes numbers of them')
    named = tuple((_named(table, dim, coordinates), size) for dim, size in zip(dims, values.shape) if size > 1)
    return Output(name, tuple(dim for dim, _ in named), tuple(size for _, size in named), table.units[column], table.meanings[column])


def _named(table: Table, dim: str, coordinates: dict[str, tuple[str, NDArray[Any], str]]) -> str:
    """The name of a dimension: its own, unless another table has one of this name with other values."""
    values = np.asarray(table[dim])
    name = dim if dim not in coordinates or np.array_equal(coordinates[dim][1], values) else f'{table.name}.{dim}'
    coordinates.setdefault(name, (table.name, values, table.units[dim]))
    return name
