"""Long calls beside the interpreter, so that Ctrl-C and progress are not kept waiting.

A call into the library holds no lock of Python's, but signals are handled by the main thread alone, and only
between two steps of Python. So there the call runs in a thread of its own, and the main thread waits.
"""

from __future__ import annotations

import atexit
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np

#: Seconds between two looks at the progress.
_INTERVAL = 0.1

#: Seconds that a run has, once it is told to stop, until nobody waits for it any longer.
_GRACE = 0.7

#: Seconds that the end of the interpreter waits for a run that was told to stop.
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
        self.is_left = False
        self.lock = threading.Lock()

    def run(self) -> None:
        try:
            self.result = self.call()
        except BaseException as error:  # handed on to who waits
            self.error = error
        with self.lock:
            self.done.set()
            if self.is_left and self.error is None:
                self.drop(self.result)

    def leave(self) -> bool:
        """Nobody waits any longer: the result will be dropped. False where it is there already."""
        with self.lock:
            self.is_left = not self.done.is_set()
        return self.is_left

    def answer(self) -> Any:
        if self.error is not None:
            raise self.error
        return self.result


@atexit.register
def _wait_for_calls() -> None:
    """A call that nobody waits for any longer must not meet libraries that the end of the process has taken down."""
    for thread in threading.enumerate():
        if isinstance(thread, _Worker):
            thread.join(_LAST)


class Stopped(Exception):
    """Another thread told the run to stop."""


class Late(Exception):
    """The run has not ended within its seconds."""


def watched(
    call: Callable[[np.ndarray], Any],
    progress: Callable[[int, int], object] | None,
    drop: Callable[[Any], object],
    waits: bool = False,
    stop: threading.Event | None = None,
    seconds: float | None = None,
) -> tuple[Any, BaseException | None]:
    """The results of `call(watch)`, and the exception that ended it, if any.

    `watch` is stop, points done and of how many; `progress` is told the last two by the calling thread. Where another
    thread sets `stop`, that is as an exception `Stopped`, and `Late` where the call takes more than `seconds`. After an exception
    the call is told to stop. Where it is in a part that does not look, nobody waits for it: the exception comes out, the call ends
    in the background, and `drop` gets its results. With `waits`, points that are under way are waited for, as what is done by then
    is to be kept.
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
    told = 0
    looks = _INTERVAL if progress or stop else None
    end = None if seconds is None else time.monotonic() + seconds
    try:
        while not worker.done.wait(looks if end is None else max(0.0, min(looks or _INTERVAL, end - time.monotonic()))):
            if stop and stop.is_set():
                raise Stopped
            if end is not None and time.monotonic() >= end:
                raise Late
            if progress and watch[1] > told:
                told = int(watch[1])
                progress(told, int(watch[2]))
        if progress and watch[1] > told:
            progress(int(watch[1]), int(watch[2]))
    except BaseException as error:
        cause = error
        watch[0] = 1
        try:
            worker.done.wait(None if waits and watch[2] > 0 else _GRACE)
        except BaseException as again:
            cause = again
    if cause is not None and worker.leave():
        raise cause
    return worker.answer(), cause


def bar() -> Line | _Bar:
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

    def __init__(self, noun: str = 'points') -> None:
        self.noun = noun
        self.began = time.monotonic()
        self.first: int | None = None
        self.told = False

    def __call__(self, done: int, total: int, failed: int = 0) -> None:
        if self.first is None:  # what a resumed run takes over tells nothing of the time
            self.first, self.began = done, time.monotonic()
        line = f'{done} of {total} {self.noun}, {100 * done // total} %' + (f', {failed} failed' if failed else '')
        seconds = time.monotonic() - self.began
        if seconds > 1 and done > self.first:
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
