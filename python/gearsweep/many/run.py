"""Runs a plan with an executor into a store, and continues an interrupted run."""

from __future__ import annotations

import contextlib
import dataclasses
import itertools
import os
import signal
import threading
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from ..core.library import Code, Error, UnusedWarning, check_seconds
from ..core.watch import Line
from . import reading
from . import store as stores
from .execution import Dispatcher, Piece, Workers
from .outputs import Layout, Reduce
from .plan import Plan, Snapshot
from .rows import Block, Job, Trial, build_id, empty, trial
from .status import ANSWERED, Status
from .store import Store

if TYPE_CHECKING:
    import xarray

#: Duration of a block in seconds, its largest number of variants, and the least number of blocks of a plan, if possible.
_SECONDS, _MOST, _BLOCKS = 10.0, 4096, 32
#: Number of variants that are tried for the shapes of the columns.
TRIED = 16
_ENDED = 'the process that computes it ends, even if it computes nothing else'

Progress = Callable[[int, int, int], object]


class NoResult(Error):
    """None of the first variants has a result."""


def run(
    plan: Plan, take: str | Sequence[str] = (), *, executor: Any = None, store: str | os.PathLike | None = None,
    size: int | None = None, window: int | None = None, seconds: float | None = None,
    progress: Progress | bool = False, reduce: Reduce | None = None, part: tuple[int, int] = (1, 1),
    again: Status | str | Sequence[Status | str] = (), wait: float | None = None,
) -> xarray.Dataset:  # fmt: skip
    """Computes the variants of a plan, each on one thread, and stores the requested columns.

    The numbers are the same bits for any executor, number of workers and size of blocks. Stored results are not computed again: the
    same call continues an interrupted run. Ctrl-C keeps all finished blocks.

    Parameters
    ----------
    plan : Plan
        From `Plan.sobol` and its like.
    take : 'table.column' or several
        Columns of numbers. A column is an array over the index columns of its table, such as the speed; those must be the same in all
        variants. Index columns of one value are omitted.
    executor : Executor, dask Client, int or callable, optional
        Any `concurrent.futures.Executor`, a `distributed.Client`, a number of processes on this machine, or a function that returns
        an executor, which is called again if a worker died. None: this process.
    store : path, optional
        A folder in Zarr's format, which only this process writes. None: in memory.
    size : int, optional
        Variants in a block, which is one task of the executor and one file of each array; by default as many as need at most 10 s, and
        at most 1/32 of all. A store keeps the size that it was made with.
    window : int, optional
        Blocks in progress at a time; by default three for each worker.
    seconds : float, optional
        A variant that takes longer, together with its `reduce`, is `LATE`.
    progress : callable or bool
        Called after each block with the numbers of finished variants, of all, and of those without a result. True: a line on
        stderr.
    reduce : callable, optional
        A function, which the workers can import, from a `Study` to a dictionary of numbers, or of arrays of one shape.
    part : (k, m)
        The k-th of m runs, such as those of a job array, which share the store: each computes every m-th block.
    again : Status, its word such as 'late', or several; optional
        Blocks with variants of this status are computed again, such as those that are `LATE`, with more `seconds`.
    wait : float, optional
        Seconds without any worker of a Dask cluster after which the run ends with an `Error`; by default no limit. After 10 s a
        `NoWorkerWarning` reports it.

    Returns
    -------
    xarray.Dataset
        As from `open`.

    Raises
    ------
    Error
        The plan or a column is not usable, no variant tried has a result, the store is of another plan, version or OpenBLAS kernel or
        cannot be written, a file that the case names was changed meanwhile, or the executor is gone. Finished blocks are kept. An
        `UnusedWarning` names varied keys that no task of the first variant uses.
    """
    take = [take] if isinstance(take, str) else list(take)
    _check(plan, take, size, window, seconds, reduce, part, wait)
    repeated = _statuses(again)
    _warn_of_unused(plan)
    snapshot = Snapshot(plan)
    with Workers(executor, wait) as workers:
        job, target, known = _prepare(snapshot, take, store, size, window, seconds, reduce, workers)
        with target.locked(part), _reporting(progress) as report:
            done = target.usable()
            block_of = np.arange(len(done)) // target.size
            done[np.isin(block_of, block_of[np.isin(done, repeated)])] = Status.PENDING
            blocks = [(first, stop) for first, stop in target.blocks(part) if not done[first:stop].all()]
            counts = _Counts(target, part, done, report)
            if blocks:
                _gather(snapshot, job, target, workers, window, blocks, known, counts)
    return reading.dataset(target)


