"""The application as its users meet it: a browser, a page, and the same numbers as the public functions give."""

from __future__ import annotations

import html
import re
from pathlib import Path

import pytest
from served import Look

import trunnion as tn
from trunnion.driveline.starter import starter


def test_a_refused_value_is_said_beside_its_field_and_undone(look: Look) -> None:
    look.at()
    look.type("stiffness of Shaft 1", "12 parsec")
    look.page.get_by_text("unknown unit 'parsec'").wait_for()
    assert look.page.get_by_label("stiffness of Shaft 1", exact=True).get_attribute("aria-invalid") == "true"
    look.page.get_by_role("button", name="Undo").click()
    look.page.get_by_text("unknown unit 'parsec'").wait_for(state="hidden")
    assert look.page.get_by_label("stiffness of Shaft 1", exact=True).input_value() == "12 kN*m/rad"


def test_an_edited_value_changes_the_verdict_and_a_link_restores_it_in_a_fresh_browser(
    look: Look, browser: object
) -> None:
    look.at()
    look.type("angle of HookeJoint 1", "2.25 deg")
    look.view("Verdict")
    sentence = tn.assess(tn.loads(starter("two-shaft")).replace("HookeJoint 1", angle="2.25 deg")).sentence
    look.page.get_by_text(sentence, exact=True).wait_for()
    look.page.wait_for_url(re.compile("view=verdict"))
    other = browser.new_context().new_page()  # type: ignore[attr-defined]
    other.goto(look.page.url)
    other.get_by_text(sentence, exact=True).wait_for(timeout=180_000)
    assert other.locator("[data-verdict]").inner_text() == sentence
    named = {"name": "Driveline", "exact": True}
    other.get_by_role("button", **named).or_(other.get_by_role("radio", **named)).first.click()
    field = other.get_by_label("angle of HookeJoint 1", exact=True)
    field.wait_for()
    assert field.input_value() == "2.25 deg"
    other.context.close()


def choose(look: Look, label: str, text: str) -> None:
    """Choose the option that begins with ``text``."""
    field = look.page.get_by_label(label, exact=True)
    field.select_option(label=next(o for o in field.locator("option").all_inner_texts() if o.startswith(text)))


@pytest.mark.slow
def test_from_a_starter_to_a_satisfied_verdict(look: Look) -> None:
    """As somebody who reads nothing: begin, and press what each page offers until the verdict is satisfied."""
    look.at()
    choose(look, "Begin with", "two-shaft")
    look.page.get_by_role("button", name="Begin", exact=True).click()
    choose(look, "application of operation", "road")
    look.view("Verdict")
    look.page.locator("[data-verdict=exceeded]", has_text="uniformity").wait_for()
    look.page.get_by_text("no limit of torque or stress is stated").first.wait_for()
    look.page.get_by_role("button", name="What would help?").click()
    look.page.get_by_role("button", name="Try it").first.click()
    look.page.locator("[data-verdict=not-judged]").wait_for()
    look.page.get_by_role("button", name="State limits").click()
    look.page.get_by_text("type what yours may bear").wait_for()
    field = look.page.get_by_label("vibratory torque of limit of Shaft *", exact=True)
    field.wait_for()
    assert field.input_value() == "500 N*m"
    look.type("vibratory torque of limit of Shaft *", "600 N*m")
    look.view("Verdict")
    look.page.locator("[data-verdict=satisfied]").wait_for()
    assert look.page.locator("[data-verdict=exceeded]").count() == 0
    assert look.page.get_by_text("no limit of torque or stress is stated").count() == 0
    assert look.page.get_by_role("button", name="State limits").count() == 0


@pytest.mark.slow
def test_what_helps_is_found_and_tried(look: Look) -> None:
    """The change that the button makes is the one that its sentence names, and it satisfies what it is for."""
    line = tn.loads(starter("two-shaft").replace('# application = "road"', 'application = "road"'))
    line = line.replace("HookeJoint 1", angle="3.5 deg")
    sentence = tn.assess(line).sentence
    assert sentence.startswith("exceeded: uniformity")
    look.at()
    choose(look, "application of operation", "road")
    look.type("angle of HookeJoint 1", "3.5 deg")
    look.view("Verdict")
    look.page.get_by_text(sentence, exact=True).wait_for()
    look.page.get_by_role("button", name="What would help?").click()
    (expected,) = tn.remedies(line, most=2).of("uniformity")
    look.page.get_by_text(f"uniformity: {expected.sentence}").first.wait_for()
    look.page.get_by_role("button", name="Try it").first.click()
    mended = tn.assess(line.replace("HookeJoint 1", angle=expected.after)).sentence
    look.page.get_by_text(mended, exact=True).wait_for()


