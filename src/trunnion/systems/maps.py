"""Maps made from a flow: over one period, from one crossing of a section to the next, and their derivatives.

A map takes a state to a state, x → P(x), and is a system again: what works on a map (fixed points, multipliers,
branches, Lyapunov exponents) works on any of these.

    over a period T of the forcing:            P(x) = φ(t₀ + T; t₀, x),          DP = Φ
    section {g = 0, in one direction}:         P(x) = φ(τ(x); x),   DP = (I − f ∇gᵀ/ġ) Φ
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, Self

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Integers
from trunnion.errors import InputError
from trunnion.numerics.curves import extremes, fourier
from trunnion.numerics.integration.integration import MOST_STEPS, TOLERANCE, IntegrationEnd, Trajectory, integrate
from trunnion.numerics.integration.integration import kernel as compiled_core
from trunnion.numerics.integration.tangents import Motion
from trunnion.systems.events import Event, watch
from trunnion.systems.regimes import SLACK
from trunnion.systems.system import System

if TYPE_CHECKING:
    from trunnion.numerics.integration.integration import Watch

SETTLED = 1e-8
"""Tolerance of motions that only have to come near an orbit."""
SAME = 1e-9
"""Time between two crossings, over that between looks, below which they are one."""
MOMENT = 0.02
"""Share of the period within which a slider that sticks may slip by rounding."""
LOOSER = (1.0, 10.0, 100.0)
"""A motion that touches a switching surface may chatter there at one tolerance and pass at another."""


@dataclass(frozen=True)
class MapEvaluation:
    """One application of a map.

    state (n,): P(x); tangents (n, n): DP; by_values (n, k): derivatives by the values asked for; changes of regime on
    the way; done: False where the motion ended before; run: what is behind it.
    """

    state: Array
    tangents: Array
    by_values: Array
    changes: int
    done: bool
    run: Any


class Observed(NamedTuple):
    """What a closed motion does: peak-to-peak and largest absolute value of the curves (c,), amplitude of every
    state (n,) at the frequency of the forcing."""

    span: Array
    largest: Array
    amplitude: Array


class PeriodMap(Protocol):
    """x → x after a period, at values of the parameters that a branch follows or that an orbit has as unknowns."""

    @property
    def size(self) -> int:
        """Number of states n."""

    @property
    def length(self) -> float:
        """Time of one application [s]."""

    def at(self, *values: float) -> Self:
        """The same map at other values; a value that is none raises InputError, here or where the map is applied."""

    def __call__(
        self, x: Array, *, tangents: bool = True, by: Sequence[int] = (), watch: bool = False
    ) -> MapEvaluation:
        """P(x), its derivative, and the derivatives by some of the values; ``watch`` records what is observed."""

    def settle(self, x: Array, periods: int) -> Array | None:
        """Where the motion is after some applications, as near as a start has to be; None where it ends before."""

    def observe(self, x: Array, passage: MapEvaluation) -> Observed:
        """What the closed motion from x does; NaN where it cannot be computed."""


class RubbingMap(PeriodMap, Protocol):
    """The map of a line with sliders.

    The deflection of a slider that sticks throughout comes back whatever it has beside the twist that it follows: the
    motion is one of a continuum, and the gradient of that difference a left eigenvector of its monodromy matrix, with
    the multiplier 1.
    """

    @property
    def sliders(self) -> int:
        """How many."""

    @property
    def deflections(self) -> Integers:
        """Places (slider,) of their deflections among the states."""

    @property
    def fixed(self) -> tuple[int, ...]:
        """Numbers of those that are kept from slipping."""

    def holding(self, which: tuple[int, ...]) -> Self:
        """The map in which the sliders ``which`` are kept from slipping, which rounding could let them."""

    def idle(self, x: Array) -> tuple[int, ...]:
        """Numbers of the sliders that slip for no more than a moment in the motion from x, and stay within what they
        hold."""

    def conserved(self, x: Array, which: tuple[int, ...]) -> Array:
        """Gradients (k, n) by the state of the deflections of sliders beside the twists that they follow."""

    def within_limits(self, x: Array) -> Array:
        """x (n,), deflections beyond what their sliders hold brought back to that."""


@dataclass(frozen=True)
class IntegratedMap:
    """x(t₀) → x(t₀ + periods · T) by integration, of one system or of a family of them.

    Parameters
    ----------
    family : values → system.
    values, steps : where the family stands, and the steps of its differences by them (k,).
    phase : t₀ [s].
    periods : forcing periods per application.
    look : (system, times, states) → curves (times, c) to be observed; by default the states.
    fixed : numbers of the sliders that are kept from slipping.
    """

    family: Callable[..., System]
    values: tuple[float, ...] = ()
    steps: tuple[float, ...] = ()
    phase: float = 0.0
    periods: int = 1
    tolerance: float = TOLERANCE
    most_steps: int = MOST_STEPS
    look: Callable[[System, Array, Array], Array] | None = None
    fixed: tuple[int, ...] = ()

    @classmethod
    def of(cls, system: System, *, phase: float = 0.0, periods: int = 1, tolerance: float = TOLERANCE) -> Self:
        """The map of one system."""
        return cls(lambda: system, phase=phase, periods=periods, tolerance=tolerance)

    @cached_property
    def system(self) -> System:
        """The system at the values."""
        system = self.family(*self.values)
        if not self.fixed:
            return system
        assert system.regimes is not None
        numbers = system.regimes.holding(np.array(self.fixed), system.numbers)
        return system.with_fields(numbers_of=lambda values: numbers)

    @property
    def size(self) -> int:
        return self.system.size

    @cached_property
    def length(self) -> float:
        period = self.system.forcing_period
        if period is None:
            raise InputError(
                "is autonomous and has no forcing period", element=self.system.name, key="period",
                remedy="use a SectionMap, or give the system its period",
            )  # fmt: skip
        return self.periods * period

    def at(self, *values: float) -> Self:
        return replace(self, values=values)

    def run(self, block: Array, *, dense: bool = False, looser: float = 1.0) -> Trajectory:
        """The motion from the first row of ``block``, the others carried along as tangents."""
        start = self.system.within_limits(block[0])
        if np.any(start != block[0]):  # a trial may lie where no motion is; its neighbours there lead to the same one
            block = np.vstack([start, np.where(start == block[0], block[1:], 0.0)])
        regime = self.system.regime_at(self.phase, start)
        return integrate(
            self.system.equations, self.phase, self.phase + self.length, block, regime=regime,
            tolerance=looser * self.tolerance, most_steps=self.most_steps, dense=dense,
        )  # fmt: skip

    def __call__(
        self,
        x: Array,
        *,
        tangents: bool = True,
        by: Sequence[int] = (),
        watch: bool = False,
        looser: float = 1.0,
        dense: bool = False,
    ) -> MapEvaluation:
        n = self.size
        run = self.run(np.vstack([x, np.eye(n)]) if tangents else x[None], dense=dense, looser=looser)
        columns = [self.slope(x, run, place, looser) for place in by] if run.end is IntegrationEnd.REACHED else []
        done = run.end is IntegrationEnd.REACHED and all(np.isfinite(column).all() for column in columns)
        by_values = np.stack(columns, axis=1) if columns else np.zeros((n, 0))
        return MapEvaluation(run.final[0], run.final[1:].T, by_values, len(run.event_time), done, run)

    def slope(self, x: Array, run: Trajectory, place: int, looser: float) -> Array:
        """∂P by one of the values, by a central difference of runs as loose as ``run``; NaN where one ends before."""
        ends = []
        for side in (-1.0, 1.0):
            moved = list(self.values)
            moved[place] += side * self.steps[place]
            beside = self.at(*moved).run(x[None], looser=looser)
            ends.append(beside.final[0] if beside.end is IntegrationEnd.REACHED else np.full(len(x), np.nan))
        return np.asarray((ends[1] - ends[0]) / (2 * self.steps[place]))

    def settle(self, x: Array, periods: int) -> Array | None:
        x = self.system.within_limits(x)
        run = integrate(
            self.system.equations, self.phase, self.phase + periods * self.length, x,
            regime=self.system.regime_at(self.phase, x), tolerance=max(self.tolerance, SETTLED), dense=False,
        )  # fmt: skip
        return run.final[0] if run.end is IntegrationEnd.REACHED else None

    def observe(self, x: Array, passage: MapEvaluation) -> Observed:
        look = self.look or (lambda system, times, states: states)
        run = next((run for run in (self.run(x[None], dense=True, looser=by) for by in LOOSER) if _reached(run)), None)
        if run is None:
            nothing = np.full(look(self.system, np.zeros(1), x[None]).shape[1], np.nan)
            return Observed(nothing, nothing, np.full(self.size, np.nan))
        amplitude = np.abs(fourier(run.at, run.time_of_state, self.periods)[self.periods])
        seen = extremes(lambda times: look(self.system, times, run.at(times)), run.time_of_state)
        return Observed(seen.span, seen.largest, amplitude)

    @property
    def sliders(self) -> int:
        return len(self.system.sliders)

    @property
    def deflections(self) -> Integers:
        return np.arange(self.size - self.sliders, self.size)

    def holding(self, which: tuple[int, ...]) -> Self:
        return replace(self, fixed=which)

    def idle(self, x: Array) -> tuple[int, ...]:
        passage, regimes, count = self(x, tangents=False, dense=True), self.system.regimes, self.sliders
        if regimes is None or not passage.done:
            return ()
        still = regimes.stuck(passage.run.regime, passage.run.length, MOMENT)
        seen = extremes(lambda times: passage.run.at(times)[:, -count:], passage.run.time_of_state)
        reach = self.family(*self.values).within_limits(np.full(self.size, np.inf))[-count:]
        return tuple(still[seen.largest[still] <= (1 + SLACK) * reach[still]].tolist())

    def conserved(self, x: Array, which: tuple[int, ...]) -> Array:
        system, equations = self.system, self.system.equations
        if system.regimes is None:
            return np.zeros((0, system.size))
        count = equations.transitions.shape[1]
        g, slopes = np.zeros(count), np.zeros(count * (system.size + 1))
        compiled_core().call_guard(equations.guard, float(self.phase), x, system.numbers.copy(), 0, g, slopes)
        return system.regimes.conserved(np.array(which, dtype=np.int64), slopes.reshape(count, -1))

    def within_limits(self, x: Array) -> Array:
        return self.system.within_limits(x)

    def motion(self, x: Array, frame: Array) -> Motion:
        """The motion from x application by application, a frame of tangents (k, n) carried along, compiled."""
        system = self.system
        return Motion(
            system.equations, x, frame, self.length, system.forcing_period or 0.0, self.phase,
            system.regime_at(self.phase, x), self.tolerance,
        )  # fmt: skip


@dataclass(frozen=True)
class TimedMap(IntegratedMap):
    """x → φ(T; x) of an autonomous system, the time T [s] its only value."""

    @cached_property
    def length(self) -> float:
        return float(self.values[0])

    def slope(self, x: Array, run: Trajectory, place: int, looser: float) -> Array:
        return self.system.rate_at(run.time, run.final[0], run.final_regime)

    @classmethod
    def over(cls, system: System, time: float, *, phase: float = 0.0, tolerance: float = TOLERANCE) -> Self:
        """The map of one system over a time."""
        return cls(lambda time: system, (float(time),), (0.0,), phase, tolerance=tolerance)


def _reached(run: Trajectory) -> bool:
    return run.end is IntegrationEnd.REACHED


class Image(NamedTuple):
    """What a map returns: the state (n,), the images of the tangent vectors (k, n), the time it took, how it
    ended (``IntegrationEnd.REACHED``, or what went wrong: the state is then NaN), and the trajectory behind it."""

    state: Array
    tangents: Array
    duration: float
    end: IntegrationEnd
    trajectory: Trajectory


class Crossings(NamedTuple):
    """Points (m, n) and times (m,) [s] at which a motion meets a section, and the last stretch of it."""

    points: Array
    time: Array
    run: Trajectory


class _Applied(ABC):
    """What follows from ``apply`` alone."""

    system: System

    @abstractmethod
    def apply(self, state: ArrayLike, tangents: ArrayLike | None = None) -> Image:
        """P(x) and what it does to tangents."""

    def __call__(self, state: ArrayLike) -> Array:
        """P(x)."""
        return self.apply(state).state

    def jacobian(self, state: ArrayLike) -> Array:
        """DP (n, n); of a section of rank n − 1: its range lies in the surface."""
        return self.apply(state, np.eye(self.system.size)).tangents.T


def checked_periods(periods: int) -> int:
    """The number of periods, if it is one.

    Raises
    ------
    InputError : not a whole number from 1.
    """
    if isinstance(periods, bool) or periods != int(periods) or periods < 1:
        raise InputError("must be a whole number from 1", key="periods", value=periods)
    return int(periods)


@dataclass(frozen=True)
class StroboscopicMap(_Applied):
    """x(t₀) → x(t₀ + periods · T); each application starts at the same phase, so no digits are lost to time.

    Parameters
    ----------
    system : with a forcing period.
    phase : t₀ [s].
    periods : forcing periods per application.
    tolerance : error allowed per step, relative to the scale of a state + |x|.
    most_steps : steps after which an application ends.

    Raises
    ------
    InputError : an autonomous system, periods that are not a whole number from 1.

    >>> import trunnion as tn
    >>> section = StroboscopicMap(tn.reference_system("duffing"))
    >>> section([0.1, 0.0]).round(4)
    array([-0.1371,  0.4198])
    """

    system: System
    phase: float = 0.0
    periods: int = 1
    tolerance: float = TOLERANCE
    most_steps: int = MOST_STEPS

    def __post_init__(self) -> None:
        checked_periods(self.periods)
        _ = self.duration  # refuses what has no period

    @cached_property
    def map(self) -> IntegratedMap:
        """The map as orbits and branches take it."""
        found = IntegratedMap.of(self.system, phase=self.phase, periods=self.periods, tolerance=self.tolerance)
        return replace(found, most_steps=self.most_steps)

    @property
    def duration(self) -> float:
        """Time of one application [s]."""
        return self.map.length

    def apply(self, state: ArrayLike, tangents: ArrayLike | None = None, *, dense: bool = False) -> Image:
        """P(x), and DP·v for each row of ``tangents`` (k, n)."""
        run = self.map.run(_block(state, tangents), dense=dense)
        return _image(run, run.final, self.duration, run.end)


@dataclass(frozen=True)
class SectionMap(_Applied):
    """From one crossing of a surface to the next in the same direction.

    Parameters
    ----------
    system : any.
    section : the surface, with a direction of +1 or −1.
    longest : time [s] after which the section counts as never crossed; by default 1000 forcing periods, or
        1000 s for an autonomous system.
    tolerance : error allowed per step, relative to the scale of a state + |x|.
    most_steps : steps after which an application ends.

    Raises
    ------
    InputError : a section without a direction.

    >>> import trunnion as tn
    >>> section = SectionMap(tn.reference_system("lorenz"), Event("z", level=27.0, direction=+1))
    >>> section([1.0, 1.0, 20.0]).round(4)
    array([14.0025, 20.1258, 27.    ])
    """

    system: System
    section: Event
    longest: float | None = None
    tolerance: float = TOLERANCE
    most_steps: int = MOST_STEPS

    def __post_init__(self) -> None:
        if self.section.direction not in (-1, 1):
            raise InputError(
                "must be +1 or −1 on a section", element="Event", key="direction", value=self.section.direction
            )

    @cached_property
    def _watch(self) -> Watch:
        return watch(self.system, (self.section.stopping(),))

    @property
    def limit(self) -> float:
        """Time [s] after which the section counts as never crossed."""
        return self.longest if self.longest is not None else 1000 * (self.system.forcing_period or 1.0)

    def apply(
        self, state: ArrayLike, tangents: ArrayLike | None = None, *, time: float = 0.0, dense: bool = False
    ) -> Image:
        """The next crossing after ``time``, and DP·v for each row of ``tangents``; ``end`` is
        ``IntegrationEnd.STOPPED`` where there is one and ``IntegrationEnd.REACHED`` where there is none within
        ``longest``."""
        block = _block(state, tangents)
        run = integrate(
            self.system.equations, time, time + self.limit, block, regime=self.system.regime_at(time, block[0]),
            tolerance=self.tolerance, most_steps=self.most_steps, watch=self._watch, dense=dense,
        )  # fmt: skip
        if run.end is not IntegrationEnd.STOPPED:
            return _image(run, np.full_like(run.final, np.nan), run.time - time, run.end)
        final = run.final.copy()
        rate = self.system.rate_at(run.time, final[0], run.final_regime)
        gradient, by_time = self._gradient(run)
        speed = gradient @ rate + by_time
        final[1:] -= np.outer(final[1:] @ gradient / speed, rate)
        return Image(final[0], final[1:], run.time - time, IntegrationEnd.REACHED, run)

    def crossings(self, state: Array, wanted: int) -> Crossings:
        """The next ``wanted`` crossings of the motion from ``state`` at time 0; looked for in pieces of a hundredth of
        the limit, so that no digits are lost to time."""
        system, period, piece = self.system, self.system.forcing_period, self.limit / 100
        watched, own = watch(system, (self.section,)), system.equations.transitions.shape[1]
        points, times, have, passed, since, last = [], [], 0, 0.0, 0.0, -np.inf
        time, x, regime, step = 0.0, state, system.regime_at(0.0, state), 0.0
        while True:
            run = integrate(
                system.equations, time, time + piece, x, regime=regime, tolerance=self.tolerance, watch=watched,
                dense=False, first_step=step, most_steps=self.most_steps,
            )  # fmt: skip
            mine = run.event_which == own
            met = run.event_time[mine] - time + passed
            # A crossing that rounding leaves on its near side is met again at once; it counts as one.
            once = np.diff(met, prepend=last) > SAME * piece
            points.append(run.event_before[mine][once])
            times.append(met[once])
            last, have = met[-1] if len(met) else last, have + int(once.sum())
            since = 0.0 if mine.any() else since + piece
            if run.end is not IntegrationEnd.REACHED or have >= wanted or since >= self.limit:
                return Crossings(np.concatenate(points)[:wanted], np.concatenate(times)[:wanted], run)
            passed += piece
            time = 0.0 if period is None else (time + piece) % period
            x, regime, step = run.final[0], run.final_regime, run.next_step

    def _gradient(self, run: Trajectory) -> tuple[Array, float]:
        n, g = self.system.size, np.zeros(1)
        slope = np.zeros(n + 1)
        compiled_core().call_guard(
            self._watch.address, run.time, run.final[0].copy(), self._watch.numbers, run.final_regime, g, slope
        )
        return slope[:n], float(slope[n])


def _block(state: ArrayLike, tangents: ArrayLike | None) -> Array:
    x = np.asarray(state, dtype=float)
    return x[None] if tangents is None else np.vstack([x, np.atleast_2d(np.asarray(tangents, dtype=float))])


def _image(run: Trajectory, final: Array, duration: float, end: IntegrationEnd) -> Image:
    if run.end is not IntegrationEnd.REACHED:
        final = np.full_like(final, np.nan)
    return Image(final[0], final[1:], duration, end, run)
