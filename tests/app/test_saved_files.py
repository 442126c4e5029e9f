"""Saving a line keeps the comments, order and layout of its file where nothing changed."""

from __future__ import annotations

import shutil
import tomllib
import warnings
from collections import Counter
from copy import deepcopy
from pathlib import Path

import numpy as np
import pytest

import trunnion as tn
from trunnion.app.parts.document import Document
from trunnion.driveline.rewriting import rewritten

FILE = """\
# Test rig, hall 3
format = 1            # of the file
name = "rig"

# ---- how it runs ----

[operation]
speed_range = [ "600 rpm",   "2400 rpm" ]   # from the log
speed = "1500 rpm"

# the long hill
[[operation.load_case]]
name = "climb"
loads = { "wheel" = "250 N*m" }   # estimated

# ---- the line ----

# the motor
[[element]]
type = "ConstantSpeed"

[[element]]   # first tube
type = "Shaft"
stiffness = "12 kN*m/rad"    # drawing 17
damping = "3 N*m*s/rad"

# the flywheel
[[element]]
type = "Disk"
inertia = "0.4 kg*m^2"   # measured

# the second flywheel, its twin
[[element]]
type = "Disk"
inertia = "0.4 kg*m^2"   # from the catalogue

[[element]]
type = "HookeJoint"
angle = "12 deg"
# to be checked

[[element]]
type = "Clutch"
stiffnesses = [
  "800 N*m/rad",   # first stage
  "2 kN*m/rad",
]
breakpoints = ["3 deg"]

[[element.friction]]   # dry
torque = "6 N*m"
stiffness = "4 kN*m/rad"

[[element]]
type = "Disk"
name = "wheel"
inertia = "0.9 kg*m^2"

[[limit]]
of = "Shaft 1"
vibratory_torque = "500 N*m"   # agreed

# end of the file
"""


@pytest.fixture
def document() -> Document:
    return Document(FILE)


def changed(before: str, after: str) -> tuple[set[str], set[str]]:
    """Lines that the one has oftener, and that the other has oftener; empty ones apart."""
    one, other = Counter(before.splitlines()), Counter(after.splitlines())
    return set(one - other) - {""}, set(other - one) - {""}


def saved(document: Document) -> str:
    """The file, which says what the document says."""
    assert not document.problems
    found = document.file()
    assert found.lost == ""
    assert tomllib.loads(found.text) == document.data
    return found.text


def test_what_is_opened_is_saved_as_it_was(document):
    assert saved(document) == FILE
    document.set_text(("element", 1, "stiffness"), "14 kN*m/rad")
    document.undo()
    assert saved(document) == FILE


def test_a_number_changes_its_line_alone(document):
    document.set_text(("element", 1, "stiffness"), "14 kN*m/rad")
    assert changed(FILE, saved(document)) == (
        {'stiffness = "12 kN*m/rad"    # drawing 17'},
        {'stiffness = "14 kN*m/rad"    # drawing 17'},
    )


def test_a_slider_changes_its_line_alone(document):
    document.set_numbers(document.line.replace("Shaft 1", stiffness=14e3), "slider")
    document.set_numbers(document.line.replace("Shaft 1", stiffness=15e3), "slider")
    found = document.file()
    assert tn.loads(found.text) == document.line
    assert changed(FILE, found.text) == (
        {'stiffness = "12 kN*m/rad"    # drawing 17'},
        {'stiffness = "15 kN*m/rad"    # drawing 17'},
    )


def test_inline_tables_and_lists_of_several_lines_keep_their_comments(document):
    document.set_text(("operation", "load_case", 0, "loads", "wheel"), "300 N*m")
    document.set_text(("element", 5, "stiffnesses"), '["900 N*m/rad", "2 kN*m/rad"]')
    document.set_text(("element", 5, "friction", 0, "torque"), "7 N*m")
    assert changed(FILE, saved(document)) == (
        {'loads = { "wheel" = "250 N*m" }   # estimated', '  "800 N*m/rad",   # first stage', 'torque = "6 N*m"'},
        {'loads = { "wheel" = "300 N*m" }   # estimated', '  "900 N*m/rad",   # first stage', 'torque = "7 N*m"'},
    )


@pytest.mark.parametrize("twin", [2, 3])
def test_of_twins_the_one_that_is_removed_takes_its_comments_along(document, twin):
    document.remove(("element", twin))
    gone, come = changed(FILE, saved(document))
    heading, note = [("# the flywheel", "# measured"), ("# the second flywheel, its twin", "# from the catalogue")][
        twin - 2
    ]
    assert gone == {heading, "[[element]]", f'inertia = "0.4 kg*m^2"   {note}', 'type = "Disk"'}
    assert come == set()


