"""The frequency response of a piecewise linear oscillator by continuation of its exact periodic motions.

The curve P(x, x′; ω) = (x, x′), followed by pseudo-arclength with the exact derivative by state and frequency;
special points as in ``analyses/branch``. It is what the other methods are measured against.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from trunnion.analyses.orbits.branch import STEP, PeriodicBranch, Progress, collect, follow_both_ways
from trunnion.analyses.orbits.closing import RADIUS_ERROR, refuse_speed
from trunnion.analyses.orbits.exact_branch import exact_branch
from trunnion.analyses.orbits.piecewise_orbit import piecewise_orbit
from trunnion.driveline.driveline import Driveline
from trunnion.equations.coefficients import Assembly
from trunnion.errors import InputError
from trunnion.numerics.continuation.arclength import CurvePoint
from trunnion.numerics.piecewise_linear.piecewise import Passage, TooManyEventsError, measure, period
from trunnion.results.outcome import Outcome
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


def check_range(low: float, high: float) -> None:
    """Refuse what is no rising range of positive frequencies.

    Raises
    ------
    InputError : so.
    """
    if not (np.isfinite(low) and np.isfinite(high) and 0 < low < high):
        raise InputError("must be a rising range of positive frequencies", key="low, high", value=[low, high])


def piecewise_branch(
    oscillator: PiecewiseOscillator | Driveline | Assembly,
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
    """Exact periodic motions over the frequency from ``low`` to ``high``, stable and unstable.

    Parameters
    ----------
    oscillator : or a driveline that ``exact_motion`` takes, over its speed, or over the common frequency of its
        excitations where those are in time.
    begin : frequency to begin at, ``low`` by default; the branch is followed both ways from it.
    start : x and x′ at phase zero near the first motion; so isolated branches are reached. Of a driveline as in
        ``exact_motion``.
    speed : of a driveline excited in time, where a viscous load depends on it.
    periods : forcing periods of the motion; 2 follows a motion of twice the period.
    longest_step : of the continuation, over the frequency range and over the size of the gap or of the motion.
    progress : called as progress(share done).

    Returns
    -------
    PeriodicBranch with the curve "x", of a driveline the torques of its springs; where nothing was found at
    ``begin`` it has no points and says so.

    Raises
    ------
    InputError : a range that does not rise, a frequency outside it, an undamped linear resonance; a driveline
        without exact motion, or excited both by its rotation and in time.
    """
    check_range(low, high)
    first = low if begin is None else float(begin)
    if not low <= first <= high:
        raise InputError("lies outside the range", key="begin", value=first, remedy=f"choose {low:g} to {high:g}")
    if isinstance(oscillator, Driveline | Assembly):
        return exact_branch(
            oscillator, low, high, begin=first, start=start, speed=speed, periods=periods, longest_step=longest_step,
            most_points=most_points, progress=progress,
        )  # fmt: skip
    refuse_speed(oscillator.name, speed)
    orbit = piecewise_orbit(oscillator.but(frequency=first), start, periods=periods)
    size = max([*map(abs, oscillator.breakpoints), 0.0]) or max(abs(orbit.highest), abs(orbit.lowest), 1e-12)
    problem = _Exact(oscillator, periods, size, (high - low) * longest_step / STEP)
    if not orbit.outcome.ok:
        return collect(problem, [], Outcome(False, "not found", f"no motion at ω = {first:g}: {orbit.outcome}"))
    whole, outcome = follow_both_ways(
        problem, np.append(orbit.start, first), low, high, most_points, 1e-11, progress=progress
    )
    return collect(problem, whole, outcome)


@dataclass(frozen=True)
class _Frequency:
    """Name and unit of the parameter and of what is observed; see ``branch.Names``."""

    label: str = "frequency"
    unit: str = "rad/s"
    curves: tuple[str, ...] = ("x",)
    curve_unit: str = "1"


@dataclass
class _Exact:
    """The closing of an orbit as equations of a curve z = (x, x′, ω)."""

    oscillator: PiecewiseOscillator
    periods: int
    width: float
    range: float
    size: int = 2
    over: _Frequency = _Frequency()
    runs: dict[bytes, Passage] = field(default_factory=dict)

    @property
    def scale(self) -> Array:
        return np.array([self.width, self.width * self.oscillator.frequency, self.range])

    def passage(self, z: Array) -> Passage:
        key = z.tobytes()
        if key not in self.runs:
            o = self.oscillator
            self.runs[key] = period(o.regimes, o.coefficients, float(z[2]), z[:2], self.periods)
        return self.runs[key]

    def equations(self, z: Array) -> tuple[Array, Array]:
        try:
            if not (z[2] > 0 and np.isfinite(z).all()):
                raise TooManyEventsError("no motion at such a frequency")
            run = self.passage(z)
        except TooManyEventsError:
            return np.full(2, np.nan), np.full((2, 3), np.nan)
        over = 1 / self.scale[:2]
        return (run.state - z[:2]) * over, (run.tangents - np.eye(2, 3)) * over[:, None]

    def start(self, point: CurvePoint) -> Array:
        return point.z[:2]

    def multipliers(self, point: CurvePoint) -> Complex:
        values = np.linalg.eigvals(self.passage(point.z).tangents[:, :2]).astype(complex)
        return np.asarray(values[np.argsort(-np.abs(values))])

    def radius_error(self, point: CurvePoint, radius: float) -> float:
        return RADIUS_ERROR

    def changes(self, point: CurvePoint) -> int:
        return len(self.passage(point.z).crossings)

    def observed(self, point: CurvePoint) -> tuple[Array, Array, Array, float]:
        o, omega = self.oscillator, point.parameter
        found = measure(o.regimes, o.coefficients, omega, point.z[:2], self.periods)
        low, high = found["low"], found["high"]
        swing, largest = np.array([high - low]), np.array([max(abs(low), abs(high))])
        # At the forcing frequency, of a subharmonic motion too.
        fundamental = float(np.hypot(found["real"], found["imaginary"]))
        return swing, largest, fundamental * np.array([1.0, omega]), self.periods * 2 * np.pi / omega
