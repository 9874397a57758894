"""Outputs of each variant: columns of tables, and numbers that the caller's function computes from a study."""

from __future__ import annotations

import functools
import hashlib
import math
import os
import types
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.library import Error
from ..core.study import Study
from ..core.table import ROW, Table, suggestion

Reals = NDArray[np.float64]
Reduce = Callable[[Study], Mapping[str, Any]]
OTHER_INDEX = 'table {}: the values of {} are not those of the other variants; use another column, or reduce'


@dataclass(frozen=True)
class Output:
    """A selected column, without dimensions of size 1.

    Attributes
    ----------
    name : str
        'table.column', or its name in `reduce`.
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
class Layout:
    """All outputs of a study.

    Attributes
    ----------
    columns : tuple of Output
        Columns of tables.
    reduced : tuple of Output
        Numbers of `reduce`.
    coordinates : dict
        By dimension: the first table that has it, its values, which must be the same in each table and in each variant, and their
        unit.
    """

    columns: tuple[Output, ...]
    reduced: tuple[Output, ...]
    coordinates: dict[str, tuple[str, NDArray[Any], str]]

    def of(self, study: Study, numbers: Mapping[str, Reals]) -> dict[str, Reals]:
        """Returns the outputs of a variant, with the numbers of `reduce`.

        Raises
        ------
        Error
            Its results have other index columns than those of the first variant.
        """
        found = {}
        for table, column, dim in self._indexed():
            if not np.array_equal(study[table][column], self.coordinates[dim][1]):
                raise Error(OTHER_INDEX.format(table, column))
        for one in self.columns:
            table, _, column = one.name.partition('.')
            found[one.name] = _shaped(one, study[table][column])
        if set(numbers) != {one.name for one in self.reduced}:
            raise Error(f'reduce: returns {", ".join(sorted(numbers))}, for the first variant other numbers')
        return found | {one.name: _shaped(one, numbers[one.name]) for one in self.reduced}

    def same(self, other: Layout) -> bool:
        """True if both have columns of the same shapes, over the same index values."""
        return (self.columns, self.reduced, [*self.coordinates]) == (other.columns, other.reduced, [*other.coordinates]) and all(
            np.array_equal(one[1], two[1]) for one, two in zip(self.coordinates.values(), other.coordinates.values())
        )

    def _indexed(self) -> list[tuple[str, str, str]]:
        """Table, index column and dimension of all outputs, each once: tables may have a common dimension."""
        return list(dict.fromkeys((one.name.partition('.')[0], dim.rpartition('.')[2], dim) for one in self.columns for dim in one.dims))

    def indices(self) -> dict[str, Reals] | None:
        """Returns the index columns of the outputs by 'table.column', with a value for each row; None if one contains words."""
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


def layout_of(study: Study, take: Sequence[str], numbers: Mapping[str, Reals]) -> Layout:
    """Determines shapes and coordinates of the columns 'table.column' and of the numbers of `reduce`, from the study of one
    variant.

    Raises
    ------
    Error
        There is no such column, it has words, or its number of rows varies.
    """
    coordinates: dict[str, tuple[str, NDArray[Any], str]] = {}
    columns = tuple(_column(study, name, coordinates) for name in take)
    reduced = tuple(Output(name, tuple(f'{name}.{at}' for at in range(one.ndim)), one.shape) for name, one in numbers.items())
    return Layout(columns, reduced, coordinates)


def _column(study: Study, name: str, coordinates: dict[str, tuple[str, NDArray[Any], str]]) -> Output:
    table_name, _, column = name.partition('.')
    if table_name not in study:
        raise Error(f"take: {name}: the case has no table {table_name}{suggestion(table_name, study.tables)}; the case asks for {', '.join(study.case.tasks)}")
    table = study[table_name]
    if column not in table:
        raise Error(f'take: {name}: the table {table_name} has no column {column}{suggestion(column, table)}')
    values = np.asarray(table[column])
    if values.dtype.kind == 'U':
        raise Error(f'take: {name}: has words; use a column of numbers, or reduce')
    dims = table.dims[column]
    if ROW in dims:
        raise Error(f'take: {name}: the table {table_name} has another number of rows for each variant; use reduce to compute numbers from it')
    named = tuple((_named(table, dim, coordinates), size) for dim, size in zip(dims, values.shape) if size > 1)
    return Output(name, tuple(dim for dim, _ in named), tuple(size for _, size in named), table.units[column], table.meanings[column])


def _named(table: Table, dim: str, coordinates: dict[str, tuple[str, NDArray[Any], str]]) -> str:
    """Returns the name of a dimension: its own, unless another table has one with this name and other values."""
    values = np.asarray(table[dim])
    name = dim if dim not in coordinates or np.array_equal(coordinates[dim][1], values) else f'{table.name}.{dim}'
    coordinates.setdefault(name, (table.name, values, table.units[dim]))
    return name


def qualified_name(reduce: Any) -> str:
    """Returns the name of a function for later comparison; with some arguments fixed (`functools.partial`), that of the
    function.
    """
    one = getattr(reduce, 'func', reduce)
    return 'None' if one is None else f'{one.__module__}.{getattr(one, "__qualname__", type(one).__name__)}'


def reduce_digest(reduce: Any) -> str:
    """Returns a digest of a function, as far as it is accessible: its code and that of the functions of its module that it calls,
    default values, variables of the enclosing function, constants of its module, and fixed arguments (`functools.partial`).
    """
    return hashlib.sha256(repr(_content(reduce, [])).encode('utf-8', 'surrogateescape')).hexdigest()


def _content(one: Any, enclosing: list[Any]) -> Any:
    """Returns the content of an object, in values that `repr` shows alike in each process."""
    if one is None or isinstance(one, (bool, int, float, complex, str, bytes, np.generic)):
        return repr(one)
    if any(one is other for other in enclosing):
        return 'itself'
    enclosing = [*enclosing, one]
    if isinstance(one, functools.partial):
        return 'partial', _content(one.func, enclosing), _content(one.args, enclosing), _content(one.keywords, enclosing)
    if isinstance(one, types.MethodType):
        return 'method', _content(one.__func__, enclosing), _content(one.__self__, enclosing)
    if isinstance(one, types.FunctionType):
        return _function(one, enclosing)
    if isinstance(one, (list, tuple)):
        return type(one).__name__, [_content(value, enclosing) for value in one]
    if isinstance(one, (set, frozenset)):
        return 'set', sorted(repr(_content(value, enclosing)) for value in one)
    if isinstance(one, Mapping):
        return 'mapping', [(_content(key, enclosing), _content(value, enclosing)) for key, value in one.items()]
    if isinstance(one, np.ndarray) and one.dtype != object:
        return str(one.dtype), one.shape, hashlib.sha256(one.tobytes()).hexdigest()
    if isinstance(one, os.PathLike):
        return os.fspath(one)
    if isinstance(one, (type, types.ModuleType, types.BuiltinFunctionType)):
        return one.__name__
    call = vars(type(one)).get('__call__')
    return type(one).__qualname__, _content(call, enclosing) if isinstance(call, types.FunctionType) else '', _content(getattr(one, '__dict__', {}), enclosing)


def _function(one: types.FunctionType, enclosing: list[Any]) -> Any:
    used = sorted(_names(one.__code__) & set(one.__globals__))
    theirs = [(name, one.__globals__[name]) for name in used]
    return (_code(one.__code__), _content(one.__defaults__, enclosing), _content(one.__kwdefaults__, enclosing),
            [_content(cell.cell_contents, enclosing) for cell in one.__closure__ or () if _is_full(cell)],
            [(name, _content(value, enclosing)) for name, value in theirs
             if not isinstance(value, (types.FunctionType, types.ModuleType, type)) or getattr(value, '__module__', '') == one.__module__])  # fmt: skip


def _is_full(cell: Any) -> bool:
    try:
        return cell.cell_contents is not cell
    except ValueError:  # set later, as in a function that calls itself
        return False


def _names(code: types.CodeType) -> set[str]:
    """Names that the code and the functions within it look up."""
    return set(code.co_names).union(*(_names(inner) for inner in code.co_consts if isinstance(inner, types.CodeType)))


def _code(code: types.CodeType) -> Any:
    """Returns the code without its line numbers."""
    constants = [_code(inner) if isinstance(inner, types.CodeType) else repr(sorted(map(repr, inner)) if isinstance(inner, frozenset) else inner)
                 for inner in code.co_consts]  # fmt: skip
    return code.co_code.hex(), constants, code.co_names, code.co_varnames, code.co_freevars
