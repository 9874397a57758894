"""The panel's web server: the page, its calls and its files, for browsers on this machine only."""

from __future__ import annotations

import json
import socket
import threading
from collections.abc import Callable
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.parse import parse_qsl, urlsplit

from ..core.library import Code, Error
from . import files
from .api import Api, StudyDropped, error_json

STATIC = Path(__file__).parent / 'static'
_KINDS = {'.html': 'text/html', '.css': 'text/css', '.js': 'text/javascript', '.svg': 'image/svg+xml'}
_LONGEST = 20_000_000
#: Seconds of silence after which a connection ends, and the largest number of connections, each with its thread.
_PATIENCE = 60
_MOST = 100
#: Headers: the page loads nothing from elsewhere, and no other page may embed it.
_HEADERS = {
    'Content-Security-Policy': "default-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; frame-ancestors 'none'",
    'X-Content-Type-Options': 'nosniff',
    'Referrer-Policy': 'no-referrer',
    'Cache-Control': 'no-store',
}


class Server(ThreadingHTTPServer):
    """Listens on 127.0.0.1; port 0 selects any free one."""

    daemon_threads = True
    address_family = socket.AF_INET

    def __init__(self, api: Api, port: int):
        self.api = api
        self.store = ''  # store of many variants, which is shown instead of a case
        self.pages: dict[str, tuple[object, bytes]] = {}
        self.drawing = threading.Lock()  # matplotlib's settings are global to the process
        super().__init__(('127.0.0.1', port), Handler)
        self.names = {f'{name}:{self.server_port}' for name in ('127.0.0.1', 'localhost')}

    def page_of_store(self) -> bytes:
        """Page of the store, cached until a block is written."""
        from ..many.page import page, stamp

        with self.drawing:
            seen = stamp(self.store)
            cached = self.pages.get(self.store)
            if cached is None or cached[0] != seen:
                cached = seen, page(self.store).encode('utf-8', 'replace')
                self.pages = {self.store: cached}
            return cached[1]

    @property
    def address(self) -> str:
        return f'http://127.0.0.1:{self.server_port}/'

    def verify_request(self, request: Any, client_address: Any) -> bool:
        """Limits the connections to those that a browser with many windows opens."""
        return threading.active_count() <= _MOST

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Ignores connections that the browser closed."""


class Handler(BaseHTTPRequestHandler):
    """Handles one request."""

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
            self._answer(lambda: self._file(address.path.removeprefix('/file/'), asked))
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
        except (ValueError, RecursionError):  # also for arrays nested thousands deep
            self.close_connection = True
            self._say(400, {'error': {'message': 'the request is no JSON object of known length'}})
            return
        call = self.path.removeprefix('/call/')
        if call == 'run':
            self._run(asked)
        elif self.path.startswith('/call/') and call in ('about', 'open', 'check', 'change', 'stop', 'table'):
            self._answer(lambda: getattr(self.server.api, call)(**asked))
        else:
            self._say(404, {'error': {'message': 'there is no such call'}})

    def _is_ours(self, changes: bool = False) -> bool:
        """True if the request comes from a page of this server. The name of another site may lead to this machine, and its page
        may send requests.
        """
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

    def _file(self, what: str, asked: dict[str, str]) -> files.File:
        with self.server.drawing:
            return files.download(self.server.api, what, asked)

    def _store(self) -> None:
        """Returns the present page of a store."""
        try:
            content = self.server.page_of_store()
        except Exception as error:
            code, failure = _failure(error)
            self._say(code, {'error': failure})
            return
        self._send(200, content, 'text/html; charset=utf-8')

    def _static(self, name: str) -> None:
        path = STATIC / name
        if path.suffix not in _KINDS or path not in STATIC.iterdir():
            self._say(404, {'error': {'message': 'there is no such page'}})
        else:
            self._send(200, path.read_bytes(), _KINDS[path.suffix] + '; charset=utf-8')

    def _answer(self, call: Callable[[], Any]) -> None:
        """Sends the result of a call, as JSON or as a file."""
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
        """Sends a run line by line: its progress, and in the end its result or its error."""
        self.close_connection = True
        self._head(200, 'application/x-ndjson', {'Connection': 'close'})
        self.end_headers()
        try:
            last = {'result': self.server.api.run(**asked, progress=lambda done, of: self._line({'done': done, 'of': of}))}
        except ConnectionError:  # the browser no longer waits for it
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
        """Logs nothing: a server for one person needs no log."""


def _failure(error: Exception) -> tuple[int, dict[str, Any]]:
    """Returns the status code of an error, and its message."""
    if isinstance(error, StudyDropped):
        return 410, {'message': 'this study is no longer stored', 'code': 'GONE', 'group': None, 'key': None}
    if isinstance(error, Error):
        return (404 if error.code == Code.FILE else 400), error_json(error)
    return 400, {'message': f'{type(error).__name__}: {error}', 'code': 'INPUT', 'group': None, 'key': None}
