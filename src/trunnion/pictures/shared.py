"""What several pictures share: their axes, the operating speed, stretches of speeds, names in legends."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from trunnion.arrays import Array, Flags
from trunnion.driveline.operation import Operation
from trunnion.driveline.quantities import signs
from trunnion.errors import InputError
from trunnion.pictures.picture import Axis, Item, Level, Picture, Spans, runs, single
from trunnion.results.quantity_axes import QuantityAxis
from trunnion.results.speeds import speed_factor
from trunnion.results.words import Words


def printed(quantity: str) -> str:
    """A number with its unit, or a unit alone, as a page prints it: "−3 N m", "rad/s²"."""
    return signs(quantity).replace("-", "−")


def axis_of(quantity: QuantityAxis, low: float | None = None, high: float | None = None) -> Axis:
    """The axis of a quantity, between ends in SI."""
    first, last = (None if end is None else float(end) * quantity.factor for end in (low, high))
    return Axis(quantity.quantity, quantity.unit, first, last)


def speed_axis(x: Array, unit: str) -> Axis:
    """The input speed in ``unit``, over the values shown."""
    return Axis("input speed", unit, float(x[0]), float(x[-1])) if len(x) > 1 else Axis("input speed", unit)


def over_speed(
    x: Array, unit: str, up: Axis, items: Sequence[Item], operating: Operation | None = None,
    *, height: float = 4.3, title: str = "", grid: str = "both",
) -> Picture:  # fmt: skip
    """A picture over input speeds ``x`` in ``unit``, with a line at the operating speed."""
    at = operating.speed * speed_factor(unit) if operating and operating.speed else None
    marked = [Level(at, "operating", "operating speed", "x")] if at is not None and x[0] <= at <= x[-1] else []
    return single(speed_axis(x, unit), up, [*items, *marked], height=height, title=title, grid=grid)


def histogram(values: Array, fewest: int) -> tuple[Array, Array]:
    """How many of ``values`` lie in each of at least ``fewest`` bins, and where these end; one bin where all are equal
    but for rounding."""
    low, high = float(np.min(values)), float(np.max(values))
    if high - low <= 1e-9 * max(abs(low), abs(high)):
        half = 0.005 * max(abs(low), abs(high)) or 0.5
        return np.array([len(values)]), np.array([low - half, high + half])
    return np.histogram(values, bins=int(np.clip(2 * np.sqrt(len(values)), fewest, 60)))


def stands(parameter: str, unit: str, value: float, name: str = "") -> Level:
    """A line across where a parameter stands, from its value in SI."""
    return Level(value * Words().parameter(parameter, unit).factor, "stands", name)


def stretches(x: Array, where: Flags, role: str, words: str) -> list[Item]:
    """Strips where something holds of single speeds, none of a single point."""
    return [Spans(runs(x, where), role, words)] if np.any(where) and len(x) > 1 else []


def place_of(name: str | None, known: Sequence[str], usual: int, key: str, what: str, remedy: str) -> int:
    """Where a name stands, or ``usual`` where none is given; InputError, "is ``what``", for one that is not known."""
    if not name:
        return usual
    if name not in known:
        raise InputError(f"is {what}", key=key, value=name, remedy=remedy)
    return known.index(name)
