"""How many frames a second a line in motion gets, in a browser without a window that draws by software.

    PYTHONPATH=src:tests/app python benchmarks/frame_rate.py [SECONDS]

Needs playwright and Chromium. For lines of 10 and of 60 elements, at about 1000 × 500 pixels: frames a second as they
came, and the processor time of all of the browser's processes a frame, which says what an idle machine would
give: as many as fit into a second of one processor, at most the 60 of the screen.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from playwright.sync_api import sync_playwright
from served import browser_path

import trunnion as tn

ASKED = {10: 40, 60: 25}
"""Frames a second asked for by number of elements."""
PLAYER = "document.getElementById('trunnion-player').player"
TICK = os.sysconf("SC_CLK_TCK")


def main() -> None:
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 8.0
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as driver:
        for count, asked in ASKED.items():
            path = Path(folder) / f"{count}.html"
            tn.animate(line(count), "turning", speed=60.0).save(path)
            browser = driver.chromium.launch(executable_path=browser_path(), args=["--no-sandbox"])
            page = browser.new_page(viewport={"width": 1000, "height": 700})
            page.goto(path.as_uri())
            page.wait_for_function(f"() => {PLAYER}?.wide > 0")
            page.wait_for_timeout(2000)  # until the resolution has settled
            frames, spent, taken = measured(page, seconds)
            quality = page.evaluate(f"{PLAYER}.quality")
            browser.close()
            print(
                f"{count} elements: {frames / taken:.1f} frames/s over {taken:.1f} s at load {os.getloadavg()[0]:.1f}, "
                f"{1e3 * spent / frames:.1f} ms of processor time a frame, so {min(60.0, frames / spent):.0f} frames/s "
                f"of one processor (asked {asked}); resolution × {quality:.2g}",
                flush=True,
            )


def line(count: int) -> tn.Driveline:
    """Drive, then shafts, disks and joints in turn."""
    kinds = (
        lambda: tn.Shaft(stiffness=2e4, damping=1.0),
        lambda: tn.Disk(inertia=0.2),
        lambda: tn.HookeJoint(angle="8 deg"),
        lambda: tn.Shaft(stiffness=1e4, damping=1.0),
        lambda: tn.Disk(inertia=0.4),
    )
    return tn.Driveline(
        [tn.ConstantSpeed(), *(kinds[k % len(kinds)]() for k in range(count - 2)), tn.Disk(inertia=0.3)]
    )


def measured(page: Any, seconds: float) -> tuple[int, float, float]:
    """Frames drawn, processor time of the browser [s], and time gone by [s]."""
    page.evaluate(
        f"""() => {{ window.drawn = 0; const p = {PLAYER}, own = p.draw.bind(p)
        p.draw = (...given) => {{ window.drawn++; return own(...given) }}; if (!p.playing) p.toggle() }}"""
    )
    before, begin = processor_time(), time.perf_counter()
    page.wait_for_timeout(1000 * seconds)
    return page.evaluate("window.drawn"), processor_time() - before, time.perf_counter() - begin


def processor_time() -> float:
    """Of all processes below this one [s], from /proc."""
    parents: dict[int, int] = {}
    spent: dict[int, float] = {}
    for entry in Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            fields = (entry / "stat").read_text().rpartition(")")[2].split()
        except OSError:
            continue  # it has ended meanwhile
        parents[int(entry.name)] = int(fields[1])
        spent[int(entry.name)] = (int(fields[11]) + int(fields[12])) / TICK
    own, total = os.getpid(), 0.0
    for number, used in spent.items():
        above = parents[number]
        while above not in (0, 1, own):
            above = parents.get(above, 0)
        total += used if above == own else 0.0
    return total


if __name__ == "__main__":
    main()
