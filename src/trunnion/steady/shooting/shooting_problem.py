"""P(x) = x as equations: of one orbit, solved by Newton's method, and of the curve that a branch of orbits is; and the
one rule which multipliers of the motion count, what they may be off by, and what follows.

Unknown are the state x (n,) and some of the map's values, the last of which a branch moves along. Where a motion may
be shifted in time (nothing prescribes its phase) one value more is unknown, and one equation chooses among the shifted
ones: row · (x − anchor) = 0.

The multipliers of a motion that is exact in pieces are known to rounding. An integrated motion is run at two
tolerances, whose difference bounds the error of Φ and so of every multiplier (``numerics.spectrum``). Of a motion that
nothing fixes in phase the multiplier 1 is set aside, and that of each slider which never slips (``RubbingMap``).
A motion is undecided where the spectral radius is 1 to within its error (``results.verdict``), and marginal where
besides nothing damps it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.errors import InputError
from trunnion.numerics.continuation.arclength import CurvePoint, once
from trunnion.numerics.continuation.newton import Root, solve
from trunnion.numerics.integration.integration import IntegrationEnd, Trajectory
from trunnion.numerics.spectrum import along, multipliers, real_positive, spectral_radius, without
from trunnion.results.parameter_names import Names
from trunnion.results.verdict import Verdict, verdicts
from trunnion.systems.maps import IntegratedMap, MapEvaluation, PeriodMap, RubbingMap, TimedMap
from trunnion.systems.system import System

M = TypeVar("M", bound=PeriodMap)
C = TypeVar("C", bound="ShootingProblem[Any]")
MANY_STATES = 8
"""From which on an integrated motion without its tangents takes a fraction of one with them."""
CHANCES = 2
"""Motions in which a slider is tried as one that sticks: the first may begin before the motion has settled."""
SETTLING = (0, 50, 500)
"""Applications of the map that pass before each attempt at shooting."""
EXACT_ERROR = 1e-9
"""What the spectral radius of a motion known to rounding may be off by."""
COARSER = 30.0
"""How much larger than its own the tolerance is against which a motion's error is measured."""
ROUGHER = 1e4
"""How much larger than its own the tolerance is with which the derivative of many states is integrated."""
CLEAR = 1e-6
"""Distance of a spectral radius from 1 at which no error of the integration matters."""
AT_REST = 1e-7
"""Movement over a period, in units of the states' scale and size, that counts as none: what shooting leaves is less."""
UNDAMPED = 1e-10
"""ln of what a volume of states changes by over a period, per state, below which nothing damps the motion."""
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(5)
PHASE_FIXED = 1e-6, 100.0
"""How far, absolutely and over the error of Φ, a shift of the phase may miss coming back before something holds it."""


class Phase(NamedTuple):
    """Which of all motions shifted in time is meant: row · (x − anchor) = 0, the row (n,) in units of the states."""

    row: Array
    anchor: Array

    @classmethod
    def fixed(cls, place: int, value: float, scale: Array) -> Phase:
        """One state held at a value."""
        unit = np.eye(len(scale))[place]
        return cls(unit / scale, unit * value)


