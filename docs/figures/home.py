"""Draws the pictures of the home page and of README: a line that turns, and the verdict of a report.

PYTHONPATH=src python docs/figures/home.py [turning] [verdict]      # the verdict needs chromium and the extra dev
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

import trunnion as tn
from trunnion.pictures.looks import COLOURS, FAINT, INK

IMAGES = Path(__file__).parents[1] / "images"
BETA = np.radians(30)
FRAMES = 40
LENGTHS = (1.5, 2.6, 1.5)
ARM, NECK = 0.3, 0.42
"""Half a cross, and from its middle to where a fork begins."""


def line(fork_offset: float) -> tn.Driveline:
    """Two joints of 30° in one plane."""
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.HookeJoint(angle=BETA),
            tn.Shaft(stiffness=1e9, fork_offset=fork_offset),
            tn.Disk(inertia=0.01),
            tn.HookeJoint(angle=BETA),
            tn.Disk(inertia=0.01),
        ]
    )


def axes_of_shafts() -> list[np.ndarray]:
    """A Z arrangement: input and output parallel."""
    along = np.array([1.0, 0.0, 0.0])
    return [along, np.array([np.cos(BETA), 0.0, -np.sin(BETA)]), along]


def around(axis: np.ndarray, vector: np.ndarray, angle: float) -> np.ndarray:
    """Rodrigues' rotation."""
    return (
        vector * np.cos(angle) + np.cross(axis, vector) * np.sin(angle) + axis * (axis @ vector) * (1 - np.cos(angle))
    )


def forks(chi: float, fork_offset: float) -> list[tuple[np.ndarray, np.ndarray]]:
    """Directions of the fork arms in front of and behind each cross; the first is ``chi`` from the joint plane."""
    e = axes_of_shafts()
    normal = np.array([0.0, 1.0, 0.0])
    pairs = []
    arm = around(e[0], np.cross(normal, e[0]), chi)
    for rear in e[1:]:
        behind = np.cross(rear, arm)
        behind /= np.linalg.norm(behind)
        pairs.append((arm, behind))
        arm = around(rear, behind, fork_offset)
    return pairs


def project(points: np.ndarray) -> np.ndarray:
    """Seen from the side and a little from above and behind: (…, 3) to x, y and depth."""
    turn, rise = np.radians(-24), np.radians(20)
    x, y, z = np.moveaxis(np.asarray(points, dtype=float), -1, 0)
    x, y = x * np.cos(turn) - y * np.sin(turn), x * np.sin(turn) + y * np.cos(turn)
    return np.stack([x, z * np.cos(rise) + y * np.sin(rise), y * np.cos(rise) - z * np.sin(rise)], axis=-1)


def draw_line(axes, chi: float, fork_offset: float) -> None:
    """Three shafts, their forks and crosses at one instant; what is nearer covers what is farther."""
    e = axes_of_shafts()
    starts = [np.zeros(3)]
    for axis, length in zip(e, LENGTHS, strict=True):
        starts.append(starts[-1] + axis * length)
    centres = starts[1:3]
    pairs = forks(chi, fork_offset)
    strokes: list[tuple[float, np.ndarray, dict]] = []

    def stroke(*points: np.ndarray, **look) -> None:
        seen = project(np.array(points))
        strokes.append((float(seen[:, 2].mean()), seen, look))

    for k, axis in enumerate(e):
        first = starts[k] + (axis * NECK if k else 0)
        last = starts[k + 1] - (axis * NECK if k < 2 else 0)
        stroke(first, last, color=INK, lw=13, solid_capstyle="butt")
        stroke(first, last, color=COLOURS[k], lw=10.5, solid_capstyle="butt")
        arm = pairs[k][0] if k < 2 else pairs[1][1]
        toward = project(np.array([arm, np.zeros(3)]))
        for side in (1, -1):  # a stripe along the fork, where it faces us
            if side * (toward[0, 2] - toward[1, 2]) < 0:
                shift = side * arm * 0.085
                stroke(first + shift, last + shift, color="white", lw=2.2, solid_capstyle="butt")
                strokes[-1] = (strokes[-1][0] - 5, *strokes[-1][1:])
    for centre, (front, rear), before, after in zip(centres, pairs, e, e[1:], strict=False):
        for direction, axis in ((front, -before), (rear, after)):
            for side in (1, -1):
                tip = centre + side * ARM * direction
                root = tip + NECK * axis
                stroke(root - side * ARM * direction, root, tip, color=INK, lw=5.5, solid_joinstyle="round")
            stroke(centre - ARM * direction, centre + ARM * direction, color="#d0602f", lw=4, solid_capstyle="round")
    for _, seen, look in sorted(strokes, key=lambda one: -one[0]):
        axes.plot(seen[:, 0], seen[:, 1], **look)
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set_xlim(-0.1, 5.3)
    axes.set_ylim(-2.4, 0.5)


