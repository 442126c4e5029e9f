"""Pulses of a shaft that swings far, counted by the turn before: what a tooth showed one turn ago it shows again.

Where the speed falls to two fifths of the mean within a few teeth, a gap is as long as with a pulse missing and those
beside it do not tell. The gaps of the turn before do: swings at whole orders and pitch errors come again each turn (at
half orders every second one). From a stretch that repeats without a fault the train is followed to both ends.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import maximum_filter1d, median_filter, minimum_filter1d

from trunnion.arrays import Array, Flags, Integers

TURNS = (1, 2)
"""Turns after which gaps may come again."""
ALIKE = 0.25
"""How far apart the largest and the smallest change of a gap's logarithm may be where a stretch repeats without a
fault."""
SWINGS = 0.405
"""Logarithm of the longest over the shortest gap of a stretch from which neighbours do not tell: of 1.5."""
STEADY = 5
"""Gaps whose median is free of single faults."""
AS_BEFORE = 0.16
"""Logarithm by which a gap may differ from what is awaited before other counts are tried."""
SHORT = 0.55
"""Share of the gap awaited below which one of its ends may be double."""
AHEAD = 8
"""Gaps behind by which a count is judged, up to the next fault."""
MOST_OFF, BEYOND = 0.3, 0.02
"""Square of a logarithm that one gap adds at most to the misfit of a count, and what each behind another fault adds."""
LEFT_OUT = 0.1
"""What the misfit has to gain where an edge is left out: without the next one and a pitch more all fits as well."""
FITS, CLEARLY = 0.6, 0.5
"""Misfit of a count that fits, and share of the next best's misfit that it has at most: doubtful beyond."""
MOST_DOUBTFUL = 0.02
"""Share of the gaps that may be doubtful for the count to stand."""


@dataclass(frozen=True)
class RepeatingEdges:
    """Which edges (edge,) are kept, their numbers (kept,), and times [s] of gaps that are counted with doubt."""

    kept: Flags
    number: Integers
    doubtful: tuple[float, ...]


def repeating(times: Array, teeth: int) -> RepeatingEdges | None:
    """The edges by their turns; None where nothing repeats, or swings too little for it to matter.

    times : rising [s] (edge,). teeth : of the wheel.
    """
    seed = _seed(np.log(np.diff(times)), teeth)
    if seed is None:
        return None
    first, lag = seed
    onward = _Walk(times[first:], lag)
    # The second of both alike stretches begins the way back.
    back = _Walk(-times[: first + 2 * lag + 1][::-1], lag)
    onward.to_end()
    back.to_end()
    doubtful = [first + gap for gap in onward.doubtful] + [first + 2 * lag - gap - 1 for gap in back.doubtful]
    if len(doubtful) > MOST_DOUBTFUL * len(times):
        return None
    number = {first + edge: at for edge, at in onward.number.items()}
    number |= {first + 2 * lag - edge: 2 * lag - at for edge, at in back.number.items()}
    edges = sorted(number)
    kept = np.zeros(len(times), dtype=bool)
    kept[edges] = True
    found = np.array([number[edge] for edge in edges], dtype=np.int64)
    return RepeatingEdges(kept, found - found[0], tuple(sorted({float(times[gap]) for gap in doubtful})))


