"""Branches of exact periodic motions of a driveline with stages, over its speed or the frequency of its excitation.

The curve P(q, q′; value) = (q, q′), followed by pseudo-arclength with the exact derivative by state and value; special
points as in ``analyses/branch``.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from trunnion.analyses.motion.exact_motion import start_state
from trunnion.analyses.orbits.branch import STEP, PeriodicBranch, Progress, collect, follow_both_ways
from trunnion.analyses.orbits.closing import RADIUS_ERROR
from trunnion.analyses.orbits.exact_orbit import ExactOrbit, Shooting, by_modulus, orbit_near, refuse_found_speed
from trunnion.driveline.driveline import Driveline
from trunnion.equations.coefficients import Assembly
from trunnion.equations.staged_line import StagedLine, staged_line
from trunnion.errors import InputError
from trunnion.numerics.continuation.arclength import CurvePoint
from trunnion.numerics.piecewise_linear.staged_flow import StagedPassage, kernel, move
from trunnion.results.outcome import Outcome

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
SAMPLES = 512
"""Of a period, for the fundamental; a power of two times any usual number of periods."""


def line_over(line: Driveline | Assembly, value: float, speed: float | None) -> StagedLine:
    """The line, ready for other values of what turns its excitation, of which ``value`` is one.

    Raises
    ------
    InputError : excitation by speed and in time together, or none.
    """
    prepared = staged_line(line, value)
    if prepared.clock == "frequency":
        prepared = staged_line(line, speed)
    if prepared.clock == "both":
        raise InputError(
            "is excited by its rotation and in time, so its motions over speed have no common period",
            element="driveline", key="excitation", remedy="give orders in place of frequencies, or frequencies only",
        )  # fmt: skip
    refuse_found_speed(prepared)
    _ = prepared.base  # refuses what has none
    return prepared


def exact_branch(
    line: Driveline | Assembly,
    low: float,
    high: float,
    *,
    begin: float | None = None,
    start: ArrayLike | None = None,
    speed: float | None = None,
    periods: int = 1,
    longest_step: float = 0.01,
    most_points: int = 4000,
    progress: Progress | None = None,
) -> PeriodicBranch:
    """See ``piecewise_branch``, which has checked the range."""
    first = low if begin is None else float(begin)
    prepared = line_over(line, first, speed)
    orbit = orbit_near(prepared, start_state(prepared, start), first, periods)
    shooting = Shooting(prepared, periods)
    problem = _Exact(shooting, _over(prepared), _scale(shooting, orbit, (high - low) * longest_step / STEP))
    if not orbit.outcome.ok:
        return collect(problem, [], Outcome(False, "not found", f"no motion at {first:g} rad/s: {orbit.outcome}"))
    begins = np.append(orbit.start[shooting.kept], first)
    whole, outcome = follow_both_ways(problem, begins, low, high, most_points, 1e-10, progress=progress)
    return collect(problem, whole, outcome)


@dataclass(frozen=True)
class _Over:
    """Name and unit of the parameter and of what is observed; see ``branch.Names``."""

    label: str
    unit: str
    curves: tuple[str, ...]
    curve_unit: str = "N*m"


def _over(line: StagedLine) -> _Over:
    return _Over("speed" if line.clock == "speed" else "frequency", "rad/s", line.springs)


def _scale(shooting: Shooting, orbit: ExactOrbit, width: float) -> Array:
    """Twists count by the larger of the motion and the gap, rates by that per phase."""
    line, size = shooting.line, np.abs(orbit.start)
    if orbit.outcome.ok:
        size[: len(line.springs)] = np.maximum(np.abs(orbit.twist_low), np.abs(orbit.twist_high))
    return np.append(shooting.scale(size, orbit.value), width)


@dataclass
class _Exact:
    """The closing of an orbit as equations of a curve; see ``branch.Problem``."""

    shooting: Shooting
    over: _Over
    scale: Array
    runs: dict[bytes, StagedPassage] = field(default_factory=dict)

    @property
    def size(self) -> int:
        return len(self.scale) - 1

    def equations(self, z: Array) -> tuple[Array, Array]:
        n = self.size
        if not (z[-1] > 0 and np.isfinite(z).all()):
            return np.full(n, np.nan), np.full((n, n + 1), np.nan)
        residual, slope = self.shooting.residual(z[:-1], float(z[-1]))
        over = 1 / self.scale[:-1]
        return residual * over, slope * over[:, None]

    def passage(self, point: CurvePoint) -> StagedPassage:
        key = point.z.tobytes()
        if key not in self.runs:
            self.runs[key] = self.shooting.passage(point.z[:-1], point.parameter, watch=True)
        return self.runs[key]

    def start(self, point: CurvePoint) -> Array:
        return point.z[:-1]

    def multipliers(self, point: CurvePoint) -> Complex:
        kept = self.shooting.kept
        return by_modulus(self.passage(point).tangents[np.ix_(kept, kept)])

    def radius_error(self, point: CurvePoint, radius: float) -> float:
        return RADIUS_ERROR

    def changes(self, point: CurvePoint) -> int:
        return len(self.passage(point).events)

    def observed(self, point: CurvePoint) -> tuple[Array, Array, Array, float]:
        shooting, k, run = self.shooting, kernel(), self.passage(point)
        line, length = shooting.line, shooting.periods * shooting.line.period(point.parameter)
        seen = run.seen[: len(line.springs)]
        low, high = seen[:, k.TORQUE_LOW], seen[:, k.TORQUE_HIGH]
        count = SAMPLES * shooting.periods
        flow, start = line.flow(point.parameter), shooting.whole(point.z[:-1])
        states = move(flow, start, 0.0, length, times=length * np.arange(count) / count).states
        # At the frequency of the excitation, of a subharmonic motion too.
        amplitude = 2 * np.abs(np.fft.rfft(states, axis=0)[shooting.periods]) / count
        return high - low, np.maximum(np.abs(low), np.abs(high)), amplitude[shooting.kept], length
