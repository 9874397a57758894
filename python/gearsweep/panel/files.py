"""Files for downloads from a page: a table as CSV, an archive of all results, a report."""

from __future__ import annotations

import io
import os
import tempfile
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from ..core.library import Error
from ..core.study import Study
from ..report.page import drawings, page


@dataclass
class File:
    name: str
    kind: str
    content: bytes


def download(api: Any, what: str, asked: dict[str, str]) -> File:
    """Builds the requested file `what` of the study with the requested name.

    Raises
    ------
    Error
        There is no such file, or it cannot be built.
    """
    study = api.study(asked.get('study', ''))
    name = ''.join(letter if letter.isalnum() or letter in '-_.' else '_' for letter in asked.get('name') or 'gearsweep')
    name = name.encode('ascii', 'replace').decode().replace('?', '_').lstrip('.')
    if what == 'table':
        table = asked.get('table', '')
        for path, content in written_files(study, name):
            if path == f'{name}.{table}.csv':
                return File(path, 'text/csv; charset=utf-8', content)
        raise Error(f'{table}: this study has no such file')
    if what == 'report':
        return File(f'{name}.html', 'text/html; charset=utf-8', page(study, drawings(study, 'svg')).encode('utf-8', 'replace'))
    if what == 'all':
        return File(f'{name}.zip', 'application/zip', archive(study, name))
    raise Error(f'{what}: there is no such file')


def written_files(study: Study, name: str) -> Iterator[tuple[str, bytes]]:
    """Returns name and content of each file that the program writes for a study."""
    with tempfile.TemporaryDirectory(prefix='gearsweep-') as folder:
        for path in study.write(folder, name):
            with open(path, 'rb') as file:
                yield os.path.basename(path), file.read()


def archive(study: Study, name: str) -> bytes:
    """Builds an archive of case, report as text and page, tables, and pictures if matplotlib is installed."""
    buffer, pictures = io.BytesIO(), drawings(study, 'png', 'svg')
    with zipfile.ZipFile(buffer, 'w', zipfile.ZIP_DEFLATED) as file:
        file.writestr(f'{name}/{name}.nml', study.case.text.encode('utf-8', 'surrogateescape'))
        file.writestr(f'{name}/{name}.txt', study.report().encode('utf-8', 'surrogateescape'))
        file.writestr(f'{name}/{name}.html', page(study, pictures).encode('utf-8', 'replace'))
        for path, content in written_files(study, name):
            file.writestr(f'{name}/{path}', content)
        for table, files in pictures.items():
            for ending, content in files.items():
                file.writestr(f'{name}/{name}.{table}.{ending}', content)
    return buffer.getvalue()
