"""A periodic motion of a system by shooting, and its stability from its own variational equations.

    forced:      P(x) = x over one forcing period (or several: a subharmonic),
    autonomous:  φ_T(x) = x for x and T, with f(x₀)·(x − x₀) = 0 to choose one point of the orbit,

by Newton's method with the exact derivative Φ of the flow (with saltation at switching surfaces). The
multipliers are the eigenvalues of Φ, those of the true motion whatever its amplitude. Their error is bounded
from the difference of Φ at two tolerances, and checked by Liouville's identity ln det Φ = ∫ tr ∂f/∂x dt.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Complex
from trunnion.errors import InputError
from trunnion.numerics.continuation.newton import Root
from trunnion.numerics.curves import extremes, fourier
from trunnion.numerics.integration.integration import IntegrationEnd, Trajectory
from trunnion.numerics.spectrum import spectral_radius
from trunnion.results.counts import counted
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, computed, coordinate, internal, labelled, variable
from trunnion.results.of_systems import about, states
from trunnion.results.outcome import Outcome
from trunnion.results.quantity_axes import state_axes
from trunnion.results.result import Result
from trunnion.results.units import with_error
from trunnion.results.variables import Attribute, Variable
from trunnion.results.verdict import MEANING, Verdict, verdicts
from trunnion.steady.shooting.integration_outcomes import outcome_of
from trunnion.steady.shooting.repetition import repetition
from trunnion.steady.shooting.shooting_problem import (
    COARSER,
    IntegratedShooting,
    Phase,
    close,
    divergence_of,
    keeps_volume,
    rests,
    sticking,
)
from trunnion.systems.maps import IntegratedMap, TimedMap, checked_periods
from trunnion.systems.system import System

TOLERANCE = 1e-11
SAMPLES = 512
LEFT = 200.0
"""Residual at which an orbit counts as closed, over the tolerance of its integration."""
RUNAWAY = 1e-4
"""Residual, in units of the states' scale, that no motion leaves which really closes."""
MOST_SHARES = 12
"""Repetitions within the period found that are looked for where there is no forcing."""
WHOLE = 4
"""Times that a closed orbit is gone round to ask after how much of it it repeats."""
MOST_STEPS = 200_000
"""Steps of one trial motion; one that needs more will not close."""
LONGEST = 10.0
"""How many times longer or shorter than its guess the period of an autonomous motion may be."""


@labelled
class Orbit:
    """A periodic motion, whatever map it closes under."""

    start: Array = internal("state at the beginning", axes="state")
    period: float = internal("of the motion", "s")
    multipliers: Complex = variable(
        "multiplier_number", "1", "by falling modulus, without the 1 of each slider that never slips", name="multiplier"
    )
    monodromy: Array = internal("matrix", axes="state state", repr=False)
    verdict: Verdict = attribute()
    iterations: int = internal("of the shooting")
    outcome: Outcome = internal("whether it was found, else numbers are NaN")


@labelled
class IntegratedOrbit(Orbit):
    """The orbit of a system with n states, integrated.

    spectral_radius and error_estimate leave out the trivial multiplier of an autonomous system that moves (one at rest
    has none: outcome "at rest"), and the ``speed_multiplier`` of a free–free line none of whose torques depends on the
    speed.
    """

    period: float = variable("", "s")
    system: System = internal("that moves", repr=False)
    multiplier_error: Array = variable("multiplier_number", "1", "bound on the error of each multiplier")
    spectral_radius: float = variable("", "1")
    error_estimate: float = internal("of the spectral radius", "1")
    liouville_defect: float = internal("|ln det Φ - ∫ tr ∂f/∂x dt|, NaN where a jump takes part")
    residual: float = attribute("of the period, in units of the states' scale")
    trajectory: Trajectory = internal("over one period", repr=False)
    values: tuple[float, ...] = internal(
        "what was unknown besides the start, as the period of an autonomous system or the torque of a free–free line"
    )
    speed_multiplier: float = internal("NaN of all but such a free–free line")
    set_aside: int = internal("how many multipliers of 1 the spectral radius leaves out, as none of a disturbance")
    stuck: tuple[str, ...] = internal("names of the sliders that never slip")

    @classmethod
    def of(cls, orbit: IntegratedOrbit, **more: Any) -> Self:
        """An orbit as one of this kind, with what that knows besides."""
        return cls(**{name: getattr(orbit, name) for name in IntegratedOrbit.__dataclass_fields__}, **more)

    @property
    @computed(variable("", "1/s"))
    def growth_rate(self) -> float:
        """Growth of the fastest disturbance [1/s]; negative when it decays."""
        return float(np.log(self.spectral_radius) / self.period) if self.spectral_radius > 0 else -np.inf

    @property
    def radius_in_words(self) -> str:
        """The spectral radius to the digits that are known."""
        return f"spectral radius {with_error(self.spectral_radius, self.error_estimate, beside=1.0)}"


