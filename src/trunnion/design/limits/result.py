"""What ``stable_limit`` gives: unstable ranges of a parameter at every speed, other limits beside them, what binds."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from enum import IntEnum
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from trunnion.arrays import Array, Codes, Integers
from trunnion.floquet.tongues.windows import StableWindows
from trunnion.results.counts import counted
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, computed, coordinate, internal, labelled, members, variable
from trunnion.results.finding import Finding
from trunnion.results.quantity_axes import QuantityAxis
from trunnion.results.result import Result
from trunnion.results.variables import Attribute, Coordinate, Variable, attributes

if TYPE_CHECKING:
    from trunnion.driveline.operation import Operation

STABILITY = "stability"
WHOLE = "the same for every speed between; None of a single speed, and where the listed ones alone were asked for"
UNSEARCHED = "; what lies between these speeds was not searched"
"""Regions of instability may be narrower than the steps of the speed."""
ROUNDING = 1e-12
"""Share of the range below which a window is none."""


class LimitKind(IntEnum):
    """What a limit is; codes of the int8 array."""

    CROSSING = 0
    BEYOND = 1
    AT_ONCE = 2
    UNKNOWN = 3


KINDS = {
    "flag_values": np.array([int(k) for k in LimitKind], dtype=np.int8),
    "flag_meanings": " ".join(k.name.lower() for k in LimitKind),
}


@labelled
class OtherLimit:
    """A limit of the description, and the value of the parameter at which it is reached first."""

    name: str = internal()
    allowed: float = variable(words="the margin that the description requires taken off")
    unit: str = variable(name="allowed_unit")
    reached: Array = internal("infinite where it is not reached up to the end of the range", axes="speed")


@labelled
class StableLimit(Result):
    """Largest stable value of a parameter at each speed, the stable ranges above it, and the other limits."""

    SPEEDS_IN = "speed_unit"

    parameter: str = attribute("what is raised")
    unit: str = internal("of the parameter")
    speed: Array = coordinate("speed", "rad/s")
    limit: Array = variable("speed", "{self.unit}", "largest stable {self.parameter}")
    kind: Codes = variable("speed", words="codes of LimitKind", more=KINDS)
    unstable: tuple[Array, ...] = internal("of each speed its unstable ranges (ranges, 2), rising", axes="speed")
    unknown: tuple[Array, ...] = internal(
        "of each speed the ranges (ranges, 2), rising, in which nothing is known of stability", axes="speed"
    )
    low: float = attribute("end of the range searched")
    high: float = attribute("end of the range searched")
    complete: bool = attribute("whether every zero of the boundary functions was found")
    search: str = attribute("the same in words")
    others: tuple[OtherLimit, ...] = members(OtherLimit, "other_limit", name="name", default=())
    others_search: str = internal("how other limits were looked for", default="")
    whole: StableWindows | None = internal(WHOLE, default=None)
    findings: tuple[Finding, ...] = internal("what of the line is left out", default=())
    speed_unit: str = internal("that speeds are printed in", default="rad/s")
    ended: str = attribute("what ended the search before it was done, as a clause", default="")

    @property
    @computed(variable("speed", "1", "separate unstable ranges"))
    def intervals(self) -> Integers:
        """How many separate unstable ranges each speed has."""
        return np.array([len(ranges) for ranges in self.unstable], dtype=np.int64)

    @property
    def windows(self) -> tuple[Array, ...]:
        """The stable ranges (ranges, 2) of each speed, those above the limit among them."""
        return tuple(
            _between(np.concatenate(both), self.low, self.high)
            for both in zip(self.unstable, self.unknown, strict=True)
        )

    @property
    def common_windows(self) -> Array:
        """The ranges (ranges, 2) that are stable at all these speeds."""
        return _between(np.concatenate([*self.unstable, *self.unknown]), self.low, self.high)

    @property
    def smallest(self) -> float:
        """The largest value that is stable at all these speeds; ``high`` where nothing was unstable, NaN where one of
        them is unknown."""
        return float(self.limit.min())

    @property
    def critical_speed(self) -> float | None:
        """The speed [rad/s] that limits it; None where nothing was unstable."""
        if not np.any((self.kind == LimitKind.CROSSING) | (self.kind == LimitKind.AT_ONCE)):
            return None
        return float(self.speed[int(np.nanargmin(self.limit))])

    @cached_property
    @computed(variable("speed", "{self.unit}", "up to which no limit is reached"))
    def usable(self) -> Array:
        """The value (speed,) up to which neither stability nor any other limit is reached."""
        return np.asarray(np.min([self.limit, *(o.reached for o in self.others)], axis=0))

    @cached_property
    @computed(variable("speed"))
    def binding(self) -> tuple[str, ...]:
        """What ends ``usable`` at each speed: "stability", the name of another limit, or "" up to the end."""
        names = [STABILITY, *(o.name for o in self.others)]
        ends = np.array(
            [np.where(self.kind == LimitKind.BEYOND, np.inf, self.limit), *(o.reached for o in self.others)]
        )
        known = np.where(np.isnan(ends), -np.inf, ends)  # what could not be computed binds
        which = known.argmin(axis=0)
        return tuple(names[w] if known[w, i] <= self.high else "" for i, w in enumerate(which.tolist()))

    @property
    @computed(attribute())
    def sentence(self) -> str:
        """The answer for all speeds in a sentence, and before it the one for every speed between where it is known."""
        if self.ended:
            return self._ended_in_words()
        words, shown = self.words, self._shown
        low, high = (float(end) * words.factor for end in (self.speed.min(), self.speed.max()))
        span = f"all {len(self.speed)} speeds from {low:.6g} to {high:.6g} {words.unit}"
        if self.whole is not None:
            span = f"the {len(self.speed)} speeds that were asked for"
        span = span if len(self.speed) > 1 else f"{high:.6g} {words.unit}"
        at = self.critical_speed
        if np.any(self.kind == LimitKind.UNKNOWN):
            failed = words.speed(float(self.speed[self.kind == LimitKind.UNKNOWN][0]))
            said = f"At {failed} it is not known up to which {shown.quantity} the line is stable"
        elif at is None:
            said = f"Stable at {span} up to {shown.value(self.high)}, the end of the range"
        elif np.any(self.kind == LimitKind.AT_ONCE):
            said = f"Unstable from {shown.value(self.low)} on, at {words.speed(at)}"
        else:
            said = f"Stable at {span} up to {shown.value(self.smallest)}, set at {words.speed(at)}"
        answer = f"{said}{self._other_in_words(shown)}{self._again_in_words(shown)}"
        if self.whole is not None:
            return f"{self.whole.in_unit(self.speed_unit).sentence} {answer}."
        return f"{answer}{UNSEARCHED if len(self.speed) > 1 else ''}."

    @property
    def _shown(self) -> QuantityAxis:
        return self.words.parameter(self.parameter, self.unit)

    def _at(self, places: Integers, whole: StableWindows | None) -> StableLimit:
        """The same at some of the speeds."""
        return replace(
            self, speed=self.speed[places], limit=self.limit[places], kind=self.kind[places], whole=whole, ended="",
            unstable=tuple(self.unstable[k] for k in places), unknown=tuple(self.unknown[k] for k in places),
            others=tuple(replace(other, reached=other.reached[places]) for other in self.others),
        )  # fmt: skip

    def sentence_at(self, speed: float, unit: str | None = None) -> str:
        """The answer at the speed of the result that is nearest to ``speed`` [rad/s], in a sentence."""
        nearest = int(np.abs(self.speed - speed).argmin())
        return self.in_unit(unit)._at(np.array([nearest]), None).sentence

    def _ended_in_words(self) -> str:
        """The answer at the speeds that were searched before a time limit ended the search."""
        known = self.kind != LimitKind.UNKNOWN
        ended = f"{self.ended[0].upper()}{self.ended[1:]}: {int(known.sum())} of {len(known)} speeds were searched"
        left = ", and nothing between them." if self.whole is None and len(known) > 1 else "."
        if not np.any(known):
            return f"{ended}{left}"
        return f"{self._at(np.flatnonzero(known), self.whole).sentence} {ended}{left}"

    def _other_in_words(self, shown: QuantityAxis) -> str:
        """ "; above 28° the vibratory torque of Shaft 2 binds, at 1850 rpm", where another limit ends before."""
        if not self.others:
            return ""
        reached = np.array([o.reached for o in self.others])
        which, at = np.unravel_index(int(reached.argmin()), reached.shape)
        first, name = float(reached[which, at]), self.others[which].name
        if not first <= self.high or first >= self.smallest:
            return ""
        where = f", at {self.words.speed(float(self.speed[at]))}" if len(self.speed) > 1 else ""
        if first <= self.low:
            return f"; the {name} is exceeded at the start of the range already{where}"
        return f"; above {shown.number(first)} the {name} binds{where}"

    def _again_in_words(self, shown: QuantityAxis) -> str:
        """What lies above the limit and is stable again."""
        above = [w for w in self.common_windows.tolist() if w[0] > self.low]
        if not above:
            return ""
        everywhere = " at all of them" if len(self.speed) > 1 else ""
        return f"; stable again{everywhere} from " + " and from ".join(
            f"{shown.number(a)} to {shown.number(b)}" for a, b in above
        )

    def declared(self) -> Iterator[Variable | Attribute]:
        """The limit, its kind, every unstable range, and the other limits, over speed."""
        yield from super().declared()
        every = np.concatenate([*self.unstable, np.zeros((0, 2))])
        owners = np.repeat(self.speed, self.intervals)
        yield Coordinate("range", np.arange(len(every)), "range")
        yield Variable("range_speed", owners, "range", "rad/s", "speed of an unstable range")
        yield Variable("range_from", every[:, 0], "range", self.unit)
        yield Variable("range_to", every[:, 1], "range", self.unit)
        reached = np.array([o.reached for o in self.others]).reshape(len(self.others), len(self.speed)).T
        reached = np.where(reached <= self.high, reached, np.nan)
        first = f"{self.parameter} at which a limit is reached first; NaN: not in the range"
        yield Variable("reached", reached, "speed other_limit", self.unit, first)
        yield from attributes(others_search=self.others_search or None)
        if self.whole is not None:
            yield from attributes(whole_range=self.whole.in_unit(self.speed_unit).sentence)

    def plot(
        self,
        axes: Axes | None = None,
        *,
        unit: str = "",
        operating: Operation | None = None,
        values: dict[str, float] | None = None,
    ) -> Axes:
        """Limits over speed; see ``pictures.stable_limit.stable_limit``."""
        return drawing(self, "plot")(self, axes, unit=unit, operating=operating, values=values)

    def _lines(self) -> Iterator[str]:
        yield self.sentence
        yield f"  {self.search}"
        several = int(np.count_nonzero(self.intervals > 1))
        if several:
            yield f"  at {counted(several, 'speed')} the line is stable again above the limit, and unstable once more"
        for o in self.others:
            at, first = int(o.reached.argmin()), float(o.reached.min())
            where = f"reached at {self._shown.number(first)}, at {self.words.speed(float(self.speed[at]))}"
            yield f"  {o.name}: {where if first <= self.high else 'not reached in the range'}"
        if self.others_search:
            yield f"  {self.others_search}"
        if self.whole is not None:
            yield f"  between these speeds: {self.whole.search}"


def _between(ranges: Array, low: float, high: float) -> Array:
    """What of ``low`` to ``high`` is in none of ``ranges`` (ranges, 2)."""
    left, at, rounding = [], low, ROUNDING * (high - low)
    for begin, end in sorted(ranges.tolist()):
        if begin > at + rounding:
            left.append((at, begin))
        at = max(at, end)
    if at < high - rounding:
        left.append((at, high))
    return np.array(left).reshape(-1, 2)