def frame(step: int, traces: list[tuple[np.ndarray, np.ndarray]]) -> Image.Image:
    """One picture of both lines, with the output speed so far."""
    figure = Figure(figsize=(7.6, 4.4), dpi=100)
    FigureCanvasAgg(figure)
    chi = 2 * np.pi * step / FRAMES
    for row, (offset, title) in enumerate(
        ((0.0, "Forks in line: the joints cancel"), (np.pi / 2, "Forks a quarter turn off: they add up"))
    ):
        sketch = figure.add_axes((0.0, 0.49 - 0.5 * row, 0.62, 0.44))
        draw_line(sketch, chi, offset)
        figure.text(0.02, 0.95 - 0.5 * row, title, color=INK, fontsize=12, weight="bold")
        turn, ratio = traces[row]
        plot = figure.add_axes((0.68, 0.62 - 0.5 * row, 0.29, 0.26))
        plot.plot(np.degrees(turn), ratio, color=COLOURS[1], lw=1.8)
        now = np.interp(chi, turn, ratio)
        plot.plot([np.degrees(chi)], [now], "o", color="#d0602f", ms=7)
        plot.set(xlim=(0, 360), ylim=(0.65, 1.45), xticks=(0, 180, 360), yticks=(0.8, 1.0, 1.2, 1.4))
        plot.tick_params(labelsize=9, colors=INK)
        plot.set_title("output speed / input speed", fontsize=9.5, color=INK)
        plot.set_xlabel("input rotation [deg]", fontsize=9, color=INK, labelpad=1)
        plot.grid(color=FAINT, alpha=0.3, lw=0.6)
    figure.canvas.draw()
    return Image.fromarray(np.asarray(figure.canvas.buffer_rgba())[..., :3].copy())


def trace(fork_offset: float) -> tuple[np.ndarray, np.ndarray]:
    """Input rotation [rad] and output over input speed, as kinetostatics gives them."""
    turn = tn.kinetostatics(line(fork_offset), speed=1.0)
    rotation = np.linspace(0, 2 * np.pi, len(turn.output_speed), endpoint=False)
    closed = np.append(turn.output_speed, turn.output_speed[0])
    return np.append(rotation, 2 * np.pi), closed


def turning() -> None:
    """One turn, again and again."""
    traces = [trace(0.0), trace(np.pi / 2)]
    frames = [frame(step, traces) for step in range(FRAMES)]
    palette = frames[FRAMES // 3].quantize(64)
    small = [one.quantize(palette=palette, dither=Image.Dither.NONE) for one in frames]
    small[0].save(IMAGES / "turning.gif", save_all=True, append_images=small[1:], duration=70, loop=0, optimize=True)


def verdict() -> None:
    """The top of the report on the power take-off shaft, as a browser shows it."""
    from playwright.sync_api import sync_playwright

    root = Path(__file__).parents[2]
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as player:
        path = Path(folder) / "report.html"
        tn.report(tn.load(root / "examples/pto-shaft.toml")).save(path)
        browser = player.chromium.launch(executable_path="/usr/bin/chromium", args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 900, "height": 620})
        page.goto(path.as_uri())
        page.wait_for_timeout(800)
        page.screenshot(path=folder + "/shot.png")
        browser.close()
        Image.open(folder + "/shot.png").convert("RGB").quantize(128).save(IMAGES / "verdict.png", optimize=True)


if __name__ == "__main__":
    for name in sys.argv[1:] or ("turning", "verdict"):
        {"turning": turning, "verdict": verdict}[name]()
