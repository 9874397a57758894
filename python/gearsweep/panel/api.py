"""Calls of the panel's pages, independent of the web server.

Each call of a page is complete: it has the case as text and its place. The API stores only studies, under names that nobody can
guess, so that no window sees those of another one, and the runs in progress.
"""

from __future__ import annotations

import math
import re
import secrets
import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ..core import library
from ..core.assignments import assignments
from ..core.case import formatted
from ..core.library import Code, Error
from ..core.study import Study, attempt
from ..core.watch import Stopped
from ..report.headlines import as_json
from .case_folders import CaseFolders, description
from .scene import scene

#: Number of stored studies for all windows; a page whose study was dropped runs its case again.
_MOST = 40
#: Number of simultaneous runs, as each uses all cores; seconds between two checks for a stop while a run is queued.
_AT_ONCE, _LOOK = 2, 0.1
_NAMED = re.compile(r'&(\w+)(?: (\w+))?')


class StudyDropped(Exception):
    """The study is no longer stored."""


class Api:
    """Answers the calls of the pages, from any number of threads."""

    def __init__(self, case_folders: CaseFolders, start: Mapping[str, str]):
        self._folders = case_folders
        self._start = dict(start)
        self._studies: OrderedDict[str, Study] = OrderedDict()
        self._stops: dict[str, threading.Event] = {}
        self._lock = threading.Lock()
        self._turns = threading.Semaphore(_AT_ONCE)

    def about(self) -> dict[str, Any]:
        """Returns the data that a page needs once: the declarations, the available cases and the first one."""
        return {**description(), 'cases': self._folders.cases(), 'start': self._start}

    def open(self, place: str, name: str) -> dict[str, Any]:
        """Returns a case of a folder."""
        return self.check(self._folders.read(place, name), place) | {'name': name.removesuffix('.nml'), 'place': place}

    def check(self, text: str, place: str) -> dict[str, Any]:
        """Returns the values in a text and those in effect, and the library's message if the text is not usable."""
        answer: dict[str, Any] = {'text': text, 'given': assignments(text), 'values': {}, 'unused': [], 'error': None}
        try:
            case = self._folders.case(text, place)
            answer |= {'values': {group: {key: formatted(one) for key, one in keys.items()} for group, keys in case.values.items()}, 'unused': case.unused}
        except Error as error:
            answer['error'] = error_json(error)
        return answer

    def change(self, text: str, place: str, group: str, key: str, value: Any) -> dict[str, Any]:
        """Returns the text with another value of a key, checked; None removes the key.

        A string is the typed text, in the form of a case; for a key with one text, the text itself. A value that a case cannot have
        leaves the text unchanged.
        """
        known = {(one['group'], one['name']): one for one in description()['keys']}
        about = known.get((group, key), {})
        is_text = about.get('kind') == 'text' and not about.get('list')
        words = value.strip() if isinstance(value, str) and not is_text else formatted(value or None)
        try:
            return self.check(library.edit('change', text, group, key, words), place)
        except Error as error:
            return self.check(text, place) | {'error': {**error_json(error), 'group': group, 'key': key}, 'unchanged': True}

    def run(
        self, text: str, place: str, tasks: list[str] | None = None, earlier: str = '', drop: str = '',
        columns: Mapping[str, list[str] | None] | None = None, teeth: bool = False, run: str = '',
        progress: Callable[[int, int], object] | None = None,
    ) -> dict[str, Any]:  # fmt: skip
        """Runs a case; returns the name of its study, the list of its tables, the requested columns, and the report.

        `earlier` is a study whose results are reused, if it is still stored; `drop` one that is no longer needed; `run` names the
        run, for `stop`; `teeth` requests the tooth pair, too.

        Raises
        ------
        Error
            As in the library; with the code INTERRUPTED if it was stopped.
        """
        began = time.perf_counter()
        case = self._folders.case(text, place)
        if tasks:
            case = case.changed(case={'tasks': tasks, 'published': None})
        stop = threading.Event()
        with self._lock:
            self._stops[run] = stop
            before = self._studies.get(earlier)
        try:
            while not self._turns.acquire(timeout=_LOOK):
                if stop.is_set():
                    raise Stopped
            try:
                study, error, cause = attempt(case, 0, before, progress, stop=stop)
            finally:
                self._turns.release()
        except BaseException as caught:
            study, error, cause = None, None, caught
        finally:
            with self._lock:
                self._stops.pop(run, None)
        if stop.is_set() or (error is not None and error.code == Code.INTERRUPTED):
            raise Error('stopped before it was done', Code.INTERRUPTED)
        if cause is not None:
            raise cause
        if study is None:
            raise error or Error('the run made no study')
        answer: dict[str, Any] = {
            'study': self._keep(study, drop),
            'tables': list(study._about.values()),
            'report': study.report(),
            'headlines': as_json(study),
            'partial': str(error) if error is not None else '',
            'columns': {name: columns_of(study, name, existing(study, name, wanted)) for name, wanted in (columns or {}).items() if name in study},
        }
        if teeth:
            answer['scene'] = scene(case)
        return answer | {'seconds': time.perf_counter() - began}

    def stop(self, run: str) -> bool:
        """Ends a run; returns False if there is none with this name."""
        with self._lock:
            stop = self._stops.get(run)
        if stop is not None:
            stop.set()
        return stop is not None

    def table(self, study: str, table: str, columns: list[str] | None = None) -> dict[str, list[Any]]:
        """Returns columns of a table, row by row."""
        return columns_of(self.study(study), table, columns)

    def study(self, name: str) -> Study:
        with self._lock:
            if name not in self._studies:
                raise StudyDropped(name)
            self._studies.move_to_end(name)
            return self._studies[name]

    def _keep(self, study: Study, drop: str) -> str:
        name = secrets.token_urlsafe(12)
        with self._lock:
            self._studies.pop(drop, None)
            self._studies[name] = study
            while len(self._studies) > _MOST:
                self._studies.popitem(last=False)
        return name


def existing(study: Study, table: str, columns: list[str] | None) -> list[str]:
    """Returns those of the columns that the table has; all columns if none are named."""
    return [name for name in study[table] if columns is None or name in columns]


def columns_of(study: Study, table: str, columns: list[str] | None) -> dict[str, list[Any]]:
    """Returns values row by row, in the form of JSON: NaN is None.

    Raises
    ------
    Error
        There is no such table or column.
    """
    try:
        return {name: _values(study._column(table, name)) for name in (list(study[table]) if columns is None else columns)}
    except KeyError as error:
        raise Error(str(error.args[0])) from error


def _values(values: np.ndarray) -> list[Any]:
    if values.dtype.kind == 'f' and not np.isfinite(values).all():
        return [value if math.isfinite(value) else None for value in values.tolist()]
    return values.tolist()


def error_json(error: Error) -> dict[str, Any]:
    """Formats an error, with the group and key at the beginning of its message."""
    named = _NAMED.match(str(error))
    group, key = named.groups() if named else (None, None)
    return {'message': str(error), 'code': error.code.name, 'group': group, 'key': key}
