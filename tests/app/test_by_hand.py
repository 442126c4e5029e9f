"""What a user does on every view: save files, move a number, send the address to somebody, turn forks."""

from __future__ import annotations

import csv
import re
import tomllib
from io import BytesIO
from typing import Any

import pytest
from served import WAIT, Look
from test_views import UNNAMED, rattling

import trunnion as tn
from trunnion.app.address import pack, unpack
from trunnion.driveline.starter import starter

QUICK = {
    "driveline": "",
    "parts": "",
    "verdict": "",
    "stability": "stability.across=8&stability.up=6&stability.at_x=707.0&stability.at_y=19.5&stability.look=True",
    "limits": "limits.what=errors+of+assembly&limits.error=2.0",
    "motion": "motion.speed=900.0",
}
"""Settings of a view that differ from its own, and compute quickly."""
LONGER = {
    "orders": ("orders", "orders.speed=1234.0&orders.spring=Shaft+2&orders.mode=2"),
    "joints": ("joints", "joints.torque=250.0&joints.turn=40.0&joints.side=5.0&joints.top=7.0"),
    "stable limit": ("limits", "limits.speeds=3&limits.high=20.0"),
    "windows": ("limits", "limits.what=stable+windows+of+a+parameter&limits.high=20.0"),
    "tolerances": ("limits", "limits.what=tolerances&limits.tolerance=4.0"),
    "best": ("limits", "limits.what=best+value+of+a+parameter&limits.aim=irregularity"),
    "run-up": ("motion", "motion.what=run-up&motion.rate=400.0"),
    "map": ("motion", "motion.what=section&motion.returns=20"),
    "rattle": ("motion", "motion.what=rattle&motion.points=3&line=" + pack(tn.dumps(rattling()))),
}
"""The other views, and the other questions of a view."""
CASES = [
    pytest.param(*case, id=name, marks=pytest.mark.slow)
    for name, case in [*((view, (view, settings)) for view, settings in QUICK.items()), *LONGER.items()]
]

SHOWN = """() => {
  const plain = v => ArrayBuffer.isView(v) ? Array.from(v) : v
  const drawn = Bokeh.documents.flatMap(d => [...d._all_models.values()])
    .filter(m => m.type === 'ColumnDataSource')
    .map(m => JSON.stringify(Object.entries(m.data).map(([k, v]) => [k, Array.from(v, plain)])))
  const values = [], texts = []
  const walk = (root) => {
    for (const node of root.querySelectorAll('*')) {
      if (node.shadowRoot) walk(node.shadowRoot)
      if (node.matches('input, select')) values.push(node.value)
      if (node.matches('pre, td')) texts.push(node.innerText)
    }
  }
  walk(document)
  return {drawn: drawn.sort(), values, texts}
}"""
"""Everything drawn, typed and tabulated on the page."""
TOOK = re.compile(r", [\d.e+-]+ s$", re.MULTILINE)
"""How long a computation took, which is another time each time."""


def address(view: str, settings: str) -> str:
    return f"?view={view}&{settings}".rstrip("&")


def no_alarm(look: Look) -> None:
    assert look.page.locator("[role=alert]", has_text=re.compile("unexpected|error|refused")).count() == 0
    assert look.page.get_by_text("not computed", exact=True).count() == 0
    assert look.page.evaluate(UNNAMED) == []


def fits(ending: str, body: bytes) -> bool:
    """Whether a file is what its ending says, and holds something."""
    match ending:
        case "png":
            return body.startswith(b"\x89PNG") and len(body) > 5000
        case "svg":
            return b"<svg" in body[:2000] and b"<path" in body
        case "csv":
            head, *rows = list(csv.reader(body.decode().splitlines()))
            return 0 < len(rows) < 20_000 and all(len(row) == len(head) > 1 for row in rows)
        case "nc":
            import h5py

            with h5py.File(BytesIO(body)) as held:
                return len(held) > 0
        case "toml":
            return bool(tn.loads(body.decode()))
        case "py":
            compile(body, "view.py", "exec")
            return b"import trunnion as tn" in body
    return False


@pytest.mark.parametrize(("view", "settings"), CASES)
def test_files_of_a_view_a_number_that_moves_its_address_and_undo(
    look: Look, browser: Any, view: str, settings: str
) -> None:
    """All on one page, since opening one takes longest: a server, a worker and a browser are asked for each."""
    look.at(address(view, settings))
    no_alarm(look)
    assert look.page.get_by_text("Save", exact=True).count() == 1
    every_file_is_what_its_name_says(look)
    move_a_number(look, view)
    an_address_restores_it_in_a_fresh_browser(look, browser, settings)
    undo_takes_it_back(look, settings)


def every_file_is_what_its_name_says(look: Look) -> None:
    found = look.page.locator(".files a, ul a[download]").evaluate_all("links => links.map(l => l.href)")
    endings = {href.rpartition(".")[2] for href in found}
    assert {"toml", "py", "html"} <= endings
    for href in found:
        ending = href.rpartition(".")[2]
        if ending == "html":
            continue  # the report takes long and has a test of its own
        answer = look.page.request.get(href, timeout=WAIT)
        assert answer.status == 200, (href, answer.text()[:300])
        assert fits(ending, answer.body()), href


