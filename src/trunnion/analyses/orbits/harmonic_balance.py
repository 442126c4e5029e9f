"""Periodic motions as Fourier series whose harmonics balance, followed over a parameter.

For ẋ = f(t, x) with period T the series x(t) of H harmonics must satisfy the first H harmonics of the equation.
f is evaluated in the time domain, at samples of the period, and transformed (alternating frequency–time: Cameron
and Griffin, J. Appl. Mech. 56, 1989); the Jacobian is exact, from ∂f/∂x at the same samples, also across the kinks
of a piecewise force. Any forced ``System`` will do: an oscillator, a backlash, a driveline.

Stability comes from the monodromy matrix along the motion that starts where the series starts; how far that
motion misses its start after a period is the ``defect``, the error of the series measured by another method.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from threadpoolctl import threadpool_limits

from trunnion.analyses.orbits.branch import STEP, PeriodicBranch, collect, follow_both_ways
from trunnion.analyses.orbits.periodic_orbit import periodic_orbit
from trunnion.analyses.orbits.systems_over import SystemOver, system_over
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.parameters import Parameter
from trunnion.equations.coefficients import Assembly
from trunnion.errors import InputError
from trunnion.numerics import harmonics as fourier
from trunnion.numerics.continuation.arclength import CurvePoint
from trunnion.numerics.curves import extremes
from trunnion.numerics.integration.integration import End, Trajectory, integrate
from trunnion.numerics.integration.sampled_rates import sampled_rates
from trunnion.results.outcome import Outcome
from trunnion.systems.system import System

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
FEWEST, MOST = 8, 256
"""Harmonics to begin with, and the most that a tail is answered with."""
TAIL, KINKED_TAIL = 1e-6, 1e-4
"""Of a smooth motion, whose coefficients fall exponentially; of one with kinks, whose rates fall like k⁻³."""
SMOOTH_SAMPLES, KINKED_SAMPLES = 8, 128
"""Samples per harmonic: what is not resolved of a kink folds back, and must stay below what the series leaves out."""
MOST_STEPS = 200_000
RADIUS_ERROR = 1e-6
"""What the spectral radius may be off by; nearer to 1 it is undecided."""


@dataclass(frozen=True)
class HarmonicBalance:
    """A branch of periodic motions as Fourier series.

    ``branch`` holds parameter, multipliers, verdicts, amplitudes and special points as ``periodic_branch`` does;
    rows (points, n, 2H + 1): mean, cosines, sines of every state; tail (points,): the largest of the last harmonics
    over the whole; defect (points,): distance between start and end of the true motion through the series' start, in
    units of the states' scales, NaN where that motion cannot be computed (at a grazing).
    """

    branch: PeriodicBranch
    rows: Array
    tail: Array
    defect: Array
    periods: int

    @property
    def harmonics(self) -> int:
        """H, per period of the motion."""
        return fourier.order(self.rows)

    @property
    def outcome(self) -> Outcome:
        """Where the branch ended and why."""
        return self.branch.outcome

    @property
    def data(self) -> xr.Dataset:
        """The branch's dataset with the series."""
        rows = ("point", "state", "coefficient"), self.rows, {"long_name": "mean, cosines 1…H, sines 1…H"}
        extra = {"series": rows, "tail": ("point", self.tail), "defect": ("point", self.defect)}
        return self.branch.data.assign(extra).assign_attrs(harmonics=self.harmonics, periods=self.periods)

    def motion(self, point: int, count: int = 1024) -> Array:
        """States (count, n) at equidistant times of the period of one point."""
        return np.ascontiguousarray(fourier.samples(self.rows[point], count).T)

    def plot(self, axes: Axes | None = None, **options: Any) -> Axes:
        """Response curve with its jumps."""
        return self.branch.plot(axes, **options)

    def __str__(self) -> str:
        if not len(self.rows):
            return str(self.branch)
        worst = f"tail up to {self.tail.max():.1e}, defect up to {np.nanmax(self.defect):.1e}"
        return f"harmonic balance with {self.harmonics} harmonics, {worst}\n{self.branch}"

    __repr__ = __str__


