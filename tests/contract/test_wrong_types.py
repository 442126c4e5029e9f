"""Every key of every element and table, written as something that it cannot be: one line each, with what to write.

Kinds, keys and what they take come from the JSON Schema of the file format, so that a new key is tested by itself.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from functools import cache
from typing import Any

import jsonschema
import pytest
from element_examples import ELEMENTS

import trunnion as tn
from trunnion.driveline.kinds import KINDS
from trunnion.driveline.record import Record
from trunnion.driveline.schema import json_schema
from trunnion.errors import InputError

SCHEMA = json_schema()
TABLES: dict[str, Any] = {name: one for name, one in SCHEMA["$defs"].items() if name != "ComponentElement"}
"""All but elements from the catalogue of components, which ``test_components`` has."""
WRONG = (True, False, "three", [1.0], ["three"], [], {"a": 1}, math.nan, math.inf, 1.5)
MAY_BE_EMPTY = {
    "excitation", "ripple", "transmission_error", "stiffness_variation", "breakpoints", "friction", "torque",
    "disturbance", "crossing", "switched_off", "duty", "load_case", "schedule", "passage", "limit", "sn_curve",
    "tolerance", "scenario",
}  # fmt: skip
"""Lists that can say "none of them"."""
NEVER_NEGATIVE = {"kg*m^2", "m", "kg", "kg/m^3", "m^2", "K/W", "K", "N/m", "N*s/m", "N*m/rad", "N", "Pa"}
SIGNED = {"TransmissionError.amplitude", "Schedule.travel"}
"""Lengths with a sign of their own: a phase, a direction."""
POINT = {"torque_ratio": 1.0, "capacity": 1.0}
GIVEN = {"TorqueConverter": {"curves": [{"speed_ratio": one, **POINT} for one in (0.0, 0.5, 1.0)]}}
"""Where what the schema asks for is not enough to read a key."""
IN_FILES_ONLY = {"AppliedTorque.file"}
IN_PYTHON = {"load_case": "load_cases", "schedule": "schedules", "passage": "passages"}


def classes(base: type[Record] = Record) -> dict[str, type[Record]]:
    return {name: one for sub in base.__subclasses__() for name, one in {sub.__name__: sub, **classes(sub)}.items()}


CLASSES = classes()


def takes(field: dict[str, Any], value: object) -> bool:
    if isinstance(value, float) and not math.isfinite(value):
        return False
    return bool(checks(json.dumps(field)).is_valid(value))


@cache
def checks(field: str) -> Any:
    return jsonschema.Draft202012Validator({**json.loads(field), "$defs": SCHEMA["$defs"]})


def some(field: dict[str, Any]) -> Any:
    """A value that a key takes, whatever it means."""
    if "$ref" in field:
        return least(field["$ref"].rpartition("/")[2])
    if "enum" in field or "const" in field:
        return field.get("const", field.get("enum", [None])[0])
    if "anyOf" in field:
        return some(field["anyOf"][0])
    made = {"number": 1.0, "integer": 20, "string": "a", "boolean": True, "object": {}}
    return [some(field["items"])] * field.get("minItems", 1) if field["type"] == "array" else made[field["type"]]


def least(name: str) -> dict[str, Any]:
    """The keys that a table cannot be read without; what goes with what is asked later."""
    if not name:
        return {"format": 1, "element": [{"type": "Disk", "inertia": 1.0}]}
    made = {key: some(TABLES[name]["properties"][key]) for key in TABLES[name].get("required", ())}
    return {**made, **GIVEN.get(name, {})}


def cases(name: str) -> Iterator[tuple[str, Any]]:
    """Keys of a table, of the file for "", with each of ``WRONG`` that the schema refuses there, and empty lists."""
    for key, field in (TABLES[name] if name else SCHEMA)["properties"].items():
        if key == "type" and name in KINDS:
            continue
        for value in WRONG:
            empty = value == [] and key not in MAY_BE_EMPTY
            if empty or not takes(field, value):
                yield key, value


def faults(error: InputError, key: str, value: Any, *places: str) -> str:
    """What is missing in a complaint about ``key``; empty where nothing is."""
    said = str(error)
    member = value
    while isinstance(member, list | dict) and member:
        member = member[0] if isinstance(member, list) else next(iter(member.values()))
    shown = [f"{one:g}" if isinstance(one, float) else repr(one) for one in (value, member)]
    shown += ["is a single table"] if isinstance(value, dict) else []
    found = {
        "one line": "\n" not in said and len(error.problems) == 1,
        "key": key in f"{error.element}.{error.key}" or f"{key}]]" in error.remedy,
        "value": any(one in said for one in shown),
        "remedy": error.remedy != "" and said.endswith(error.remedy),
        "place": not places or any(one in said for one in places),
        "exit code": error.exit_code == 2,
    }
    return ", ".join(what for what, there in found.items() if not there)


def refused(make: Any, *asked: Any) -> str:
    try:
        make()
    except InputError as error:
        wrong = faults(error, *asked)
        return f"without {wrong}: {error}" if wrong else ""
    return f"{asked[0]} = {asked[1]} is accepted"


@pytest.mark.parametrize("name", TABLES)
def test_in_python(name: str) -> None:
    kind, given = CLASSES[name], {key: value for key, value in least(name).items() if key != "type"}
    found = []
    for key, value in cases(name):
        if f"{name}.{key}" in IN_FILES_ONLY:
            continue
        key = IN_PYTHON.get(key, key) if name == "Operation" else key
        stated = {**given, key: value}
        called = kind.called(stated)
        found.append(refused(lambda stated=stated: kind(**stated), key, value, called))
    assert found and not [one for one in found if one]


def test_every_key_is_gone_through() -> None:
    """A few by name, and many in all: a schema without them would test nothing."""
    all_cases = [(name, key) for name in TABLES for key, _ in cases(name)]
    assert len(set(all_cases)) > 500 and len(all_cases) > 3500
    named = {("Planetary", "planets"), ("Coupling", "damping_factors"), ("Engine", "gas_torque"), ("Sheet", "version")}
    assert named < set(all_cases)


@pytest.mark.parametrize("name", [name for name in TABLES if name in CLASSES])
def test_what_is_never_negative(name: str) -> None:
    """Masses, lengths, stiffnesses: below zero they are refused, by their own name where an element has them."""
    examples = [one.stated for one in ELEMENTS if one.kind == name]
    for key, field in TABLES[name]["properties"].items():
        unit, place = unit_of(field), f"{name}.{key}"
        if unit not in NEVER_NEGATIVE or place in SIGNED or key not in CLASSES[name].model_fields:
            continue
        own = next((one for one in examples if key in one), None)
        stated = dict(own or (examples[0] if examples else least(name)))
        listed = isinstance(stated.get(key), tuple) or field.get("type") == "array"
        stated[key] = [-1.0] * len(stated.get(key, "ab")) if listed else -1.0
        with pytest.raises(InputError) as caught:
            CLASSES[name](**stated)
        assert all(one.exit_code == 2 and one.remedy for one in caught.value.problems), place
        assert own is None or (key in caught.value.key and len(caught.value.problems) == 1), str(caught.value)


def unit_of(field: dict[str, Any]) -> str:
    """SI unit of a key, or of what its list holds."""
    parts = [field, field.get("items", {}), *field.get("anyOf", ())]
    return next((one["unit"] for one in parts if isinstance(one, dict) and "unit" in one), "")


def written(value: Any) -> str:
    """A value as TOML writes it on one line."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{json.dumps(key)} = {written(one)}" for key, one in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(written, value)) + "]"
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return json.dumps(value)


