"""Results in files: NumPy's npz format with a description in JSON; no pickle."""

from __future__ import annotations

import dataclasses
import json
import os
from typing import Any

import numpy as np

from . import maps, results
from ._border import Code, Error
from ._files import replacing
from .case import Case

#: Of the files; a later one need not be readable by this version.
_FORMAT = 1
_KINDS = {
    name: kind
    for name, kind in (vars(results) | vars(maps)).items()
    if isinstance(kind, type) and issubclass(kind, results.Result)
}


def save(result: results.Result | results.Study, path: str | os.PathLike) -> None:
    """Writes a result; a file that is there is replaced when the new one is complete.

    Raises
    ------
    Error
        The file cannot be written.
    """
    parts = _parts(result)
    arrays = {f'{name}.{key}': getattr(part, key) for name, part in parts.items() for key in part.units}
    about = {
        'format': _FORMAT,
        'kind': type(result).__name__,
        'version': result.version,
        'text': result.case.text,
        'folder': result.case.folder,
        'parts': {name: type(part).__name__ for name, part in parts.items()},
    }
    with replacing(path) as new, open(new, 'wb') as file:
        np.savez_compressed(file, about=np.frombuffer(json.dumps(about).encode(), np.uint8), **arrays)


def read(path: str | os.PathLike) -> results.Result | results.Study:
    """Reads a result that `save` wrote, bit by bit as it was.

    Raises
    ------
    Error
        The file cannot be read, or is none of ours.

    Examples
    --------
    >>> import gearsweep, os, tempfile
    >>> case = gearsweep.Case('&pair module_mm = 3 face_width_mm = 20 / &pinion teeth = 21 / &gear teeth = 34 /')
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     gearsweep.geometry(case).save(os.path.join(folder, 'pair.npz'))
    ...     geometry = gearsweep.read(os.path.join(folder, 'pair.npz'))
    >>> geometry.case == case, geometry.distance_mm
    (True, 82.5)
    """
    path = os.fspath(path)
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        about = json.loads(arrays['about'].tobytes())
        if about['format'] != _FORMAT:
            raise Error(f'cannot read {path}: format {about["format"]} is not known to this version', Code.FILE)
        case = Case(about['text'], about['folder'])
        parts: dict[str, Any] = {
            name: _part(_KINDS[kind], case, about['version'], name, arrays) for name, kind in about['parts'].items()
        }
        if about['kind'] == 'Study':
            return results.Study(case, about['version'], **parts)
        return parts['']
    except Error:
        raise
    except OSError as error:
        raise Error(f'cannot read {path}: {error.strerror or error}', Code.FILE) from error
    # What a damaged file raises is up to zipfile, zlib, NumPy and json, or whatever it makes of the result.
    except Exception as error:
        raise Error(f'cannot read {path}: is no result of gearsweep', Code.FILE) from error


def _parts(result: results.Result | results.Study) -> dict[str, results.Result]:
    if isinstance(result, results.Study):
        parts = {field.name: getattr(result, field.name) for field in dataclasses.fields(result)}
        return {name: part for name, part in parts.items() if isinstance(part, results.Result)}
    return {'': result}


def _part(kind: type, case: Case, version: str, name: str, arrays: dict) -> results.Result:
    keys = [field.name for field in dataclasses.fields(kind) if 'unit' in field.metadata]
    values = (arrays[f'{name}.{key}'] for key in keys)
    return kind(case, version, *(value if value.ndim else float(value) for value in values))
