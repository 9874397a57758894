"""A study: what a case answers, as tables; how one is run, kept in files and read again."""

from __future__ import annotations

import contextlib
import json
import os
import re
import threading
import warnings
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _library
from ._files import replacing
from ._given import given
from ._library import Code, Error, PartialWarning, UnusedWarning
from ._watch import Late, Stopped, bar
from .case import Case, written
from .table import Table, as_html, meant

if TYPE_CHECKING:
    from ._named import Named  # the tables and their columns, for completion
else:
    Named = object

#: Of the files; a later one need not be readable by this version.
_FORMAT = 2
_TEXTS = ('report', 'log')
_VERSION = _library.version()


@dataclass
class _Kept:
    """A study that was read from a file or came from another process."""

    texts: dict[str, str]
    columns: dict[tuple[str, str], np.ndarray]

    def text(self, what: str) -> str:
        return self.texts[what]

    def column(self, table: str, name: str) -> np.ndarray:
        return self.columns[table, name]


class Study(Named):
    """What a case answers: a table for each thing that its tasks compute, under its name.

    Any number of threads may read it. It can be pickled, saved, and be the `earlier` of further runs.

    Attributes
    ----------
    case : Case
        The case that was run.
    version : str
        Of the library that ran it.
    tables : tuple of str
        The names of its tables.
    is_complete : bool
        Every operating point has a result.
    log : str
        Which stages ran, which were taken over from an earlier study and which were left out.
    """

    def __init__(self, case: Case, version: str, is_complete: bool, about: list[dict[str, Any]], source: _library.Handle | _Kept):
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
        """The whole answer as text, as the program prints it."""
        return self._source.text('report')

    def write(self, folder: str | os.PathLike, name: str) -> list[str]:
        """Writes tables and grids as files `name.sweep.csv` and so on into a folder, which is made if missing; their paths.

        All or, where one cannot be written, none; a table of this name that this study lacks gets the ending `.old`.
        """
        return self._live('to write its tables').write(os.fspath(folder), name)

    def write_report(self, path: str | os.PathLike) -> None:
        """Writes result, warnings, answer, pictures, formulas with their values, tables and input to one page of HTML that stands alone.

        Pictures need matplotlib. Where it cannot be written, an `Error` says why, and one that is there stays as it was.
        """
        from ._page import write

        write(self, path)

    def save(self, path: str | os.PathLike) -> None:
        """Writes all tables to one file that `gearsweep.read` reads: NumPy's npz format, bit by bit, no pickle.

        Where it cannot be written, an `Error` says why, and one that is there stays as it was.
        """
        about, columns = self._state()
        arrays = {'.'.join(place): values for place, values in columns.items()}
        with replacing(path) as new, open(new, 'wb') as file:
            np.savez_compressed(file, about=np.frombuffer(json.dumps(about).encode(), np.uint8), **arrays)  # type: ignore[arg-type]

    def __getattr__(self, name: str) -> Table:
        if name.startswith('_'):
            raise AttributeError(name)
        if name not in self._about:
            raise AttributeError(f'this study has no table {name}{meant(name, self._about)}; the case asks for '
                                 f'{", ".join(self.case.tasks)}')  # fmt: skip
        return Table(self, self._about[name], lambda column: self._column(name, column))

    def __getitem__(self, name: str) -> Table:
        if name not in self._about:
            raise KeyError(f'this study has no table {name}{meant(name, self._about)}')
        return getattr(self, name)

    def __contains__(self, name: object) -> bool:
        return name in self._about

    def __iter__(self) -> Iterator[Table]:
        return (self[name] for name in self._about)

    def __dir__(self) -> list[str]:
        return sorted({*(name for name in dir(type(self)) if not name.startswith('_')), *self._about,
                       'case', 'is_complete', 'version'})  # fmt: skip

    def __repr__(self) -> str:
        lines = [f'  {name + ":":{max(map(len, self._about)) + 1}} {self[name]._in_short()}' for name in self._about]
        return '\n'.join([f'<{self._heading()}', *lines]) + '>'

    def _repr_html_(self) -> str:
        return as_html(self._heading(), [(table.name, table._in_short(), table.meaning) for table in self])

    def _heading(self) -> str:
        title = self.case.get('case', 'title')
        return 'gearsweep.Study' + (f' of {title}' if title else '')

    def _live(self, purpose: str) -> _library.Handle:
        if isinstance(self._source, _Kept):
            raise Error(f'this study holds its tables only, as it was read from a file or comes from another process: '
                        f'run its case again {purpose}')  # fmt: skip
        return self._source

    def _column(self, table: str, name: str) -> np.ndarray:
        """The values row by row, read once; where two threads do at the same time, they read the same."""
        place = table, name
        if place not in self._read:
            values = self._source.column(table, name)
            values.setflags(write=False)
            self._read[place] = values
        return self._read[place]

    def _of(self, tables: list[Table]) -> Study:
        """A study of these tables alone, of which it holds the numbers."""
        columns = {(table.name, name): table._read(name) for table in tables for name in table}
        source = _Kept({what: self._source.text(what) for what in _TEXTS}, columns)
        return Study(self.case, self.version, self.is_complete, [table._about for table in tables], source)

    def _state(self) -> tuple[dict[str, Any], dict[tuple[str, str], np.ndarray]]:
        """All that there is, without the library's memory."""
        texts = {what: self._source.text(what) for what in _TEXTS}
        about = {'format': _FORMAT, 'version': self.version, 'text': self.case.text, 'folder': self.case.folder,
                 'is_complete': self.is_complete, 'texts': texts, 'tables': list(self._about.values())}  # fmt: skip
        return about, {(table.name, name): self._column(table.name, name) for table in self for name in table}

    def __reduce__(self) -> tuple:
        return _restored, self._state()


