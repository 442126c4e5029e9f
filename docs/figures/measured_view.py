"""Takes the picture of the application with a measured run and its reference run, for the page of the application.

PYTHONPATH=src python docs/figures/measured_view.py      # needs chromium and the extras app and dev
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image
from playwright.sync_api import Page, sync_playwright

import trunnion as tn

PICTURE = Path(__file__).parents[1] / "images" / "reference-run.png"
IDLE = "[data-state=idle]"
WAIT = 400_000
LINE = """\
format = 1
name = "one joint on a test bench"
[operation]
speed = "750 rpm"
speed_range = ["500 rpm", "900 rpm"]
[[element]]
type = "ConstantSpeed"
name = "input"
[[element]]
type = "HookeJoint"
name = "joint"
angle = "2 deg"
[[element]]
type = "Shaft"
name = "tube"
stiffness = "20 kN*m/rad"
damping = "25 N*m*s/rad"
[[element]]
type = "Disk"
name = "hub"
inertia = "2.5 kg*m^2"
"""
CHANNELS = "".join(
    f'[[channel]]\ncolumn = {k}\nname = "{at}"\nkind = "edges"\npulses_per_turn = 30\nat = "{at}"\n'
    for k, at in enumerate(("input", "hub"), start=1)
)


def recorded(line: tn.Driveline, speeds: float | tuple[float, float], seed: int, path: Path) -> Path:
    """Edges of two wheels whose teeth are off by 2 %, as a table."""
    wheels = {"input": 30, "hub": 30}
    run = tn.measure(line, speeds, 6.0, wheels, pitch_error=0.02, wheels=7, seed=seed, jitter=1e-6)
    rows = min(len(one.times) for one in run.pulses)
    times = zip(*(one.times[:rows] for one in run.pulses), strict=True)
    path.write_text("input,hub\n" + "\n".join(f"{a:.9f},{b:.9f}" for a, b in times))
    return path


def drop(page: Page, *paths: Path) -> None:
    """Give files to the view and wait for what is computed of them."""
    page.get_by_label("Measured file").set_input_files(paths)
    page.wait_for_timeout(2000)
    page.wait_for_selector(IDLE, timeout=WAIT)


def take(address: str, folder: Path) -> None:
    """Drop a still run, take it as the reference, drop the run-up, and look."""
    line = tn.loads(LINE)
    still = recorded(line.replace("joint", angle=0.0), 80.0, 2, folder / "still.csv")
    run = recorded(line, (55.0, 92.0), 1, folder / "run-up.csv")
    channels = folder / "still.channels.toml"
    channels.write_text(CHANNELS)
    with sync_playwright() as driver:
        browser = driver.chromium.launch(args=["--no-sandbox"], executable_path="/usr/bin/chromium")
        page = browser.new_page(viewport={"width": 1280, "height": 960})
        page.goto(address + "?view=measured")
        page.wait_for_selector(IDLE, timeout=WAIT)
        drop(page, still, channels)
        page.get_by_role("button", name="Take it as the reference run").click()
        page.wait_for_timeout(1000)
        page.wait_for_selector(IDLE, timeout=WAIT)
        drop(page, run)
        orders = page.get_by_label("Orders", exact=True)
        orders.fill("1,2")
        orders.press("Enter")
        page.wait_for_timeout(2000)
        page.wait_for_selector(IDLE, timeout=WAIT)
        page.get_by_label("Channel", exact=True).select_option("hub")
        page.wait_for_timeout(2000)
        page.wait_for_selector(IDLE, timeout=WAIT)
        shot = folder / "shot.png"
        page.screenshot(path=shot)
        browser.close()
        Image.open(shot).convert("RGB").quantize(128).save(PICTURE, optimize=True)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "bench.toml").write_text(LINE)
        command = [sys.executable, "-u", "-m", "trunnion", "app", "--no-browser", str(folder / "bench.toml")]
        server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        try:
            assert server.stdout
            take(next(word for word in server.stdout.readline().split() if word.startswith("http")), folder)
        finally:
            server.terminate()
