"""The line under edit: what is refused stands beside its field, and the views keep what was accepted."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace

import pytest

pytest.importorskip("panel")

import trunnion as tn
from trunnion.app.address import pack, unpack
from trunnion.app.parts.calls import LINE, Call, script
from trunnion.app.parts.document import Document
from trunnion.app.parts.form import FieldGroup
from trunnion.app.parts.variants import Sliders, difference
from trunnion.app.views.driveline import DrivelineView
from trunnion.driveline.files import dumps, loads
from trunnion.driveline.starter import STARTERS, starter
from trunnion.errors import InputError


def fields(document: Document) -> dict[tuple[str | int, ...], tuple[str, str]]:
    """Text and message of every field, by its path."""
    return {f.path: (f.text, f.message) for g in document.groups() for f in g.fields}


@pytest.mark.parametrize("name", STARTERS)
def test_every_field_reads_back_as_it_is_shown(name: str) -> None:
    document = Document(starter(name))
    line = document.line
    for path, (text, message) in fields(document).items():
        assert message == ""
        document.set_text(path, text)
    assert document.problems == ()
    assert document.line == line


def test_a_refused_text_stays_in_its_field_and_the_line_stays() -> None:
    document = Document(starter("two-shaft"))
    before = document.line
    document.set_text(("element", 1, "stiffness"), "12 parsec")
    text, message = fields(document)["element", 1, "stiffness"]
    assert text == "12 parsec"
    assert "unknown unit" in message
    assert document.line is before
    assert document.undo()
    assert fields(document)["element", 1, "stiffness"] == ("12 kN*m/rad", "")


@pytest.mark.parametrize(
    ("path", "text"),
    [
        (("element", 1, "stiffness"), "-3 N*m/rad"),
        (("element", 3, "angle"), ""),
        (("element", 2, "name"), "load"),
        (("operation", "speed"), "-5 rpm"),
        (("operation", "speed_range", 0), "9000 rpm"),
        (("element", 4, "after"), "nowhere"),
    ],
)
def test_every_refusal_is_said_somewhere(path: tuple[str | int, ...], text: str) -> None:
    document = Document(starter("two-shaft"))
    document.set_text(path, text)
    assert document.problems
    said = [f.message for g in document.groups() for f in g.fields] + [g.message for g in document.groups()]
    assert any(said)


def case_fields(document: Document) -> dict[str, tuple[str, str]]:
    """Text and message of the fields of the load cases, by label and group."""
    groups = [g for g in document.groups() if g.kind == "load case"]
    return {f"{f.label} of {g.title}": (f.text, f.message) for g in groups for f in g.fields}


def test_a_load_case_has_a_factor_for_every_machine() -> None:
    text = dumps(
        tn.Driveline(
            [tn.ConstantSpeed(), tn.Shaft(stiffness=1e4), tn.Fan(inertia=2.0, quadratic_load=0.01, name="fan")]
        )
    )
    document = Document(text)
    document.add_load_case()
    place = ("operation", "load_case", 0)
    document.set_text((*place, "factors", "fan"), "1.3")
    assert dict(document.line.operation.load_cases[0].factors) == {"fan": 1.3}
    group = next(one for one in document.groups() if one.path == place)
    assert [one.label for one in group.fields] == ["name", "factor on the torque of fan"]


def test_a_load_case_has_a_field_for_its_name_and_for_every_disk() -> None:
    document = Document(starter("two-shaft"))
    document.add_load_case()
    assert case_fields(document) == {
        "name of load case load 1": ("load 1", ""),
        "torque at Disk 1 of load case load 1": ("", ""),
        "torque at load of load case load 1": ("100 N*m", ""),
    }
    place = ("operation", "load_case", 0)
    document.set_text((*place, "loads", "Disk 1"), "-20 N*m")
    document.set_text((*place, "name"), "coast")
    document.add_load_case()
    assert [(c.name, dict(c.loads)) for c in document.line.operation.load_cases] == [
        ("coast", {"Disk 1": -20.0, "load": 100.0}), ("load 1", {"load": 100.0}),
    ]  # fmt: skip
    document.set_text((*place, "loads", "load"), "")
    document.remove(("operation", "load_case", 1))
    assert [dict(c.loads) for c in document.line.operation.load_cases] == [{"Disk 1": -20.0}]
    document.remove(place)
    assert document.line == Document(starter("two-shaft")).line


@pytest.mark.parametrize(
    ("path", "text", "said"),
    [
        (("loads", "Disk 1"), "5 parsec", "torque at Disk 1 of load case load 1"),
        (("loads", "load"), "nan N*m", "torque at load of load case load 1"),
        (("name",), "", "name of load case "),
    ],
)
def test_a_refused_load_is_said_beside_its_field(path: tuple[str, ...], text: str, said: str) -> None:
    document = Document(starter("two-shaft"))
    document.add_load_case()
    document.set_text(("operation", "load_case", 0, *path), text)
    assert case_fields(document)[said][1]
    assert not any(g.message for g in document.groups())


def test_a_load_of_no_disk_keeps_its_field() -> None:
    """A disk that lost its name leaves a load behind, which can be taken away where it stands."""
    document = Document(starter("two-shaft"))
    document.add_load_case()
    document.set_text(("element", 5, "name"), "wheel")
    assert "not a Disk" in case_fields(document)["torque at load of load case load 1"][1]
    document.set_text(("operation", "load_case", 0, "loads", "load"), "")
    assert document.problems == ()


def test_the_application_is_chosen_and_left_open_again() -> None:
    document = Document(starter("two-shaft"))
    (field,) = [f for g in document.groups() for f in g.fields if f.label == "application"]
    assert (field.text, field.choices[0], "steering" in field.choices) == ("", "", True)
    document.set_text(field.path, "steering")
    assert document.line.operation.application == "steering"
    document.set_text(field.path, "")
    assert document.line == Document(starter("two-shaft")).line


def test_a_rule_is_switched_off_with_a_reason_or_not_at_all() -> None:
    """Until the reason is given the line stays as it was, and the field says why."""
    document = Document(starter("two-shaft"))

    def fields() -> dict[str, tuple[str, str]]:
        return {f.label: (f.text, f.message) for g in document.groups() if g.kind == "switched off" for f in g.fields}

    document.switch_off()
    assert fields()["rule"] == ("spicer-angles", "") and "gives no reason" in fields()["reason"][1]
    assert document.line.operation.switched_off == () and document.problems
    place = ("operation", "switched_off", 0)
    document.set_text((*place, "reason"), "[2] joints at a hand's speed")
    assert [str(one) for one in document.line.operation.switched_off] == ["spicer-angles: [2] joints at a hand's speed"]
    document.switch_off()
    document.set_text(("operation", "switched_off", 1, "rule"), "spicer-angles")
    document.set_text(("operation", "switched_off", 1, "reason"), "again")
    assert any("is switched off 2 times" in g.message for g in document.groups())
    document.remove(("operation", "switched_off", 1))
    document.remove(place)
    assert document.line == Document(starter("two-shaft")).line


def test_slider_moves_are_undone_as_one() -> None:
    document = Document(starter("two-shaft"))
    start = document.line
    for angle in (0.1, 0.2, 0.3):
        document.set_numbers(start.replace("HookeJoint 1", angle=angle), "HookeJoint 1.angle")
    assert document.line.elements[3].angle == 0.3
    document.undo()
    assert document.line == start


def test_a_number_that_a_slider_moves_is_written_short_and_the_others_stay() -> None:
    document = Document(starter("two-shaft"))
    before = fields(document)
    document.set_numbers(document.line.replace("HookeJoint 1", angle="2.9 deg"))
    assert fields(document).pop(("element", 3, "angle")) == ("2.9 deg", "")
    assert {k: v for k, v in fields(document).items() if v != before.get(k)} == {
        ("element", 3, "angle"): ("2.9 deg", "")
    }
    third = 1 / 3
    document.set_numbers(document.line.replace("Shaft 1", stiffness=third))
    assert document.line.elements[1].stiffness == third


def test_a_stated_default_stays_stated() -> None:
    """When another number moves, when it is itself moved to its default and back, in the file, and undone."""
    document = Document(starter("two-shaft"))
    document.set_text(("element", 4, "fork_offset"), "0 deg")
    before = fields(document)
    assert before["element", 5, "load_torque"][0] == "0 N*m"
    document.set_numbers(document.line.replace("HookeJoint 1", angle="0 deg"), "HookeJoint 1.angle")
    assert fields(document) == before | {("element", 3, "angle"): ("0 deg", "")}
    assert fields(Document(document.toml)) == fields(document)
    document.set_numbers(document.line.replace("load", load_torque="50 N*m"))
    document.set_numbers(document.line.replace("load", load_torque=0.0))
    assert fields(document)["element", 5, "load_torque"][0] == "0 N*m"
    document.set_numbers(document.line.replace("load", load_torque="50 N*m"))
    document.undo()
    assert fields(document)["element", 5, "load_torque"][0] == "0 N*m"


def test_elements_are_added_moved_and_removed() -> None:
    document = Document(starter("two-shaft"))
    document.add_element(2, "Disk")
    assert document.line.names[2] == "Disk 1"
    document.remove(("element", 2))
    document.move(1, 1)
    document.undo()
    document.undo()
    document.undo()
    assert document.line == Document(starter("two-shaft")).line


def edit(document: Document) -> Callable[[dict[str, object]], None]:
    """What the table of the page sends, as its view takes it."""
    host = SimpleNamespace(document=document, edit=lambda change: change(document))
    view = SimpleNamespace(session=host, adapt=lambda line: None)
    return lambda data: DrivelineView._edited(view, data)  # type: ignore[arg-type]


LISTED = {"element": 6, "limit": 2, "load case": 2, "schedule": 2, "switched off": 2}


def full() -> Document:
    """The two-shaft starter with two of everything that can be added."""
    document = Document(starter("two-shaft"))
    for shaft in ("Shaft 1", "Shaft 2"):
        document.add_limit(shaft)
        document.add_load_case()
        document.add_schedule()
    for place in (0, 1):
        document.switch_off()
        document.set_text(("operation", "switched_off", place, "rule"), ("spicer-angles", "elbe-uniformity")[place])
        document.set_text(("operation", "switched_off", place, "reason"), "turned by hand")
    assert document.problems == ()
    return document


@pytest.mark.parametrize("kind", LISTED)
def test_pressed_twice_a_table_is_removed_once(kind: str) -> None:
    """Both clicks name the same table, which is gone with the first; what has moved to its place stays."""
    document = full()
    listed = [g for g in document.groups() if kind in (g.kind, g.path[:1] and g.path[0])]
    assert len(listed) == LISTED[kind]
    first, *others = listed
    seen = {"do": "remove", "path": list(first.path), "key": first.key}
    for _ in range(3):
        edit(document)(seen)
        now = [g for g in document.groups() if kind in (g.kind, g.path[:1] and g.path[0])]
        assert [g.key for g in now] == [g.key for g in others]
    document.undo()
    assert [g.key for g in document.groups()] == [g.key for g in full_keys(document)]


def full_keys(document: Document) -> list[FieldGroup]:
    """Groups in order, each with a key that no other one of its list has."""
    groups = list(document.groups())
    for section in {g.path[:-1] for g in groups}:
        keys = [g.key for g in groups if g.path[:-1] == section and g.key]
        assert len(keys) == len(set(keys))
    return groups


def key_at(document: Document, place: int) -> int:
    return next(g.key for g in document.groups() if g.path == ("element", place))


def test_what_was_typed_meets_its_own_element_wherever_that_has_moved() -> None:
    document = full()
    shaft = next(g for g in document.groups() if g.title == "Shaft 2")
    typed = {"do": "set", "path": [*shaft.path, "stiffness"], "key": shaft.key, "text": "9 kN*m/rad"}
    edit(document)({"do": "remove", "path": ["element", 2], "key": key_at(document, 2)})
    edit(document)(typed)
    stiffness = {
        n: getattr(e, "stiffness", 0.0) for n, e in zip(document.line.names, document.line.elements, strict=True)
    }
    assert (stiffness["Shaft 1"], stiffness["Shaft 2"]) == (12e3, 9e3)
    edit(document)({"do": "remove", "path": list(shaft.path), "key": shaft.key})
    before = document.data
    edit(document)(typed)
    assert document.data == before


def schedule_fields(document: Document) -> dict[str, tuple[str, str]]:
    """Text and message of the fields of the schedules, by label and group."""
    groups = [g for g in document.groups() if g.kind == "schedule"]
    return {f"{f.label} of {g.title}": (f.text, f.message) for g in groups for f in g.fields}


def test_a_schedule_is_added_typed_and_taken_away() -> None:
    document = Document(starter("three-shaft"))
    before = document.line
    document.add_schedule()
    place = ("operation", "schedule", 0)
    document.set_text((*place, "travel"), '["-60 mm", "0 mm", "90 mm"]')
    message = schedule_fields(document)["angle of HookeJoint 1 of schedule schedule 1"][1]
    assert "one value for each of 3 points, and has 2" in message
    document.set_text((*place, "angles", "HookeJoint 1"), '["9 deg", "6 deg", "3 deg"]')
    document.set_text((*place, "angles", "HookeJoint 2"), '["8 deg", "6 deg", "2 deg"]')
    document.set_text((*place, "loads", "load"), '["10 N*m", "20 N*m", "30 N*m"]')
    document.set_text((*place, "name"), "axle travel")
    assert document.problems == ()
    (schedule,) = document.line.operation.schedules
    assert schedule.name == "axle travel" and schedule.travel == pytest.approx((-0.06, 0.0, 0.09))
    assert {n: list(a) for n, a in schedule.angles.items()} == {
        "HookeJoint 1": pytest.approx([tn.deg(9), tn.deg(6), tn.deg(3)]),
        "HookeJoint 2": pytest.approx([tn.deg(8), tn.deg(6), tn.deg(2)]),
    }
    assert list(schedule.loads["load"]) == [10.0, 20.0, 30.0]
    document.set_text((*place, "angles", "HookeJoint 1"), '["9 deg", "95 deg", "3 deg"]')
    assert schedule_fields(document)["angle of HookeJoint 1 of schedule axle travel"][1]
    document.remove(place)
    assert document.line == before and document.problems == ()


def test_a_joint_that_a_schedule_names_can_go() -> None:
    """Its field stays, says so, and is emptied; the other joint is not taken for it though it is the first now."""
    document = Document(starter("three-shaft"))
    document.add_schedule()
    place = ("operation", "schedule", 0)
    document.set_text((*place, "angles", "HookeJoint 2"), '["8 deg", "2 deg"]')
    joint = next(g for g in document.groups() if g.title == "HookeJoint 1")
    document.remove(joint.path)
    found = schedule_fields(document)
    assert found["angle of HookeJoint 1 of schedule schedule 1"][1]
    assert found["angle of HookeJoint 2 of schedule schedule 1"][1] == ""
    document.set_text((*place, "angles", "HookeJoint 1"), "")
    assert document.problems == ()
    assert list(document.line.operation.schedules[0].angles) == ["HookeJoint 2"]
    assert document.line.names.count("HookeJoint 2") == 1


def test_what_is_said_of_an_element_stays_said_of_it_when_others_come_and_move() -> None:
    """Of unnamed ones too, whose names count them: limits of the second shaft are not the first one's."""
    document = Document(starter("two-shaft"))
    document.add_limit("Shaft 2")
    stiff = document.line.elements[document.line.index("Shaft 2")].stiffness
    document.set_text(("element", 1, "stiffness"), "77 kN*m/rad")

    def limited() -> float:
        return document.line.elements[document.line.index(document.line.limits_by_element[0].element)].stiffness

    assert limited() == stiff
    document.add_element(1, "Disk")
    document.add_element(1, "Shaft")
    assert document.problems == () and limited() == stiff
    document.move(1, 1)
    assert document.problems == () and limited() == stiff
    document.remove(("element", 2))
    document.remove(("element", 2))
    assert limited() == stiff


