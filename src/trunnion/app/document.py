"""The driveline that a session edits: the content of a file, its last valid line, what is wrong with it, undo.

Whatever is typed goes through the reader of driveline files; a field whose text is refused keeps the text, with the
refusal beside it, and the views keep the last line that was accepted.
"""

from __future__ import annotations

import re
import tomllib
import warnings
from copy import deepcopy
from dataclasses import dataclass, replace
from typing import Any

from trunnion.driveline.driveline import Driveline
from trunnion.driveline.field_text import label_of, text_of
from trunnion.driveline.files import dumps, loads
from trunnion.driveline.kinds import KINDS
from trunnion.driveline.limits import LIMIT_KINDS, Limit
from trunnion.driveline.quantities import ANGLE, RATIO, SPEED, TORQUE, Kind, parse
from trunnion.errors import InputError, InputRemark

MOST_STEPS = 200
"""Steps that can be undone."""
ROUNDING = 1e-15
"""What a number may lose when it is written short."""
LARGEST_FILE = 1_000_000
"""Characters of a file that is taken from the browser."""
Path = tuple[str | int, ...]
_PLACE = re.compile(r"\(element ([0-9]+)\)$|^element ([0-9]+)$")
_WHOLE = {"name": None, "description": None, "damping_ratio": RATIO, "damping_ratio_frequency": SPEED}
_WORDS = ("name", "description", "after", "of", "speed_unit")
LOAD_CASE, LOADS, LOAD_KIND = "load_case", "loads", "load case"
_HIDDEN = ("type", "after", "name")


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
class Group:
    """Fields that belong together: the whole line, its operation, an element, a limit."""

    path: Path
    title: str
    kind: str
    fields: tuple[Field, ...]
    addable: tuple[str, ...] = ()
    message: str = ""


