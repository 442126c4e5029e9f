"""Maps over a period whose motion is exact in pieces: of one mass, and of a driveline with stages.

The motion within a piece is known to rounding, and so is its passage from piece to piece; the derivatives by the state
and by the frequency (or speed) are those of the motion itself (``numerics.piecewise_linear``). A motion that touches
the end of a piece (grazing) has none.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple, Self

import numpy as np

from trunnion.arrays import Array, Integers
from trunnion.equations.staged_line import StagedLine
from trunnion.errors import InputError
from trunnion.laws.stages import STICKS
from trunnion.motion.orbits.spring_contacts import SpringContact, contact_state
from trunnion.motion.simulation.exact_motion import stage_events
from trunnion.numerics.piecewise_linear import piecewise, staged_flow
from trunnion.numerics.piecewise_linear.staged_flow import StagedFlow, StagedSegment, kernel, stages_of
from trunnion.systems.maps import MOMENT, MapEvaluation, Observed
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator
from trunnion.systems.regimes import SLACK

SAMPLES = 512
"""Of a period, for the fundamental; a power of two times any usual number of periods."""
LEAST_TWIST = 1e-6
"""What a twist counts as at least when an orbit is closed [rad]."""
SIDES = ("none", "upper", "lower", "both")
"""Sides touched, by the code of the measurement."""
REPEATS = 3
"""Periods that must repeat, one after the other, before a motion counts as settled."""


class DecayedTransient(NamedTuple):
    """Where a motion is at phase zero (n,) after so many periods, whether they repeat, and whether it got there."""

    state: Array
    periods: int
    repeats: bool
    done: bool


@dataclass(frozen=True)
class ExactMap(ABC):
    """What both maps share; ``value`` is the frequency or speed [rad/s] that turns the excitation."""

    value: float
    periods: int

    def at(self, *values: float) -> Self:
        if not values[0] > 0:
            raise InputError("must be positive", key="frequency", value=values[0])
        return replace(self, value=values[0])

    def settle(self, x: Array, periods: int) -> Array | None:
        found = self.steady(x, periods * self.periods, periods * self.periods, 0.0)
        return found.state if found.done else None

    @property
    @abstractmethod
    def size(self) -> int:
        """Number of states."""

    def nowhere(self, values: int = 0) -> MapEvaluation:
        """A motion that changes its pieces too often to come to an end; its derivatives by so many values."""
        nothing = np.full((self.size, self.size + values), np.nan)
        return MapEvaluation(nothing[:, 0], nothing[:, : self.size], nothing[:, self.size :], -1, False, None)

    @property
    @abstractmethod
    def unmeasured(self) -> dict[str, Any]:
        """What ``measured`` tells of a motion that is not known: NaN."""

    @abstractmethod
    def measured(self, x: Array) -> tuple[dict[str, Any], Array] | None:
        """What the motion from x does, by the names of results, and where it ends; None where it cannot be followed."""

    @abstractmethod
    def steady(self, x: Array, least: int, most: int, same: float) -> DecayedTransient:
        """The motion after ``least`` to ``most`` periods of the excitation, until it changes by less than ``same``."""


@dataclass(frozen=True)
class OscillatorMap(ExactMap):
    """x, x′ over ``periods`` of the force at a frequency."""

    oscillator: PiecewiseOscillator

    @classmethod
    def of(cls, oscillator: PiecewiseOscillator, periods: int = 1) -> Self:
        """At the oscillator's own frequency."""
        return cls(oscillator.frequency, periods, oscillator)

    @property
    def size(self) -> int:
        return 2

    @property
    def length(self) -> float:
        return self.periods * 2 * np.pi / self.value

    def scale(self, start: Array) -> Array:
        """Size of x and x′ that counts as one."""
        ends = map(abs, self.oscillator.breakpoints)
        return np.array([1.0, self.value]) * max(float(np.abs(start).max()), *ends, 1e-300)

    def __call__(
        self, x: Array, *, tangents: bool = True, by: Sequence[int] = (), watch: bool = False
    ) -> MapEvaluation:
        o = self.oscillator
        try:
            run = piecewise.period(o.regimes, o.coefficients, self.value, x, self.periods)
        except piecewise.TooManyEventsError:
            return self.nowhere(len(by))
        changes = int((run.events[:, 3] >= 0).sum())
        return MapEvaluation(run.state, run.tangents[:, :2], run.tangents[:, 2 : 2 + len(by)], changes, True, run)

    def steady(self, x: Array, least: int, most: int, same: float) -> DecayedTransient:
        o, k = self.oscillator, piecewise.kernel()
        state, tables = np.array(x, dtype=float), o.regimes
        regime = k.regime_at(state[0], state[1], tables.guards, tables.then)
        _, periods, repeats, ended = k.settle(
            state, regime, least, most, same, self.value, o.coefficients, tables.pieces, tables.guards, tables.then,
            np.empty((piecewise.MOST_EVENTS, k.RECORDED)),
        )  # fmt: skip
        return DecayedTransient(state, int(periods), bool(repeats), ended == k.DONE)

    def steady_from(self, starts: Array, least: int, most: int, same: float) -> Array:
        """As ``steady`` from many starts (m, 2): where they settle, NaN where they do not."""
        o, k = self.oscillator, piecewise.kernel()
        ends, periods = np.empty_like(starts), np.zeros(len(starts), dtype=np.int64)
        k.basins(
            starts, least, most, same, self.value, o.coefficients, o.regimes.pieces, o.regimes.guards,
            o.regimes.then, np.empty((piecewise.MOST_EVENTS, k.RECORDED)), ends, periods,
        )  # fmt: skip
        return np.where(periods[:, None] > 0, ends, np.nan)

    @property
    def unmeasured(self) -> dict[str, Any]:
        return self._told(dict.fromkeys(piecewise.COLUMNS, np.nan))

    def measured(self, x: Array) -> tuple[dict[str, Any], Array]:
        found = self._told(self._measured(x))
        return found, found["state"]

    def _told(self, seen: dict[str, float]) -> dict[str, Any]:
        sides = SIDES[int(seen["contact"])] if np.isfinite(seen["contact"]) else "none"
        return {
            "lowest": seen["low"],
            "highest": seen["high"],
            "mean": seen["mean"],
            "impacts": seen["impacts"],
            "impact_energy": self.oscillator.inertia * seen["energy"],
            "impact_impulse": self.oscillator.inertia * seen["impulse"],
            "sides": sides,
            "contact": contact_state(sides),
            "state": np.array([seen["x"], seen["v"]]),
        }

    def _measured(self, x: Array) -> dict[str, float]:
        o = self.oscillator
        return piecewise.measure(o.regimes, o.coefficients, self.value, x, self.periods)

    def observe(self, x: Array, passage: MapEvaluation) -> Observed:
        found = self._measured(x)
        low, high = found["low"], found["high"]
        # At the forcing frequency, of a subharmonic motion too.
        fundamental = float(np.hypot(found["real"], found["imaginary"]))
        return Observed(
            np.array([high - low]), np.array([max(abs(low), abs(high))]), fundamental * np.array([1.0, self.value])
        )