@dataclass
class ShootingProblem(Generic[M]):
    """The closing of motions of a map as equations in z = (x, values).

    scale (n + unknown values,): size of each unknown that counts as one; tolerance: how well an orbit must close, in
    these units; within: between which an unknown value of one orbit is looked for; over: what a branch lies over; last:
    the last trial motion; alone: of what map and from where it began, if it was without tangents.
    """

    map: M
    scale: Array
    phase: Phase | None = None
    tolerance: float = 1e-11
    within: tuple[float, float] = (-np.inf, np.inf)
    over: Names = field(default_factory=Names)
    last: MapEvaluation | None = None
    alone: tuple[M, Array] | None = None

    @property
    def size(self) -> int:
        """Number of states."""
        return self.map.size

    def place(self, z: Array) -> M:
        """The map at z."""
        return self.map.at(*map(float, z[self.size :])) if len(z) > self.size else self.map

    def missing(self, z: Array) -> Array:
        """What is missing to close, in units of the scales; NaN where there is no motion."""
        n = self.size
        passage = self._tried(z, tangents=False)
        if passage is None or not passage.done:
            return np.full(n + (self.phase is not None), np.nan)
        left = (passage.state - z[:n]) / self.scale[:n]
        return left if self.phase is None else np.append(left, self.phase.row @ (z[:n] - self.phase.anchor))

    def equations(self, z: Array) -> tuple[Array, Array]:
        """What is missing to close, and its derivative by z, in units of the scales; NaN where there is no motion."""
        return self._closing(z, self._tried(z))

    def for_newton(self, z: Array) -> tuple[Array, Array]:
        """As ``equations``, its derivative to as many digits as Newton's steps need."""
        return self.equations(z)

    def _closing(self, z: Array, passage: MapEvaluation | None) -> tuple[Array, Array]:
        """The equations at z, of its motion."""
        n = self.size
        if passage is None or not passage.done:
            rows = n + (self.phase is not None)
            return np.full(rows, np.nan), np.full((rows, len(z)), np.nan)
        size = self.scale[:n]
        left = (passage.state - z[:n]) / size
        slope = np.empty((n, len(z)))
        slope[:, :n], slope[:, n:] = passage.tangents, passage.by_values
        slope.reshape(-1)[:: len(z) + 1] -= 1  # its diagonal
        slope /= size[:, None]
        if self.phase is not None:
            left = np.append(left, self.phase.row @ (z[:n] - self.phase.anchor))
            slope = np.vstack([slope, np.append(self.phase.row, np.zeros(len(z) - n))])
        return left, slope

    def _tried(self, z: Array, *, tangents: bool = True) -> MapEvaluation | None:
        """The motion at z, kept as the last one tried; None where z is nowhere."""
        if not np.isfinite(z).all():
            return None
        n = self.size
        if not tangents and self.alone and self.alone[0] is self.map and np.array_equal(self.alone[1], z):
            return self.last
        try:
            by = range(len(z) - n) if tangents else ()
            self.alone = None
            self.last = self.place(z)(z[:n], tangents=tangents, by=by)
        except InputError:  # a trial value may be no value of this parameter
            if len(z) == n and self.last is None:
                raise
            return None
        self.alone = None if tangents else (self.map, z.copy())
        return self.last

    def solve(self, guess: Array) -> Root:
        """The orbit near ``guess`` (n + unknown values,)."""
        n, low, high = self.size, *self.within

        def within(z: Array) -> Array:
            return z if len(z) == n or low < z[n] < high else np.full_like(z, np.nan)

        def residual(z: Array) -> tuple[Array, Array]:
            left, slope = self.for_newton(within(z))
            return left * self.scale, slope * self.scale[:, None]

        def alone(z: Array) -> Array:
            return self.missing(within(z)) * self.scale

        cheap = alone if self.cheaper_alone else None
        return solve(residual, guess, self.scale, tolerance=self.tolerance, alone=cheap)

    @property
    def cheaper_alone(self) -> bool:
        """Whether a motion without its tangents takes so much less that it is worth trying alone."""
        return False

    @once
    def passage(self, point: CurvePoint) -> MapEvaluation:
        """The closed motion at a point of the curve."""
        return self.place(point.z)(point.z[: self.size], watch=True)

    def start(self, point: CurvePoint) -> Array:
        """State at t = 0."""
        return point.z[: self.size]

    def changes(self, point: CurvePoint) -> int:
        """Changes of regime in a period; −1 where the motion cannot be computed."""
        passage = self.passage(point)
        return passage.changes if passage.done else -1

    def multipliers(self, point: CurvePoint) -> Complex:
        """Floquet multipliers by falling modulus; NaN where the motion cannot be computed."""
        passage = self.passage(point)
        return by_modulus(passage.tangents) if passage.done else np.full(self.size, np.nan, dtype=complex)

    def observed(self, point: CurvePoint) -> tuple[Array, Array, Array, float]:
        """See ``motion.orbits.branch.BranchProblem``."""
        place = self.place(point.z)
        return (*place.observe(self.start(point), self.passage(point)), place.length)

    def radius_error(self, point: CurvePoint, radius: float) -> float:
        """What the spectral radius may be off by: rounding, and what is left of closing."""
        return EXACT_ERROR

    def undamped(self, point: CurvePoint) -> bool:
        """Whether volumes of states keep their size along the motion."""
        return _undamped(self.multipliers(point))