class Document:
    """A driveline under edit."""

    def __init__(self, text: str) -> None:
        line = loads(text)
        self.data: dict[str, Any] = tomllib.loads(text)
        self.line: Driveline = line
        self.toml = text
        self.problems: tuple[InputError, ...] = ()
        self.remarks: tuple[str, ...] = ()
        self._undo: list[dict[str, Any]] = []
        self._redo: list[dict[str, Any]] = []
        self._mover = ""

    # -- changes ------------------------------------------------------------------------------------------------

    def set_text(self, path: Path, text: str) -> None:
        """Put what was typed into a field; an empty text takes the field away."""
        data = deepcopy(self.data)
        owner: Any = data
        for key, following in zip(path, (*path[1:], None), strict=True):
            if following is None:
                break
            if isinstance(key, str) and key not in owner:
                owner[key] = [] if isinstance(following, int) else {}
            owner = owner[key]
        last = path[-1]
        value = text.strip() if last in _WORDS and LOADS not in path else _read(text)
        if text.strip():
            if isinstance(owner, list) and isinstance(last, int) and last >= len(owner):
                owner.append(value)
            else:
                owner[last] = value
        elif isinstance(owner, dict):
            owner.pop(last, None)
        self._take(data)

    def set_numbers(self, line: Driveline, by: str = "") -> None:
        """Take over a line whose numbers were changed elsewhere; moves of one slider ``by`` are undone as one."""
        data = _texts_kept(tomllib.loads(dumps(line)), self.data, line)
        if by and by == self._mover:
            self.data = data
            self._judge()
            return
        self._take(data)
        self._mover = by

    def add_element(self, place: int, kind: str) -> None:
        """A new element of a kind before ``place``, with the example of its kind."""
        data = deepcopy(self.data)
        data.setdefault("element", []).insert(place, {"type": kind} | _EXAMPLES.get(kind, {}))
        self._take(data)

    def add_limit(self, of: str) -> None:
        """An empty limit of an element."""
        data = deepcopy(self.data)
        data.setdefault("limit", []).append({"of": of, "vibratory_torque": "500 N*m"})
        self._take(data)

    def add_load_case(self) -> None:
        """A load case with a torque at the last disk, and a name that no other one has."""
        data = deepcopy(self.data)
        operation = data.setdefault("operation", {})
        cases = operation.setdefault(LOAD_CASE, [])
        taken = {str(case.get("name", "")) for case in cases}
        name = next(n for n in (f"load {k}" for k in range(1, len(cases) + 2)) if n not in taken)
        disks = _disks(data.get("element", []))
        cases.append({"name": name, LOADS: {disks[-1]: "100 N*m"} if disks else {}})
        self._take(data)

    def remove(self, path: Path) -> None:
        """Take an element, a limit or a load case away."""
        data = deepcopy(self.data)
        owner: Any = data
        for key in path[:-2]:
            owner = owner[key]
        section, place = str(path[-2]), int(path[-1])
        del owner[section][place]
        if not owner[section]:
            del owner[section]
        self._take(data)

    def move(self, place: int, by: int) -> None:
        """Move an element toward the drive (−1) or the load (+1)."""
        data = deepcopy(self.data)
        elements = data["element"]
        if 0 <= place + by < len(elements):
            elements.insert(place + by, elements.pop(place))
            self._take(data)

    def replace_text(self, text: str) -> None:
        """Another file.

        Raises
        ------
        InputError : it is too large or describes no driveline; nothing is changed then.
        """
        if len(text) > LARGEST_FILE:
            problem = f"has {len(text)} characters, at most {LARGEST_FILE} are taken"
            raise InputError(problem, key="file", remedy="give a driveline file")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", InputRemark)
            loads(text)
        self._take(tomllib.loads(text))

    def undo(self) -> bool:
        """Take the last change back."""
        return self._step(self._undo, self._redo)

    def redo(self) -> bool:
        """Make it again."""
        return self._step(self._redo, self._undo)

    @property
    def can_undo(self) -> bool:
        return bool(self._undo)

    @property
    def can_redo(self) -> bool:
        return bool(self._redo)

    def _step(self, source: list[dict[str, Any]], target: list[dict[str, Any]]) -> bool:
        if not source:
            return False
        target.append(self.data)
        self._mover = ""
        self.data = source.pop()
        self._judge()
        return True

    def _take(self, data: dict[str, Any]) -> None:
        if data == self.data:
            return
        self._undo = [*self._undo[1 - MOST_STEPS :], self.data]
        self._redo = []
        self._mover = ""
        self.data = data
        self._judge()

    def _judge(self) -> None:
        import tomli_w

        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always", InputRemark)
            text = tomli_w.dumps(self.data)
            try:
                self.line = loads(text)
            except InputError as error:
                self.problems = error.problems
            else:
                self.problems = ()
                self.toml = text  # as typed: what is stated stays so, be it a default
        self.remarks = tuple(dict.fromkeys(str(w.message) for w in said))

    # -- what the editor shows ----------------------------------------------------------------------------------

    def groups(self) -> tuple[Group, ...]:
        """Everything that can be edited, problems beside the fields they concern."""
        left = list(self.problems)
        elements = self.data.get("element", [])
        names = _names(elements)
        cases = self.data.get("operation", {}).get(LOAD_CASE, [])
        loads = [self._load_case(i, case, _disks(elements), left) for i, case in enumerate(cases)]
        groups = [self._whole(left), self._operation(left), *loads]
        groups += [self._element(i, table, names[i], left) for i, table in enumerate(elements)]
        groups += [self._limit(i, table, left) for i, table in enumerate(self.data.get("limit", []))]
        if left:
            first = replace(groups[0], message="\n".join(map(str, left)))
            groups[0] = first
        return tuple(groups)

    def _whole(self, left: list[InputError]) -> Group:
        fields = [
            Field((key,), label_of(key), text_of(self.data[key], kind), message=_said(left, ("", "driveline"), key))
            for key, kind in _WHOLE.items()
            if key in self.data
        ]
        return Group((), "line", "", tuple(fields), tuple(k for k in _WHOLE if k not in self.data))

    def _operation(self, left: list[InputError]) -> Group:
        table = self.data.get("operation", {})
        unit = table.get("speed_unit", "rpm")
        example = {"rpm": "1500 rpm", "Hz": "25 Hz"}.get(unit, "157 rad/s")
        said = {k: _said(left, ("operation",), k) for k in ("speed", "speed_range", "angle_range", "speed_unit")}
        fields = [
            Field(("operation", "speed"), "speed", text_of(table.get("speed", ""), SPEED), example, said["speed"])
        ]
        for key, kind, hint in (("speed_range", SPEED, example), ("angle_range", ANGLE, "15 deg")):
            ends = table.get(key, ["", ""])
            ends = [*ends, "", ""][:2] if isinstance(ends, list) else ["", ""]
            words = ("lowest", "highest") if kind is SPEED else ("smallest", "largest")
            for i, word in enumerate(words):
                text = text_of(ends[i], kind)
                name = f"{word} {'speed' if kind is SPEED else 'angle'}"
                fields.append(Field(("operation", key, i), name, text, hint, said[key] if i == 0 else ""))
        units = Field(
            ("operation", "speed_unit"), "unit of speeds", unit, "", said["speed_unit"], ("rpm", "Hz", "rad/s")
        )
        fields.append(units)
        rest = [e for e in left if e.element == "operation"]
        for error in rest:
            left.remove(error)
        return Group(("operation",), "operation", "", tuple(fields), (), "\n".join(map(str, rest)))

    def _load_case(self, place: int, table: Any, disks: list[str], left: list[InputError]) -> Group:
        """A field for every disk; an empty one leaves the disk its own torque."""
        path: Path = ("operation", LOAD_CASE, place)
        table = table if isinstance(table, dict) else {}
        name = str(table.get("name", ""))
        owners = (f"load case {name}", f"load case {place + 1}")
        fields = [Field((*path, "name"), "name", name, "full load", _said(left, owners, "name"))]
        loads = table.get(LOADS, {})
        loads = loads if isinstance(loads, dict) else {}
        for disk in dict.fromkeys([*disks, *loads]):
            text = text_of(loads.get(disk, ""), TORQUE)
            fields.append(Field((*path, LOADS, disk), f"torque at {disk}", text, "as it is", _said(left, owners, disk)))
        rest = [e for e in left if e.element in owners]
        for error in rest:
            left.remove(error)
        return Group(path, f"load case {name}", LOAD_KIND, tuple(fields), (), "\n".join(map(str, rest)))

    def _element(self, place: int, table: dict[str, Any], name: str, left: list[InputError]) -> Group:
        kind = str(table.get("type", ""))
        model = KINDS.get(kind)
        owners = (name, f"element {place + 1}", ("element", place + 1))
        known = list(model.model_fields) if model else []
        missing = {e.key for e in left if _owns(e, owners) and e.key in known and e.key not in table}
        keys = [k for k in known if (k in table or k in missing) and k not in _HIDDEN]
        keys += [k for k in table if k not in known and k not in ("type",)]
        fields = [
            Field(("element", place, "name"), "name", str(table.get("name", "")), name, _said(left, owners, "name"))
        ]
        for key in keys:
            quantity = model.quantity_of(key) if model and key in known else None
            text = text_of(table.get(key, ""), quantity)
            hint = quantity.example if quantity else ""
            fields.append(Field(("element", place, key), label_of(key), text, hint, _said(left, owners, key)))
        if "after" in table or any(_owns(e, owners) and e.key == "after" for e in left):
            message = _said(left, owners, "after")
            fields.append(Field(("element", place, "after"), "after", str(table.get("after", "")), "", message))
        rest = [e for e in left if _owns(e, owners)]
        for error in rest:
            left.remove(error)
        addable = tuple(k for k in (*known, "after") if k not in table and k not in ("name", *missing))
        addable = tuple(dict.fromkeys(addable))
        return Group(("element", place), name, kind, tuple(fields), addable, "\n".join(map(str, rest)))

    def _limit(self, place: int, table: dict[str, Any], left: list[InputError]) -> Group:
        of = str(table.get("of", ""))
        owners = (f"limit of {of}", f"limit {place + 1}")
        fields = []
        for key, value in table.items():
            kind = LIMIT_KINDS.get(key)
            message = _said(left, owners, key)
            hint = kind.example if kind else ""
            fields.append(Field(("limit", place, key), label_of(key), text_of(value, kind), hint, message))
        rest = [e for e in left if _owns(e, owners)]
        for error in rest:
            left.remove(error)
        addable = tuple(k for k in Limit.model_fields if k not in table)
        return Group(("limit", place), f"limit of {of}", "limit", tuple(fields), addable, "\n".join(map(str, rest)))


