"""The search for bounds of peaks: boxes of speeds and tolerances, halved where a bound stands furthest above what is
asked."""

from __future__ import annotations

import heapq
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from trunnion.arrays import Array, Flags
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.errors import ComputationError
from trunnion.floquet.certificate.box_space import BoxSpace, halved, volume
from trunnion.response.orders.response import order_response
from trunnion.response.orders.result import OrderResponse
from trunnion.response.peaks.box_peaks import BoxPeaks, box_peaks
from trunnion.response.peaks.peak_limits import largest_allowed
from trunnion.response.peaks.quantities import ALWAYS, OF_INERTIAS, OF_SPRINGS, SPEED, in_unit, quantities_of
from trunnion.response.speed_sweep import sweep_speeds
from trunnion.results.words import Words
from trunnion.waiting import time_is_up, to_the_end

AROUND = 64
"""Speeds looked at before the first box."""
BELOW = 1e-6
"""Share by which a bound may lie below what was computed: more than rounding makes of both."""
LEAST = 1e-3
"""What springs carry below this share of the largest is bounded by that."""


@dataclass
class PeakSearch:
    """Boxes by how far they stand above what is asked; ``quantities`` by measure and element, ``limit`` (quantity,),
    infinite where none is stated."""

    space: BoxSpace
    gap: float
    most: int
    report_progress: Callable[[float], None]
    quantities: list[tuple[str, str]]
    limit: Array
    computed: Array
    speed: Array
    judged: int = 0
    done: bool = False
    ended: str = ""
    counterexample: dict[str, float] | None = None
    exceeded: str = ""
    line: Driveline | None = None
    _todo: list[tuple[float, int, Array, BoxPeaks]] = field(default_factory=list)
    _kept: list[tuple[Array, Array]] = field(default_factory=list)
    _count: int = 0

    @classmethod
    def of(cls, space: BoxSpace, gap: float, most: int, progress: Callable[[float], None]) -> PeakSearch:
        found = quantities_of(space.assembly)
        limit, none = largest_allowed(space.assembly), np.full(len(found), np.nan)
        return cls(space, gap, most, progress, found, limit, none, none)

    @property
    def upper(self) -> Array:
        """Bounds (quantity,) over everything."""
        every = [peaks.upper for _, _, _, peaks in self._todo] + [upper for _, upper in self._kept]
        return np.asarray(np.max(every, axis=0)) if every else np.full(len(self.limit), np.inf)

    @property
    def open_share(self) -> float:
        """Of the volume without a bound."""
        boxes = [box for _, _, box, peaks in self._todo if not np.isfinite(peaks.upper).all()]
        boxes += [box for box, upper in self._kept if not np.isfinite(upper).all()]
        return volume(np.array(boxes)) if self._todo or self._kept else 1.0

    def run(self) -> None:
        """Until every bound is close enough, a line exceeds a limit, or boxes or time are used up."""
        if ended := time_is_up():
            self.ended = ended
            return
        self._look_around()
        self._judge(np.array([np.zeros(self.space.size), np.ones(self.space.size)]))
        while self._todo and self.counterexample is None:
            if ended := time_is_up():
                self.ended = ended
                return
            _, _, box, peaks = heapq.heappop(self._todo)
            beyond = self._beyond(peaks)
            if not beyond.max() > 1:
                self._kept.append((box, peaks.upper))
                continue
            halves = halved(box, peaks.blame[:, int(beyond.argmax())]) if self.judged < self.most else ()
            if not halves:
                self._kept.append((box, peaks.upper))
                if self.judged >= self.most:
                    self.ended = f"{self.judged} boxes were judged, as many as most_boxes allows"
                    return
                continue
            for half in halves:
                self._judge(half)
            self.report_progress(min(self._closed, 0.999))
        with np.errstate(invalid="ignore"):
            wrong = bool(np.any(self.upper < self.computed * (1 - BELOW)))
        self.done = bool(np.all(self._within(self.upper))) and self.counterexample is None and not wrong
        self.ended = self.ended or ("a bound lies below what was computed, so one of both is wrong" if wrong else "")

    def _look_around(self) -> None:
        """What the line in the middle of the tolerances takes over the range: what matters is known then."""
        line = self.space.line_at(np.full(self.space.size, 0.5))[0]
        low, high = self.space.speeds
        try:
            speeds = sweep_speeds(line, low, high) if low < high else np.array([low])
            speeds = speeds[:: -(-len(speeds) // AROUND)]  # the middles of boxes come closer
            found = order_response(line, speeds)
        except ComputationError:
            return
        every = _values(found)
        every = np.where(np.isfinite(every), every, -np.inf)
        at = every.argmax(axis=0)
        self.computed, self.speed = every[at, np.arange(every.shape[1])], speeds[at]

    @property
    def _closed(self) -> float:
        return volume(np.array([box for box, _ in self._kept]))

    def _allowed(self) -> Array:
        known = np.where(np.isfinite(self.computed), self.computed, 0.0)
        measures = np.array([measure for measure, _ in self.quantities])
        least = np.zeros(len(known))
        for measure in (*OF_SPRINGS, *OF_INERTIAS):
            of = measures == measure
            least[of] = LEAST * known[of].max(initial=0.0)
        return np.maximum((1 + self.gap) * known, least)

    def _within(self, upper: Array) -> Flags:
        """Whether bounds are below limits, or without one close enough."""
        close = np.where(np.isfinite(self.limit), upper <= self.limit, upper <= self._allowed())
        return np.asarray(close | ~self._asked)

    @property
    def _asked(self) -> Flags:
        """What is to come close, or below its limit; other bounds are given as they come."""
        always = np.array([measure in ALWAYS for measure, _ in self.quantities])
        return np.asarray(always | np.isfinite(self.limit))

    def _beyond(self, peaks: BoxPeaks) -> Array:
        """By what factor a box stands above what is asked (quantity,); 1 where it does not."""
        target = np.where(np.isfinite(self.limit), self.limit, self._allowed())
        target = np.where(self._asked, target, np.inf)
        with np.errstate(invalid="ignore", divide="ignore"):
            factor = np.where(peaks.upper > target, np.where(target > 0, peaks.upper / target, np.inf), 1.0)
        return np.asarray(np.nan_to_num(factor, nan=np.inf, posinf=1e300))

    def _judge(self, box: Array) -> None:
        with to_the_end():  # a box takes tenths of a second at most
            peaks = box_peaks(self.space.assembly, self.space.span(box), self.space.ranges(box))
        self.judged += 1
        middle = box.mean(axis=0)
        larger = ~(peaks.computed <= self.computed) & np.isfinite(peaks.computed)
        if larger.any():
            self.computed = np.where(larger, peaks.computed, self.computed)
            speed = float(self.space.values(middle[None])[0, 0])
            self.speed = np.where(larger, speed, self.speed)
        with np.errstate(invalid="ignore"):
            over = np.flatnonzero(peaks.computed > self.limit)
        if len(over):
            self._refute(middle, int(over[np.argmax(peaks.computed[over] / self.limit[over])]))
        self._count += 1
        heapq.heappush(self._todo, (-float(self._beyond(peaks).max()), self._count, box, peaks))

    def _refute(self, middle: Array, quantity: int) -> None:
        """The line at the middle of a box, if ``order_response`` finds it beyond its limit too."""
        line, speed, known = self.space.line_at(middle)
        try:
            value = float(_values(order_response(line, speed))[0, quantity])
        except ComputationError:
            return
        limit = float(self.limit[quantity])
        if not value > limit:
            return
        measure, name = self.quantities[quantity]
        words = Words(speed_unit(line))
        has, most = (words.speed(one) if measure == SPEED else in_unit(measure, one) for one in (value, limit))
        self.line, self.counterexample = line, known
        self.exceeded = f"has a {measure} of {has} in {name}, of which {most} is allowed"


def _values(found: OrderResponse) -> Array:
    """Quantities (speed, quantity) of a response."""
    parts = (
        found.vibratory_torque, found.peak_torque, found.vibratory_twist, found.twist_range.largest,
        found.rated_torque, found.heat, found.speed_fluctuation, found.acceleration,
    )  # fmt: skip
    return np.concatenate(parts, axis=1)