def test_a_moved_element_takes_its_comments_along_and_headings_stay(document):
    document.move(4, -1)
    text = saved(document)
    gone, come = changed(FILE, text)
    assert gone == set()
    assert come == set()
    order = ["# ---- the line", "# the motor", "# drawing 17", "# the fly", "# to be", "# the second", "# from the cat"]
    places = [text.index(one) for one in order]
    assert places == sorted(places)


def test_the_first_element_stands_below_its_heading(document):
    document.remove(("element", 0))
    document.add_element(0, "Disk")
    text = saved(document)
    assert changed(FILE, text)[0] == {"# the motor", 'type = "ConstantSpeed"'}
    assert text.index("# ---- the line") < text.index('type = "Disk"') < text.index("# first tube")


def test_an_added_element_stands_at_its_place(document):
    document.add_element(4, "Shaft")
    gone, come = changed(FILE, saved(document))
    assert gone == set()
    assert come == {"[[element]]", 'damping = "3 N*m*s/rad"', 'stiffness = "12 kN*m/rad"', 'type = "Shaft"'}
    assert [one["type"] for one in tomllib.loads(saved(document))["element"]][3:6] == ["Disk", "Shaft", "HookeJoint"]


def test_a_renamed_element_keeps_its_comments(document):
    document.set_text(("element", 2, "name"), "flywheel")
    assert changed(FILE, saved(document)) == (set(), {'name = "flywheel"'})


def test_cases_and_limits_come_and_go(document):
    document.add_load_case()
    document.add_limit("Clutch 1")
    document.remove(("operation", "load_case", 0))
    gone, come = changed(FILE, saved(document))
    assert gone == {"# the long hill", 'loads = { "wheel" = "250 N*m" }   # estimated', 'name = "climb"'}
    assert 'name = "load 1"' in come
    assert "# ---- how it runs ----" in saved(document)
    assert saved(document).endswith("# end of the file\n")


def test_undo_brings_a_removed_table_back_with_its_comments(document):
    document.remove(("element", 3))
    document.set_text(("element", 1, "damping"), "4 N*m*s/rad")
    document.undo()
    document.undo()
    assert saved(document) == FILE


def test_what_is_refused_is_not_saved(document):
    document.set_text(("element", 1, "stiffness"), "12 kg")
    assert document.problems
    assert document.file().text == FILE


def test_a_component_stays_named_until_its_numbers_change():
    component = '[[element]]\ncomponent = "example/rubber-16"  # as bought\n'
    file = FILE.replace('[[element]]\ntype = "HookeJoint"', f'{component}\n[[element]]\ntype = "HookeJoint"')
    document = Document(file)
    document.set_text(("element", 1, "damping"), "4 N*m*s/rad")
    assert component in document.file().text
    document.set_text(("element", 4, "stiffness"), "70 kN*m/rad")
    text = document.file().text
    assert tomllib.loads(text) == document.data
    assert 'component = "example/rubber-16"  #' not in text
    assert "[element.sheet" in text
    assert "# ---- the line ----" in text


def test_another_file_brings_its_own_comments(document):
    document.replace_text("# mine\n" + FILE)
    document.set_text(("element", 2, "inertia"), "0.5 kg*m^2")
    assert document.file().text.startswith("# mine\n# Test rig")
    document.begin_empty()
    assert document.file().text.startswith("# mine")  # the last line that is one
    for place, kind in enumerate(["ConstantSpeed", "Shaft", "Disk"]):
        document.add_element(place, kind)
    assert "#" not in saved(document)


SCENARIO = """
# rush hour
[[scenario]]
name = "pull away"   # one
[[scenario.torque]]
at = "wheel"  # here
[scenario.torque.points]
t = [0, 1]   # s

# at night
[[scenario]]
name = "cruise"
a.b = 1 # dotted
text = '''
[[element]]
# no comment
'''
"""


def test_tables_within_tables_and_texts_of_several_lines():
    before = tomllib.loads(SCENARIO)
    data = tomllib.loads(SCENARIO)
    data["scenario"][0]["torque"][0]["points"]["t"][1] = 2
    data["scenario"][1]["a"]["b"] = 2
    data["scenario"][1]["more"] = [{"x": 1}]
    found = rewritten(SCENARIO, data)
    assert tomllib.loads(found.text) == data
    assert changed(SCENARIO, found.text) == (
        {"t = [0, 1]   # s", "a.b = 1 # dotted"},
        {"t = [0, 2]   # s", "a.b = 2 # dotted", "[[scenario.more]]", "x = 1"},
    )
    assert rewritten(SCENARIO, before).text == SCENARIO