_EXAMPLES: dict[str, dict[str, Any]] = {
    "Shaft": {"stiffness": "12 kN*m/rad", "damping": "3 N*m*s/rad"},
    "Coupling": {"stiffness": "12 kN*m/rad", "relative_damping": 0.8},
    "Clutch": {"stiffnesses": ["800 N*m/rad"], "friction": [{"torque": "6 N*m", "stiffness": "4 kN*m/rad"}]},
    "Disk": {"inertia": "0.4 kg*m^2"},
    "HookeJoint": {"angle": "12 deg"},
    "IdealJoint": {"angle": "12 deg"},
    "TripodJoint": {"angle": "8 deg", "radius": "30 mm", "length": "0.5 m"},
    "RzeppaJoint": {"angle": "8 deg"},
    "DoubleCardanJoint": {"angle": "20 deg"},
    "Ratio": {"teeth_in": 10, "teeth_out": 41},
}
"""What a new element starts with."""


def _texts_kept(data: dict[str, Any], before: dict[str, Any], line: Driveline) -> dict[str, Any]:
    """``data`` of ``line`` with the numbers of elements as ``before`` wrote them where they stay, and short where they
    change. A field that was stated stays so with its default value too, which ``data`` leaves out."""
    for key, value in before.items():
        if key not in data and key in Driveline.model_fields and getattr(line, key) == value:
            data[key] = value
    tables = zip(data.get("element", []), before.get("element", []), line.elements, strict=False)
    for place, (new, old, element) in enumerate(tables):
        model = KINDS.get(str(new.get("type", "")))
        if model is None or old.get("type") != new.get("type"):
            continue
        added = {k: getattr(element, k) for k in old if k not in new and k in model.model_fields}
        stated = new | {k: v for k, v in added.items() if isinstance(v, str | int | float)}
        new = data["element"][place] = {k: stated[k] for k in dict.fromkeys([*old, *new]) if k in stated}
        for key, text in new.items():
            kind = model.quantity_of(key) if key in model.model_fields else None
            if kind is not None and isinstance(text, str | int | float):
                new[key] = _kept(text, old.get(key), kind)
    return data


