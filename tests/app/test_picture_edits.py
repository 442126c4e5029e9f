"""The picture is an editor: a part is clicked, or chosen by keyboard, and changed, moved, taken away or given a
neighbour beside it; undo takes back."""

from __future__ import annotations

import re
from typing import Any

import pytest
from served import Look
from test_live_view import FOUND, plays

pytest.importorskip("panel")

from trunnion.app.parts.document import Document
from trunnion.app.parts.editing import change_of
from trunnion.driveline.starter import starter


def test_what_is_inserted_goes_by_the_part_it_stands_beside() -> None:
    document = Document(starter("two-shaft"))
    group = next(one for one in document.groups() if one.path == ("element", 2))
    document.add_element(0, "Disk")  # the part has moved since its fields were read
    change_of({"do": "insert", "by": 1, "kind": "Disk", "path": list(group.path), "key": group.key})(document)
    kinds = [element["type"] for element in document.data["element"]]
    assert kinds[0] == kinds[4] == "Disk"
    assert kinds[1:4] + kinds[5:] == [element["type"] for element in Document(starter("two-shaft")).data["element"]]
    change_of({"do": "remove", "path": list(group.path), "key": group.key})(document)
    change_of({"do": "remove", "path": list(group.path), "key": group.key})(document)  # a second click meets nothing
    assert len(document.data["element"]) == len(kinds) - 1
    for _ in range(3):
        change_of({"do": "undo"})(document)
    assert document.data == Document(starter("two-shaft")).data


@pytest.mark.slow
def test_a_click_on_a_part_brings_its_fields(look: Look) -> None:
    look.page.set_default_timeout(60_000)
    look.at("?view=live")
    plays(look, "turning")
    page = look.page
    page.evaluate(f"{FOUND}.pause()")
    place = page.evaluate(
        f"""(() => {{ const p = {FOUND}, part = p.named.find(one => one.name === 'Disk 1')
        const [x, y] = p.pixel(part, p.high), box = p.canvas.getBoundingClientRect()
        return [box.left + x, box.top + y] }})()"""
    )
    page.mouse.click(*place)
    field = page.get_by_label("inertia of Disk 1", exact=True)
    field.wait_for()
    assert page.get_by_label("Part to change", exact=True).input_value() == "Disk 1"
    before = field.input_value()
    radius = f"{FOUND}.parts.find(one => one.name === 'Disk 1').size.radius"
    drawn = page.evaluate(radius)
    field.fill("40 kg*m^2")
    field.press("Enter")
    page.wait_for_function(f"() => {radius} > 1.3 * {drawn}")
    page.get_by_role("button", name="Undo", exact=True).click()
    page.wait_for_function(f"() => Math.abs({radius} - {drawn}) < 1e-6")
    assert field.input_value() == before


@pytest.mark.slow
def test_by_keyboard_a_part_is_chosen_given_a_neighbour_and_taken_away(look: Look) -> None:
    look.page.set_default_timeout(60_000)
    look.at("?view=live&live.part=Disk+1")
    plays(look, "turning")
    page = look.page
    page.get_by_label("inertia of Disk 1", exact=True).wait_for()
    count = page.evaluate(f"{FOUND}.named.length")
    page.get_by_label("kind of the new element", exact=True).select_option("Disk")
    page.get_by_role("button", name="Behind", exact=True).press("Enter")
    page.wait_for_function(f"() => {FOUND}.named.length === {count} + 1")
    page.get_by_label("Part to change", exact=True).select_option("Disk 2")
    page.get_by_role("button", name="remove Disk 2", exact=True).press("Enter")
    page.wait_for_function(f"() => {FOUND}.named.length === {count}")


@pytest.mark.slow
def test_an_element_is_dragged_to_another_place_and_back(look: Look) -> None:
    look.at()
    page = look.page
    heads = page.locator("[data-group^='element-'] .head")
    heads.first.wait_for()
    kinds = "rows => rows.map(row => row.querySelector('.kind').textContent)"

    def order() -> list[str]:
        return [str(one) for one in heads.evaluate_all(kinds)]

    before = order()
    last = len(before) - 1
    behind = {"target_position": {"x": 20, "y": 4}}
    heads.nth(1).drag_to(heads.nth(last), **behind)
    wanted = [before[0], *before[2:last], before[1], before[last]]
    assert wanted != before
    for _ in range(300):
        if order() == wanted:
            break
        page.wait_for_timeout(100)
    assert order() == wanted
    page.get_by_role("button", name="Undo", exact=True).click()
    page.wait_for_timeout(500)
    look.settled_anew()
    assert order() == before