def file_of(**tables: Any) -> str:
    return "\n".join(f"{key} = {written(value)}" for key, value in {**least(""), **tables}.items())


@cache
def way_to(name: str) -> tuple[tuple[str, str, bool], ...]:
    """Steps from the file to a table: the table that a key stands in ("" for the file), the key, whether it lists."""
    seen: dict[str, tuple[tuple[str, str, bool], ...]] = {"": ()}
    waiting = [""]
    while name not in seen:
        inside = waiting.pop(0)
        table = TABLES[inside] if inside else SCHEMA
        for key, field in table["properties"].items():
            for part in (field, *field.get("anyOf", ())):
                listed = part.get("type") == "array"
                items = part["items"] if listed else part
                for one in (items, *items.get("oneOf", ())):
                    of = one.get("$ref", "").rpartition("/")[2]
                    if of in TABLES and of not in seen:
                        seen[of] = (*seen[inside], (inside, key, listed))
                        waiting.append(of)
    return seen[name]


def in_file(name: str, tables: list[dict[str, Any]]) -> str:
    """A file with these tables, beside each other in the first list on their way."""
    steps = way_to(name)
    first = next((i for i, (_, _, listed) in enumerate(steps) if listed), len(steps))
    for i, (inside, key, listed) in reversed(list(enumerate(steps))):
        if i == first:
            tables = [{**least(inside), key: tables}]
        else:
            tables = [{**least(inside), key: [one] if listed else one} for one in tables]
    [whole] = tables
    return file_of(**whole)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["", *TABLES])
def test_in_a_file(name: str) -> None:
    go_through(name, list(cases(name)))


@pytest.mark.parametrize("name", ["", *TABLES])
def test_in_a_file_each_key_once(name: str) -> None:
    """One wrong value a key, another for each."""
    by_key: dict[str, list[Any]] = {}
    for key, value in cases(name):
        by_key.setdefault(key, []).append(value)
    go_through(name, [(key, values[i % len(values)]) for i, (key, values) in enumerate(by_key.items())])


def go_through(name: str, asked: list[tuple[str, Any]]) -> None:
    """All wrong tables in one file, a complaint each; one by one where the file has only one such table."""
    tables = [{**least(name), key: value} for key, value in asked]
    if any(listed for _, _, listed in way_to(name)):
        with pytest.raises(InputError) as caught:
            tn.loads(in_file(name, tables))
        single = list(caught.value.problems)
    else:
        single = []
        for table in tables:
            with pytest.raises(InputError) as caught:
                tn.loads(in_file(name, [table]))
            single += caught.value.problems
    assert len(single) == len(asked), [str(one) for one in single]
    found = [(faults(one, key, value), str(one)) for one, (key, value) in zip(single, asked, strict=True)]
    assert not [one for one in found if one[0]]


def test_at_the_command_line(tmp_path: Any, capsys: pytest.CaptureFixture[str]) -> None:
    """One line on the error stream, and exit code 2."""
    from trunnion.cli import main

    path = tmp_path / "line.toml"
    stated = {**least("Planetary"), "planets": True}
    path.write_text(file_of(element=[{"type": "Disk", "inertia": 1.0}, stated]), encoding="utf-8")
    with pytest.raises(SystemExit) as leave:
        main(["natural-frequencies", str(path)])
    assert leave.value.code == 2
    said = capsys.readouterr()
    assert said.out == "" and len(said.err.splitlines()) == 1
    assert "Planetary 1 (element 2).planets = true: must be a whole number" in said.err
