"""How long the application takes to answer, as a browser sees it: medians and 95th percentiles.

    PYTHONPATH=tests/app python benchmarks/app_latency.py [STARTER] [REPEATS]

Needs the extra ``app``, playwright and Chromium. Times are from the key press to the changed page.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from playwright.sync_api import sync_playwright
from served import Server, browser_path, start_server

from trunnion.driveline.starter import starter

WAIT = 300_000


def main() -> None:
    signal.signal(signal.SIGTERM, lambda number, frame: sys.exit(128 + number))  # so that the server is stopped
    name = sys.argv[1] if len(sys.argv) > 1 else "two-shaft"
    repeats = int(sys.argv[2]) if len(sys.argv) > 2 else 20
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "line.toml"
        path.write_text(starter(name), encoding="utf-8")
        measure(name, str(path), repeats)


def measure(name: str, file: str, repeats: int) -> None:
    begin = time.perf_counter()
    server = start_server(file)
    try:
        with sync_playwright() as driver:
            browser = driver.chromium.launch(executable_path=browser_path(), args=["--no-sandbox"])
            page = browser.new_page(viewport={"width": 1280, "height": 900})
            page.set_default_timeout(WAIT)
            page.goto(server.address)
            page.get_by_label("Begin with").wait_for()
            print(f"{name}: start to first page, browser's own start included: {time.perf_counter() - begin:.2f} s")
            for view, query in (("orders", ""), ("stability", "")):
                page.goto(f"{server.address}?view={view}{query}")
                page.wait_for_selector("[data-state=idle]")
                slide(page, repeats // 4 + 1, finished)
                report(f"{name}: number typed to updated {view} view, all of it", slide(page, repeats, finished))
                if view == "stability":
                    report(f"{name}: point typed to its multipliers", points(page, repeats))
            browser.close()
    finally:
        stop(server)


def stop(server: Server) -> None:
    """End the server and its workers, whatever ended the measurement: politely, and after a minute not."""
    server.process.send_signal(signal.SIGINT)
    try:
        server.process.wait(60)
    except subprocess.TimeoutExpired:
        os.killpg(server.process.pid, signal.SIGKILL)


def slide(page: Any, repeats: int, wait: Callable[[Any], None]) -> list[float]:
    """Seconds from a new value of the slider's number to the finished view."""
    box = page.get_by_label("Value [deg]", exact=True)
    times = []
    for k in range(repeats):
        box.fill(f"{3 + 0.37 * (k % 17):.2f}")
        times.append(timed(page, box, wait))
    return times


def points(page: Any, repeats: int) -> list[float]:
    """Seconds from a new point to its table."""
    box = page.get_by_label("Look at input speed [rpm]", exact=True)
    times = []
    for k in range(repeats):
        speed = f"{900 + 37 * (k % 23)}"
        box.fill(speed)
        times.append(
            timed(page, box, lambda p, s=speed: p.locator("td[data-value='speed']", has_text=f"{s} rpm").wait_for())
        )
        finished(page)
    return times


def timed(page: Any, box: Any, wait: Callable[[Any], None]) -> float:
    page.evaluate("n => { window.before = n }", int(page.locator("[data-state]").get_attribute("data-done") or 0))
    begin = time.perf_counter()
    box.press("Enter")
    wait(page)
    return time.perf_counter() - begin


def finished(page: Any) -> None:
    before = page.evaluate("window.before")
    page.locator(f"[data-done='{before + 1}']").wait_for()


def report(what: str, seconds: list[float]) -> None:
    middle, late = np.percentile(seconds, [50, 95])
    print(f"{what}: median {1e3 * middle:.0f} ms, 95th percentile {1e3 * late:.0f} ms ({len(seconds)} times)")


if __name__ == "__main__":
    main()
