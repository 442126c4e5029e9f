"""The line under edit: what is refused stands beside its field, and the views keep what was accepted."""

from __future__ import annotations

import pytest

import trunnion as tn
from trunnion.app.address import pack, unpack
from trunnion.app.calls import LINE, Call, script
from trunnion.app.document import Document
from trunnion.app.variants import difference
from trunnion.driveline.files import dumps
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
    assert any("names two reasons" in g.message for g in document.groups())
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


def test_changes_are_named_with_units() -> None:
    line = tn.loads(starter("two-shaft"))
    shown = difference(dumps(line), line.replace("HookeJoint 1", angle="5 deg"))
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
