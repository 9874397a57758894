"""Blocks of variants over an executor: so many at a time, and what to do where a worker dies."""

from __future__ import annotations

import contextlib
import math
import os
import pickle
import sys
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Executor, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._library import Code, Error
from .rows import Job, compute, made_here

Reals = NDArray[np.float64]
#: A block whose worker died is cut into so many parts: with Dask each part that holds the cause costs several workers.
_PARTS = 8
#: So often a single variant is tried alone before it is said to end its process.
_TRIES = 2
#: Seconds between two looks at how many workers there are, and the longest wait in which Ctrl-C is not seen (Windows).
_LOOK, _WAIT = 5.0, 1.0


class Here(Executor):
    """Computes in this thread, as it is submitted."""

    def submit(self, call, /, *arguments, **options) -> Future:
        future: Future = Future()
        try:
            future.set_result(call(*arguments, **options))
        except Exception as error:
            future.set_exception(error)
        return future


class Crew:
    """The executor, whatever the caller gave: none, a number of processes, an executor, a Dask client, or what makes an executor."""

    def __init__(self, given: Any):
        self.make: Callable[[], Executor] | None = None
        self.client = None
        if given is None:
            self.executor: Executor = Here()
        elif isinstance(given, int) and not isinstance(given, bool):
            if given < 1:
                raise Error(f'executor = {given}: must be a number of processes, at least 1')
            self.make = lambda: _processes(given)
        elif hasattr(given, 'get_executor'):  # a Client of Dask, whose own futures are of another kind
            self.client = given
            self.executor = given.get_executor(pure=False)
        elif isinstance(given, Executor):
            self.executor = given
        elif callable(given):
            self.make = given
        else:
            raise TypeError(f'executor: must be an Executor, a function that makes one, a dask Client or a number of processes, not '
                            f'{type(given).__name__}')  # fmt: skip
        if self.make:
            self.executor = self.make()
        self.looked, self.count, self.checked = -math.inf, 1, False

    def __enter__(self) -> Crew:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        self.close(at_once=kind is not None)

    def workers(self) -> int:
        """How many blocks are computed at a time."""
        if isinstance(self.executor, Here):
            return 1
        if self.client is None:
            return getattr(self.executor, '_max_workers', None) or os.cpu_count() or 1
        if time.monotonic() - self.looked > _LOOK:
            with contextlib.suppress(Exception):  # one that is gone is told by its futures
                self.count = max(1, sum(self.client.nthreads().values()))
            self.looked = time.monotonic()
        return self.count

    def submit(self, call: Callable, *arguments: Any) -> Future:
        """As the executor does it, which may start a process for it."""
        with _ctrl_c_later() if self.make else contextlib.nullcontext():
            return self.executor.submit(call, *arguments)

    def renew(self) -> bool:
        """Makes a new executor for one that broke; False: it is the caller's, who alone can."""
        if self.make is None:
            return False
        self.close()
        self.executor = self.make()
        return True

    def close(self, at_once: bool = False) -> None:
        """Ends an executor of ours; at once: with what it still computes."""
        if self.make is None:
            return
        for process in list((getattr(self.executor, '_processes', None) or {}).values()) if at_once else ():
            process.kill()
        self.executor.shutdown(wait=True, cancel_futures=True)

    def check(self, job: Job) -> None:
        """Raises an `Error` where the work cannot be sent to processes, or these end as they start, before they are asked first."""
        if isinstance(self.executor, ProcessPoolExecutor) and not self.checked:
            self.checked = True
            try:
                pickle.dumps(job)
            except Exception as error:
                raise Error(f'reduce: cannot be sent to other processes: {error}; a function of a module that they can import can') from error
            try:
                first = self.submit(made_here)
            except BrokenExecutor:  # long before: told by the first block
                return
            try:
                first.result()
            except BrokenExecutor as error:
                raise Error("processes end as they start: a script that starts some has its own lines below if __name__ == '__main__'",
                            Code.INTERRUPTED) from error  # fmt: skip


def _processes(count: int) -> Executor:
    """Processes that leave Ctrl-C to this one, and end with it."""
    import multiprocessing

    context = multiprocessing.get_context('spawn')
    return ProcessPoolExecutor(count, mp_context=context, initializer=_follow)


