"""Who may ask, for what, and what a browser may do with the answer: pages of this very server, on this machine.

The server listens on the loopback address only; but a page of any other site, open in the same browser, can send
requests there, directly (``Sec-Fetch-Site``, ``Origin`` or ``Referer`` tell) or under a name of its own that it lets
point to 127.0.0.1 (``Host`` tells). They are refused before anything is read, computed or begun. A link to a page from
elsewhere, in a mail say, is answered by a page that computes nothing and asks whether to go on.
"""

from __future__ import annotations

import re
import secrets
from typing import Any
from urllib.parse import urlsplit

import tornado.httputil as httputil

from trunnion.app.parts.widgets import markup

REFUSAL = b"This server answers its own pages only: open the address that trunnion app printed.\n"
SERVED = re.compile(r"/|/ws|/favicon\.ico|/(static|components|download)/.*")
"""Paths that there are. Bokeh's ``autoload.js``, which would hand a session to any page, is none of them."""
OWN = ("same-origin", "none")
"""What ``Sec-Fetch-Site`` says of this server's pages, and of an address that was typed or a bookmark."""
HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}
"""Of every answer."""
POLICY = (
    "default-src 'none'; script-src 'self' blob: 'nonce-{nonce}'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data: blob:; font-src 'self' data:; connect-src 'self' blob:{sockets}; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'none'"
)
"""Scripts are files of this server, modules that Panel makes of them, and those that stand in the page as it is sent,
which holds nothing of a driveline: they carry the nonce. No text is compiled (``unsafe-eval``), and no attribute of an
element is a script (``unsafe-inline``). Styles stand beside their elements."""
SANDBOX = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; frame-ancestors 'none'; sandbox"
"""Of a file that is saved, should a browser show it."""
_SCRIPT = re.compile(rb"<script(?=[\s>])")
_FROM_ELSEWHERE = (
    "<!DOCTYPE html><html lang='en'><meta charset='utf-8'><title>Trunnion</title>"
    "<p>A page of another site, or a mail, leads here. It may hold a driveline of somebody else.</p>"
    "<p><a href='{}'>Open it in Trunnion</a></p></html>"
)


class Guard(httputil.HTTPServerConnectionDelegate):
    """Stands before the application and refuses what does not come from ``hosts``."""

    def __init__(self, application: Any, hosts: frozenset[str]) -> None:
        self.application, self.hosts = application, hosts

    def start_request(self, server_conn: object, request_conn: httputil.HTTPConnection) -> Any:
        """A delegate that looks at the headers and hands the request on, or refuses it."""
        return _GuardedHandler(self, server_conn, _HeaderConnection(request_conn, self.hosts))

    def on_close(self, server_conn: object) -> None:
        """Handed on."""
        self.application.on_close(server_conn)

    def names_this(self, headers: httputil.HTTPHeaders) -> bool:
        """Whether the request is for this server under one of its own names."""
        hosts = headers.get_list("Host")
        return len(hosts) == 1 and hosts[0].lower() in self.hosts

    def is_own(self, headers: httputil.HTTPHeaders) -> bool:
        """Whether the request comes from a page of this server, if from any."""
        own = {f"http://{host}" for host in self.hosts}
        origins = [*headers.get_list("Origin"), *headers.get_list("Sec-WebSocket-Origin")]
        origins += [_origin(one) for one in headers.get_list("Referer")]
        sites = headers.get_list("Sec-Fetch-Site")
        return all(one.lower() in own for one in origins) and all(site.lower() in OWN for site in sites)


def _origin(address: str) -> str:
    """Scheme, host and port of an address."""
    try:
        parts = urlsplit(address)
    except ValueError:
        return ""
    return f"{parts.scheme}://{parts.netloc}"


def is_link(start_line: Any, headers: httputil.HTTPHeaders) -> bool:
    """Whether somebody followed a link to a page of this server, in a window of its own."""
    said = (headers.get("Sec-Fetch-Mode", ""), headers.get("Sec-Fetch-Dest", ""), "Origin" in headers)
    return start_line.method == "GET" and said == ("navigate", "document", False)


def one_question(path: str) -> str:
    """A request with every "?" behind the first escaped: a query may hold them, but Panel splits at each."""
    before, mark, query = path.partition("?")
    return before + mark + query.replace("?", "%3F")


def with_nonce(page: bytes, nonce: str) -> bytes:
    """The page with the scripts that stand in it marked as its own."""
    return _SCRIPT.sub(b'<script nonce="' + nonce.encode() + b'"', page)


class _HeaderConnection:
    """A connection whose answers carry the headers of this server."""

    def __init__(self, connection: Any, hosts: frozenset[str]) -> None:
        self._connection, self._hosts = connection, hosts

    def __getattr__(self, name: str) -> Any:
        return getattr(self._connection, name)

    def write_headers(self, start_line: Any, headers: httputil.HTTPHeaders, chunk: bytes | None = None) -> Any:
        """What is answered, with the headers of this server."""
        for name, value in HEADERS.items():
            headers[name] = value
        headers["Content-Security-Policy"] = SANDBOX
        is_page = headers.get("Content-Type", "").startswith("text/html") and "Content-Disposition" not in headers
        if is_page and chunk:
            nonce = secrets.token_urlsafe(16)
            chunk = with_nonce(chunk, nonce)
            sockets = "".join(f" ws://{host}" for host in sorted(self._hosts))
            headers["Content-Security-Policy"] = POLICY.format(nonce=nonce, sockets=sockets)
            headers["Content-Length"] = str(len(chunk))
            headers.pop("Etag", None)
        return self._connection.write_headers(start_line, headers, chunk)


class _GuardedHandler(httputil.HTTPMessageDelegate):
    def __init__(self, guard: Guard, server_conn: object, request_conn: Any) -> None:
        self.guard, self.server_conn, self.connection = guard, server_conn, request_conn
        self.inner: Any = None
        self.bodiless = False
        self.refusal = (403, "Forbidden", "text/plain", REFUSAL)

    def headers_received(self, start_line: Any, headers: httputil.HTTPHeaders) -> Any:
        self.bodiless = start_line.method == "HEAD"
        if not self.guard.names_this(headers):
            return None
        path = start_line.path.partition("?")[0]
        if not self.guard.is_own(headers):
            if path == "/" and is_link(start_line, headers):
                again = markup(_FROM_ELSEWHERE, start_line.path).encode("utf-8", "replace")
                self.refusal = (403, "Forbidden", "text/html; charset=utf-8", again)
            return None
        if not SERVED.fullmatch(path):
            self.refusal = (404, "Not Found", "text/plain", b"There is no such page.\n")
            return None
        start_line = start_line._replace(path=one_question(start_line.path))
        self.inner = self.guard.application.start_request(self.server_conn, self.connection)
        return self.inner.headers_received(start_line, headers)

    def data_received(self, chunk: bytes) -> Any:
        return self.inner.data_received(chunk) if self.inner else None

    def finish(self) -> None:
        if self.inner:
            self.inner.finish()
            return
        code, reason, kind, body = self.refusal
        answer = httputil.HTTPHeaders({"Content-Type": kind, "Content-Length": str(len(body))})
        start_line = httputil.ResponseStartLine("HTTP/1.1", code, reason)
        self.connection.write_headers(start_line, answer, None if self.bodiless else body)
        self.connection.finish()

    def on_connection_close(self) -> None:
        if self.inner:
            self.inner.on_connection_close()
