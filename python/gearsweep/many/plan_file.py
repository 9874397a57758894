"""A plan as a text file (TOML): what `gearsweep many PLAN.toml` runs."""

from __future__ import annotations

import csv
import os
from dataclasses import dataclass
from typing import Any

from .._files import content
from .._library import Code, Error, declared
from ..case import Case
from ..table import meant
from .inputs import input_of
from .plan import Plan

KINDS = ('sobol', 'random', 'lhs', 'saltelli', 'grid', 'table')
#: How a table may write a logical: as a case does, or a spreadsheet.
_LOGICALS = {'.true.': True, '.false.': False, 'true': True, 'false': False}
#: What may stand in the file, of which kind.
_TYPES: dict[str, tuple[tuple[type, ...], str]] = {
    'case': ((str,), 'the name of a file with a case'),
    'kind': ((str,), ', '.join(KINDS)),
    'n': ((int,), 'a whole number'),
    'seed': ((int,), 'a whole number of at least 0'),
    'scrambles': ((int,), 'a whole number of at least 2'),
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
    """What a file tells.

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
    """Reads a plan; files that it names lie beside it.

    Raises
    ------
    Error
        It cannot be read, or something in it is not usable: table, key, value and what is allowed are named.
    """
    import tomllib

    try:
        told = tomllib.loads(content(path).decode())
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise Error(f'{path}: is no TOML: {error}') from error
    try:
        return _plan_file(told, os.path.dirname(path), os.path.splitext(path)[0] + '.zarr')
    except Error as error:
        raise Error(f'{path}: {error}', error.code) from error


def _plan_file(told: dict[str, Any], folder: str, store: str) -> PlanFile:
    for name, value in told.items():
        if name not in _TYPES:
            raise Error(f'{name}: unknown{meant(name, _TYPES)}')
        kinds, allowed = _TYPES[name]
        if not isinstance(value, kinds) or isinstance(value, bool):
            raise Error(f'{name} = {value!r}: must be {allowed}')
    for name in ('case', 'kind', 'take'):
        if name not in told:
            raise Error(f'{name}: missing; must be {_TYPES[name][1]}')
    take = [told['take']] if isinstance(told['take'], str) else told['take']
    for one in take:
        if not isinstance(one, str):
            raise Error(f"take = {one!r}: must be a column 'table.column'")
    case = Case.read(os.path.join(folder, told['case']))
    try:
        case = case.changed(**_groups(told, 'change'))
    except Error as error:
        raise Error(f'[change]: {error}', error.code) from error
    return PlanFile(_plan(case, told, folder), take, os.path.join(folder, told['store']) if 'store' in told else store,
                    told.get('size'), told.get('seconds'))  # fmt: skip


def _groups(told: dict[str, Any], what: str) -> dict[str, dict[str, Any]]:
    groups = told.get(what, {})
    for group, keys in groups.items():
        if not isinstance(keys, dict):
            raise Error(f'[{what}] {group} = {keys!r}: must be a table of keys, [{what}.{group}]')
    return groups


def _plan(case: Case, told: dict[str, Any], folder: str) -> Plan:
    kind = told['kind']
    if kind not in KINDS:
        raise Error(f'kind = {kind!r}: must be one of {", ".join(KINDS)}')
    uses = {'sobol': ('n', 'seed', 'scrambles', 'vary'), 'grid': ('vary',), 'table': ('table',)}.get(kind, ('n', 'seed', 'vary'))
    for name in ('n', 'seed', 'scrambles', 'vary', 'table'):
        if name in told and name not in uses:
            raise Error(f'{name}: is not used with kind = {kind!r}')
    for name in ('n', 'vary', 'table'):
        if name in uses and name not in told:
            raise Error(f'{name}: missing; must be {_TYPES[name][1]}')
    if kind == 'table':
        return Plan.table(case, _table(os.path.join(folder, told['table'])))
    groups = {group: {key: _given(group, key, value) for key, value in keys.items()} for group, keys in _groups(told, 'vary').items()}
    options = {name: told[name] for name in ('n', 'seed', 'scrambles') if name in told}
    return getattr(Plan, kind)(case, **options, **groups)


def _given(group: str, key: str, value: Any) -> Any:
    """A list, or the distribution that a table tells."""
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
    found = _frozen(place, name, numbers)
    try:
        input_of(group, key, found)
    except Error as error:
        raise Error(f'[vary.{group}]: {error}') from error
    return found


def _frozen(place: str, name: Any, numbers: dict[str, Any]) -> Any:
    import reprlib

    import numpy as np
    from scipy import stats

    known = [one for one in dir(stats) if isinstance(getattr(stats, one), (stats.rv_continuous, stats.rv_discrete))]
    if name not in known:
        raise Error(f"{place}: distribution = {name!r}: must be one of scipy.stats, such as 'norm', 'truncnorm', 'uniform'"
                    f'{meant(name, known) if isinstance(name, str) and "did you" in meant(name, known) else ""}')  # fmt: skip
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
    with np.errstate(all='ignore'):  # told below
        middle = found.ppf(0.5)
    if not np.isfinite(middle):
        raise Error(f'{place}: {name} is not possible with {", ".join(f"{word} = {number:g}" for word, number in numbers.items())}')
    return found


def _table(path: str) -> dict[str, list[Any]]:
    """The columns of a CSV file, as the keys take them that they are called by: words, logicals, or numbers where one of the column is."""
    reader = csv.reader(content(path).decode('utf-8-sig', 'replace').splitlines())
    rows = [(reader.line_num, row) for row in reader if row and not row[0].startswith('#')]
    if len(rows) < 2 or any(len(row) != len(rows[0][1]) for _, row in rows):
        raise Error(f'{path}: must be a table (CSV) with a line of names and the same number of values in each row', Code.INPUT)
    names = [name.strip() for name in rows[0][1]]
    for name in names:
        if names.count(name) > 1:
            raise Error(f'{path}: has two columns {name}', Code.INPUT)
    kinds = {f'{one["group"]}.{one["name"]}': one['kind'] for one in declared()['keys']}
    lines = [line for line, _ in rows[1:]]
    return {name: _values(f'{path}: column {name}', kinds.get(name.lower()), lines, [row[at].strip() for _, row in rows[1:]])
            for at, name in enumerate(names)}  # fmt: skip


def _values(place: str, kind: str | None, lines: list[int], words: list[str]) -> list[Any]:
    """The cells of a column, which stand in these lines."""
    if kind == 'logical':
        return [_LOGICALS.get(word.lower(), word) for word in words]
    found = [_number(word) for word in words]
    if None not in found:
        return found
    if kind in ('number', 'integer') and any(one is not None for one in found):
        at = found.index(None)
        raise Error(f'{place}, line {lines[at]}: {words[at]!r}: must be a number, as others of the column are', Code.INPUT)
    return list(words)


def _number(word: str) -> float | None:
    try:
        return float(word)
    except ValueError:
        return None
