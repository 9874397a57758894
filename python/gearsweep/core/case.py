"""The case: one text that describes the gear pair and the tasks."""

from __future__ import annotations

import functools
import numbers
import os
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from . import library
from .files import content, replacing
from .library import Error
from .texts import decoded


@dataclass(frozen=True)
class Case:
    """A case as text, with the folder of the files that it names.

    It is immutable: `changed` returns a new case. Its keys are described in doc/case.md; the library checks their values when the
    case is used.

    Parameters
    ----------
    text : str
        Fortran namelist text.
    folder : str
        Folder of the files that the case names; empty: the current folder.

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
        """Returns the first twenty lines of the text."""
        lines = self.text.strip().splitlines()
        shown = lines[:20] + ([f'... ({len(lines) - 20} more lines)'] if len(lines) > 20 else [])
        return '\n'.join([f'Case with files of {self.folder}:' if self.folder else 'Case:', *shown])

    @classmethod
    def read(cls, path: str | os.PathLike) -> Case:
        """Reads a case from a file; relative names in it refer to the folder of the file.

        Raises
        ------
        Error
            The file cannot be read, or is longer than 10 MB.
        """
        text = decoded(content(path), os.fsdecode(path))
        return cls(text, os.path.abspath(os.path.dirname(os.fspath(path))))

    @classmethod
    def build(cls, **groups: Mapping[str, Any]) -> Case:
        """Builds a case from groups and keys, as in `Case.build(pair={'module_mm': 3}, ...)`.

        A list is several values; None omits a key. Omitted keys have the library's default.
        """
        return cls('').changed(**groups)

    def write(self, path: str | os.PathLike) -> None:
        """Writes the text to a file; an existing file is replaced when the new one is complete.

        Raises
        ------
        Error
            The file cannot be written.
        """
        with replacing(path) as new:
            Path(new).write_bytes(self.text.encode('utf-8', 'surrogateescape'))

    def changed(self, **groups: Mapping[str, Any]) -> Case:
        """Returns a new case with other values, as in `case.changed(relief={'amount_um': [0, 5]})`.

        All other text, comments included, remains unchanged. None removes a key.

        Raises
        ------
        Error
            A group, key or value that no case can have; for a misspelt key, the closest one is named. Whether
            this case allows the value is checked when the case is used.
        """
        text = self.text
        new: dict[str, dict[str, str]] = {}  # changes of one edit
        for group, keys in groups.items():
            if not isinstance(keys, Mapping):
                raise TypeError(f'{group}: must be a dictionary of keys, not {type(keys).__name__}; None removes a key')
            for key, value in keys.items():
                try:
                    word = formatted(value)
                except Error as error:
                    raise type(error)(f'&{group} {key}: {error}') from None
                if word and word.isprintable() and f'{group}{key}'.isidentifier():
                    new.setdefault(group.lower(), {})[key.lower()] = word
                else:
                    text = library.edit('change', text, group, key, word)
        if new:
            lines = [' '.join([f'&{group}', *(f'{key} = {word}' for key, word in keys.items()), '/']) for group, keys in new.items()]
            text = library.edit('change', text, value=' '.join(lines))
        return Case(text, self.folder)

    def get(self, group: str, key: str, default: Any = None) -> Any:
        """Returns the value in effect: that of the case, or the library's default.

        Several values are returned as a tuple; `default` if there is no value or this case does not use the key.

        Raises
        ------
        Error
            The case is not usable, or no case has such a key: the closest one is named.
        """
        group, key = group.lower(), key.lower()
        values = self.values.get(group, {})
        if key not in values:
            library.edit('change', '', group, key, '')  # fails if there is no such key
        return values.get(key, default)

    @functools.cached_property
    def values(self) -> Mapping[str, Mapping[str, Any]]:
        """Returns all values in effect, by group and key."""
        return parsed(self.complete().text)

    def complete(self) -> Case:
        """Returns the case with every default written out. It has the same results."""
        return Case(library.edit('complete', self.text), self.folder)

    @property
    def tasks(self) -> tuple[str, ...]:
        """Tasks of the case."""
        tasks = self.get('case', 'tasks')
        return tasks if isinstance(tasks, tuple) else (tasks,)

    @property
    def unused(self) -> list[str]:
        """Keys of the text that are not used, mostly for tasks that the case does not request.

        They are read and checked, but have no effect. There is a line for each use that they would have, as in
        `load, sweep or optimum: &pair backlash_um; &dynamics damping_ratio, friction`.

        >>> Case("&case tasks = 'geometry' / &pair module_mm = 3  face_width_mm = 20 /"
        ...      "&pinion teeth = 21 /  &gear teeth = 34 /  &modal modes = 5 /").unused
        ['modal: &modal modes']
        """
        return library.edit('unused', self.text).splitlines()

    def __str__(self) -> str:
        return self.text


class NoValue(Error, TypeError):
    """A value of a type that a case cannot have, such as a date."""


def formatted(value: Any) -> str:
    """Formats a value for a case.

    >>> formatted([0, 2.5e-7]), formatted("it's"), formatted(True), formatted(None)
    ('0, 2.5e-07', "'it''s'", '.true.', '')
    """
    if value is None:
        return ''
    if isinstance(value, str):
        return "'" + value.replace("'", "''") + "'"
    if hasattr(value, 'tolist'):  # a scalar or an array of NumPy
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
            words = [formatted(one) for one in ones]
            if all(words):
                return ', '.join(words)
    raise NoValue(f'a case has no values such as {value!r}')


_ASSIGNMENT = re.compile(r'^  (\w+) =(.*(?:\n {4}.*)*)', re.MULTILINE)
_VALUE = re.compile(r"'((?:[^']|'')*)'|([^\s,]+)")


def parsed(complete: str) -> dict[str, dict[str, Any]]:
    """Parses groups and keys of a text with all defaults written out."""
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
