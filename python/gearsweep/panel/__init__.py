"""The front panel: a gear pair, its numbers and its pictures on a page in the browser, for this machine alone.

`gearsweep panel` starts it. Nothing of this package is loaded otherwise.
"""

from __future__ import annotations

import errno
import os
import sys
import webbrowser

from .._library import Code, Error
from .desk import Desk
from .places import Places
from .server import Server

PORT = 8642
HELP = f"""usage: gearsweep panel [CASE.nml | FOLDER | STORE.zarr] [options]

Opens the front panel in the browser, on this machine alone: http://127.0.0.1:{PORT}/
With a case it begins with that; the cases of its folder, or of FOLDER (the current one), are offered beside
those of papers. Files that a case names are read in its folder alone. With a store of `gearsweep many` it shows its
numbers and pictures, also while it is written.

  --port N        another port; 0 is any that is free ({PORT}, or where that is taken any)
  --no-browser    print the address only
  --help          print this

Ctrl-C ends it."""


def main(words: list[str]) -> int:
    """Serves the panel until Ctrl-C, with the words behind `gearsweep panel`; the exit code."""
    if {'--help', '-h'} & set(words):
        print(HELP)
        return Code.OK
    path, port, opens = arguments(words)
    is_store = bool(path) and os.path.isfile(os.path.join(path, 'zarr.json'))
    server = listen(desk_of('' if is_store else path), port)
    if is_store:
        server.store = path
    try:  # Ctrl-C may come as soon as the address is told
        print(f'The panel is at {server.address} (Ctrl-C ends it)', flush=True)
        if opens and not show(server.address):
            print('No browser was found: open this address in one.', file=sys.stderr)
        server.serve_forever()
    except KeyboardInterrupt:
        pass
    finally:
        server.server_close()
    return Code.OK


def show(address: str) -> bool:
    """Opens the page in a browser with a window; False where there is none. One in the terminal could not draw it."""
    try:
        browser = webbrowser.get()
    except webbrowser.Error:
        return False
    return type(browser) is not webbrowser.GenericBrowser and browser.open(address)


def arguments(words: list[str]) -> tuple[str, int | None, bool]:
    """Case or folder, port and whether a browser is to open.

    Raises
    ------
    Error
        The command line is not usable.
    """
    path, port, opens = '', None, True
    rest = iter(words)
    for word in rest:
        if word == '--no-browser':
            opens = False
        elif word == '--port':
            value = next(rest, '')
            if not (value.isascii() and value.isdigit() and int(value) < 65536):
                raise Error('--port: must be an integer from 0 to 65535; gearsweep panel --help tells more', Code.USAGE)
            port = int(value)
        elif word.startswith('-'):
            raise Error(f'unknown option {word}; gearsweep panel --help tells more', Code.USAGE)
        elif path:
            raise Error(f'one case or folder at a time: {path} and {word}; gearsweep panel --help tells more', Code.USAGE)
        else:
            path = word
    return path, port, opens


def desk_of(path: str) -> Desk:
    """A desk with the cases of a folder, or with the folder of a case, which it begins with.

    Raises
    ------
    Error
        There is no such case or folder.
    """
    if not path or os.path.isdir(path):
        return Desk(Places(path or '.'), {'place': 'data', 'name': 'case1.nml'})
    folder, name = os.path.split(os.path.abspath(path))
    places = Places(folder)
    places.read('folder', name)
    return Desk(places, {'place': 'folder', 'name': name})


def listen(desk: Desk, port: int | None = None) -> Server:
    """A server on this port; on the usual one where none is given, or, if that is taken, on any.

    Raises
    ------
    Error
        The port cannot be had.
    """
    try:
        return Server(desk, PORT if port is None else port)
    except OSError as error:
        if port is None and error.errno == errno.EADDRINUSE:
            return Server(desk, 0)
        raise Error(f'--port {port}: {error.strerror}', Code.FILE) from error
