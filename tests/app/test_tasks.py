"""Tasks of an engineer, each from its beginning to its end in a browser, against what the public functions give.

A line is built until it is satisfied, the phase found that calms it, seen why it is unstable, variants are compared, a
report is handed on."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from served import Look
from test_every_width import CUT_OFF
from test_in_the_browser import choose
from test_live_view import FOUND, plays
from test_picture_edits import becomes
from test_reach_and_read import CROWDED

import trunnion as tn
from trunnion.app.address import pack
from trunnion.driveline.files import dumps
from trunnion.driveline.starter import starter

pytestmark = pytest.mark.slow
SENTENCE = "[data-verdict]"
PATIENCE = 120_000
"""Milliseconds: machines that test are busy."""


@pytest.fixture
def at_work(look: Look) -> Look:
    look.page.set_default_timeout(PATIENCE)
    return look


def saved(look: Look) -> tn.Driveline:
    """The line as the page saves it."""
    href = look.page.locator("a[href$='driveline.toml']").first.evaluate("link => link.href")
    return tn.loads(look.page.request.get(href).text())


def test_a_line_is_built_from_nothing_until_it_is_satisfied(at_work: Look) -> None:
    """The first two parts from the list, all others dragged or put from the palette into the picture."""
    look, page = at_work, at_work.page
    look.at()
    choose(look, "Begin with", "an empty line")
    page.get_by_role("button", name="Begin", exact=True).click()
    page.get_by_role("button", name=re.compile("^remove ")).first.wait_for(state="detached")
    kind, add = page.get_by_label("kind of the new element", exact=True), page.get_by_role("button", name="Add element")
    for k, name in enumerate(("ConstantSpeed", "Shaft", "Disk"), start=1):
        kind.select_option(name)
        add.click()
        page.locator(f"[data-group=element-{k - 1}]").wait_for()
        kind = page.get_by_label("kind of the new element", exact=True)
    have = ["ConstantSpeed 1", "Shaft 1", "Disk 1"]
    becomes(page, have)
    for chip, after, name in (
        ("HookeJoint", "Disk 1", "HookeJoint 1"),
        ("Shaft", "HookeJoint 1", "Shaft 2"),
        ("Disk", "Shaft 2", "Disk 2"),
    ):
        look.settled_anew()
        page.locator(f".chip[data-kind={chip}]").drag_to(page.locator(f"[data-where='behind {after}']"))
        have.append(name)
        becomes(page, have)
    for field, value in (
        ("angle of HookeJoint 1", "2 deg"),
        ("speed of operation", "1500 rpm"),
        ("lowest speed of operation", "300 rpm"),
        ("highest speed of operation", "3000 rpm"),
    ):
        look.type(field, value)
    choose(look, "application of operation", "road")
    look.view("Verdict")
    page.locator("[data-verdict=not-judged]").wait_for()
    page.get_by_role("button", name="State limits").click()
    page.get_by_label("vibratory torque of limit of Shaft *", exact=True).wait_for()
    look.view("Verdict")
    page.locator("[data-verdict=satisfied]").wait_for()
    line = saved(look)
    assert list(line.names) == have
    assert page.locator(SENTENCE).inner_text() == tn.assess(line).sentence
    look.view("Dashboard")
    page.locator("[data-verdict=satisfied]").wait_for()


def phased(offset: str) -> tn.Driveline:
    """The line of two joints whose forks are not in line."""
    return tn.loads(starter("three-shaft")).replace("tube", fork_offset=offset)


def left_of(beta: float, offset: float) -> float:
    """Angle of the one joint that is as uneven as two of ``beta`` in one plane, to first order: their terms of twice a
    turn add up as β²(1 − e^{2iφ})."""
    return float(beta * np.sqrt(abs(1 - np.exp(2j * offset))))


@pytest.mark.parametrize("by", ["dragging", "keys"])
def test_the_phase_that_calms_the_line_is_found(at_work: Look, by: str) -> None:
    """The slider of the fork offset is moved while the irregularity is looked at, to where the two joints cancel."""
    look, page = at_work, at_work.page
    start = 40.0 if by == "dragging" else 4.0
    look.at(f"?view=joints&joints.shaft=tube&line={pack(dumps(phased(f'{start} deg')))}")
    equivalent = page.locator("td[data-value=equivalent]")
    equivalent.wait_for()

    def said() -> float:
        return float(equivalent.inner_text().rstrip("°"))

    assert said() == pytest.approx(left_of(10.0, np.radians(start)), rel=0.02)
    handle = page.get_by_role("slider", name="Fork offset [deg]")
    handle.scroll_into_view_if_needed()
    seen = [said()]
    if by == "keys":
        handle.focus()
        for k in range(1, 5):
            handle.press("ArrowLeft")
            page.wait_for_function(WITHIN, arg=["equivalent", left_of(10.0, np.radians(start - k)) * 1.03 + 0.05])
            seen.append(said())
    else:
        box = handle.bounding_box()
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        track = handle.locator("xpath=ancestor::*[contains(@class, 'noUi-target')]").bounding_box()
        degree = track["width"] / 180
        page.mouse.move(x, y)
        page.mouse.down()
        for down in (10, 20, 30, 36, 40):
            page.mouse.move(x - down * degree, y, steps=3)
            page.wait_for_function(WITHIN, arg=["equivalent", left_of(10.0, np.radians(start - down)) * 1.03 + 0.9])
            seen.append(said())  # while the button is still pressed
        page.mouse.up()
        for _ in range(3):  # the hand is a degree off, the keys are not
            if (offset := float(handle.get_attribute("aria-valuenow"))) == 0:
                break
            handle.press("ArrowLeft" if offset > 0 else "ArrowRight")
            page.wait_for_timeout(500)
    assert seen == sorted(seen, reverse=True)
    page.wait_for_function(WITHIN, arg=["equivalent", 0.3])
    look.settled_anew()
    line = saved(look)
    assert line.elements[line.index("tube")].stated.get("fork_offset", 0.0) == pytest.approx(0.0, abs=1e-9)
    assert float(page.locator("td[data-value=irregularity]").inner_text()) == pytest.approx(
        float(tn.kinetostatics(line).irregularity), abs=2e-6
    )


WITHIN = """([name, most]) => { const deep = root => [...root.querySelectorAll('*')].flatMap(e =>
  [...(e.matches(`td[data-value=${name}]`) ? [e] : []), ...(e.shadowRoot ? deep(e.shadowRoot) : [])])
  return parseFloat(deep(document)[0]?.innerText) <= most }"""
"""A number of the page is small enough."""


def test_why_a_line_is_unstable_is_seen(at_work: Look) -> None:
    """From the dashboard that says so to the disturbance that grows, beside the one that decays."""
    look, page = at_work, at_work.page
    line = tn.catalogue("two-shaft-cardan", angle=0.5, damping_ratio=0.001)
    text = at(line, "1.62 rad/s")
    look.at(f"?line={pack(text)}&view=dashboard")
    said = page.locator("[data-value=growth]")
    said.get_by_text("unstable at").or_(said).first.wait_for()
    rate = tn.stability(tn.loads(text)).growth_rate
    assert rate > 0 and said.inner_text().startswith("unstable at 1.62 rad/s")
    assert f"grows by {rate:.4g} 1/s" in said.inner_text()
    page.get_by_role("button", name="Stability ›").click()
    page.wait_for_url("**view=stability**")
    page.get_by_text("unstable", exact=True).first.wait_for()
    look.view("Live")
    page.get_by_label("Motion", exact=True).select_option(label="the disturbance that grows fastest")
    plays(look, "disturbance")
    captions = [one.split(":")[0] for one in page.locator(".caption").all_inner_texts()]
    assert captions == ["grows", "decays"]
    page.evaluate(f"{FOUND}.seek(0)")
    page.wait_for_function(f"() => {FOUND}.playing && {FOUND}.time > 0.01 * {FOUND}.whole")
    page.get_by_role("button", name="Pause", exact=True).click()
    sizes = []
    for share in (0.0, 0.5):
        page.evaluate(f"{FOUND}.seek({share} * {FOUND}.whole)")
        sizes.append([abs(complex(*page.evaluate(f"{FOUND}.rows[{row}].envelope({FOUND}.time)"))) for row in (0, 1)])
    seconds = 0.5 * page.evaluate(f"{FOUND}.whole")
    assert sizes[1][0] / sizes[0][0] == pytest.approx(np.exp(rate * seconds), rel=1e-6)
    assert sizes[1][1] < sizes[0][1]


def at(line: tn.Driveline, speed: str) -> str:
    """The file of a line that runs at a speed."""
    ends = 'speed_range = ["1 rad/s", "2 rad/s"]\nspeed_unit = "rad/s"\n'
    return f'{dumps(line)}\n[operation]\nspeed = "{speed}"\n{ends}'


def test_three_variants_are_compared(at_work: Look) -> None:
    """Two are kept under names, the third is the line now: on the same axes, with verdicts and differences."""
    look, page = at_work, at_work.page
    look.at("?view=orders")
    angle = page.get_by_label("Value [deg]", exact=True)

    def keep(name: str) -> None:
        page.get_by_label("Name of the variant", exact=True).fill(name)
        page.get_by_label("Name of the variant", exact=True).blur()
        page.get_by_role("button", name="Keep this variant to compare").click()
        page.get_by_role("button", name=f"Drop {name}", exact=True).wait_for()

    keep("as built")
    angle.fill("6")
    angle.press("Enter")
    keep("flatter")
    angle.fill("3")
    angle.press("Enter")
    page.get_by_role("button", name="on the same axes").or_(page.get_by_role("radio", name="on the same axes")).click()
    look.settled_anew()
    line = tn.loads(starter("two-shaft"))
    angles = {"as built": 12, "flatter": 6, "now": 3}
    lines = {name: line.replace("HookeJoint 1", angle=f"{angle} deg") for name, angle in angles.items()}
    low, high = tn.rpm(300), tn.rpm(3000)
    peak = {
        name: float(tn.order_response(one, tn.sweep_speeds(one, low, high)).vibratory_torque[:, 0].max())
        for name, one in lines.items()
    }
    rows = page.locator("table.plain tr", has_text="all together")
    for name in ("as built", "flatter"):
        row = rows.filter(has_text=name).first
        row.wait_for()
        words = row.inner_text()
        assert f"{peak[name]:.4g} N m" in words and f"{peak['now']:.4g} N m" in words, words
        assert f"{peak['now'] / peak[name] - 1:+.1%}" in words
    for one in lines.values():
        page.get_by_text(tn.assess(one).sentence).first.wait_for()
    page.get_by_text("as built is like the line now").wait_for(state="detached")
    assert page.get_by_role("button", name="Swap flatter", exact=True).count() == 1


def test_a_report_is_handed_on(at_work: Look, browser: Any, tmp_path: Path) -> None:
    """With its number typed and its verdict read, as a file that opens by itself with the network cut."""
    look, page = at_work, at_work.page
    look.at(f"?view=driveline&line={pack(dumps(phased('0 deg')))}")
    look.type("angle of HookeJoint 1", "9.75 deg")
    look.view("Verdict")
    page.locator(SENTENCE).first.wait_for()
    look.settled_anew()
    sentence = page.locator(SENTENCE).inner_text()
    with page.expect_download(timeout=280_000) as waiting:
        page.get_by_role("link", name="HTML", exact=True).first.click()
    waiting.value.save_as(tmp_path / "report.html")
    context = browser.new_context(offline=True)
    read, asked = context.new_page(), []
    read.on("request", lambda request: asked.append(request.url))
    read.goto((tmp_path / "report.html").as_uri())
    body = " ".join(read.locator("body").inner_text().split())
    assert sentence.partition(",")[0] in body  # the verdict, and what binds
    assert "9.75" in body
    assert [url for url in asked if not url.startswith(("file:", "data:", "blob:"))] == []
    context.close()


@pytest.mark.parametrize("view", ["dashboard", "driveline", "parts", "verdict", "orders", "joints"])
def test_a_name_of_eighty_letters_fits(at_work: Look, view: str) -> None:
    look, page = at_work, at_work.page
    name = "intermediate shaft between the gearbox and the second axle, of the long wheelbase"[:80]
    assert len(name) == 80
    line = tn.loads(starter("two-shaft"))
    text = starter("two-shaft").replace('type = "Shaft"\n', f'type = "Shaft"\nname = "{name}"\n', 1)
    assert tn.loads(text).names[1] == name and len(line.names) == len(tn.loads(text).names)
    look.at(f"?view={view}&line={pack(text)}")
    for width in (1440, 390):
        page.set_viewport_size({"width": width, "height": 900})
        for _ in range(40):
            page.wait_for_timeout(250)
            found = page.evaluate(CROWDED) + [
                one for one in page.evaluate(CUT_OFF) if not one.startswith(("INPUT", "SELECT"))
            ]
            if not found:
                break
        assert found == [], width


def test_a_click_while_the_page_loads_is_not_lost(at_work: Look) -> None:
    """What is pressed as soon as it can be seen, before the first view has computed, is what the page then shows."""
    page = at_work.page
    page.goto(at_work.server.address + "?view=driveline", wait_until="commit")
    named = {"name": "Joints", "exact": True}
    page.get_by_role("button", **named).or_(page.get_by_role("radio", **named)).first.click()
    page.wait_for_url(re.compile("view=joints"))
    page.locator("td[data-value=irregularity]").wait_for()
    page.get_by_role("button", name="Keep this variant to compare").click()
    page.get_by_role("button", name="Drop variant 1").wait_for()
    at_work.settled_anew()
    assert "view=joints" in page.url
