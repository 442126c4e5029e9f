"""Ranges of speeds in which something is the case."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from trunnion.arrays import Array
from trunnion.results.speeds import speed_factor
from trunnion.results.units import figures

MOST_STRETCHES = 4


def stretches_above(speed: Array, value: Array, limit: float, *, between: bool = True) -> list[tuple[float, float]]:
    """Ranges of rising ``speed`` (speed,) [rad/s] in which ``value`` (speed,) is above ``limit``: to where the straight
    line between two speeds passes it, or, not ``between``, from the first to the last such speed."""
    above = value > limit
    edges = np.flatnonzero(np.diff(np.concatenate([[False], above, [False]]).astype(int)))
    found = []
    for a, b in zip(edges[::2].tolist(), (edges[1::2] - 1).tolist(), strict=True):
        low, high = float(speed[a]), float(speed[b])
        if between and a > 0:
            low = float(np.interp(limit, value[[a - 1, a]], speed[[a - 1, a]]))
        if between and b < len(speed) - 1:
            high = float(np.interp(limit, value[[b + 1, b]], speed[[b + 1, b]]))
        found.append((low, high))
    return found


def largest_over(speed: Array, value: Array) -> tuple[float, float]:
    """Largest of ``value`` (speed,) and the ``speed`` [rad/s] where it is; NaN where none is known."""
    if not np.any(np.isfinite(value)):
        return np.nan, np.nan
    at = int(np.nanargmax(value))
    return float(value[at]), float(speed[at])


def ranges_in_words(ranges: Sequence[tuple[float, float]], unit: str, digits: int = 6) -> str:
    """ "300 to 400 rpm, 500 rpm and 2 more stretches"."""
    factor = speed_factor(unit)
    words = [
        f"{a} {unit}" if a == b else f"{a} to {b} {unit}"
        for a, b in ((figures(low * factor, digits), figures(high * factor, digits)) for low, high in ranges)
    ]
    more = f" and {len(words) - MOST_STRETCHES} more stretches" if len(words) > MOST_STRETCHES else ""
    return f"{', '.join(words[:MOST_STRETCHES])}{more}"
