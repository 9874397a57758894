"""A study: the results of a case as tables; running, saving and reading it."""

from __future__ import annotations

import contextlib
import json
import os
import re
import threading
import warnings
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from . import library
from .assignments import assignments
from .case import Case, formatted
from .files import replacing
from .library import Code, Error, PartialWarning, UnusedWarning, check_seconds
from .table import Table, as_html, suggestion
from .watch import Late, Stopped, bar

if TYPE_CHECKING:
    from .named import Named  # tables and columns, for completion in editors
else:
    Named = object

#: Version of the files' format; this version of the package may be unable to read a later one.
_FORMAT = 2
_TEXTS = ('report', 'log')
_VERSION = library.version()


@dataclass
class _StoredData:
    """Data of a study that was read from a file or came from another process."""

    texts: dict[str, str]
    columns: dict[tuple[str, str], np.ndarray]

    def text(self, what: str) -> str:
        return self.texts[what]

    def column(self, table: str, name: str) -> np.ndarray:
        return self.columns[table, name]


class Study(Named):
    """Results of a case: a table for each result of its tasks, by name.

    Any number of threads may read it. It can be pickled, saved, and used as `earlier` of further runs.

    Attributes
    ----------
    case : Case
        The case that was run.
    version : str
        Version of the library that ran it.
    tables : tuple of str
        Names of its tables.
    is_complete : bool
        True if every operating point converged.
    log : str
        Stages that ran, those reused from an earlier study, and those that did not run.
    """

    #: `report.page.write`, which is above this room: the package's front sets it.
    write_report: ClassVar[Callable[[Study, str | os.PathLike], None]]

    def __init__(self, case: Case, version: str, is_complete: bool, about: list[dict[str, Any]], source: library.Handle | _StoredData):
        self.case = case
        self.version = version
        self.is_complete = is_complete
        self._about = {table['name']: table for table in about}
        self._source = source
        self._read: dict[tuple[str, str], np.ndarray] = {}

    @property
    def tables(self) -> tuple[str, ...]:
        return tuple(self._about)

    @property
    def log(self) -> str:
        return self._source.text('log')

    def report(self) -> str:
        """Complete report as text, as the program prints it."""
        return self._source.text('report')

    def write(self, folder: str | os.PathLike, name: str) -> list[str]:
        """Writes tables and grids as files `name.sweep.csv` and so on into a folder, which is made if missing; returns their
        paths.

        If one cannot be written, none is; a file for a table that this study does not have is renamed with the ending `.old`.
        """
        return self._handle('to write its tables').write(os.fspath(folder), name)

    def save(self, path: str | os.PathLike) -> None:
        """Writes all tables to one file for `gearsweep.read`: NumPy's npz format, with the same bits, no pickle.

        If it cannot be written, an `Error` gives the reason, and an existing file remains unchanged.
        """
        about, columns = self._state()
        arrays = {'.'.join(place): values for place, values in columns.items()}
        with replacing(path) as new, open(new, 'wb') as file:
            np.savez_compressed(file, about=np.frombuffer(json.dumps(about).encode(), np.uint8), **arrays)  # type: ignore[arg-type]

    def __getattr__(self, name: str) -> Table:
        if name.startswith('_'):
            raise AttributeError(name)
        if name not in self._about:
            raise AttributeError(f'this study has no table {name}{suggestion(name, self._about)}; the case asks for '
                                 f'{", ".join(self.case.tasks)}')  # fmt: skip
        return Table(self, self._about[name], lambda column: self._column(name, column))

    def __getitem__(self, name: str) -> Table:
        if name not in self._about:
            raise KeyError(f'this study has no table {name}{suggestion(name, self._about)}')
        return getattr(self, name)

    def __contains__(self, name: object) -> bool:
        return name in self._about

    def __iter__(self) -> Iterator[Table]:
        return (self[name] for name in self._about)

    def __dir__(self) -> list[str]:
        return sorted({*(name for name in dir(type(self)) if not name.startswith('_')), *self._about,
                       'case', 'is_complete', 'version'})  # fmt: skip

    def __repr__(self) -> str:
        lines = [f'  {name + ":":{max(map(len, self._about)) + 1}} {self[name]._summary()}' for name in self._about]
        return '\n'.join([f'<{self._heading()}', *lines]) + '>'

    def _repr_html_(self) -> str:
        return as_html(self._heading(), [(table.name, table._summary(), table.meaning) for table in self])

    def _heading(self) -> str:
        title = self.case.get('case', 'title')
        return 'gearsweep.Study' + (f' of {title}' if title else '')

    def _handle(self, purpose: str) -> library.Handle:
        if isinstance(self._source, _StoredData):
            raise Error(f'this study holds its tables only, as it was read from a file or comes from another process: '
                        f'run its case again {purpose}')  # fmt: skip
        return self._source

    def _column(self, table: str, name: str) -> np.ndarray:
        """Reads a column once, row by row; several threads may read it at the same time."""
        place = table, name
        if place not in self._read:
            values = self._source.column(table, name)
            values.setflags(write=False)
            self._read[place] = values
        return self._read[place]

    def _with_tables(self, tables: list[Table]) -> Study:
        """Builds a study of these tables alone, with their numbers."""
        columns = {(table.name, name): table._read(name) for table in tables for name in table}
        source = _StoredData({what: self._source.text(what) for what in _TEXTS}, columns)
        return Study(self.case, self.version, self.is_complete, [table._about for table in tables], source)

    def _state(self) -> tuple[dict[str, Any], dict[tuple[str, str], np.ndarray]]:
        """Returns all data outside the library's memory."""
        texts = {what: self._source.text(what) for what in _TEXTS}
        about = {'format': _FORMAT, 'version': self.version, 'text': self.case.text, 'folder': self.case.folder,
                 'is_complete': self.is_complete, 'texts': texts, 'tables': list(self._about.values())}  # fmt: skip
        return about, {(table.name, name): self._column(table.name, name) for table in self for name in table}

    def __reduce__(self) -> tuple:
        return _restored, self._state()


