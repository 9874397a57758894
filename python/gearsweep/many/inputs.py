"""Inputs of a plan: keys of a case, each with a distribution or a list of values."""

from __future__ import annotations

import hashlib
import reprlib
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.case import Case, formatted
from ..core.library import Error, declared, edit

Reals = NDArray[np.float64]
#: Probabilities at which a distribution is evaluated, to distinguish it from others.
_PROBES = (np.arange(64) + 0.5) / 64


@dataclass(frozen=True)
class Key:
    """A key that is varied, with the data that the computing processes need.

    Attributes
    ----------
    group, key : str
    integer : bool
        True for integers only.
    choices : tuple, optional
        Values other than numbers, such as words and lists: a row then has an index in it.
    """

    group: str
    key: str
    integer: bool = False
    choices: tuple | None = None

    @property
    def name(self) -> str:
        return f'{self.group}.{self.key}'

    def formatted(self, value: float) -> Any:
        """Formats the number of a row for a case.

        Raises
        ------
        Error
            It is no integer where one is required, or no index of the list.
        """
        if self.choices is None and not self.integer:
            return float(value)
        if not float(value).is_integer():
            raise Error(f'&{self.group} {self.key} = {value}: must be a whole number')
        if self.choices is None:
            return int(value)
        if not 0 <= value < len(self.choices):
            raise Error(f'&{self.group} {self.key}: position {value:g} in its list: must be from 0 to {len(self.choices) - 1}')
        return self.choices[int(value)]


def case_with(case: Case, keys: Iterable[Key], row: Reals) -> Case:
    """Returns the case with the values of a row."""
    groups: dict[str, dict[str, Any]] = {}
    for key, value in zip(keys, row):
        groups.setdefault(key.group, {})[key.key] = key.formatted(value)
    return case.changed(**groups)


@dataclass(frozen=True)
class Input:
    """A key with its distribution or list.

    Attributes
    ----------
    key : Key
    distribution : object with ppf, or tuple
        A distribution, or the values of a list.
    """

    key: Key
    distribution: Any

    name = property(lambda self: self.key.name)
    is_list = property(lambda self: isinstance(self.distribution, tuple))

    def values(self, u: Reals) -> Reals:
        """Returns the values at these probabilities, between 0 and 1."""
        if self.is_list:
            return self.at((u * len(self.distribution)).astype(int))
        with np.errstate(all='ignore'):  # reported below
            found = np.asarray(self.distribution.ppf(u), float)
        if found.shape != u.shape or not np.isfinite(found).all():
            raise Error(f'&{self.key.group} {self.key.key}: the distribution has numbers that are not finite')
        return found

    def at(self, position: NDArray[np.int_]) -> Reals:
        """Returns the values at these indices of the list."""
        return position.astype(float) if self.key.choices is not None else np.array(self.distribution, float)[position]

    def description(self) -> dict[str, Any]:
        """Returns all data that its numbers depend on, for JSON."""
        if self.is_list:
            return {'name': self.name, 'values': [str(one) if self.key.choices else float(one) for one in self.distribution]}
        kind = getattr(getattr(self.distribution, 'dist', None), 'name', type(self.distribution).__name__)
        numbers = [float(one) for one in getattr(self.distribution, 'args', ()) if np.ndim(one) == 0]
        named = {name: float(one) for name, one in getattr(self.distribution, 'kwds', {}).items() if np.ndim(one) == 0}
        probes = hashlib.sha256(self.values(_PROBES).tobytes()).hexdigest()
        return {'name': self.name, 'distribution': kind, 'args': numbers, **named, 'probes': probes}


def described(one: dict[str, Any]) -> str:
    """Describes the values of a key in words, from the data of `Input.description`."""
    if 'values' in one:
        shown = ', '.join(f'{value:g}' if isinstance(value, float) else str(value) for value in one['values'][:8])
        return shown + (' ...' if len(one['values']) > 8 else '') or 'as in the table'
    more = [f'{name} = {value:g}' for name, value in one.items() if isinstance(value, float)]
    return f'{one["distribution"]}({", ".join([*(f"{value:g}" for value in one["args"]), *more])})'


def inputs_of(groups: Mapping[str, Mapping[str, Any]], only_lists: bool = False) -> tuple[Input, ...]:
    """Returns the inputs of groups of keys, as in `load={'torque_nm': norm(100, 5)}`.

    Raises
    ------
    Error
        No case has such a key, or its value is neither a distribution nor a list.
    """
    found = []
    for group, keys in groups.items():
        if not isinstance(keys, Mapping):
            raise TypeError(f'{group}: must be a dictionary of keys, not {type(keys).__name__}')
        found += [input_of(group, key, distribution, only_lists) for key, distribution in keys.items()]
    if not found:
        raise Error('plan: varies no key; add groups such as load={"torque_nm": scipy.stats.norm(100, 5)}')
    return tuple(found)


def input_of(group: str, key: str, distribution: Any, only_lists: bool = False) -> Input:
    """Returns the input of one key."""
    group, key = group.lower(), key.lower()
    edit('change', '', group, key, '')  # fails if there is no such key, and names the closest
    kind = next(one['kind'] for one in declared()['keys'] if (one['group'], one['name']) == (group, key))
    place, integer = f'&{group} {key}', kind == 'integer'
    if hasattr(distribution, 'ppf'):
        if only_lists:
            raise Error(f'{place}: a grid needs a list of values, not a distribution')
        if kind not in ('integer', 'number'):
            raise Error(f'{place}: is {kind}, which has no distribution; use a list of values')
        if integer and not hasattr(distribution, 'pmf'):
            raise Error(f'{place}: must be whole numbers: use a discrete distribution, such as scipy.stats.randint, or a list')
        return Input(Key(group, key, integer), distribution)
    if isinstance(distribution, str) or not isinstance(distribution, Iterable):
        raise Error(f'{place} = {distribution!r}: must be a distribution of scipy.stats with its numbers, or a list of values')
    values = tuple(one.tolist() if hasattr(one, 'tolist') else one for one in distribution)
    if not values:
        raise Error(f'{place}: the list is empty')
    if all(isinstance(one, (int, float)) and not isinstance(one, bool) for one in values):
        if large := [one for one in values if not abs(one) <= sys.float_info.max]:
            raise Error(f'{place} = {reprlib.repr(large[0])}: its values must be finite, and at most {sys.float_info.max:.4g}')
        if integer and any(one != round(one) for one in values):
            raise Error(f'{place}: must be whole numbers')
        return Input(Key(group, key, integer), values)
    choices = tuple(tuple(one) if isinstance(one, list) else one for one in values)
    for one in choices:
        try:
            formatted(one)
        except Error as error:
            raise Error(f'{place}: {error}') from None
    return Input(Key(group, key, integer, choices), choices)
