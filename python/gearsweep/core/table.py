"""A result as a table: one class for all results."""

from __future__ import annotations

import difflib
import html
import importlib
import os
from collections.abc import Callable, Iterator
from operator import itemgetter
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import pandas
    import xarray

    from .study import Study

#: Dimension of the rows of a table that is no grid of its index columns.
ROW = 'row'
#: Names of columns in earlier versions, and their present ones.
FORMER = {'member': 'gear'}
_MOST = 5  # most values in a line
_FEW_ROWS = 12  # most numbers of a column in the display of a table


def _installed(package):
    """Imports an optional package."""
    try:
        return importlib.import_module(package)
    except ModuleNotFoundError:
        raise ModuleNotFoundError(f"{package} is not installed: pip install 'gearsweep[tables]' has it", name=package) from None


class Table:
    """A table of results: its columns are read-only NumPy arrays, under their names.

    If the rows are all combinations of the index columns, arrays have a dimension for each of these, in their order, and an index
    column has its own dimension only. Otherwise all arrays have one element a row. A table of one row without index columns has
    plain numbers.

    Attributes
    ----------
    name, meaning : str
        Name, as in the files and in all languages; meaning of a row.
    rows : int
        Number of rows.
    units, meanings : dict
        By column: the unit, empty for plain numbers, and the meaning.
    is_reproducible : dict
        By column: true if the same case has the same bits in every run, unlike run times.
    dims : dict
        By column: the names of its dimensions.
    grid : str
        For fields: the table of their nodes or elements. Otherwise empty.
    study : Study
        Study of the table, with its case and version.

    Examples
    --------
    >>> import gearsweep
    >>> case = gearsweep.Case('''&pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 0.8 /
    ...     &load normal_force_n = 7000 / &relief amount_um = 0, 10 /
    ...     &mesh model = 'polynomial' contact_ratio = 1.6 coefficients = 400, 0, -120 /
    ...     &sweep rpm_first = 8000 rpm_last = 16000 rpm_step = 100 /''')
    >>> sweep = gearsweep.run(case, 'sweep').sweep
    >>> sweep.dynamic_factor.shape, sweep.dims['dynamic_factor'], sweep.units['rpm']
    ((2, 81), ('relief_um', 'rpm'), '1/min')
    >>> sweep.at(relief_um=0, rpm=13700).status
    'ok'
    """

    def __init__(self, study: Study, about: dict[str, Any], read: Callable[[str], np.ndarray]):
        self._study = study
        self._about = about
        self._read = read
        self._columns = {column['name']: column for column in about['columns']}

    name = property(lambda self: self._about['name'])
    meaning = property(lambda self: self._about['meaning'])
    rows = property(lambda self: self._about['rows'])
    grid = property(lambda self: self._about['grid'])
    study = property(lambda self: self._study)
    case = property(lambda self: self._study.case)
    version = property(lambda self: self._study.version)
    units = property(lambda self: {name: column['unit'] for name, column in self._columns.items()})
    meanings = property(lambda self: {name: column['meaning'] for name, column in self._columns.items()})
    is_reproducible = property(lambda self: {name: column.get('reproducible', True) for name, column in self._columns.items()})

    @property
    def dims(self) -> dict[str, tuple[str, ...]]:
        all_dims = tuple(self._sizes)
        return {name: (name,) if name in all_dims else all_dims for name in self._columns}

    @property
    def _index(self) -> list[str]:
        return [name for name, column in self._columns.items() if column['index']]

    @property
    def _sizes(self) -> dict[str, int]:
        """Size of each dimension."""
        if self._about['extent'] is not None and self.rows > 0:
            return dict(zip(self._index, self._about['extent']))
        return {ROW: self.rows} if self._index or self.rows != 1 else {}

    def __getattr__(self, name: str) -> Any:
        if name.startswith('_'):
            raise AttributeError(name)
        if name not in self._columns:
            raise AttributeError(f'the table {self.name} has no column {name}{suggestion(name, self._columns)}')
        sizes = self._sizes
        values = self._read(name).reshape(tuple(sizes.values()))
        if name in sizes:
            along = list(sizes).index(name)
            values = values[(0,) * along + (slice(None),) + (0,) * (len(sizes) - along - 1)]
        values.setflags(write=False)
        return values if values.ndim else values.item()

    def __getitem__(self, name: str) -> Any:
        if name not in self._columns:
            raise KeyError(f'the table {self.name} has no column {name}{suggestion(name, self._columns)}')
        return getattr(self, name)

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __contains__(self, name: object) -> bool:
        return name in self._columns

    def __len__(self) -> int:
        return self.rows

    def __dir__(self) -> list[str]:
        return sorted({*(name for name in dir(type(self)) if not name.startswith('_')), *self._columns})

    def at(self, **where: float | str) -> Table:
        """Selects the rows at these values of index columns, or at the closest ones: `sweep.at(rpm=1600, relief_um=0)`.

        Each loses its dimension, so that with all of them columns are plain numbers.
        """
        rows = np.ones(self.rows, bool)
        for name, value in where.items():
            if name not in self._index:
                raise TypeError(f'the table {self.name} has no index column {name}{suggestion(name, self._index)}')
            labels = self._read(name)
            if labels.dtype.kind == 'U':
                if value not in labels:
                    raise ValueError(f'{name} = {value!r}: must be one of {", ".join(map(repr, dict.fromkeys(labels.tolist())))}')
                rows &= labels == value
            elif labels.size:
                distance = np.where(np.isnan(labels), np.inf, np.abs(labels - value))
                rows &= distance == distance.min()
        columns = [column | {'index': column['index'] and column['name'] not in where} for column in self._about['columns']]
        extent = self._about['extent']
        if extent is not None:
            extent = [size for name, size in self._sizes.items() if name not in where]
        about = self._about | {'columns': columns, 'extent': extent, 'rows': int(rows.sum())}
        return Table(self._study, about, lambda name: self._read(name)[rows])

    def __repr__(self) -> str:
        lines = [(name, unit, values, meaning) for name, unit, values, meaning in self._lines()]
        wide = [max(len(line[i]) for line in lines) for i in range(3)]
        body = [f'  {line[0]:{wide[0]}}  {line[1]:{wide[1]}}  {line[2]:{wide[2]}}  {line[3]}'.rstrip() for line in lines]
        return '\n'.join([f'<gearsweep.Table {self.name}: {self.meaning}', *body]) + '>'

    def _repr_html_(self) -> str:
        return as_html(f'{self.name}: {self.meaning}', list(self._lines()))

    def _lines(self) -> Iterator[tuple[str, str, str, str]]:
        """Lines for each column: its name, with its size if it is a dimension; unit, values in short, meaning."""
        for name, column in self._columns.items():
            size = f' ({self._sizes[name]})' if name in self._sizes else ''
            yield name + size, column['unit'], summary(getattr(self, name), _FEW_ROWS), column['meaning']

    def _summary(self) -> str:
        """Short form of the table in a line: its numbers, or their count."""
        if self._sizes:
            return ', '.join(f'{size} {name}' for name, size in self._sizes.items())
        return ', '.join(f'{name} {summary(getattr(self, name))}' for name in self._columns)

    def to_pandas(self) -> pandas.DataFrame:
        """Returns the rows with all columns as a DataFrame; units, case and version are in its `attrs`."""
        pandas = _installed('pandas')
        frame = pandas.DataFrame({name: self._read(name) for name in self._columns})
        frame.attrs = self._attributes() | {'units': self.units}
        return frame

    def to_xarray(self) -> xarray.Dataset:
        """Returns all columns with named dimensions and units as a Dataset, the index columns as coordinates."""
        xarray = _installed('xarray')
        dims = self.dims
        arrays = {
            name: (dims[name], getattr(self, name), {'units': column['unit'], 'long_name': column['meaning']})
            for name, column in self._columns.items()
        }
        coordinates = {name: arrays.pop(name) for name in self._index}
        return xarray.Dataset(arrays, coords=coordinates, attrs=self._attributes())

    def _attributes(self) -> dict[str, str]:
        return {'table': self.name, 'case': str(self.case), 'version': self.version}

    def save(self, path: str | os.PathLike) -> None:
        """Writes the table to a file for `gearsweep.read`: NumPy's npz format, with the same bits, no pickle."""
        self._study._with_tables([self]).save(path)

    def __reduce__(self) -> tuple:
        return itemgetter(self.name), (self._study._with_tables([self]),)


