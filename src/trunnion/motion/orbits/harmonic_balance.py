"""Periodic motions as Fourier series whose harmonics balance, followed over a parameter.

For ẋ = f(t, x) with period T the series x(t) of H harmonics must satisfy the first H harmonics of the equation.
f is evaluated in the time domain, at samples of the period, and transformed (alternating frequency–time: Cameron
and Griffin, J. Appl. Mech. 56, 1989); the Jacobian is exact, from ∂f/∂x at the same samples, also across the kinks
of a piecewise force. Any forced ``System`` will do: an oscillator, a backlash, a driveline.

Stability comes from the monodromy matrix along the motion that starts where the series starts; how far that
motion misses its start after a period is the ``defect``, the error of the series measured by another method.

One driver follows every balance: a branch with so many harmonics, or with as many as its tail asks for. What differs
is the residual: here of any first-order system, in ``harmonic_balance_springs`` of masses on springs. Periodic steady
states of free–free lines (``steady.free.free_balance``) lie on no branch: their speeds are given, and one Newton's
method takes its steps for all of them together (``numerics.continuation.newton``). Harmonics are doubled alike, and
the matrices of the balance are the same for all (``numerics.harmonics``).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Complex
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.parameters import Parameter
from trunnion.equations.coefficients import Assembly
from trunnion.errors import InputError
from trunnion.motion.orbits.branch import STEP, BranchProblem, PeriodicBranch, collect, follow_both_ways
from trunnion.motion.orbits.periodic_branch import SystemOver, system_over
from trunnion.numerics import harmonics as fourier
from trunnion.numerics.continuation.arclength import CurvePoint
from trunnion.numerics.curves import extremes
from trunnion.numerics.harmonics import doubled
from trunnion.numerics.integration.sampled_rates import sampled_rates
from trunnion.numerics.threads import on_one_thread
from trunnion.results.fields import attribute, computed, labelled, variable
from trunnion.results.outcome import Outcome
from trunnion.steady.shooting.periodic_orbit import TOLERANCE, periodic_orbit
from trunnion.steady.shooting.shooting_problem import CLEAR, IntegratedShooting
from trunnion.systems.system import System

FEWEST, MOST = 8, 256
"""Harmonics to begin with, whose samples are the fewest taken, and the most that a tail is answered with."""
SMOOTH_SAMPLES, KINKED_SAMPLES = 8, 128
"""Samples per harmonic: what is not resolved of a kink folds back, and must stay below what the series leaves out."""
TAIL, KINKED_TAIL = 1e-6, 1e-4
"""Of a smooth motion, whose coefficients fall exponentially; of one with kinks, whose rates fall like k⁻³."""
FAR = 100.0
"""Distance of a spectral radius from 1, over that of the series from the motion, at which its error does not matter."""


@labelled
class SeriesBranch(PeriodicBranch):
    """A branch of periodic motions as Fourier series."""

    rows: Array = variable("point state coefficient", "", "mean, cosines 1…H, sines 1…H", name="series")
    tail: Array = variable("point", "", "the largest of the last harmonics over the largest of all")
    periods: int = attribute("of the forcing in one of the motion")

    @property
    @computed(attribute())
    def harmonics(self) -> int:
        """H, per period of the motion."""
        return fourier.order(self.rows)

    @property
    def branch(self) -> PeriodicBranch:
        """The branch alone, as other methods give it."""
        return PeriodicBranch(**{name: getattr(self, name) for name in PeriodicBranch.__dataclass_fields__})

    @property
    def _worst(self) -> str:
        return f"tail up to {self.tail.max():.1e}"

    def __str__(self) -> str:
        head = f"harmonic balance with {self.harmonics} harmonics, {self._worst}\n" if len(self.rows) else ""
        return f"{head}{super().__str__()}"


S = TypeVar("S", bound=SeriesBranch)


class Balance(BranchProblem, Protocol):
    """The balance of h harmonics as equations of a curve z = (series, parameter)."""

    h: int
    periods: int

    def first(self) -> Array:
        """A series to begin with, (n, 2h + 1)."""

    def rows(self, point: CurvePoint) -> Array:
        """The series at a point of the curve, (n, 2h + 1)."""


class HarmonicSeries:
    """What every balance shares."""

    h: int

    def rows(self, point: CurvePoint) -> Array:
        return point.z[:-1].reshape(-1, 2 * self.h + 1)


def balanced(
    kind: type[S],
    make: Callable[[int], Balance],
    harmonics: int | None,
    fewest: int,
    most: int,
    limit: float,
    begin: float,
    low: float,
    high: float,
    most_points: int,
) -> S:
    """The branch with ``harmonics``, or doubled from ``fewest`` until the tail is below ``limit`` everywhere."""
    *tried, last = [harmonics] if harmonics is not None else doubled(fewest, most)
    with on_one_thread():
        for h in tried:
            found = _followed(kind, make(h), begin, low, high, most_points, limit)
            if found is not None and np.all(found.tail < limit):
                return found
        found = _followed(kind, make(last), begin, low, high, most_points, np.inf)
    assert found is not None
    return found if harmonics is not None else _judged(found, limit)


def _followed(
    kind: type[S], problem: Balance, begin: float, low: float, high: float, most_points: int, limit: float
) -> S | None:
    """The branch; None as soon as a point of it needs more harmonics to keep its tail below the limit."""

    def stop(point: CurvePoint) -> bool:
        return not tail_of(problem.rows(point)) < limit

    first = np.append(problem.first().ravel(), begin)
    walk, outcome = follow_both_ways(problem, first, low, high, most_points, stop=stop)
    if outcome.kind == "stopped" and np.isfinite(limit):
        return None
    if not walk:
        near = problem.over.said(begin)
        nothing = f"no motion with {problem.h} harmonics was found near {near}; give a start"
        outcome = Outcome(False, "not found", nothing)
    shape = -1, (len(problem.scale) - 1) // (2 * problem.h + 1), 2 * problem.h + 1
    rows = np.array([problem.rows(point) for point, _ in walk]).reshape(shape)
    tail = np.array([tail_of(row) for row in rows])
    return collect(problem, walk, outcome, kind, rows=rows, tail=tail, periods=problem.periods)


def _judged(found: S, limit: float) -> S:
    """With the outcome that the tail asked for was not reached, if so."""
    worst = found.tail.max(initial=0.0)
    if worst < limit:
        return found
    words = f"{found.outcome.sentence}; the last of {found.harmonics} harmonics are still {worst:.1e} of the motion"
    return replace(found, outcome=Outcome(False, "tail", f"{words}: raise tail above {limit:.1g}, or give harmonics"))


def tail_of(rows: Array) -> float:
    """The last two harmonics over the largest; of all unknowns together, since those of one that hardly moves say
    nothing."""
    h = fourier.order(rows)
    size = np.hypot(rows[:, 1 : h + 1], rows[:, h + 1 :]).max(axis=0)
    return float(size[max(h - 2, 0) :].max() / max(size.max(), 1e-300))


@labelled
class HarmonicBalance(SeriesBranch):
    """A branch of periodic motions as Fourier series; see ``SeriesBranch``."""

    @cached_property
    @computed(variable("point"))
    def defect(self) -> Array:
        """Distance (points,) between start and end of the true motion through the series' start, in units of the
        states' scales; NaN where that motion cannot be computed (at a grazing)."""
        assert isinstance(self.problem, _LineBalance)
        return np.array([self.problem.defect(CurvePoint(z, z, 0)) for z in self.unknowns])

    def motion(self, point: int, count: int = 1024) -> Array:
        """States (count, n) at equidistant times of the period of one point."""
        return np.ascontiguousarray(fourier.samples(self.rows[point], count).T)

    @property
    def _worst(self) -> str:
        return f"{super()._worst}, defect up to {np.nanmax(self.defect):.1e}"


