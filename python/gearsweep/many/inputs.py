"""What a plan varies: keys of a case, each with a distribution or a list of values."""

from __future__ import annotations

import hashlib
import reprlib
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._library import Error, declared, edit
from ..case import Case, written

Reals = NDArray[np.float64]
#: Where a distribution is looked at, to tell it from others.
_PROBES = (np.arange(64) + 0.5) / 64


@dataclass(frozen=True)
class Key:
    """A key that is varied, as far as the processes that compute must know it.

    Attributes
    ----------
    group, key : str
    whole : bool
        It takes whole numbers only.
    choices : tuple, optional
        Values that are no numbers, such as words and lists: a row then has a position in it.
    """

    group: str
    key: str
    whole: bool = False
    choices: tuple | None = None

    @property
    def name(self) -> str:
        return f'{self.group}.{self.key}'

    def written(self, value: float) -> Any:
        """What a case takes for a number of a row.

        Raises
        ------
        Error
            It is no whole number where it must be, or no position in the list.
        """
        if self.choices is None and not self.whole:
            return float(value)
        if not float(value).is_integer():
            raise Error(f'&{self.group} {self.key} = {value}: must be a whole number')
        if self.choices is None:
            return int(value)
        if not 0 <= value < len(self.choices):
            raise Error(f'&{self.group} {self.key}: position {value:g} in its list: must be from 0 to {len(self.choices) - 1}')
        return self.choices[int(value)]


def case_with(case: Case, keys: Iterable[Key], row: Reals) -> Case:
    """The case with the values of a row."""
    groups: dict[str, dict[str, Any]] = {}
    for key, value in zip(keys, row):
        groups.setdefault(key.group, {})[key.key] = key.written(value)
    return case.changed(**groups)


@dataclass(frozen=True)
class Input:
    """A key with what it takes.

    Attributes
    ----------
    key : Key
    given : object with ppf, or tuple
        A distribution, or the values of a list.
    """

    key: Key
    given: Any

    name = property(lambda self: self.key.name)
    is_list = property(lambda self: isinstance(self.given, tuple))

    def values(self, u: Reals) -> Reals:
        """The values at these probabilities, 0 to 1 without the ends."""
        if self.is_list:
            return self.at((u * len(self.given)).astype(int))
        with np.errstate(all='ignore'):  # told below
            found = np.asarray(self.given.ppf(u), float)
        if found.shape != u.shape or not np.isfinite(found).all():
            raise Error(f'&{self.key.group} {self.key.key}: the distribution gives numbers that are not finite')
        return found

    def at(self, position: NDArray[np.int_]) -> Reals:
        """The values at these positions of the list."""
        return position.astype(float) if self.key.choices is not None else np.array(self.given, float)[position]

    def told(self) -> dict[str, Any]:
        """All that its numbers depend on, for JSON."""
        if self.is_list:
            return {'name': self.name, 'values': [str(one) if self.key.choices else float(one) for one in self.given]}
        kind = getattr(getattr(self.given, 'dist', None), 'name', type(self.given).__name__)
        numbers = [float(one) for one in getattr(self.given, 'args', ()) if np.ndim(one) == 0]
        named = {name: float(one) for name, one in getattr(self.given, 'kwds', {}).items() if np.ndim(one) == 0}
        probes = hashlib.sha256(self.values(_PROBES).tobytes()).hexdigest()
        return {'name': self.name, 'distribution': kind, 'args': numbers, **named, 'probes': probes}


def inputs_of(groups: Mapping[str, Mapping[str, Any]], only_lists: bool = False) -> tuple[Input, ...]:
    """The inputs that groups of keys tell, as in `load={'torque_nm': norm(100, 5)}`.

    Raises
    ------
    Error
        No case has such a key, or what is given for it is no distribution and no list.
    """
    found = []
    for group, keys in groups.items():
        if not isinstance(keys, Mapping):
            raise TypeError(f'{group}: must be a dictionary of keys, not {type(keys).__name__}')
        found += [input_of(group, key, given, only_lists) for key, given in keys.items()]
    if not found:
        raise Error('plan: varies no key; give groups such as load={"torque_nm": scipy.stats.norm(100, 5)}')
    return tuple(found)


def input_of(group: str, key: str, given: Any, only_lists: bool = False) -> Input:
    """An input of one key."""
    group, key = group.lower(), key.lower()
    edit('change', '', group, key, '')  # fails where there is no such key, and names the closest
    kind = next(one['kind'] for one in declared()['keys'] if (one['group'], one['name']) == (group, key))
    place, whole = f'&{group} {key}', kind == 'integer'
    if hasattr(given, 'ppf'):
        if only_lists:
            raise Error(f'{place}: a grid takes a list of values, not a distribution')
        if kind not in ('integer', 'number'):
            raise Error(f'{place}: is {kind}, which has no distribution; give a list of values')
        if whole and not hasattr(given, 'pmf'):
            raise Error(f'{place}: takes whole numbers: give a discrete distribution, such as scipy.stats.randint, or a list')
        return Input(Key(group, key, whole), given)
    if isinstance(given, str) or not isinstance(given, Iterable):
        raise Error(f'{place} = {given!r}: must be a distribution of scipy.stats with its numbers, or a list of values')
    values = tuple(one.tolist() if hasattr(one, 'tolist') else one for one in given)
    if not values:
        raise Error(f'{place}: the list is empty')
    if all(isinstance(one, (int, float)) and not isinstance(one, bool) for one in values):
        if large := [one for one in values if not abs(one) <= sys.float_info.max]:
            raise Error(f'{place} = {reprlib.repr(large[0])}: its values must be finite, and at most {sys.float_info.max:.4g}')
        if whole and any(one != round(one) for one in values):
            raise Error(f'{place}: takes whole numbers')
        return Input(Key(group, key, whole), values)
    choices = tuple(tuple(one) if isinstance(one, list) else one for one in values)
    for one in choices:
        try:
            written(one)
        except Error as error:
            raise Error(f'{place}: {error}') from None
    return Input(Key(group, key, whole, choices), choices)
