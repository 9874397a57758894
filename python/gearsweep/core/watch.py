"""Long calls in a separate thread, so that Ctrl-C and progress are handled at once.

A call into the library does not hold Python's lock, but signals are handled only by the main thread, and only between two
steps of Python. The call therefore runs in a thread of its own, while the main thread waits.
"""

from __future__ import annotations

import atexit
import ctypes
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np

#: Seconds between two checks of the progress.
_INTERVAL = 0.1

#: Seconds after a request to stop until the caller no longer waits for the run.
_GRACE = 0.7

#: Seconds that the end of the interpreter waits for a run that was requested to stop.
_LAST = 60


class _Worker(threading.Thread):
    """Runs a call; `done` is set when it has ended."""

    def __init__(self, call: Callable[[], Any], drop: Callable[[Any], object]):
        super().__init__(daemon=True, name='gearsweep')
        self.call = call
        self.drop = drop
        self.done = threading.Event()
        self.result: Any = None
        self.error: BaseException | None = None
        self.is_abandoned = False
        self.lock = threading.Lock()

    def run(self) -> None:
        try:
            self.result = self.call()
        except BaseException as error:  # passed on to the waiting thread
            self.error = error
        with self.lock:
            self.done.set()
            if self.is_abandoned and self.error is None:
                self.drop(self.result)

    def abandon(self) -> bool:
        """Marks the result as no longer needed; False if it already exists."""
        with self.lock:
            self.is_abandoned = not self.done.is_set()
        return self.is_abandoned

    def answer(self) -> Any:
        if self.error is not None:
            raise self.error
        return self.result


@atexit.register
def _wait_for_calls() -> None:
    """Waits for abandoned calls, which would otherwise use libraries unloaded at the end of the process."""
    for thread in threading.enumerate():
        if isinstance(thread, _Worker):
            thread.join(_LAST)


class Stopped(Exception):
    """Another thread stopped the run."""


class Late(Exception):
    """The run has not ended within its time limit."""


def watched(
    call: Callable[[np.ndarray], Any],
    progress: Callable[[int, int], object] | None,
    drop: Callable[[Any], object],
    waits: bool = False,
    stop: threading.Event | None = None,
    seconds: float | None = None,
) -> tuple[Any, BaseException | None]:
    """Runs `call(watch)`; returns its results, and the exception that ended it, if any.

    `watch` holds the stop flag, and the numbers of finished and of all points; `progress` is called with the last two in the
    calling thread. If another thread sets `stop`, the exception is `Stopped`; if the call takes more than `seconds`, it is `Late`.
    After an exception the call is requested to stop. If it is in a part without a check of the flag, the exception is returned at
    once; the call ends in the background, and `drop` receives its results. With `waits`, the call first finishes the points in
    progress, as the finished ones are kept.
    """
    watch = np.zeros(3, dtype=np.intc)
    if progress is None and stop is None and seconds is None and threading.current_thread() is not threading.main_thread():
        return call(watch), None
    worker = _Worker(lambda: call(watch), drop)
    try:
        worker.start()
    except RuntimeError:  # no thread can be started, as at the end of the interpreter
        return call(watch), None
    cause = None
    reported = 0
    interval = _INTERVAL if progress or stop else None
    end = None if seconds is None else time.monotonic() + seconds
    try:
        while not worker.done.wait(interval if end is None else max(0.0, min(interval or _INTERVAL, end - time.monotonic()))):
            if stop and stop.is_set():
                raise Stopped
            if end is not None and time.monotonic() >= end:
                raise Late
            if progress and watch[1] > reported:
                reported = int(watch[1])
                progress(reported, int(watch[2]))
        if progress and watch[1] > reported:
            progress(int(watch[1]), int(watch[2]))
    except BaseException as error:
        cause = error
        watch[0] = 1
        try:
            worker.done.wait(None if waits and watch[2] > 0 else _GRACE)
        except BaseException as again:
            cause = again
    if cause is not None and worker.abandon():
        raise cause
    return worker.answer(), cause


class _Ended(BaseException):
    """Ends an abandoned Python call; not an Exception, as a loop may catch these and continue."""


def limited(call: Callable[[], Any], seconds: float) -> Any:
    """Returns the result of a Python call that runs in a thread of its own.

    Raises
    ------
    Late
        It has not ended within these seconds. An exception ends it at its next step of Python; the caller does not wait for that,
        but for a step that holds Python's lock.
    """
    worker = _Worker(call, lambda _: None)
    end = time.monotonic() + seconds
    worker.start()
    try:
        if not worker.done.wait(max(0.0, seconds)) or time.monotonic() > end:
            raise Late
    finally:
        if worker.abandon():
            ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(worker.ident or 0), ctypes.py_object(_Ended))
    return worker.answer()


def bar() -> Line | _Bar:
    """Returns a progress bar on stderr: that of tqdm if installed, otherwise a line that is overwritten."""
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
    """A line on stderr that is overwritten: finished points, per cent, remaining time."""

    def __init__(self, noun: str = 'points') -> None:
        self.noun = noun
        self.began = time.monotonic()
        self.first: int | None = None
        self.reported = False

    def __call__(self, done: int, total: int, failed: int = 0) -> None:
        if self.first is None:  # what is there already, as in the store of `many`, says nothing about the time
            self.first, self.began = done, time.monotonic()
        line = f'{done} of {total} {self.noun}, {100 * done // total} %' + (f', {failed} failed' if failed else '')
        seconds = time.monotonic() - self.began
        if seconds > 1 and done > self.first:
            line += f', {_duration(seconds * (total - done) / (done - self.first))} left'
        print(f'\r{line:60}', end='', file=sys.stderr, flush=True)
        self.reported = True

    def close(self) -> None:
        """Clears the line on a terminal, otherwise prints the last state."""
        if self.reported:
            print(f'\r{"":60}\r' if sys.stderr.isatty() else '', end='' if sys.stderr.isatty() else '\n', file=sys.stderr)


def _duration(seconds: float) -> str:
    if seconds < 100:
        return f'{seconds:.0f} s'
    return f'{seconds / 60:.0f} min' if seconds < 6000 else f'{seconds / 3600:.1f} h'
