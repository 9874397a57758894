"""Computes a block of variants from the values of its rows: columns, statuses and messages.

Only this module runs in the processes of an executor.
"""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..core import library
from ..core.case import Case
from ..core.library import Code, Error, kernel
from ..core.study import Study, attempt, run_rows
from ..core.watch import Late, limited
from .inputs import Key, case_with
from .outputs import OTHER_INDEX, Layout, Reduce, layout_of
from .status import ANSWERED, Status

Reals = NDArray[np.float64]
#: The last `study` of this thread, and its last `rows` or study, whose stiffness the next run may reuse.
_last = threading.local()
#: Statuses of a variant by code; other codes: a method failed.
_STATUS = {Code.OK: Status.OK, Code.PARTIAL: Status.PARTIAL, Code.INPUT: Status.REFUSED}


@dataclass(frozen=True)
class Job:
    """Data that are the same for all blocks.

    Attributes
    ----------
    base : Case
    keys : tuple of Key
        Keys of the columns of the rows.
    layout : Layout
    reduce : callable, optional
        Function from a `Study` to a dictionary of numbers.
    seconds : float, optional
        Time limit of a variant, including `reduce`.
    """

    base: Case
    keys: tuple[Key, ...]
    layout: Layout
    reduce: Reduce | None = None
    seconds: float | None = None


@dataclass(frozen=True)
class Block:
    """Results of some variants.

    Attributes
    ----------
    columns : dict
        By output: an array with a row for each variant, NaN for none.
    status : array of int8
    messages : list of str
        Reason for each variant without a complete result.
    build : tuple of str
        Version of the library and OpenBLAS's kernel.
    """

    columns: dict[str, Reals]
    status: NDArray[np.int8]
    messages: list[str]
    build: tuple[str, str]


def build_id() -> tuple[str, str]:
    return library.version(), kernel()


def empty(layout: Layout, rows: int, status: Status = Status.PENDING, message: str = '') -> Block:
    """Returns a block of variants without numbers."""
    columns = {one.name: np.full((rows, *one.shape), np.nan) for one in (*layout.columns, *layout.reduced)}
    return Block(columns, np.full(rows, status, np.int8), [message] * rows, build_id())


def compute(job: Job, values: Reals) -> Block:
    """Computes the block of variants with these values, a row each, on one thread. A failed variant does not affect the others."""
    if (found := _in_one_call(job, values)) is not None:
        return found
    block = empty(job.layout, len(values))
    for at, row in enumerate(values):
        status, message, numbers = _variant(job, row)
        block.status[at], block.messages[at] = status, ' '.join(message.split())
        for name, value in numbers.items():
            block.columns[name][at] = value
    return block


def _in_one_call(job: Job, values: Reals) -> Block | None:
    """Computes the block by one call of the library; None if each variant needs a study of its own, or if the error of the call
    names no variant.
    """
    indices = job.layout.indices()
    if job.reduce or job.seconds or indices is None or any(key.choices is not None for key in job.keys):
        return None
    names = [one.name for one in job.layout.columns]
    try:
        found = run_rows(job.base, [key.name for key in job.keys], values, [*dict.fromkeys([*names, *indices])],
                         earlier=getattr(_last, 'rows', None))  # fmt: skip
    except Error:
        return None
    _last.rows = found
    # A call sets the count of numbers by the first row that it runs, which may differ from the plan's; without such a row it is 0.
    sizes = {one.name: math.prod(one.shape) for one in job.layout.columns} | {name: one.size for name, one in indices.items()}
    if any(found.columns[name].shape[1] not in (0, size) for name, size in sizes.items()):
        return None
    block = empty(job.layout, len(values))
    for at, (code, message) in enumerate(zip(found.codes, found.messages)):
        block.status[at], block.messages[at] = _STATUS.get(Code(code), Status.FAILED), ' '.join(message.split())
        if block.status[at] not in ANSWERED:
            continue
        other = next((name for name, expected in indices.items() if not np.array_equal(found.columns[name][at], expected)), None)
        if other:
            block.status[at], block.messages[at] = Status.REFUSED, OTHER_INDEX.format(*other.split('.'))
            continue
        for one in job.layout.columns:
            block.columns[one.name][at] = found.columns[one.name][at].reshape(one.shape)
    return block


def _variant(job: Job, row: Reals) -> tuple[Status, str, dict[str, Reals]]:
    began = time.monotonic()
    status, message, study = _study(job, row)
    if study is None:
        return status, message, {}
    try:
        return status, message, job.layout.of(study, _reduced(job, study, began))
    except Exception as failure:
        return *_failure(job, failure), {}


@dataclass(frozen=True)
class Trial:
    """Results of a trial variant, while the shapes of the columns are not known.

    Attributes
    ----------
    block : Block
        Block of this variant; without columns if it has no result.
    seconds : float
        Run time of the variant.
    layout : Layout, optional
        Shapes of the columns; None: the variant has no result.
    request_error : str
        Error in the request, such as a column that does not exist.
    """

    block: Block
    seconds: float
    layout: Layout | None = None
    request_error: str = ''


def trial(take: Sequence[str], job: Job, values: Reals) -> Trial:
    """Computes a single variant, and the shapes of the columns 'table.column' from it."""
    began = time.monotonic()
    status, message, study = _study(job, values[0])
    found, columns, request_error = None, {}, ''
    if study is not None:
        try:
            numbers = _reduced(job, study, began)
        except Exception as failure:
            status, message = _failure(job, failure)
        else:
            try:
                found = layout_of(study, take, numbers)
                columns = {name: one[np.newaxis] for name, one in found.of(study, numbers).items()}
            except Error as error:
                request_error = str(error)
    block = Block(columns, np.full(1, status, np.int8), [' '.join(message.split())], build_id())
    return Trial(block, time.monotonic() - began, found, request_error)


def _study(job: Job, row: Reals) -> tuple[Status, str, Study | None]:
    try:
        study, error = study_of(case_with(job.base, job.keys, row), job.seconds)
    except Error as refused:
        return _STATUS.get(refused.code, Status.FAILED), str(refused), None
    except Late:
        return Status.LATE, f'not done after {job.seconds:g} s', None
    return (Status.PARTIAL, str(error), study) if error else (Status.OK, '', study)


def _reduced(job: Job, study: Study, began: float) -> dict[str, Reals]:
    """Returns the result of the caller's function, within the remaining seconds of the variant."""
    reduce = job.reduce
    if not reduce:
        return {}
    found = reduce(study) if job.seconds is None else limited(lambda: reduce(study), began + job.seconds - time.monotonic())
    return {name: np.asarray(values, float) for name, values in found.items()}


def _failure(job: Job, failure: Exception) -> tuple[Status, str]:
    """Describes a failure of the caller's function, unless it is an `Error`."""
    if isinstance(failure, Late):
        return Status.LATE, f'reduce: not done after {job.seconds:g} s'
    if isinstance(failure, Error):
        return Status.REFUSED, str(failure)
    return Status.FAILED, f'reduce: {type(failure).__name__}: {failure}'


def study_of(case: Case, seconds: float | None) -> tuple[Study, Error | None]:
    """Returns the study of a case on one thread, and an error if some points have no result.

    Raises
    ------
    Error
        There is no study.
    Late
        It is not done after these seconds.
    """
    study, error, cause = attempt(case, 1, getattr(_last, 'study', None), seconds=seconds)
    if cause is not None:
        raise cause
    if study is None or (error is not None and error.code != Code.PARTIAL):
        raise error or Error('the run made no study', Code.NUMERICAL)
    _last.study = _last.rows = study
    return study, error