def harmonic_balance(
    line: Driveline | Assembly | System,
    parameter: str | Parameter,
    low: float,
    high: float,
    *,
    begin: float | None = None,
    start: ArrayLike | None = None,
    speed: float | str | None = None,
    periods: int = 1,
    harmonics: int | None = None,
    tail: float | None = None,
    longest_step: float = 0.01,
    most_points: int = 2000,
) -> HarmonicBalance:
    """Follow a periodic motion over a parameter by harmonic balance.

    Parameters
    ----------
    line : a ``Driveline`` whose speed is prescribed (or its ``Assembly``), or a forced ``System``.
    parameter : of a line its path ("speed", "HookeJoint 1.angle", a ``Parameter``); of a system its name.
    low, high : ends of the range, in SI units.
    begin : where the first motion is sought, by default at ``low``; from inside the range the branch is followed both
        ways.
    start : a state (n,) near the first motion at t = 0, or its series (n, 2H + 1); so isolated branches are reached.
    speed : input speed [rad/s] of a line, where it is not the parameter.
    periods : forcing periods in one period of the motion; more than 1 gives subharmonic motions.
    harmonics : number of harmonics H of the motion's own period; by default as many as bring the last ones below
        ``tail`` times the motion everywhere on the branch (at most 256; the outcome says if these are too few).
    tail : last harmonics over the largest; 1e-6 by default, 1e-4 for systems with regimes.
    longest_step : largest step of the parameter, as a share of its range.
    most_points : points after which the branch ends.

    Returns
    -------
    HarmonicBalance, a branch whose ``outcome`` says where it ended; if no motion was found at ``begin`` it has no
    points.

    Raises
    ------
    InputError : an unknown parameter, a reversed range, an autonomous system, a number of harmonics below 1.

    Examples
    --------
    >>> import trunnion as tn
    >>> duffing = tn.reference_system("duffing")
    >>> branch = tn.harmonic_balance(duffing, "frequency", 0.8, 1.2, harmonics=5, longest_step=0.05)
    >>> branch.rows.shape[1:], branch.outcome.kind
    ((2, 11), 'followed')
    """
    if harmonics is not None and not 1 <= harmonics <= 10_000:
        raise InputError("must be a whole number of at least 1", key="harmonics", value=harmonics)
    if tail is not None and not 0 < tail < 1:
        raise InputError("must lie between 0 and 1", key="tail", value=tail, remedy="write 1e-6, say")
    family = system_over(line, parameter, low, high, begin, speed, longest_step / STEP)
    limit = tail or (TAIL if family.at(family.begin).regimes is None else KINKED_TAIL)
    begun = _first_rows(family, start, periods, harmonics or FEWEST * periods)
    return balanced(
        HarmonicBalance, lambda h: _LineBalance(family, periods, h, begun), harmonics, FEWEST * periods, MOST, limit,
        family.begin, low, high, most_points,
    )  # fmt: skip


