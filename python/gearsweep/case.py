"""The case: one text that says which gear pair is meant and what to compute."""

from __future__ import annotations

import functools
import numbers
import os
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from . import _library
from ._files import content, replacing
from ._library import Error


@dataclass(frozen=True)
class Case:
    """A case as text, with the folder in which the files that it names lie.

    It never changes: `changed` gives a new one. Its keys are described in doc/case.md; what they may be is
    checked by the library where the case is used.

    Parameters
    ----------
    text : str
        Fortran namelist text.
    folder : str
        Where files that the case names lie; empty: in the current folder.

    Examples
    --------
    >>> case = Case("&pair module_mm = 3  face_width_mm = 20 /  &pinion teeth = 21 /  &gear teeth = 34 /"
    ...             "&load torque_nm = 100 /  &case tasks = 'mesh' /  ! a small pair")
    >>> case.get('pair', 'module_mm'), case.get('pair', 'pressure_angle_deg')
    (3, 20)
    >>> stronger = case.changed(pair={'module_mm': 3.5}, gear={'profile_shift': 0.1})
    >>> print(stronger)
    &pair module_mm = 3.5  face_width_mm = 20 /  &pinion teeth = 21 /  &gear teeth = 34 profile_shift = 0.1 ...
    """

    text: str
    folder: str = ''

    def __post_init__(self):
        if not isinstance(self.text, str):
            raise TypeError(f'text: must be str, not {type(self.text).__name__}')
        object.__setattr__(self, 'folder', os.fspath(self.folder))

    def __repr__(self):
        """The text as it is, its first twenty lines."""
        lines = self.text.strip().splitlines()
        shown = lines[:20] + ([f'... ({len(lines) - 20} more lines)'] if len(lines) > 20 else [])
        return '\n'.join([f'Case with files of {self.folder}:' if self.folder else 'Case:', *shown])

    @classmethod
    def read(cls, path: str | os.PathLike) -> Case:
        """Reads a case from a file; the files that it names lie beside it.

        Raises
        ------
        Error
            The file cannot be read, or is longer than 10 MB.
        """
        text = content(path).decode('utf-8', 'surrogateescape')
        return cls(text, os.path.abspath(os.path.dirname(os.fspath(path))))

    @classmethod
    def build(cls, **groups: Mapping[str, Any]) -> Case:
        """Makes a case of groups and keys, as in `Case.build(pair={'module_mm': 3}, ...)`.

        A list gives several values; None leaves a key out. What is not given has the library's default.
        """
        return cls('').changed(**groups)

    def write(self, path: str | os.PathLike) -> None:
        """Writes the text to a file; one that is there is replaced when the new one is complete.

        Raises
        ------
        Error
            The file cannot be written.
        """
        with replacing(path) as new:
            Path(new).write_bytes(self.text.encode('utf-8', 'surrogateescape'))

    def changed(self, **groups: Mapping[str, Any]) -> Case:
        """A new case with other values, as in `case.changed(relief={'amount_um': [0, 5]})`.

        The rest of the text stays as it is, with its remarks. None takes a key out.

        Raises
        ------
        Error
            A group, key or value that no case could have; of a misspelt key, the closest one is named. Whether
            this case allows the value is told where it is used.
        """
        text = self.text
        new: dict[str, dict[str, str]] = {}  # what one edit does
        for group, keys in groups.items():
            for key, value in keys.items():
                try:
                    word = written(value)
                except Error as error:
                    raise type(error)(f'&{group} {key}: {error}') from None
                if word and word.isprintable() and f'{group}{key}'.isidentifier():
                    new.setdefault(group.lower(), {})[key.lower()] = word
                else:
                    text = _library.edit('change', text, group, key, word)
        if new:
            lines = [' '.join([f'&{group}', *(f'{key} = {word}' for key, word in keys.items()), '/']) for group, keys in new.items()]
            text = _library.edit('change', text, value=' '.join(lines))
        return Case(text, self.folder)

    def get(self, group: str, key: str, default: Any = None) -> Any:
        """The value in effect: as the case gives it, or else the library's default.

        A key with several values gives a tuple; one that has none, or that this case does not use, `default`.

        Raises
        ------
        Error
            The case is not usable, or no case has such a key: the closest one is named.
        """
        group, key = group.lower(), key.lower()
        values = self.values.get(group, {})
        if key not in values:
            _library.edit('change', '', group, key, '')  # fails where there is no such key
        return values.get(key, default)

    @functools.cached_property
    def values(self) -> Mapping[str, Mapping[str, Any]]:
        """All values in effect, by group and key."""
        return parsed(self.complete().text)

    def complete(self) -> Case:
        """The case with every default written out. It gives the same answer."""
        return Case(_library.edit('complete', self.text), self.folder)

    @property
    def tasks(self) -> tuple[str, ...]:
        """What the case asks for."""
        tasks = self.get('case', 'tasks')
        return tasks if isinstance(tasks, tuple) else (tasks,)

    @property
    def unused(self) -> list[str]:
        """Keys that are given but not used, mostly for tasks that the case does not name.

        They are read and checked, but change nothing. For each use that they would have, as in
        `load, sweep or optimum: &pair backlash_um; &dynamics damping_ratio, friction`.

        >>> Case("&case tasks = 'geometry' / &pair module_mm = 3  face_width_mm = 20 /"
        ...      "&pinion teeth = 21 /  &gear teeth = 34 /  &modal modes = 5 /").unused
        ['modal: &modal modes']
        """
        return _library.edit('unused', self.text).splitlines()

    def __str__(self) -> str:
        return self.text


