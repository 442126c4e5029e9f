"""Driveline files: reading, writing and reading again is the identity; examples and starters load."""

import json
import math
import os
import tomllib
import warnings
from pathlib import Path

import jsonschema
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from trunnion.driveline import (
    STARTERS,
    ConstantSpeed,
    Disk,
    Driveline,
    HookeJoint,
    IdealJoint,
    Limit,
    LoadCase,
    Operation,
    Ratio,
    Schedule,
    Shaft,
    Tolerance,
    dump,
    dumps,
    json_schema,
    load,
    loads,
    starter,
)
from trunnion.driveline.kinds import KINDS
from trunnion.driveline.record import is_name
from trunnion.driveline.rules import APPLICATIONS
from trunnion.errors import ComputationError, InputRemark

EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*.toml"))

positive = st.floats(1e-9, 1e12) | st.sampled_from([0.076, 12000.0, 79.3e9, math.radians(12)])
torque = st.floats(-1e9, 1e9)
angle = st.floats(-1.57, 1.57) | st.integers(-89, 89).map(math.radians)
names = st.none() | st.text(min_size=1, max_size=12).filter(is_name)


@st.composite
def shafts(draw):
    data = {"fork_offset": draw(angle)}
    if draw(st.booleans()):
        data["stiffness"] = draw(positive)
    else:
        data["outer_diameter"] = outer = draw(positive)
        data |= {"length": draw(positive), "shear_modulus": draw(positive)}
        if draw(st.booleans()):
            data["inner_diameter"] = outer * draw(st.just(0.0) | st.floats(1e-3, 0.99))
        data |= {key: draw(positive) for key in draw(st.sets(st.sampled_from(["density", "young_modulus"])))}
    damped = draw(st.sampled_from(["no", "viscous", "loss"]))
    if damped == "viscous":
        data["damping"] = draw(positive)
    elif damped == "loss":
        data |= {"loss_factor": draw(positive), "loss_factor_frequency": draw(positive)}
    return Shaft(**data)


@st.composite
def disks(draw):
    if draw(st.booleans()):
        return Disk(inertia=draw(positive), load_torque=draw(torque))
    return Disk(outer_diameter=draw(positive), thickness=draw(positive), density=draw(positive))


teeth = st.integers(1, 200)
others = st.one_of(
    st.builds(HookeJoint, angle=angle, plane=angle),
    st.builds(IdealJoint, angle=angle),
    st.builds(Ratio, ratio=torque.filter(lambda x: abs(x) > 1e-9)),
    st.builds(Ratio, teeth_in=teeth, teeth_out=teeth),
)


@st.composite
def drivelines(draw):
    elements = draw(st.lists(shafts() | disks() | others, min_size=1, max_size=6))
    if draw(st.booleans()):
        elements.insert(0, ConstantSpeed())
    unique = draw(st.lists(names, min_size=len(elements), max_size=len(elements)))
    unique = [n if n and unique.count(n) == 1 and n[-1] not in "0123456789" else None for n in unique]
    elements = [type(e)(**e.stated, name=n) for e, n in zip(elements, unique, strict=True)]
    line = Driveline(elements)
    loaded = [n for n, e in zip(line.names, elements, strict=True) if isinstance(e, Disk)]
    for i, element in enumerate(elements[1:], start=1):  # now and then a branch
        earlier = [n for n in loaded if line.index(n) < i]
        if earlier and draw(st.integers(0, 3)) == 0:
            elements[i] = type(element)(**element.stated, after=draw(st.sampled_from(earlier)))
    rest = {"name": draw(names), "description": draw(st.none() | st.text(max_size=40))}
    if not any(isinstance(e, Shaft) and (e.damping or e.loss_factor) for e in elements) and draw(st.booleans()):
        rest["damping_ratio"] = draw(positive)
        rest["damping_ratio_frequency"] = draw(st.none() | positive)
    if draw(st.booleans()):
        cases = [LoadCase(name="full load", loads={n: draw(torque) for n in loaded})]
        if draw(st.booleans()):
            cases.append(LoadCase(name="none", loads={}))
        low = draw(st.just(0.0) | st.floats(1e-9, 100))
        over, first = draw(st.sampled_from(["travel", "speed"])), draw(st.floats(1e-9, 10))
        pull = {n: [draw(torque), draw(torque)] for n in loaded}
        schedules = [Schedule(name="pull", **{over: [first, first + 1.0]}, loads=pull)] if pull else []
        rest["operation"] = Operation(
            speed=draw(st.none() | positive),
            speed_range=draw(st.none() | st.just((low, low + 50.0))),
            angle_range=draw(st.none() | st.just((0.0, math.radians(15)))),
            speed_unit=draw(st.sampled_from(["rpm", "Hz", "rad/s"])),
            application=draw(st.none() | st.sampled_from(sorted(APPLICATIONS))),
            switched_off=draw(st.just(()) | st.just([{"rule": "m68", "reason": 'a [[table]] "within"'}])),
            load_cases=cases if draw(st.booleans()) else (),
            schedules=schedules if draw(st.booleans()) else (),
        )
    sprung = [n for n, e in zip(line.names, elements, strict=True) if isinstance(e, Shaft)]
    if sprung and draw(st.booleans()):
        margin = draw(st.just(0.0) | st.floats(1e-9, 0.99))
        rest["limits"] = [
            Limit(of=draw(st.sampled_from(sprung)), vibratory_torque=draw(positive), margin=margin),
            Limit(of="Shaft *", max_torque=draw(positive), max_twist=draw(positive)),
        ]
    stiff = [n for n, e in zip(line.names, elements, strict=True) if isinstance(e, Shaft) and e.stiffness]
    if stiff and draw(st.booleans()):
        share, size = draw(st.floats(1e-9, 0.3)), draw(st.floats(1e-9, 1e3))
        rest["tolerances"] = [
            Tolerance(stiff[0], stiffness=share, fork_offset=draw(st.sampled_from(["0.5 deg", f"{size} rad"]))),
            Tolerance("Shaft *", stiffness={"deviation": share}, fork_offset=[-size, size]),
        ]
    return Driveline(elements, **rest)


