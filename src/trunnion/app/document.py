"""The driveline that a session edits: the content of a file, its last valid line, what is wrong with it, undo.

Whatever is typed goes through the reader of driveline files; a field whose text is refused keeps the text, with the
refusal beside it, and the views keep the last line that was accepted.
"""

from __future__ import annotations

import re
import tomllib
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from copy import deepcopy
from typing import Any

import tomli_w

from trunnion.app.form import LOAD_CASE, LOADS, SWITCHED_OFF, Group, Path, disks_of, form
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.files import dumps, loads
from trunnion.driveline.kinds import KINDS
from trunnion.driveline.quantities import Kind, eye_unit, parse
from trunnion.driveline.rules import RULES
from trunnion.errors import InputError, InputRemark

MOST_STEPS = 200
"""Steps that can be undone."""
ROUNDING = 1e-15
"""What a number may lose when it is written short."""
LARGEST_FILE = 1_000_000
"""Characters of a file that is taken from the browser."""
_WORDS = ("name", "description", "after", "of", "speed_unit", "application", "rule", "reason")


class Document:
    """A driveline under edit."""

    def __init__(self, text: str) -> None:
        self.line: Driveline = loads(text)
        self._history: list[dict[str, Any]] = [tomllib.loads(text)]
        self._now = 0
        self.toml = text
        self.problems: tuple[InputError, ...] = ()
        self._mover = ""

    @property
    def data(self) -> dict[str, Any]:
        """The content of the file, as it is typed."""
        return self._history[self._now]

    def groups(self) -> tuple[Group, ...]:
        """Everything that can be edited, problems beside the fields they concern."""
        return form(self.data, self.problems)

    # -- changes ------------------------------------------------------------------------------------------------

    def set_text(self, path: Path, text: str) -> None:
        """Put what was typed into a field; an empty text takes the field away."""
        last = path[-1]
        with self._changing() as data:
            owner: Any = data
            for key, following in zip(path, path[1:], strict=False):
                if isinstance(key, str) and key not in owner:
                    owner[key] = [] if isinstance(following, int) else {}
                owner = owner[key]
            value = text.strip() if last in _WORDS and LOADS not in path else _read(text)
            if isinstance(owner, dict) and not text.strip():
                owner.pop(last, None)
            elif text.strip() and isinstance(owner, list) and isinstance(last, int) and last >= len(owner):
                owner.append(value)
            elif text.strip():
                owner[last] = value

    def set_numbers(self, line: Driveline, by: str = "") -> None:
        """Take over a line whose numbers were changed elsewhere; moves of one slider ``by`` are undone as one."""
        data = _texts_kept(tomllib.loads(dumps(line)), self.data, line)
        if by and by == self._mover:
            self._history[self._now] = data
            self._judge()
            return
        self._take(data)
        self._mover = by

    def add_element(self, place: int, kind: str) -> None:
        """A new element of a kind before ``place``, with the example of its kind."""
        with self._changing() as data:
            data.setdefault("element", []).insert(place, {"type": kind} | _EXAMPLES.get(kind, {}))

    def add_limit(self, of: str) -> None:
        """An empty limit of an element."""
        with self._changing() as data:
            data.setdefault("limit", []).append({"of": of, "vibratory_torque": "500 N*m"})

    def add_load_case(self) -> None:
        """A load case with a torque at the last disk, and a name that no other one has."""
        with self._changing() as data:
            cases = data.setdefault("operation", {}).setdefault(LOAD_CASE, [])
            taken = {str(case.get("name", "")) for case in cases}
            name = next(n for n in (f"load {k}" for k in range(1, len(cases) + 2)) if n not in taken)
            disks = disks_of(data.get("element", []))
            cases.append({"name": name, LOADS: {disks[-1]: "100 N*m"} if disks else {}})

    def switch_off(self) -> None:
        """Switch off a rule that is not off yet; until its reason is given the line stays as it was."""
        with self._changing() as data:
            off = data.setdefault("operation", {}).setdefault(SWITCHED_OFF, [])
            taken = {one.get("rule") for one in off if isinstance(one, dict)}
            rule = next((name for name, one in RULES.items() if one.guideline and name not in taken), "")
            off.append({"rule": rule, "reason": ""})

    def remove(self, path: Path) -> None:
        """Take an element, a limit, a load case or a rule switched off away."""
        *outer, section, place = path
        with self._changing() as data:
            owner: Any = data
            for key in outer:
                owner = owner[key]
            del owner[section][place]
            if not owner[section]:
                del owner[section]

    def move(self, place: int, by: int) -> None:
        """Move an element toward the drive (−1) or the load (+1)."""
        with self._changing() as data:
            elements = data["element"]
            if 0 <= place + by < len(elements):
                elements.insert(place + by, elements.pop(place))

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
        yield data
        self._take(data)

    def _take(self, data: dict[str, Any]) -> None:
        if data == self.data:
            return
        self._history = [*self._history[: self._now + 1][-MOST_STEPS:], data]
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
                self.problems = ()
                self.toml = text  # as typed: what is stated stays so, be it a default


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
        unit, size = eye_unit(value, kind)
        short = f"{value / size:.8g} {unit}"
        return short if abs(parse(short, kind) - value) <= ROUNDING * abs(value) else text
    except InputError:
        return text


def _read(text: str) -> Any:
    """What was typed, as a file would hold it: a number, a list or table in TOML, or a text."""
    text = text.strip()
    if text[:1] in "[{\"'" or re.fullmatch(r"[+-]?[0-9][0-9_]*|[+-]?[0-9.]+([eE][+-]?[0-9]+)?|true|false", text):
        try:
            return tomllib.loads(f"value = {text}")["value"]
        except (tomllib.TOMLDecodeError, RecursionError, ValueError):
            return text
    return text