def harmonic_balance(
    line: Driveline | Assembly | System,
    parameter: str | Parameter,
    low: float,
    high: float,
    *,
    begin: float | None = None,
    start: ArrayLike | None = None,
    speed: float | None = None,
    periods: int = 1,
    harmonics: int | None = None,
    tail: float | None = None,
    longest_step: float = 0.01,
    most_points: int = 2000,
) -> HarmonicBalance:
    """Follow a periodic motion over a parameter by harmonic balance.

    Parameters
    ----------
    line, parameter, low, high, begin, speed, periods, longest_step, most_points : as in ``periodic_branch``;
        ``periods`` > 1 gives subharmonic motions, an isolated branch is followed from a ``start`` on it.
    start : a state near the first motion at t = 0, or its series (n, 2H + 1).
    harmonics : number of harmonics H of the motion's own period; by default as many as bring the last ones below
        ``tail`` times the motion everywhere on the branch (at most 256; the outcome says if these are too few).
    tail : 1e-6 by default, 1e-4 for systems with regimes.

    Returns
    -------
    A branch whose ``outcome`` says where it ended; if no motion was found at ``begin`` it has no points.

    Raises
    ------
    InputError : an unknown parameter, a reversed range, an autonomous system, a number of harmonics below 1.
    """
    if harmonics is not None and not 1 <= harmonics <= 10_000:
        raise InputError("must be a whole number of at least 1", key="harmonics", value=harmonics)
    if tail is not None and not 0 < tail < 1:
        raise InputError("must lie between 0 and 1", key="tail", value=tail, remedy="write 1e-6, say")
    over = system_over(line, parameter, low, high, begin, speed, longest_step / STEP)
    limit = tail or (TAIL if over.at(over.begin).regimes is None else KINKED_TAIL)
    h = harmonics or FEWEST * periods
    rows = _first_rows(over, start, periods, h)
    # Matrices of a few hundred rows: a library's threads would spend their time waiting for each other.
    with threadpool_limits(1, user_api="blas"):
        while harmonics is None and 2 * h <= MOST:
            found = _followed(over, rows, periods, h, low, high, most_points, limit)
            if found is not None and (not len(found.rows) or found.tail.max() < limit):
                return found
            h *= 2
            rows = fourier.resized(rows, h)
        found = _followed(over, rows, periods, h, low, high, most_points)
    assert found is not None
    return found if harmonics is not None else _judged(found, limit)


def _first_rows(over: SystemOver, start: ArrayLike | None, periods: int, h: int) -> Array:
    """A series to begin with: the one given, or that of a motion found by shooting, or none but zeros."""
    system = over.at(over.begin)
    n = system.size
    if start is not None and np.ndim(start) == 2:
        return fourier.resized(np.asarray(start, dtype=float), h)
    orbit = periodic_orbit(system, start=start, periods=periods)
    if not orbit.outcome.ok or system.forcing_period is None:
        return np.zeros((n, 2 * h + 1))
    times = periods * system.forcing_period * np.arange(32 * h) / (32 * h)
    run = _motion(system, orbit.start, periods * system.forcing_period)
    return fourier.rows_of(run.at(times).T, h)


def _followed(
    over: SystemOver,
    rows: Array,
    periods: int,
    h: int,
    low: float,
    high: float,
    most_points: int,
    limit: float = np.inf,
) -> HarmonicBalance | None:
    """The branch with h harmonics; None as soon as a point of it needs more to keep its tail below the limit."""
    problem = _Balance(over, periods, h)
    first = problem.packed(rows, over.begin)
    whole, outcome = follow_both_ways(
        problem, first, low, high, most_points, stop=lambda point: not _tail(problem.rows(point)) < limit
    )
    if outcome.kind == "stopped" and np.isfinite(limit):
        return None
    if not whole:
        nothing = f"no motion with {h} harmonics was found near {over.label} = {over.begin:g}; give a start"
        outcome = Outcome(False, "not found", nothing)
    return _result(problem, whole, outcome)


def _result(problem: _Balance, points: list[tuple[CurvePoint, str]], outcome: Outcome) -> HarmonicBalance:
    rows = np.array([problem.rows(point) for point, _ in points]).reshape(-1, problem.size, 2 * problem.h + 1)
    # The harmonics of a state that hardly moves say nothing, so a tail counts in units of the whole motion.
    tails = np.array([_tail(row) for row in rows])
    defects = np.array([problem.defect(point) for point, _ in points])
    return HarmonicBalance(collect(problem, points, outcome), rows, tails, defects, problem.periods)