def test_dispersed_tables_stay_dispersed():
    file = "[[operation.case]]\nname = 1 # a\n\n[x]\ny = 1\n\n[[operation.case]]\nname = 2 # b\n"
    found = rewritten(file.replace("[[operation.case]]\nname = 2", "[operation.late]\nname = 2"), {
        "x": {"y": 1}, "operation": {"case": [{"name": 3}], "late": {"name": 2}, "speed": 5},
    })  # fmt: skip
    assert "name = 3 # a" in found.text
    assert tomllib.loads(found.text)["operation"]["speed"] == 5


def test_what_cannot_be_mapped_is_written_plainly_and_says_so():
    file = "a = { b = 1 } # kept\n[c] # c\nd.e = 1\n"
    data = {"a": {"b": float("nan")}, "c": {"d": {"e": 1}}}  # no comparison shows that it was written right
    found = rewritten(file, data)
    assert found.lost
    assert found.text.startswith(f"# {found.lost}\n")
    assert tomllib.loads(found.text)["c"] == data["c"]


def test_lines_end_as_they_did():
    file = FILE.replace("\n", "\r\n")
    data = tomllib.loads(file)
    data["element"][1]["damping"] = 4
    text = rewritten(file, data).text
    assert tomllib.loads(text) == data
    assert "# the second flywheel, its twin\r\n" in text


@pytest.mark.parametrize("seed", range(40))
def test_any_change_reads_as_it_should_and_comments_go_only_with_their_tables(seed):
    rng = np.random.default_rng(seed)
    old = tomllib.loads(FILE)
    order = [int(k) for k in rng.permutation(len(old["element"]))][: int(rng.integers(1, 8))]
    data = deepcopy(old)
    data["element"] = [deepcopy(old["element"][k]) for k in order]
    same: list[int | None] = list(order)
    for _ in range(int(rng.integers(0, 3))):
        place = int(rng.integers(0, len(same) + 1))
        data["element"].insert(place, {"type": "Disk", "inertia": 0.1 * place, "curve": [{"speed": 1}]})
        same.insert(place, None)
    if rng.random() < 0.5:
        del data["limit"]
    if rng.random() < 0.5:
        del data["operation"]["load_case"]
    found = rewritten(FILE, data, {("element",): same})
    assert tomllib.loads(found.text) == data
    assert found.lost == ""
    notes = {1: "# first tube", 2: "# measured", 3: "# from the catalogue", 4: "# to be checked", 5: "# dry"}
    for place, note in notes.items():
        assert (note in found.text) == (place in order)
    heads = {"# Test rig, hall 3", "# ---- how it runs ----", "# ---- the line ----", "# end of the file"}
    assert all(found.text.count(one) == 1 for one in heads)
    places = [found.text.index(notes[k]) for k in order if k in notes]
    assert places == sorted(places)


LISTED = """\
format = 1   # of the file
element = [
  { type = "ConstantSpeed" },
  # first tube
  { type = "Shaft", stiffness = "12 kN*m/rad", name = "a } b" },   # drawing 17

  # the flywheel
  # of the maker
  { type = "Disk", inertia = "0.4 kg*m^2", excitation = [{ order = 1, amplitude = 2 }, { order = 2, amplitude = 3 }] },
  { type = "HookeJoint", angle = "12 deg" }, # dry
  { type = "Disk", inertia = "0.4 kg*m^2" }  # last
  # end of the list
]

[operation]
speed = "1500 rpm"   # from the log
"""
LISTED_NOTES = {
    1: ["# first tube", "# drawing 17"],
    2: ["# the flywheel", "# of the maker"],
    3: ["# dry"],
    4: ["# last"],
}