def parts(page: Any) -> list[str]:
    """Names of the parts of the sketch, from the drive on."""
    return [str(one) for one in page.locator(".stage .part").evaluate_all("all => all.map(e => e.title)")]


def becomes(page: Any, wanted: list[str]) -> None:
    page.wait_for_function(
        """wanted => { const deep = root => [...root.querySelectorAll('*')].flatMap(e =>
          [...(e.matches('.stage .part') ? [e.title] : []), ...(e.shadowRoot ? deep(e.shadowRoot) : [])])
          return JSON.stringify(deep(document)) === JSON.stringify(wanted) }""",
        arg=wanted,
    )


def test_in_the_sketch_parts_are_dragged_put_between_and_taken_away(look: Look) -> None:
    """By dragging, and the same by keys: what comes of it is the order of the file."""
    look.at("?view=driveline")
    page = look.page
    page.set_default_timeout(90_000)
    page.locator(".stage .part").first.wait_for()
    first = parts(page)
    assert first == ["ConstantSpeed 1", "Shaft 1", "Disk 1", "HookeJoint 1", "Shaft 2", "load"]
    page.get_by_role("button", name="Disk 1, Disk", exact=True).drag_to(page.locator("[data-where='behind load']"))
    becomes(page, ["ConstantSpeed 1", "Shaft 1", "HookeJoint 1", "Shaft 2", "load", "Disk 2"])  # the second now
    page.get_by_role("button", name="Undo", exact=True).first.click()
    becomes(page, first)
    between = page.locator("[data-where='between Shaft 1 and Disk 1']")
    page.locator(".chip[data-kind=Coupling]").drag_to(between)
    becomes(page, [*first[:2], "Coupling 1", *first[2:]])
    page.get_by_role("button", name="Coupling 1, Coupling", exact=True).press("Alt+ArrowRight")
    becomes(page, [*first[:3], "Coupling 1", *first[3:]])
    page.get_by_role("button", name="Coupling 1, Coupling", exact=True).press("Delete")
    becomes(page, first)
    page.get_by_label("kind of the part to insert", exact=True).select_option("Disk")
    page.get_by_role("button", name="insert Disk between HookeJoint 1 and Shaft 2", exact=True).press("Enter")
    becomes(page, [*first[:4], "Disk 2", *first[4:]])
    page.get_by_role("button", name="Disk 2, Disk", exact=True).press("Enter")
    field = page.get_by_label("inertia of Disk 2", exact=True).first
    field.fill("2 kg*m^2")
    field.press("Enter")
    page.get_by_role("button", name="On a branch", exact=True).press("Enter")
    page.wait_for_function(
        """() => { const deep = root => [...root.querySelectorAll('*')].flatMap(e =>
          [...(e.matches('.stage .part') ? [e] : []), ...(e.shadowRoot ? deep(e.shadowRoot) : [])])
          return deep(document).length === 8 }"""
    )
    after = page.get_by_label(re.compile("^after of "))
    assert after.first.input_value() == "Disk 2"
    page.get_by_role("button", name="Undo", exact=True).first.click()
    page.get_by_role("button", name="Undo", exact=True).first.click()
    page.get_by_role("button", name="Undo", exact=True).first.click()
    becomes(page, first)
    chip, gap = page.locator(".chip[data-kind=Coupling]"), page.locator("[data-where='behind load']")
    dragged = "(part, kind) => part.dispatchEvent(new DragEvent(kind, {dataTransfer: new DataTransfer()}))"
    chip.evaluate(dragged, "dragstart")
    page.get_by_role("button", name="Disk 1, Disk", exact=True).press("Delete")  # the sketch changes under the hand
    page.wait_for_timeout(4_000)
    assert parts(page) == first
    gap.evaluate(dragged, "drop")
    becomes(page, ["ConstantSpeed 1", "Shaft 1", "HookeJoint 1", "Shaft 2", "load", "Coupling 1"])
