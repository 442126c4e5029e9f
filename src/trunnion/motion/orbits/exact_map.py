"""Maps over a period whose motion is exact in pieces: of one mass, and of a driveline with stages.

The motion within a piece is known to rounding, and so is its passage from piece to piece; the derivatives by the state
and by the frequency (or speed) are those of the motion itself (``numerics.piecewise_linear``). A motion that touches
the end of a piece (grazing) has none.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple, Self

import numpy as np

from trunnion.arrays import Array, Integers
from trunnion.equations.staged_line import StagedLine
from trunnion.errors import InputError
from trunnion.laws.stages import STICKS
from trunnion.numerics.piecewise_linear import piecewise, staged_flow
from trunnion.numerics.piecewise_linear.staged_flow import StagedFlow, StagedPassage, kernel, stages_of
from trunnion.systems.maps import Observed, Passage
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator
from trunnion.systems.regimes import SLACK

SAMPLES = 512
"""Of a period, for the fundamental; a power of two times any usual number of periods."""
LEAST_TWIST = 1e-6
"""What a twist counts as at least when an orbit is closed [rad]."""
MOMENT = 0.02
"""Share of the period within which a slider that sticks may slip by rounding."""
REPEATS = 3
"""Periods that must repeat, one after the other, before a motion counts as settled."""


class Settled(NamedTuple):
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

    @abstractmethod
    def steady(self, x: Array, least: int, most: int, same: float) -> Settled:
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

    def __call__(self, x: Array, *, tangents: bool = True, by: Sequence[int] = (), watch: bool = False) -> Passage:
        o = self.oscillator
        try:
            run = piecewise.period(o.regimes, o.coefficients, self.value, x, self.periods)
        except piecewise.TooManyEventsError:
            return _broken(2, len(by))
        changes = int((run.events[:, 3] >= 0).sum())
        return Passage(run.state, run.tangents[:, :2], run.tangents[:, 2 : 2 + len(by)], changes, True, run)

    def steady(self, x: Array, least: int, most: int, same: float) -> Settled:
        o, k = self.oscillator, piecewise.kernel()
        state, tables = np.array(x, dtype=float), o.regimes
        regime = k.regime_at(state[0], state[1], tables.guards, tables.then)
        _, periods, repeats, ended = k.settle(
            state, regime, least, most, same, self.value, o.coefficients, tables.pieces, tables.guards, tables.then,
            np.empty((piecewise.MOST_EVENTS, k.RECORDED)),
        )  # fmt: skip
        return Settled(state, int(periods), bool(repeats), ended == k.DONE)

    def steady_from(self, starts: Array, least: int, most: int, same: float) -> Array:
        """As ``steady`` from many starts (m, 2): where they settle, NaN where they do not."""
        o, k = self.oscillator, piecewise.kernel()
        ends, periods = np.empty_like(starts), np.zeros(len(starts), dtype=np.int64)
        k.basins(
            starts, least, most, same, self.value, o.coefficients, o.regimes.pieces, o.regimes.guards,
            o.regimes.then, np.empty((piecewise.MOST_EVENTS, k.RECORDED)), ends, periods,
        )  # fmt: skip
        return np.where(periods[:, None] > 0, ends, np.nan)

    def measure(self, x: Array) -> dict[str, float]:
        """What the motion from x does; see ``piecewise.measure``."""
        o = self.oscillator
        return piecewise.measure(o.regimes, o.coefficients, self.value, x, self.periods)

    def observe(self, x: Array, passage: Passage) -> Observed:
        found = self.measure(x)
        low, high = found["low"], found["high"]
        # At the forcing frequency, of a subharmonic motion too.
        fundamental = float(np.hypot(found["real"], found["imaginary"]))
        return Observed(
            np.array([high - low]), np.array([max(abs(low), abs(high))]), fundamental * np.array([1.0, self.value])
        )


@dataclass(frozen=True)
class LineMap(ExactMap):
    """Twists and rates over ``periods`` of the excitation.

    Of a line that starts free with a viscous load the rotation itself need not close, only its rate: it is no state of
    the map, whose states stand at the places ``kept`` of the line's. Neither is the deflection of a slider that sticks
    throughout: what it has beside the twist comes back whatever it is, and ``stuck`` holds (row, that [rad]) of each.
    Such a slider is kept from slipping here, which rounding could let it; the motion found is asked whether it stays
    within what it holds.
    """

    line: StagedLine
    stuck: tuple[tuple[int, float], ...] = ()

    @property
    def size(self) -> int:
        return len(self.kept)

    @property
    def length(self) -> float:
        return self.periods * self.line.period(self.value)

    @cached_property
    def kept(self) -> Integers:
        """Places of the map's states among the line's."""
        still = {row for row, _ in self.stuck}
        return np.array([i for i in self.line.kept if i not in still])

    @cached_property
    def flow(self) -> StagedFlow:
        """The line's flow at the value."""
        return self.line.holding([row for row, _ in self.stuck], self.value)

    def whole(self, part: Array) -> Array:
        """The line's state (2m,) from the map's, deflections beyond what sliders hold brought back to it."""
        state = np.zeros(2 * self.line.size)
        state[self.kept] = part
        state = self.line.within_limits(state)
        for row, beside in self.stuck:
            state[row] = state[self.line.source[row]] + beside
        return state

    @cached_property
    def spread(self) -> Array:
        """Derivative (2m, n) of the line's state by the map's."""
        matrix = np.eye(2 * self.line.size)
        for row, _ in self.stuck:
            matrix[row] = matrix[self.line.source[row]]
        return matrix[:, self.kept]

    def sticking(self, rows: Iterable[int], start: Array) -> Self:
        """The map in which the sliders in these rows stick with the deflections that they have in ``start`` (2m,)."""
        beside = start[: self.line.size] - start[self.line.source]
        return replace(self, stuck=tuple((row, float(beside[row])) for row in sorted(rows)))

    def idle(self, passage: StagedPassage, start: Array) -> set[int]:
        """Rows of the sliders that slip for no more than a moment in a watched passage from ``start`` (2m,), and stay
        within what they hold."""
        k, first, found = kernel(), stages_of(self.flow, start), set()
        for row in self.line.slider_rows:
            own = passage.events[:, 1] == row
            times = np.concatenate([[0.0], passage.events[own, 0], [self.length]])
            slips = np.concatenate([[first[row]], passage.events[own, 2]]) != STICKS
            furthest = np.abs(passage.seen[row, [k.LOW, k.HIGH]]).max()
            if np.diff(times) @ slips <= MOMENT * self.length and furthest <= (1 + SLACK) * self.line.knots[row]:
                found.add(row)
        return found

    def scale(self, start: Array) -> Array:
        """Size of every state of the map that counts as one, from a start (2m,) of the line."""
        m = self.line.size
        size = np.maximum(np.maximum(np.abs(start[:m]), self.line.knots), LEAST_TWIST)
        turning = 2 * np.pi / self.line.period(self.value)
        return np.concatenate([size, np.maximum(np.abs(start[m:]), size * turning)])[self.kept]

    def __call__(self, x: Array, *, tangents: bool = True, by: Sequence[int] = (), watch: bool = False) -> Passage:
        slope = self.length * self.line.period_slope(self.value)
        run = staged_flow.period(self.flow, self.whole(x), self.length, slope, watch=watch)
        if not (run.done and np.isfinite(run.tangents).all()):
            return _broken(self.size, len(by))
        by_state = self.spread * (self.whole(x)[self.kept] == x)  # beyond what it holds a deflection is brought back
        matrix = (run.tangents[:, : 2 * self.line.size] @ by_state)[self.kept]
        by_value = run.tangents[self.kept, 2 * self.line.size :][:, : len(by)]
        return Passage(run.state[self.kept], matrix, by_value, len(run.events), True, run)

    def steady(self, x: Array, least: int, most: int, same: float) -> Settled:
        length, state, repeated = self.line.period(self.value), self.whole(x), 0
        for count in range(1, most + 1):
            run = staged_flow.move(self.flow, state, 0.0, length)
            change = np.abs(run.state - state)[self.kept] / self.scale(run.state)
            state = run.state
            if not (run.done and np.isfinite(state).all()):
                return Settled(np.full(self.size, np.nan), count, False, False)
            repeated = repeated + 1 if np.max(change) < same else 0
            if count >= least and repeated >= REPEATS:
                return Settled(state[self.kept], count, True, True)
        return Settled(state[self.kept], most, False, True)

    def watched(self, x: Array) -> StagedPassage:
        """The motion from x with what it shows of every spring."""
        return staged_flow.move(self.flow, self.whole(x), 0.0, self.length, watch=True)

    def observe(self, x: Array, passage: Passage) -> Observed:
        k, count = staged_flow.kernel(), SAMPLES * self.periods
        seen = passage.run.seen[: len(self.line.springs)]
        low, high = seen[:, k.TORQUE_LOW], seen[:, k.TORQUE_HIGH]
        times = self.length * np.arange(count) / count
        states = staged_flow.move(self.flow, self.whole(x), 0.0, self.length, times=times).states
        # At the frequency of the excitation, of a subharmonic motion too.
        amplitude = 2 * np.abs(np.fft.rfft(states, axis=0)[self.periods]) / count
        return Observed(high - low, np.maximum(np.abs(low), np.abs(high)), amplitude[self.kept])


def _broken(size: int, values: int) -> Passage:
    """A motion that changes its pieces too often to come to an end."""
    nothing = np.full((size, size + values), np.nan)
    return Passage(nothing[:, 0], nothing[:, :size], nothing[:, size:], -1, False, None)