@pytest.mark.parametrize("seed", range(40))
def test_a_list_of_one_element_a_line_keeps_its_lines(seed: int) -> None:
    rng = np.random.default_rng(seed)
    old = tomllib.loads(LISTED)
    order = [int(k) for k in rng.permutation(5)][: int(rng.integers(1, 6))]
    data = deepcopy(old)
    data["element"] = [deepcopy(old["element"][k]) for k in order]
    touched = [k for k in order if rng.random() < 0.3]
    for k in touched:
        data["element"][order.index(k)]["name"] = f"new # {k}"
    same: list[int | None] = list(order)
    for _ in range(int(rng.integers(0, 3))):
        place = int(rng.integers(0, len(same) + 1))
        data["element"].insert(place, {"type": "Disk", "inertia": 0.1 * place, "curve": [{"speed": 1}]})
        same.insert(place, None)
    found = rewritten(LISTED, data, {("element",): same})
    assert tomllib.loads(found.text) == data
    assert found.lost == ""
    lines = LISTED.splitlines()
    for k, notes in LISTED_NOTES.items():
        assert all((note in found.text) == (k in order) for note in notes)
    for k in set(order) - set(touched) - {4}:  # the last one had no comma
        own = next(line for line in lines if line.lstrip().startswith("{") and f'"{old["element"][k]["type"]}"' in line)
        assert own in found.text
    assert "# end of the list\n]" in found.text
    assert "# of the file" in found.text
    assert "# from the log" in found.text
    items = [line for line in found.text.splitlines() if line.startswith("  {")]
    assert len(items) == len(data["element"])


def test_other_lists_of_elements_say_what_they_lose() -> None:
    """Elements that share a line cannot be told apart by lines; without comments nothing is lost."""
    file = 'element = [{ type = "Disk", inertia = 1 }, # one\n{ type = "Disk", inertia = 2 }]\n'
    data = {"element": [{"type": "Disk", "inertia": 2}]}
    assert rewritten(file, data).lost == "comments between the keys of element could not be kept"
    found = rewritten(file.replace("# one", ""), data)
    assert (tomllib.loads(found.text), found.lost) == (data, "")


def test_an_element_of_a_list_keeps_the_name_of_its_component() -> None:
    file = 'element = [\n  { component = "tube" }, # bought\n  { type = "Disk", inertia = 1 },\n]\n'

    def expanded(table: dict[str, object]) -> dict[str, object]:
        return {"type": "Shaft", "stiffness": 5} if table.get("component") else table

    tube, disk = {"type": "Shaft", "stiffness": 5}, {"type": "Disk", "inertia": 1}
    heavier = disk | {"inertia": 2}
    for wanted, same in (
        ([disk, tube], [1, 0]),
        ([tube], [0]),
        ([tube, heavier], [0, 1]),
        ([disk, heavier, tube], [1, None, 0]),
    ):
        found = rewritten(file, {"element": wanted}, {("element",): same}, expanded)
        assert '{ component = "tube" }, # bought' in found.text
        assert [expanded(one) for one in tomllib.loads(found.text)["element"]] == wanted


def test_listed_lines_end_as_they_did() -> None:
    file = LISTED.replace("\n", "\r\n")
    data = tomllib.loads(file)
    del data["element"][3]
    text = rewritten(file, data).text
    assert tomllib.loads(text) == data
    assert "\n" not in text.replace("\r\n", "")


def test_a_line_is_written_over_its_file_and_keeps_its_comments(tmp_path):
    place = tmp_path / "line.toml"
    place.write_text(FILE)
    line = tn.load(place).replace("Shaft 1", stiffness=14e3)
    tn.dump(line, place, comments_of=place)
    assert changed(FILE, place.read_text()) == (
        {'stiffness = "12 kN*m/rad"    # drawing 17'},
        {'stiffness = "14 kN*m/rad"    # drawing 17'},
    )
    assert tn.load(place) == line
    assert [one.name for one in tmp_path.iterdir()] == ["line.toml"]


def test_every_example_is_written_over_itself_as_it_was(tmp_path):
    examples = Path(__file__).parents[2] / "examples"
    for one in (*examples.glob("*.toml"), *examples.glob("*.csv")):
        shutil.copy(one, tmp_path)
    for file in sorted(tmp_path.glob("*.toml")):
        text = file.read_text()
        line = tn.load(file)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            tn.dump(line, file, comments_of=file)
        assert file.read_text() == text


def test_a_component_of_a_folder_is_written_out_elsewhere(tmp_path):
    place = tmp_path / "line.toml"
    component = '[[element]]\ncomponent = "example/rubber-16"  # as bought\n'
    place.write_text(FILE.replace('[[element]]\ntype = "HookeJoint"', f'{component}\n[[element]]\ntype = "HookeJoint"'))
    line = tn.load(place)
    (tmp_path / "away").mkdir()
    for target, named in ((place, True), (tmp_path / "away" / "line.toml", False)):
        tn.dump(line, target, comments_of=place)
        assert (component in target.read_text()) == named
        assert tn.load(target) == line