def _kept(text: str | float, old: Any, kind: Kind) -> Any:
    try:
        value = parse(text, kind)
        if isinstance(old, str | int | float) and not isinstance(old, bool) and parse(old, kind) == value:
            return old
        unit, size = next(((u, s) for u, s, least in kind.shown if abs(value) >= least), (kind.unit, 1.0))
        short = f"{value / size:.8g} {unit}"
        return short if abs(parse(short, kind) - value) <= ROUNDING * abs(value) else text
    except InputError:
        return text


def _names(tables: list[Any]) -> list[str]:
    seen: dict[str, int] = {}
    names = []
    for table in tables:
        kind = str(table.get("type", "element"))
        seen[kind] = seen.get(kind, 0) + 1
        names.append(str(table.get("name") or f"{kind} {seen[kind]}"))
    return names


def _disks(tables: list[Any]) -> list[str]:
    """Names of the elements that a load acts on."""
    return [n for n, t in zip(_names(tables), tables, strict=True) if t.get("type") == "Disk"]


def _owns(error: InputError, owners: tuple[Any, ...]) -> bool:
    place = _PLACE.search(error.element)
    number = int(place.group(1) or place.group(2)) if place else None
    return error.element in owners or (number is not None and ("element", number) in owners)


def _said(left: list[InputError], owners: tuple[Any, ...], key: str) -> str:
    """What is said of one field; taken off the list of what is still to be said."""
    mine = [e for e in left if e.key == key and _owns(e, owners)]
    for error in mine:
        left.remove(error)
    return "; ".join(f"{e.problem}{'; ' + e.remedy if e.remedy else ''}" for e in mine)


def _read(text: str) -> Any:
    """What was typed, as a file would hold it: a number, a list or table in TOML, or a text."""
    text = text.strip()
    if text[:1] in "[{\"'" or re.fullmatch(r"[+-]?[0-9][0-9_]*|[+-]?[0-9.]+([eE][+-]?[0-9]+)?|true|false", text):
        try:
            return tomllib.loads(f"value = {text}")["value"]
        except (tomllib.TOMLDecodeError, RecursionError, ValueError):
            return text
    return text
