"""Where cases lie that the panel offers, and which files a case may read."""

from __future__ import annotations

import functools
import os
import re
from pathlib import Path
from typing import Any

from .. import _library
from .._library import Code, Error
from .._names import NUMBERS, TASKS, WORDS
from ..case import Case

#: Comes with the package: the cases of papers, as in the folder data of the sources.
DATA = Path(__file__).parent / 'cases'
_TITLE = re.compile(r"^[^!\n]*\btitle\s*=\s*'((?:[^'\n]|'')*)'", re.MULTILINE | re.IGNORECASE)


@functools.cache
def description() -> dict[str, Any]:
    """All that the library declares, its version, and what people read for its names."""
    return {'version': _library.version(), **_library.declared(), 'names': {'numbers': NUMBERS, 'tasks': TASKS, 'words': WORDS}}


class Places:
    """Two folders with cases: `data`, which comes with the package, and `folder`, where the panel was started."""

    def __init__(self, folder: str | os.PathLike):
        self.folders = {'data': DATA, 'folder': Path(folder).resolve()}

    def cases(self) -> list[dict[str, str]]:
        """Place, name and title of every case, those of the folder first."""
        return [
            {'place': place, 'name': path.name, 'title': title_of(path)}
            for place in ('folder', 'data')
            for path in sorted(self.folders[place].glob('*.nml'))
            if path.is_file() and self._holds(place, path)
        ]

    def read(self, place: str, name: str) -> str:
        """The text of a case in a place.

        Raises
        ------
        Error
            There is no such place, or no such case in it.
        """
        if place not in self.folders or name != os.path.basename(name) or not name.endswith('.nml'):
            raise Error(f'{place}: there is no case {name}', Code.FILE)
        path = self.folders[place] / name
        if not self._holds(place, path):
            raise Error(f'{name}: lies outside the folder {self.folders[place]}', Code.FILE)
        return Case.read(path).text

    def case(self, text: str, place: str) -> Case:
        """The case with its folder, once it is certain that the files that it names lie in there.

        A case that came from the browser has no folder, and may name no files.

        Raises
        ------
        Error
            A file lies elsewhere, or the case is not usable.
        """
        case = Case(text, str(self.folders.get(place, '')))
        words = set(re.findall(r'[a-z0-9_]+', text.lower()))
        for group, key in file_keys():
            if key not in words:  # it takes time to ask for the values in effect
                continue
            name = case.values.get(group, {}).get(key)
            if not name:
                continue
            if place not in self.folders:
                raise Error(f'&{group} {key} = {name}: this case has no folder in which a file could lie; '
                            'start gearsweep panel in that folder, and open the case from there')  # fmt: skip
            if not isinstance(name, str) or not name.isprintable() or not self._holds(place, self.folders[place] / name):
                raise Error(f'&{group} {key} = {name}: must lie in the folder of the case', Code.FILE)
        return case

    def _holds(self, place: str, path: Path) -> bool:
        """Is the file in the folder, also after links are followed?"""
        return path.resolve().is_relative_to(self.folders[place].resolve())


@functools.cache
def file_keys() -> list[tuple[str, str]]:
    """Group and name of each key that may name a file: every free text but the title."""
    keys = [(key['group'], key['name']) for key in description()['keys'] if key['kind'] == 'text' and not key['words']]
    return [key for key in keys if key != ('case', 'title')]


def title_of(path: Path) -> str:
    """The title in a case's text; empty where there is none."""
    found = _TITLE.search(path.read_text(encoding='utf-8', errors='replace'))
    return found[1].replace("''", "'") if found else ''
