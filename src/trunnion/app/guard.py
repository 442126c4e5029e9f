"""Who may ask: pages of this very server, on this machine.

The server listens on the loopback address only; but a page of any other site, open in the same browser, can send
requests there, directly (its Origin tells) or under a name of its own that it lets point to 127.0.0.1 (the Host tells).
"""

from __future__ import annotations

from typing import Any

import tornado.httputil as httputil

REFUSAL = b"This server answers its own pages only: open the address that trunnion app printed.\n"
POLICY = (
    "default-src 'self' data: blob: 'unsafe-inline' 'unsafe-eval'; "
    "connect-src 'self' ws://127.0.0.1:* ws://localhost:* data: blob:; "
    "frame-ancestors 'none'; form-action 'self'; object-src 'none'; base-uri 'self'"
)
"""Nothing is fetched from elsewhere; Bokeh's callbacks need inline scripts."""


class Guard(httputil.HTTPServerConnectionDelegate):
    """Stands before the application and refuses what does not come from ``hosts``."""

    def __init__(self, application: Any, hosts: frozenset[str]) -> None:
        self.application, self.hosts = application, hosts

    def start_request(self, server_conn: object, request_conn: httputil.HTTPConnection) -> Any:
        """A delegate that looks at the headers and hands the request on, or refuses it."""
        return _Looking(self, server_conn, request_conn)

    def on_close(self, server_conn: object) -> None:
        """Handed on."""
        self.application.on_close(server_conn)

    def admits(self, headers: httputil.HTTPHeaders) -> bool:
        """Whether the request names this server, and comes from a page of it if from any."""
        hosts, origins = headers.get_list("Host"), headers.get_list("Origin")
        return (
            len(hosts) == 1
            and hosts[0].lower() in self.hosts
            and all(origin.lower() in {f"http://{h}" for h in self.hosts} for origin in origins)
        )


def one_question(path: str) -> str:
    """A request with every "?" behind the first escaped: a query may hold them, but Panel splits at each."""
    before, mark, query = path.partition("?")
    return before + mark + query.replace("?", "%3F")


class _Looking(httputil.HTTPMessageDelegate):
    def __init__(self, guard: Guard, server_conn: object, request_conn: httputil.HTTPConnection) -> None:
        self.guard, self.server_conn, self.connection = guard, server_conn, request_conn
        self.inner: Any = None

    def headers_received(self, start_line: Any, headers: httputil.HTTPHeaders) -> Any:
        if self.guard.admits(headers):
            start_line = start_line._replace(path=one_question(start_line.path))
            self.inner = self.guard.application.start_request(self.server_conn, self.connection)
            return self.inner.headers_received(start_line, headers)
        return None

    def data_received(self, chunk: bytes) -> Any:
        return self.inner.data_received(chunk) if self.inner else None

    def finish(self) -> None:
        if self.inner:
            self.inner.finish()
            return
        answer = httputil.HTTPHeaders({"Content-Type": "text/plain", "Content-Length": str(len(REFUSAL))})
        self.connection.write_headers(httputil.ResponseStartLine("HTTP/1.1", 403, "Forbidden"), answer, REFUSAL)
        self.connection.finish()

    def on_connection_close(self) -> None:
        if self.inner:
            self.inner.on_connection_close()
