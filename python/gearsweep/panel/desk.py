"""What the panel answers to its pages, without the web around it.

A page says all that it wants in each call: its case as text and where that lies. Kept here are only studies, under names that
nobody can guess, so that no window sees another's, and runs that can be ended.
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

from .. import _library
from .._given import given
from .._headlines import as_json
from .._library import Code, Error
from .._watch import Stopped
from ..case import written
from ..study import Study, attempt
from .places import Places, description
from .scene import scene

#: Studies that are kept for all windows; a page whose study is gone runs its case again.
_MOST = 40
#: Runs at once, as each takes all cores; others wait for their turn, and look every so many seconds whether they are stopped.
_AT_ONCE, _LOOK = 2, 0.1
_NAMED = re.compile(r'&(\w+)(?: (\w+))?')


class Gone(Exception):
    """A study is no longer kept."""


class Desk:
    """Answers the calls of the pages; any number of threads may ask at once."""

    def __init__(self, places: Places, start: Mapping[str, str]):
        self._places = places
        self._start = dict(start)
        self._studies: OrderedDict[str, Study] = OrderedDict()
        self._stops: dict[str, threading.Event] = {}
        self._lock = threading.Lock()
        self._turns = threading.Semaphore(_AT_ONCE)

    def about(self) -> dict[str, Any]:
        """All that a page needs once: the declarations, the cases at hand and the one to begin with."""
        return {**description(), 'cases': self._places.cases(), 'start': self._start}

    def open(self, place: str, name: str) -> dict[str, Any]:
        """A case of a folder."""
        return self.check(self._places.read(place, name), place) | {'name': name.removesuffix('.nml'), 'place': place}

    def check(self, text: str, place: str) -> dict[str, Any]:
        """What a text gives for each key, what is in effect, and the library's message where it is not usable."""
        answer: dict[str, Any] = {'text': text, 'given': given(text), 'values': {}, 'unused': [], 'error': None}
        try:
            case = self._places.case(text, place)
            answer |= {'values': _plain(case.values), 'unused': case.unused}
        except Error as error:
            answer['error'] = told(error)
        return answer

    def change(self, text: str, place: str, group: str, key: str, value: Any) -> dict[str, Any]:
        """The text with another value of a key, checked; None takes the key out.

        A string is what was typed, in the form of a case; of a key with one text, the text itself. What cannot stand in
        a case leaves the text as it is.
        """
        known = {(one['group'], one['name']): one for one in description()['keys']}
        about = known.get((group, key), {})
        is_text = about.get('kind') == 'text' and not about.get('list')
        words = value.strip() if isinstance(value, str) and not is_text else written(value or None)
        try:
            return self.check(_library.edit('change', text, group, key, words), place)
        except Error as error:
            return self.check(text, place) | {'error': {**told(error), 'group': group, 'key': key}, 'unchanged': True}

    def run(
        self, text: str, place: str, tasks: list[str] | None = None, earlier: str = '', drop: str = '',
        columns: Mapping[str, list[str] | None] | None = None, teeth: bool = False, run: str = '',
        progress: Callable[[int, int], object] | None = None,
    ) -> dict[str, Any]:  # fmt: skip
        """Runs a case: the name of its study, what its tables are, the columns wanted, and the answer as text.

        `earlier` is a study to start from, where it is still there; `drop` one that nobody needs any longer; `run` names
        the run, for `stop`; `teeth` asks for the tooth pair, too.

        Raises
        ------
        Error
            As the library's; with the code INTERRUPTED where it was stopped.
        """
        began = time.perf_counter()
        case = self._places.case(text, place)
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
            'columns': {name: columns_of(study, name, there(study, name, wanted)) for name, wanted in (columns or {}).items() if name in study},
        }
        if teeth:
            answer['scene'] = scene(case)
        return answer | {'seconds': time.perf_counter() - began}

    def stop(self, run: str) -> bool:
        """Ends a run; False where there is none of this name."""
        with self._lock:
            stop = self._stops.get(run)
        if stop is not None:
            stop.set()
        return stop is not None

    def table(self, study: str, table: str, columns: list[str] | None = None) -> dict[str, list[Any]]:
        """Columns of a table, row by row."""
        return columns_of(self.study(study), table, columns)

    def study(self, name: str) -> Study:
        with self._lock:
            if name not in self._studies:
                raise Gone(name)
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


def there(study: Study, table: str, columns: list[str] | None) -> list[str]:
    """Those of the columns that the table has; all where none are named."""
    return [name for name in study[table] if columns is None or name in columns]


def columns_of(study: Study, table: str, columns: list[str] | None) -> dict[str, list[Any]]:
    """Values row by row, as JSON has them: what is no number is None.

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


def _plain(values: Mapping[str, Mapping[str, Any]]) -> dict[str, dict[str, str]]:
    """Values in effect as a case has them."""
    return {group: {key: written(value) for key, value in keys.items()} for group, keys in values.items()}


def told(error: Error) -> dict[str, Any]:
    """An error with the group and key that its message begins with."""
    named = _NAMED.match(str(error))
    group, key = named.groups() if named else (None, None)
    return {'message': str(error), 'code': error.code.name, 'group': group, 'key': key}