class NoValue(Error, TypeError):
    """A value of a type that no case has, such as a date."""


def written(value: Any) -> str:
    """A value as a case has it.

    >>> written([0, 2.5e-7]), written("it's"), written(True), written(None)
    ('0, 2.5e-07', "'it''s'", '.true.', '')
    """
    if value is None:
        return ''
    if isinstance(value, str):
        return "'" + value.replace("'", "''") + "'"
    if hasattr(value, 'tolist'):  # of NumPy: a scalar or an array
        value = value.tolist()
    if isinstance(value, bool):
        return '.true.' if value else '.false.'
    if isinstance(value, numbers.Integral):
        return str(int(value))
    if isinstance(value, numbers.Real):
        try:
            return repr(float(value))
        except OverflowError as error:
            raise Error(f'a case has no number as large as {type(value).__name__}: {error}') from error
    if isinstance(value, Iterable) and not isinstance(value, (bytes, Mapping)):
        ones = [one.tolist() if hasattr(one, 'tolist') else one for one in value]
        if all(isinstance(one, str) or not isinstance(one, Iterable) for one in ones):
            words = [written(one) for one in ones]
            if all(words):
                return ', '.join(words)
    raise NoValue(f'a case has no values such as {value!r}')


_ASSIGNMENT = re.compile(r'^  (\w+) =(.*(?:\n {4}.*)*)', re.MULTILINE)
_VALUE = re.compile(r"'((?:[^']|'')*)'|([^\s,]+)")


def parsed(complete: str) -> dict[str, dict[str, Any]]:
    """Groups and keys of a text that the library has completed."""
    values: dict[str, dict[str, Any]] = {}
    for group in re.split(r'^&', complete, flags=re.MULTILINE)[1:]:
        name = group.split(maxsplit=1)[0]
        values[name] = {}
        for key, words in _ASSIGNMENT.findall(group):
            found = tuple(_value(*match.groups()) for match in _VALUE.finditer(words))
            values[name][key] = found[0] if len(found) == 1 else found
    return values


def _value(text: str | None, word: str) -> Any:
    if text is not None:
        return text.replace("''", "'")
    if word.lower() in ('.true.', 'true', '.t.', 't'):
        return True
    if word.lower() in ('.false.', 'false', '.f.', 'f'):
        return False
    for kind in (int, float):
        try:
            return kind(word.lower().replace('d', 'e'))
        except ValueError:
            pass
    return word.lower()
