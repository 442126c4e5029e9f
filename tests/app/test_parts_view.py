"""The view of the parts: what every part is made of, its sheet beside what was typed of it and what the line has, its
ratings against loads; a part is made of a component of the catalogue and put back."""

from __future__ import annotations

import pytest
from served import Look

import trunnion as tn
from trunnion.app import shown
from trunnion.app.parts.document import Document
from trunnion.driveline.starter import starter

COMPONENT = "example/rubber-16"


def coupled() -> Document:
    """The two-shaft line with its first shaft made of a component."""
    document = Document(starter("two-shaft"))
    document.add_limit("Shaft 2")
    document.make_of(1, COMPONENT)
    return document


def test_a_part_is_made_of_a_component_and_what_is_said_of_others_stays() -> None:
    document = coupled()
    assert document.problems == ()
    made = document.line.elements[1]
    assert isinstance(made, tn.Coupling) and made.sheet == tn.component(COMPONENT).sheet
    assert document.line.limits[0].of == "Shaft 2"  # the second shaft is the only one now, and keeps its name
    assert document.line.names[4] == "Shaft 2"
    document.undo()
    assert isinstance(document.line.elements[1], tn.Shaft)


def test_the_sheet_stands_beside_what_was_typed_and_what_the_line_has() -> None:
    document = coupled()
    document.set_text(("element", 1, "nominal_torque"), "12 kN*m")
    document.set_text(("element", 1, "heat_rating"), "")
    found = shown.parts(document.line)
    [sheet] = found["sheets"]
    typed = tn.component(COMPONENT).sheet
    assert typed is not None and sheet["printed"] == typed.printed
    made = {key: (before, now, differs) for key, before, now, differs in sheet["made"]}
    assert made["stiffness"] == ("80 kN m/rad", "80 kN m/rad", "")
    assert made["nominal torque"] == ("16 kN m", "12 kN m", "differs")
    assert made["heat rating"] == ("450 W", "left out", "differs")
    assert [row[1] for row in found["rows"]] == list(document.line.names)


def test_ratings_are_those_of_the_assessment_part_by_part() -> None:
    line = coupled().line
    judged = tn.assess(line)
    found = shown.loads(judged)
    rows = {row[1]: row for row in found["rows"]}
    of_coupling = [one for one in judged.checks if one.element == "Coupling 1"]
    assert len(of_coupling) == 4 and all(rows[one.name][0] == "Coupling 1" for one in of_coupling)
    heat = next(one for one in of_coupling if "heat rating" in one.name)
    assert f"{heat.value:.4g} W against {line.elements[1].heat_rating:.4g} W" in rows[heat.name][-1]
    drawn = " ".join(found["picture"].panel.y.names)
    assert "heat rating" in drawn and "parametric stability" not in drawn  # of the whole line


@pytest.mark.slow
def test_in_the_browser_a_part_is_made_of_a_component(look: Look) -> None:
    look.at("?view=parts")
    page = look.page
    page.get_by_label("Component of the catalogue", exact=True).select_option(f"{COMPONENT}@1")
    page.get_by_text("C_Tdyn", exact=True).wait_for()
    page.get_by_label("Part", exact=True).select_option("Shaft 1")
    page.get_by_role("button", name="Make the part of it", exact=True).click()
    sheet = page.get_by_role("region", name=f"Coupling 1: {COMPONENT}")
    sheet.wait_for()
    assert sheet.get_by_text("80 kN m/rad").count() == 2  # as typed, and in the line
    page.get_by_text("heat rating of Coupling 1", exact=True).wait_for()
    look.view("Driveline")
    page.get_by_role("button", name="Undo", exact=True).first.click()
    look.view("Parts")
    page.get_by_text("No part of this line is made of a maker's sheet").wait_for()