@pytest.mark.slow
def test_the_report_is_saved_whole(look: Look, tmp_path: Path) -> None:
    """One file without references to elsewhere, with the verdict that the page shows."""
    look.at("?view=verdict")
    sentence = look.page.locator("[data-verdict]").inner_text()
    with look.page.expect_download(timeout=280_000) as waiting:
        look.page.locator("a[href$='driveline.html'], a[href$='report.html']").first.click()
    path = tmp_path / "report.html"
    waiting.value.save_as(path)
    page = path.read_text(encoding="utf-8")
    assert page.lstrip().lower().startswith("<!doctype html>") and page.rstrip().endswith("</html>")
    assert not re.findall(r"(?:src|href)=[\"']https?://", page)
    said = sentence.partition(": ")[2].replace(" deg", "°")  # the report sets units as print does
    assert "data:image/svg+xml" in page and said in html.unescape(" ".join(page.split()))


@pytest.mark.slow
def test_a_malformed_file_is_refused_and_the_page_lives(look: Look) -> None:
    from playwright.sync_api import expect  # where there is a browser, see conftest

    look.at()
    field = look.page.get_by_label("Open a TOML file")
    field.set_input_files({"name": "bad.toml", "mimeType": "text/plain", "buffer": b"format = 1\n[[element"})
    look.page.get_by_text("is not valid TOML").wait_for()
    field.set_input_files({"name": "big.toml", "mimeType": "text/plain", "buffer": b"#" * 1_500_000})
    look.page.get_by_text("at most 1000000 are taken").wait_for()
    good = starter("two-shaft").replace("12 deg", "3.5 deg").encode()
    field.set_input_files({"name": "good.toml", "mimeType": "text/plain", "buffer": good})
    look.page.wait_for_function("() => document.location.search.length > 0", timeout=180_000)
    look.page.get_by_text("3.5").first.wait_for()
    expect(look.page.get_by_label("angle of HookeJoint 1", exact=True)).to_have_value("3.5 deg", timeout=60_000)


@pytest.mark.slow
def test_what_stayed_unsent_follows_when_the_page_rests(look: Look) -> None:
    """A change that nobody sees carries it; it comes after every other change."""
    look.at("?view=joints")
    look.page.wait_for_selector("[data-mark]", state="attached")
    look.page.wait_for_timeout(1000)
    before = look.page.locator("[data-mark]").get_attribute("data-mark")
    look.type("Angle in side view [deg]", "6")
    look.page.wait_for_selector(f"[data-mark]:not([data-mark='{before}'])", state="attached")
    assert look.page.locator("[data-mark]").get_attribute("data-mark") != before


def test_a_double_click_removes_one_element_and_what_is_refused_stamps_the_pictures(look: Look) -> None:
    """The second click meets the × of the element that has moved up; a line is begun with nothing."""
    look.at()
    look.page.get_by_role("button", name="remove Shaft 1").dblclick()
    look.page.get_by_role("button", name="remove Shaft 2").wait_for(state="detached")
    look.settled_anew()
    left = look.page.get_by_role("button", name=re.compile("^remove "))
    assert left.count() == 5
    assert look.page.locator(".stamp").count() == 0
    look.type("angle of HookeJoint 1", "200 deg")
    look.page.locator(".stamp", has_text="last accepted").wait_for()
    faint = (
        "e => { for (; e; e = e.parentElement || e.getRootNode().host) if (getComputedStyle(e).opacity < 1) return 1 }"
    )
    sketch = look.page.locator("img[alt^='sketch']")
    look.page.wait_for_timeout(600)
    assert sketch.evaluate(faint) == 1
    look.page.get_by_role("button", name="Undo").click()
    look.page.locator(".stamp").wait_for(state="detached")
    look.settled_anew()
    assert sketch.evaluate(faint) is None
    choose(look, "Begin with", "an empty line")
    look.page.get_by_role("button", name="Begin", exact=True).click()
    left.first.wait_for(state="detached")
    look.page.locator(".stamp", has_text="last accepted").wait_for()
