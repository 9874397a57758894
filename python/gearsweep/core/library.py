"""The library's calls in Python's types: the only module that calls it.

Texts are passed as bytes of UTF-8; a failed call becomes an `Error`. The calls are described in include/gearsweep.h.
"""

from __future__ import annotations

import ctypes
import enum
import functools
import json
import os
import signal
import threading
import weakref
from collections.abc import Callable
from operator import index
from typing import Any

import numpy as np

from .. import _flat
from .watch import watched

#: Initial buffer size; for a longer text the call returns its length and is repeated.
_USUAL_LENGTH = 100_000
#: Kinds of columns, as in `gs_size`.
_INTEGER, _WORDS = 2, 3


class Code(enum.IntEnum):
    """Kind of a failure: the exit codes of the program."""

    OK = 0
    INPUT = 1  #: the case or an argument is not usable
    USAGE = 2  #: the command line is not usable
    FILE = 3  #: a file or folder cannot be read or written
    PARTIAL = 4  #: some operating points have no result
    INTERRUPTED = 130  #: the run was ended before it was done
    NUMERICAL = 5  #: a method failed, although the input is valid
    MEMORY = 6  #: the work does not fit into memory


class Error(Exception):
    """A call failed; the message is the library's.

    Attributes
    ----------
    code : Code
        Kind of the failure.

    Examples
    --------
    >>> import gearsweep
    >>> try:
    ...     gearsweep.run(gearsweep.Case('&pair modul_mm = 3 /'), 'geometry')
    ... except gearsweep.Error as error:
    ...     print(error.code.name, error)
    INPUT &pair modul_mm = 3: unknown key (did you mean module_mm?)...
    """

    def __init__(self, message: str, code: Code = Code.INPUT):
        super().__init__(message)
        self.code = Code(code)


class PartialWarning(UserWarning):
    """Some operating points have no result; they are NaN and their status says why."""


class UnusedWarning(UserWarning):
    """The case has keys that it does not use, mostly for tasks that it does not request; they change nothing."""


def check_seconds(name: str, value: Any) -> None:
    """Raises an `Error`, which names the argument `name`, unless the time limit is None or a number above 0."""
    if value is not None and (isinstance(value, bool) or not isinstance(value, (int, float, np.integer, np.floating)) or not value > 0):
        raise Error(f'{name} = {value!r}: must be a number of seconds above 0')


def version() -> str:
    return _str(_checked(_flat.gs_version())[0]).rstrip()


@functools.cache
def kernel() -> str:
    """Returns the processor type whose kernel OpenBLAS chose, on which bits depend, or that `OPENBLAS_CORETYPE` named; 'unknown' for another BLAS."""
    try:
        name = ctypes.CDLL(_flat.__file__).openblas_get_corename
    except (OSError, AttributeError):
        return 'unknown'
    name.restype = ctypes.c_char_p
    return (name() or b'unknown').decode()


def describe(what: str) -> str:
    """Describes what the library has, as JSON."""
    return _text(_flat.gs_describe, _bytes(what))


@functools.cache
def declared() -> dict[str, list[dict[str, Any]]]:
    """Returns all tasks, groups and keys, as the library declares them."""
    return {what: json.loads(describe(what)) for what in ('tasks', 'groups', 'keys')}


def edit(action: str, text: str, group: str = '', key: str = '', value: str = '') -> str:
    """Edits the text of a case: 'complete', 'change', 'unused' ..."""
    return _text(_flat.gs_edit, *map(_bytes, (action, text, group, key, value)), length=2 * len(text) + len(value))


class Handle:
    """Handle of a study in the library's memory, which is freed with the last reference."""

    def __init__(self, address: int):
        self.address = address
        weakref.finalize(self, _free, address).atexit = False

    def text(self, what: str) -> str:
        """Returns a text of the study: 'report', 'log', 'tables' (as JSON) or 'case'."""
        return _text(_flat.gs_text, self.address, _bytes(what))

    def column(self, table: str, name: str) -> np.ndarray:
        """Returns the values of a column, row by row: reals, integers or words."""
        place = self.address, _bytes(table), _bytes(name)
        rows, kind, width = _checked(_flat.gs_size(*place))
        if kind != _WORDS:
            values = _checked(_flat.gs_column(*place, rows))[0]
            return values.astype(np.int64) if kind == _INTEGER else values
        words = []
        for row in range(rows):
            word = np.array(b' ' * max(1, width))  # f2py strips trailing blanks from the last word
            _checked(_flat.gs_words(*place, row + 1, word))
            words.append(_str(word.item()).rstrip())
        return np.array(words, dtype=np.str_)

    def word(self, table: str, name: str, row: int) -> str:
        """Returns the word of a column in one row; rows are counted from 0."""
        word = np.array(b' ' * _checked(_flat.gs_size(self.address, _bytes(table), _bytes(name)))[2] or b' ')
        _checked(_flat.gs_words(self.address, _bytes(table), _bytes(name), row + 1, word))
        return _str(word.item()).rstrip()

    def write(self, folder: str, name: str) -> list[str]:
        """Writes the study's tables and grids as files; returns their paths."""
        return _text(_flat.gs_write, self.address, _bytes(folder), _bytes(name)).splitlines()


