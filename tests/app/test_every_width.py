"""Every view at the widths of a telephone, a tablet, a laptop and a desk, in both themes: nothing scrolls sideways,
no words are cut off, and nothing lies on anything else.

``TRUNNION_SCREENSHOTS=FOLDER`` keeps what was seen, a file each, to be looked at."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from served import Look
from test_reach_and_read import CROWDED, FAINT_TEXT, LEAST_CONTRAST, WALK

from trunnion import registry

WIDTHS = (1920, 1440, 1024, 390)
HEIGHT = 900
THEMES = ("light", "dark")
PATIENCE = 10_000
"""Milliseconds in which pictures follow the page."""

CUT_OFF = (
    """() => {"""
    + WALK
    + """
  const found = [], canvas = document.createElement('canvas').getContext('2d')
  const wide = (words, style) => {
    canvas.font = `${style.fontWeight} ${style.fontSize} ${style.fontFamily}`
    return canvas.measureText(words).width
  }
  walk(document, (node) => {
    if (!shown(node) || node.closest('.skip, .bk-Figure, .bk-Canvas')) return
    const style = getComputedStyle(node), inner = node.clientWidth - parseFloat(style.paddingLeft || 0)
      - parseFloat(style.paddingRight || 0)
    const say = (words, need, has) =>
      found.push(`${node.tagName} ${words.slice(0, 60)}: ${Math.round(need)} > ${Math.round(has)}`)
    if (node.matches('select')) {
      const words = node.selectedOptions[0]?.textContent.trim() ?? ''
      if (style.textOverflow !== 'ellipsis' && wide(words, style) > inner + 1) say(words, wide(words, style), inner)
    } else if (node.matches('input[type=text], input[type=number], input:not([type])')) {
      const words = node.value || node.placeholder
      if (wide(words, style) > inner + 1) say(named(node) + ' = ' + words, wide(words, style), inner)
    } else {
      const own = [...node.childNodes].filter(c => c.nodeType === 3).map(c => c.textContent.trim()).join('')
      if (!own || node.matches('style, script, option')) return
      const range = document.createRange()
      range.selectNodeContents(node)
      const words = range.getBoundingClientRect()
      for (let at = node; at; at = parentOf(at)) {
        const look = getComputedStyle(at), box = at.getBoundingClientRect()
        if (/auto|scroll/.test(look.overflowX)) break
        const cuts = /hidden|clip/.test(look.overflowX) && (words.right > box.right + 1 || words.left < box.left - 1)
        const low = /hidden|clip/.test(look.overflowY) && (words.bottom > box.bottom + 2 || words.top < box.top - 2)
        if (cuts || low) { say(own, cuts ? words.width : words.height, cuts ? box.width : box.height); break }
      }
    }
  })
  return found
}"""
)
"""Words that do not fit into what holds them: of fields, of lists that show no …, and what a box cuts off."""


@pytest.mark.slow
@pytest.mark.parametrize("view", registry.VIEWS)
def test_a_view_fits_every_width_in_both_themes(look: Look, view: str) -> None:
    page, found = look.page, {}
    page.set_viewport_size({"width": WIDTHS[0], "height": HEIGHT})
    look.at(f"?view={view}&stability.across=20&stability.up=16")
    for width in WIDTHS:
        page.set_viewport_size({"width": width, "height": HEIGHT})
        for theme in THEMES:
            page.emulate_media(color_scheme=theme)
            for _ in range(PATIENCE // 250):
                page.wait_for_timeout(250)
                crowded, cut_off = page.evaluate(CROWDED), page.evaluate(CUT_OFF)
                faint = [one for one in page.evaluate(FAINT_TEXT) if one[0] < LEAST_CONTRAST]
                found[width, theme] = crowded + cut_off + faint
                if not found[width, theme]:
                    break
            keep(look, f"{view}-{width}-{theme}")
    assert {where: what for where, what in found.items() if what} == {}


def keep(look: Look, name: str) -> None:
    """The whole page as a picture, where somebody wants to look at it."""
    if folder := os.environ.get("TRUNNION_SCREENSHOTS"):
        look.page.wait_for_timeout(700)
        look.page.screenshot(path=Path(folder, f"{name}.png"), full_page=True)
