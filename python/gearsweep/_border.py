"""The border to the library: the only module that calls it.

Texts go in and come out as bytes of UTF-8; a failed call becomes an `Error`. What the calls do is told in
src/doors/gearsweep_flat*.f90.
"""

from __future__ import annotations

import enum
import os
import warnings
from collections.abc import Callable
from math import prod
from operator import index

import numpy as np

from . import _flat
from ._watch import in_background, watched

#: No stiffness is passed in: the call finds it itself.
NO_WORK = np.empty(0)


class Code(enum.IntEnum):
    """What went wrong: the exit codes of the program."""

    OK = 0
    INPUT = 1  #: the case or an argument is not usable
    USAGE = 2  #: the command line is not usable
    FILE = 3  #: a file or folder cannot be read or written
    PARTIAL = 4  #: some operating points have no answer
    INTERRUPTED = 130  #: the run was ended before it was done
    NUMERICAL = 5  #: a method did not deliver, although the input is valid
    MEMORY = 6  #: the work does not fit into memory


class Error(Exception):
    """A call failed; the message is the library's.

    Attributes
    ----------
    code : Code
        What went wrong.

    Examples
    --------
    >>> import gearsweep
    >>> try:
    ...     gearsweep.geometry(gearsweep.Case('&pair modul_mm = 3 /'))
    ... except gearsweep.Error as error:
    ...     print(error.code.name, error)
    INPUT &pair modul_mm = 3: unknown key (did you mean module_mm?)...
    """

    def __init__(self, message: str, code: Code = Code.INPUT):
        super().__init__(message)
        self.code = Code(code)


class PartialWarning(UserWarning):
    """Some operating points have no answer; they are NaN and their status says why."""


class UnusedWarning(UserWarning):
    """The case gives keys that it does not use, mostly for tasks that it does not name; they change nothing."""


def version() -> str:
    return _call(_flat.gs_version)[0].decode()


def sizes(text: str, folder: str) -> dict[str, int]:
    names = ('speeds', 'reliefs', 'rows', 'tried', 'positions', 'modes', 'nodes', 'elements', 'harmonics', 'nwork')
    return dict(zip(names, _call(_flat.gs_sizes, _bytes(text), _bytes(folder)), strict=True))


def prepare(text: str, folder: str, nwork: int) -> np.ndarray:
    return _call(_flat.gs_prepare, _bytes(text), _bytes(folder), nwork)[0]


def geometry(text: str) -> list:
    return _call(_flat.gs_geometry, _bytes(text))


def outline(text: str, member: int) -> np.ndarray:
    """Points (x and y in mm) of the outline of the pinion (1) or the gear (2)."""
    points, x, y = _with_room(_flat.gs_outline, _bytes(text), _integer('member', member))
    return np.column_stack((x[:points], y[:points]))


def motion(text: str, work: np.ndarray) -> list:
    return _call(_flat.gs_motion, _bytes(text), _work(work))


def mesh(text: str, work: np.ndarray, rows: int) -> list:
    return _call(_flat.gs_mesh, _bytes(text), _work(work), rows)


def harmonics(text: str, work: np.ndarray, harmonics: int, reliefs: int) -> list:
    return _call(_flat.gs_harmonics, _bytes(text), _work(work), harmonics, reliefs)


def load(text: str, work: np.ndarray) -> list:
    rows, *columns = _with_room(_flat.gs_load, _bytes(text), _work(work))
    return [column[:rows].copy() for column in columns]


