"""How long the application takes to answer, as a browser sees it: medians and 95th percentiles.

    PYTHONPATH=src:tests/app python benchmarks/app_latency.py [STARTER] [REPEATS]

Needs the extra ``app``, playwright and Chromium. Times are from the key press, the click or the start of the command to
the changed page; each line names the load of the machine, since the server, its workers and the browser share it. Below
stands the mean processor time of the server and of its workers (Linux), which other work does not lengthen much.
"""

from __future__ import annotations

import asyncio
import os
import re
import signal
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from playwright.sync_api import sync_playwright
from served import browser_path, start_server
from test_views import laborious

from trunnion.app.address import pack
from trunnion.app.parts.calls import LINE, Call
from trunnion.app.parts.jobs import Job
from trunnion.app.pool import Pool
from trunnion.driveline.starter import starter

WAIT = 300_000
FULL = """before => {
  const search = (root) => {
    for (const node of root.querySelectorAll('*')) {
      if (node.dataset?.chart === 'chart' && +node.dataset.count > before) return true
      if (node.shadowRoot && search(node.shadowRoot)) return true
    }
    return false
  }
  return search(document)
}"""
"""A full chart newer than the one numbered ``before``."""


def main() -> None:
    signal.signal(signal.SIGTERM, lambda number, frame: sys.exit(128 + number))  # so that the server is stopped
    name = sys.argv[1] if len(sys.argv) > 1 else "two-shaft"
    repeats = int(sys.argv[2]) if len(sys.argv) > 2 else 20
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "line.toml"
        path.write_text(starter(name), encoding="utf-8")
        begins, spent = zip(*(first_page(str(path)) for _ in range(max(3, repeats // 5))), strict=True)
        every = (sum(one[0] for one in spent), sum(one[1] for one in spent))
        report(f"{name}: start of the command to the first page, the browser's own start included", list(begins), every)
        measure(name, str(path), repeats)
    report("a job that does not listen, cancelled, to the end of its process", asyncio.run(ends(max(3, repeats // 4))))


Spent = tuple[float, float]
"""Seconds of processor time: of the server, of its workers."""


def processor(server: Any) -> Spent:
    """Processor time so far; nothing where the system does not say it."""
    tick = os.sysconf("SC_CLK_TCK") if hasattr(os, "sysconf") else 1
    own, workers = 0.0, 0.0
    for place in Path("/proc").glob("[0-9]*/stat"):
        try:
            name, _, fields = place.read_text().rpartition(")")
        except OSError:
            continue  # ended meanwhile
        number, numbers = int(place.parent.name), fields.split()
        seconds = (int(numbers[11]) + int(numbers[12])) / tick
        if number == server.process.pid:
            own = seconds + (int(numbers[13]) + int(numbers[14])) / tick  # with those that have ended
        elif int(numbers[1]) == server.process.pid:
            workers += seconds
    return own, workers


def first_page(file: str) -> tuple[float, Spent]:
    """Seconds from the command to its first page, and what the server and its workers had spent by then."""
    begin = time.perf_counter()
    server = start_server(file)
    try:
        with sync_playwright() as driver:
            browser = driver.chromium.launch(executable_path=browser_path(), args=["--no-sandbox"])
            page = opened(browser)
            page.goto(server.address)
            page.get_by_text("The line ›").wait_for()
            taken, spent = time.perf_counter() - begin, processor(server)
            browser.close()
    finally:
        server.stop()
    return taken, spent


def opened(browser: Any) -> Any:
    page = browser.new_page(viewport={"width": 1280, "height": 900})
    page.set_default_timeout(WAIT)
    return page


def measure(name: str, file: str, repeats: int) -> None:
    server = start_server(file)
    try:
        with sync_playwright() as driver:
            browser = driver.chromium.launch(executable_path=browser_path(), args=["--no-sandbox"])
            page = opened(browser)
            page.goto(f"{server.address}?view=orders")
            page.wait_for_selector("[data-state=idle]")
            slide(page, repeats // 4 + 1)
            spent, taken = during(server, lambda: slide(page, repeats))
            report(f"{name}: number typed to updated orders view, all four pictures", taken, spent)
            page.goto(f"{server.address}?view=stability")
            page.wait_for_selector("[data-chart=chart]")
            page.wait_for_selector("[data-state=idle]")
            charts(page, repeats // 4 + 1)
            spent, taken = during(server, lambda: charts(page, repeats))
            coarse, full = zip(*taken, strict=True)
            report(f"{name}: number typed to updated 16 × 12 chart", list(coarse))
            report(f"{name}: number typed to updated 60 × 60 chart, all that the view computes", list(full), spent)
            spent, taken = during(server, lambda: clicks(page, repeats))
            report(f"{name}: click in the chart to the multipliers there", taken, spent)
            page.goto(f"{server.address}?view=stability&line={pack(laborious())}")
            report("a chart of minutes, Cancel pressed to the page saying so", cancels(page, max(3, repeats // 4)))
            browser.close()
    finally:
        server.stop()


def during(server: Any, act: Callable[[], list[Any]]) -> tuple[Spent, list[Any]]:
    """What was spent while something was done, and what that gave."""
    before = processor(server)
    found = act()
    after = processor(server)
    return (after[0] - before[0], after[1] - before[1]), found


def slide(page: Any, repeats: int) -> list[float]:
    """Seconds from a new value of the slider's number, a joint angle, to the finished view."""
    box = page.get_by_label("Value [deg]", exact=True)
    times = []
    for k in range(repeats):
        box.fill(f"{3 + 0.37 * (k % 17) + 0.01 * k:.2f}")
        times.append(timed(lambda: box.press("Enter"), lambda mark: finished(page, mark), done(page)))
    return times


def charts(page: Any, repeats: int) -> list[tuple[float, float]]:
    """Seconds from a new stiffness to the coarse chart and to the full one."""
    path = page.get_by_label("Parameter to move", exact=True)
    names = path.locator("option").all_inner_texts()
    stiffness = next(name for name in names if name.endswith(".stiffness"))
    if path.input_value() != stiffness:
        path.select_option(stiffness)
        page.get_by_label(re.compile(r"^Value \[.*N\*m/rad\]")).wait_for()
    box = page.get_by_label(re.compile(r"^Value \[.*N\*m/rad\]"))
    now, times = float(box.input_value()), []
    for k in range(repeats):
        count = int(page.locator("[data-count]").get_attribute("data-count"))
        box.fill(f"{now * (0.8 + 0.02 * (k % 19) + 0.0007 * k):.5g}")
        mark = done(page)
        begin = time.perf_counter()
        box.press("Enter")
        page.locator(f"[data-count='{count + 1}'], [data-count='{count + 2}']").wait_for()
        coarse = time.perf_counter() - begin
        page.wait_for_function(FULL, arg=count)  # a chart that comes at once has no coarse one before it
        times.append((coarse, time.perf_counter() - begin))
        finished(page, mark)
    return times


def clicks(page: Any, repeats: int) -> list[float]:
    """Seconds from a click to its table."""
    chart = page.locator(".bk-Canvas").first
    chart.scroll_into_view_if_needed()
    box, value = chart.bounding_box(), page.locator("td[data-value='speed']")
    times = []
    for k in range(repeats):
        before = value.inner_text()
        x, y = box["x"] + (0.2 + 0.027 * (k % 19)) * box["width"], box["y"] + 0.5 * box["height"]
        mark = done(page)
        page.wait_for_timeout(500)  # two clicks close together are a double one
        begin = time.perf_counter()
        page.mouse.click(x, y)
        value.filter(has_not_text=before).wait_for()
        times.append(time.perf_counter() - begin)
        finished(page, mark)
    return times


def cancels(page: Any, repeats: int) -> list[float]:
    """Seconds from the button to the page that is free again; a change of the angle begins anew."""
    times = []
    for k in range(repeats):
        page.wait_for_selector("[data-state=busy]")
        begin = time.perf_counter()
        page.get_by_role("button", name="Cancel").click()
        page.get_by_text("cancelled", exact=True).wait_for()
        times.append(time.perf_counter() - begin)
        box = page.get_by_label("Value [deg]", exact=True)
        box.fill(f"{10 + 0.5 * k}")
        box.press("Enter")
    return times


async def ends(repeats: int) -> list[float]:
    """Seconds until the process of a cancelled job has ended."""
    pool = Pool(asyncio.get_running_loop(), 1, 2)
    long = Job(starter("two-shaft"), Call("tn.simulate", (LINE,), {"turns": 1e6, "dense": False}), "nothing")
    short = Job(starter("two-shaft"), Call("tn.natural_frequencies", (LINE,)), "text")
    times = []
    try:
        for _ in range(repeats):
            await pool.run(short, pool)
            task = asyncio.ensure_future(pool.run(long, pool))
            await asyncio.sleep(0.5)
            (worker,) = pool.busy
            begin = time.perf_counter()
            task.cancel()
            while worker.process.poll() is None:
                await asyncio.sleep(0.005)
            times.append(time.perf_counter() - begin)
            while pool.busy:
                await asyncio.sleep(0.005)
    finally:
        pool.close()
    return times


def timed(act: Callable[[], None], wait: Callable[[int], None], mark: int) -> float:
    begin = time.perf_counter()
    act()
    wait(mark)
    return time.perf_counter() - begin


def done(page: Any) -> int:
    """How many computations the page has finished."""
    return int(page.locator("[data-state]").get_attribute("data-done") or 0)


def finished(page: Any, before: int) -> None:
    page.locator(f"[data-done='{before + 1}']").wait_for()


def report(what: str, seconds: list[float], spent: Spent | None = None) -> None:
    """One line; ``spent`` by all times together."""
    middle, late = np.percentile(seconds, [50, 95])
    load = f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores"
    print(f"{what}: median {1e3 * middle:.0f} ms, 95th percentile {1e3 * late:.0f} ms ({len(seconds)} times, {load})")
    if spent is not None:
        server, workers = (1e3 * one / len(seconds) for one in spent)
        both = server + workers
        print(f"    processor time each: server {server:.0f} ms, workers {workers:.0f} ms, both {both:.0f} ms")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
