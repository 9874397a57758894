"""The front panel: a gear pair, its numbers and its pictures on a page in the browser, for this machine alone.

`gearsweep panel` starts it. Without it, no module of this package is loaded.
"""

from __future__ import annotations

import errno
import os
import sys
import webbrowser

from ..core.library import Code, Error
from .api import Api
from .case_folders import CaseFolders
from .server import Server

PORT = 8642
HELP = f"""usage: gearsweep panel [CASE.nml | FOLDER | STORE.zarr] [options]

Opens the front panel in the browser, on this machine alone: http://127.0.0.1:{PORT}/
It starts with the named case and lists the cases of its folder, or of FOLDER (the current one), and those of
papers. Files that a case names are read from its folder only. For a store of `gearsweep many` it shows numbers
and pictures, also while it is written.

  --port N        another port; 0 selects a free one ({PORT}, or a free one if that is in use)
  --no-browser    print the address only
  --help          print this

Ctrl-C ends it."""


def main(words: list[str]) -> int:
    """Serves the panel until Ctrl-C; `words`: the arguments of `gearsweep panel`. Returns the exit code."""
    if {'--help', '-h'} & set(words):
        print(HELP)
        return Code.OK
    path, port, opens = arguments(words)
    is_store = bool(path) and os.path.isfile(os.path.join(path, 'zarr.json'))
    server = listen(api_of('' if is_store else path), port)
    if is_store:
        server.store = path
    try:  # Ctrl-C may come as soon as the address is printed
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
    """Opens the page in a browser with a window; returns False if there is none. A browser in the terminal could not draw the
    page.
    """
    try:
        browser = webbrowser.get()
    except webbrowser.Error:
        return False
    return type(browser) is not webbrowser.GenericBrowser and browser.open(address)


def arguments(words: list[str]) -> tuple[str, int | None, bool]:
    """Parses the command line: case or folder, port, and whether to open a browser.

    Raises
    ------
    Error
        The command line is not usable.
    """
    path, port, opens = '', None, True
    remaining = iter(words)
    for word in remaining:
        if word == '--no-browser':
            opens = False
        elif word == '--port':
            value = next(remaining, '')
            if not (value.isascii() and value.isdigit() and int(value) < 65536):
                raise Error('--port: must be an integer from 0 to 65535; gearsweep panel --help has more', Code.USAGE)
            port = int(value)
        elif word.startswith('-'):
            raise Error(f'unknown option {word}; gearsweep panel --help has more', Code.USAGE)
        elif path:
            raise Error(f'one case or folder at a time: {path} and {word}; gearsweep panel --help has more', Code.USAGE)
        else:
            path = word
    return path, port, opens


def api_of(path: str) -> Api:
    """Returns an API with the cases of a folder, or with those of the folder of a case, which is shown first.

    Raises
    ------
    Error
        There is no such case or folder.
    """
    if not path or os.path.isdir(path):
        return Api(CaseFolders(path or '.'), {'place': 'data', 'name': 'case1.nml'})
    folder, name = os.path.split(os.path.abspath(path))
    case_folders = CaseFolders(folder)
    case_folders.read('folder', name)
    return Api(case_folders, {'place': 'folder', 'name': name})


def listen(api: Api, port: int | None = None) -> Server:
    """Opens a server on this port; without a port on the usual one or, if that is in use, on any.

    Raises
    ------
    Error
        The port is not available.
    """
    try:
        return Server(api, PORT if port is None else port)
    except OSError as error:
        if port is None and error.errno == errno.EADDRINUSE:
            return Server(api, 0)
        raise Error(f'--port {port}: {error.strerror}', Code.FILE) from error
