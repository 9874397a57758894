"""Runs a plan over an executor into a store, and goes on where it was left."""

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

from .._library import Code, Error, UnusedWarning
from .._watch import Line
from . import reading
from . import store as stores
from .flow import Crew, Flow, Piece
from .outputs import Reduce, Taken
from .plan import Begun, Plan
from .rows import Block, First, Job, empty, first, made_here
from .status import ANSWERED, Status
from .store import Store

if TYPE_CHECKING:
    import xarray

#: A block shall last so many seconds, has no more variants than this, and a plan has at least so many blocks where it can.
_SECONDS, _MOST, _BLOCKS = 10.0, 4096, 32
#: So many variants are tried for what the columns are like.
TRIED = 16
_ENDED = 'the process that computes it ends, also where nothing else is computed'

Progress = Callable[[int, int, int], object]


class NoResult(Error):
    """None of the first variants has a result."""


def run(
    plan: Plan, take: str | Sequence[str] = (), *, executor: Any = None, store: str | os.PathLike | None = None,
    size: int | None = None, window: int | None = None, seconds: float | None = None,
    progress: Progress | bool = False, reduce: Reduce | None = None, part: tuple[int, int] = (1, 1),
    again: Status | str | Sequence[Status | str] = (),
) -> xarray.Dataset:  # fmt: skip
    """Computes the variants of a plan, each on one thread, and keeps the columns that are wanted of them.

    The numbers are the same bits for any executor, number of workers and size of blocks. What is in the store is not computed again:
    a run that was interrupted goes on by the same call. Ctrl-C keeps all blocks that are done.

    Parameters
    ----------
    plan : Plan
        From `Plan.sobol` and its like.
    take : 'table.column' or several
        Columns of numbers. A column is an array over the index columns of its table, such as the speed; those must be the same in all
        variants. Index columns of one value are left out.
    executor : Executor, dask Client, int or callable, optional
        What computes: any `concurrent.futures.Executor`, a `distributed.Client`, a number of processes on this machine, or a function
        that makes an executor, which is called again where a worker died. None: this process.
    store : path, optional
        A folder in Zarr's format, that this process alone writes. None: in memory.
    size : int, optional
        Variants in a block, which is one task of the executor and one file of each array; by default so many as take at most 10 s, and
        at most 1/32 of all. A store keeps the size that it was made with.
    window : int, optional
        Blocks under way at a time; by default three for each worker.
    seconds : float, optional
        A variant that takes longer is `LATE`.
    progress : callable or bool
        Called after each block with the number of variants that are done, of all, and of those without a result. True: a line on stderr.
    reduce : callable, optional
        A function, which the workers can import, that makes a dictionary of numbers, or arrays of one shape, of a `Study`.
    part : (k, m)
        The k-th of m runs, such as those of a job array, which share the store: each computes every m-th block.
    again : Status, its word such as 'late', or several; optional
        Blocks with variants of which this came are computed again, such as those that are `LATE`, with more `seconds`.

    Returns
    -------
    xarray.Dataset
        As `open` gives it.

    Raises
    ------
    Error
        The plan or a column is not usable, no variant tried has a result, the store is of another plan, version or OpenBLAS kernel or
        cannot be written, a file that the case names was changed meanwhile, or the executor is gone. What is done is kept. An `UnusedWarning` names varied keys that no task of the first
        variant uses.
    """
    take = [take] if isinstance(take, str) else list(take)
    _check(plan, take, size, window, seconds, reduce, part)
    anew = _statuses(again)
    _warn_of_unused(plan)
    begun = Begun(plan)
    with Crew(executor) as crew:
        job, kept, known = _begun(begun, take, store, size, window, seconds, reduce, crew)
        with kept.held(part), _told(progress) as told:
            done = kept.usable()
            done[_of_blocks(np.isin(done, anew), kept.size)] = Status.PENDING
            blocks = [(first, stop) for first, stop in kept.blocks(part) if not done[first:stop].all()]
            counts = _Counts(kept, part, done, told)
            if blocks:
                _gather(begun, job, kept, crew, window, blocks, known, counts)
    return reading.dataset(kept)