def _restored(about: dict[str, Any], columns: dict[tuple[str, str], np.ndarray]) -> Study:
    source = _Kept(about['texts'], columns)
    return Study(Case(about['text'], about['folder']), about['version'], about['is_complete'], about['tables'], source)


def run(
    case: Case, tasks: str | Iterable[str] | None = None, *, threads: int = 0, earlier: Study | None = None,
    progress: Callable[[int, int], object] | bool = False, keep: str | os.PathLike = '', resume: str | os.PathLike = '',
    seconds: float | None = None,
) -> Study:  # fmt: skip
    """Everything that the case asks for.

    Parameters
    ----------
    case : Case
        What to compute.
    tasks : str or several, optional
        What to compute instead of the tasks that the case names, such as 'sweep'.
    threads : int
        For the sweep; 0: all. The answer is the same for any number.
    earlier : Study, optional
        What it was made of, such as the stiffness, is taken over where the inputs are equal, so that it costs nothing;
        the answer is the same. `log` tells.
    progress : callable or bool
        Called now and then with the number of operating points that are done, and of all. True shows a bar on
        stderr, by tqdm where it is installed. An exception that it raises ends the run and comes out.
    keep : path, optional
        File that is written where the run is interrupted, by Ctrl-C or by `progress`, with what is done by then. Where none
        can be written under this name, an `Error` says so before the run begins; where it fails in the end, an `Error` that
        says why is the `__cause__` of the exception.
    resume : path, optional
        Such a file: the run goes on from there, to the same bits as if it had not been interrupted. One of another
        case or version is refused. Interrupted again, it is written anew, unless `keep` names another file.
    seconds : float, optional
        The run ends after this time, as by Ctrl-C, with an `Error` of code `INTERRUPTED`. A stage that does not look at the time,
        such as one finite-element solution, goes on in the background to its end.

    Returns
    -------
    Study

    Raises
    ------
    Error
        The case is not usable, a file is missing, or a method failed. Operating points without a result are
        no error: they are NaN, and a `PartialWarning` tells how many. An `UnusedWarning` names keys that none of
        the case's tasks uses, unless `tasks` are given.

    Examples
    --------
    >>> import gearsweep
    >>> case = gearsweep.Case('''&case tasks = 'mesh' / &pair module_mm = 3 face_width_mm = 20 /
    ...     &pinion teeth = 21 / &gear teeth = 34 / &load torque_nm = 100 / &section elements_across = 4 /''')
    >>> study = gearsweep.run(case)
    >>> print(f'{study.geometry.contact_ratio:.4f}, {study.motion.natural_frequency_hz:.1f} Hz')
    1.6248, 7722.8 Hz
    >>> 'sweep' in study
    False
    """
    if not isinstance(case, Case):
        raise TypeError(f'case: must be a gearsweep.Case, not {type(case).__name__}')
    if seconds is not None and not seconds > 0:
        raise Error(f'seconds = {seconds}: must be above 0')
    if tasks is not None:
        case = _asking(case, tasks)
    elif case.unused:
        keys = ''.join(f'\n  for {line}' for line in case.unused)
        warnings.warn(f'keys that no task of this case uses:{keys}', UnusedWarning, stacklevel=2)
    with contextlib.closing(bar()) if progress is True else contextlib.nullcontext(progress or None) as shown:
        study, error, cause = attempt(case, threads, earlier, shown, resume, keep or resume, seconds=seconds)
    if isinstance(cause, Late):
        raise Error(f'the run is not done after {seconds:g} s', Code.INTERRUPTED) from error
    if cause is not None:
        raise cause from (error if error is not None and lost(error) else None)
    if study is None or (error is not None and error.code == Code.INTERRUPTED):
        raise error or Error('the run made no study')
    if error is not None:
        warnings.warn(str(error), PartialWarning, stacklevel=2)
    return study


def _asking(case: Case, tasks: str | Iterable[str]) -> Case:
    """The case with these tasks: as it is, where it names just them and no published values."""
    said = given(case.text).get('case', {})
    if said.get('tasks') == written(tasks) and 'published' not in said:
        return case
    return case.changed(case={'tasks': tasks, 'published': None})


def lost(error: Error) -> bool:
    """Does the error of an interrupted run tell that what was done could not be kept?"""
    return error.code == Code.INTERRUPTED and '; it is not kept: ' in str(error)


