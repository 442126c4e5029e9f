"""Kept variants: named, judged beside each other, shown beside the present line or on its axes, restored by the address
with the comments of their files."""

from __future__ import annotations

import asyncio
from html import escape
from urllib.parse import parse_qs

import pytest

pytest.importorskip("panel")

from test_whose_result import Held, on_session, settled, turn

import trunnion as tn
from trunnion.app.address import unpack
from trunnion.app.parts.variant_strip import MOST_SHOWN, UPON
from trunnion.app.session import JUDGED_AFTER, NOW, Session
from trunnion.driveline.starter import starter
from trunnion.pictures.looks import look
from trunnion.pictures.overlaid import largest, overlaid
from trunnion.pictures.picture import Axis, Key, Level, Line, Panel, Picture, Points


def own_panel(made: Session) -> object:
    """Of the present line in the visible view."""
    return made.view.of(NOW).panel


def test_variants_are_named_shown_on_the_same_axes_and_told_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    async def work(made: Session, pool: Held) -> None:
        made.show_view("orders")
        await settled(made)
        made.keep("as built")
        await settled(made)
        turn(made, "7 deg")
        await settled(made)
        made.keep("")
        assert [one.name for one in made.variants] == ["as built", "variant 1"]
        assert len(made.page.main.objects[-2]) == 3  # beside each other
        made.drop(made.variants[1].key)
        made.arrange_variants(UPON)
        await settled(made)
        assert made.view.upon in made.page.main.objects
        assert own_panel(made) in made.page.main.objects[-2].objects
        own, other = (made.view.of(key).canvases for key in (NOW, made.variants[0].key))
        place = next(name for name, canvas in own.items() if canvas.own and canvas.others)
        drawn = overlaid(own[place].own[0], own[place].others)
        kept = [item for item in drawn.panel.items if getattr(item, "role", "").startswith("of variant 0")]
        assert len(kept) >= 2
        assert Key("variant 0", "as built") in drawn.panel.items
        peaks = {one.curve: one for one in largest(own[place].own[0], other[place].own[0])}
        assert peaks
        assert "12 deg" in made.difference.object
        assert "<td>as built</td>" in made.view.upon.object
        made.compare_all_no_more()
        await settled(made)
        assert not own[place].others and not made.view.upon.object

    on_session(work, monkeypatch)


def test_the_strip_says_the_verdict_of_each_line_and_swaps_them(monkeypatch: pytest.MonkeyPatch) -> None:
    async def work(made: Session, pool: Held) -> None:
        made.keep("first")
        turn(made, "2 deg")
        await asyncio.sleep(2 * JUDGED_AFTER)
        await settled(made)
        for _ in range(200):
            if "not yet" not in made.variants[0].verdict and made.verdict[0] == made.document.toml:
                break
            await asyncio.sleep(0.05)
        sentences = [tn.assess(tn.loads(toml)).sentence for toml in (made.variants[0].toml, made.document.toml)]
        assert escape(sentences[0]) in made.variants[0].verdict and escape(sentences[1]) in made.verdict[1]
        before = made.document.toml
        made.swap(made.variants[0].key)
        await settled(made)
        assert made.variants[0].toml == before
        assert made.document.line == tn.loads(starter("two-shaft"))

    on_session(work, monkeypatch)


def test_the_address_keeps_comments_and_every_variant(monkeypatch: pytest.MonkeyPatch) -> None:
    text = starter("two-shaft").replace("[operation]", "# measured in May\n[operation]", 1)
    found: dict[str, str] = {}

    async def work(made: Session, pool: Held) -> None:
        made.edit(lambda document: document.replace_text(text))
        made.keep("before")
        turn(made, "7 deg")
        await settled(made)
        found.update({key: values[0] for key, values in parse_qs(made.location.search[1:]).items()})

    async def again(made: Session, pool: Held) -> None:
        assert "# measured in May" in made.document.file().text
        assert "7 deg" in made.document.file().text
        assert [(one.name, one.is_shown) for one in made.variants] == [("before", True)]
        assert "# measured in May" in made.variants[0].file
        made.swap(made.variants[0].key)
        await settled(made)
        assert made.document.file().text == text

    on_session(work, monkeypatch)
    assert "# measured in May" in unpack(found["line"])
    on_session(again, monkeypatch, **found)


