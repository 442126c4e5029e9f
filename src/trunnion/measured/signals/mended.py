"""Missing and double pulses of a train: found by their gaps, numbered, and counted.

Nothing is invented for a pulse that is missing: the edges that are there keep their times, and their numbers jump.

The gaps beside a long one are uneven by pitch errors and vibration, so that their mean counts forty missing pulses no
better than by chance. Where several are missing in a row, both sides are fitted by one polynomial with a step instead.
Of a shaft that swings far the turn before tells (``repeating``).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Flags, Integers, Places
from trunnion.measured.signals.repeating import repeating, swings_far

NEIGHBOURS = 15
"""Gaps whose median is taken for the usual one."""
SHORT, LONG = 0.55, 1.55
"""Shares of the usual gap below which an edge is double and above which one is missing."""
MOST_PASSES = 20
BESIDE = 3
"""Gaps on either side by which it is judged whether those between are several."""
SMOOTHER = 0.8
"""Share of its roughness that a row of gaps may keep where some of them are taken for several."""
SEVERAL = 5
"""Steps of a gap from which it is counted by what both sides show."""
LEAST_SIDE = 6
"""Edges that a side needs."""
LEAST_SPREAD, FROM_WHOLE = 0.1, 0.3
"""Standard deviation of a count, and its distance from a whole number or from another way to count: doubtful beyond."""


@dataclass(frozen=True)
class MendedEdges:
    """Which edges (edge,) are kept, numbers of these (kept,), how many were missing and how many double.

    doubtful : times [s] at which gaps begin whose missing pulses cannot be counted surely. swings : whether the shaft
    swings so far that slow pulses and missing ones look alike, and no turn repeats another from which they are told.
    """

    kept: Flags
    number: Integers
    missing: int
    double: int
    doubtful: tuple[float, ...]
    swings: bool = False


def mended(times: Array, teeth: int) -> MendedEdges:
    """The edges of a wheel by their gaps.

    times : rising [s] (edge,). teeth : of the wheel.
    """
    by_turns = repeating(times, teeth)
    if by_turns is not None:
        kept, number = by_turns.kept, by_turns.number
        missing = int(number[-1]) + 1 - len(number)
        return MendedEdges(kept, number, missing, int((~kept).sum()), by_turns.doubtful)
    kept = np.ones(len(times), dtype=bool)
    for _ in range(MOST_PASSES):
        double = _double(times[kept])
        if not double.any():
            break
        kept[np.flatnonzero(kept)[double]] = False
    gap = np.diff(times[kept])
    steps = _steps(gap)
    doubtful = _recounted(times[kept], steps, teeth)
    number = np.concatenate([[0], np.cumsum(steps)]).astype(np.int64)
    lost, twice = int((steps - 1).sum()), int((~kept).sum())
    swings = bool(lost or twice) and swings_far(gap, teeth)
    return MendedEdges(kept, number, lost, twice, doubtful, swings)


def _steps(gap: Array) -> Integers:
    """How many pitches each gap (gap,) spans.

    A shaft that swings far makes gaps as long as where a pulse is missing, but smoothly: a gap is taken for several
    only where the gaps around it run more smoothly so.
    """
    steps = np.ones(len(gap), dtype=np.int64)
    for _ in range(MOST_PASSES if len(gap) >= 3 else 0):
        each = gap / steps
        beside = np.minimum(np.append(np.inf, each[:-1]), np.append(each[1:], np.inf))
        slow = each > LONG * _usual(each)
        long = slow & (each > LONG * beside)
        # Between two such gaps one that is as long may be of their kind.
        long[1:-1] |= slow[1:-1] & long[:-2] & long[2:]
        long |= each > LONG * _smoothly(each)
        counted = np.ones_like(steps)
        counted[long] = np.maximum(np.rint(each[long] / _between(each, long)), 1)
        changed = False
        for run in _runs(np.flatnonzero(counted > 1)):
            around = slice(max(int(run[0]) - BESIDE, 0), int(run[-1]) + BESIDE + 1)
            fewer = np.maximum(counted - (counted < SEVERAL), 1)
            way = min((counted, fewer), key=lambda one: _roughness(each[around] / one[around]))
            if _roughness(each[around] / way[around]) < SMOOTHER * _roughness(each[around]):
                steps[run] *= way[run]
                changed = True
        if not changed:
            break
    return steps


def _smoothly(gap: Array) -> Array:
    """What the two gaps on either side of each make of it: a cubic through their logarithms; infinite at the ends."""
    found = np.full(len(gap), np.inf)
    size = np.log(gap)
    found[2:-2] = np.exp((4 * (size[1:-3] + size[3:-1]) - size[:-4] - size[4:]) / 6)
    return found


def _roughness(gap: Array) -> float:
    """Sum of squares of second differences of logarithms."""
    return float((np.diff(np.log(gap), 2) ** 2).sum())


def _runs(places: Places) -> list[Places]:
    """Places one after another, in groups of neighbours."""
    return np.split(places, np.flatnonzero(np.diff(places) > 1) + 1) if len(places) else []


def _recounted(times: Array, steps: Integers, teeth: int) -> tuple[float, ...]:
    """Put right the steps (gap,) of gaps in which several pulses are missing; where the count is doubtful."""
    doubtful = []
    several = np.flatnonzero(steps >= SEVERAL)
    ends = [-1, *several.tolist(), len(steps)]
    for k, gap in enumerate(several.tolist()):
        # A side ends at the next such gap, whose own count would else come in.
        side = 2 * teeth + 2 * int(steps[gap])
        first, last = max(ends[k] + 1, gap + 1 - side), min(ends[k + 2] + 1, gap + 1 + side)
        if min(gap + 1 - first, last - gap - 1) < LEAST_SIDE:
            doubtful.append(float(times[gap]))
            continue
        before = np.concatenate([np.cumsum(steps[first:gap][::-1])[::-1] * -1.0, [0.0]])
        after = np.concatenate([[0.0], np.cumsum(steps[gap + 1 : last - 1])])
        (plain, _), (count, spread) = (
            _step_between(times[first : gap + 1], times[gap + 1 : last], before, after, degree) for degree in (2, 3)
        )
        steps[gap] = max(round(count), 1)
        if spread > LEAST_SPREAD or max(abs(count - round(count)), abs(count - plain)) > FROM_WHOLE:
            doubtful.append(float(times[gap]))
    return tuple(doubtful)


def _step_between(before: Array, after: Array, number: Array, beyond: Array, degree: int) -> tuple[float, float]:
    """By how many numbers the first edge ``after`` a gap is beyond the last ``before`` it, and its standard deviation.

    Numbers (edge,) count from those two; rotation is a polynomial of time over both sides.
    """
    times = np.concatenate([before, after])
    place = 2 * (times - (before[-1] + after[0]) / 2) / (times[-1] - times[0])
    step = np.repeat([0.0, -1.0], [len(before), len(after)])
    columns = np.column_stack([*(place**k for k in range(degree + 1)), step])
    q, r = np.linalg.qr(columns)
    known = np.concatenate([number, beyond])
    found = np.linalg.solve(r, q.T @ known)
    left = known - columns @ found
    spread = np.linalg.norm(left) / np.sqrt(len(known) - degree - 2) * np.linalg.norm(np.linalg.inv(r)[-1])
    return float(found[-1]), float(spread)


def _usual(gap: Array) -> Array:
    from scipy.ndimage import median_filter  # which names of channels do not need

    return np.asarray(median_filter(gap, size=min(NEIGHBOURS, len(gap)), mode="mirror"))


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
