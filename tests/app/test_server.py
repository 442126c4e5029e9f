"""What the server admits and refuses, and how it begins and ends; without a browser."""

from __future__ import annotations

import asyncio
import gc
import http.client
import re
import signal
import socket
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from served import ROOT, Server, start_server
from typer.testing import Result

from trunnion.app.serve import left


def answer(server: Server, path: str = "/", method: str = "GET", **headers: str) -> tuple[int, str, dict[str, str]]:
    """Status, text and headers of what a request with the given headers is answered."""
    name, _, port = server.host.partition(":")
    connection = http.client.HTTPConnection(name, int(port), timeout=120)
    connection.putrequest(method, path, skip_host=True)
    for key, value in ({"Host": server.host} | {k.replace("_", "-"): v for k, v in headers.items()}).items():
        connection.putheader(key, value)
    connection.endheaders()
    got = connection.getresponse()
    return got.status, got.read().decode("utf-8", "replace"), {k.lower(): v for k, v in got.getheaders()}


def ask(server: Server, path: str = "/", **headers: str) -> tuple[int, str]:
    """Status and text of a request with the given headers."""
    return answer(server, path, **headers)[:2]


def test_own_page_is_served_with_a_policy_that_lets_no_other_script_run(server: Server) -> None:
    status, text, headers = answer(server)
    assert status == 200
    policy = dict(part.split(" ", 1) for part in headers["content-security-policy"].split("; "))
    nonce = re.search(r"'nonce-([\w-]{20,})'", policy["script-src"])
    assert nonce and policy["script-src"] == f"'self' blob: {nonce.group()}"
    assert policy["default-src"] == policy["frame-ancestors"] == policy["base-uri"] == policy["form-action"] == "'none'"
    assert "http:" not in headers["content-security-policy"] and "'unsafe-eval'" not in policy.values()
    scripts = re.findall("<script[^>]*>", text)
    assert len(scripts) > 3 and all(f'nonce="{nonce.group(1)}"' in script for script in scripts)
    assert nonce.group() not in answer(server)[2]["content-security-policy"]
    assert headers["x-frame-options"] == "DENY" and headers["cache-control"] == "no-store"


@pytest.mark.parametrize("path", ["/", "/static/js/bokeh.min.js", "/download/x/driveline/driveline.toml", "/nowhere"])
@pytest.mark.parametrize("site", ["same-origin", "cross-site"])
def test_every_answer_carries_the_headers_that_browsers_go_by(server: Server, path: str, site: str) -> None:
    headers = answer(server, path, Sec_Fetch_Site=site)[2]
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["referrer-policy"] == "same-origin"
    assert headers["cross-origin-resource-policy"] == headers["cross-origin-opener-policy"] == "same-origin"
    assert "frame-ancestors 'none'" in headers["content-security-policy"]


@pytest.mark.parametrize("host", ["evil.example", "evil.example:80", "127.0.0.1", "0.0.0.0:1", ""])
def test_foreign_host_is_refused(server: Server, host: str) -> None:
    status, text = ask(server, Host=host)
    assert (status, "Bokeh" in text) == (403, False)


@pytest.mark.parametrize("origin", ["http://evil.example", "https://127.0.0.1", "null", "http://localhost:1"])
def test_foreign_origin_is_refused(server: Server, origin: str) -> None:
    assert ask(server, Origin=origin)[0] == 403
    upgrade = {"Upgrade": "websocket", "Connection": "Upgrade", "Sec-WebSocket-Version": "13"}
    assert ask(server, "/ws", Origin=origin, Sec_WebSocket_Key="AAAAAAAAAAAAAAAAAAAAAA==", **upgrade)[0] == 403


OWN_NAMES = ("127.0.0.1", "localhost", "[::1]", "127.0.0.2", "127.0.0.1.evil.example", "evil.example")
FOREIGN = [f"{scheme}://{name}{port}" for scheme in ("http", "https") for name in OWN_NAMES for port in ("", ":1")]
FOREIGN += [
    "null",
    "",
    "file://",
    "http://",
    "ws://127.0.0.1",
    "chrome-extension://abc",
    "http://127.0.0.1:{port}.evil.example",
]
FOREIGN += ["https://127.0.0.1:{port}", "http://user@127.0.0.1:{port}", "ftp://localhost:{port}"]


