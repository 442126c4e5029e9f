"""How many frames a second a line in motion gets, in a browser without a window that draws by software.

    PYTHONPATH=src:tests/app python benchmarks/frame_rate.py [SECONDS]

Needs playwright and Chromium. For lines of 10 and of 60 elements, at about 1000 × 500 pixels: frames a second as they
came, and the processor time of all of the browser's processes a frame, which says what an idle machine would
give: as many as fit into a second of one processor, at most the 60 of the screen. Beside each, for scale on a machine
that does other work too: as many plain cylinders, drawn one by one in bare WebGL on a page of its own.
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
PLAIN = """<!DOCTYPE html><canvas id=c width=972 height=480></canvas><script>
const COUNT = %d, SIDES = 28, points = []
const g = document.getElementById("c").getContext("webgl2", { antialias: true })
for (let k = 0; k < SIDES; k++) {
  const ring = [k, k + 1].map(j => [Math.cos(2 * Math.PI * j / SIDES), Math.sin(2 * Math.PI * j / SIDES)])
  const [[a, b], [c, d]] = ring
  for (const [x, y, z] of [[0, a, b], [1, a, b], [1, c, d], [0, a, b], [1, c, d], [0, c, d]])
    points.push(x, y, z, 0, y, z)
  for (const x of [0, 1]) for (const [y, z] of [[0, 0], [a, b], [c, d]]) points.push(x, y, z, 2 * x - 1, 0, 0)
}
function made(kind, text) {
  const one = g.createShader(kind)
  g.shaderSource(one, text); g.compileShader(one)
  return one
}
const program = g.createProgram()
g.attachShader(program, made(g.VERTEX_SHADER, `#version 300 es
uniform vec2 at; uniform float angle; in vec3 p; in vec3 n; out vec3 shade;
vec3 seen(vec3 v) { float c = cos(angle), s = sin(angle); v = vec3(v.x, c * v.y - s * v.z, s * v.y + c * v.z);
  return vec3(0.8 * v.x + 0.6 * v.z, v.y, 0.8 * v.z - 0.6 * v.x); }
void main() { shade = vec3(0.3 + 0.6 * max(dot(seen(n), vec3(-0.3, 0.6, 0.74)), 0.0));
  vec3 v = seen(p * vec3(0.1, 0.2, 0.2)); gl_Position = vec4(v.xy + at, v.z * 0.1, 1.0); }`))
g.attachShader(program, made(g.FRAGMENT_SHADER, `#version 300 es
precision mediump float; in vec3 shade; out vec4 c; void main() { c = vec4(shade, 1.0); }`))
g.linkProgram(program); g.useProgram(program)
g.bindBuffer(g.ARRAY_BUFFER, g.createBuffer()); g.bufferData(g.ARRAY_BUFFER, new Float32Array(points), g.STATIC_DRAW)
for (const [name, from] of [["p", 0], ["n", 12]]) {
  const at = g.getAttribLocation(program, name)
  g.enableVertexAttribArray(at); g.vertexAttribPointer(at, 3, g.FLOAT, false, 24, from)
}
g.enable(g.DEPTH_TEST)
const at = g.getUniformLocation(program, "at"), angle = g.getUniformLocation(program, "angle")
window.drawn = 0
requestAnimationFrame(function step(now) {
  g.clear(g.COLOR_BUFFER_BIT | g.DEPTH_BUFFER_BIT); g.uniform1f(angle, now / 500)
  for (let k = 0; k < COUNT; k++) {
    g.uniform2f(at, -0.95 + 1.9 * k / COUNT, 0); g.drawArrays(g.TRIANGLES, 0, points.length / 6)
  }
  window.drawn++; requestAnimationFrame(step)
})
</script>"""
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
            plain_frames, plain_spent, plain_taken = plain(driver, Path(folder), count, seconds)
            print(
                f"{count} elements: {frames / taken:.1f} frames/s over {taken:.1f} s at load {os.getloadavg()[0]:.1f}, "
                f"{1e3 * spent / frames:.1f} ms of processor time a frame, so {min(60.0, frames / spent):.0f} frames/s "
                f"of one processor (asked {asked}); resolution × {quality:.2g}\n"
                f"  {count} plain cylinders beside it: {plain_frames / plain_taken:.1f} frames/s, "
                f"{1e3 * plain_spent / plain_frames:.1f} ms a frame",
                flush=True,
            )


def plain(driver: Any, folder: Path, count: int, seconds: float) -> tuple[int, float, float]:
    """Frames, processor time and time gone by of cylinders alone, in a browser of their own."""
    path = folder / f"plain-{count}.html"
    path.write_text(PLAIN % count, encoding="utf-8")
    browser = driver.chromium.launch(executable_path=browser_path(), args=["--no-sandbox"])
    page = browser.new_page(viewport={"width": 1000, "height": 700})
    page.goto(path.as_uri())
    page.wait_for_function("() => window.drawn > 5")
    found = counted(page, seconds, page.evaluate("window.drawn"))
    browser.close()
    return found


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
    return counted(page, seconds, 0)


def counted(page: Any, seconds: float, already: int) -> tuple[int, float, float]:
    """The same of a page that counts what it draws."""
    before, begin = processor_time(), time.perf_counter()
    page.wait_for_timeout(1000 * seconds)
    return page.evaluate("window.drawn") - already, processor_time() - before, time.perf_counter() - begin


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
