"""What the editor shows of a driveline file: groups of fields, with what is wrong beside the field it concerns."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from trunnion.driveline import patterns
from trunnion.driveline.field_text import label_of, text_of
from trunnion.driveline.kinds import KINDS
from trunnion.driveline.limits import LIMIT_KINDS, Limit
from trunnion.driveline.quantities import ANGLE, RATIO, SPEED, TORQUE
from trunnion.driveline.rules import APPLICATIONS, RULES, SwitchedOff
from trunnion.driveline.schedules import KEYS as FOLLOWED
from trunnion.driveline.schedules import OVER as SCHEDULE_OVER
from trunnion.driveline.title_block import TitleBlock
from trunnion.errors import InputError

Path = tuple[str | int, ...]
_PLACE = re.compile(r"\(element ([0-9]+)\)$|^element ([0-9]+)$")
_WHOLE = {"name": None, "description": None, "damping_ratio": RATIO, "damping_ratio_frequency": SPEED}
_EXAMPLE_SPEEDS = {"rpm": "1500 rpm", "Hz": "25 Hz", "rad/s": "157 rad/s"}
LOAD_CASE, LOADS, FACTORS, LOAD_KIND = "load_case", "loads", "factors", "load case"
SCHEDULE, ANGLES = "schedule", "angles"
LISTS: tuple[tuple[str, ...], ...] = (
    ("element",), ("limit",), ("operation", LOAD_CASE), ("operation", SCHEDULE), ("operation", "switched_off"),
)  # fmt: skip
"""Where a file lists tables that can be added and taken away."""
SWITCHED_OFF, OFF_KIND = "switched_off", "switched off"
_HIDDEN = ("type", "after", "name", "sheet")


@dataclass(frozen=True)
class Field:
    """One field of the editor: where it stands, its name, text, hint and what is wrong with it."""

    path: Path
    label: str
    text: str
    hint: str = ""
    message: str = ""
    choices: tuple[str, ...] = ()


@dataclass(frozen=True)
class FieldGroup:
    """Fields that belong together: the whole line, its operation, an element, a limit.

    key: what a listed table keeps while others come, go and move; its place in ``path`` changes.
    """

    path: Path
    title: str
    kind: str
    fields: tuple[Field, ...]
    addable: tuple[str, ...] = ()
    message: str = ""
    key: int = 0


class _OpenErrors:
    """What is still to be said of a file; each is taken off by the field or the group that says it."""

    def __init__(self, problems: Iterable[InputError]) -> None:
        self.left = list(problems)

    def about(self, owners: tuple[Any, ...], key: str | None = None) -> list[InputError]:
        """Those of an owner, by name or as ("element", number), and of one of its keys."""
        return [e for e in self.left if _owns(e, owners) and key in (None, e.key)]

    def said(self, owners: tuple[Any, ...], key: str) -> str:
        """What is said of one field."""
        mine = self._taken(owners, key)
        return "; ".join(f"{e.problem}{'; ' + e.remedy if e.remedy else ''}" for e in mine)

    def said_within(self, owners: tuple[Any, ...], key: str, name: str) -> str:
        """What is said of the entry ``name`` of a table ``key``, of its value or of whom it names."""
        return "; ".join(filter(None, (self.said(owners, f"{key}.{name}"), self.said(owners, name))))

    def rest(self, owners: tuple[Any, ...]) -> str:
        """What is said of a group, once its fields have taken theirs."""
        return "\n".join(map(str, self._taken(owners)))

    def _taken(self, owners: tuple[Any, ...], key: str | None = None) -> list[InputError]:
        mine = self.about(owners, key)
        for error in mine:
            self.left.remove(error)
        return mine


def form(data: Mapping[str, Any], problems: Iterable[InputError]) -> tuple[FieldGroup, ...]:
    """Everything that can be edited; what concerns no group is said of the whole."""
    left = _OpenErrors(problems)
    elements, operation = data.get("element", []), data.get("operation", {})
    names, loaded = names_of(elements), (disks_of(elements), machines_of(elements))
    groups = [_whole(data, left), _document(data.get("document", {}), left), _operation(operation, left)]
    groups += [_switched_off(i, one, left) for i, one in enumerate(operation.get(SWITCHED_OFF, []))]
    groups += [_load_case(i, case, *loaded, left) for i, case in enumerate(operation.get(LOAD_CASE, []))]
    groups += [_schedule(i, table, elements, left) for i, table in enumerate(operation.get(SCHEDULE, []))]
    groups += [_element(i, table, names[i], left) for i, table in enumerate(elements)]
    groups += [_limit(i, table, left) for i, table in enumerate(data.get("limit", []))]
    if left.left:
        groups[0] = replace(groups[0], message="\n".join(map(str, left.left)))
    return tuple(groups)


def _whole(data: Mapping[str, Any], left: _OpenErrors) -> FieldGroup:
    fields = [
        Field((key,), label_of(key), text_of(data[key], kind), message=left.said(("", "driveline"), key))
        for key, kind in _WHOLE.items()
        if key in data
    ]
    return FieldGroup((), "line", "", tuple(fields), tuple(k for k in _WHOLE if k not in data))


def _document(table: Mapping[str, Any], left: _OpenErrors) -> FieldGroup:
    path = owners = ("document",)
    fields = [
        Field((*path, key), label_of(key), str(table[key]), message=left.said(owners, key))
        for key in TitleBlock.model_fields
        if key in table
    ]
    addable = tuple(key for key in TitleBlock.model_fields if key not in table)
    return FieldGroup(path, "document", "", tuple(fields), addable, left.rest(owners))


def _operation(table: Mapping[str, Any], left: _OpenErrors) -> FieldGroup:
    path = owners = ("operation",)
    unit = table.get("speed_unit", "rpm")
    example = _EXAMPLE_SPEEDS.get(unit, "157 rad/s")
    speed = text_of(table.get("speed", ""), SPEED)
    fields = [Field((*path, "speed"), "speed", speed, example, left.said(owners, "speed"))]
    for key, kind, hint, names in (
        ("speed_range", SPEED, example, ("lowest speed", "highest speed")),
        ("angle_range", ANGLE, "15 deg", ("smallest angle", "largest angle")),
    ):
        stated = table.get(key)
        ends = [*stated, "", ""] if isinstance(stated, list) else ["", ""]
        said = (left.said(owners, key), "")
        for i, name in enumerate(names):
            fields.append(Field((*path, key, i), name, text_of(ends[i], kind), hint, said[i]))
    said_unit = left.said(owners, "speed_unit")
    fields.append(Field((*path, "speed_unit"), "unit of speeds", unit, "", said_unit, tuple(_EXAMPLE_SPEEDS)))
    application, known = str(table.get("application", "")), ("", *APPLICATIONS)
    said_application = left.said(owners, "application")
    fields.append(Field((*path, "application"), "application", application, "", said_application, known))
    return FieldGroup(path, "operation", "", tuple(fields), (), left.rest(owners))


def _switched_off(place: int, table: Any, left: _OpenErrors) -> FieldGroup:
    path: Path = ("operation", SWITCHED_OFF, place)
    table = table if isinstance(table, dict) else {}
    rule = str(table.get("rule", ""))
    owners = (f"{SwitchedOff.what} {rule}", f"{SwitchedOff.what} {place + 1}")
    known = tuple(name for name, one in RULES.items() if not one.kept)
    reason, said = str(table.get("reason", "")), left.said(owners, "reason")
    fields = (
        Field((*path, "rule"), "rule", rule, "", left.said(owners, "rule"), known),
        Field((*path, "reason"), "reason", reason, "why it does not fit", said),
    )
    return FieldGroup(path, f"{OFF_KIND}: {rule}", OFF_KIND, fields, (), left.rest(owners))


def _load_case(place: int, table: Any, disks: Sequence[str], machines: Sequence[str], left: _OpenErrors) -> FieldGroup:
    """A field for every disk and machine; an empty one leaves it its own torque."""
    path: Path = ("operation", LOAD_CASE, place)
    table = table if isinstance(table, dict) else {}
    name, stated = str(table.get("name", "")), table.get(LOADS)
    owners = (f"load case {name}", f"load case {place + 1}")
    fields = [Field((*path, "name"), "name", name, "full load", left.said(owners, "name"))]
    loads = stated if isinstance(stated, dict) else {}
    for disk in dict.fromkeys([*disks, *loads]):
        text, said = text_of(loads.get(disk, ""), TORQUE), left.said_within(owners, LOADS, disk)
        fields.append(Field((*path, LOADS, disk), f"torque at {disk}", text, "as it is", said))
    factors = table.get(FACTORS) if isinstance(table.get(FACTORS), dict) else {}
    for one in dict.fromkeys([*machines, *(factors or {})]):
        text = text_of((factors or {}).get(one, ""), RATIO)
        what, said = f"factor on the torque of {one}", left.said_within(owners, FACTORS, one)
        fields.append(Field((*path, FACTORS, one), what, text, "as it is", said))
    return FieldGroup(path, f"load case {name}", LOAD_KIND, tuple(fields), (), left.rest(owners))


def _schedule(place: int, table: Any, elements: Sequence[Mapping[str, Any]], left: _OpenErrors) -> FieldGroup:
    """Its points, and what every joint and disk has there; an empty field leaves the element as it is.

    What it says of an element that is there no more keeps its field, where it can be taken away."""
    path: Path = ("operation", SCHEDULE, place)
    table = table if isinstance(table, dict) else {}
    name = str(table.get("name", ""))
    owners = (f"schedule {name}", f"schedule {place + 1}")
    fields = [Field((*path, "name"), "name", name, "axle travel", left.said(owners, "name"))]
    over = "speed" if "speed" in table else "travel"
    quantity = SCHEDULE_OVER[over]
    points = text_of(table.get(over, ""), quantity)
    hint = f'["{quantity.example}", ...]'
    fields.append(Field((*path, over), f"points of {over}", points, hint, left.said(owners, over)))
    for key, word, kind, there in (
        (ANGLES, "angle of", ANGLE, joints_of(elements)),
        (LOADS, "torque at", TORQUE, disks_of(elements)),
        (FACTORS, "factor on", RATIO, ()),
    ):
        stated = table.get(key)
        values = stated if isinstance(stated, dict) else {}
        for one in dict.fromkeys([*there, *values]):
            said = (
                left.said((*owners, f"{owners[0]}, {one}"), about) for about in (one, f"{key}.{one}", kind_key(key))
            )
            text = text_of(values.get(one, ""), kind)
            fields.append(Field((*path, key, one), f"{word} {one}", text, "as it is", "; ".join(filter(None, said))))
    return FieldGroup(path, f"schedule {name}", SCHEDULE, tuple(fields), (), left.rest(owners))


def about(groups: Iterable[FieldGroup], place: int) -> tuple[FieldGroup, ...]:
    """What concerns one element: its own fields, its limits, what load cases and schedules say of it."""
    groups = tuple(groups)
    own = next((one for one in groups if one.path == ("element", place)), None)
    if own is None:
        return ()
    found = [own]
    for one in groups:
        if one.kind == "limit":
            of = next((f.text for f in one.fields if f.path[-1] == "of"), "")
            if patterns.names(of, own.title, own.kind.partition(":")[0]):
                found.append(one)
        elif one.kind in (LOAD_KIND, SCHEDULE):
            fields = tuple(f for f in one.fields if f.path[-1] == own.title)
            over = tuple(f for f in one.fields if one.kind == SCHEDULE and f.path[-1] in SCHEDULE_OVER)
            if fields:
                found.append(replace(one, fields=over + fields, kind=f"in {one.title}", addable=()))
    return tuple(found)


def kind_key(key: str) -> str:
    """The field of an element that a schedule's table ``key`` sets."""
    return FOLLOWED.get(key, key)