def test_no_more_are_shown_than_can_be_told_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    async def work(made: Session, pool: Held) -> None:
        for _ in range(MOST_SHOWN + 3):
            made.keep("")
        assert sum(one.is_shown for one in made.variants) == MOST_SHOWN
        made.keep("one too many")
        assert "drop one first" in made.page.said.object
        made.show_variant(made.variants[-1].key, True)
        assert not made.variants[-1].is_shown and "hide one first" in made.page.said.object
        assert len({one.name for one in made.variants}) == len(made.variants)
        await settled(made)

    on_session(work, monkeypatch)


def test_only_what_has_the_same_axes_is_laid_upon_another() -> None:
    speed, torque = Axis("speed", "rpm", 0.0, 10.0), Axis("torque", "N m", 0.0, 5.0)
    own = Picture((Panel(speed, torque, (Line([0, 10], [1, 2], "curve 0", "tube"),)), Panel(speed, torque, ())))
    more = Line([0, 5, 10], [0, -8, 3], "curve 0", "tube")
    higher = Axis("torque", "N m", -9.0, 9.0)
    other = Picture(
        (Panel(speed, higher, (more, Points([1], [1], "start"), Level(3.0, "zero"))), Panel(torque, speed, ()))
    )
    both = overlaid(own, [("b", other)])
    assert (both.panel.y.low, both.panel.y.high) == (-9.0, 9.0)
    assert len(both.panel.items) == 1 + 3 + 1
    assert both.panels[1] == own.panels[1]
    (peak,) = largest(own, other)
    assert (peak.now, peak.at, peak.other, peak.other_at, peak.share) == (2.0, 10.0, -8.0, 5.0, -1.25)
    modes = Picture((Panel(speed, torque, (Line([0, 1], [1, 1], "mode", "mode"), Line([0, 1], [2, 2], "mode"))),))
    assert list(largest(modes, modes)) == []
    assert look("of variant 1: curve 3").colour == look("curve 3").colour
    assert look("of variant 1: curve 3").dash != look("of variant 0: curve 3").dash


def test_what_a_variant_had_under_other_settings_is_not_laid_upon_the_new(monkeypatch: pytest.MonkeyPatch) -> None:
    async def work(made: Session, pool: Held) -> None:
        made.show_view("orders")
        await settled(made)
        made.keep("")
        made.arrange_variants(UPON)
        await settled(made)
        own = made.view.of(NOW).canvases
        laid = [name for name, canvas in own.items() if canvas.others]
        assert laid
        pool.held.clear()
        made.view.put("speed", 900.0)
        old = [name for name in laid if not made.view.of(NOW).is_up_to_date(own[name])]
        assert old
        assert all(not own[name].others for name in old)
        pool.held.set()
        await settled(made)
        assert all(own[name].others for name in laid)

    on_session(work, monkeypatch)


def test_a_verdict_whose_search_was_cancelled_is_looked_for_again(monkeypatch: pytest.MonkeyPatch) -> None:
    async def work(made: Session, pool: Held) -> None:
        made.keep("")
        await asyncio.sleep(0.1)
        made.cancel()
        await asyncio.sleep(0.1)
        assert made.variants[0].verdict == "" and made.verdict == ("", "")
        turn(made, "7 deg")
        await settled(made)
        for _ in range(400):
            if made.variants[0].verdict and "not yet checked" not in made.variants[0].verdict:
                break
            await asyncio.sleep(0.05)
        assert escape(tn.assess(tn.loads(starter("two-shaft"))).sentence) in made.variants[0].verdict

    on_session(work, monkeypatch)