def test_a_line_is_begun_with_nothing_and_built_up() -> None:
    document = Document(starter("two-shaft"))
    before = document.line
    document.begin_empty()
    assert document.problems and document.line is before
    assert not [g for g in document.groups() if g.path[:1] == ("element",)]
    for k, kind in enumerate(("ConstantSpeed", "Shaft", "HookeJoint", "Disk")):
        document.add_element(k, kind)
    assert document.problems == ()
    assert document.line.names == ("ConstantSpeed 1", "Shaft 1", "HookeJoint 1", "Disk 1")
    with pytest.raises(InputError):
        document.set_text(("element", 2, "angle"), "200 deg")
        document.set_numbers(document.line)
    for _ in range(6):
        document.undo()
    assert document.line == before


@pytest.mark.parametrize("path", ["Shaft 1.stiffness", "Disk 1.inertia", "HookeJoint 1.angle"])
def test_an_address_holds_the_number_that_is_moved_and_how_far_it_may_go(path: str) -> None:
    """The ends stay when the number moves, where a fresh page would put others about it."""
    line = tn.loads(starter("two-shaft"))
    moved: list[tn.Driveline] = []

    def page(query: dict[str, str], line: tn.Driveline) -> Sliders:
        sliders = Sliders(line, lambda line, path: moved.append(line))
        sliders.read(query)
        sliders.adapt(line)
        return sliders

    first = page({}, line)
    assert first.query() == {}
    first.which.value = path
    first.value.value = 0.7 * first.value.value
    first.adapt(moved[-1])
    fresh = page(first.query(), moved[-1])
    for name in ("which", "low", "high", "value", "slider"):
        assert getattr(fresh, name).value == getattr(first, name).value, name
    assert (fresh.slider.start, fresh.slider.end) == (first.slider.start, first.slider.end)
    assert fresh.query() == first.query()
    for wrong in ({"move.from": "x", "move.to": "2"}, {"move.from": "3", "move.to": "2"}, {"move": "no.such"}):
        assert page(wrong, line).query() == {}


