"""Files of what is on screen: pictures, data, the report, Python; asked for by plain links."""

from __future__ import annotations

from typing import Any

from tornado.web import HTTPError, RequestHandler

from trunnion.app.session import Session
from trunnion.errors import TrunnionError

TYPES = {
    "png": "image/png",
    "svg": "image/svg+xml",
    "csv": "text/csv; charset=utf-8",
    "nc": "application/x-netcdf",
    "html": "text/html; charset=utf-8",
    "py": "text/x-python; charset=utf-8",
    "toml": "application/toml; charset=utf-8",
    "gif": "image/gif",
    "json": "application/json",
}


class Download(RequestHandler):
    """``/download/SESSION/VIEW/NAME.FORMAT``; only what the session shows, and no path of the file system."""

    def initialize(self, sessions: dict[str, Session]) -> None:
        self.sessions = sessions

    async def get(self, token: str, view: str, name: str, ending: str) -> None:
        """The file, computed now if need be."""
        session = self.sessions.get(token)
        if session is None or ending not in TYPES:
            raise HTTPError(404)
        try:
            body = await session.file(view, name, ending)
        except KeyError:
            raise HTTPError(404) from None
        except TrunnionError as error:
            self.set_status(422)
            self.set_header("Content-Type", "text/plain; charset=utf-8")
            self.finish(f"error: {error}\n")
            return
        self.set_header("Content-Type", TYPES[ending])
        self.set_header("Content-Disposition", f'attachment; filename="{view}-{name}.{ending}"')
        self.set_header("Cache-Control", "no-store")
        self.finish(body)

    def write_error(self, status_code: int, **settings: Any) -> None:
        """One line, no traceback."""
        self.set_header("Content-Type", "text/plain; charset=utf-8")
        self.finish(f"error {status_code}: there is no such file; reload the page\n")
