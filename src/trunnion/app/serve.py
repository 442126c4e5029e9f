"""The server: where it listens, what it serves, how it ends."""

from __future__ import annotations

import asyncio
import signal
import socket
import sys
import webbrowser
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import Any

from trunnion.errors import ComputationError, InputError

ADDRESS = "127.0.0.1"
LARGEST_MESSAGE = 4_000_000
"""Bytes of one message from the browser; a file is refused far below."""


def serve(
    toml: str, *, port: int | None = None, browser: bool = True, threads: int = 1, say: Callable[[str], None] = print
) -> None:
    """Serve the application until Ctrl-C.

    Parameters
    ----------
    toml : the driveline that a new page starts with.
    port : to listen on; by default a free one.
    browser : whether to open the address.
    threads : of each computing process.
    say : takes the address.

    Raises
    ------
    ComputationError : Panel is not installed.
    InputError : the port is taken.
    """
    try:
        import panel
    except ImportError:
        raise ComputationError('the application needs Panel: install it with  pip install "trunnion[app]"') from None
    panel.config.autoreload = False
    port = _free_port() if port is None else _checked(port)
    loop = asyncio.new_event_loop()
    asyncio.set_event_loop(loop)
    from tornado.ioloop import IOLoop

    from trunnion.app.pool import Pool
    from trunnion.app.warming import WARMING

    pool = Pool(loop, threads)
    server = _server(toml, port, pool, IOLoop.current())
    server.start()
    address = f"http://{ADDRESS}:{port}/"
    say(f"Trunnion is at {address}  (stop with Ctrl-C)")
    sys.stdout.flush()
    loop.call_soon(pool.start, WARMING)
    if browser:
        loop.call_later(0.1, partial(webbrowser.open, address))
    try:
        with suppress(ValueError, AttributeError):
            signal.signal(signal.SIGTERM, _interrupt)
        loop.run_forever()
    except KeyboardInterrupt:
        say("stopped")
    finally:
        pool.close()
        server.stop()


def _interrupt(number: int, frame: object) -> None:
    raise KeyboardInterrupt


def _server(toml: str, port: int, pool: Any, loop: Any) -> Any:
    from panel.io.server import get_server

    from trunnion.app.downloads import Download
    from trunnion.app.guard import Guard
    from trunnion.app.session import Session

    hosts = [f"{ADDRESS}:{port}", f"localhost:{port}"]
    sessions: dict[str, Session] = {}
    server = get_server(
        {"/": lambda: Session(toml, pool, sessions).template},
        port=port,
        address=ADDRESS,
        websocket_origin=hosts,
        loop=loop,
        title="Trunnion",
        show=False,
        start=False,
        verbose=False,
        xsrf_cookies=True,
        websocket_max_message_size=LARGEST_MESSAGE,
        extra_patterns=[(r"/download/([\w-]+)/(\w+)/([\w-]+)\.(\w+)", Download, {"sessions": sessions})],
    )
    server._http.request_callback = Guard(server._tornado, frozenset(hosts))
    return server


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind((ADDRESS, 0))
        return int(probe.getsockname()[1])


def _checked(port: int) -> int:
    if not 1 <= port <= 65535:
        raise InputError("is not a port", key="--port", value=port, remedy="give a number from 1024 to 65535")
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((ADDRESS, port))
        except OSError as error:
            problem = f"cannot be used ({error.strerror})"
            remedy = "give another, or leave it out for a free one"
            raise InputError(problem, key="--port", value=port, remedy=remedy) from None
    return port