@dataclass(frozen=True)
class LineMap(ExactMap):
    """Twists and rates over ``periods`` of the excitation; sliders ``fixed`` are kept from slipping.

    Of a free–free line with a viscous load the rotation itself need not close, only its rate: it is not a state of
    the map, whose states stand at the places ``kept`` of the line's.
    """

    line: StagedLine
    fixed: tuple[int, ...] = ()

    @property
    def size(self) -> int:
        return len(self.kept)

    @property
    def length(self) -> float:
        return self.periods * self.line.period(self.value)

    @cached_property
    def kept(self) -> Integers:
        """Places of the map's states among the line's."""
        return self.line.kept

    @cached_property
    def flow(self) -> StagedFlow:
        """The line's flow at the value."""
        return self.line.holding([self.line.slider_rows[i] for i in self.fixed], self.value)

    def whole(self, part: Array) -> Array:
        """The line's state (2m,) from the map's, deflections beyond what sliders hold brought back to it."""
        state = np.zeros(2 * self.line.size)
        state[self.kept] = part
        free = self.line.within_limits(state)
        rows = [self.line.slider_rows[i] for i in self.fixed]
        free[rows] = state[rows]
        return free

    @property
    def sliders(self) -> int:
        return len(self.line.sliders)

    @property
    def deflections(self) -> Integers:
        return np.searchsorted(self.kept, self.line.slider_rows)

    def holding(self, which: tuple[int, ...]) -> Self:
        return replace(self, fixed=which)

    def idle(self, x: Array) -> tuple[int, ...]:
        k, passage = kernel(), self.watched(x)
        first, found = stages_of(self.flow, self.whole(x)), []
        for i, row in enumerate(self.line.slider_rows if passage.done else ()):
            own = passage.events[:, 1] == row
            times = np.concatenate([[0.0], passage.events[own, 0], [self.length]])
            slips = np.concatenate([[first[row]], passage.events[own, 2]]) != STICKS
            furthest = np.abs(passage.seen[row, [k.LOW, k.HIGH]]).max()
            if np.diff(times) @ slips <= MOMENT * self.length and furthest <= (1 + SLACK) * self.line.knots[row]:
                found.append(i)
        return tuple(found)

    def conserved(self, x: Array, which: tuple[int, ...]) -> Array:
        rows, unit = [self.line.slider_rows[i] for i in which], np.eye(2 * self.line.size)
        return (unit[rows] - unit[self.line.source[rows]])[:, self.kept]

    def within_limits(self, x: Array) -> Array:
        return self.whole(x)[self.kept]

    def scale(self, start: Array) -> Array:
        """Size of every state of the map that counts as one, from a start (2m,) of the line."""
        m = self.line.size
        size = np.maximum(np.maximum(np.abs(start[:m]), self.line.knots), LEAST_TWIST)
        turning = 2 * np.pi / self.line.period(self.value)
        return np.concatenate([size, np.maximum(np.abs(start[m:]), size * turning)])[self.kept]

    def __call__(
        self, x: Array, *, tangents: bool = True, by: Sequence[int] = (), watch: bool = False
    ) -> MapEvaluation:
        slope = self.length * self.line.period_slope(self.value)
        start = self.whole(x)
        run = staged_flow.period(self.flow, start, self.length, slope, watch=watch)
        if not (run.done and np.isfinite(run.tangents).all()):
            return self.nowhere(len(by))
        within = start[self.kept] == x  # beyond what it holds a deflection is brought back
        matrix = run.tangents[self.kept][:, self.kept] * within
        by_value = run.tangents[self.kept, 2 * self.line.size :][:, : len(by)]
        return MapEvaluation(run.state[self.kept], matrix, by_value, len(run.events), True, run)

    def steady(self, x: Array, least: int, most: int, same: float) -> DecayedTransient:
        length, state, repeated = self.line.period(self.value), self.whole(x), 0
        for count in range(1, most + 1):
            run = staged_flow.move(self.flow, state, 0.0, length)
            change = np.abs(run.state - state)[self.kept] / self.scale(run.state)
            state = run.state
            if not (run.done and np.isfinite(state).all()):
                return DecayedTransient(np.full(self.size, np.nan), count, False, False)
            repeated = repeated + 1 if np.max(change) < same else 0
            if count >= least and repeated >= REPEATS:
                return DecayedTransient(state[self.kept], count, True, True)
        return DecayedTransient(state[self.kept], most, False, True)

    def watched(self, x: Array) -> StagedSegment:
        """The motion from x with what it shows of every spring."""
        return staged_flow.move(self.flow, self.whole(x), 0.0, self.length, watch=True)

    @property
    def unmeasured(self) -> dict[str, Any]:
        line, nan = self.line, np.nan
        nothing = [SpringContact(line.springs[e], np.zeros(0), nan, "none", np.zeros(0), nan) for e in line.staged]
        return self._told(np.full((line.size, kernel().SHARES), nan), np.full(2 * line.size, nan), tuple(nothing))

    def measured(self, x: Array) -> tuple[dict[str, Any], Array] | None:
        run = self.watched(x)
        return (self.told_of(x, run), run.state[self.kept]) if run.done else None

    def told_of(self, x: Array, run: StagedSegment) -> dict[str, Any]:
        """What a watched passage from x shows.

        An impact is a passage from the softest stage of a spring to another, its energy ½ m q̇² with the inertia m that
        the rest of the line opposes to a push between the ends of the spring.
        """
        line, start, contacts = self.line, self.whole(x), []
        first, events = stages_of(line.flow(), start), stage_events(line, run.events)
        for e in line.staged:
            own = events.spring == e
            sides = np.concatenate([[line.sides[e, first[e]]], events.side[own]])
            speeds = np.abs(events.rate[own][(sides[1:] != 0) & (sides[:-1] == 0)])
            shares, stages = run.seen[e, kernel().SHARES :][: line.counts[e]] / self.length, line.sides[e]
            inertia = 1 / line.inverse[e, e]
            contacts.append(SpringContact.of(line.springs[e], shares, stages[: line.counts[e]], speeds, inertia))
        return self._told(run.seen, start, tuple(contacts))

    def _told(self, seen: Array, start: Array, contacts: tuple[SpringContact, ...]) -> dict[str, Any]:
        k, springs = kernel(), seen[: len(self.line.springs)]
        return {
            "torque_low": springs[:, k.TORQUE_LOW],
            "torque_high": springs[:, k.TORQUE_HIGH],
            "torque_mean": springs[:, k.TORQUE_SUM] / self.length,
            "twist_low": springs[:, k.LOW],
            "twist_high": springs[:, k.HIGH],
            "twist_mean": springs[:, k.TWIST_SUM] / self.length,
            "clearance": float(springs[:, k.CLEARANCE].min()),
            "contacts": contacts,
            "state": start,
        }

    def observe(self, x: Array, passage: MapEvaluation) -> Observed:
        k, count = staged_flow.kernel(), SAMPLES * self.periods
        seen = passage.run.seen[: len(self.line.springs)]
        low, high = seen[:, k.TORQUE_LOW], seen[:, k.TORQUE_HIGH]
        times = self.length * np.arange(count) / count
        states = staged_flow.move(self.flow, self.whole(x), 0.0, self.length, times=times).states
        # At the frequency of the excitation, of a subharmonic motion too.
        amplitude = 2 * np.abs(np.fft.rfft(states, axis=0)[self.periods]) / count
        return Observed(high - low, np.maximum(np.abs(low), np.abs(high)), amplitude[self.kept])