@dataclass(frozen=True)
class NeutralDisturbances:
    """Disturbances of a free–free line: those that come back exactly (n, k), phase first; and where no torque
    depends on the speed but dampers do, the change of speed (n,), whose multiplier is stated by itself, and from Φ
    (n, n) whether that ``grows``, None where it cannot be told."""

    returns: Array
    drifts: Array | None = None
    grows: Callable[[Array], bool | None] = lambda tangents: None


class ClassifiedMultipliers(NamedTuple):
    """All multipliers (n,) by falling modulus and their bounds, those that count, and the one of the line's speed where
    that is stated by itself."""

    values: Complex
    bound: Array
    counted: Complex
    counted_bound: Array
    speed: float


@dataclass
class IntegratedShooting(ShootingProblem[IntegratedMap]):
    """The closing of an integrated motion; ``neutral`` of a free–free line, from its system and the start."""

    neutral: Callable[[System, Array], NeutralDisturbances] | None = None

    @property
    def cheaper_alone(self) -> bool:
        return self.size >= MANY_STATES

    def for_newton(self, z: Array) -> tuple[Array, Array]:
        """Of many states the derivative is that of a motion run with a larger tolerance: its fast disturbances ask for
        steps several times shorter than the motion itself does."""
        if not self.cheaper_alone:
            return super().for_newton(z)
        motion = self._tried(z, tangents=False)
        if motion is None or not motion.done:
            return self._closing(z, None)
        rough = self.place(z)(z[: self.size], by=range(len(z) - self.size), looser=ROUGHER)
        if not rough.done:
            return self._closing(z, None)
        return self._closing(z, replace(motion, tangents=rough.tangents, by_values=rough.by_values))

    def judged(
        self, place: IntegratedMap, x: Array, run: Trajectory, coarse: Trajectory, missed: float
    ) -> ClassifiedMultipliers:
        """Of the motion from x, run again as ``coarse`` with a larger tolerance, which misses closing by ``missed``;
        without those of sliders that are kept from slipping."""
        system, scale = place.system, np.asarray(place.system.scale)
        scaled, error = scaled_matrix(system, run, coarse, missed)
        basis = np.eye(len(scaled))
        if place.fixed:
            scaled, basis = beside_sticking(place, x, scaled, scale)
        values, bound = multipliers(scaled, np.array(error))
        order = np.argsort(-np.abs(values))
        values, bound = values[order], bound[order]
        counted, counted_bound, speed = values, bound, np.nan
        if self.neutral is not None:
            counted, counted_bound, speed = beside_neutral(
                scaled, error, self.neutral(system, x), basis.T / scale, run.final[1:].T
            )
        if isinstance(place, TimedMap) and not rests(place, run):
            one = int(np.argmin(np.abs(counted - 1)))
            counted, counted_bound = np.delete(counted, one), np.delete(counted_bound, one)
        return ClassifiedMultipliers(values, bound, counted, counted_bound, speed)

    def multipliers(self, point: CurvePoint) -> Complex:
        """Those that count, by falling modulus; NaN where the motion cannot be computed."""
        passage = self.passage(point)
        if not passage.done:
            return super().multipliers(point)
        run = passage.run
        if self.neutral is None:
            return by_modulus(run.final[1:])
        values = self.judged(self.place(point.z), self.start(point), run, run, 0.0).counted
        return np.asarray(values[np.argsort(-np.abs(values))])

    def radius_error(self, point: CurvePoint, radius: float) -> float:
        """Near 1 estimated as that of a single orbit is; farther away it does not matter."""
        passage, place, x = self.passage(point), self.place(point.z), self.start(point)
        if abs(radius - 1) > CLEAR or not passage.done:
            return CLEAR
        coarse = place(x, looser=COARSER)
        if not coarse.done:
            return CLEAR
        missed = float(np.abs((passage.state - x) / np.asarray(place.system.scale)).max())
        found = self.judged(place, x, passage.run, coarse.run, missed)
        return float(spectral_radius(found.counted, found.counted_bound)[1])

    def undamped(self, point: CurvePoint) -> bool:
        """Whether volumes of states keep their size along the motion."""
        place = self.place(point.z)
        run = place(self.start(point), tangents=False, dense=True).run
        return run.end is IntegrationEnd.REACHED and keeps_volume(divergence_of(place.system, run), self.size)


