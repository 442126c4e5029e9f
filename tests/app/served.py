"""A server of its own process and a browser for all tests of a run, and pages that note what they asked of whom."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
WAIT = 180_000
"""Milliseconds until a page must have answered: machines that test are busy, and the first run compiles."""

LATE = 90_000
"""The same of a page that was just opened, before it is loaded once more."""
IDLE = "[data-state=idle]"
"""What says that nothing is being computed."""


def browser_path() -> str | None:
    """Chromium or Chrome of the system."""
    names = ("chromium", "chromium-browser", "google-chrome", "chrome")
    return os.environ.get("TRUNNION_BROWSER") or next((p for n in names if (p := shutil.which(n))), None)


@dataclass
class Server:
    """``trunnion app`` in a process of its own."""

    address: str
    process: subprocess.Popen[str]

    def stop(self) -> None:
        """End it and its workers: politely, and where a busy machine takes too long over that, not."""
        self.process.send_signal(signal.SIGINT)
        try:
            self.process.wait(60)
        except subprocess.TimeoutExpired:
            os.killpg(self.process.pid, signal.SIGKILL)
            self.process.wait(60)

    @property
    def host(self) -> str:
        """Host and port."""
        return self.address.removeprefix("http://").rstrip("/")


def start_server(*arguments: str, folder: Path | None = None) -> Server:
    """Start the command, in a folder, and wait for its address."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "src"), "PYTHONUNBUFFERED": "1"}
    command = [sys.executable, "-m", "trunnion", "app", "--no-browser", "--threads", "1", *arguments]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, env=environment, text=True, start_new_session=True,
                               cwd=folder)  # fmt: skip
    assert process.stdout
    found = re.search(r"http://\S+", process.stdout.readline())
    assert found, "the command ended without an address"
    return Server(found.group(), process)


@dataclass
class Look:
    """A page, and what it asked of whom."""

    page: Any
    server: Server
    outside: list[str] = field(default_factory=list)
    errors: list[str] = field(default_factory=list)

    def at(self, query: str = "?view=driveline") -> Look:
        """Open the page and wait until it has computed.

        Two of some hundred fresh pages of *Joints* said "computing …" for good, behind a large picture. The session now
        sends what stayed behind; should it happen again the page is loaded once more, and the report says so.
        """
        from playwright.sync_api import TimeoutError as Late

        self.page.goto(self.server.address + query)
        try:
            self.page.wait_for_selector(IDLE, timeout=LATE)
        except Late:
            warnings.warn(f"{query or 'the first page'} was loaded twice: it still computed after 90 s", stacklevel=2)
            self.page.reload()
            self.settled()
        return self

    def settled(self) -> None:
        """Wait until nothing is being computed."""
        self.page.wait_for_selector(IDLE, timeout=WAIT)

    def settled_anew(self) -> None:
        """Wait until the page has rested for a while: what was just pressed may not have begun yet."""
        self.page.wait_for_timeout(300)
        self.settled()
        done = "e => e.dataset.done"
        before = None
        while (now := self.page.locator("[data-state=idle]").evaluate(done)) != before:
            before = now
            self.page.wait_for_timeout(300)
            self.settled()

    def view(self, title: str) -> None:
        """Choose a view by its button."""
        self.page.get_by_role("button", name=title, exact=True).or_(
            self.page.get_by_role("radio", name=title, exact=True)
        ).first.click()

    def type(self, label: str, text: str) -> None:
        """Type into a field and leave it."""
        box = self.page.get_by_label(label, exact=True)
        box.fill(text)
        box.press("Enter")
        box.blur()


def outside(url: str, server: Server) -> bool:
    own = ("http://" + server.host, "ws://" + server.host, "blob:", "data:")
    return not url.startswith(own)


@pytest.fixture(scope="session")
def server() -> Iterator[Server]:
    """A server on the two-shaft starter."""
    pytest.importorskip("panel")
    running = start_server()
    yield running
    running.stop()  # an ERROR here would stand against whichever test is the last


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """A browser without a window."""
    playwright = pytest.importorskip("playwright.sync_api")
    path = browser_path()
    if path is None:
        pytest.skip("no Chromium found: install Debian's package chromium, or name one in TRUNNION_BROWSER")
    with playwright.sync_playwright() as driver:
        running = driver.chromium.launch(executable_path=path, args=["--no-sandbox"])
        yield running
        running.close()


@pytest.fixture
def look(server: Server, browser: Any) -> Iterator[Look]:
    """A page of a fresh browser context."""
    context = browser.new_context(viewport={"width": 1280, "height": 900}, accept_downloads=True)
    page = context.new_page()
    page.set_default_timeout(WAIT)
    seen = Look(page, server)
    page.on("request", lambda request: seen.outside.append(request.url) if outside(request.url, server) else None)
    page.on("pageerror", lambda error: seen.errors.append(str(error)))
    yield seen
    context.close()
    assert seen.outside == []
    assert seen.errors == []
