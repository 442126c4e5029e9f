"""Numbers as a file wrote them: where a number stays, its text stays; where it changes, the new text is short."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from trunnion.driveline.driveline import Driveline
from trunnion.driveline.kinds import KINDS
from trunnion.driveline.quantities import QUANTITY_KINDS, QuantityKind, eye_unit, parse
from trunnion.errors import InputError

ROUNDING = 1e-15
"""What a number may lose when it is written short."""


def texts_kept(data: dict[str, Any], before: dict[str, Any], line: Driveline) -> dict[str, Any]:
    """``data`` of ``line`` with the numbers of elements as ``before`` wrote them where they stay, and short where they
    change. A field that was stated stays so with its default value too, which ``data`` leaves out."""
    for key, value in before.items():
        if key not in data and key in Driveline.model_fields and getattr(line, key) == value:
            data[key] = value
    tables = zip(data.get("element", []), before.get("element", []), line.as_stated.elements, strict=False)
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


def _kept(text: str | float, old: Any, kind: QuantityKind) -> Any:
    try:
        value = parse(text, kind)
        if isinstance(old, str | int | float) and not isinstance(old, bool) and parse(old, kind) == value:
            return old
        unit, size = eye_unit(value, kind)
        short = f"{value / size:.8g} {unit}"
        return short if abs(parse(short, kind) - value) <= ROUNDING * abs(value) else text
    except InputError:
        return text


def quantities_kept(new: Any, old: Any, texts: bool = False) -> Any:
    """``new`` with the texts of ``old`` in place of plain numbers that say the same, as 250 for "250 N*m"; and in place
    of other ``texts`` that do, as "0.1 GPa" for "100 MPa"."""
    if isinstance(new, dict) and isinstance(old, dict):
        return {key: quantities_kept(value, old.get(key), texts) for key, value in new.items()}
    if isinstance(new, list) and isinstance(old, list) and len(new) == len(old):
        return [quantities_kept(one, other, texts) for one, other in zip(new, old, strict=True)]
    if (
        not isinstance(old, str)
        or isinstance(new, bool)
        or not isinstance(new, (int, float, str) if texts else (int, float))
    ):
        return new
    return old if new != old and any(_same(new, old)) else new


def _same(new: str | float, old: str) -> Iterator[bool]:
    """For every kind of quantity that both can be, whether they are the same one."""
    for kind in QUANTITY_KINDS:
        try:
            yield parse(old, kind) == parse(new, kind)
        except InputError:
            continue