def _check(
    plan: Plan, take: list[str], size: int | None, window: int | None, seconds: float | None, reduce: Reduce | None, part: tuple[int, int]
) -> None:
    if not isinstance(plan, Plan):
        raise TypeError(f'plan: must be a Plan, not {type(plan).__name__}')
    if not take and reduce is None:
        raise Error("take: names no column; give 'table.column', such as 'sweep_worst.worst_dynamic_factor', or reduce")
    if len(set(take)) < len(take):
        raise Error('take: names a column twice')
    if seconds is not None and not seconds > 0:
        raise Error(f'seconds = {seconds}: must be above 0')
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
    """Keys that are varied for nothing, as the tasks of the first variant do not use them."""
    try:
        lines = plan.case(0).unused
    except Error:  # told as the variant's status
        return
    words = [one.split() for line in lines for one in line.partition(': ')[2].replace('&', '').replace(',', '').split('; ')]
    unused = {f'{group}.{key}' for group, *keys in words for key in keys}
    if found := [name for name in plan.names if name in unused]:
        warnings.warn(f'keys that are varied, but that no task of the first variant uses: {", ".join(found)}', UnusedWarning, stacklevel=3)


def _is_whole(value: Any) -> bool:
    return isinstance(value, (int, np.integer)) and not isinstance(value, bool)


def _begun(
    begun: Begun, take: list[str], path: Any, size: int | None, window: int | None, seconds: float | None, reduce: Reduce | None, crew: Crew
) -> tuple[Job, Store, list[Block | None]]:
    """What the workers are told; the store, which is made where there is none; and what came of the first variants where it is made."""
    plan = begun.plan
    job = Job(plan.base, plan.keys, Taken((), (), {}), reduce, seconds)
    known: list[Block | None] = []
    if path is not None and os.path.exists(path):
        kept = stores.read(path)
    else:
        found, known, took = _first(plan, take, job, crew, window, is_timed=size is None and plan.n > _BLOCKS)
        begun.check()
        kept = stores.make(path, begun, found, int(min(size or _size(plan.n, took), plan.n)), reduce)
    stores.check(kept, begun, take, reduce)  # where another part was faster, it is that one's
    return dataclasses.replace(job, taken=kept.taken), kept, known


def _first(plan: Plan, take: list[str], job: Job, crew: Crew, window: int | None, is_timed: bool) -> tuple[Taken, list[Block | None], float]:
    """What the columns are like, by the first variant that has a result; what came of the variants from the first on, as far as they were
    tried and fit (None: it ends its process); and the seconds that the last one took.

    Each worker tries one at a time. Where time counts, they come one after the other, until there are two: the second may take over
    what the first one made.
    """
    crew.check(job)
    flow = Flow(crew, job, plan.rows, window, partial(first, take))
    tried = min(plan.n, TRIED)
    came: list[First | None] = []
    there: list[First] = []
    while len(came) < tried and len(there) < 1 + is_timed:
        stop = min(len(came) + (1 if is_timed else crew.workers()), tried)
        found = {piece.first: one for piece, one in flow.run([(at, at + 1) for at in range(len(came), stop)])}
        came += [found[at] for at in sorted(found)]
        there = [one for one in came if one and (one.taken or one.wrong)]
    if not there:
        said = _ENDED if came[0] is None else came[0].block.messages[0]
        raise NoResult(f'none of the first {tried} variants has a result; of the first: {said}')
    taken = there[0].taken
    if taken is None:
        raise Error(there[0].wrong)
    known: list[Block | None] = []
    for one in came:
        if one and (one.wrong or (one.taken and not one.taken.same(taken))):
            break
        block = None if one is None else one.block
        known.append(block if block is None or block.columns else empty(taken, 1, Status(block.status[0]), block.messages[0]))
    return taken, known, there[-1].seconds


