"""Numbers beside their units in text."""

from __future__ import annotations


def with_unit(text: str, unit: str) -> str:
    """``text`` and its unit; the unit 1 of what has no dimension is left out."""
    return text if unit == "1" else f"{text} {unit}"
