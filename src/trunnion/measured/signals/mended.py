"""Missing and double pulses of a train: found by their gaps, numbered, and counted.

Nothing is invented for a pulse that is missing: the edges that are there keep their times, and their numbers jump.
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import median_filter

from trunnion.arrays import Array, Flags, Integers

NEIGHBOURS = 15
"""Gaps whose median is taken for the usual one."""
SHORT, LONG = 0.55, 1.55
"""Shares of the usual gap below which an edge is double and above which one is missing."""
MOST_PASSES = 20


def mended(times: Array) -> tuple[Flags, Integers, int, int]:
    """Which edges (edge,) are kept, numbers of these (kept,), how many were missing and how many double.

    times : rising [s] (edge,).
    """
    kept = np.ones(len(times), dtype=bool)
    for _ in range(MOST_PASSES):
        double = _double(times[kept])
        if not double.any():
            break
        kept[np.flatnonzero(kept)[double]] = False
    gap = np.diff(times[kept])
    steps = np.ones(len(gap), dtype=np.int64)
    if len(gap) >= 3:
        long = gap > LONG * _usual(gap)
        steps[long] = np.maximum(np.rint(gap[long] / _between(gap, long)), 1).astype(np.int64)
    number = np.concatenate([[0], np.cumsum(steps)]).astype(np.int64)
    return kept, number, int((steps - 1).sum()), int((~kept).sum())


def _usual(gap: Array) -> Array:
    return np.asarray(median_filter(gap, size=min(NEIGHBOURS, len(gap)), mode="nearest"))


def _between(gap: Array, long: Flags) -> Array:
    """The usual gap where ``long`` ones are, a mean of the regular ones around: it follows a speed that changes."""
    places = np.arange(len(gap))
    if long.all():
        return gap[long]
    # Beside a long gap a median is of the speed before or after it; the regular neighbours' mean is of both.
    regular, at = places[~long], places[long]
    right = np.searchsorted(regular, at)
    before, after = regular[np.maximum(right - 1, 0)], regular[np.minimum(right, len(regular) - 1)]
    return np.asarray((gap[before] + gap[after]) / 2)


def _double(times: Array) -> Flags:
    """Edges that stand too near to a neighbour; of a pair the one whose removal leaves the more even gaps."""
    gap = np.diff(times)
    found = np.zeros(len(times), dtype=bool)
    if len(gap) < 3:
        return found
    usual = _usual(gap)
    for i in np.flatnonzero(gap < SHORT * usual).tolist():
        if found[i] or found[i + 1]:
            continue
        # Without edge i the gap before grows, without edge i + 1 the gap behind does; at an end there is none.
        own = float(gap[i] / usual[i])
        before = float(gap[i - 1] / usual[i]) if i else 1.0
        after = float(gap[i + 1] / usual[i]) if i + 1 < len(gap) else 1.0
        without_first, without_second = _off(before + own) + _off(after), _off(before) + _off(after + own)
        # Two short gaps in a row are a fast motion, or doubles that the next pass sees.
        if min(without_first, without_second) < _off(before) + _off(own) + _off(after):
            found[i if without_first < without_second else i + 1] = True
    return found


def _off(gap: float) -> float:
    """How far a gap, in usual ones, is from one or several: beside a double pulse one may be missing."""
    return abs(gap - max(1.0, round(gap)))