def _size(n: int, took: float) -> int:
    return max(1, min(_MOST, int(_SECONDS / max(took, 1e-6)), -(-n // _BLOCKS)))


def _of_blocks(rows: np.ndarray, size: int) -> np.ndarray:
    """All rows of blocks that have one of these."""
    return np.isin(np.arange(len(rows)) // size, np.flatnonzero(rows) // size)


class _Counts:
    """How many variants are done and have no result."""

    def __init__(self, kept: Store, part: tuple[int, int], status: np.ndarray, told: Progress | None):
        mine = np.concatenate([status[first:stop] for first, stop in kept.blocks(part)] or [status[:0]])
        self.total, self.told = len(mine), told
        self.done, self.failed = 0, 0
        self.add(mine[mine != Status.PENDING])

    def add(self, status: np.ndarray) -> None:
        self.done += len(status)
        self.failed += int((~np.isin(status, ANSWERED)).sum())
        if self.told and self.total:  # a part may have no block
            self.told(self.done, self.total, self.failed)


class _Values:
    """The rows of blocks under way, of which each is asked for once, as Sobol' points are drawn in their order."""

    def __init__(self, plan: Plan, size: int):
        self.plan, self.size = plan, size
        self.blocks: dict[int, np.ndarray] = {}

    def __call__(self, first: int, stop: int) -> np.ndarray:
        begin = first // self.size * self.size
        if begin not in self.blocks:
            self.blocks[begin] = self.plan.rows(begin, min(begin + self.size, self.plan.n))
        return self.blocks[begin][first - begin : stop - begin]


def _gather(
    begun: Begun, job: Job, kept: Store, crew: Crew, window: int | None, blocks: list[tuple[int, int]], known: list[Block | None], counts: _Counts
) -> None:
    """Writes each block when all of its pieces are there; those of the first variants are known."""
    crew.check(job)
    values = _Values(begun.plan, kept.size)
    there = [(Piece(at, at + 1), known[at]) for first, stop in blocks for at in range(first, min(stop, len(known)))]
    rest = [(max(first, len(known)), stop) for first, stop in blocks if stop > len(known)]
    waiting: dict[int, tuple[Block, int]] = {}  # by the number of the block: what is there, and how many variants are missing
    for piece, found in itertools.chain(there, Flow(crew, job, values, window).run(rest)):
        if found is None:
            found = empty(job.taken, 1, Status.CRASHED, _ENDED)
        _check_maker(found)
        at = piece.first // kept.size
        first, stop = at * kept.size, min((at + 1) * kept.size, kept.n)
        whole, missing = waiting.pop(at, (None, stop - first))
        if whole is None:
            whole = found if missing == piece.stop - piece.first else empty(job.taken, stop - first)
        if whole is not found:
            _insert(whole, found, piece, first)
        missing -= piece.stop - piece.first
        if missing:
            waiting[at] = whole, missing
            continue
        begun.check()
        with _interrupts_later():
            kept.put(first, values(first, stop), whole)
            del values.blocks[first]
        counts.add(whole.status)


@contextlib.contextmanager
def _interrupts_later() -> Iterator[None]:
    """Ctrl-C takes effect at the end: a file that is half written would leave tasks of Zarr behind, which complain as the process ends."""
    came: list[tuple] = []
    before = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(before):
        yield
        return
    signal.signal(signal.SIGINT, lambda *what: came.append(what))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
        if came:
            before(*came[0])


def _insert(whole: Block, found: Block, piece: Piece, first: int) -> None:
    rows = slice(piece.first - first, piece.stop - first)
    whole.status[rows], whole.messages[rows] = found.status, found.messages
    for name, column in found.columns.items():
        whole.columns[name][rows] = column


def _check_maker(block: Block) -> None:
    """Another version or kernel gives other bits."""
    for what, here, there in zip(('version', 'OpenBLAS kernel'), made_here(), block.made_by):
        if here != there:
            hint = '; set OPENBLAS_CORETYPE for all, this process too' if what != 'version' else ''
            raise Error(f'a worker has the {what} {there}, this process {here}{hint}', Code.INTERRUPTED)


@contextlib.contextmanager
def _told(progress: Progress | bool) -> Iterator[Progress | None]:
    if progress is not True:
        yield progress or None
        return
    with contextlib.closing(Line('variants')) as line:
        yield line