@pytest.mark.filterwarnings("ignore::trunnion.errors.InputRemark")
@given(drivelines())
@settings(max_examples=30, deadline=None)
def test_writing_and_reading_is_the_identity(line):
    assert loads(dumps(line)) == line


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::trunnion.errors.InputRemark")
@given(drivelines())
@settings(max_examples=1000, deadline=None)
def test_writing_and_reading_is_the_identity_for_a_thousand_lines(line):
    assert loads(dumps(line)) == line


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_examples_load_without_a_remark_and_survive_a_round_trip(path, tmp_path):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        line = load(path)
    assert line.operation is not None and line.name
    dump(line, tmp_path / "again.toml")
    again = load(tmp_path / "again.toml")
    assert again == line
    assert dumps(again) == dumps(line)


def test_there_are_examples():
    assert {path.stem for path in EXAMPLES} >= {"truck", "steering-column", "rolling-mill-spindle"}


@pytest.mark.parametrize("name", STARTERS)
def test_starters_load_without_a_remark(name):
    text = starter(name)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        line = loads(text)
    assert loads(dumps(line)) == line
    assert "#" in text


def test_numbers_are_written_as_an_engineer_would():
    text = dumps(loads(starter("truck")))
    assert 'angle = "5 deg"' in text
    assert 'outer_diameter = "90 mm"' in text
    assert 'stiffness = "45 kN*m/rad"' in text
    assert 'speed = "1800 rpm"' in text


def test_byte_order_mark_and_windows_line_ends_are_read(tmp_path):
    path = tmp_path / "notepad.toml"
    path.write_bytes(b"\xef\xbb\xbf" + starter("two-shaft").replace("\n", "\r\n").encode())
    assert load(path) == loads(starter("two-shaft"))


def test_dump_replaces_the_file_whole(tmp_path):
    path = tmp_path / "line.toml"
    path.write_text("old")
    line = loads(starter("two-shaft"))
    dump(line, path)
    assert load(path) == line
    assert os.listdir(tmp_path) == ["line.toml"]


def test_failed_dump_leaves_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / "line.toml"
    path.write_text("old")
    monkeypatch.setattr(os, "replace", lambda *_: (_ for _ in ()).throw(OSError(28, "No space left on device")))
    with pytest.raises(ComputationError, match="cannot be written"):
        dump(loads(starter("two-shaft")), path)
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["line.toml"]


def test_large_angle_in_a_file_is_a_remark_with_its_place(tmp_path):
    path = tmp_path / "steep.toml"
    path.write_text('format = 1\n[[element]]\ntype = "HookeJoint"\nangle = "50 deg"\n')
    with pytest.warns(InputRemark, match=r"^steep\.toml: HookeJoint 1 \(element 1\)\.angle = '50 deg': is 50 deg"):
        load(path)


def test_negative_damping_in_a_file_is_said_once_with_its_place():
    text = 'format = 1\n[[element]]\ntype = "Shaft"\nstiffness = 1\ndamping = -1\n'
    with pytest.warns(InputRemark, match=r"^Shaft 1 \(element 1\)\.damping = -1") as remarks:
        loads(text)
    assert len(remarks) == 1


def test_schema_covers_every_element_with_units():
    schema = json_schema()
    json.dumps(schema)
    for name, kind in KINDS.items():
        definition = schema["$defs"][name]
        assert set(definition["properties"]) == {"type", *kind.model_fields}
        for key, field in definition["properties"].items():
            quantity = kind.quantity_of(key) if key != "type" else None
            unit = field.get("unit", field.get("items", {}).get("unit"))  # a list of quantities names it once
            assert unit == (quantity.unit if quantity else None)
    assert schema["$defs"]["HookeJoint"]["required"] == ["type", "angle"]
    assert "load_case" in schema["$defs"]["Operation"]["properties"]
    assert schema["$defs"]["Operation"]["properties"]["application"]["enum"] == list(APPLICATIONS)
    assert "stability" not in schema["$defs"]["SwitchedOff"]["properties"]["rule"]["enum"]
    assert schema["$defs"]["SwitchedOff"]["required"] == ["rule", "reason"]


@pytest.fixture(scope="module")
def schema():
    """What judges descriptions by the schema."""
    return jsonschema.Draft202012Validator(json_schema())


def test_schema_accepts_the_examples(schema):
    schema.check_schema(schema.schema)
    for path in EXAMPLES:
        schema.validate(tomllib.loads(path.read_text(encoding="utf-8")))


NOT_IN_SCHEMA = [
    {"type": "Shaft"},
    {"type": "Shaft", "stiffness": 1, "length": 1},
    {"type": "Shaft", "stifness": 1},
    {"type": "Shaft", "stiffness": 1, "loss_factor_frequency": 0.02},
    {"type": "Disk", "inertia": [1]},
    {"type": "HookeJoint", "angle": "steep"},
    {"type": "Ratio", "teeth_in": 10},
    {"type": "Axle"},
    {"stiffness": 1},
]


@pytest.mark.parametrize("element", NOT_IN_SCHEMA, ids=str)
def test_schema_refuses(element, schema):
    with pytest.raises(jsonschema.ValidationError):
        schema.validate({"format": 1, "element": [element]})