def _element(place: int, table: Mapping[str, Any], name: str, left: _OpenErrors) -> FieldGroup:
    path: Path = ("element", place)
    kind = str(table.get("type", ""))
    owners = (name, f"element {place + 1}", ("element", place + 1))
    model = KINDS.get(kind)
    known = list(model.model_fields) if model else []
    wanting = {e.key for e in left.about(owners)}
    shown = [k for k in known if k in table or k in wanting]
    fields = [Field((*path, "name"), "name", str(table.get("name", "")), name, left.said(owners, "name"))]
    for key in dict.fromkeys([*shown, *table]):
        if key not in _HIDDEN:
            quantity = model.quantity_of(key) if model and key in known else None
            hint = quantity.example if quantity else ""
            text = text_of(table.get(key, ""), quantity)
            fields.append(Field((*path, key), label_of(key), text, hint, left.said(owners, key)))
    if "after" in table or "after" in wanting:
        after = str(table.get("after", ""))
        fields.append(Field((*path, "after"), "after", after, "", left.said(owners, "after")))
    out = ("name", "sheet", *shown)
    addable = dict.fromkeys(k for k in (*known, "after") if k not in table and k not in out)
    sheet = table.get("sheet")
    source = str(sheet.get("component", "")) if isinstance(sheet, dict) else ""
    shown_kind = f"{kind}: {source}" if source else kind
    return FieldGroup(path, name, shown_kind, tuple(fields), tuple(addable), left.rest(owners))