def _check(
    plan: Plan, take: list[str], size: int | None, window: int | None, seconds: float | None, reduce: Reduce | None, part: tuple[int, int],
    wait: float | None,
) -> None:
    if not isinstance(plan, Plan):
        raise TypeError(f'plan: must be a Plan, not {type(plan).__name__}')
    if not take and reduce is None:
        raise Error("take: names no column; use 'table.column', such as 'sweep_worst.worst_dynamic_factor', or reduce")
    if len(set(take)) < len(take):
        raise Error('take: names a column twice')
    for name, limit in (('seconds', seconds), ('wait', wait)):
        check_seconds(name, limit)
    for name, value in (('size', size), ('window', window)):
        if value is not None and not (_is_whole(value) and value > 0):
            raise Error(f'{name} = {value}: must be a whole number of at least 1')
    k, m = part
    if not (_is_whole(k) and _is_whole(m) and 1 <= k <= m):
        raise Error(f'part {k}/{m}: must be from 1/{m} to {m}/{m}')


def _statuses(again: Any) -> list[Status]:
    known = {one.name.lower(): one for one in Status}
    several = [again] if isinstance(again, (str, Status)) or not isinstance(again, Iterable) else list(again)
    for one in several:
        if not isinstance(one, Status) and not (isinstance(one, str) and one in known):
            raise Error(f'again = {one!r}: must be a Status or its word, of {", ".join(known)}')
    return [known[one] if isinstance(one, str) else one for one in several]


def _warn_of_unused(plan: Plan) -> None:
    """Warns of varied keys without effect, as the tasks of the first variant do not use them."""
    try:
        lines = plan.case(0).unused
    except Error:  # reported as the variant's status
        return
    words = [one.split() for line in lines for one in line.partition(': ')[2].replace('&', '').replace(',', '').split('; ')]
    unused = {f'{group}.{key}' for group, *keys in words for key in keys}
    if found := [name for name in plan.names if name in unused]:
        warnings.warn(f'keys that are varied, but that no task of the first variant uses: {", ".join(found)}', UnusedWarning, stacklevel=3)


def _is_whole(value: Any) -> bool:
    return isinstance(value, (int, np.integer)) and not isinstance(value, bool)