def attempt(
    case: Case, threads: int = 0, earlier: Study | None = None, progress: Callable[[int, int], object] | None = None,
    resume: str | os.PathLike = '', keep: str | os.PathLike = '', stop: threading.Event | None = None,
    seconds: float | None = None,
) -> tuple[Study | None, Error | None, BaseException | None]:  # fmt: skip
    """The study as far as there is one, the error that the run ended with, and the exception that ended it."""
    if earlier is not None and not isinstance(earlier, Study):
        raise TypeError(f'earlier: must be a gearsweep.Study, not {type(earlier).__name__}')
    before = None if earlier is None else earlier._live('to start others from it')
    files = os.fspath(resume), os.fspath(keep)
    try:
        found, error, cause = _library.run(case.text, case.folder, threads, before, progress, *files, stop, seconds)
    except Late as late:  # in a part that does not look at the time, and goes on
        return None, None, late
    study = Study(case, _VERSION, error is None, json.loads(found.text('tables')), found) if found else None
    return study, error, cause


@dataclass
class Rows:
    """What a case answers for each row of values.

    Attributes
    ----------
    columns : dict of str to array
        By 'table.column' the numbers of each row, (row, number); NaN where a row has no result. Where no row ran, no numbers.
    codes : array
        A `Code` for each row: OK, PARTIAL (some operating points are NaN), INTERRUPTED (not run), or why there is none.
    messages : list of str
        The same in words; empty where all is well.
    """

    columns: dict[str, np.ndarray]
    codes: np.ndarray
    messages: list[str]
    _source: _library.Handle | None = field(default=None, repr=False, compare=False)

    def __reduce__(self) -> tuple:
        return Rows, (self.columns, self.codes, self.messages)  # without the library's memory

    def _live(self) -> _library.Handle:
        if self._source is None:
            raise Error('these rows hold their numbers only, as they come from another process: run one of them again to start '
                        'others from it')  # fmt: skip
        return self._source


def run_rows(
    case: Case, names: Iterable[str], values: Any, take: Iterable[str], *, threads: int = 1, earlier: Rows | Study | None = None,
    progress: Callable[[int, int], object] | None = None, stop: threading.Event | None = None,
) -> Rows:  # fmt: skip
    """Runs a case once for each row of values of some of its keys, in one call: for a thousand variants and more.

    Each row gives the same bits as `run(case.changed(...))`, at a small part of the time: the case is read once, and teeth, stiffness
    and whatever else is made of the same inputs are taken over from row to row.

    Parameters
    ----------
    case : Case
        With its tasks, as it stands; its own values of the keys in `names` do not count.
    names : several str
        The keys, as 'load.line_load_n_mm'. Each takes one number; of a list, the only one.
    values : array (row, name)
        Numbers in the keys' units. A key that takes integers takes whole numbers, such as 25.0.
    take : several str
        Columns of numbers, as 'sweep.dynamic_factor'. How many numbers a row has is told by the first row that runs; one with
        more or fewer has the code INPUT.
    threads : int
        For the sweep of each row; 0: all. The answer is the same for any number.
    earlier : Rows or Study, optional
        Whatever of it was made of the same inputs is taken over: of the rows before, the last that ran.
    progress : callable, optional
        Called now and then with the number of rows that are done, and of all. An exception that it raises ends the run and
        comes out.
    stop : threading.Event, optional
        Once it is set, rows that are not done get the code INTERRUPTED.

    Raises
    ------
    Error
        The case has no such key, its tables no such column, or the text cannot be read. Whatever is wrong with the
        values of a row is told by its code and message.

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
        before = earlier._live('to start others from it') if isinstance(earlier, Study) else earlier._live()
    found, error, cause = _library.run_rows(case.text, case.folder, ' '.join(names), values, ' '.join(take), threads, before,
                                            progress, stop)  # fmt: skip
    if cause is not None and not isinstance(cause, Stopped):
        raise cause
    if found is None:
        raise error or Error('the run made no rows')
    codes = found.column('rows', 'code')
    messages = [found.word('rows', 'message', row) if code else '' for row, code in enumerate(codes)]
    there = {table['name'] for table in json.loads(found.text('tables'))}
    columns = {name: found.column(*name.split('.')).reshape(len(values), -1) if name.split('.')[0] in there
               else np.empty((len(values), 0)) for name in take}  # fmt: skip
    return Rows(columns, codes, messages, found)


def _several(what: str, names: Iterable[str]) -> list[str]:
    names = [names] if isinstance(names, str) else list(names)
    for name in names:
        if not re.fullmatch(r'\w+\.\w+', name):
            raise Error(f'{what} = {name}: must be two names with a point between them')
    return names


def read(path: str | os.PathLike) -> Study:
    """Reads a study that `save` wrote, bit by bit as it was.

    One that cannot be read, or is none of ours, is an `Error`.
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
    # What a damaged file raises is up to zipfile, zlib, NumPy and json, or whatever it makes of the result.
    except Exception as error:
        raise Error(f'cannot read {path}: is no result of gearsweep', Code.FILE) from error