def test_changes_are_named_with_units() -> None:
    line = tn.loads(starter("two-shaft"))
    shown = difference("before", dumps(line), line.replace("HookeJoint 1", angle="5 deg"))
    assert "<td>HookeJoint 1, angle</td><td>12 deg</td><td>5 deg</td>" in shown


def test_an_address_holds_the_line() -> None:
    text = starter("truck")
    assert unpack(pack(text)) == text


@pytest.mark.parametrize("text", ["", "!!!", "AAAA", "eJw", pack("x" * 2_000_000)])
def test_a_damaged_or_swollen_address_is_refused(text: str) -> None:
    with pytest.raises(InputError):
        Document(unpack(text))


def test_a_file_too_large_is_refused_before_it_is_read() -> None:
    document = Document(starter("two-shaft"))
    with pytest.raises(InputError, match="characters"):
        document.replace_text("#" * 1_000_001)


def test_exported_python_computes_what_the_call_gives() -> None:
    line = tn.loads(starter("two-shaft"))
    call = Call("tn.order_response", (LINE, Call("np.linspace", (50.0, 60.0, 3))), {"orders": (2.0,)})
    there: dict[str, object] = {}
    exec(script(starter("two-shaft"), {"orders": (call, starter("two-shaft"))}, "orders"), there)
    assert (there["orders"].torque == call.evaluate(line).torque).all()


