"""Numbers beside their units in text."""

from __future__ import annotations

from trunnion.driveline.quantities import KINDS, SPEED, shown


def signs(text: str) -> str:
    """A unit, or a number with its unit, as a page prints it: "N·m", "kg·m²"."""
    return text.replace("*", "·").replace("^2", "²").replace("^3", "³")


def with_unit(text: str, unit: str) -> str:
    """``text`` and its unit; the unit 1 of what has no dimension is left out."""
    return text if unit == "1" else f"{text} {unit}"


def in_words(value: float, unit: str, digits: int = 4) -> str:
    """A value in SI with an engineer's unit, "32.8 kN*m/rad"; what is in rad/s is a frequency."""
    kind = next((kind for kind in KINDS if kind.unit == unit and kind is not SPEED), None)
    return with_unit(f"{value:.4g}", unit) if kind is None or unit == "1" else shown(value, kind, digits=digits)
