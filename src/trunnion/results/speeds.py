"""Speeds and frequencies in the unit a reader thinks in."""

from __future__ import annotations

from math import pi

from trunnion.errors import InputError

PER_RADIAN_PER_SECOND = {"rad/s": 1.0, "rpm": 60 / (2 * pi), "Hz": 1 / (2 * pi)}


def speed_factor(unit: str) -> float:
    """What a speed in rad/s is multiplied by to read in ``unit``: "rpm", "Hz" or "rad/s"."""
    try:
        return PER_RADIAN_PER_SECOND[unit]
    except KeyError:
        known = ", ".join(PER_RADIAN_PER_SECOND)
        raise InputError("is not a unit of speed", key="unit", value=unit, remedy=f"use one of {known}") from None


def frequency_unit(speed_unit: str | None) -> str:
    """What frequencies read in where speeds read in ``speed_unit``: Hz, or rad/s for a line in rad/s and for equations
    of one's own (None)."""
    return "rad/s" if speed_unit in ("rad/s", None) else "Hz"


def show_speed(speed: float, unit: str = "rad/s") -> str:
    """``1500 rpm``: six figures at most."""
    return f"{speed * speed_factor(unit):.6g} {unit}"
