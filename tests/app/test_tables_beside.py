"""Lines whose files name tables and components that lie beside them, in the application: its pages, addresses, kept
variants and saved files hold text alone."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from served import IDLE, ROOT, WAIT, start_server

import trunnion as tn
from trunnion.app.parts.document import Document
from trunnion.cli.app import _text as text_for_pages

LINE = """\
# of two tables, a component and a torque over time
format = 1
[operation]
speed = "900 rpm"
[[scenario]]
name = "switched on"
duration = "1 s"
speed = "0 rpm"
[[scenario.torque]]
on = "motor"
file = "start.csv"
[[element]]
type = "Disk"
name = "motor"
inertia = "0.5 kg*m^2"   # with its fan
excitation = "orders.csv"
[[element]]
component = "maker/soft"
name = "coupling"
[[element]]
type = "Disk"
name = "pump"
inertia = "0.3 kg*m^2"
"""
COMPONENTS = """\
format = 1
source = "a sheet"
date = "2020-01"
[[component]]
name = "soft"
type = "Shaft"
version = 1
[component.printed]
"C" = "2 kNm/rad"
[component.numbers]
stiffness = "2 kN*m/rad"
damping = "1 N*m*s/rad"
"""


@pytest.fixture
def line(tmp_path: Path) -> Path:
    """The file in a folder with all that it names."""
    (tmp_path / "components").mkdir()
    (tmp_path / "components" / "maker.toml").write_text(COMPONENTS, encoding="utf-8")
    (tmp_path / "orders.csv").write_text("order,amplitude [N*m]\n1,30\n2,20\n", encoding="utf-8")
    (tmp_path / "start.csv").write_text("time [s],torque [N*m]\n0,50\n1,60\n", encoding="utf-8")
    file = tmp_path / "line.toml"
    file.write_text(LINE, encoding="utf-8")
    return file


def test_a_page_begins_with_the_line_of_the_file_and_its_comments(line: Path) -> None:
    text = text_for_pages(str(line))
    found, whole = tn.loads(text), tn.load(line)
    assert found == whole
    assert [one.order for one in found.elements[0].excitation] == [1, 2]
    assert found.elements[1].stiffness == 2000
    assert found.scenarios[0].torque[0].torque == (50, 60)
    assert "# of two tables" in text and "# with its fan" in text
    assert ".csv" not in text


@pytest.mark.parametrize("file", sorted((ROOT / "examples").glob("*.toml")), ids=lambda file: file.stem)
def test_every_example_begins_as_its_own_line(file: Path) -> None:
    text = text_for_pages(str(file))
    assert tn.loads(text) == tn.load(file)
    if ".csv" not in file.read_text(encoding="utf-8").partition("[[element]]")[2]:
        assert text == file.read_text(encoding="utf-8")


def test_what_is_edited_kept_and_saved_needs_no_folder(line: Path) -> None:
    document = Document(text_for_pages(str(line)))
    place = ("element", 2, "inertia")
    document.set_text(place, "0.4 kg*m^2")
    assert not document.problems
    saved = document.file().text
    assert tn.loads(saved) == tn.load(line).replace("pump", inertia=0.4)
    assert "# with its fan" in saved
    document.undo()
    assert document.line == tn.load(line)
    assert tn.loads(document.toml) == tn.load(line)


def test_a_file_from_the_browser_that_names_a_table_is_refused_with_the_way_to_open_it() -> None:
    document = Document(tn.dumps(tn.catalogue("two-shaft-cardan")))
    before = document.line
    text = LINE.replace('component = "maker/soft"', 'type = "Shaft"\nstiffness = 2000.0')
    with pytest.raises(tn.InputError) as refused:
        document.replace_text(text.partition("[[scenario]]")[0] + text[text.index("[[element]]") :])
    assert "motor (element 1).excitation = 'orders.csv'" in str(refused.value)
    assert "trunnion app FILE" in str(refused.value)
    assert document.line == before


def test_an_engine_with_its_pressures_beside_it_opens(browser: Any) -> None:
    server = start_server(str(ROOT / "examples" / "six-cylinder-ship.toml"))
    context = browser.new_context()
    try:
        page = context.new_page()
        page.set_default_timeout(WAIT)
        page.goto(server.address + "?view=driveline")
        page.wait_for_selector(f"{IDLE}, .alert, pre:has-text('Traceback')")
        assert page.get_by_text("Traceback").count() == 0
        assert page.get_by_label("firing order").input_value() == "1-5-3-6-2-4"
    finally:
        context.close()
        server.stop()