def move_a_number(look: Look, view: str) -> None:
    """The view follows."""
    if view == "stability":  # whose point keeps its angle, an axis of the chart
        choose(look, "Shaft 1.stiffness", "kN*m/rad")
    before = look.page.evaluate(SHOWN)
    field = look.page.get_by_label(re.compile(r"^Value \["), exact=False)
    was = float(field.input_value())
    field.fill(f"{was * 0.9:.6g}")
    field.press("Enter")
    look.page.wait_for_function("was => document.location.href !== was", arg=look.page.url, timeout=WAIT)
    look.settled_anew()
    after, kinds = look.page.evaluate(SHOWN), ("values",) if view == "driveline" else ("drawn", "texts")
    assert any(after[kind] != before[kind] for kind in kinds)
    no_alarm(look)
    if view == "stability":  # and the address no longer names another number
        choose(look, "HookeJoint 1.angle", "deg")
        look.page.wait_for_function("() => !document.location.href.includes('move=')", timeout=WAIT)


def choose(look: Look, parameter: str, unit: str) -> None:
    """Which number is moved."""
    look.page.get_by_label("Parameter to move", exact=True).select_option(parameter)
    look.page.get_by_label(f"Value [{unit}]", exact=True).wait_for()


def an_address_restores_it_in_a_fresh_browser(look: Look, browser: Any, settings: str) -> None:
    """Its settings, the line with a number changed, and the same pictures."""
    query = look.page.url.removeprefix(look.server.address)
    for setting in settings.split("&"):
        assert not setting or setting.startswith("line=") or setting.replace("=40&", "") in query, setting
    context = browser.new_context(viewport={"width": 1280, "height": 900})
    other = Look(context.new_page(), look.server)
    other.page.set_default_timeout(WAIT)
    other.at(query)
    first, second = look.page.evaluate(SHOWN), other.page.evaluate(SHOWN)
    context.close()
    assert second["values"] == first["values"]
    assert [TOOK.sub("", one) for one in second["texts"]] == [TOOK.sub("", one) for one in first["texts"]]
    assert second["drawn"] == first["drawn"]


def undo_takes_it_back(look: Look, settings: str) -> None:
    moved = unpack(dict(re.findall(r"[?&](\w+)=([^&]+)", look.page.url))["line"])
    look.view("Driveline")
    look.page.get_by_role("button", name="Undo").click()
    look.page.wait_for_function("was => !document.location.href.includes(was)", arg=pack(moved), timeout=WAIT)
    back = unpack(dict(re.findall(r"[?&](\w+)=([^&]+)", look.page.url))["line"])
    assert tn.loads(back) == (rattling() if "line=" in settings else tn.loads(starter("two-shaft")))
    assert tomllib.loads(moved) != tomllib.loads(back)


@pytest.mark.slow
def test_forks_are_turned_by_a_slider_and_angles_of_two_views_are_combined(look: Look) -> None:
    look.at("?view=joints")
    nonuniform = look.page.locator("td[data-value=irregularity]").inner_text()
    look.type("Angle in side view [deg]", "6")
    look.type("Angle in top view [deg]", "8")
    bend, plane = tn.combined_angle(tn.deg(6), tn.deg(8))
    look.page.get_by_text(f"compound angle {bend / tn.deg(1):.5g}°, plane {plane / tn.deg(1):.5g}°").wait_for()
    look.page.get_by_role("button", name="Use this angle").click()
    look.page.wait_for_function("was => !document.location.href.includes(was)", arg=pack(starter("two-shaft")))
    look.settled_anew()
    other = tn.loads(starter("two-shaft")).replace("HookeJoint 1", angle=bend)
    shown = look.page.locator("td[data-value=irregularity]")
    assert shown.inner_text() != nonuniform
    assert float(shown.inner_text()) == pytest.approx(tn.kinetostatics(other).irregularity, rel=1e-5)
    before = look.page.evaluate(SHOWN)["drawn"]
    handle = look.page.locator(".bk-input-group", has_text="Fork offset [deg]").locator("[role=slider]").last
    handle.focus()
    was = look.page.url
    for _ in range(3):
        handle.press("ArrowRight")
    look.page.wait_for_function("was => document.location.href !== was", arg=was, timeout=WAIT)
    look.settled_anew()
    line = tn.loads(unpack(dict(re.findall(r"[?&](\w+)=([^&]+)", look.page.url))["line"]))
    assert any(getattr(e, "fork_offset", 0.0) for e in line.elements)
    assert look.page.evaluate(SHOWN)["drawn"] != before
    no_alarm(look)


@pytest.mark.slow
def test_two_variants_stand_side_by_side_in_every_view(look: Look) -> None:
    """With what changed; no picture is squeezed out of its half at 1024 px."""
    look.page.set_viewport_size({"width": 1024, "height": 800})
    look.at("?view=stability&stability.across=8&stability.up=6")
    look.page.get_by_role("button", name="Keep this variant to compare").click()
    look.type("Value [deg]", "7")
    look.page.get_by_text("12 deg", exact=True).wait_for()
    for view in ("Stability", "Verdict", "Orders", "Joints", "Motion", "Driveline"):
        look.view(view)
        look.settled_anew()
        assert look.page.get_by_role("heading", name="variant 1", exact=True).count() == 2
        widths = look.page.locator(".bk-Figure").evaluate_all("f => f.map(e => e.getBoundingClientRect().width)")
        assert all(width > 200 or width == 0 for width in widths), (view, widths)
        ends = look.page.locator(".bk-Figure").evaluate_all("f => f.map(e => e.getBoundingClientRect().right)")
        assert max(ends, default=0.0) <= look.page.locator("aside").bounding_box()["x"] + 1, (view, ends)
        no_alarm(look)
    look.page.get_by_role("button", name="Compare no more").click()
    look.page.get_by_role("button", name="Show variant 1").wait_for()
