"""A branch of periodic motions followed over a parameter by shooting, through folds, stable or not.

The branch is the curve P(x; λ) = x in the space of z = (x, λ), followed by pseudo-arclength
(``numerics.arclength``) with the exact ∂P/∂x. Lengths are measured in the scale of the states and in the range of
the parameter.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from trunnion.analyses.orbits.branch import STEP, PeriodicBranch, Progress, collect, follow_both_ways
from trunnion.analyses.orbits.periodic_orbit import COARSER, multipliers_of, periodic_orbit
from trunnion.analyses.orbits.systems_over import SystemOver, system_over
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.parameters import Parameter
from trunnion.equations.coefficients import Assembly
from trunnion.errors import InputError
from trunnion.numerics.continuation.arclength import CurvePoint
from trunnion.numerics.curves import extremes, fourier
from trunnion.numerics.integration.integration import End, Trajectory, integrate
from trunnion.numerics.spectrum import spectral_radius
from trunnion.results.outcome import Outcome
from trunnion.systems.system import System

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
TOLERANCE = 1e-11
MOST_POINTS = 2000
CLEAR = 1e-6
"""Distance of a spectral radius from 1 at which no error of the integration matters."""
MOST_INTEGRATION_STEPS = 200_000


def periodic_branch(
    line: Driveline | Assembly | System,
    parameter: str | Parameter,
    low: float,
    high: float,
    *,
    begin: float | None = None,
    start: ArrayLike | None = None,
    speed: float | None = None,
    periods: int = 1,
    tolerance: float = TOLERANCE,
    longest_step: float = 0.01,
    most_points: int = MOST_POINTS,
    progress: Progress | None = None,
) -> PeriodicBranch:
    """Follow the periodic motion of a line or a forced system while a parameter moves from ``low`` to ``high``.

    Parameters
    ----------
    parameter : of a line its path ("speed", "HookeJoint 1.angle", a ``Parameter``); of a system its name.
    low, high : ends of the range, in SI units.
    begin : where the first motion is sought, by default at ``low``; from inside the range the branch is followed
        both ways.
    start : a state near that motion.
    speed : input speed [rad/s] of a line, where it is not the parameter.
    periods : forcing periods in one period of the motion.
    longest_step : largest step of the parameter, as a share of its range; two special points closer together than
        a step may be missed.
    progress : called as progress(share done).

    Returns
    -------
    A branch whose ``outcome`` says where it ended; if no motion was found at ``begin`` it has no points.

    Raises
    ------
    InputError : an unknown parameter, a reversed range, an autonomous system, a free line.
    """
    # The parameter's scale makes its largest step the one asked for, whatever a state's may be.
    over = system_over(line, parameter, low, high, begin, speed, longest_step / STEP)
    problem, first = _Shooting(over, periods, tolerance), over.begin
    orbit = periodic_orbit(over.at(first), start=start, periods=periods, tolerance=tolerance)
    if not orbit.outcome.ok:
        return collect(problem, [], Outcome(False, orbit.outcome.kind, f"at {first:g}: {orbit.outcome.sentence}"))
    whole, outcome = follow_both_ways(problem, np.append(orbit.start, first), low, high, most_points, progress=progress)
    return collect(problem, whole, outcome)


@dataclass
class _Shooting:
    """P(x; λ) = x as equations of a curve; see ``branch.Problem``."""

    over: SystemOver
    periods: int
    tolerance: float
    shots: dict[bytes, Trajectory | None] = field(default_factory=dict)

    @property
    def scale(self) -> Array:
        return self.over.scale

    @property
    def size(self) -> int:
        return len(self.over.scale) - 1

    def start(self, point: CurvePoint) -> Array:
        return point.z[:-1]

    def shoot(self, z: Array, tangents: bool = True, looser: float = 1.0) -> Trajectory | None:
        """One period from x at λ, with Φ in its tangents; None where there is no such motion."""
        n = len(z) - 1
        try:
            system = self.over.at(float(z[-1]))
        except InputError:  # a trial value may be no value of this parameter
            return None
        if not np.all(np.isfinite(z)) or system.forcing_period is None:
            return None
        block = np.vstack([z[:n], np.eye(n)]) if tangents else z[None, :n]
        run = integrate(
            system.equations, 0.0, self.periods * system.forcing_period, block,
            regime=system.regime_at(0.0, z[:n]), tolerance=looser * self.tolerance, dense=False,
            most_steps=MOST_INTEGRATION_STEPS,
        )  # fmt: skip
        return run if run.end is End.REACHED else None

    def equations(self, z: Array) -> tuple[Array, Array]:
        """P(x; λ) − x and its derivative by (x, λ), in units of the states' scales; NaN where there is none."""
        n, h = len(z) - 1, 1e-4 * self.scale[-1]
        nothing = np.full(n, np.nan), np.full((n, n + 1), np.nan)
        run = self.shoot(z)
        if run is None:
            return nothing
        ends = []
        for side in (-1.0, 1.0):
            moved = z.copy()
            moved[-1] += side * h
            beside = self.shoot(moved, tangents=False)
            if beside is None:
                return nothing
            ends.append(beside.final[0])
        slope = np.hstack([run.final[1:].T - np.eye(n), ((ends[1] - ends[0]) / (2 * h))[:, None]])
        return (run.final[0] - z[:n]) / self.scale[:n], slope / self.scale[:n, None]

    def closed(self, point: CurvePoint) -> Trajectory | None:
        """The motion at a point of the curve, computed once."""
        key = point.z.tobytes()
        if key not in self.shots:
            self.shots[key] = self.shoot(point.z)
        return self.shots[key]

    def multipliers(self, point: CurvePoint) -> Complex:
        """By falling modulus; NaN where the motion cannot be computed."""
        run = self.closed(point)
        if run is None:
            return np.full(len(point.z) - 1, np.nan, dtype=complex)
        values = np.linalg.eigvals(run.final[1:]).astype(complex)
        return np.asarray(values[np.argsort(-np.abs(values))])

    def radius_error(self, point: CurvePoint, radius: float) -> float:
        """Near 1 estimated as that of a single orbit is; farther away it does not matter."""
        run = self.closed(point)
        if abs(radius - 1) > CLEAR or run is None:
            return CLEAR
        coarse, system = self.shoot(point.z, looser=COARSER), self.over.at(point.parameter)
        if coarse is None:
            return CLEAR
        missed = float(np.abs((run.final[0] - point.z[:-1]) / np.asarray(system.scale)).max())
        return float(spectral_radius(*multipliers_of(system, run, coarse, missed))[1])

    def changes(self, point: CurvePoint) -> int:
        """Changes of regime in a period."""
        run = self.closed(point)
        return -1 if run is None else len(run.event_time)

    def observed(self, point: CurvePoint) -> tuple[Array, Array, Array, float]:
        """See ``branch.Problem``; NaN where the motion cannot be computed."""
        system = self.over.at(point.parameter)
        assert system.forcing_period is not None
        period = self.periods * system.forcing_period
        run = self._seen(system, point.z[:-1], period)
        if run is None:
            curves = np.full(len(self.over.curves), np.nan)
            return curves, curves, np.full(self.size, np.nan), period
        amplitude = np.abs(fourier(run.at, run.time_of_state, self.periods)[self.periods])
        seen = extremes(lambda times: self.over.observe(system, times, run.at(times)), run.time_of_state)
        return seen.span, seen.largest, amplitude, period

    def _seen(self, system: System, start: Array, period: float) -> Trajectory | None:
        """One period with dense output. A motion that touches a switching surface may chatter there at one tolerance
        and pass at another; both look the same."""
        for looser in (1, 10, 100):
            run = integrate(
                system.equations, 0.0, period, start, regime=system.regime_at(0.0, start),
                tolerance=looser * self.tolerance, most_steps=MOST_INTEGRATION_STEPS,
            )  # fmt: skip
            if run.end is End.REACHED:
                return run
        return None