def test_a_call_reaches_public_functions_only() -> None:
    for name in ("os.system", "tn._HOME", "np.__class__", "eval"):
        with pytest.raises(ValueError):
            Call(name).evaluate(None)
    with pytest.raises(ValueError):
        Call("__class__", of=Call("tn.catalogue", ("gear-rattle",))).evaluate(None)


def test_a_component_is_added_with_its_numbers_and_keeps_its_sheet() -> None:
    document = Document(starter("two-shaft"))
    count = len(document.line.elements)
    document.add_element(1, "example/rubber-16")
    added = document.line.elements[1]
    assert len(document.line.elements) == count + 1 and not document.problems
    assert added.but(name=None) == tn.component("example/rubber-16")
    group = next(g for g in document.groups() if g.path == ("element", 1))
    assert group.kind == "Coupling: example/rubber-16"
    assert next(f.text for f in group.fields if f.path[-1] == "stiffness") == "80 kN*m/rad"
    assert "sheet" not in group.addable and all(f.path[-1] != "sheet" for f in group.fields)
    document.set_text(("element", 1, "stiffness"), "70 kN*m/rad")
    assert document.line.elements[1].departures == {"stiffness": "80 kN*m/rad"}


def test_a_file_that_names_a_component_opens_with_its_numbers_in_the_fields() -> None:
    document = Document(starter("two-shaft"))
    text = 'format = 1\n[[element]]\ntype = "ConstantSpeed"\n[[element]]\ncomponent = "example/rubber-16"\n'
    document.replace_text(text + '[[element]]\ntype = "Disk"\ninertia = 1.0\n')
    assert document.line.elements[1].sheet.component == "example/rubber-16"
    assert document.data["element"][1]["type"] == "Coupling"
    assert loads(document.toml) == document.line
