"""Which multipliers of a periodic motion count, what they may be off by, and what follows: the one rule for orbits and
branches.

An integrated motion is run at two tolerances, whose difference bounds the error of Φ and so of every multiplier
(``numerics.spectrum``). Of a motion that nothing holds in phase the multiplier 1 is set aside, and that of each slider
which never slips (``systems.sticking``). A motion is undecided where the spectral radius is 1 to within its error
(``results.verdict``), and marginal where besides nothing damps it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from trunnion.arrays import Array, Complex, Integers
from trunnion.numerics.continuation.arclength import CurvePoint
from trunnion.numerics.integration.integration import End, Trajectory
from trunnion.numerics.spectrum import along, multipliers, spectral_radius, without
from trunnion.results.verdict import Verdict, verdicts
from trunnion.steady.shooting.closing import Closing, by_modulus
from trunnion.systems.maps import IntegratedMap, TimedMap
from trunnion.systems.sticking import conserved
from trunnion.systems.system import System

EXACT_ERROR = 1e-9
"""What the spectral radius of a motion known to rounding may be off by."""
COARSER = 30.0
"""How much larger than its own the tolerance is against which a motion's error is measured."""
CLEAR = 1e-6
"""Distance of a spectral radius from 1 at which no error of the integration matters."""
AT_REST = 1e-7
"""Movement over a period, in units of the states' scale and size, that counts as none: what shooting leaves is less."""
UNDAMPED = 1e-10
"""ln of what a volume of states changes by over a period, per state, below which nothing damps the motion."""
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(5)
HELD = 1e-6, 100.0
"""How far, absolutely and over the error of Φ, a shift of the phase may miss coming back before something holds it."""


@dataclass(frozen=True)
class Neutral:
    """Disturbances of a line that starts free: those that come back exactly (n, k), phase first; and where no torque
    depends on the speed but dampers do, the change of speed (n,), whose multiplier is near 1 and stated by itself."""

    returns: Array
    drifts: Array | None = None


class Judged(NamedTuple):
    """All multipliers (n,) by falling modulus and their bounds, those that count, and the one of the line's speed where
    that is stated by itself."""

    values: Complex
    bound: Array
    counted: Complex
    counted_bound: Array
    speed: float


@dataclass
class IntegratedClosing(Closing[IntegratedMap]):
    """The closing of an integrated motion; ``neutral`` of a line that starts free, from its system and the start."""

    neutral: Callable[[System, Array], Neutral] | None = None

    def judged(
        self, place: IntegratedMap, x: Array, run: Trajectory, coarse: Trajectory, missed: float, stuck: Integers
    ) -> Judged:
        """Of the motion from x, run again as ``coarse`` with a larger tolerance, which misses closing by ``missed``;
        ``stuck``: sliders that never slip."""
        system, scale = place.system, np.asarray(place.system.scale)
        scaled, error = scaled_matrix(system, run, coarse, missed)
        basis = np.eye(len(scaled))
        if len(stuck):
            kept, basis = without(scaled.T, (conserved(system, place.phase, x, stuck) * scale).T)
            scaled = kept.T
        values, bound = multipliers(scaled, np.array(error))
        order = np.argsort(-np.abs(values))
        values, bound = values[order], bound[order]
        counted, counted_bound, speed = values, bound, np.nan
        if self.neutral is not None:
            counted, counted_bound, speed = beside_neutral(scaled, error, self.neutral(system, x), basis.T / scale)
        if isinstance(place, TimedMap) and not rests(place, run):
            one = int(np.argmin(np.abs(counted - 1)))
            counted, counted_bound = np.delete(counted, one), np.delete(counted_bound, one)
        return Judged(values, bound, counted, counted_bound, speed)

    def multipliers(self, point: CurvePoint) -> Complex:
        """Those that count, by falling modulus; NaN where the motion cannot be computed."""
        passage = self.passage(point)
        if not passage.done:
            return super().multipliers(point)
        place, run = self.place(point.z), passage.run
        stuck = never_slip(place.system, run)
        if self.neutral is None and not len(stuck):
            return by_modulus(run.final[1:])
        values = self.judged(place, self.start(point), run, run, 0.0, stuck).counted
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
        found = self.judged(place, x, passage.run, coarse.run, missed, never_slip(place.system, passage.run))
        return float(spectral_radius(found.counted, found.counted_bound)[1])

    def undamped(self, point: CurvePoint) -> bool:
        """Whether volumes of states keep their size along the motion."""
        place = self.place(point.z)
        run = place(self.start(point), tangents=False, dense=True).run
        return run.end is End.REACHED and keeps_volume(divergence_of(place.system, run), self.size)


@dataclass
class ExactClosing(Closing):  # type: ignore[type-arg]
    """The closing of a motion that is exact in pieces."""

    def radius_error(self, point: CurvePoint, radius: float) -> float:
        """Rounding, and what is left of closing."""
        return EXACT_ERROR

    def undamped(self, point: CurvePoint) -> bool:
        """Whether volumes of states keep their size along the motion."""
        return _undamped(self.multipliers(point))


def never_slip(system: System, run: Trajectory, most: float = 0.0) -> Integers:
    """Numbers of the sliders that slip for no more than the share ``most`` of a motion."""
    if system.regimes is None:
        return np.zeros(0, dtype=np.int64)
    return system.regimes.stuck(run.regime, run.length, most)


def exact_verdict(values: Complex) -> Verdict:
    """The verdict on multipliers of a motion that is exact in pieces."""
    return Verdict(int(verdicts(np.abs(values).max(), EXACT_ERROR, _undamped(values))))


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


def beside_neutral(scaled: Array, error: float, neutral: Neutral, units: Array) -> tuple[Complex, Array, float]:
    """The multipliers to judge, their bounds, and the one of the line's speed where that is not judged with them.

    ``units`` (m, n) : takes a disturbance of the states to the coordinates in which ``scaled`` (m, m) stands.
    """
    aside = units @ neutral.returns
    missed = float(np.linalg.norm(scaled @ aside[:, :1] - aside[:, :1]) / np.linalg.norm(aside[:, :1]))
    if missed > HELD[0] + HELD[1] * error:  # something holds the phase after all
        aside = aside[:, :0]
    rest, basis = without(scaled, aside)
    values, bound = multipliers(rest, np.array(error))
    if neutral.drifts is None or not aside.shape[1]:
        return values, bound, np.nan
    place = along(rest, (units @ neutral.drifts) @ basis)
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
