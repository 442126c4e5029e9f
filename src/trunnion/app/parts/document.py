"""The driveline that a session edits: the content of a file, its last valid line, what is wrong with it, undo.

Whatever is typed goes through the reader of driveline files; a field whose text is refused keeps the text, with the
refusal beside it, and the views keep the last line that was accepted.
"""

from __future__ import annotations

import re
import tomllib
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from copy import deepcopy
from dataclasses import dataclass, replace
from itertools import count
from typing import Any

import tomli_w

from trunnion.app.parts.chain_edits import ChainEdit, chain_of
from trunnion.app.parts.form import (
    ANGLES,
    FACTORS,
    LISTS,
    LOAD_CASE,
    LOADS,
    SCHEDULE,
    SWITCHED_OFF,
    FieldGroup,
    Path,
    about,
    disks_of,
    form,
    joints_of,
    names_of,
)
from trunnion.driveline.component_files import find, with_sheet
from trunnion.driveline.csv_table import UNKNOWN_FILE
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.files import dumps, loads
from trunnion.driveline.rewriting import Rewritten, rewritten
from trunnion.driveline.rules import RULES
from trunnion.driveline.texts_kept import quantities_kept, texts_kept
from trunnion.driveline.title_block import TitleBlock
from trunnion.errors import InputError, InputRemark

MOST_STEPS = 200
"""Steps that can be undone."""
LARGEST_FILE = 1_000_000
"""Characters of a file that is taken from the browser."""
_WORDS = (
    *("name", "description", "after", "of", "speed_unit", "application", "rule", "reason"),
    *TitleBlock.model_fields,
)
PLACED = ("name", "after", "to")
"""What an element keeps that is made of another component: what it is called and where it stands."""


@dataclass(frozen=True)
class _DocumentState:
    """The content of the file, and a key for each of its listed tables by list, which it keeps wherever it moves."""

    data: dict[str, Any]
    keys: Mapping[Path, list[int]]
    file: _OpenedFile


@dataclass(frozen=True)
class _OpenedFile:
    """The text that was opened, and the keys of its listed tables."""

    text: str
    keys: Mapping[Path, list[int]]