def resonances(rpm: np.ndarray, dynamic_factor: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    found, peak_rpm, peak_factor = _call(_flat.gs_resonances, rpm, dynamic_factor)
    return peak_rpm[:found], peak_factor[:found]


def stability(text: str, work: np.ndarray, rpm: np.ndarray, damping_ratio: np.ndarray, tongues: int) -> list:
    return _call(_flat.gs_stability, _bytes(text), _work(work), rpm, damping_ratio, _size('tongues', tongues, 100))


def follow(text: str, work: np.ndarray, relief: int, rpm: np.ndarray, jump: float, closeness: float) -> list:
    """Changes (four arrays, a change a row) and what there is at each speed."""
    changes, *found = _with_room(_flat.gs_follow, _bytes(text), _work(work), _integer('relief', relief), rpm,
                                 _real('jump', jump), _real('closeness', closeness))
    return [ends[:, :changes].T.copy() for ends in found[:4]] + found[4:]


def strobe(
    text: str, work: np.ndarray, relief: int, rpm: np.ndarray, start: tuple[float, float], settle: int, keep: int
) -> list:
    keep = _size('keep', keep, 10**7)
    start = tuple(_real('start', one) for one in start)
    relief, settle = _integer('relief', relief), _integer('settle', settle)
    return _call(_flat.gs_strobe, _bytes(text), _work(work), relief, rpm, *start, settle, keep)


def section(text: str, nodes: int, elements: int) -> list:
    """Nodes and elements; here the nodes of an element are counted from 0, an element a row."""
    x, y, element, tooth = _call(_flat.gs_section, _bytes(text), nodes, elements)
    return [x, y, np.ascontiguousarray(element.T) - 1, tooth]


def modes(text: str, modes: int, nodes: int) -> list:
    return _call(_flat.gs_modes, _bytes(text), modes, nodes)


def root(text: str, work: np.ndarray, positions: int, reliefs: int) -> list:
    return _call(_flat.gs_root, _bytes(text), _work(work), positions, reliefs)


def stress(text: str, work: np.ndarray, position: int, relief: int, nodes: int) -> list:
    """Here position and relief are counted from 0."""
    position, relief = _integer('position', position), _integer('relief', relief)
    return _call(_flat.gs_stress, _bytes(text), _work(work), position + 1, relief + 1, nodes)


def report(text: str, folder: str, work: np.ndarray, threads: int) -> str:
    return _text(_flat.gs_report, 1_000_000, _bytes(text), _bytes(folder), _work(work), _threads(threads))


def complete(text: str) -> str:
    return _text(_flat.gs_complete, 2 * len(text) + 20_000, _bytes(text))


def unused(text: str) -> list[str]:
    return _text(_flat.gs_unused, 5_000, _bytes(text)).splitlines()


def change(text: str, group: str, key: str, value: str) -> str:
    return _text(_flat.gs_change, 4 * (len(text) + len(value)) + 1000, *map(_bytes, (text, group, key, value)))


def run(
    text: str,
    folder: str,
    work: np.ndarray,
    threads: int,
    room: int,
    out: str = '',
    name: str = '',
    *,
    progress: Callable[[int, int], object] | None = None,
    resume: str = '',
    keep: str = '',
) -> tuple[dict[str, dict], str, str, list[str], Error | None]:
    """What the program does: numbers, answer, stages, files written, and the error that it ended with, if any.

    The numbers are arrays by task and name; `room` is how many they may be, 0 if they are not wanted. Without
    `out` there are only they. An exception that comes up meanwhile, such as KeyboardInterrupt or one of
    `progress`, ends the call soon; it is then the cause of an error with the code INTERRUPTED.
    """
    answer_room = 1_000_000 if out else 1
    while True:
        answer = np.array(b' ' * answer_room)
        words = [_bytes(word) for word in (text, folder, out, name, resume, keep)]
        given, team, rows = _work(work), _threads(threads), room

        def call(watch: np.ndarray) -> tuple:
            return _flat.gs_all(*words[:2], given, team, *words[2:4], watch, *words[4:], rows, answer)

        found, cause = watched(call, progress)
        values, used, names, length, stages, files, info, message = found
        if cause is not None or (used <= room and length <= answer_room):
            break
        room, answer_room = max(room, used), max(answer_room, length)
    error = Error(_str(message), Code(info)) if info else None
    if cause is not None:
        error = error if info else Error('interrupted at its end', Code.INTERRUPTED)
        error.__cause__ = cause
        if used > room:
            return {}, '', '', [], error
    return _named(values, _str(names)), _str(answer.item()), _str(stages), _str(files).splitlines(), error


def _named(values: np.ndarray, names: str) -> dict[str, dict]:
    """Arrays, and single numbers, out of the row of all."""
    found: dict[str, dict] = {}
    first = 0
    for line in names.splitlines():
        name, *sizes = line.split()
        task, field = name.split('.')
        shape = tuple(map(int, sizes))
        last = first + prod(shape)
        array = values[first:last].reshape(shape, order='F').copy('K')
        found.setdefault(task, {})[field] = array if shape else float(array)
        first = last
    return found


def _call(procedure, *arguments) -> list:
    try:
        found = in_background(procedure, *arguments)
    except OverflowError as error:
        raise Error(f'an argument is too large: {error}') from error
    return _checked(found)


def _with_room(procedure, *arguments) -> list:
    """The results of a call whose last argument is the room for its rows, and its first result their number."""
    room = 10_000
    try:
        results = in_background(procedure, *arguments, room)
    except OverflowError as error:
        raise Error(f'an argument is too large: {error}') from error
    if results[0] > room:
        results = in_background(procedure, *arguments, results[0])
    return _checked(results)


def _checked(results: tuple) -> list:
    """All results but the last two, which are the code and the message of every call."""
    *found, info, message = results
    if info == Code.PARTIAL:
        warnings.warn(_str(message), PartialWarning, stacklevel=5)
    elif info != Code.OK:
        raise Error(_str(message), Code(info))
    return found


def _text(procedure, room: int, *arguments) -> str:
    """The text that a call leaves in its last argument; asked for again where it needs more room."""
    while True:
        text = np.array(b' ' * room)
        length, info, message = in_background(procedure, *arguments, text)
        if length <= room:
            break
        room = length
    if info not in (Code.OK, Code.PARTIAL):
        raise Error(_str(message), Code(info))
    return _str(text.item())


def _bytes(text: str) -> bytes:
    if '\0' in text:
        raise Error('text: has a NUL character')
    try:
        return text.encode('utf-8', 'surrogateescape')
    except UnicodeEncodeError as error:
        raise Error(f'text: {error}') from error


def _str(text: bytes) -> str:
    return text.decode('utf-8', 'surrogateescape')


_is_fork = False


def _forked() -> None:
    global _is_fork
    _is_fork = True


if hasattr(os, 'register_at_fork'):
    os.register_at_fork(after_in_child=_forked)


def _integer(name: str, n: int) -> int:
    """An integer as the library's arguments have it."""
    if not -(2**31) <= index(n) < 2**31 - 1:
        raise Error(f'{name} = {n}: must be from {-(2**31)} to {2**31 - 2}')
    return index(n)


def reals(name: str, values) -> np.ndarray:
    """A row of real numbers, of which nothing is lost: no imaginary parts, no mask."""
    if np.ma.isMaskedArray(values):
        raise TypeError(f'{name}: is a masked array; give the numbers that count, or NaN')
    if np.asarray(values).dtype.kind == 'c':
        raise TypeError(f'{name}: is complex; must be real')
    try:
        return np.array(values, dtype=float, ndmin=1)
    except OverflowError as error:
        raise Error(f'{name}: {error}') from error


def _real(name: str, x: float) -> float:
    """Of a complex number f2py would take the real part without a word."""
    if np.iscomplexobj(x) or np.ma.isMaskedArray(x):
        raise TypeError(f'{name} = {x}: must be real')
    return x


def _size(name: str, n: int, most: int) -> int:
    """The size of a result, which is refused before there is room made for it."""
    if not 0 <= index(n) <= most:
        raise Error(f'{name} = {n}: must be from 0 to {most}')
    return index(n)


def _threads(threads: int) -> int:
    """One in a forked process, where GNU's OpenMP would wait for the parent's threads for ever."""
    threads = _integer('threads', threads)
    return 1 if _is_fork and threads >= 0 else threads


def _work(work: np.ndarray) -> np.ndarray:
    work = np.asanyarray(work)
    if np.ma.isMaskedArray(work) or work.ndim != 1 or work.dtype.kind not in 'fiu':
        raise TypeError('work: must be the array that prepare gives')
    return np.ascontiguousarray(work, dtype=np.float64)