def test_no_page_of_another_origin_gets_an_answer_whatever_it_asks_for(server: Server) -> None:
    """Each of more than thirty origins, with a page, its socket, a file and the script that hands out sessions."""
    port = server.host.partition(":")[2]
    upgrade = {"Upgrade": "websocket", "Connection": "Upgrade", "Sec-WebSocket-Version": "13"}
    upgrade |= {"Sec-WebSocket-Key": "AAAAAAAAAAAAAAAAAAAAAA==", "Sec-WebSocket-Protocol": "bokeh"}
    assert len(FOREIGN) > 30
    for origin in FOREIGN:
        there = origin.format(port=port)
        for path, more in (("/?view=verdict", {}), ("/ws", upgrade), ("/download/x/verdict/view.py", {}),
                           ("/autoload.js?bokeh-autoload-element=x", {}), ("/static/js/bokeh.min.js", {})):  # fmt: skip
            status, text = ask(server, path, Origin=there, **more)
            assert (status, "token" in text, "Bokeh" in text) == (403, False, False), (there, path)
    assert ask(server, "/ws", Sec_WebSocket_Origin="http://evil.example", **upgrade)[0] == 403


DESTINATIONS = {
    "no-cors": ("image", "script", "style", "audio", "video", "font", "object", "embed", "empty", "worker", "manifest"),
    "cors": ("empty", "script", "track", "xslt"),
    "navigate": ("iframe", "frame", "object", "embed", "document"),
    "websocket": ("empty",),
}


@pytest.mark.parametrize("site", ["cross-site", "same-site", "Cross-Site"])
def test_what_another_site_has_the_browser_ask_for_is_refused(server: Server, site: str) -> None:
    """Pictures, scripts, framings: nothing is computed, and no session begun. A link says first where it leads."""
    query = "/?view=verdict&line=eJw%27%22%3E%3Cscript%3E"
    for mode, destinations in DESTINATIONS.items():
        for destination in destinations:
            asked = {"Sec-Fetch-Site": site, "Sec-Fetch-Mode": mode, "Sec-Fetch-Dest": destination}
            status, text = ask(server, query, **asked)
            assert (status, "token" in text, "<script" in text) == (403, False, False), asked
            link = (mode, destination) == ("navigate", "document")
            assert (f"<a href='{query.replace('&', '&amp;')}'>Open it in Trunnion</a>" in text) == link
    assert ask(server, Referer="https://mail.example/inbox")[0] == 403
    assert ask(server, Referer="http://[")[0] == 403


def test_own_pages_bookmarks_and_other_programs_are_answered(server: Server) -> None:
    for site in ("same-origin", "none"):
        assert ask(server, Sec_Fetch_Site=site, Sec_Fetch_Mode="navigate", Sec_Fetch_Dest="document")[0] == 200
    assert ask(server, Referer=f"http://{server.host}/?view=verdict")[0] == 200
    assert ask(server)[0] == 200


@pytest.mark.parametrize("path", ["/autoload.js", "/metadata", "/liveness", "/autoload.js?bokeh-autoload-element=1"])
def test_no_address_hands_a_session_to_whoever_asks(server: Server, path: str) -> None:
    for method in ("GET", "OPTIONS", "HEAD", "POST"):
        status, text, headers = answer(server, path, method)
        assert (status, "token" in text) == (404, False)
        assert "access-control-allow-origin" not in headers


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


def test_bad_arguments_are_refused(run: Callable[..., Result]) -> None:
    """Those that are refused before anything is served in this process, which a server would leave its marks on."""
    code, lines = refused("app", "--no-browser", "--port", "99999")
    assert (code, len(lines)) == (2, 1)
    for arguments in (("--threads", "0"), ("missing.toml",)):
        told = run("app", "--no-browser", *arguments)
        assert told.exit_code == 2 and told.stderr.count("\n") == 1, told.stderr


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
