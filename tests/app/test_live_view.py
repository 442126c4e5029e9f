"""The view *Live* of the application: it plays what ``tn.animate`` gives in one WebGL context, saves it, and follows
the line and its settings."""

from __future__ import annotations

import json
import urllib.request

import pytest
from served import Look

FOUND = """(() => { const find = root => { for (const e of root.querySelectorAll("*")) {
  if (e.player) return e.player; const within = e.shadowRoot && find(e.shadowRoot); if (within) return within }
  return null }; return find(document) })()"""
"""The player on the page, wherever it stands."""


def plays(seen: Look, title: str) -> None:
    seen.page.wait_for_function(f"() => {FOUND}?.data.choices[0].title === '{title}'")


@pytest.mark.slow
def test_it_plays_the_line_and_follows_its_settings(look: Look) -> None:
    look.at("?view=live")
    plays(look, "turning")
    page = look.page
    assert page.evaluate(f"{FOUND}.kind") == "webgl"
    names = page.evaluate(f"{FOUND}.parts.map(part => part.name)")
    assert "joint" in " ".join(names).lower()
    page.get_by_label("Motion", exact=True).select_option(label="a mode")
    plays(look, "mode 1")
    look.type("Mode", "2")
    look.settled_anew()
    plays(look, "mode 2")
    page.evaluate(f"{FOUND}.pause(); {FOUND}.orbit(0.3, 0); {FOUND}.seek(0.4 * {FOUND}.whole)")
    turned = page.evaluate(f"{FOUND}.camera.turn")
    look.type("Mode", "1")
    look.settled_anew()
    plays(look, "mode 1")
    assert page.evaluate(f"{FOUND}.camera.turn") == turned  # seen from the same side


def test_what_it_plays_can_be_saved(look: Look) -> None:
    look.at("?view=live&live.what=response")
    plays(look, "response")
    link = look.page.get_by_role("link", name="JSON").get_attribute("href")
    with urllib.request.urlopen(look.server.address + link) as answer:
        scene = json.loads(answer.read())
    assert scene["choices"][0]["title"] == "response"
    assert scene == look.page.evaluate(f"{FOUND}.data")


@pytest.mark.slow
def test_two_variants_take_one_context(look: Look) -> None:
    look.at("?view=live")
    plays(look, "turning")
    look.page.get_by_role("button", name="Keep this variant to compare").click()
    look.settled_anew()
    kinds = """() => { const found = []; const walk = root => { for (const e of root.querySelectorAll('*')) {
      if (e.player) found.push(e.player.kind); if (e.shadowRoot) walk(e.shadowRoot) } }
      walk(document); return found.sort() }"""
    look.page.wait_for_function(f"() => ({kinds})().length === 2")
    assert look.page.evaluate(kinds) == ["2d", "webgl"]


def test_a_motion_that_cannot_be_shown_says_why(look: Look) -> None:
    look.at("?view=live&live.what=transient")
    look.page.get_by_text("has no scenario").first.wait_for()
    assert look.page.evaluate(FOUND) is None


@pytest.mark.slow
@pytest.mark.parametrize("width", [390, 1024])
def test_it_needs_no_sideways_scroll(look: Look, width: int) -> None:
    look.page.set_viewport_size({"width": width, "height": 800})
    look.at("?view=live")
    plays(look, "turning")
    assert look.page.evaluate("document.documentElement.scrollWidth") <= width