def _restored(about: dict[str, Any], columns: dict[tuple[str, str], np.ndarray]) -> Study:
    source = _StoredData(about['texts'], columns)
    return Study(Case(about['text'], about['folder']), about['version'], about['is_complete'], about['tables'], source)


def run(
    case: Case, tasks: str | Iterable[str] | None = None, *, threads: int = 0, earlier: Study | None = None,
    progress: Callable[[int, int], object] | bool = False, seconds: float | None = None,
) -> Study:  # fmt: skip
    """Runs the tasks of a case.

    Parameters
    ----------
    case : Case
        Case to run.
    tasks : str or several, optional
        Tasks instead of those of the case, such as 'sweep'.
    threads : int
        Number of threads of the sweep; 0: all. The results are the same for any number.
    earlier : Study, optional
        Its intermediate results, such as the stiffness, are reused if their inputs are equal, which saves time; the results
        are the same. `log` lists what was reused.
    progress : callable or bool
        Called repeatedly with the numbers of finished and of all operating points. True shows a bar on stderr, by tqdm if it is
        installed. An exception that it raises ends the run and is passed on.
    seconds : float, optional
        The run ends after this time, as by Ctrl-C, with an `Error` of code `INTERRUPTED`. A stage without a check of the
        time, such as one finite-element solution, continues in the background to its end.

    Returns
    -------
    Study

    Raises
    ------
    Error
        The case is not usable, a file is missing, or a method failed. Operating points without a result are
        no error: they are NaN, and a `PartialWarning` reports their number. An `UnusedWarning` names keys that none of
        the case's tasks uses, unless `tasks` are named.

    Examples
    --------
    >>> import gearsweep
    >>> case = gearsweep.Case('''&case tasks = 'mesh' / &pair module_mm = 3 face_width_mm = 20 /
    ...     &pinion teeth = 21 / &gear teeth = 34 / &load torque_nm = 100 / &section elements_across = 4 /''')
    >>> study = gearsweep.run(case)
    >>> print(f'{study.geometry.contact_ratio:.4f}, {study.motion.natural_frequency_hz:.1f} Hz')
    1.6248, 6891.4 Hz
    >>> 'sweep' in study
    False
    """
    if not isinstance(case, Case):
        raise TypeError(f'case: must be a gearsweep.Case, not {type(case).__name__}')
    check_seconds('seconds', seconds)
    if tasks is not None:
        case = _with_tasks(case, tasks)
    elif case.unused:
        keys = ''.join(f'\n  for {line}' for line in case.unused)
        warnings.warn(f'keys that no task of this case uses:{keys}', UnusedWarning, stacklevel=2)
    with contextlib.closing(bar()) if progress is True else contextlib.nullcontext(progress or None) as shown:
        study, error, cause = attempt(case, threads, earlier, shown, seconds=seconds)
    if isinstance(cause, Late):
        raise Error(f'the run is not done after {seconds:g} s', Code.INTERRUPTED) from error
    if cause is not None:
        raise cause
    if study is None or (error is not None and error.code == Code.INTERRUPTED):
        raise error or Error('the run made no study')
    if error is not None:
        warnings.warn(str(error), PartialWarning, stacklevel=2)
    return study


