"""Writes files in one step, so that no partial file replaces an old one, and reads files up to a size limit."""

from __future__ import annotations

import contextlib
import errno
import os
import shutil
import stat
import tempfile
from collections.abc import Iterator

from .library import Code, Error

#: Largest size of a case and of the files that it names, as in the library.
_LONGEST = 10_000_000


@contextlib.contextmanager
def replacing(path: str | os.PathLike) -> Iterator[str]:
    """Returns a temporary path in a folder of its own next to `path`; at the end the new file is renamed to `path`.

    After an error or an interrupt, the folder is removed and `path` is unchanged. If `path` is a symbolic link, the linked file is
    replaced. If it is no regular file, such as a pipe or a device, it remains, and the new content is written into it.

    Raises
    ------
    Error
        The file cannot be written.
    """
    path = os.fsdecode(path)
    try:
        target, is_stream = _target(path)
        with tempfile.TemporaryDirectory(prefix='.gearsweep-', dir=None if is_stream else os.path.dirname(target) or '.') as folder:
            new = os.path.join(folder, os.path.basename(path))
            yield new
            if is_stream:
                with open(new, 'rb') as file, open(path, 'wb') as stream:
                    shutil.copyfileobj(file, stream)
            else:
                os.replace(new, target)
    except OSError as error:
        raise Error(f'cannot write {path}: {error.strerror or error}', Code.FILE) from error


def try_file(path: str) -> None:
    """Checks, before anything is computed, that `replacing` can write this file.

    Raises
    ------
    Error
        It cannot.
    """
    try:
        target, is_stream = _target(path)
        if is_stream and not os.access(path, os.W_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
        if not is_stream:
            tempfile.TemporaryDirectory(prefix='.gearsweep-', dir=os.path.dirname(target) or '.').cleanup()
    except OSError as error:
        raise Error(f'cannot write {path}: {error.strerror}', Code.FILE) from error


def _target(path: str) -> tuple[str, bool]:
    """Returns the file that a path leads to, which may not exist yet, and whether it is no regular file.

    Raises
    ------
    OSError
        It is a folder, or a chain of links has no end.
    """
    try:
        mode = os.stat(path).st_mode
    except FileNotFoundError:
        return os.path.realpath(path) if os.path.islink(path) else path, False
    if stat.S_ISDIR(mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
    return os.path.realpath(path) if os.path.islink(path) else path, not stat.S_ISREG(mode)


def content(path: str | os.PathLike) -> bytes:
    """Reads a complete file or pipe.

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
