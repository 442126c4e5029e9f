"""The server: where it listens, what it serves, how it ends."""

from __future__ import annotations

import asyncio
import gc
import signal
import socket
import sys
import threading
import warnings
import webbrowser
from collections.abc import Callable
from contextlib import closing, suppress
from importlib.util import find_spec
from typing import Any

from trunnion.app.pool import Pool
from trunnion.errors import ComputationError, InputError

ADDRESS = "127.0.0.1"
LARGEST_MESSAGE = 4_000_000
"""Bytes of one message from the browser; a file is refused far below."""
LATEST = 15.0
"""Seconds until kernels are warmed though no page was opened; else they are once the first one shows what it has."""


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
    if find_spec("panel") is None:
        raise ComputationError('the application needs Panel: install it with  pip install "trunnion[app]"')
    interrupts = Interrupts()
    gc.disable()  # modules that load leave nothing to collect; see _serve_on
    listening = _listening(port)
    port = listening.getsockname()[1]
    address = f"http://{ADDRESS}:{port}/"
    say(f"Trunnion is at {address}  (stop with Ctrl-C)")
    sys.stdout.flush()
    if browser:
        threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()
    loop = asyncio.new_event_loop()
    asyncio.set_event_loop(loop)
    loop.set_exception_handler(left)
    pool = Pool(loop, threads)
    try:
        with closing(listening), closing(pool):
            _serve_on(listening, toml, pool, loop, interrupts)
    except KeyboardInterrupt:
        say("stopped")


def left(loop: Any, context: Any) -> None:
    """Say what failed in a task that nobody waits for, but nothing of browsers that went away while it wrote."""
    from tornado.iostream import StreamClosedError
    from tornado.websocket import WebSocketClosedError

    if not isinstance(context.get("exception"), WebSocketClosedError | StreamClosedError):
        loop.default_exception_handler(context)


class Interrupts:
    """Ctrl-C. While modules load it is kept for the end of that: half a module is worse than a second's wait."""

    def __init__(self) -> None:
        self.loading, self.wanted = True, False
        self.catch()

    def catch(self) -> None:
        """Be the one that hears of it."""
        for number in (signal.SIGINT, signal.SIGTERM):
            with suppress(ValueError, AttributeError):  # not in the main thread
                signal.signal(number, self)

    def loaded(self) -> None:
        """From now on at once. KeyboardInterrupt where it came before."""
        self.catch()
        self.loading = False
        if self.wanted:
            raise KeyboardInterrupt

    def __call__(self, number: int, frame: object) -> None:
        self.wanted = True
        if not self.loading:
            raise KeyboardInterrupt


def _serve_on(listening: socket.socket, toml: str, pool: Pool, loop: Any, interrupts: Interrupts) -> None:
    """Load what pages need, answer who has asked meanwhile, and go on until Ctrl-C."""
    import panel

    panel.config.autoreload = False
    # The browser sends back a button that is new on the page; nothing is changed, and the terminal need not say so.
    warnings.filterwarnings("ignore", message="reference already known")
    from tornado.ioloop import IOLoop

    from trunnion.app.warming import WARMING

    server = _server(toml, listening, pool, IOLoop.current())
    try:
        server.start()
        gc.freeze()
        gc.enable()
        interrupts.loaded()
        loop.call_soon(pool.start)
        loop.call_later(LATEST, pool.warm, WARMING)
        loop.run_forever()
    finally:
        server.stop()


def _server(toml: str, listening: socket.socket, pool: Pool, loop: Any) -> Any:
    from panel.io.server import get_server
    from tornado.httpserver import HTTPServer

    from trunnion.app.downloads import Download
    from trunnion.app.guard import Guard
    from trunnion.app.session import Session

    port = listening.getsockname()[1]
    hosts = [f"{ADDRESS}:{port}", f"localhost:{port}"]
    sessions: dict[str, Session] = {}
    server = get_server(
        {"/": lambda: Session(toml, pool, sessions).template},
        port=0,
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
    server._http.stop()  # the port of its own, in favour of the one where browsers wait already, behind the guard
    HTTPServer(Guard(server._tornado, frozenset(hosts))).add_socket(listening)
    return server


def _listening(port: int | None) -> socket.socket:
    """A socket that takes connections, though nobody answers yet."""
    if port is not None and not 1 <= port <= 65535:
        raise InputError("is not a port", key="--port", value=port, remedy="give a number from 1024 to 65535")
    listening = socket.socket()
    if sys.platform != "win32":  # where it would let two programs share a port
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind((ADDRESS, port or 0))
    except OSError as error:
        listening.close()
        problem = f"cannot be used ({error.strerror})"
        remedy = "give another, or leave it out for a free one"
        raise InputError(problem, key="--port", value=port, remedy=remedy) from None
    listening.listen(128)
    listening.setblocking(False)
    return listening
