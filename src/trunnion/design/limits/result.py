"""What ``stable_limit`` gives: unstable ranges of a parameter at every speed, other limits beside them, what binds."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from enum import IntEnum
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from trunnion.arrays import Array, Codes, Integers
from trunnion.floquet.tongues.windows import StableWindows
from trunnion.results.declared import Described, Held, axis, over, remark, remarks, remarks_of
from trunnion.results.drawing import Axes, drawing
from trunnion.results.finding import Finding
from trunnion.results.quantity_axes import QuantityAxis, quantity_axis
from trunnion.results.speeds import show_speed, speed_factor

if TYPE_CHECKING:
    from trunnion.driveline.operation import Operation

STABILITY = "stability"
UNSEARCHED = "; what lies between these speeds was not searched"
"""Regions of instability may be narrower than the steps of the speed."""


class LimitKind(IntEnum):
    """What a limit is; codes of the int8 array."""

    CROSSING = 0
    BEYOND = 1
    AT_ONCE = 2
    UNKNOWN = 3


@dataclass(frozen=True)
class OtherLimit:
    """A limit of the description, and the value (speed,) of the parameter at which it is reached first.

    ``allowed`` [unit], the margin that the description requires taken off; ``reached`` is infinite where it is not
    reached up to the end of the range.
    """

    name: str
    allowed: float
    unit: str
    reached: Array


@dataclass(frozen=True, repr=False)
class StableLimit(Described):
    """Largest stable value of ``parameter`` at each speed, the stable ranges above it, and the other limits.

    speed (speed,) [rad/s]; limit (speed,) in SI units: the value below which nothing is unstable; kind (speed,): codes
    of ``LimitKind``; unstable: of each speed its unstable ranges (ranges, 2), rising; low, high: the range searched;
    complete: whether every zero of the boundary functions was found, which ``search`` puts in words; others: limits of
    the description, and ``others_search`` how they were looked for; whole: the same for every speed between the
    lowest and the highest, None of a single speed and where the listed ones alone were asked for; ended: what ended the
    search before it was done, as a clause, "" where it was done; ``findings`` say what
    of the line is left out; speed_unit: that speeds are printed in.
    """

    parameter: str
    unit: str
    speed: Array
    limit: Array
    kind: Codes
    unstable: tuple[Array, ...]
    low: float
    high: float
    complete: bool
    search: str
    others: tuple[OtherLimit, ...] = ()
    others_search: str = ""
    whole: StableWindows | None = None
    findings: tuple[Finding, ...] = ()
    speed_unit: str = "rad/s"
    ended: str = ""

    @property
    def intervals(self) -> Integers:
        """How many separate unstable ranges each speed has."""
        return np.array([len(ranges) for ranges in self.unstable], dtype=np.int64)

    @property
    def windows(self) -> tuple[Array, ...]:
        """The stable ranges (ranges, 2) of each speed, those above the limit among them; none where it is unknown."""
        known = (self.kind != LimitKind.UNKNOWN).tolist()
        return tuple(
            _between(ranges, self.low, self.high) if told else np.zeros((0, 2))
            for ranges, told in zip(self.unstable, known, strict=True)
        )

    @property
    def common_windows(self) -> Array:
        """The ranges (ranges, 2) that are stable at all these speeds; none where one of them is unknown."""
        if np.any(self.kind == LimitKind.UNKNOWN):
            return np.zeros((0, 2))
        every = np.concatenate([*self.unstable, np.zeros((0, 2))])
        return _between(every[np.argsort(every[:, 0])], self.low, self.high)

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
    def usable(self) -> Array:
        """The value (speed,) up to which neither stability nor any other limit is reached."""
        return np.asarray(np.min([self.limit, *(o.reached for o in self.others)], axis=0))

    @cached_property
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
    def sentence(self) -> str:
        """The answer for all speeds in a sentence; speeds in the unit of the line's description."""
        return self.sentence_in(self.speed_unit)

    def sentence_in(self, unit: str) -> str:
        """The answer for all speeds in a sentence, and before it the one for every speed between where it is known."""
        if self.ended:
            return self._ended_in_words(unit)
        shown, factor = quantity_axis(self.parameter, self.unit, unit), speed_factor(unit)
        low, high = (float(end) * factor for end in (self.speed.min(), self.speed.max()))
        span = f"all {len(self.speed)} speeds from {low:.6g} to {high:.6g} {unit}"
        if self.whole is not None:
            span = f"the {len(self.speed)} speeds that were asked for"
        span = span if len(self.speed) > 1 else f"{high:.6g} {unit}"
        at = self.critical_speed
        if np.any(self.kind == LimitKind.UNKNOWN):
            failed = show_speed(float(self.speed[self.kind == LimitKind.UNKNOWN][0]), unit)
            said = (
                f"At {failed} it is not known over the whole range of the {shown.quantity} whether the line is stable"
            )
        elif at is None:
            said = f"Stable at {span} up to {shown.value(self.high)}, the end of the range"
        elif np.any(self.kind == LimitKind.AT_ONCE):
            said = f"Unstable from {shown.value(self.low)} on, at {show_speed(at, unit)}"
        else:
            said = f"Stable at {span} up to {shown.value(self.smallest)}, set at {show_speed(at, unit)}"
        answer = f"{said}{self._other_in_words(shown, unit)}{self._again_in_words(shown)}"
        if self.whole is not None:
            return f"{self.whole.sentence_in(unit)} {answer}."
        return f"{answer}{UNSEARCHED if len(self.speed) > 1 else ''}."

    def sentence_at(self, speed: float, unit: str | None = None) -> str:
        """The answer at the speed of the result that is nearest to ``speed`` [rad/s], in a sentence."""
        i, unit = int(np.abs(self.speed - speed).argmin()), unit or self.speed_unit
        others = tuple(replace(other, reached=other.reached[i : i + 1]) for other in self.others)
        ranges = self.unstable[i : i + 1]
        return replace(
            self, speed=self.speed[i : i + 1], limit=self.limit[i : i + 1], kind=self.kind[i : i + 1],
            unstable=ranges, others=others, whole=None, ended="",
        ).sentence_in(unit)  # fmt: skip

    def _ended_in_words(self, unit: str) -> str:
        """The answer at the speeds that were searched before a time limit ended the search."""
        known = self.kind != LimitKind.UNKNOWN
        ended = f"{self.ended[0].upper()}{self.ended[1:]}: {int(known.sum())} of {len(known)} speeds were searched"
        left = ", and nothing between them." if self.whole is None and len(known) > 1 else "."
        if not np.any(known):
            return f"{ended}{left}"
        there = np.flatnonzero(known)
        part = replace(
            self, speed=self.speed[there], limit=self.limit[there], kind=self.kind[there],
            unstable=tuple(self.unstable[k] for k in there), ended="",
            others=tuple(replace(other, reached=other.reached[there]) for other in self.others),
        )  # fmt: skip
        return f"{part.sentence_in(unit)} {ended}{left}"

    def _other_in_words(self, shown: QuantityAxis, unit: str) -> str:
        """ "; above 28° the vibratory torque of Shaft 2 binds, at 1850 rpm", where another limit ends before."""
        if not self.others:
            return ""
        reached = np.array([o.reached for o in self.others])
        which, at = np.unravel_index(int(reached.argmin()), reached.shape)
        first, name = float(reached[which, at]), self.others[which].name
        if not first <= self.high or first >= self.smallest:
            return ""
        where = f", at {show_speed(float(self.speed[at]), unit)}" if len(self.speed) > 1 else ""
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

    def declared(self) -> Iterator[Held]:
        """The limit, its kind, every unstable range, and the other limits, over speed."""
        meanings = " ".join(k.name.lower() for k in LimitKind)
        codes = np.array([int(k) for k in LimitKind], dtype=np.int8)
        yield axis("speed", self.speed, "rad/s")
        yield over("speed", "limit", self.limit, self.unit, f"largest stable {self.parameter}")
        yield over("speed", "kind", self.kind, flag_values=codes, flag_meanings=meanings)
        yield over("speed", "intervals", self.intervals, "1", "separate unstable ranges")
        yield over("speed", "usable", self.usable, self.unit, "up to which no limit is reached")
        yield over("speed", "binding", list(self.binding))
        every = np.concatenate([*self.unstable, np.zeros((0, 2))])
        yield axis("range", np.arange(len(every)))
        yield over("range", "range_speed", np.repeat(self.speed, self.intervals), "rad/s", "speed of an unstable range")
        yield over("range", "range_from", every[:, 0], self.unit)
        yield over("range", "range_to", every[:, 1], self.unit)
        yield axis("other_limit", [o.name for o in self.others])
        reached = np.array([o.reached for o in self.others]).reshape(len(self.others), len(self.speed)).T
        yield over("speed other_limit", "reached", np.where(reached <= self.high, reached, np.nan), self.unit,
                   f"{self.parameter} at which a limit is reached first; NaN: not in the range")  # fmt: skip
        yield over("other_limit", "allowed", np.array([o.allowed for o in self.others], dtype=float))
        yield over("other_limit", "allowed_unit", [o.unit for o in self.others])
        yield from remarks_of(self, "parameter", "low", "high")
        yield from remarks(
            complete=int(self.complete),
            search=self.search,
            others_search=self.others_search or None,
            sentence=self.sentence,
            ended=self.ended,
        )
        if self.whole is not None:
            yield remark("whole_range", self.whole.sentence)

    def plot(
        self,
        axes: Axes | None = None,
        *,
        unit: str = "",
        operating: Operation | None = None,
        values: dict[str, float] | None = None,
    ) -> Axes:
        """Limits over speed; see ``plots.stable_limit.draw``."""
        return drawing(self, "plot")(self, axes, unit=unit, operating=operating, values=values)

    def describe(self, unit: str | None = None) -> str:
        """The result in a few lines, speeds in ``unit``, by default that of the line's description."""
        unit = unit or self.speed_unit
        lines = [self.sentence_in(unit), f"  {self.search}"]
        several = int(np.count_nonzero(self.intervals > 1))
        if several:
            many = "1 speed" if several == 1 else f"{several} speeds"
            lines.append(f"  at {many} the line is stable again above the limit, and unstable once more")
        lines += [f"  {text}" for text in self._others_in_lines(unit)]
        if self.whole is not None:
            lines.append(f"  between these speeds: {self.whole.search}")
        return "\n".join([*lines, *(f"  {finding}" for finding in self.findings)])

    def _others_in_lines(self, unit: str) -> Iterator[str]:
        shown = quantity_axis(self.parameter, self.unit, unit)
        for o in self.others:
            at = int(o.reached.argmin())
            first = float(o.reached[at])
            if first <= self.high:
                yield f"{o.name}: reached at {shown.number(first)}, at {show_speed(float(self.speed[at]), unit)}"
            else:
                yield f"{o.name}: not reached in the range"
        if self.others_search:
            yield self.others_search


def _between(ranges: Array, low: float, high: float) -> Array:
    """What of ``low`` to ``high`` is in none of ``ranges`` (ranges, 2), sorted by their low ends."""
    left, at = [], low
    for begin, end in ranges.tolist():
        if begin > at:
            left.append((at, begin))
        at = max(at, end)
    if at < high:
        left.append((at, high))
    return np.array(left).reshape(-1, 2)