def suggestion(name: str, names) -> str:
    """Suggests the present name of a former one or the closest of the names, or lists all, for the end of a message."""
    if name in FORMER and FORMER[name] in names:
        return f' (did you mean {FORMER[name]}?)'
    close = difflib.get_close_matches(name, list(names), 1, 0.6)
    return f' (did you mean {close[0]}?)' if close else f'; there are {", ".join(names)}' if names else '; there are none'


def select_value(values: np.ndarray, wanted: float | None, name: str) -> float:
    """Returns the requested value of a column, or the first.

    Raises
    ------
    ValueError
        The column has no such value, or none; or it is no number.
    """
    if not values.size:
        raise ValueError(f'{name}: there is none, as no point has a result')
    if wanted is None:
        return float(values[0])
    is_number = isinstance(wanted, (int, float, np.number))
    if not is_number or not np.isclose(values, wanted).any():
        raise ValueError(f'{name} = {f"{wanted:g}" if is_number else repr(wanted)}: must be one of {", ".join(f"{value:g}" for value in dict.fromkeys(values))}')
    return wanted


def summary(values: Any, most: int = _MOST) -> str:
    """Formats a few of the values, or their range if there are more than `most`; for words, the count of each."""
    if isinstance(values, str):
        return values
    if not isinstance(values, np.ndarray):
        return f'{values:.6g}'
    if values.dtype.kind == 'U':
        words, counts = np.unique(values, return_counts=True)
        if values.size <= _MOST:
            return ', '.join(values.ravel())
        some = [f'{count} {word}' for word, count in zip(words, counts)]
        return ', '.join(some[:_MOST]) + (' ...' if len(some) > _MOST else '')
    known = values[np.isfinite(values)]
    missing = f', {values.size - known.size} without' if known.size < values.size else ''
    if values.size <= most:
        return ', '.join(f'{value:.6g}' for value in values.ravel()) + (missing if values.size > 1 else '')
    return (f'{known.min():.6g} to {known.max():.6g}' if known.size else 'none') + missing


def as_html(heading: str, rows: list[tuple[str, ...]]) -> str:
    """Formats a table for notebooks."""
    left = 'style="text-align:left"'
    body = ''.join('<tr>' + ''.join(f'<td {left}>{html.escape(cell)}</td>' for cell in row) + '</tr>' for row in rows)
    wide = max((len(row) for row in rows), default=1)
    return f'<table><thead><tr><th colspan="{wide}" {left}>{html.escape(heading)}</th></tr></thead>{body}</table>'
