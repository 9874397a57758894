"""A plan as a text file (TOML), for `gearsweep many PLAN.toml`."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ..core.case import Case
from ..core.files import content
from ..core.library import Code, Error, declared, edit
from ..core.table import suggestion
from ..core.texts import ascii_hint, decoded
from .inputs import input_of
from .plan import Plan
from .points import FEWEST_SCRAMBLES

KINDS = ('sobol', 'random', 'lhs', 'saltelli', 'grid', 'table')
#: Forms of a logical in a table: those of a case, and those of a spreadsheet.
_LOGICALS = {'.true.': True, '.false.': False, 'true': True, 'false': False}
#: Allowed entries of the file, with their types.
_TYPES: dict[str, tuple[tuple[type, ...], str]] = {
    'case': ((str,), 'the name of a file with a case'),
    'kind': ((str,), ', '.join(KINDS)),
    'n': ((int,), 'a whole number'),
    'seed': ((int,), 'a whole number of at least 0'),
    'scrambles': ((int,), f'a whole number of at least {FEWEST_SCRAMBLES}'),
    'table': ((str,), 'the name of a file (CSV)'),
    'take': ((str, list), "a column 'table.column' or a list of them"),
    'store': ((str,), 'the name of a folder'),
    'size': ((int,), 'a whole number of at least 1'),
    'seconds': ((int, float), 'a number above 0'),
    'change': ((dict,), 'tables of keys, such as [change.sweep]'),
    'vary': ((dict,), 'tables of keys, such as [vary.load]'),
}


@dataclass(frozen=True)
class PlanFile:
    """Contents of a file.

    Attributes
    ----------
    plan : Plan
    take : list of str
    store : str
    size : int, optional
    seconds : float, optional
    """

    plan: Plan
    take: list[str]
    store: str
    size: int | None
    seconds: float | None


def read(path: str) -> PlanFile:
    """Reads a plan; relative names of files in it refer to its folder.

    Raises
    ------
    Error
        It cannot be read, or something in it is not usable: table, key, value and what is allowed are named.
    """
    import tomllib

    text = decoded(content(path), path).removeprefix('\ufeff').replace('\r\n', '\n').replace('\r', '\n').rstrip('\x1a')
    try:
        entries = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        place = re.search(r'at line (\d+), column (\d+)', str(error))
        letter = ''.join(text.split('\n')[int(place[1]) - 1 : int(place[1])])[int(place[2]) - 1 : int(place[2])] if place else ''
        raise Error(f'{path}: is no TOML: {error}{ascii_hint(letter)}') from error
    try:
        return _plan_file(entries, os.path.dirname(path), os.path.splitext(path)[0] + '.zarr')
    except Error as error:
        raise Error(f'{path}: {error}', error.code) from error


def _plan_file(entries: dict[str, Any], folder: str, store: str) -> PlanFile:
    for name, value in entries.items():
        if name not in _TYPES:
            raise Error(f'{name}: unknown{suggestion(name, _TYPES)}')
        kinds, allowed = _TYPES[name]
        if not isinstance(value, kinds) or isinstance(value, bool):
            raise Error(f'{name} = {value!r}: must be {allowed}')
    for name in ('case', 'kind', 'take'):
        if name not in entries:
            raise Error(f'{name}: missing; must be {_TYPES[name][1]}')
    take = [entries['take']] if isinstance(entries['take'], str) else entries['take']
    for one in take:
        if not isinstance(one, str):
            raise Error(f"take = {one!r}: must be a column 'table.column'")
    case = Case.read(os.path.join(folder, entries['case']))
    try:
        case = case.changed(**_groups(entries, 'change'))
    except Error as error:
        raise Error(f'[change]: {error}', error.code) from error
    return PlanFile(_plan(case, entries, folder), take, os.path.join(folder, entries['store']) if 'store' in entries else store,
                    entries.get('size'), entries.get('seconds'))  # fmt: skip


def _groups(entries: dict[str, Any], what: str) -> dict[str, dict[str, Any]]:
    groups = entries.get(what, {})
    for group, keys in groups.items():
        if not isinstance(keys, dict):
            raise Error(f'[{what}] {group} = {keys!r}: must be a table of keys, [{what}.{group}]')
    return groups


def _plan(case: Case, entries: dict[str, Any], folder: str) -> Plan:
    kind = entries['kind']
    if kind not in KINDS:
        raise Error(f'kind = {kind!r}: must be one of {", ".join(KINDS)}')
    uses = {'sobol': ('n', 'seed', 'scrambles', 'vary'), 'grid': ('vary',), 'table': ('table',)}.get(kind, ('n', 'seed', 'vary'))
    for name in ('n', 'seed', 'scrambles', 'vary', 'table'):
        if name in entries and name not in uses:
            raise Error(f'{name}: is not used with kind = {kind!r}')
    for name in ('n', 'vary', 'table'):
        if name in uses and name not in entries:
            raise Error(f'{name}: missing; must be {_TYPES[name][1]}')
    if kind == 'table':
        return Plan.table(case, _table(os.path.join(folder, entries['table'])))
    groups = {group: {key: _domain(group, key, value) for key, value in keys.items()} for group, keys in _groups(entries, 'vary').items()}
    options = {name: entries[name] for name in ('n', 'seed', 'scrambles') if name in entries}
    return getattr(Plan, kind)(case, **options, **groups)


def _domain(group: str, key: str, value: Any) -> Any:
    """Returns a list, or the distribution that a table describes."""
    place = f'[vary.{group}] {key}'
    if isinstance(value, list):
        try:
            input_of(group, key, value)
        except Error as error:
            raise Error(f'[vary.{group}]: {error}') from error
        return value
    if not isinstance(value, dict):
        raise Error(f"{place} = {value!r}: must be a list of values, or {{distribution = 'norm', loc = ..., scale = ...}}")
    numbers = dict(value)
    name = numbers.pop('distribution', None)
    found = _distribution(place, name, numbers)
    try:
        input_of(group, key, found)
    except Error as error:
        raise Error(f'[vary.{group}]: {error}') from error
    return found


def _distribution(place: str, name: Any, numbers: dict[str, Any]) -> Any:
    import reprlib

    import numpy as np
    from scipy import stats

    known = [one for one in dir(stats) if isinstance(getattr(stats, one), (stats.rv_continuous, stats.rv_discrete))]
    if name not in known:
        raise Error(f"{place}: distribution = {name!r}: must be one of scipy.stats, such as 'norm', 'truncnorm', 'uniform'"
                    f'{suggestion(name, known) if isinstance(name, str) and "did you" in suggestion(name, known) else ""}')  # fmt: skip
    kind = getattr(stats, name)
    allowed = [*(kind.shapes or '').replace(',', ' ').split(), 'loc', *(['scale'] if isinstance(kind, stats.rv_continuous) else [])]
    for word, number in numbers.items():
        if word not in allowed:
            raise Error(f'{place}: {word} = {number!r}: {name} has the numbers {", ".join(allowed)}')
        if isinstance(number, bool) or not isinstance(number, (int, float)):
            raise Error(f'{place}: {word} = {number!r}: must be a number')
        try:
            numbers[word] = float(number)
        except OverflowError:
            raise Error(f'{place}: {word} = {reprlib.repr(number)}: is too large') from None
    missing = [word for word in allowed if word not in (*numbers, 'loc', 'scale')]
    if missing:
        raise Error(f'{place}: {", ".join(missing)}: missing; {name} has the numbers {", ".join(allowed)}')
    found = kind(**numbers)
    with np.errstate(all='ignore'):  # reported below
        middle = found.ppf(0.5)
    if not np.isfinite(middle):
        raise Error(f'{place}: {name} is not possible with {", ".join(f"{word} = {number:g}" for word, number in numbers.items())}')
    return found


def _table(path: str) -> dict[str, list[Any]]:
    """Reads the columns of a CSV file for the keys in its head: words, logicals, or numbers if one of the column is a number."""
    table = json.loads(edit('table', decoded(content(path), path), key=path))
    if len(table) < 2:
        raise Error(f'{path}: must be a table (CSV) with a line of names and a row of values for each variant', Code.INPUT)
    (_, *names), rows = table[0], table[1:]
    for name in names:
        if names.count(name) > 1:
            raise Error(f'{path}: has two columns {name}', Code.INPUT)
    kinds = {f'{one["group"]}.{one["name"]}': one['kind'] for one in declared()['keys']}
    lines, *columns = zip(*rows)
    return {name: _values(f'{path}: column {name}', kinds.get(name.lower()), lines, words) for name, words in zip(names, columns)}


def _values(place: str, kind: str | None, lines: Sequence[int], words: Sequence[str]) -> list[Any]:
    """Reads the cells of a column; `lines` are their lines in the file."""
    if kind == 'logical':
        return [_LOGICALS.get(word.lower(), word) for word in words]
    found = [_number(word) for word in words]
    if None not in found:
        return found
    at = found.index(None)
    if kind in ('number', 'integer') and (ascii_hint(words[at]) or any(one is not None for one in found)):
        raise Error(f'{place}, line {lines[at]}: {words[at]!r}: must be a number, as others of the column are{ascii_hint(words[at])}', Code.INPUT)
    return list(words)


def _number(word: str) -> float | None:
    try:
        return float(word)
    except ValueError:
        return None