@labelled
class PeriodicOrbit(Result, IntegratedOrbit):
    """A periodic motion of a system; see ``IntegratedOrbit``."""

    error_estimate: float = variable("", "1", "of the spectral radius")
    liouville_defect: float = attribute("|ln det Φ - ∫ tr ∂f/∂x dt|, NaN where a jump takes part")

    @property
    def regime_changes(self) -> int:
        """How often the motion changes its regime in a period."""
        return len(self.trajectory.event_time)

    @cached_property
    @computed(coordinate("time", "s"))
    def time(self) -> Array:
        """Times (points,) over one period, both ends included [s]; where none was found, of the last trial's steps."""
        if not self.outcome.ok:
            return self.trajectory.time_of_state
        return np.asarray(self.trajectory.start[0] + self.period * np.arange(SAMPLES + 1) / SAMPLES)

    @cached_property
    def state(self) -> Array:
        """States (points, n) at ``time``."""
        return self.trajectory.at(self.time) if self.outcome.ok else self.trajectory.state

    @property
    def mean(self) -> Array:
        """Mean of every state (n,) over a period, integrated on the dense output."""
        return self.harmonics(0)[0].real

    def harmonics(self, highest: int) -> Complex:
        """Fourier coefficients (highest + 1, n): x = Re Σ c_k e^{2πikt/T}; |c_k| is the amplitude.

        Integrals over the dense output: nothing above the highest order folds back on them.
        """
        return fourier(self.trajectory.at, self.trajectory.time_of_state, highest)

    @cached_property
    def peak_to_peak(self) -> Array:
        """Largest minus smallest value of every state (n,), found on the dense output."""
        return extremes(self.trajectory.at, self.trajectory.time_of_state).span

    def declared(self) -> Iterator[Variable | Attribute]:
        """What the fields hold, every state by its name over one period, and the system."""
        yield from states(self.system, "time", self.state)
        yield from super().declared()
        yield Attribute("tangents", "exact" if self.system.exact_tangents else "differenced")
        yield from about(self.system, self.outcome)

    def plot(self, axes: Axes | None = None, *, x: str = "", y: str = "") -> Axes:
        """Portrait of the orbit; see ``pictures.motion``."""
        return drawing(self, "plot")(self, axes, x=x, y=y)

    @property
    def _growth(self) -> str:
        if self.spectral_radius > self.error_estimate:
            return f"{self.growth_rate:+.6g} 1/s"
        most = np.log(self.spectral_radius + self.error_estimate) / self.period
        return f"below {most:+.3g} 1/s"

    def __str__(self) -> str:
        if not self.outcome.ok:
            return f"no periodic motion of {self.system.name}: {self.outcome}"
        changes = f", {self.regime_changes} changes of regime" if self.system.regimes else ""
        tangents = "" if self.system.exact_tangents else "; tangents differenced"
        what = "equilibrium" if self.outcome.kind == "at rest" else "periodic motion"
        axes = state_axes(self.system)
        rows = [
            f"  {name}: {mean * axis.factor:.6g} ± {axis.number(float(peak) / 2)}"
            for name, mean, peak, axis in zip(self.system.states, self.mean, self.peak_to_peak, axes, strict=True)
        ]
        return "\n".join(
            [
                f"{self.verdict} {what} of {self.system.name}, period {self.period:.8g} s{changes}: "
                f"{MEANING[self.verdict]}",
                f"  {self.radius_in_words}, growth rate {self._growth}{tangents}",
                *rows,
                f"  {self.outcome}",
            ]
        )


def speed_in_words(orbit: IntegratedOrbit) -> str:
    """What becomes of a change of the mean speed of a free line none of whose torques depends on the speed."""
    return change_of_speed_in_words(orbit.speed_multiplier, orbit.period)


