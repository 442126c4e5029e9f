"""Fields of a description as text: their names, and their values with units."""

from __future__ import annotations

import re
from typing import Any

from trunnion.driveline.quantities import RATIO, QuantityKind


def label_of(key: str) -> str:
    """ "fork_offset" as a reader says it."""
    return key.replace("_", " ")


def text_of(value: Any, kind: QuantityKind | None) -> str:
    """A value as text in a field, numbers with their unit."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        return f"{value!r} {kind.unit}" if kind and kind is not RATIO else repr(value)
    if isinstance(value, str):
        return value
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{_key(k)} = {_inline(v)}" for k, v in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(_inline, value)) + "]"
    return str(value)


def _inline(value: Any) -> str:
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    return text_of(value, None)


def _key(key: str) -> str:
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else _inline(key)
