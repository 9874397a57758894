"""Computes a block of variants: the values of its rows go in; columns, statuses and messages come out.

This is all that runs in the processes of an executor.
"""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .. import _library
from .._library import Code, Error
from .._watch import Late
from ..case import Case
from ..study import Study, attempt, run_rows
from .inputs import Key, case_with
from .kernel import kernel
from .outputs import OTHER_INDEX, Reduce, Taken, taken
from .status import ANSWERED, Status

Reals = NDArray[np.float64]
#: The last `study` of this thread, and its last `rows` or study, whose stiffness the next may take over.
_last = threading.local()
#: What a code means for a variant; others: a method failed.
_STATUS = {Code.OK: Status.OK, Code.PARTIAL: Status.PARTIAL, Code.INPUT: Status.REFUSED}


@dataclass(frozen=True)
class Job:
    """What is the same for all blocks.

    Attributes
    ----------
    base : Case
    keys : tuple of Key
        What the columns of the rows are.
    taken : Taken
    reduce : callable, optional
        Makes a dictionary of numbers of a `Study`.
    seconds : float, optional
        Time that a variant has.
    """

    base: Case
    keys: tuple[Key, ...]
    taken: Taken
    reduce: Reduce | None = None
    seconds: float | None = None


@dataclass(frozen=True)
class Block:
    """What came of some variants.

    Attributes
    ----------
    columns : dict
        By output: an array with a row for each variant, NaN where there is none.
    status : array of int8
    messages : list of str
        Of variants without a plain result: why.
    made_by : tuple of str
        Version of the library and OpenBLAS's kernel.
    """

    columns: dict[str, Reals]
    status: NDArray[np.int8]
    messages: list[str]
    made_by: tuple[str, str]


def made_here() -> tuple[str, str]:
    return _library.version(), kernel()


def empty(taken: Taken, rows: int, status: Status = Status.PENDING, message: str = '') -> Block:
    """A block of variants without numbers."""
    columns = {one.name: np.full((rows, *one.shape), np.nan) for one in (*taken.columns, *taken.reduced)}
    return Block(columns, np.full(rows, status, np.int8), [message] * rows, made_here())


def compute(job: Job, values: Reals) -> Block:
    """The block of variants with these values, a row each, on one thread. A variant that fails leaves the others as they are."""
    if (found := _in_one_call(job, values)) is not None:
        return found
    block = empty(job.taken, len(values))
    for at, row in enumerate(values):
        status, message, numbers = _variant(job, row)
        block.status[at], block.messages[at] = status, ' '.join(message.split())
        for name, value in numbers.items():
            block.columns[name][at] = value
    return block


def _in_one_call(job: Job, values: Reals) -> Block | None:
    """The block by one call of the library; None where each variant needs a study of its own, or the call does not say what is wrong
    with which."""
    indices = job.taken.indices()
    if job.reduce or job.seconds or indices is None or any(key.choices is not None for key in job.keys):
        return None
    names = [one.name for one in job.taken.columns]
    try:
        found = run_rows(job.base, [key.name for key in job.keys], values, [*dict.fromkeys([*names, *indices])],
                         earlier=getattr(_last, 'rows', None))  # fmt: skip
    except Error:
        return None
    _last.rows = found
    # A call takes how many there are from the first row that it runs, which need not be as the plan's; without one that runs there are none.
    sizes = {one.name: math.prod(one.shape) for one in job.taken.columns} | {name: one.size for name, one in indices.items()}
    if any(found.columns[name].shape[1] not in (0, size) for name, size in sizes.items()):
        return None
    block = empty(job.taken, len(values))
    for at, (code, message) in enumerate(zip(found.codes, found.messages)):
        block.status[at], block.messages[at] = _STATUS.get(Code(code), Status.FAILED), ' '.join(message.split())
        if block.status[at] not in ANSWERED:
            continue
        other = next((name for name, expected in indices.items() if not np.array_equal(found.columns[name][at], expected)), None)
        if other:
            block.status[at], block.messages[at] = Status.REFUSED, OTHER_INDEX.format(*other.split('.'))
            continue
        for one in job.taken.columns:
            block.columns[one.name][at] = found.columns[one.name][at].reshape(one.shape)
    return block


def _variant(job: Job, row: Reals) -> tuple[Status, str, dict[str, Reals]]:
    status, message, study = _study(job, row)
    if study is None:
        return status, message, {}
    try:
        return status, message, job.taken.of(study, _reduced(job, study))
    except Exception as failure:
        return *_failure(failure), {}


@dataclass(frozen=True)
class First:
    """What a variant tells where nothing is known of the columns yet.

    Attributes
    ----------
    block : Block
        Of this variant; without columns where it has no result.
    seconds : float
        That it took.
    taken : Taken, optional
        What the columns are like; None: the variant has no result.
    wrong : str
        What is wrong with what is asked for, such as a column that is not there.
    """

    block: Block
    seconds: float
    taken: Taken | None = None
    wrong: str = ''


def first(take: Sequence[str], job: Job, values: Reals) -> First:
    """A variant by itself, and what the columns 'table.column' are like by it."""
    began = time.monotonic()
    status, message, study = _study(job, values[0])
    found, columns, wrong = None, {}, ''
    if study is not None:
        try:
            numbers = _reduced(job, study)
        except Exception as failure:
            status, message = _failure(failure)
        else:
            try:
                found = taken(study, take, numbers)
                columns = {name: one[np.newaxis] for name, one in found.of(study, numbers).items()}
            except Error as error:
                wrong = str(error)
    block = Block(columns, np.full(1, status, np.int8), [' '.join(message.split())], made_here())
    return First(block, time.monotonic() - began, found, wrong)


def _study(job: Job, row: Reals) -> tuple[Status, str, Study | None]:
    try:
        study, error = study_of(case_with(job.base, job.keys, row), job.seconds)
    except Error as refused:
        return _status(refused), str(refused), None
    except Late:
        return Status.LATE, f'not done after {job.seconds:g} s', None
    return (Status.PARTIAL, str(error), study) if error else (Status.OK, '', study)


def _reduced(job: Job, study: Study) -> dict[str, Reals]:
    """What the caller's function gives."""
    return {name: np.asarray(values, float) for name, values in job.reduce(study).items()} if job.reduce else {}


def _failure(failure: Exception) -> tuple[Status, str]:
    """Of the caller's function, unless it is an `Error`."""
    if isinstance(failure, Error):
        return Status.REFUSED, str(failure)
    return Status.FAILED, f'reduce: {type(failure).__name__}: {failure}'


def study_of(case: Case, seconds: float | None) -> tuple[Study, Error | None]:
    """The study of a case on one thread, and an error that some points have no result.

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


def _status(error: Error) -> Status:
    return _STATUS.get(error.code, Status.FAILED)