def _prepare(
    snapshot: Snapshot, take: list[str], path: Any, size: int | None, window: int | None, seconds: float | None, reduce: Reduce | None, workers: Workers
) -> tuple[Job, Store, list[Block | None]]:
    """Returns the job for the workers, the store, which is made if missing, and the results of the first variants if it is made."""
    plan = snapshot.plan
    job = Job(plan.base, plan.keys, Layout((), (), {}), reduce, seconds)
    known: list[Block | None] = []
    if path is not None and os.path.exists(path):
        target = stores.read(path)
    else:
        found, known, elapsed = _first(plan, take, job, workers, window, is_timed=size is None and plan.n > _BLOCKS)
        snapshot.check()
        target = stores.make(path, snapshot, found, min(int(size or max(1, min(_MOST, _SECONDS / max(elapsed, 1e-6), -(-plan.n // _BLOCKS)))), plan.n), reduce)
    stores.check(target, snapshot, take, reduce)  # if another part was faster, it is the store of that one
    return dataclasses.replace(job, layout=target.layout), target, known


def _first(plan: Plan, take: list[str], job: Job, workers: Workers, window: int | None, is_timed: bool) -> tuple[Layout, list[Block | None], float]:
    """Returns the shapes of the columns, from the first variant with a result; the results of the first variants, as far as they
    were tried and agree (None: it ends its process); and the run time of the last one in seconds.

    Each worker tries one at a time. If the time is measured, they run one after the other, until there are two results: the second
    may reuse products of the first.
    """
    workers.check(job)
    dispatcher = Dispatcher(workers, job, plan.rows, window, partial(trial, take))
    tried = min(plan.n, TRIED)
    trials: list[Trial | None] = []
    available: list[Trial] = []
    while len(trials) < tried and len(available) < 1 + is_timed:
        stop = min(len(trials) + (1 if is_timed else workers.parallel()), tried)
        found = {piece.first: one for piece, one in dispatcher.run([(at, at + 1) for at in range(len(trials), stop)])}
        trials += [found[at] for at in sorted(found)]
        available = [one for one in trials if one and (one.layout or one.request_error)]
    if not available:
        reason = _ENDED if trials[0] is None else trials[0].block.messages[0]
        raise NoResult(f'none of the first {tried} variants has a result; of the first: {reason}')
    layout = available[0].layout
    if layout is None:
        raise Error(available[0].request_error)
    known: list[Block | None] = []
    for one in trials:
        if one and (one.request_error or (one.layout and not one.layout.same(layout))):
            break
        block = None if one is None else one.block
        known.append(block if block is None or block.columns else empty(layout, 1, Status(block.status[0]), block.messages[0]))
    return layout, known, available[-1].seconds


class _Counts:
    """Counts finished variants and those without a result."""

    def __init__(self, target: Store, part: tuple[int, int], status: np.ndarray, report: Progress | None):
        mine = np.concatenate([status[first:stop] for first, stop in target.blocks(part)] or [status[:0]])
        self.total, self.report = len(mine), report
        self.done, self.failed = 0, 0
        self.add(mine[mine != Status.PENDING])

    def add(self, status: np.ndarray) -> None:
        self.done += len(status)
        self.failed += int((~np.isin(status, ANSWERED)).sum())
        if self.report and self.total:  # a part may have no block
            self.report(self.done, self.total, self.failed)


class _Values:
    """Rows of the blocks in progress, each requested once, as Sobol' points are drawn in order."""

    def __init__(self, plan: Plan, size: int):
        self.plan, self.size = plan, size
        self.blocks: dict[int, np.ndarray] = {}

    def __call__(self, first: int, stop: int) -> np.ndarray:
        begin = first // self.size * self.size
        if begin not in self.blocks:
            self.blocks[begin] = self.plan.rows(begin, min(begin + self.size, self.plan.n))
        return self.blocks[begin][first - begin : stop - begin]


def _gather(
    snapshot: Snapshot, job: Job, target: Store, workers: Workers, window: int | None, blocks: list[tuple[int, int]], known: list[Block | None], counts: _Counts
) -> None:
    """Writes each block when all of its pieces exist; those of the first variants are known."""
    workers.check(job)
    values = _Values(snapshot.plan, target.size)
    available = [(Piece(at, at + 1), known[at]) for first, stop in blocks for at in range(first, min(stop, len(known)))]
    remaining = [(max(first, len(known)), stop) for first, stop in blocks if stop > len(known)]
    waiting: dict[int, tuple[Block, int]] = {}  # by the number of the block: its data, and the number of missing variants
    for piece, found in itertools.chain(available, Dispatcher(workers, job, values, window).run(remaining)):
        if found is None:
            found = empty(job.layout, 1, Status.CRASHED, _ENDED)
        _check_maker(found)
        at = piece.first // target.size
        first, stop = at * target.size, min((at + 1) * target.size, target.n)
        block, missing = waiting.pop(at, (None, stop - first))
        if block is None:
            block = found if missing == piece.stop - piece.first else empty(job.layout, stop - first)
        if block is not found:
            _insert(block, found, piece, first)
        missing -= piece.stop - piece.first
        if missing:
            waiting[at] = block, missing
            continue
        snapshot.check()
        with _interrupts_later():
            target.put(first, values(first, stop), block)
            del values.blocks[first]
        counts.add(block.status)


@contextlib.contextmanager
def _interrupts_later() -> Iterator[None]:
    """Delays Ctrl-C to the end of the block: a half-written file would leave tasks of Zarr, with messages at the end of the
    process.
    """
    received: list[tuple] = []
    before = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(before):
        yield
        return
    signal.signal(signal.SIGINT, lambda *what: received.append(what))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
        if received:
            before(*received[0])


def _insert(block: Block, found: Block, piece: Piece, first: int) -> None:
    rows = slice(piece.first - first, piece.stop - first)
    block.status[rows], block.messages[rows] = found.status, found.messages
    for name, column in found.columns.items():
        block.columns[name][rows] = column


def _check_maker(block: Block) -> None:
    """Refuses results of another version or kernel, which have other bits."""
    for what, ours, theirs in zip(('version', 'OpenBLAS kernel'), build_id(), block.build):
        if ours != theirs:
            hint = '; set OPENBLAS_CORETYPE for all, this process too' if what != 'version' else ''
            raise Error(f'a worker has the {what} {theirs}, this process {ours}{hint}', Code.INTERRUPTED)


@contextlib.contextmanager
def _reporting(progress: Progress | bool) -> Iterator[Progress | None]:
    if progress is not True:
        yield progress or None
        return
    with contextlib.closing(Line('variants')) as line:
        yield line
