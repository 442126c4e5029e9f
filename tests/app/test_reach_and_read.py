"""Everybody can read the pages and use them without a mouse: contrast, the Tab key, large type, numbers for clicks."""

from __future__ import annotations

import re
from typing import Any

import pytest
from served import Look

from trunnion.pictures import looks

LEAST_CONTRAST = 4.5
"""Of text, by WCAG 2.2, 1.4.3."""
LABORIOUS = ("driveline", "live", "parts", "verdict", "joints", "orders", "stability", "limits", "motion")
VIEWS = [
    "dashboard",
    *(pytest.param(view, marks=pytest.mark.slow) for view in LABORIOUS),
]
QUERY = "?view={}&stability.across=20&stability.up=16"

WALK = """
const walk = (root, meet) => {
  for (const node of root.querySelectorAll('*')) {
    meet(node)
    if (node.shadowRoot) walk(node.shadowRoot, meet)
  }
}
const parentOf = (node) => node.assignedSlot || node.parentElement || (node.getRootNode().host ?? null)
const shown = (node) => {
  const box = node.getBoundingClientRect()
  return box.width > 1 && box.height > 1 && node.checkVisibility({ visibilityProperty: true })
}
const named = (node) => (node.getAttribute('aria-label') || node.labels?.[0]?.textContent || node.textContent ||
  node.className || node.tagName).trim().slice(0, 60)
"""
FAINT_TEXT = (
    """() => {"""
    + WALK
    + """
  const numbers = (colour) => {
    const parts = colour.match(/[0-9.]+/g).map(Number)
    return [parts[0], parts[1], parts[2], parts[3] ?? 1]
  }
  const over = (top, below) => below.map((c, i) => i < 3 ? top[i] * top[3] + c * (1 - top[3]) : 1)
  const behind = (node) => {
    const layers = []
    for (let at = node; at; at = parentOf(at)) {
      const colour = numbers(getComputedStyle(at).backgroundColor)
      if (colour[3] > 0) layers.push(colour)
      if (colour[3] === 1) break
    }
    return layers.reverse().reduce((below, layer) => over(layer, below), [255, 255, 255, 1])
  }
  const bright = (c) => {
    const [r, g, b] = c.map(v => (v /= 255) <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
    return 0.2126 * r + 0.7152 * g + 0.0722 * b
  }
  const found = []
  const judge = (node, style, text) => {
    const ground = behind(node)
    const [a, b] = [bright(over(numbers(style.color), ground)), bright(ground)]
    const contrast = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05)
    found.push([Math.round(100 * contrast) / 100, style.color, ground.map(Math.round).slice(0, 3).join(), text])
  }
  walk(document, (node) => {
    if (!shown(node) || node.closest('.skip') || node.disabled) return
    const own = [...node.childNodes].filter(c => c.nodeType === 3).map(c => c.textContent.trim()).filter(t => t)
    if (own.length && !node.matches('style, script, option')) judge(node, getComputedStyle(node), own[0].slice(0, 60))
    if (node.matches('input[type=text], input[type=number], input:not([type]), select')) {
      const empty = node.placeholder && !node.value
      judge(node, getComputedStyle(node, empty ? '::placeholder' : null), named(node))
    }
  })
  return found
}"""
)
"""Contrast, colours and words of everything written, through all shadow roots; what is switched off is exempt."""

