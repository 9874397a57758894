"""Computes blocks of variants with an executor: a limited number at a time, with recovery after the death of a worker."""

from __future__ import annotations

import contextlib
import math
import os
import pickle
import sys
import threading
import time
import warnings
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Executor, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.library import Code, Error
from .rows import Job, build_id, compute

Reals = NDArray[np.float64]
#: Number of parts of a block whose worker died: with Dask each part that contains the cause costs several workers.
_PARTS = 8
#: Number of separate trials of a single variant before it is reported to end its process.
_TRIES = 2
#: Seconds between two counts of the workers, and the longest wait during which Ctrl-C has no effect (Windows).
_LOOK, _WAIT = 5.0, 1.0
#: Seconds without any worker of a cluster before a warning.
_SILENT = 10.0
#: Seconds that processes have to end by themselves after their last block; a call that its time limit abandoned may go on in them.
_GRACE = 5.0


class NoWorkerWarning(UserWarning):
    """A run of many variants waits for a cluster that has no worker."""


class Inline(Executor):
    """Executor that computes in this thread on submission."""

    def submit(self, call, /, *arguments, **options) -> Future:
        future: Future = Future()
        try:
            future.set_result(call(*arguments, **options))
        except Exception as error:
            future.set_exception(error)
        return future


class Workers:
    """The executor, whatever the caller passed: None, a number of processes, an executor, a Dask client, or a function that
    returns an executor; and the time limit for the wait for a worker of a cluster.
    """

    def __init__(self, executor: Any, patience: float | None = None):
        self.make: Callable[[], Executor] | None = None
        self.client = None
        if executor is None:
            self.executor: Executor = Inline()
        elif isinstance(executor, int) and not isinstance(executor, bool):
            if executor < 1:
                raise Error(f'executor = {executor}: must be a number of processes, at least 1')
            self.make = lambda: _processes(executor)
        elif hasattr(executor, 'get_executor'):  # a Client of Dask, whose own futures are of another kind
            self.client = executor
            self.executor = executor.get_executor(pure=False)
        elif isinstance(executor, Executor):
            self.executor = executor
        elif callable(executor):
            self.make = executor
        else:
            raise TypeError(f'executor: must be an Executor, a function that makes one, a dask Client or a number of processes, not '
                            f'{type(executor).__name__}')  # fmt: skip
        if self.make:
            self.executor = self.make()
        self.counted_at, self.count, self.checked = -math.inf, 1, False
        self.patience, self.last_seen, self.warned = patience, time.monotonic(), False

    def __enter__(self) -> Workers:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        self.close(at_once=kind is not None)

    def parallel(self) -> int:
        """Number of blocks that are computed at a time."""
        if isinstance(self.executor, Inline):
            return 1
        if self.client is None:
            return getattr(self.executor, '_max_workers', None) or os.cpu_count() or 1
        self._count_workers()
        return max(1, self.count)

    def _count_workers(self) -> None:
        """Counts the workers of a cluster at intervals."""
        if self.client is None or time.monotonic() - self.counted_at <= _LOOK:
            return
        with contextlib.suppress(Exception):  # a lost scheduler is reported by its futures
            self.count = sum(self.client.nthreads().values())
        self.counted_at = time.monotonic()
        if self.count:
            self.last_seen, self.warned = self.counted_at, False

    def check_cluster(self) -> None:
        """Warns if a cluster has had no worker for some seconds.

        Raises
        ------
        Error
            It has had none for longer than the caller's limit.
        """
        self._count_workers()
        if self.count:
            return
        without = time.monotonic() - self.last_seen
        if self.patience is not None and without >= self.patience:
            raise Error(f'the Dask cluster has had no worker for {without:.0f} s; finished blocks are kept, and the same call continues', Code.INTERRUPTED)
        if without >= _SILENT and not self.warned:
            self.warned = True
            warnings.warn(f'the Dask cluster has had no worker for {without:.0f} s; the run continues when it has one', NoWorkerWarning, stacklevel=2)

    def submit(self, call: Callable, *arguments: Any) -> Future:
        """Submits a call to the executor, which may start a process for it."""
        with _defer_interrupt() if self.make else contextlib.nullcontext():
            return self.executor.submit(call, *arguments)

    def renew(self) -> bool:
        """Builds a new executor for one that broke; returns False if it is the caller's."""
        if self.make is None:
            return False
        self.close()
        self.executor = self.make()
        return True

    def close(self, at_once: bool = False) -> None:
        """Shuts down an executor of this package; `at_once`: without waiting for its calls."""
        if self.make is None:
            return
        processes = list((getattr(self.executor, '_processes', None) or {}).values())

        def kill() -> None:
            for process in processes:
                process.kill()

        if at_once:
            kill()
        timer = threading.Timer(_GRACE, kill)
        timer.daemon = True
        timer.start()
        self.executor.shutdown(wait=True, cancel_futures=True)
        timer.cancel()

    def check(self, job: Job) -> None:
        """Raises an `Error` if the work cannot be sent to processes, or if these end at their start."""
        if isinstance(self.executor, ProcessPoolExecutor) and not self.checked:
            self.checked = True
            try:
                pickle.dumps(job)
            except Exception as error:
                raise Error(f'reduce: cannot be sent to other processes: {error}; use a function of a module that they can import') from error
            try:
                first = self.submit(build_id)
            except BrokenExecutor:  # much earlier: reported by the first block
                return
            try:
                first.result()
            except BrokenExecutor as error:
                raise Error("processes end as they start: put the lines of the script below if __name__ == '__main__'",
                            Code.INTERRUPTED) from error  # fmt: skip


