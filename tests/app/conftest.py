"""One server and one browser for all tests of a process; each test gets a page of its own."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from served import WAIT, Look, Server, browser_path, outside, start_server


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
