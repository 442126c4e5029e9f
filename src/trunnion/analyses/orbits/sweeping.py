"""What a test bench does: a value raised or lowered step by step, each step from where the last one ended.

Every step settles and is then measured: over one period where the motion repeats, else over many.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import TypeVar

from trunnion.analyses.orbits.exact_map import LineMap, OscillatorMap, Settled
from trunnion.analyses.orbits.jumps import abrupt_changes
from trunnion.arrays import Array

Place = TypeVar("Place", OscillatorMap, LineMap)
Seen = TypeVar("Seen")
LEAST, MOST, SAME, MEASURED = 20, 2000, 1e-11, 64
"""Periods of a step at least and at most; change per period that counts as settled; periods measured otherwise."""


def stepped(
    maps: list[Place],
    start: Array,
    least: int,
    most: int,
    same: float,
    measure: Callable[[Place, Array], tuple[Seen | None, Array]],
) -> Iterator[tuple[Settled, Seen | None]]:
    """How each map's motion settles and what was measured of it; None, and the end, where it cannot be followed.

    measure : (map, state at phase zero) → what is seen over its periods, and the state after them.
    """
    state = start
    for place in maps:
        found = place.steady(state, least, most, same)
        seen: Seen | None = None
        if found.done:
            seen, state = measure(replace(place, periods=1 if found.repeats else MEASURED), found.state)
        yield found, seen
        if seen is None:
            return


def jumps(values: Array, swings: Array) -> tuple[tuple[float, float], ...]:
    """Pairs of neighbouring values between which any swing (points, curves) changes abruptly, in the order swept."""
    found = {i for swing in swings.T for i in abrupt_changes(swing)}
    return tuple((float(values[i]), float(values[i + 1])) for i in sorted(found))


def upwards(values: Array) -> bool:
    """Whether the value was raised."""
    return bool(values[-1] >= values[0])