def close(
    start: Array, make: Callable[[Array], C], values: tuple[float, ...] = (), *, settle: bool = True
) -> tuple[C, Root]:
    """The closing and its root near ``start``, or from where the motion has settled: after each of ``SETTLING``.

    make : guess → its closing; values : guesses of the unknown values.
    """
    problem = make(start)
    root = problem.solve(np.append(start, values))
    for periods in SETTLING[1:] if settle else ():
        if root.converged:
            break
        settled = problem.map.settle(start, periods)
        if settled is None:
            break
        problem = make(settled)
        root = problem.solve(np.append(settled, values))
    return problem, root


def holding(problem: C, which: tuple[int, ...]) -> C:
    """The closing of motions in which the sliders ``which`` are kept from slipping."""
    return replace(problem, map=problem.map.holding(which)) if which else problem


def sticking(free: C, root: Root, fixed: tuple[int, ...] = ()) -> tuple[C, Root, tuple[int, ...]] | None:
    """The sliders that never slip in the motion at ``root`` of a closing, which was found with those ``fixed`` kept
    from slipping; and closing and root with rounding kept from letting them. None where no motion agrees with which
    stick.

    A motion that settles by slipping less and less just reaches in the end where its sliders slip. One that slips for a
    moment is held and the motion closed again; where it stays within what the slider holds, the slider sticks.
    """
    n, problem, slipped = free.size, holding(free, fixed), Counter[int]()
    for _ in range(2 * CHANCES * free.map.sliders + 1):
        idle = problem.place(root.x).idle(root.x[:n]) if free.map.sliders else ()
        slipped.update(set(fixed).difference(idle))
        stick = tuple(one for one in idle if slipped[one] < CHANCES)
        if stick == fixed:
            return problem, root, fixed
        # First those slip that cannot stick after all; then those stick that turn out not to slip.
        fixed = stick if set(fixed).issubset(idle) else tuple(one for one in fixed if one in stick)
        problem = holding(free, fixed)
        within = problem.place(root.x).within_limits(root.x[:n])
        again = problem.solve(np.append(within, root.x[n:]))
        if not again.converged:
            return None
        root = replace(again, iterations=root.iterations + again.iterations)
    return None


def beside_sticking(place: RubbingMap, x: Array, scaled: Array, scale: Array) -> tuple[Array, Array]:
    """A monodromy matrix in units of ``scale`` (n,) without what sliders that are kept from slipping leave as it was,
    and the basis in which it stands."""
    kept, basis = without(scaled.T, (place.conserved(x, place.fixed) * scale).T)
    return kept.T, basis


def by_modulus(matrix: Array) -> Complex:
    """Eigenvalues by falling modulus; NaN where the matrix is."""
    if not np.isfinite(matrix).all():
        return np.full(len(matrix), np.nan, dtype=complex)
    values = np.linalg.eigvals(matrix).astype(complex)
    return np.asarray(values[np.argsort(-np.abs(values), kind="stable")])