def _processes(count: int) -> Executor:
    """Returns processes that ignore Ctrl-C, and that end with this one."""
    import multiprocessing

    context = multiprocessing.get_context('spawn')
    return ProcessPoolExecutor(count, mp_context=context, initializer=_initialise)


@contextlib.contextmanager
def _defer_interrupt() -> Iterator[None]:
    """Delays Ctrl-C in this process, and blocks it in processes that are started, also before `_follow` runs in them."""
    import signal

    if not hasattr(signal, 'pthread_sigmask'):  # Windows
        yield
        return
    from multiprocessing import resource_tracker

    resource_tracker.ensure_running()  # otherwise it starts with the first process, and unblocks Ctrl-C
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _initialise() -> None:
    """In a computing process, leaves Ctrl-C and SIGTERM to the parent, and ends the process if the parent is killed."""
    import multiprocessing
    import signal

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
    """The variants from `first` up to, not including, `stop`.

    Attributes
    ----------
    tries : int
        Number of times that its worker died while nothing else was computed.
    alone : bool
        True if it is computed while nothing else is.
    """

    first: int
    stop: int
    tries: int = 0
    alone: bool = False


class Dispatcher:
    """Computes blocks, a window of them at a time.

    If workers die, the blocks in progress are suspects: each is computed again while nothing else is. If its worker then dies
    again, the block is divided into parts, down to single variants.
    """

    def __init__(self, workers: Workers, job: Job, rows: Callable[[int, int], Reals], window: int | None, call: Callable[[Job, Reals], Any] = compute):
        self.workers, self.job, self.rows, self.window, self.call = workers, job, rows, window, call
        self.running: dict[Future, Piece] = {}
        self.suspects: list[Piece] = []

    def run(self, blocks: Iterable[tuple[int, int]]) -> Iterator[tuple[Piece, Any]]:
        """Produces pieces with their results, in the order in which they end; None: the variant ends its process.

        Raises
        ------
        Error
            The executor is lost, cannot accept the work, or has had no worker for too long.
        """
        todo = deque(Piece(*block) for block in blocks)
        try:
            while todo or self.suspects or self.running:
                self._fill(todo)
                done, _ = wait(self.running, _WAIT, FIRST_COMPLETED)
                if not done:
                    self.workers.check_cluster()
                for future in done:
                    piece = self.running.pop(future)
                    yield from self._finished(future, piece)
        finally:
            for future in self.running:
                future.cancel()
            self.running.clear()

    def _fill(self, todo: deque[Piece]) -> None:
        if self.suspects:
            if not self.running:
                one = self.suspects.pop()
                self._submit(Piece(one.first, one.stop, one.tries, alone=True))
            return
        window = self.window or max(2, 3 * self.workers.parallel())
        while todo and len(self.running) < (1 if isinstance(self.workers.executor, Inline) else window):
            if not self._submit(todo.popleft()):
                return

    def _submit(self, piece: Piece) -> bool:
        values = self.rows(piece.first, piece.stop)
        try:
            future = self.workers.submit(self.call, self.job, values)
        except BrokenExecutor:  # a worker died between two blocks
            self.suspects.append(piece)
            if not self.running:
                self._renew()
            return False
        except Exception as error:
            raise Error(f'the executor accepts no work: {type(error).__name__}: {error}', Code.INTERRUPTED) from error
        self.running[future] = piece
        return True

    def _finished(self, future: Future, piece: Piece) -> Iterator[tuple[Piece, Any]]:
        try:
            block = future.result()
        except CancelledError as error:
            raise Error('the scheduler is gone, or cancelled the work; the same call continues', Code.INTERRUPTED) from error
        except Exception as error:
            if not _is_death(error):
                raise Error(f'a worker cannot compute: {type(error).__name__}: {error}', Code.INTERRUPTED) from error
            yield from self._worker_died(piece)
            if isinstance(error, BrokenExecutor) and not self.running:
                self._renew()
        else:
            yield piece, block

    def _worker_died(self, piece: Piece) -> Iterator[tuple[Piece, Any]]:
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
        if not self.workers.renew():
            raise Error('a worker process ended, and the pool with it; the same call continues with a new one. A function that returns the pool '
                        'as executor, or a number of processes, continues by itself, and finds a variant that ends its process',
                        Code.INTERRUPTED)  # fmt: skip


def _is_death(error: Exception) -> bool:
    """True if a worker died. Dask has an exception of its own for a block of which several workers died."""
    scheduler = sys.modules.get('distributed.scheduler')
    return isinstance(error, BrokenExecutor) or (scheduler is not None and isinstance(error, scheduler.KilledWorker))
