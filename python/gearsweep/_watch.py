"""Long calls beside the interpreter, so that Ctrl-C and progress are not kept waiting.

A call into the library holds no lock of Python's, but signals are handled by the main thread alone, and only
between two steps of Python. So there the call runs in a thread of its own, and the main thread waits.
"""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np

#: Seconds between two looks at the progress.
_INTERVAL = 0.1

#: Calls that end at once are not worth a thread.
_SHORT = {'gs_version', 'gs_sizes', 'gs_geometry', 'gs_outline', 'gs_resonances', 'gs_complete', 'gs_unused', 'gs_change'}


class _Worker(threading.Thread):
    """Runs a call; `done` is set when it has ended."""

    def __init__(self, call: Callable[[], Any]):
        super().__init__(daemon=True, name='gearsweep')
        self.call = call
        self.done = threading.Event()
        self.result: Any = None
        self.error: BaseException | None = None

    def run(self) -> None:
        try:
            self.result = self.call()
        except BaseException as error:  # handed on to who waits
            self.error = error
        finally:
            self.done.set()

    def answer(self) -> Any:
        if self.error is not None:
            raise self.error
        return self.result


def _begin(call: Callable[[], Any]) -> _Worker | None:
    """None where no thread can be started, as at the end of the interpreter."""
    worker = _Worker(call)
    try:
        worker.start()
    except RuntimeError:
        return None
    return worker


def in_background(procedure: Callable, *arguments: Any) -> Any:
    """The call's results. On Ctrl-C the main thread goes on at once; what is under way ends by itself."""
    short = getattr(procedure, '__name__', '').split()[-1:] or ['']
    if threading.current_thread() is not threading.main_thread() or short[0] in _SHORT:
        return procedure(*arguments)
    worker = _begin(lambda: procedure(*arguments))
    if worker is None:
        return procedure(*arguments)
    worker.done.wait()
    return worker.answer()


def watched(call: Callable[[np.ndarray], Any], progress: Callable[[int, int], object] | None) -> tuple[Any, BaseException | None]:
    """The results of `call(watch)`, and the exception that ended it, if any.

    `watch` is stop, points done and of how many; `progress` is told the last two by the calling thread.
    """
    watch = np.zeros(3, dtype=np.intc)
    if progress is None and threading.current_thread() is not threading.main_thread():
        return call(watch), None
    worker = _begin(lambda: call(watch))
    if worker is None:
        return call(watch), None
    cause = None
    told = 0
    try:
        while not worker.done.wait(_INTERVAL if progress else None):
            if progress and watch[1] > told:
                told = int(watch[1])
                progress(told, int(watch[2]))
        if progress and watch[1] > told:
            progress(int(watch[1]), int(watch[2]))
    except BaseException as error:
        cause = error
        watch[0] = 1
        worker.done.wait()
    return worker.answer(), cause


def bar() -> Callable[[int, int], None]:
    """Progress on stderr: tqdm's bar where that is installed, else a line that is written over."""
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return Line()
    return _Bar(tqdm)


class _Bar:
    def __init__(self, tqdm: type):
        self.bar = tqdm(unit='point')

    def __call__(self, done: int, total: int) -> None:
        self.bar.total = total
        self.bar.update(done - self.bar.n)

    def close(self) -> None:
        self.bar.close()


class Line:
    """A line on stderr that is written over: points done, per cent, time left."""

    def __init__(self) -> None:
        self.began = time.monotonic()
        self.first: int | None = None
        self.told = False

    def __call__(self, done: int, total: int) -> None:
        if self.first is None:
            self.first = done - 1
        line = f'{done} of {total} points, {100 * done // total} %'
        seconds = time.monotonic() - self.began
        if seconds > 1:
            line += f', {_duration(seconds * (total - done) / (done - self.first))} left'
        print(f'\r{line:60}', end='', file=sys.stderr, flush=True)
        self.told = True

    def close(self) -> None:
        """Leaves an empty line on a terminal, else the last state."""
        if self.told:
            print(f'\r{"":60}\r' if sys.stderr.isatty() else '', end='' if sys.stderr.isatty() else '\n', file=sys.stderr)


def _duration(seconds: float) -> str:
    if seconds < 100:
        return f'{seconds:.0f} s'
    return f'{seconds / 60:.0f} min' if seconds < 6000 else f'{seconds / 3600:.1f} h'