class Document:
    """A driveline under edit."""

    def __init__(self, text: str) -> None:
        self.line: Driveline = loads(text)
        data = _with_sheets(tomllib.loads(text))
        self._fresh = count(1)
        keys = self._new_keys(data)
        self._history = [_DocumentState(data, keys, _OpenedFile(text, keys))]
        self._now = 0
        self.toml = text
        self._accepted = self._history[0]
        self.problems: tuple[InputError, ...] = ()
        self._mover = ""

    @property
    def data(self) -> dict[str, Any]:
        """The content of the file, as it is typed."""
        return self._history[self._now].data

    def groups(self) -> tuple[FieldGroup, ...]:
        """Everything that can be edited, problems beside the fields they concern."""
        keys, made = self._history[self._now].keys, []
        for group in form(self.data, self.problems):
            section = _section(group.path)
            made.append(replace(group, key=keys[section][int(group.path[-1])]) if section else group)
        return tuple(made)

    @property
    def element_keys(self) -> list[int]:
        """Of the elements of ``line``, which was accepted last."""
        return list(self._accepted.keys["element",])

    def about(self, name: str) -> tuple[FieldGroup, ...]:
        """Fields of an element of ``line``, its limits, and what load cases and schedules say of it."""
        names = self.line.as_stated.names
        if name not in names:
            return ()
        place = self.place(("element", names.index(name)), self.element_keys[names.index(name)])
        return about(self.groups(), int(place[1])) if place else ()

    def file(self) -> Rewritten:
        """The file to save: the one opened with what was changed, comments and layout kept; the last valid line."""
        state = self._accepted
        same = {
            section: [opened.index(key) if key in opened else None for key in keys]
            for section, keys in state.keys.items()
            if (opened := state.file.keys[section])
        }
        data = quantities_kept(state.data, tomllib.loads(state.file.text))
        return rewritten(state.file.text, data, same, with_sheet)

    def place(self, path: Path, key: int) -> Path | None:
        """Where a field or a table is now whose ``path`` was read when its table had the ``key``; None: it is gone."""
        section = _section(path)
        if section is None:
            return path
        keys, at = self._history[self._now].keys[section], len(section)
        return (*section, keys.index(key), *path[at + 1 :]) if key in keys else None

    def _new_keys(self, data: dict[str, Any]) -> dict[Path, list[int]]:
        """A key for every table of a list."""
        return {section: [next(self._fresh) for _ in _listed(data, section)] for section in LISTS}

    # -- changes ------------------------------------------------------------------------------------------------

    def set_text(self, path: Path, text: str) -> None:
        """Put what was typed into a field; an empty text takes the field away."""
        last = path[-1]
        with self._changing() as data:
            owner: Any = data
            for key, following in zip(path, path[1:], strict=False):
                if isinstance(key, str) and key not in owner:
                    if not text.strip():
                        return  # what is not there need not be taken away
                    owner[key] = [] if isinstance(following, int) else {}
                owner = owner[key]
            value = (
                text.strip() if last in _WORDS and path[-2:-1] not in ((LOADS,), (ANGLES,), (FACTORS,)) else _read(text)
            )
            if isinstance(owner, dict) and not text.strip():
                owner.pop(last, None)
            elif text.strip() and isinstance(owner, list) and isinstance(last, int) and last >= len(owner):
                owner.append(value)
            elif text.strip():
                owner[last] = value

    def set_numbers(self, line: Driveline, by: str = "") -> None:
        """Take over a line whose numbers were changed elsewhere; moves of one slider ``by`` are undone as one.

        Raises
        ------
        InputError : what is typed is refused: the numbers are those of an earlier line.
        """
        if self.problems:
            remedy = "mend it in the table of Driveline, or undo it"
            raise InputError("holds what is refused, so no number can be moved", element="driveline", remedy=remedy)
        data = texts_kept(tomllib.loads(dumps(line)), self.data, line)
        if by and by == self._mover:
            self._history[self._now] = replace(self._history[self._now], data=data)
            self._judge()
            return
        self._take(data)
        self._mover = by

    def add_element(self, place: int, kind: str) -> None:
        """A new element of a kind before ``place``, with the example of its kind, or a component, "maker/type"."""
        with self._changing_chain() as (chain, fresh):
            if place < len(chain.nodes):
                chain.put_in_front(max(place, 0), _made(kind), fresh)
            elif chain.nodes:
                chain.put_behind(len(chain.nodes) - 1, _made(kind), fresh)
            else:
                chain.begin(_made(kind), fresh)

    def insert(self, place: int, kind: str, front: bool) -> None:
        """A new element in front of, or behind, that at ``place``, in its own chain."""
        with self._changing_chain() as (chain, fresh):
            (chain.put_in_front if front else chain.put_behind)(place, _made(kind), fresh)

    def make_of(self, place: int, component: str) -> None:
        """Have the element at ``place`` be of a component, "maker/type": its numbers and its sheet, the name kept."""
        with self._changing() as data, self._names_kept(data):
            before = data["element"][place]
            data["element"][place] = _made(component) | {key: before[key] for key in PLACED if key in before}

    def branch(self, place: int, kind: str) -> None:
        """A new element on a branch of its own that leaves from that at ``place``."""
        with self._changing_chain() as (chain, fresh):
            chain.branch(place, _made(kind), fresh)

    def add_limit(self, of: str) -> None:
        """An empty limit of an element."""
        with self._changing() as data:
            data.setdefault("limit", []).append({"of": of, "vibratory_torque": "500 N*m"})
            self._append_key("limit")

    def add_load_case(self) -> None:
        """A load case with a torque at the last disk, and a name that no other one has."""
        with self._changing() as data:
            cases = data.setdefault("operation", {}).setdefault(LOAD_CASE, [])
            disks = disks_of(data.get("element", []))
            cases.append({"name": _free_name("load", cases), LOADS: {disks[-1]: "100 N*m"} if disks else {}})
            self._append_key("operation", LOAD_CASE)

    def add_schedule(self) -> None:
        """A schedule over suspension travel of the first joint, or without one over speed of the last disk."""
        with self._changing() as data:
            schedules = data.setdefault("operation", {}).setdefault(SCHEDULE, [])
            elements = data.get("element", [])
            name, joints, disks = _free_name("schedule", schedules), joints_of(elements), disks_of(elements)
            if joints or not disks:
                angle = elements[names_of(elements).index(joints[0])].get("angle", "12 deg") if joints else "12 deg"
                follows = {"travel": ["0 mm", "100 mm"], ANGLES: {one: [angle, angle] for one in joints[:1]}}
            else:
                follows = {"speed": ["300 rpm", "3000 rpm"], LOADS: {disks[-1]: ["0 N*m", "100 N*m"]}}
            schedules.append({"name": name, **follows})
            self._append_key("operation", SCHEDULE)

    def begin_empty(self) -> None:
        """No element at all; until there are enough of them for a line, the last one stays in the views."""
        none: dict[Path, list[int]] = {section: [] for section in LISTS}
        self._take({"format": self.data.get("format", 1)}, none, _OpenedFile("", none))

    def switch_off(self) -> None:
        """Switch off a rule that is not off yet; until its reason is given the line stays as it was."""
        with self._changing() as data:
            off = data.setdefault("operation", {}).setdefault(SWITCHED_OFF, [])
            taken = {one.get("rule") for one in off if isinstance(one, dict)}
            rule = next((name for name, one in RULES.items() if one.guideline and name not in taken), "")
            off.append({"rule": rule, "reason": ""})
            self._append_key("operation", SWITCHED_OFF)

    def remove(self, path: Path) -> None:
        """Take an element, a limit, a load case, a schedule or a rule switched off away."""
        *outer, section, place = path
        with self._changing() as data, self._names_kept(data):
            if section == "element":
                with chain_of(data["element"], self._changed_keys["element",]) as chain:
                    chain.remove(int(place))
                if not data["element"]:
                    del data["element"]
                return
            owner: Any = data
            for key in outer:
                owner = owner[key]
            del owner[section][place]
            del self._changed_keys[*outer, section][int(place)]
            if not owner[section]:
                del owner[section]

    def move(self, place: int, by: int) -> None:
        """Move an element toward the drive (−1) or the load (+1) along its chain."""
        with self._changing_chain() as (chain, _):
            chain.step(place, by)

    def put(self, place: int, target: int, front: bool) -> None:
        """Move an element to the front of, or behind, that at ``target``; branches that leave from it come along."""
        with self._changing_chain() as (chain, _):
            chain.move(place, target, front)

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
            try:
                loads(text)
            except InputError as error:
                raise error.each(_from_elsewhere) from None
        data = _with_sheets(tomllib.loads(text))
        keys = self._new_keys(data)
        self._take(data, keys, _OpenedFile(text, keys))

    def undo(self) -> bool:
        """Take the last change back."""
        return self._step(-1)

    def redo(self) -> bool:
        """Make it again."""
        return self._step(1)

    def can_step(self, by: int) -> bool:
        """Whether there is a change to take back (−1) or to make again (+1)."""
        return 0 <= self._now + by < len(self._history)

    def _step(self, by: int) -> bool:
        if not self.can_step(by):
            return False
        self._now += by
        self._mover = ""
        self._judge()
        return True

    @contextmanager
    def _changing(self) -> Iterator[dict[str, Any]]:
        """A copy of the content to change, then taken over."""
        data = deepcopy(self.data)
        self._changed_keys = {section: list(keys) for section, keys in self._history[self._now].keys.items()}
        yield data
        self._take(data, self._changed_keys)

    @contextmanager
    def _changing_chain(self) -> Iterator[tuple[ChainEdit, int]]:
        """The elements to change, and a key for one more."""
        with self._changing() as data, self._names_kept(data):
            elements = data.setdefault("element", [])
            with chain_of(elements, self._changed_keys["element",]) as chain:
                yield chain, next(self._fresh)

    @contextmanager
    def _names_kept(self, data: dict[str, Any]) -> Iterator[None]:
        """While elements come, go and move, what is said of one by the name of its kind and number stays said of it.

        "HookeJoint 2" is the first once the one before it is gone; it is then given that name, where a limit, a load, a
        schedule or a branch speaks of it or of the name that it would get."""
        before = dict(zip(self._changed_keys["element",], names_of(data.get("element", [])), strict=True))
        yield
        elements, keys, spoken_of = data.get("element", []), self._changed_keys["element",], _spoken_of(data)
        for table, key, name in zip(elements, keys, names_of(elements), strict=True):
            if key in before and name != before[key] and {name, before[key]} & spoken_of:
                table["name"] = before[key]
        names = names_of(elements)
        for table, key, name in zip(elements, keys, names, strict=True):
            if key not in before and names.count(name) > 1:
                table["name"] = next(n for k in count(1) if (n := f"{table['type']} {k}") not in names)

    def _append_key(self, *section: str) -> None:
        """A key for a table that was put at the end of its list."""
        self._changed_keys[section].append(next(self._fresh))

    def _take(
        self,
        data: dict[str, Any],
        keys: Mapping[Path, list[int]] | None = None,
        file: _OpenedFile | None = None,
    ) -> None:
        if data == self.data and (file is None or file.text == self._history[self._now].file.text):
            return
        if keys is None or any(len(_listed(data, section)) != len(own) for section, own in keys.items()):
            own, opened = self._history[self._now].keys, self._history[self._now].file
            alike = {section: len(_listed(data, section)) == len(one) for section, one in own.items()}
            keys = own if all(alike.values()) else self._new_keys(data)
            if keys is not own:  # which of the tables is which is no longer known
                file = _OpenedFile(opened.text, {section: [] for section in LISTS})
        made = _DocumentState(data, keys, file or self._history[self._now].file)
        self._history = [*self._history[: self._now + 1][-MOST_STEPS:], made]
        self._now = len(self._history) - 1
        self._mover = ""
        self._judge()

    def _judge(self) -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", InputRemark)
            text = tomli_w.dumps(self.data)
            try:
                self.line = loads(text)
            except InputError as error:
                self.problems = error.problems
            else:
                self.problems, self._accepted = (), self._history[self._now]
                self.toml = text  # as typed: what is stated stays so, be it a default