def _judged(found: HarmonicBalance, limit: float) -> HarmonicBalance:
    """With the outcome that the tail asked for was not reached, if so."""
    worst = float(found.tail.max()) if len(found.tail) else 0.0
    if worst < limit:
        return found
    words = f"{found.outcome.sentence}; the last of {found.harmonics} harmonics are still {worst:.1e} of the motion"
    outcome = Outcome(False, "tail", f"{words}: raise tail above {limit:.1g}, or give harmonics")
    return replace(found, branch=replace(found.branch, outcome=outcome))


def _tail(rows: Array) -> float:
    h = fourier.order(rows)
    size = np.hypot(rows[:, 1 : h + 1], rows[:, h + 1 :]).max(axis=0)
    return float(size[max(h - 2, 0) :].max() / max(size.max(), 1e-300))


@dataclass
class _Balance:
    """The balance of h harmonics as equations of a curve, and what its points tell."""

    over: SystemOver
    periods: int
    h: int
    runs: dict[bytes, Trajectory | None] = field(default_factory=dict)

    @property
    def size(self) -> int:
        return len(self.over.scale) - 1

    @property
    def scale(self) -> Array:
        wide = 2 * self.h + 1
        return np.append(np.repeat(self.over.scale[:-1], wide), self.over.scale[-1])

    def packed(self, rows: Array, value: float) -> Array:
        return np.append(rows.ravel(), value)

    def rows(self, point: CurvePoint) -> Array:
        return point.z[:-1].reshape(self.size, 2 * self.h + 1)

    def start(self, point: CurvePoint) -> Array:
        rows = self.rows(point)
        return np.asarray(rows[:, : self.h + 1].sum(axis=1))

    def equations(self, z: Array) -> tuple[Array, Array]:
        """What the balance leaves over one radian, in units of the states' scales, and its derivative."""
        n, wide, value = self.size, 2 * self.h + 1, float(z[-1])
        nothing = np.full(n * wide, np.nan), np.full((n * wide, n * wide + 1), np.nan)
        here = self._left(z[:-1].reshape(n, wide), value, with_slope=True)
        if here is None:
            return nothing
        left, slope = here
        # The parameter enters in any way, the period included: central differences, good to some 1e-9.
        step = 1e-4 * float(self.over.scale[-1])
        beside = [self._left(z[:-1].reshape(n, wide), value + side * step, with_slope=False) for side in (-1, 1)]
        if beside[0] is None or beside[1] is None:
            return nothing
        by_parameter = (beside[1][0] - beside[0][0]) / (2 * step)
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
        slope = np.zeros((n, wide, n, wide))
        for i in range(n):
            slope[i, :, i, :] = fourier.rate_matrix(h, omega)
            for j in range(n):
                if np.any(jacobians[:, i, j]):
                    slope[i, :, j, :] -= fourier.product_matrix(jacobians[:, i, j], h)
        return left.ravel(), slope.reshape(n * wide, n * wide) / omega

    def closed(self, point: CurvePoint) -> Trajectory | None:
        """The true motion through the series' start over one period, with its tangents."""
        key = point.z.tobytes()
        if key not in self.runs:
            system = self.over.at(point.parameter)
            assert system.forcing_period is not None
            run = _motion(system, self.start(point), self.periods * system.forcing_period, tangents=True)
            self.runs[key] = run if run.end is End.REACHED else None
        return self.runs[key]

    def defect(self, point: CurvePoint) -> float:
        """How far the motion misses its start, in units of the states' scales."""
        run = self.closed(point)
        return np.nan if run is None else float(np.abs((run.final[0] - self.start(point)) / self.over.scale[:-1]).max())

    def multipliers(self, point: CurvePoint) -> Complex:
        """By falling modulus; NaN where the motion cannot be computed."""
        run = self.closed(point)
        if run is None:
            return np.full(self.size, np.nan, dtype=complex)
        values = np.linalg.eigvals(run.final[1:]).astype(complex)
        return np.asarray(values[np.argsort(-np.abs(values))])

    def radius_error(self, point: CurvePoint, radius: float) -> float:
        """A series closes to its tail, not to rounding."""
        return RADIUS_ERROR

    def changes(self, point: CurvePoint) -> int:
        """Changes of regime in a period."""
        run = self.closed(point)
        return -1 if run is None else len(run.event_time)

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


def _motion(system: System, start: Array, period: float, *, tangents: bool = False) -> Trajectory:
    block = np.vstack([start, np.eye(len(start))]) if tangents else start[None]
    return integrate(
        system.equations, 0.0, period, block, regime=system.regime_at(0.0, start), tolerance=1e-11,
        most_steps=MOST_STEPS,
    )  # fmt: skip
