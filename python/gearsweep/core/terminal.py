"""Standard output and errors of the commands."""

from __future__ import annotations

import os
import sys

from .library import Code, Error
from .texts import visible


def print_text(text: str) -> None:
    """Prints a text at once, unchanged.

    Raises
    ------
    Error
        The standard output is full or closed; once its reader has closed it, nothing more is printed.
    """
    if sys.stdout is None:
        raise Error('cannot write to the standard output: Bad file descriptor', Code.FILE)
    try:
        # The name of a file need not be UTF-8, and the terminal may lack letters of a title.
        if hasattr(sys.stdout, 'reconfigure'):
            sys.stdout.reconfigure(errors='surrogateescape' if sys.stdout.encoding.lower() == 'utf-8' else 'backslashreplace')
        print(text, flush=True)
    except OSError as error:
        # Python would try to print buffered text again at its end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if not isinstance(error, BrokenPipeError):
            raise Error(f'cannot write to the standard output: {error.strerror}', Code.FILE) from error


def print_error(message: str) -> None:
    """Prints an error on one line, without control characters."""
    print(f'gearsweep: {visible(message)}', file=sys.stderr)