def _with_tasks(case: Case, tasks: str | Iterable[str]) -> Case:
    """Returns the case with these tasks: unchanged if it names exactly these and no published values."""
    typed = assignments(case.text).get('case', {})
    if typed.get('tasks') == formatted(tasks) and 'published' not in typed:
        return case
    return case.changed(case={'tasks': tasks, 'published': None})


def attempt(
    case: Case, threads: int = 0, earlier: Study | None = None, progress: Callable[[int, int], object] | None = None,
    stop: threading.Event | None = None, seconds: float | None = None, waits: bool = False,
) -> tuple[Study | None, Error | None, BaseException | None]:  # fmt: skip
    """Runs a case; returns the study as far as it exists, the error of the run, and the exception that ended it.

    With `waits`, it returns after an exception, such as KeyboardInterrupt, only once the finished results exist.
    """
    if earlier is not None and not isinstance(earlier, Study):
        raise TypeError(f'earlier: must be a gearsweep.Study, not {type(earlier).__name__}')
    before = None if earlier is None else earlier._handle('to start others from it')
    try:
        found, error, cause = library.run(case.text, case.folder, threads, before, progress, stop, seconds, waits)
    except Late as late:  # in a part without a check of the time, which continues in the background
        return None, None, late
    study = Study(case, _VERSION, error is None, json.loads(found.text('tables')), found) if found else None
    return study, error, cause


@dataclass
class Rows:
    """Results of a case for each row of values.

    Attributes
    ----------
    columns : dict of str to array
        By 'table.column' the numbers of each row, (row, number); NaN if a row has no result. Empty if no row ran.
    codes : array
        A `Code` for each row: OK, PARTIAL (some operating points are NaN), INTERRUPTED (not run), or why there is none.
    messages : list of str
        Message for each code; empty without an error.
    """

    columns: dict[str, np.ndarray]
    codes: np.ndarray
    messages: list[str]
    _source: library.Handle | None = field(default=None, repr=False, compare=False)

    def __reduce__(self) -> tuple:
        return Rows, (self.columns, self.codes, self.messages)  # without the library's memory

    def _handle(self) -> library.Handle:
        if self._source is None:
            raise Error('these rows hold their numbers only, as they come from another process: run one of them again to start '
                        'others from it')  # fmt: skip
        return self._source