def _seed(gap: Array, teeth: int) -> tuple[int, int] | None:
    """First edge of two stretches one after another, each so many gaps long, that are most alike; and how many.

    gap : logarithms (gap,).
    """
    best: tuple[float, int, int] | None = None
    for turns in TURNS:
        lag = turns * teeth
        if lag < 2 * AHEAD or len(gap) < 3 * lag:
            continue
        off = gap[lag:] - gap[:-lag]
        around = np.arange(lag // 2, len(off) - lag + lag // 2 + 1)
        spread = (maximum_filter1d(off, lag) - minimum_filter1d(off, lag))[around]
        at = int(spread.argmin())
        # A second turn has to tell clearly more to be needed.
        if best is None or spread[at] < 0.5 * best[0]:
            best = float(spread[at]), at, lag
    if best is None or best[0] > ALIKE:
        return None
    _, at, lag = best
    return (at, lag) if np.ptp(gap[at : at + lag]) > SWINGS else None


def swings_far(gap: Array, teeth: int) -> bool:
    """Whether a shaft swings so far within a turn that gaps beside each other do not tell what is missing.

    gap : lengths of one pitch (gap,), in any unit.
    """
    if len(gap) < 2 * teeth or teeth < 2 * STEADY:
        return False
    even = median_filter(np.log(gap), STEADY)
    off = maximum_filter1d(even, teeth) - minimum_filter1d(even, teeth)
    return bool(np.median(off) > SWINGS)


class _Walk:
    """Edges numbered from the first, whose first two stretches of ``lag`` gaps are whole."""

    def __init__(self, times: Array, lag: int) -> None:
        self.times, self.lag = times, lag
        self.number = {edge: edge for edge in range(2 * lag + 1)}
        gaps = np.log(np.diff(times[: 2 * lag + 1]))
        self.gaps: list[float] = gaps.tolist()
        self.changes: list[float] = (gaps[lag:] - gaps[:lag]).tolist()
        self.doubtful: list[int] = []

    def to_end(self) -> None:
        """Number all edges."""
        edge, count = 2 * self.lag, len(self.times)
        while edge + 1 < count:
            whole, fault = self._whole(edge)
            for k in range(edge, edge + whole):
                self._take(float(np.log(self.times[k + 1] - self.times[k])))
                self.number[k + 1] = len(self.gaps)
            edge += whole
            if fault:
                edge = self._counted(edge)

    @property
    def drift(self) -> float:
        """By how much gaps are longer now than one stretch before: the speed changes."""
        return float(np.median(self.changes[-max(self.lag // 2, AHEAD) :]))

    def _take(self, gap: float) -> None:
        self.changes.append(gap - self.gaps[-self.lag])
        self.gaps.append(gap)

    def _whole(self, edge: int) -> tuple[int, bool]:
        """Gaps onward from an edge that are as awaited, some of a turn; and whether the next one is not."""
        last = min(edge + max(self.lag // 4, 1), len(self.times) - 1)
        seen = np.log(np.diff(self.times[edge : last + 1]))
        awaited = np.array(self.gaps[-self.lag :][: len(seen)]) + self.drift
        off = np.abs(seen - awaited) > AS_BEFORE
        return (int(off.argmax()), True) if off.any() else (len(seen), False)

    def _counted(self, edge: int) -> int:
        """Number the edge that ends a gap which is not as awaited, or, where that one is double, the one behind it."""
        awaited = np.exp(np.array(self.gaps[-self.lag :]) + self.drift)
        # Several turns may be missing.
        long = np.tile(awaited, 1 + int((self.times[edge + 1] - self.times[edge]) / awaited.sum()) + 1)
        reach = np.cumsum(long)
        ways: list[tuple[float, int, int]] = []
        for behind in (1, 2) if self._may_be_double(edge, long) else (1,):
            gap = float(self.times[edge + behind] - self.times[edge])
            near = int(np.abs(np.log(reach / gap)).argmin()) + 1
            for steps in {1, max(near - 1, 1), near, near + 1}:
                if steps <= len(reach):
                    misfit = self._misfit(long, edge + behind, steps, float(np.log(gap / reach[steps - 1])))
                    ways.append((misfit + LEFT_OUT * (behind - 1), steps, behind))
        ways.sort()
        (best, steps, behind), (second, _, other) = ways[:2]
        if best > FITS or best - LEFT_OUT * (behind - 1) > CLEARLY * (second - LEFT_OUT * (other - 1)):
            self.doubtful.append(edge)
        gap = float(self.times[edge + behind] - self.times[edge])
        factor = float(np.log(gap / reach[steps - 1])) if steps > 1 or abs(np.log(gap / reach[0])) < 1.0 else 0.0
        for k in range(steps):
            self._take(float(np.log(long[k])) + factor)
        self.number[edge + behind] = len(self.gaps)
        return edge + behind

    def _may_be_double(self, edge: int, long: Array) -> bool:
        """Whether the edge behind this one stands too near to it, or to the one that follows."""
        if edge + 2 >= len(self.times):
            return False
        before, after = np.diff(self.times[edge : edge + 3])
        return bool(before < SHORT * long[0] or after < SHORT * min(long[0], long[1 % len(long)]))

    def _misfit(self, long: Array, edge: int, steps: int, own: float) -> float:
        """Squares of what a gap of so many steps and those behind it differ by from what is awaited."""
        ahead = self.times[edge : edge + AHEAD + 1]
        misfit, fault, off = self._off(long, ahead, steps, own)
        if 0 <= fault < len(ahead) - 2 and off < np.log(SHORT):
            # Another edge may be double there.
            other, _, _ = self._off(long, np.delete(ahead, fault + 1), steps, own)
            misfit = min(misfit, other + LEFT_OUT)
        return misfit

    def _off(self, long: Array, ahead: Array, steps: int, own: float) -> tuple[float, int, float]:
        """That of edges ``ahead`` (edge,) as they are; the first gap between them that is not as awaited, or −1, and
        the logarithm by which it is off."""
        seen = np.log(np.diff(ahead))
        places = (steps + np.arange(len(seen))) % self.lag
        off = np.append(own, seen - np.log(long[places]))
        square = np.minimum(off**2, MOST_OFF)
        wrong = np.flatnonzero(square[1:] > AS_BEFORE)
        if not len(wrong):
            return float(square.sum()), -1, 0.0
        whole = int(wrong[0]) + 2
        return float(square[:whole].sum() + BEYOND * (len(off) - whole)), whole - 2, float(off[whole - 1])