def _from_elsewhere(error: InputError) -> InputError:
    """A browser hands over the file alone, without the folder that it comes from."""
    if error.problem != UNKNOWN_FILE:
        return error
    return error.but(remedy="begin with the file, trunnion app FILE: tables beside it are read too")


def _made(kind: str) -> dict[str, Any]:
    """The table of a new element."""
    return deepcopy(find(kind).table if "/" in kind else {"type": kind} | _EXAMPLES.get(kind, {}))


def _with_sheets(data: dict[str, Any]) -> dict[str, Any]:
    """The same with the numbers of its sheet in place of every component that is named."""
    return data | {"element": [with_sheet(table) for table in data["element"]]} if "element" in data else data


def _section(path: Path) -> tuple[str, ...] | None:
    """The list that a field or a table belongs to, if to any."""
    return next((one for one in LISTS if path[: len(one)] == one and len(path) > len(one)), None)


def _listed(data: dict[str, Any], section: Path) -> list[Any]:
    """The tables of a list, none where it is not a list."""
    owner: Any = data
    for key in section:
        owner = owner.get(key, []) if isinstance(owner, dict) else []
    return owner if isinstance(owner, list) else []


def _free_name(word: str, tables: list[Any]) -> str:
    """The first of "WORD 1", "WORD 2" that none of the tables has."""
    taken = {str(one.get("name", "")) for one in tables if isinstance(one, dict)}
    return next(n for k in count(1) if (n := f"{word} {k}") not in taken)


