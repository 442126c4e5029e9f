"""What two descriptions differ in, place by place; elements are matched by their names."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from typing import Any

from trunnion.driveline.driveline import Driveline
from trunnion.driveline.field_text import label_of, text_of
from trunnion.driveline.files import dumps
from trunnion.driveline.kinds import KINDS
from trunnion.driveline.limits import LIMIT_KINDS
from trunnion.driveline.operation import Operation
from trunnion.driveline.quantities import QuantityKind, shown, signs

NOTHING = "none"
WHOLE = ""
"""Element of what belongs to the whole line."""


@dataclass(frozen=True)
class Change:
    """One place that differs: the element ("" for the whole line, "limit of …", "operation"), the key as a reader says
    it ("" where the element itself was added or removed), and both values as text with units, "none" where
    missing."""

    element: str
    key: str
    before: str
    after: str

    @property
    def place(self) -> str:
        """ "Shaft 1, stiffness"."""
        return ", ".join(part for part in (self.element, self.key) if part)

    def __str__(self) -> str:
        if not self.key:
            return f"{self.element} added: {self.after}" if self.before == NOTHING else f"{self.element} removed"
        return f"{self.place}: {self.before} → {self.after}"


def changes(before: Driveline, after: Driveline) -> tuple[Change, ...]:
    """All places in which two descriptions differ, in the order of the first, then of the second."""
    a, b = _tables(before), _tables(after)
    found = []
    for owner in dict.fromkeys([*a, *b]):
        one, two = a.get(owner), b.get(owner)
        if one is None or two is None:
            whole = [NOTHING if table is None else _whole(table) for table in (one, two)]
            found.append(Change(owner, "", *whole))
            continue
        for key in dict.fromkeys([*one, *two]):
            if one.get(key) != two.get(key):
                found.append(Change(owner, key, *(table.get(key) or _left_out(table, key) for table in (one, two))))
    common = [name for name in before.names if name in after.names]
    moved = [name for name in after.names if name in before.names]
    if common != moved:
        found.append(Change(WHOLE, "order of elements", ", ".join(before.names), ", ".join(after.names)))
    return tuple(found)


def _whole(table: dict[str, str]) -> str:
    rest = ", ".join(f"{key} {value}" for key, value in table.items() if key not in ("type", "name"))
    return f"{table['type']} with {rest}" if "type" in table and rest else table.get("type", rest)


def _tables(line: Driveline) -> dict[str, dict[str, str]]:
    """Texts by owner and key."""
    data = tomllib.loads(dumps(line))
    found: dict[str, dict[str, str]] = {WHOLE: {}}
    for name, table in zip(line.names, data.pop("element"), strict=True):
        found[name] = {label_of(k): _read(v, _kind(table, k)) for k, v in table.items() if k != "name"}
    found["operation"] = {label_of(k): _running(k, v) for k, v in data.pop("operation", {}).items()}
    for table in data.pop("limit", []):
        own = found.setdefault(f"limit of {table['of']}", {})
        own |= {label_of(k): _read(v, LIMIT_KINDS.get(k)) for k, v in table.items() if k != "of"}
    found[WHOLE] = {label_of(key): text_of(value, None) for key, value in data.items() if key != "format"}
    return found


def _left_out(table: dict[str, str], label: str) -> str:
    """What a key that an element does not state stands at: "0 deg", or "none"."""
    model = KINDS.get(table.get("type", "").strip('"'))
    if model is None:
        return NOTHING
    for key, field in model.model_fields.items():
        if label_of(key) == label and isinstance(field.default, float) and (kind := model.quantity_of(key)):
            return shown(field.default, kind)
    return NOTHING


def _running(key: str, value: Any) -> str:
    """A value of the operation; numbers without a unit get theirs."""
    kind = Operation.quantity_of(key) if key in Operation.model_fields else None
    numbers = isinstance(value, list) and not any(isinstance(end, str) for end in value)
    return f"{text_of(value, None)} {signs(kind.unit)}" if kind and numbers else _read(value, kind)


def _read(value: Any, kind: QuantityKind | None) -> str:
    """A value as a reader says it; what is no quantity, as the file does."""
    return text_of(value, None) if kind is None else signs(text_of(value, kind))


def _kind(table: dict[str, Any], key: str) -> Any:
    model = KINDS[table["type"]]
    return model.quantity_of(key) if key in model.model_fields else None