@contextlib.contextmanager
def _ctrl_c_later() -> Iterator[None]:
    """Ctrl-C comes later here, and not at all to processes that are started, also while they begin, before `_follow`."""
    import signal

    if not hasattr(signal, 'pthread_sigmask'):  # Windows
        yield
        return
    from multiprocessing import resource_tracker

    resource_tracker.ensure_running()  # else as the first process starts, and that lets Ctrl-C in again
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _follow() -> None:
    """In a process that computes: Ctrl-C and SIGTERM are the parent's, and where that is killed, nobody else would end this one."""
    import multiprocessing
    import signal
    import threading

    for one in (signal.SIGINT, signal.SIGTERM):
        signal.signal(one, signal.SIG_IGN)
    parent = multiprocessing.parent_process()

    def end() -> None:
        if parent is not None:
            parent.join()
            os._exit(1)

    threading.Thread(target=end, daemon=True).start()


@dataclass(frozen=True)
class Piece:
    """The variants from `first` to before `stop`.

    Attributes
    ----------
    tries : int
        How often its worker died while nothing else was computed.
    alone : bool
        It is computed while nothing else is.
    """

    first: int
    stop: int
    tries: int = 0
    alone: bool = False


class Flow:
    """Computes blocks, a window of them at a time.

    Where workers die, blocks that were under way are suspects: each is computed again while nothing else is. One that ends its worker
    then too is cut into parts, down to single variants.
    """

    def __init__(self, crew: Crew, job: Job, rows: Callable[[int, int], Reals], window: int | None, call: Callable[[Job, Reals], Any] = compute):
        self.crew, self.job, self.rows, self.window, self.call = crew, job, rows, window, call
        self.flying: dict[Future, Piece] = {}
        self.suspects: list[Piece] = []

    def run(self, blocks: Iterable[tuple[int, int]]) -> Iterator[tuple[Piece, Any]]:
        """Pieces with what the call made of them, in the order in which they end; None: the variant ends its process.

        Raises
        ------
        Error
            The executor is gone, or cannot take the work.
        """
        todo = deque(Piece(*block) for block in blocks)
        try:
            while todo or self.suspects or self.flying:
                self._fill(todo)
                done, _ = wait(self.flying, _WAIT, FIRST_COMPLETED)
                for future in done:
                    piece = self.flying.pop(future)
                    yield from self._landed(future, piece)
        finally:
            for future in self.flying:
                future.cancel()
            self.flying.clear()

    def _fill(self, todo: deque[Piece]) -> None:
        if self.suspects:
            if not self.flying:
                one = self.suspects.pop()
                self._submit(Piece(one.first, one.stop, one.tries, alone=True))
            return
        window = self.window or max(2, 3 * self.crew.workers())
        while todo and len(self.flying) < (1 if isinstance(self.crew.executor, Here) else window):
            if not self._submit(todo.popleft()):
                return

    def _submit(self, piece: Piece) -> bool:
        values = self.rows(piece.first, piece.stop)
        try:
            future = self.crew.submit(self.call, self.job, values)
        except BrokenExecutor:  # a worker died between two blocks
            self.suspects.append(piece)
            if not self.flying:
                self._renew()
            return False
        except Exception as error:
            raise Error(f'the executor takes no work: {type(error).__name__}: {error}', Code.INTERRUPTED) from error
        self.flying[future] = piece
        return True

    def _landed(self, future: Future, piece: Piece) -> Iterator[tuple[Piece, Any]]:
        try:
            block = future.result()
        except CancelledError as error:
            raise Error('the scheduler is gone, or cancelled the work; the same call goes on', Code.INTERRUPTED) from error
        except Exception as error:
            if not _is_death(error):
                raise Error(f'a worker cannot compute: {type(error).__name__}: {error}', Code.INTERRUPTED) from error
            yield from self._died(piece)
            if isinstance(error, BrokenExecutor) and not self.flying:
                self._renew()
        else:
            yield piece, block

    def _died(self, piece: Piece) -> Iterator[tuple[Piece, Any]]:
        if not piece.alone:
            self.suspects.append(piece)
        elif piece.stop - piece.first > 1:
            step = -(-(piece.stop - piece.first) // _PARTS)
            self.suspects += [Piece(at, min(at + step, piece.stop)) for at in range(piece.first, piece.stop, step)]
        elif piece.tries + 1 < _TRIES:
            self.suspects.append(Piece(piece.first, piece.stop, piece.tries + 1))
        else:
            yield piece, None

    def _renew(self) -> None:
        if not self.crew.renew():
            raise Error('a worker process ended, and the pool with it; the same call goes on with a new one. A function that makes the pool '
                        'as executor, or a number of processes, goes on by itself, and finds a variant that ends its process',
                        Code.INTERRUPTED)  # fmt: skip


def _is_death(error: Exception) -> bool:
    """Did a worker die? Dask's own exception says so of the block that several workers died of."""
    scheduler = sys.modules.get('distributed.scheduler')
    return isinstance(error, BrokenExecutor) or (scheduler is not None and isinstance(error, scheduler.KilledWorker))
