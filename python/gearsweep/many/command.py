"""The command `gearsweep many PLAN.toml`."""

from __future__ import annotations

import os
import re
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..core.files import try_file
from ..core.library import Code, Error
from ..core.terminal import print_error, print_text
from ..core.watch import Line
from . import plan_file, reading
from .page import write
from .run import run
from .statistics import quantiles, with_band
from .status import ANSWERED, PASSING

if TYPE_CHECKING:
    import xarray

HELP = """gearsweep many: many variants of a case, into a store

usage: gearsweep many PLAN.toml [options]

  --workers N           processes on this machine (as many as it has processors)
  --scheduler ADDRESS   a Dask scheduler, such as tcp://node:8786, instead
  --wait SECONDS        end if the scheduler has had no worker for so long (no limit)
  --part K/M            the K-th of M runs that share the store, such as those of a job array
  --again               variants that failed, crashed or were late once more, with those of the same blocks
  --report FILE         also write one page of HTML with numbers, pictures and what failed
  --quiet               print errors only
  --help                print this

The same command continues an interrupted run. doc/many.md describes PLAN.toml.

exit code: 0 done, 4 some variants have no plain result, 130 interrupted: finished variants are kept; otherwise as gearsweep"""

#: Seconds between two lines if the output is no terminal.
_INTERVAL = 60.0


@dataclass
class Arguments:
    plan: str = ''
    workers: int = 0
    scheduler: str = ''
    part: tuple[int, int] = (1, 1)
    again: bool = False
    wait: float | None = None
    report: str = ''
    quiet: bool = False


def main(words: list[str]) -> int:
    """Runs the command line `words`; returns the exit code."""
    if any(word in ('--help', '-h') for word in words):
        print_text(HELP)
        return Code.OK
    wanted = arguments(words)
    entries = plan_file.read(wanted.plan)
    if wanted.report:
        try_file(wanted.report)
    executor = _executor(wanted)
    progress = None if wanted.quiet else _Progress()
    try:
        data = _with_warnings(run, entries.plan, entries.take, executor=executor, store=entries.store, size=entries.size, seconds=entries.seconds,
                   progress=progress or False, part=wanted.part, again=PASSING if wanted.again else (), wait=wanted.wait)  # fmt: skip
    except KeyboardInterrupt:
        print_error('interrupted; the same command continues the run')
        return Code.INTERRUPTED
    finally:
        if progress:
            progress.close()
        if wanted.scheduler:
            executor.close()
    if wanted.report:
        write(entries.store, wanted.report)
    if not wanted.quiet:
        print_text('\n'.join(report(data, entries.store)))
    plain = set(reading.counts(data)) <= {'ok', 'pending'}
    return Code.OK if plain else Code.PARTIAL


def _with_warnings(call: Callable, *arguments: Any, **options: Any) -> Any:
    """Returns the result of a call, and prints its warnings as those of the command."""
    with warnings.catch_warnings():
        warnings.showwarning = lambda message, *_, **__: print_error(str(message))
        return call(*arguments, **options)


def arguments(words: list[str]) -> Arguments:
    """Parses the command line.

    Raises
    ------
    Error
        It is not usable.
    """
    found = Arguments()
    remaining = iter(words)
    for word in remaining:
        if word in ('--quiet', '--again'):
            setattr(found, word[2:], True)
        elif word in ('--workers', '--scheduler', '--part', '--report', '--wait'):
            _option(found, word, next(remaining, ''))
        elif word.startswith('-'):
            raise _usage(f'unknown option {word}')
        elif found.plan:
            raise _usage(f'one plan at a time: {found.plan} and {word}')
        else:
            found.plan = word
    if not found.plan:
        raise _usage('no plan given')
    if found.wait is not None and not found.scheduler:
        raise _usage('--wait: is for the workers of a --scheduler')
    if found.workers and found.scheduler:
        raise _usage('--workers: a scheduler has workers of its own')
    return found


def _option(found: Arguments, word: str, value: str) -> None:
    if not value or value.startswith('--'):
        raise _usage(f'{word}: a value must follow')
    if word in ('--scheduler', '--report'):
        setattr(found, word[2:], value)
    elif word == '--workers':
        if not (value.isascii() and value.isdigit() and 1 <= int(value) <= 1024):
            raise _usage(f'--workers {value}: must be an integer from 1 to 1024')
        found.workers = int(value)
    elif word == '--wait':
        if not (value.isascii() and value.isdigit() and int(value) > 0):
            raise _usage(f'--wait {value}: must be a whole number of seconds of at least 1')
        found.wait = int(value)
    else:
        match = re.fullmatch(r'(\d+)/(\d+)', value, re.ASCII)
        if not match or not 1 <= int(match[1]) <= int(match[2]):
            raise _usage(f'--part {value}: must be K/M, with K from 1 to M, such as 3/64')
        found.part = int(match[1]), int(match[2])


def _usage(message: str) -> Error:
    return Error(f'{message}; gearsweep many --help has more', Code.USAGE)


def _executor(wanted: Arguments) -> Any:
    if not wanted.scheduler:
        count = wanted.workers or (len(os.sched_getaffinity(0)) if hasattr(os, 'sched_getaffinity') else os.cpu_count() or 1)
        return count if count > 1 else None
    try:
        from distributed import Client
    except ImportError as error:
        raise _usage(f"--scheduler needs distributed, which is not installed: pip install 'gearsweep[many]' ({error})") from error
    try:
        return Client(wanted.scheduler, set_as_default=False)
    except (OSError, TimeoutError, ValueError) as error:
        raise Error(f'cannot reach the scheduler {wanted.scheduler}: {str(error) or type(error).__name__}', Code.FILE) from error


def report(data: xarray.Dataset, store: str) -> list[str]:
    """Formats the command's output at the end."""
    counts = reading.counts(data)
    lines = [f'Variants           {data.sizes["variant"]}: {", ".join(f"{count} {name}" for name, count in counts.items())}']
    lines += list(_quantiles(data)) if 'pending' not in counts else []
    return [*lines, f'Wrote              {store}']


def _quantiles(data: xarray.Dataset) -> Iterator[str]:
    """Formats median and 95 % quantile of columns of one number for each variant."""
    complete = data.isel(variant=np.flatnonzero(np.isin(data.status.values, ANSWERED)))
    if data.attrs['kind'] not in ('random', 'lhs', 'sobol'):
        return
    if complete.sizes['variant'] < data.sizes['variant']:
        yield "Quantiles          none, as some variants have no number; many.quantiles(nan='drop') omits them"
        return
    for name, column in complete.data_vars.items():
        if column.dims == ('variant',) and 'points' in column.attrs and np.isfinite(column.values).all():
            found = quantiles(column, (0.5, 0.95))
            text = ', '.join(f'{100 * q:g} %: {with_band(*band)}' for q, *band in
                             zip(found.q.values, found.value.values, found.lower.values, found.upper.values))  # fmt: skip
            yield f'{name}\n                   {text}'


class _Progress:
    """A line on a terminal that is overwritten; elsewhere a new line at intervals."""

    def __init__(self) -> None:
        self.line = Line('variants') if sys.stderr.isatty() else None
        self.last = time.monotonic()

    def __call__(self, done: int, total: int, failed: int) -> None:
        if self.line:
            self.line(done, total, failed)
        elif time.monotonic() - self.last > _INTERVAL:
            self.last = time.monotonic()
            print(f'gearsweep: {done} of {total} variants done, {total - done} left, {failed} failed', file=sys.stderr, flush=True)

    def close(self) -> None:
        if self.line:
            self.line.close()