def change_of_speed_in_words(multiplier: float, period: float) -> str:
    """The same by its ``multiplier`` over a ``period`` [s]."""
    rate = float(np.log(multiplier) / period) if multiplier > 0 else np.nan
    return (
        f"no torque depends on the speed: a change of the mean speed goes at {rate:+.3g} 1/s (multiplier "
        f"{multiplier:.10g}), which the verdict leaves out"
    )


def periodic_orbit(
    system: System,
    *,
    start: ArrayLike | None = None,
    period: float | None = None,
    periods: int = 1,
    phase: float = 0.0,
    tolerance: float = TOLERANCE,
    settle: bool = True,
) -> PeriodicOrbit:
    """The periodic motion near ``start``, stable or not.

    Parameters
    ----------
    system : forced, or autonomous with a guess of the ``period``.
    start : a state near it at time ``phase``; by default the system's own start.
    period : of an autonomous system, a guess [s].
    periods : forcing periods in one period of the motion (a subharmonic of that order).
    tolerance : of the integration, which is the error of the orbit and, times its condition, of Φ.
    settle : when shooting fails, integrate 50 and then 500 periods and shoot again from there.

    Returns
    -------
    An orbit whose ``outcome`` tells whether it was found; otherwise its numbers are NaN.

    Raises
    ------
    InputError : no start, no period.
    """
    periods = checked_periods(periods)
    if start is None and system.start is None:
        raise InputError("is missing", element=system.name, key="start", remedy=f"give {', '.join(system.states)}")
    first = system.start if start is None else system.checked_start(start)
    assert first is not None
    if system.forcing_period is not None:
        if period is not None:
            raise InputError(
                "belongs to autonomous systems; this one is forced", element=system.name, key="period", value=period,
                remedy="give periods = 2 for a motion of twice the forcing period",
            )  # fmt: skip
        forced = IntegratedMap(lambda: system, (), (), phase, periods, tolerance, MOST_STEPS)
        return judged(*close(first, lambda guess: shooting_problem(forced), settle=settle))
    if period is None or not (np.isfinite(period) and period > 0):
        raise InputError(
            "must be guessed for an autonomous system", element=system.name, key="period", value=period,
            remedy="give a positive time in seconds, from a simulation",
        )  # fmt: skip
    length = periods * float(period)
    timed = TimedMap(lambda time: system, (length,), (0.0,), phase, 1, tolerance, MOST_STEPS)

    def across(guess: Array) -> IntegratedShooting:
        """One point of the orbit is chosen by the plane across the flow at the guess."""
        scale = np.asarray(system.scale)
        flow = system.rate_at(phase, guess)
        row = flow / max(float(np.linalg.norm(flow / scale)), 1e-300) / scale**2
        return shooting_problem(timed, Phase(row, guess), (length,), (length / LONGEST, length * LONGEST))

    return judged(*close(first, across, (length,), settle=settle))


def shooting_problem(
    place: IntegratedMap,
    phase: Phase | None = None,
    sizes: tuple[float, ...] = (),
    within: tuple[float, float] = (-np.inf, np.inf),
) -> IntegratedShooting:
    """The closing of motions of an integrated map; ``sizes`` of the unknown values that count as one."""
    scale = np.append(np.asarray(place.system.scale), sizes)
    return IntegratedShooting(place, scale, phase, LEFT * place.tolerance, within)