def refuse_speed(oscillator: str, speed: float | str | None) -> None:
    """Refuse a speed given beside an oscillator, which has none.

    Raises
    ------
    InputError : a speed is given.
    """
    if speed is not None:
        raise InputError("belongs to a driveline", element=oscillator, key="speed", value=speed, remedy="leave it out")


def exact_verdict(values: Complex) -> Verdict:
    """The verdict on multipliers of a motion that is exact in pieces."""
    radius = float(np.abs(values).max())
    undamped = abs(radius - 1) <= EXACT_ERROR and _undamped(values)
    return Verdict(int(verdicts(radius, EXACT_ERROR, undamped)))


def _undamped(values: Complex) -> bool:
    with np.errstate(divide="ignore"):
        return keeps_volume(float(np.log(np.abs(values)).sum()), len(values))


def keeps_volume(change: float, size: int) -> bool:
    """Whether a volume of ``size`` states that changes by e^change over a period keeps its size."""
    return abs(change) < UNDAMPED * size


def divergence_of(system: System, run: Trajectory) -> float:
    """∫ tr ∂f/∂x dt over a run, from what is known of it or by Gauss's rule on every step."""
    known = system.divergence
    if known is not None:
        return float(known(system.parameters) if callable(known) else known) * (run.time - float(run.start[0]))
    times = (run.start[:, None] + run.length[:, None] * (_NODES + 1) / 2).ravel()
    traces = system.divergence_at(times, run.at(times), np.repeat(run.regime, len(_NODES)))
    return float(run.length / 2 @ (traces.reshape(-1, len(_NODES)) @ _WEIGHTS))


def rests(place: IntegratedMap, run: Trajectory) -> bool:
    """Whether an autonomous motion stands still: it then has no phase, and so no multiplier 1 of its own. A line that
    turns has one, from its rotation."""
    size = np.asarray(place.system.scale) + np.abs(run.state).max(axis=0)
    return isinstance(place, TimedMap) and bool(np.all(np.ptp(run.state, axis=0) <= AT_REST * size))


def beside_neutral(
    scaled: Array, error: float, neutral: NeutralDisturbances, units: Array, tangents: Array
) -> tuple[Complex, Array, float]:
    """The multipliers to judge, their bounds, and the one of the line's speed where that is not judged with them.

    ``units`` (m, n) : takes a disturbance of the states to the coordinates in which ``scaled`` (m, m) stands;
    ``tangents`` : Φ (n, n).
    """
    aside = units @ neutral.returns
    missed = float(np.linalg.norm(scaled @ aside[:, :1] - aside[:, :1]) / np.linalg.norm(aside[:, :1]))
    if missed > PHASE_FIXED[0] + PHASE_FIXED[1] * error:  # something holds the phase after all
        aside = aside[:, :0]
    rest, basis = without(scaled, aside)
    values, bound = multipliers(rest, np.array(error))
    if neutral.drifts is None or not aside.shape[1]:
        return values, bound, np.nan
    several = int(real_positive(values).sum()) > 1
    place = along(rest, (units @ neutral.drifts) @ basis, neutral.grows(tangents) if several else None)
    return np.delete(values, place), np.delete(bound, place), float(values[place].real)


def scaled_matrix(system: System, run: Trajectory, coarse: Trajectory, residual: float) -> tuple[Array, float]:
    """Φ (n, n) in units of the states' scales, and what it may be off by in the 2-norm.

    run, coarse : the motion with its tangents, and again at ``COARSER`` times the tolerance; residual : how far it
    misses closing, in units of the states' scale.
    """
    scale = np.asarray(system.scale)
    scaled, rough = (r.final[1:].T * scale[None, :] / scale[:, None] for r in (run, coarse))
    # What a coarser tolerance changes bounds what is left; the orbit's own error moves Φ as well.
    error = float(np.linalg.norm(scaled - rough, 2)) / 3 + residual * float(np.linalg.norm(scaled, 2))
    if not system.exact_tangents:
        error += 1e-10 * float(np.linalg.norm(scaled, 2))
    return scaled, error