def run_rows(
    case: Case, names: Iterable[str], values: Any, take: Iterable[str], *, threads: int = 1, earlier: Rows | Study | None = None,
    progress: Callable[[int, int], object] | None = None, stop: threading.Event | None = None,
) -> Rows:  # fmt: skip
    """Runs a case once for each row of values of some of its keys, in one call: for a thousand variants and more.

    Each row has the same bits as `run(case.changed(...))`, in a small part of the time: the case is read once, and teeth, stiffness
    and other intermediate results with the same inputs are reused from row to row.

    Parameters
    ----------
    case : Case
        Its tasks are run; its own values of the keys in `names` are replaced.
    names : several str
        The keys, as 'load.line_load_n_mm'. Each takes one number; of a list, the only one.
    values : array (row, name)
        Numbers in the keys' units. A key that takes integers takes whole numbers, such as 25.0.
    take : several str
        Columns of numbers, as 'sweep.dynamic_factor'. The first row that runs sets the count of numbers of a row; a row
        with another count has the code INPUT.
    threads : int
        Number of threads for the sweep of each row; 0: all. The results are the same for any number.
    earlier : Rows or Study, optional
        Its intermediate results with the same inputs are reused: of rows, those of the last that ran.
    progress : callable, optional
        Called repeatedly with the numbers of finished and of all rows. An exception that it raises ends the run and is passed on.
    stop : threading.Event, optional
        Once it is set, unfinished rows have the code INTERRUPTED.

    Raises
    ------
    Error
        The case has no such key, its tables no such column, or the text cannot be read. Errors in the values of
        a row are reported in its code and message.

    Examples
    --------
    >>> import gearsweep
    >>> case = gearsweep.Case('''&case tasks = 'geometry' / &pair module_mm = 3 face_width_mm = 20 /
    ...     &pinion teeth = 21 / &gear teeth = 34 /''')
    >>> rows = gearsweep.run_rows(case, ['gear.teeth', 'pair.module_mm'], [[34, 3], [3, 3], [35, 3]], ['geometry.contact_ratio'])
    >>> print(rows.columns['geometry.contact_ratio'].ravel().round(4), rows.codes)
    [1.6248    nan 1.6279] [0 1 0]
    >>> rows.messages[1]
    '&gear teeth = 3: must be at least 5...
    """
    if not isinstance(case, Case):
        raise TypeError(f'case: must be a gearsweep.Case, not {type(case).__name__}')
    if earlier is not None and not isinstance(earlier, (Rows, Study)):
        raise TypeError(f'earlier: must be a gearsweep.Rows or a gearsweep.Study, not {type(earlier).__name__}')
    names, take = _several('names', names), _several('take', take)
    values = np.ma.filled(np.ma.asanyarray(values).astype(np.float64, casting='same_kind'), np.nan)
    if values.ndim != 2 or values.shape[1] != len(names):
        raise Error(f'values: must have a column for each of {len(names)} names, not the shape {values.shape}')
    before = None
    if earlier is not None:
        before = earlier._handle('to start others from it') if isinstance(earlier, Study) else earlier._handle()
    found, error, cause = library.run_rows(case.text, case.folder, ' '.join(names), values, ' '.join(take), threads, before,
                                            progress, stop)  # fmt: skip
    if cause is not None and not isinstance(cause, Stopped):
        raise cause
    if found is None:
        raise error or Error('the run made no rows')
    codes = found.column('rows', 'code')
    messages = [found.word('rows', 'message', row) if code else '' for row, code in enumerate(codes)]
    table_names = {table['name'] for table in json.loads(found.text('tables'))}
    columns = {name: found.column(*name.split('.')).reshape(len(values), -1) if name.split('.')[0] in table_names
               else np.empty((len(values), 0)) for name in take}  # fmt: skip
    return Rows(columns, codes, messages, found)


def _several(what: str, names: Iterable[str]) -> list[str]:
    names = [names] if isinstance(names, str) else list(names)
    for name in names:
        if not re.fullmatch(r'\w+\.\w+', name):
            raise Error(f'{what} = {name}: must be two names with a point between them')
    return names


def read(path: str | os.PathLike) -> Study:
    """Reads a study that `save` wrote, with the same bits.

    A file that cannot be read, or has another format, raises an `Error`.
    """
    path = os.fspath(path)
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        about = json.loads(arrays.pop('about').tobytes())
        if about['format'] != _FORMAT:
            raise Error(f'cannot read {path}: format {about["format"]} is not known to this version', Code.FILE)
        if not all(isinstance(words, str) for words in (about['text'], about['folder'], *(about['texts'][what] for what in _TEXTS))):
            raise TypeError
        study = _restored(about, {tuple(name.split('.')): values for name, values in arrays.items()})
        _ = [table[name] for table in study for name in table]
        return study
    except Error:
        raise
    except OSError as error:
        raise Error(f'cannot read {path}: {error.strerror or error}', Code.FILE) from error
    # A damaged file may raise any exception of zipfile, zlib, NumPy and json, or of the code that uses the result.
    except Exception as error:
        raise Error(f'cannot read {path}: is no result of gearsweep', Code.FILE) from error
