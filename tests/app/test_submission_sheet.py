"""The first sheet of the report that is handed in is one A4 page, and the others break where they may."""

from __future__ import annotations

from typing import Any

import pytest

import trunnion as tn

WIDTH, HEIGHT = (210 - 30) / 25.4 * 96, (297 - 34) / 25.4 * 96
"""Pixels of an A4 page between its margins."""
NAMES = ["truck", "harbour-tug", "two-stroke-ship", "six-cylinder-ship", "electric-drive", "passenger-car", "dumper"]


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_the_first_sheet_is_one_page(browser: Any, name: str) -> None:
    page = browser.new_page(viewport={"width": round(WIDTH), "height": round(HEIGHT)})
    page.emulate_media(media="print")
    page.set_content(tn.submission(tn.load(f"examples/{name}.toml")).html)
    sheet = page.locator("#first").bounding_box()
    assert sheet["height"] <= HEIGHT
    assert page.evaluate("document.documentElement.scrollWidth") <= WIDTH + 1
    page.close()