def judged(free: IntegratedShooting, root: Root) -> PeriodicOrbit:
    """The orbit where shooting ended: its multipliers, their error and the verdict; or why there is none."""
    if not root.converged:
        return _failed(free, root)
    problem, root, stuck = sticking(free, root) or (free, root, ())
    n, x, place, system = free.size, root.x[: free.size], problem.place(root.x), free.place(root.x).system
    length, scale = place.length, np.asarray(system.scale)
    run, coarse = place(x, dense=True).run, place(x, looser=COARSER).run
    found, matrix = problem.judged(place, x, run, coarse, root.size), run.final[1:].T
    radius, radius_error = np.array(0.0), np.array(0.0)
    if len(found.counted):
        radius, radius_error = spectral_radius(found.counted, found.counted_bound)
    divergence = divergence_of(system, run)
    sign, log_det = np.linalg.slogdet(matrix * scale[None, :] / scale[:, None])
    jumps = system.regimes is not None and system.regimes.jump is not None and len(run.event_time) > 0
    nearest = int(np.argmin(np.abs(found.values - 1)))
    left = float(np.abs(root.residual[:n] / scale).max())
    if problem.phase is None and left > RUNAWAY and abs(found.values[nearest] - 1) <= found.bound[nearest]:
        # Relative to a motion that ran away, what is left is small.
        return _failed(free, root, _unbounded(system, x))
    still, words = rests(place, run), f"closes to {root.size:.1e} after {root.iterations} iterations"
    if still:
        words = f"the motion is at rest: an equilibrium, of which every multiplier counts; {words}"
    elif (shares := _shares(place, run, x)) > 1:
        words += f"; it closes {shares} times in this period: the least period is {length / shares:.8g} s"
    return PeriodicOrbit(
        start=system.within_limits(x),
        period=length,
        multipliers=found.values,
        monodromy=matrix,
        verdict=Verdict(int(verdicts(radius, radius_error, keeps_volume(divergence, n)))),
        iterations=root.iterations,
        outcome=Outcome(True, "at rest" if still else "found", words),
        system=system,
        multiplier_error=found.bound,
        spectral_radius=float(radius),
        error_estimate=float(radius_error),
        liouville_defect=np.nan if jumps else float(abs(log_det - divergence)) if sign > 0 else np.inf,
        residual=root.size,
        trajectory=run,
        values=tuple(root.x[n:].tolist()),
        speed_multiplier=found.speed,
        set_aside=len(found.values) - len(found.counted) - int(np.isfinite(found.speed)),
        stuck=tuple(system.sliders[one] for one in stuck),
    )


def _unbounded(system: System, x: Array) -> Outcome:
    worst = int(np.argmax(np.abs(x / np.asarray(system.scale))))
    return Outcome(
        False,
        "unbounded",
        f"a multiplier is 1 and no motion closes ({system.states[worst]} runs away to {x[worst]:.1e}): undamped at "
        "resonance the motion grows without bound; give damping or another frequency",
    )


def _shares(place: IntegratedMap, run: Trajectory, x: Array) -> int:
    """How many times the motion repeats within one application of the map."""
    moved = np.ptp(run.state, axis=0) + 1e-300
    if np.all(moved <= 1e-9 * np.asarray(place.system.scale)):
        return 1

    def after(parts: int) -> int:
        """After how many of so many equal parts of the orbit it repeats; 0 where it takes more than can be told."""
        points = run.at(place.phase + place.length * np.arange(parts) / parts) - x
        # The orbit is closed: what follows is the same again.
        return repetition(np.tile(points, (2 * WHOLE, 1)), moved, np.zeros(len(x)), np.zeros((0, len(x)))).after

    if isinstance(place, TimedMap):
        return next((share for share in range(MOST_SHARES, 1, -1) if after(share) == 1), 1)
    return place.periods // (after(place.periods) or place.periods)


def _ended(root: Root) -> str:
    if not root.iterations:
        return "shooting found no step from its start that comes nearer to a periodic motion"
    return f"shooting did not converge in {counted(root.iterations, 'iteration')}"


def _failed(problem: IntegratedShooting, root: Root, outcome: Outcome | None = None) -> PeriodicOrbit:
    place, n, nan = problem.map, problem.size, float("nan")
    assert problem.last is not None
    system, run = place.system, problem.last.run
    if outcome is None and run.end is not IntegrationEnd.REACHED:
        guards = system.regimes.guards if system.regimes else ()
        broken = outcome_of(system, run, place.tolerance, guards)
        outcome = Outcome(False, broken.kind, f"a trial motion failed: {broken.sentence}")
    elif outcome is None:
        outcome = Outcome(
            False,
            "not converged",
            f"{_ended(root)} (residual {root.size:.1e}); start closer, "
            "for example from the end of a longer simulation, or follow the motion from a parameter where it is known",
        )
    nothing = np.full(n, nan)
    return PeriodicOrbit(
        start=root.x[:n],
        period=place.length,
        multipliers=nothing.astype(complex),
        monodromy=np.full((n, n), nan),
        verdict=Verdict.FAILED,
        iterations=root.iterations,
        outcome=outcome,
        system=system,
        multiplier_error=nothing,
        spectral_radius=nan,
        error_estimate=nan,
        liouville_defect=nan,
        residual=root.size,
        trajectory=run,
        values=tuple(root.x[n:].tolist()),
        speed_multiplier=nan,
        set_aside=0,
        stuck=(),
    )
