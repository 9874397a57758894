"""Files that are replaced only by complete ones, and read with a bound."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Iterator

from ._library import Code, Error

#: What the library allows for a case and for the files that it names.
_LONGEST = 10_000_000


@contextlib.contextmanager
def replacing(path: str | os.PathLike) -> Iterator[str]:
    """A path for a new file, in a folder of its own beside `path`, which it gets as its name at the end.

    Where something fails, or is interrupted, the folder is gone and `path` is as it was.

    Raises
    ------
    Error
        The file cannot be written.
    """
    path = os.fsdecode(path)
    try:
        with tempfile.TemporaryDirectory(prefix='.gearsweep-', dir=os.path.dirname(path) or '.') as folder:
            new = os.path.join(folder, os.path.basename(path))
            yield new
            os.replace(new, path)
    except OSError as error:
        raise Error(f'cannot write {path}: {error.strerror or error}', Code.FILE) from error


def content(path: str | os.PathLike) -> bytes:
    """All of a file, or of a pipe.

    Raises
    ------
    Error
        The file cannot be read, or is longer than a case may be.
    """
    path = os.fsdecode(path)
    try:
        with open(path, 'rb') as file:
            found = file.read(_LONGEST + 1)
    except OSError as error:
        raise Error(f'cannot read {path}: {error.strerror}', Code.FILE) from error
    if len(found) > _LONGEST:
        raise Error(f'{path}: is longer than 10 MB')
    return found
