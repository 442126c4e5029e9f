"""What the server admits and refuses, and how it begins and ends; without a browser."""

from __future__ import annotations

import asyncio
import gc
import http.client
import signal
import socket
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from served import ROOT, Server, start_server

from trunnion.app.serve import left


def ask(server: Server, path: str = "/", **headers: str) -> tuple[int, str]:
    """Status and text of a request with the given headers."""
    name, _, port = server.host.partition(":")
    connection = http.client.HTTPConnection(name, int(port), timeout=120)
    connection.putrequest("GET", path, skip_host=True)
    for key, value in ({"Host": server.host} | {k.replace("_", "-"): v for k, v in headers.items()}).items():
        connection.putheader(key, value)
    connection.endheaders()
    answer = connection.getresponse()
    return answer.status, answer.read().decode("utf-8", "replace")


def test_own_page_is_served(server: Server) -> None:
    status, text = ask(server)
    assert status == 200
    assert "Content-Security-Policy" in text


@pytest.mark.parametrize("host", ["evil.example", "evil.example:80", "127.0.0.1", "0.0.0.0:1", ""])
def test_foreign_host_is_refused(server: Server, host: str) -> None:
    status, text = ask(server, Host=host)
    assert (status, "Bokeh" in text) == (403, False)


@pytest.mark.parametrize("origin", ["http://evil.example", "https://127.0.0.1", "null", "http://localhost:1"])
def test_foreign_origin_is_refused(server: Server, origin: str) -> None:
    assert ask(server, Origin=origin)[0] == 403
    upgrade = {"Upgrade": "websocket", "Connection": "Upgrade", "Sec-WebSocket-Version": "13"}
    assert ask(server, "/ws", Origin=origin, Sec_WebSocket_Key="AAAAAAAAAAAAAAAAAAAAAA==", **upgrade)[0] == 403


def test_own_origin_is_admitted(server: Server) -> None:
    assert ask(server, Origin=f"http://{server.host}")[0] == 200


def post(server: Server, path: str, **headers: str) -> int:
    """Status of a POST with the given headers."""
    name, _, port = server.host.partition(":")
    connection = http.client.HTTPConnection(name, int(port), timeout=120)
    connection.request("POST", path, body=b"x=1", headers={k.replace("_", "-"): v for k, v in headers.items()})
    return connection.getresponse().status


def test_what_changes_needs_the_token_of_this_site(server: Server) -> None:
    """XSRF: a form of another site carries the cookies of this one, but cannot read the token to send beside them."""
    path = "/download/x/driveline/driveline.toml"
    token = "2|aaaaaaaa|" + "0" * 32 + "|1700000000"
    form = {"Content_Type": "application/x-www-form-urlencoded"}
    assert post(server, path, **form) == 403
    assert post(server, path, **form, Cookie=f"_xsrf={token}") == 403
    assert post(server, path, **form, Cookie=f"_xsrf={token}", X_XSRFToken=token.replace("0", "1")) == 403
    assert post(server, path, **form, Cookie=f"_xsrf={token}", X_XSRFToken=token) == 405  # admitted, nothing to post to


def test_only_the_loopback_address_listens(server: Server) -> None:
    port = int(server.host.partition(":")[2])
    addresses = {a[4][0] for a in socket.getaddrinfo(socket.gethostname(), None, socket.AF_INET)} - {"127.0.0.1"}
    others = [a for a in addresses if not a.startswith("127.")]
    if not others:
        pytest.skip("this machine has no other address")
    with socket.socket() as probe:
        probe.settimeout(5)
        assert probe.connect_ex((others[0], port)) != 0


@pytest.mark.parametrize(
    "path",
    [
        "/download/x/driveline/driveline.toml",
        "/download/x/driveline/..%2f..%2fetc%2fpasswd.toml",
        "/static/../../../../etc/passwd",
        "/static/extensions/panel/../../../../../etc/passwd",
    ],
)
def test_no_path_reaches_the_file_system(server: Server, path: str) -> None:
    status, text = ask(server, path)
    assert status in (403, 404)
    assert "root:" not in text


def test_ctrl_c_stops_the_server_and_its_workers(tmp_path: Path) -> None:
    running = start_server()
    running.process.send_signal(signal.SIGINT)
    assert running.process.wait(60) == 0
    with socket.socket() as probe:
        assert probe.connect_ex(("127.0.0.1", int(running.host.partition(":")[2]))) != 0


def refused(*arguments: str, before: str = "") -> tuple[int, list[str]]:
    """Exit code and lines on stderr of a command that must end by itself."""
    program = f"{before}\nimport sys; sys.argv[1:] = {list(arguments)!r}\nfrom trunnion.cli import main\nmain()"
    ended = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT / "src", capture_output=True, text=True, timeout=300
    )
    return ended.returncode, ended.stderr.splitlines()


def test_without_the_extra_one_line_says_what_to_install() -> None:
    code, lines = refused("app", before="import sys; sys.modules['panel'] = None")
    assert code == 1
    assert len(lines) == 1
    assert 'pip install "trunnion[app]"' in lines[0]


def test_a_port_in_use_is_refused(server: Server) -> None:
    port = server.host.partition(":")[2]
    code, lines = refused("app", "--no-browser", "--port", port)
    assert (code, len(lines)) == (2, 1)
    assert "--port" in lines[0]


@pytest.mark.parametrize("arguments", [("--port", "99999"), ("--threads", "0"), ("missing.toml",)])
def test_bad_arguments_are_refused(arguments: tuple[str, ...]) -> None:
    code, lines = refused("app", "--no-browser", *arguments)
    assert (code, len(lines)) == (2, 1)


def test_a_browser_that_goes_away_while_it_is_written_to_leaves_no_traceback() -> None:
    """Nobody waits for the end of such a write; what else fails unseen is still said."""
    from tornado.websocket import WebSocketClosedError

    said: list[object] = []

    async def fail(error: Exception) -> None:
        raise error

    async def work() -> None:
        loop = asyncio.get_running_loop()
        monkey = type(
            "Loop", (), {"default_exception_handler": lambda self, context: said.append(context["exception"])}
        )
        loop.set_exception_handler(lambda loop, context: left(monkey(), context))
        for error in (WebSocketClosedError(), ValueError("seen")):
            loop.create_task(fail(error))
        await asyncio.sleep(0.01)
        gc.collect()

    with ThreadPoolExecutor(1) as thread:  # the browser's driver has a loop of its own in this one
        thread.submit(asyncio.run, work()).result()
    assert [str(error) for error in said] == ["seen"]
