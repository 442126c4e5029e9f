"""Speeds and frequencies in the unit a reader thinks in."""

from __future__ import annotations

from math import pi

from trunnion.errors import InputError
from trunnion.results.units import figures, order_words

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


def order_name(order: float, frequency: float) -> str:
    """A harmonic by turns or in time, "order 2", "77.7 Hz", or by both, "77.7 Hz -2 per turn"."""
    if not frequency:
        return order_words(order)
    return show_speed(frequency, "Hz") + (f" {order:+.6g} per turn" if order else "")


def rounded_speed(speed: float, unit: str) -> str:
    """``1234 rpm``: four figures."""
    return f"{figures(speed * speed_factor(unit))} {unit}"


def about_speed(speed: float, unit: str) -> str:
    """``1230 rpm``: three figures, of a speed that fluctuates."""
    return about_span(speed, speed, unit)


def about_span(low: float, high: float, unit: str) -> str:
    """``1230 to 1250 rpm``: the same of two, one of them where they read alike."""
    ends = dict.fromkeys(f"{float(f'{one * speed_factor(unit):.3g}'):.10g}" for one in (low, high))
    return f"{' to '.join(ends)} {unit}"


def show_acceleration(acceleration: float, unit: str) -> str:
    """``100 rpm/s`` or ``5 rad/s²``: four figures."""
    return f"{figures(acceleration * speed_factor(unit))} {_per_second(unit)}"


def acceleration_span(low: float, high: float, unit: str) -> str:
    """``5 to 100 rpm/s``: four figures each, one of two that read alike."""
    ends = dict.fromkeys(figures(one * speed_factor(unit)) for one in (low, high))
    return f"{' to '.join(ends)} {_per_second(unit)}"


def _per_second(unit: str) -> str:
    return "rad/s²" if unit == "rad/s" else f"{unit}/s"


def rounded_span(low: float, high: float, unit: str, between: str = "to") -> str:
    """``300 to 2400 rpm``: four figures each."""
    first, last = figures(low * speed_factor(unit)), rounded_speed(high, unit)
    return last if last == f"{first} {unit}" else f"{first} {between} {last}"