def _limit(place: int, table: Mapping[str, Any], left: _OpenErrors) -> FieldGroup:
    path: Path = ("limit", place)
    of = str(table.get("of", ""))
    owners = (f"limit of {of}", f"limit {place + 1}")
    fields = []
    for key, value in table.items():
        kind = LIMIT_KINDS.get(key)
        hint = kind.example if kind else ""
        fields.append(Field((*path, key), label_of(key), text_of(value, kind), hint, left.said(owners, key)))
    addable = tuple(k for k in Limit.model_fields if k not in table)
    return FieldGroup(path, f"limit of {of}", "limit", tuple(fields), addable, left.rest(owners))


def names_of(tables: Iterable[Mapping[str, Any]]) -> list[str]:
    """Names of elements, those that a file leaves out included."""
    seen: dict[str, int] = {}
    names = []
    for table in tables:
        kind = str(table.get("type", "element"))
        seen[kind] = seen.get(kind, 0) + 1
        names.append(str(table.get("name") or f"{kind} {seen[kind]}"))
    return names


def joints_of(tables: Sequence[Mapping[str, Any]]) -> list[str]:
    """Names of the elements that have an angle."""
    known = (KINDS.get(str(t.get("type", ""))) for t in tables)
    return [n for n, kind in zip(names_of(tables), known, strict=True) if kind and "angle" in kind.model_fields]


def disks_of(tables: Sequence[Mapping[str, Any]]) -> list[str]:
    """Names of the elements that a load acts on."""
    return [n for n, t in zip(names_of(tables), tables, strict=True) if t.get("type") in ("Disk", "Vehicle")]


def machines_of(tables: Sequence[Mapping[str, Any]]) -> list[str]:
    """Names of the machines on whose torque a load case can put a factor."""
    kinds = [name for name, kind in KINDS.items() if getattr(kind, "torque_keys", ())]
    return [n for n, t in zip(names_of(tables), tables, strict=True) if t.get("type") in kinds]


def _owns(error: InputError, owners: tuple[Any, ...]) -> bool:
    place = _PLACE.search(error.element)
    number = int(place.group(1) or place.group(2)) if place else None
    return error.element in owners or (number is not None and ("element", number) in owners)