MARK_CONTROLS = (
    """() => {"""
    + WALK
    + """
  const found = []
  walk(document, (node) => {
    const control = node.matches('input, select, button, textarea, a[href], [tabindex="0"]')
    if (!control || node.disabled || !shown(node) || node.closest('.skip')) return
    node.wanted = found.length
    found.push(named(node))
  })
  return found
}"""
)
ACTIVE = """() => {
  let at = document.activeElement
  while (at && at.shadowRoot && at.shadowRoot.activeElement) at = at.shadowRoot.activeElement
  return at && at !== document.body ? (at.wanted ?? -1) : null
}"""
CROWDED = (
    """() => {"""
    + WALK
    + """
  const boxes = [], found = []
  walk(document, (node) => {
    if (!shown(node)) return
    if (node.matches('.bk-Figure') && node.getBoundingClientRect().width < 120) found.push('a squeezed picture')
    if (!node.matches('input, select, button, textarea, canvas') || node.closest('.bk-spin-btn')) return
    boxes.push([node.getBoundingClientRect(), named(node), node])
  })
  const inner = boxes.filter(([, , node]) => !node.matches('canvas'))
  for (let i = 0; i < inner.length; i++) for (let j = 0; j < i; j++) {
    const [a, b] = [inner[i][0], inner[j][0]]
    const across = Math.min(a.right, b.right) - Math.max(a.left, b.left)
    const up = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top)
    if (across > 3 && up > 3) found.push('overlap: ' + inner[i][1] + ' | ' + inner[j][1])
  }
  const wide = document.documentElement.clientWidth
  for (const [box, name] of boxes) if (box.right > wide + 1 || box.left < -1) found.push('beyond the page: ' + name)
  if (document.documentElement.scrollWidth > wide + 1) found.push('the page scrolls sideways')
  return found
}"""
)


@pytest.mark.parametrize("view", VIEWS)
def test_everybody_reads_and_reaches_what_is_on_a_page(look: Look, view: str) -> None:
    look.at(QUERY.format(view))
    text_stands_out_from_its_ground(look)
    the_tab_key_reaches_every_control(look)
    nothing_overlaps_from_twice_enlarged_to_wide(look)


def text_stands_out_from_its_ground(look: Look) -> None:
    found = look.page.evaluate(FAINT_TEXT)
    assert len(found) > 20
    assert [one for one in found if one[0] < LEAST_CONTRAST] == []


def luminance(colour: str) -> float:
    """Relative luminance of #rrggbb."""
    parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    r, g, b = (v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in parts)
    return 0.2126 * r + 0.7152 * g + 0.0722 * b


@pytest.mark.parametrize(
    ("colour", "least"), [(looks.INK, 4.5), (looks.FAINT, 4.5), *((c, 2.0) for c in looks.COLOURS)]
)
def test_what_is_drawn_stands_out_from_white(colour: str, least: float) -> None:
    """Text as text must; of the curves' colours those of Okabe and Ito are kept, which dashes tell apart as well."""
    assert 1.05 / (luminance(colour) + 0.05) >= least


def the_tab_key_reaches_every_control(look: Look) -> None:
    controls = look.page.evaluate(MARK_CONTROLS)
    assert len(controls) > 15
    look.page.evaluate("() => document.activeElement.blur()")
    reached: set[Any] = set()
    for _ in range(3 * len(controls)):
        look.page.keyboard.press("Tab")
        reached.add(look.page.evaluate(ACTIVE))
        if len(reached - {None, -1}) == len(controls):
            break
    assert [name for k, name in enumerate(controls) if k not in reached] == []


def nothing_overlaps_from_twice_enlarged_to_wide(look: Look) -> None:
    """512 and 640 points are what windows of 1024 and 1280 have at 200 %."""
    look.page.set_viewport_size({"width": 1920, "height": 800})
    look.page.wait_for_timeout(700)  # pictures follow the page with a delay
    found = {1920: look.page.evaluate(CROWDED)}
    for width in (1024, 640, 512):  # a picture that has not followed yet stands beyond the narrower page
        look.page.set_viewport_size({"width": width, "height": 800})
        for _ in range(100):
            look.page.wait_for_timeout(100)
            found[width] = look.page.evaluate(CROWDED)
            if not found[width]:
                break
    assert found == {width: [] for width in found}


@pytest.mark.slow
def test_a_click_on_a_speed_and_the_same_number_typed_are_one(look: Look) -> None:
    """The wave form that a click in the orders shows, and its address, come back from the labelled field alone."""
    look.at("?view=orders")
    chart = look.page.locator(".bk-Canvas").first
    chart.scroll_into_view_if_needed()
    box = chart.bounding_box()
    look.page.mouse.click(box["x"] + 0.55 * box["width"], box["y"] + 0.3 * box["height"])
    look.page.wait_for_url(re.compile(r"orders\.speed="))
    clicked = look.page.url
    field = look.page.get_by_label("Speed [rpm]", exact=True)
    speed = field.input_value()
    assert 300 < float(speed) < 3000
    look.at("?view=orders")
    look.type("Speed [rpm]", speed)
    look.page.wait_for_url(clicked)
