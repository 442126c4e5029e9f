"""Numbers that the views show, against the public functions; long computations, their end, two sessions."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from served import Look

import trunnion as tn
from trunnion.app.address import pack
from trunnion.driveline.starter import starter

STABILITY = "?view=stability&stability.across=20&stability.up=16"


def line() -> tn.Driveline:
    return tn.loads(starter("two-shaft"))


def value(look: Look, name: str) -> str:
    return str(look.page.locator(f"td[data-value='{name}']").inner_text())


def number(text: str) -> float:
    return float(re.split(r"[±%(]", text)[0])


def agrees(look: Look, x: float, y: float) -> None:
    """What the page shows of the point x rpm, y deg is what ``stability`` gives."""
    look.page.locator("td[data-value='speed']", has_text=re.compile(rf"^{re.escape(f'{x:.6g}')} rpm$")).wait_for()
    there = tn.stability(line().replace("HookeJoint 1", angle=f"{y!r} deg"), speed=tn.rpm(x))
    assert number(value(look, "spectral radius")) == pytest.approx(there.spectral_radius, abs=1e-8)
    assert value(look, "verdict") == str(there.verdict)
    shown = sorted(float(v) for v in value(look, "moduli of the multipliers").split(","))
    assert shown == pytest.approx(sorted(np.abs(there.multipliers)), abs=1e-8)


@pytest.mark.slow
def test_a_typed_point_shows_its_multipliers(look: Look) -> None:
    look.at(STABILITY)
    look.type("Look at HookeJoint 1.angle [deg]", "19.5")
    look.type("Look at input speed [rpm]", "707")
    agrees(look, 707.0, 19.5)


UNNAMED = """() => {
  const found = []
  const walk = (root) => {
    for (const node of root.querySelectorAll('*')) {
      if (node.shadowRoot) walk(node.shadowRoot)
      if (!node.matches('input, select, button, textarea')) continue
      const label = (node.labels && node.labels.length) || node.getAttribute('aria-label') || node.title ||
        node.textContent.trim() || (root.host && root.querySelector('label') )
      if (!label) found.push(node.outerHTML.slice(0, 200))
    }
  }
  walk(document)
  return found
}"""
"""Controls without a label."""


def saved(look: Look, name: str, folder: Path) -> Path:
    """Follow a link of the list of files."""
    with look.page.expect_download() as waiting:
        look.page.locator(f"a[href$='{name}']").click()
    path = folder / name.rpartition("/")[2]
    waiting.value.save_as(path)
    return path


PIXELS = """() => Bokeh.documents.flatMap(d => [...d._all_models.values()])
  .filter(m => m.type === 'ColumnDataSource' && m.data.dw && m.data.dw.length).map(m => m.data.dw[0])[0]"""
"""How wide the box is that the pixels of the chart fill [rpm]."""


def test_a_click_shows_the_multipliers_there_and_computes_the_point_alone_and_a_zoom_no_chart(look: Look) -> None:
    """The chart stays as it is, and no coarse one comes before it; moved aside it has its pixels in the rest."""
    look.at(STABILITY)
    look.page.locator("[data-chart='chart']").wait_for()
    said = "e => e.dataset.chart + e.dataset.count"
    before, address = look.page.locator("[data-count]").evaluate(said), look.page.url
    box = look.page.locator(".bk-Figure, .bk-Figure-wrapper, .bk-Canvas").first.bounding_box()
    look.page.mouse.click(box["x"] + 0.4 * box["width"], box["y"] + 0.4 * box["height"])
    look.page.wait_for_function("url => document.location.href !== url", arg=address)
    at = dict(re.findall(r"stability\.(at_[xy])=([^&]+)", look.page.url))
    agrees(look, float(at["at_x"]), float(at["at_y"]))
    look.settled()
    whole = look.page.evaluate(PIXELS)
    box = look.page.locator(".bk-Canvas").first.bounding_box()
    look.page.mouse.move(box["x"] + 0.6 * box["width"], box["y"] + 0.5 * box["height"])
    look.page.mouse.down()
    look.page.mouse.move(box["x"] + 0.4 * box["width"], box["y"] + 0.5 * box["height"], steps=4)
    look.page.mouse.up()
    look.page.wait_for_function(f"whole => ({PIXELS})() < 0.9 * whole", arg=whole)
    assert look.page.locator("[data-count]").evaluate(said) == before


MODE = """() => Bokeh.documents.flatMap(d => [...d._all_models.values()])
  .filter(m => m.type === 'ColumnDataSource' && /^mode-.*-marks$/.test(m.name)).map(m => Array.from(m.data.x))[0]"""
"""Rotations that the picture of a mode shows now."""


def test_a_mode_moves_and_stops_as_it_was(look: Look) -> None:
    look.at("?view=orders")
    still = look.page.evaluate(MODE)
    assert max(map(abs, still)) == pytest.approx(1)
    button = look.page.get_by_role("button", name="Move the mode")
    button.click()
    look.page.wait_for_function(f"still => ({MODE})()[0] < 0.5 * still", arg=still[0])
    moved = look.page.evaluate(MODE)
    assert moved[0] / still[0] == pytest.approx(moved[1] / still[1])
    button.click()
    look.page.wait_for_function(f"still => ({MODE})()[0] === still", arg=still[0])
    assert look.page.evaluate(MODE) == still


@pytest.mark.slow
def test_exported_python_gives_the_numbers_on_screen(look: Look, tmp_path: Path) -> None:
    look.at(STABILITY + "&stability.at_x=707.0&stability.at_y=19.5&stability.look=True")
    program = saved(look, "stability/view.py", tmp_path).read_text(encoding="utf-8")
    there: dict[str, Any] = {}
    exec(program, there)
    assert number(value(look, "spectral radius")) == pytest.approx(there["point"].spectral_radius, abs=1e-9)
    chart = tn.load_chart(saved(look, "stability/chart.nc", tmp_path))
    assert np.abs(chart.spectral_radius - there["chart"].spectral_radius).max() < 1e-10
    text = saved(look, "stability/chart.csv", tmp_path).read_text(encoding="utf-8")
    assert len(text.splitlines()) == 1 + 20 * 16
    assert saved(look, "stability/chart.png", tmp_path).read_bytes().startswith(b"\x89PNG")
    assert b"<svg" in saved(look, "stability/chart.svg", tmp_path).read_bytes()
    assert tn.load(saved(look, "driveline/driveline.toml".replace("driveline/", ""), tmp_path)) == line()


def laborious() -> str:
    """A description whose charts take minutes: stiff, with many joints and hardly any damping."""
    elements: list[object] = [tn.ConstantSpeed()]
    for i in range(8):
        elements += [tn.HookeJoint(angle=0.3)] * (i > 0)
        elements += [tn.Shaft(stiffness=1e4 * 4**i, damping=0.01), tn.Disk(inertia=0.1 + 0.03 * i)]
    operation = tn.Operation(speed="600 rpm", speed_range=["300 rpm", "900 rpm"], angle_range=["0 deg", "30 deg"])
    return tn.dumps(tn.Driveline(elements, operation=operation))


@pytest.mark.slow
def test_a_long_run_is_cancelled_while_another_session_answers(look: Look, browser: Any) -> None:
    look.page.goto(look.server.address + "?view=stability&line=" + pack(laborious()))
    look.page.locator("[data-state=busy]").wait_for()
    other = browser.new_context().new_page()
    other.set_default_timeout(180_000)
    other.goto(look.server.address + "?view=verdict")
    other.locator("[data-verdict]").wait_for()
    assert look.page.locator("[data-state=busy]").count() == 1
    other.context.close()
    look.page.get_by_role("button", name="Cancel").click()
    look.page.get_by_text("cancelled", exact=True).wait_for()
    assert look.page.get_by_role("button", name="Cancel").is_disabled()
    look.view("Joints")
    look.settled()
    assert look.page.locator("[role=alert]", has_text="process ended").count() == 0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("what", "begins"),
    [
        ("stable windows of a parameter", "Every speed from 300 rpm to 3000 rpm"),
        ("tolerances", "stable at 1500 rpm with"),
    ],
)
def test_windows_and_tolerances_are_among_the_limits(look: Look, what: str, begins: str) -> None:
    """In the words of the public functions."""
    look.at("?view=limits&limits.what=" + what.replace(" ", "+"))
    look.page.locator("pre", has_text=begins).wait_for()
    if what != "tolerances":
        expected = str(tn.stable_windows(line(), "HookeJoint 1.angle", 0.0, tn.deg(45), (tn.rpm(300), tn.rpm(3000))))
        assert look.page.locator("pre", has_text=begins).inner_text().split() == expected.split()
    assert look.page.locator("[role=alert]", has_text=re.compile("unexpected|error")).count() == 0


def test_a_question_mark_within_the_address_is_read(look: Look) -> None:
    """It is allowed in a query, and some programs leave it as it is."""
    look.at("?view=motion&motion.what=what?&stability.x=?")
    look.page.locator("pre", has_text="periodic motion at 1500 rpm").wait_for()
    assert look.page.locator("[role=alert]", has_text=re.compile("unexpected|error")).count() == 0


@pytest.mark.parametrize(
    ("what", "begins"),
    [("section", "Poincaré map of"), pytest.param("run-up", "run from 300 rpm", marks=pytest.mark.slow)],
)
def test_a_motion_shows_its_own_controls_and_words(look: Look, what: str, begins: str) -> None:
    look.at(f"?view=motion&motion.what={what}&motion.returns=20&motion.rate=400")
    look.page.locator("pre", has_text=begins).first.wait_for()
    assert look.page.get_by_label("Acceleration [rad/s²]", exact=True).is_visible() == (what == "run-up")
    assert look.page.get_by_label("Points of the map", exact=True).is_visible() == (what == "section")
    assert look.page.locator("[role=alert]", has_text=re.compile("unexpected|error")).count() == 0
    assert look.page.evaluate(UNNAMED) == []


EQUATIONS = "?view=motion&motion.of={}&motion.returns=20&motion.what={}"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("query", "public"),
    [
        (EQUATIONS.format("line", "exponents"), lambda: tn.lyapunov_spectrum(line())),
        (EQUATIONS.format("line", "chaos"), lambda: tn.certify_chaos(line(), sweep=False)),
        (EQUATIONS.format("double-tripod", "section"), lambda: tn.poincare_map(tripod(), 20)),
        (EQUATIONS.format("double-tripod", "exponents"), lambda: tn.lyapunov_spectrum(tripod())),
        (EQUATIONS.format("gear-rattle", "chaos"), lambda: tn.certify_chaos(gears(), sweep=False)),
    ],
)
def test_maps_exponents_and_verdicts_read_as_the_public_functions_print(look: Look, query: str, public: Any) -> None:
    """Intervals and reasons among them, beside the picture of the result."""
    look.at(query)
    result = public()
    first, *rest = str(result).splitlines()
    shown = look.page.locator("pre", has_text=first)
    shown.wait_for()
    assert shown.inner_text().split() == str(result).split()
    assert len(rest) > 2
    assert look.page.locator(".bk-Canvas").first.bounding_box()["width"] > 200
    speed = look.page.get_by_label("Speed [rpm]", exact=True)
    assert speed.is_visible() == ("=line&" in query)
    assert look.page.locator("[role=alert]", has_text=re.compile("unexpected|error")).count() == 0


def tripod() -> tn.System:
    return tn.catalogue("double-tripod").system("input")


def gears() -> tn.System:
    return tn.catalogue("gear-rattle").as_system()


@pytest.mark.slow
def test_a_gear_pair_that_rattles_by_every_method(look: Look) -> None:
    """Each method says what it found on one picture; the sweep in the words of the public function."""
    text = tn.dumps(rattling())
    look.at("?view=motion&motion.what=rattle&motion.points=3&line=" + pack(text))
    for title in ("sweep up", "sweep down", "response: exact", "response: shooting", "response: harmonic balance"):
        look.page.locator("pre", has_text=re.compile("^" + re.escape(title))).wait_for()
    shown = look.page.locator("pre", has_text=re.compile("^sweep up")).inner_text()
    swept = tn.sweep(tn.loads(text), np.linspace(tn.rpm(1450), tn.rpm(1550), 3))
    assert shown.split() == f"sweep up {swept}".split()
    assert look.page.locator("[role=alert]", has_text=re.compile("unexpected|error")).count() == 0


def rattling() -> tn.Driveline:
    """A gear pair that crosses its backlash, over a narrow range of speeds."""
    mesh = tn.GearPair(
        name="gears", teeth_in=25, teeth_out=40, module=0.003, mesh_stiffness=2e6, mesh_damping=300.0, backlash=2e-4
    )
    pinion = tn.Disk(name="pinion", inertia=0.01, excitation=[{"order": 2, "amplitude": 60.0}])
    shaft = tn.Shaft(name="input shaft", stiffness=2000.0, damping=4.0)
    operation = tn.Operation(speed="1500 rpm", speed_range=["1450 rpm", "1550 rpm"])
    wheel = tn.Disk(name="wheel", inertia=0.02, load_torque=10.0)
    return tn.Driveline([tn.ConstantSpeed(), shaft, pinion, mesh, wheel], operation=operation)
