"""Folders of the panel's cases, and the check of the files that a case may read."""

from __future__ import annotations

import functools
import os
import re
from pathlib import Path
from typing import Any

from ..core import library
from ..core.case import Case
from ..core.library import Code, Error
from ..core.names import NUMBERS, TASKS, WORDS
from ..core.texts import decoded

#: Folder in the package: the cases of papers, as in the folder data of the sources.
DATA = Path(__file__).parent / 'cases'
_TITLE = re.compile(r"^[^!\n]*\btitle\s*=\s*'((?:[^'\n]|'')*)'", re.MULTILINE | re.IGNORECASE)


@functools.cache
def description() -> dict[str, Any]:
    """Returns all declarations of the library, its version, and its names for readers."""
    return {'version': library.version(), **library.declared(), 'names': {'numbers': NUMBERS, 'tasks': TASKS, 'words': WORDS}}


class CaseFolders:
    """The two folders of cases: `data`, part of the package, and `folder`, in which the panel was started."""

    def __init__(self, folder: str | os.PathLike):
        self.folders = {'data': DATA, 'folder': Path(folder).resolve()}

    def cases(self) -> list[dict[str, str]]:
        """Lists place, name and title of every case, those of `folder` first."""
        return [
            {'place': place, 'name': path.name, 'title': title_of(path)}
            for place in ('folder', 'data')
            for path in sorted(self.folders[place].glob('*.nml'))
            if path.is_file() and self._holds(place, path)
        ]

    def read(self, place: str, name: str) -> str:
        """Reads the text of a case in a place.

        Raises
        ------
        Error
            There is no such place, or no such case in it.
        """
        if place not in self.folders or name != os.path.basename(name) or not name.endswith('.nml'):
            raise Error(f'{place}: there is no case {name}', Code.FILE)
        path = self.folders[place] / name
        if not self._holds(place, path):
            raise Error(f'{name}: is outside the folder {self.folders[place]}', Code.FILE)
        return Case.read(path).text

    def case(self, text: str, place: str) -> Case:
        """Returns the case with its folder, after a check that the files that it names are in that folder.

        A case from the browser has no folder, and may name no files.

        Raises
        ------
        Error
            A file is in another folder, or the case is not usable.
        """
        case = Case(text, str(self.folders.get(place, '')))
        words = set(re.findall(r'[a-z0-9_]+', text.lower()))
        for group, key in file_keys():
            if key not in words:  # the values in effect take time
                continue
            name = case.values.get(group, {}).get(key)
            if not name:
                continue
            if place not in self.folders:
                raise Error(f'&{group} {key} = {name}: this case has no folder for its files; '
                            'start gearsweep panel in that folder, and open the case from there')  # fmt: skip
            if not isinstance(name, str) or not name.isprintable() or not self._holds(place, self.folders[place] / name):
                raise Error(f'&{group} {key} = {name}: must be in the folder of the case', Code.FILE)
        return case

    def _holds(self, place: str, path: Path) -> bool:
        """True if the file is in the folder, also after links are resolved."""
        return path.resolve().is_relative_to(self.folders[place].resolve())


@functools.cache
def file_keys() -> list[tuple[str, str]]:
    """Returns group and name of each key that may name a file: every free text but the title."""
    keys = [(key['group'], key['name']) for key in description()['keys'] if key['kind'] == 'text' and not key['words']]
    return [key for key in keys if key != ('case', 'title')]


def title_of(path: Path) -> str:
    """Returns the title in a case's text; empty if there is none."""
    found = _TITLE.search(decoded(path.read_bytes(), str(path)))
    return found[1].replace("''", "'") if found else ''
