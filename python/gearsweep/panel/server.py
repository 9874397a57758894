"""The panel's web server: the page, its calls and its files, for browsers on this machine alone."""

from __future__ import annotations

import json
import socket
import threading
from collections.abc import Callable
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.parse import parse_qsl, urlsplit

from .._library import Code, Error
from . import files
from .desk import Desk, Gone, told

STATIC = Path(__file__).parent / 'static'
_KINDS = {'.html': 'text/html', '.css': 'text/css', '.js': 'text/javascript', '.svg': 'image/svg+xml'}
_LONGEST = 20_000_000
#: Seconds that a connection may say nothing, and how many there may be at once, each with its thread.
_PATIENCE = 60
_MOST = 100
#: Nothing comes from elsewhere, and no other page shows this one.
_HEADERS = {
    'Content-Security-Policy': "default-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; frame-ancestors 'none'",
    'X-Content-Type-Options': 'nosniff',
    'Referrer-Policy': 'no-referrer',
    'Cache-Control': 'no-store',
}


class Server(ThreadingHTTPServer):
    """Listens on 127.0.0.1; a port of 0 is any that is free."""

    daemon_threads = True
    address_family = socket.AF_INET

    def __init__(self, desk: Desk, port: int):
        self.desk = desk
        self.store = ''  # of many variants, which is shown instead of a case
        super().__init__(('127.0.0.1', port), Handler)
        self.names = {f'{name}:{self.server_port}' for name in ('127.0.0.1', 'localhost')}

    @property
    def address(self) -> str:
        return f'http://127.0.0.1:{self.server_port}/'

    def verify_request(self, request: Any, client_address: Any) -> bool:
        """No more than a browser with many windows opens."""
        return threading.active_count() <= _MOST

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A browser that left is no error."""


class Handler(BaseHTTPRequestHandler):
    """One request."""

    server: Server
    protocol_version = 'HTTP/1.1'
    server_version = 'gearsweep'
    sys_version = ''
    timeout = _PATIENCE

    def do_GET(self) -> None:
        address = urlsplit(self.path)
        if not self._is_ours():
            return
        if address.path == '/' and self.server.store:
            self._store()
        elif address.path == '/' or address.path.startswith('/static/'):
            self._static(address.path.removeprefix('/static/') if address.path != '/' else 'index.html')
        elif address.path.startswith('/file/'):
            asked = dict(parse_qsl(address.query))
            self._answer(lambda: files.made(self.server.desk, address.path.removeprefix('/file/'), asked))
        else:
            self._say(404, {'error': {'message': 'there is no such page'}})

    def do_POST(self) -> None:
        if not self._is_ours(changes=True):
            return
        try:
            length = int(self.headers.get('Content-Length', ''))
            if not 0 <= length <= _LONGEST:
                raise ValueError
            asked = json.loads(self.rfile.read(length))
            if not isinstance(asked, dict):
                raise ValueError
        except (ValueError, RecursionError):  # also of arrays in arrays, thousands deep
            self.close_connection = True
            self._say(400, {'error': {'message': 'the request is no JSON object of known length'}})
            return
        call = self.path.removeprefix('/call/')
        if call == 'run':
            self._run(asked)
        elif self.path.startswith('/call/') and call in ('about', 'open', 'check', 'change', 'stop', 'table'):
            self._answer(lambda: getattr(self.server.desk, call)(**asked))
        else:
            self._say(404, {'error': {'message': 'there is no such call'}})

    def _is_ours(self, changes: bool = False) -> bool:
        """Does a page of this server ask? Another site's name may lead to this machine, and its page may send here."""
        origin = self.headers.get('Origin')
        at_home = origin is None or origin in {f'http://{name}' for name in self.server.names}
        is_ours = self.headers.get('Host') in self.server.names and at_home
        if self.headers.get('Sec-Fetch-Site') in ('cross-site', 'same-site'):
            is_ours = False
        if changes and self.headers.get_content_type() != 'application/json':
            is_ours = False
        if not is_ours:
            self.close_connection = True
            self._say(403, {'error': {'message': 'this page answers to this machine alone'}})
        return is_ours

    def _store(self) -> None:
        """The page of a store, as it is now."""
        try:
            from ..many.page import page

            content = page(self.server.store)
        except Exception as error:
            code, failure = _failure(error)
            self._say(code, {'error': failure})
            return
        self._send(200, content.encode('utf-8', 'replace'), 'text/html; charset=utf-8')

    def _static(self, name: str) -> None:
        path = STATIC / name
        if path.suffix not in _KINDS or path not in STATIC.iterdir():
            self._say(404, {'error': {'message': 'there is no such page'}})
        else:
            self._send(200, path.read_bytes(), _KINDS[path.suffix] + '; charset=utf-8')

    def _answer(self, call: Callable[[], Any]) -> None:
        """What a call returns, as JSON or as a file."""
        try:
            found = call()
        except Exception as error:
            code, failure = _failure(error)
            self._say(code, {'error': failure})
            return
        if isinstance(found, files.File):
            self._send(200, found.content, found.kind, {'Content-Disposition': f'attachment; filename="{found.name}"'})
        else:
            self._say(200, found)

    def _run(self, asked: dict[str, Any]) -> None:
        """A run, line by line: how far it is, and in the end its result or its error."""
        self.close_connection = True
        self._head(200, 'application/x-ndjson', {'Connection': 'close'})
        self.end_headers()
        try:
            last = {'result': self.server.desk.run(**asked, progress=lambda done, of: self._line({'done': done, 'of': of}))}
        except ConnectionError:  # nobody waits for it any longer
            return
        except Exception as error:
            last = {'error': _failure(error)[1]}
        self._line(last)

    def _line(self, words: Any) -> None:
        self.wfile.write(json.dumps(words, allow_nan=False).encode('utf-8', 'replace') + b'\n')

    def _say(self, code: int, words: Any) -> None:
        self._send(code, json.dumps(words, allow_nan=False).encode('utf-8', 'replace'), 'application/json')

    def _send(self, code: int, content: bytes, kind: str, more: dict[str, str] | None = None) -> None:
        self._head(code, kind, {'Content-Length': str(len(content)), **(more or {})})
        self.end_headers()
        self.wfile.write(content)

    def _head(self, code: int, kind: str, more: dict[str, str]) -> None:
        self.send_response(code)
        for name, value in {**_HEADERS, 'Content-Type': kind, **more}.items():
            self.send_header(name, value)

    def log_message(self, format: str, *args: Any) -> None:
        """Nothing: a server that is used by one person needs no log."""


def _failure(error: Exception) -> tuple[int, dict[str, Any]]:
    """The code of the answer, and what it says."""
    if isinstance(error, Gone):
        return 410, {'message': 'this study is no longer kept', 'code': 'GONE', 'group': None, 'key': None}
    if isinstance(error, Error):
        return (404 if error.code == Code.FILE else 400), told(error)
    return 400, {'message': f'{type(error).__name__}: {error}', 'code': 'INPUT', 'group': None, 'key': None}
