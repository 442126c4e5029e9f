"""Two themes: what is written is read in both, what judges is told apart by every kind of colour vision, and the switch
keeps what was chosen."""

from __future__ import annotations

import colorsys
import re
from itertools import combinations

import numpy as np
import pytest
from served import Look
from test_live_view import FOUND

pytest.importorskip("panel")

from trunnion.app import page, themes
from trunnion.app.parts import editor, mode_animation, upload
from trunnion.app.views import dashboard
from trunnion.pictures import looks

LIGHT, DARK = 0, 1
DICHROMATS = {
    # Viénot, Brettel and Mollon 1999, on linear red, green and blue
    "protan": [[0.11238, 0.88762, 0.0], [0.11238, 0.88762, 0.0], [0.00401, -0.00401, 1.0]],
    "deutan": [[0.29275, 0.70725, 0.0], [0.29275, 0.70725, 0.0], [-0.02234, 0.02234, 1.0]],
}


def rgb(text: str) -> np.ndarray:
    return np.array([int(text[k : k + 2], 16) for k in (1, 3, 5)]) / 255


def linear(colour: np.ndarray) -> np.ndarray:
    return np.where(colour <= 0.04045, colour / 12.92, ((colour + 0.055) / 1.055) ** 2.4)


def contrast(a: np.ndarray, b: np.ndarray) -> float:
    """Of WCAG 2.2."""
    low, high = sorted(float(linear(np.clip(one, 0, 1)) @ [0.2126, 0.7152, 0.0722]) for one in (a, b))
    return (high + 0.05) / (low + 0.05)


def in_the_dark(colour: np.ndarray, ground: np.ndarray) -> np.ndarray:
    """A colour of a picture as the filter and the blending leave it, written out from the CSS specification."""
    c, s = np.cos(np.pi), np.sin(np.pi)
    luma = np.array([0.213, 0.715, 0.072])
    turn = luma + c * (np.eye(3) - luma)
    turn = turn + s * np.array([[-0.213, -0.715, 0.928], [0.143, 0.140, -0.283], [-0.787, 0.715, 0.072]])
    drawn = np.clip(turn @ (1 - colour), 0, 1)
    return 1 - (1 - drawn) * (1 - ground)


@pytest.mark.parametrize("theme", [LIGHT, DARK])
def test_words_and_edges_stand_out(theme: int) -> None:
    of = {name: rgb(pair[theme]) for name, pair in themes.COLOURS.items()}
    poor = [(a, b, least) for pairs, least in ((themes.TEXTS, 4.5), (themes.EDGES, 3.0)) for a, b in pairs
            if contrast(of[a], of[b]) < least]  # fmt: skip
    assert poor == []


@pytest.mark.parametrize("theme", [LIGHT, DARK])
@pytest.mark.parametrize("vision", DICHROMATS)
def test_what_judges_is_told_apart_by_every_kind_of_colour_vision(theme: int, vision: str) -> None:
    of = [rgb(themes.COLOURS[name][theme]) for name in ("satisfied", "exceeded", "undecided")]
    seen = [np.array(DICHROMATS[vision]) @ linear(one) for one in of]
    for a, b in combinations(seen, 2):
        assert np.linalg.norm(np.sqrt(np.clip(a, 0, 1)) - np.sqrt(np.clip(b, 0, 1))) > 0.1


def test_pictures_keep_their_hues_in_the_dark_and_stand_out() -> None:
    assert themes.PICTURE == {"filter": "invert(1) hue-rotate(180deg)", "blend": "screen"}
    ground = rgb(themes.COLOURS["ground"][DARK])
    assert np.allclose(in_the_dark(np.ones(3), ground), ground, atol=0.01)  # paper is not seen
    assert contrast(in_the_dark(rgb(looks.INK), ground), ground) > 10
    for colour in (looks.ACCENT, looks.VERMILION, looks.GREEN, looks.WORST, looks.BAD, looks.DARK):
        seen = in_the_dark(rgb(colour), ground)
        assert contrast(seen, ground) > 3, colour
        before, after = (colorsys.rgb_to_hsv(*one)[0] for one in (rgb(colour), seen))
        assert min(abs(before - after), 1 - abs(before - after)) < 0.09, colour


def test_the_page_names_colours_by_what_they_are_for() -> None:
    """No colour of one theme stands in the other."""
    parts = (page._STYLE, page._NAVIGATION, editor._STYLE, mode_animation._STYLE, upload._STYLE, dashboard.TILE,
             dashboard.TITLE)  # fmt: skip
    assert [re.findall(r"#[0-9a-f]{3,6}\b", part) for part in parts if re.search(r"#[0-9a-f]{3,6}\b", part)] == []
    used = set(re.findall(r"var\(--([a-z-]+)", " ".join(parts)))
    assert used - set(themes.COLOURS) - set(themes.SCALE) - set(themes.SPACES) <= {"picture-filter", "picture-blend"}


def test_the_theme_is_switched_and_kept(look: Look) -> None:
    page = look.page
    page.set_default_timeout(60_000)
    page.emulate_media(color_scheme="dark")
    look.at("?view=live")
    ground = "getComputedStyle(document.body).backgroundColor"
    light, dark = (
        "rgb({}, {}, {})".format(*(int(255 * x + 0.5) for x in rgb(one))) for one in themes.COLOURS["ground"]
    )
    page.wait_for_function(f"() => {FOUND}?.theme === 'dark'")
    assert page.evaluate(ground) == dark
    button = page.get_by_role("button", name="Theme:")
    button.press("Enter")
    page.wait_for_function(f"() => {FOUND}?.theme === 'light' && {FOUND}.drawn_theme === 'light'")
    assert page.evaluate(ground) == light
    assert button.inner_text() == "Theme: light"
    page.reload()
    page.wait_for_function(f"() => {ground} === '{light}'")
    assert button.inner_text() == "Theme: light"
    button.press("Enter")
    page.emulate_media(color_scheme="light")
    assert page.evaluate(ground) == dark