def run(
    text: str, folder: str, threads: int, earlier: Handle | None, progress: Callable[[int, int], object] | None,
    stop: threading.Event | None = None, seconds: float | None = None, waits: bool = False,
) -> tuple[Handle | None, Error | None, BaseException | None]:  # fmt: skip
    """Runs a case; returns the study, if there is one, the error of the run, and the exception that ended it.

    The exception is one raised during the run, such as KeyboardInterrupt, an exception of `progress`, `Stopped` after `stop`, or
    `Late` after `seconds`. With `waits`, it returns after an exception only once the finished results exist.
    """
    words = [_bytes(word) for word in (text, folder)]
    team = _threads(threads)

    def call(watch: np.ndarray) -> tuple:
        # Keeps a reference to the earlier study as long as the call runs, also after the caller stopped waiting.
        return _flat.gs_run(*words, team, earlier.address if earlier else 0, watch, b'', b'')

    (address, info, message), cause = watched(call, progress, lambda found: _free(found[0]), waits=waits, stop=stop, seconds=seconds)
    error = Error(_str(message).rstrip(), Code(info)) if info else None
    return Handle(address) if address else None, error, cause


def run_rows(
    text: str, folder: str, names: str, values: np.ndarray, take: str, threads: int, earlier: Handle | None,
    progress: Callable[[int, int], object] | None, stop: threading.Event | None = None,
) -> tuple[Handle | None, Error | None, BaseException | None]:  # fmt: skip
    """Runs a case with rows of values (row, name) of some of its keys; returns the same as `run`."""
    words = [_bytes(word) for word in (text, folder)]
    keys, columns = _bytes(names), _bytes(take)
    rows, team = len(values), _threads(threads)
    numbers = np.append(np.ravel(values), 0.0)  # at least one element

    def call(watch: np.ndarray) -> tuple:
        return _flat.gs_rows(*words, team, earlier.address if earlier else 0, watch, keys, rows, numbers, columns)

    (address, info, message), cause = watched(call, progress, lambda found: _free(found[0]), waits=stop is not None, stop=stop)
    error = Error(_str(message).rstrip(), Code(info)) if info else None
    return Handle(address) if address else None, error, cause


def _free(address: int) -> None:
    try:
        _flat.gs_free(address)
    except KeyboardInterrupt:
        # Python drops exceptions of a finalizer: an interrupt in it is raised again afterwards.
        threading.Timer(0.02, os.kill, (os.getpid(), signal.SIGINT)).start()


def _checked(results: tuple) -> list:
    """Checks the last two results of a call, its code and message, and returns the others; raises an `Error` if it failed."""
    *found, info, message = results
    if info != Code.OK:
        raise Error(_str(message).rstrip(), Code(info))
    return found


def _text(procedure, *arguments, length: int = 0) -> str:
    """Returns the text in a call's last argument; repeats the call with a larger buffer if it is longer."""
    room = length + _USUAL_LENGTH
    while True:
        buffer = np.array(b' ' * room)
        length, info, message = procedure(*arguments, buffer)
        if length <= room:
            break
        room = length
    _checked((info, message))
    return _str(buffer.item()[:length])


def _bytes(text: str) -> bytes:
    if '\0' in text:
        raise Error('text: has a NUL character')
    try:
        return text.encode('utf-8', 'surrogateescape')
    except UnicodeEncodeError as error:
        raise Error(f'text: {error}') from error


def _str(text: bytes) -> str:
    return text.decode('utf-8', 'surrogateescape')


_fork: list[bool] = []  #: not empty in a forked process
if hasattr(os, 'register_at_fork'):
    os.register_at_fork(after_in_child=lambda: _fork.append(True))


def _threads(threads: int) -> int:
    """Returns the number of threads: one in a forked process, where GNU's OpenMP would wait for the parent's threads forever."""
    if not -(2**31) <= index(threads) < 2**31:
        raise Error(f'threads = {threads}: must be from 0 (all) to 1024')
    return 1 if _fork and threads >= 0 else index(threads)