def _first_rows(family: SystemOver, start: ArrayLike | None, periods: int, h: int) -> Array:
    """A series to begin with: the one given, or that of a motion found by shooting, or none but zeros."""
    system = family.at(family.begin)
    if start is not None and np.ndim(start) == 2:
        return fourier.resized(np.asarray(start, dtype=float), h)
    orbit = periodic_orbit(system, start=start, periods=periods)
    if not orbit.outcome.ok:
        return np.zeros((system.size, 2 * h + 1))
    times = orbit.period * np.arange(32 * h) / (32 * h)
    return fourier.rows_of(orbit.trajectory.at(times).T, h)


@dataclass
class _LineBalance(HarmonicSeries):
    """The balance of h harmonics as equations of a curve z = (series, value), and what its points tell."""

    over: SystemOver
    periods: int
    h: int
    begun: Array

    @property
    def size(self) -> int:
        return len(self.over.scale) - 1

    @property
    def scale(self) -> Array:
        wide = 2 * self.h + 1
        return np.append(np.repeat(self.over.scale[:-1], wide), self.over.scale[-1])

    def equations(self, z: Array) -> tuple[Array, Array]:
        """What the balance leaves over one radian, in units of the states' scales, and its derivative."""
        unknowns, wide, value = len(z) - 1, 2 * self.h + 1, float(z[-1])
        rows = z[:-1].reshape(-1, wide)
        # The parameter enters in any way, the period included: central differences, good to some 1e-9.
        step = 1e-4 * float(self.over.scale[-1])
        here = self._left(rows, value, with_slope=True)
        before, after = (self._left(rows, value + side * step, with_slope=False) for side in (-1, 1))
        if here is None or before is None or after is None:
            return np.full(unknowns, np.nan), np.full((unknowns, unknowns + 1), np.nan)
        left, slope = here
        by_parameter = (after[0] - before[0]) / (2 * step)
        over = 1 / np.repeat(self.over.scale[:-1], wide)
        return left * over, np.hstack([slope, by_parameter[:, None]]) * over[:, None]

    def _left(self, rows: Array, value: float, *, with_slope: bool) -> tuple[Array, Array] | None:
        """(D X − F)/ω (n (2h + 1),) and its derivative by the rows."""
        try:
            system = self.over.at(value)
        except InputError:  # a trial value may be no value of this parameter
            return None
        if system.forcing_period is None or not np.isfinite(rows).all():
            return None
        n, wide, h = self.size, 2 * self.h + 1, self.h
        period = self.periods * system.forcing_period
        omega = 2 * np.pi / period
        per_harmonic = SMOOTH_SAMPLES if system.regimes is None else KINKED_SAMPLES
        count = 1 << int(np.ceil(np.log2(per_harmonic * max(h, FEWEST))))
        states = np.ascontiguousarray(fourier.samples(rows, count).T)
        evaluated = sampled_rates(
            system.equations, period * np.arange(count) / count, states, system.regime_at(0.0, states[0])
        )
        if evaluated is None:
            return None
        rates, jacobians, _ = evaluated
        left = (fourier.rate(rows, omega) - fourier.rows_of(rates.T, h)) / omega
        if not with_slope:
            return left.ravel(), np.zeros((0, 0))
        slope = -fourier.product_blocks(jacobians, h)
        slope[np.arange(n), :, np.arange(n), :] += fourier.rate_matrix(h, omega)
        return left.ravel(), slope.reshape(n * wide, n * wide) / omega

    @cached_property
    def true(self) -> IntegratedShooting:
        """The true motions through the starts of the series."""
        return IntegratedShooting(self.over.map(self.periods, TOLERANCE), self.over.scale)

    def first(self) -> Array:
        return fourier.resized(self.begun, self.h)

    def start(self, point: CurvePoint) -> Array:
        rows = self.rows(point)
        return np.asarray(rows[:, : self.h + 1].sum(axis=1))

    def on_motion(self, point: CurvePoint) -> CurvePoint:
        """The point of the true motion through the series' start."""
        z = np.append(self.start(point), point.parameter)
        return CurvePoint(z, np.zeros_like(z), point.corrections)

    def defect(self, point: CurvePoint) -> float:
        """How far the motion misses its start, in units of the states' scales."""
        passage = self.true.passage(self.on_motion(point))
        missed = (passage.state - self.start(point)) / self.over.scale[:-1]
        return float(np.abs(missed).max()) if passage.done else np.nan

    def multipliers(self, point: CurvePoint) -> Complex:
        """By falling modulus; NaN where the motion cannot be computed."""
        return self.true.multipliers(self.on_motion(point))

    def radius_error(self, point: CurvePoint, radius: float) -> float:
        """Against the multipliers of the motion that one step of Newton's method takes the series' start to.

        Where the radius is far from 1, the distance from there on which only the side of 1 matters.
        """
        here = self.on_motion(point)
        passage, scale = self.true.passage(here), self.over.scale[:-1]
        if not passage.done:
            return FAR
        over_period = passage.run.final[1:].T * scale / scale[:, None]
        missed = (passage.state - self.start(point)) / scale
        step = np.linalg.lstsq(np.eye(self.size) - over_period, missed, rcond=1e-12)[0]
        far = max(CLEAR, FAR * float(np.abs(step).max()))
        if abs(radius - 1) > far:
            return far
        closer = replace(here, z=here.z + np.append(step * scale, 0.0))
        if not self.true.passage(closer).done:
            return far
        better = float(np.abs(self.true.multipliers(closer)).max())
        return 2 * abs(better - radius) + self.true.radius_error(closer, better)

    def undamped(self, point: CurvePoint) -> bool:
        """Whether nothing damps the motion."""
        return self.true.undamped(self.on_motion(point))

    def changes(self, point: CurvePoint) -> int:
        """Changes of regime in a period."""
        return self.true.changes(self.on_motion(point))

    def observed(self, point: CurvePoint) -> tuple[Array, Array, Array, float]:
        """Peak-to-peak and largest absolute value of the curves, amplitude of the fundamental of the states, period."""
        system, rows = self.over.at(point.parameter), self.rows(point)
        assert system.forcing_period is not None
        period = self.periods * system.forcing_period

        def curves(phases: Array) -> Array:
            states = np.ascontiguousarray(fourier.at(rows, phases).T)
            return self.over.observe(system, period / (2 * np.pi) * phases, states)

        seen = extremes(curves, fourier.cuts(self.h))
        amplitude = np.hypot(rows[:, self.periods], rows[:, self.h + self.periods])
        return seen.span, seen.largest, amplitude, period