def _spoken_of(data: dict[str, Any]) -> set[str]:
    """Names of elements that limits, loads, schedules and branches use."""
    found = {str(one.get("of", "")) for one in _listed(data, ("limit",)) if isinstance(one, dict)}
    found |= {str(one[key]) for one in data.get("element", []) for key in ("after", "to") if key in one}
    for section in (LOAD_CASE, SCHEDULE):
        for one in _listed(data, ("operation", section)):
            for key in (LOADS, ANGLES, FACTORS) if isinstance(one, dict) else ():
                found |= set(one.get(key) or {})
    return found


_EXAMPLES: dict[str, dict[str, Any]] = {
    "Shaft": {"stiffness": "12 kN*m/rad", "damping": "3 N*m*s/rad"},
    "Coupling": {"stiffness": "12 kN*m/rad", "relative_damping": 0.8},
    "Clutch": {"stiffnesses": ["800 N*m/rad"], "friction": [{"torque": "6 N*m", "stiffness": "4 kN*m/rad"}]},
    "SlipClutch": {"torque": "1200 N*m"},
    "TorqueConverter": {
        "curves": [
            {"speed_ratio": 0, "torque_ratio": 2.1, "capacity": 0.0042},
            {"speed_ratio": 0.85, "torque_ratio": 1, "capacity": 0.003},
            {"speed_ratio": 1, "torque_ratio": 1, "capacity": 0},
        ]
    },
    "Disk": {"inertia": "0.4 kg*m^2"},
    "Engine": {
        "firing_order": "1-3-4-2",
        "throw_inertia": "0.02 kg*m^2",
        "throw_stiffness": "0.6 MN*m/rad",
        "gas_torque": [{"order": 2, "amplitude": "90 N*m"}],
    },
    "Motor": {
        "inertia": "0.4 kg*m^2",
        "breakdown_torque": "500 N*m",
        "breakdown_slip": 0.2,
        "synchronous_speed": "1500 rpm",
    },
    "Generator": {"inertia": "0.4 kg*m^2", "power": "30 kW"},
    "Fan": {"inertia": "3 kg*m^2", "rated_power": "30 kW", "rated_speed": "1480 rpm"},
    "Pump": {"inertia": "0.3 kg*m^2", "rated_power": "30 kW", "rated_speed": "1480 rpm"},
    "Propeller": {"inertia": "60 kg*m^2", "rated_power": "900 kW", "rated_speed": "300 rpm"},
    "Brake": {"inertia": "0.3 kg*m^2", "torque": "200 N*m"},
    "HookeJoint": {"angle": "12 deg"},
    "IdealJoint": {"angle": "12 deg"},
    "TripodJoint": {"angle": "8 deg", "radius": "30 mm", "length": "0.5 m"},
    "RzeppaJoint": {"angle": "8 deg"},
    "DoubleCardanJoint": {"angle": "20 deg"},
    "ViscousDamper": {"ring_inertia": "0.12 kg*m^2", "damping": "45 N*m*s/rad"},
    "TunedDamper": {"ring_inertia": "0.02 kg*m^2", "stiffness": "1.5 kN*m/rad", "damping": "2 N*m*s/rad"},
    "CentrifugalPendulum": {"mass": "1.2 kg", "radius": "80 mm", "order": 2},
    "Belt": {"radius_in": "60 mm", "radius_out": "150 mm", "span_stiffness": "4e5 N/m"},
    "DualMassFlywheel": {
        "primary_inertia": "0.14 kg*m^2",
        "secondary_inertia": "0.06 kg*m^2",
        "stiffnesses": ["15 N*m/deg"],
    },
    "Ratio": {"teeth_in": 10, "teeth_out": 41},
    "Differential": {"teeth_in": 10, "teeth_out": 41},
    "Tyre": {"stiffness": "15 kN*m/rad", "damping": "200 N*m*s/rad"},
    "Vehicle": {"mass": "1600 kg", "wheel_radius": "0.31 m"},
    "Planetary": {"teeth_sun": 30, "teeth_ring": 72, "input": "sun", "held": "ring"},
}
"""What a new element starts with."""


def _read(text: str) -> Any:
    """What was typed, as a file would hold it: a number, a list or table in TOML, or a text."""
    text = text.strip()
    if text[:1] in "[{\"'" or re.fullmatch(r"[+-]?[0-9][0-9_]*|[+-]?[0-9.]+([eE][+-]?[0-9]+)?|true|false", text):
        try:
            return tomllib.loads(f"value = {text}")["value"]
        except (tomllib.TOMLDecodeError, RecursionError, ValueError):
            return text
    return text
