"""A periodic motion of a system by shooting, and its stability from its own variational equations.

    forced:      P(x) = x over one forcing period (or several: a subharmonic),
    autonomous:  φ_T(x) = x for x and T, with f(x₀)·(x − x₀) = 0 to choose one point of the orbit,

by Newton's method with the exact derivative Φ of the flow (with saltation at switching surfaces). The
multipliers are the eigenvalues of Φ, those of the true motion whatever its amplitude. Their error is bounded
from the difference of Φ at two tolerances, and checked by Liouville's identity ln det Φ = ∫ tr ∂f/∂x dt.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from trunnion.analyses.motion.integration_outcomes import outcome_of
from trunnion.errors import InputError
from trunnion.numerics.continuation.newton import Root, solve
from trunnion.numerics.curves import extremes, fourier
from trunnion.numerics.integration.integration import End, Trajectory, integrate
from trunnion.numerics.spectrum import along, multipliers, spectral_radius, without
from trunnion.results.declared import Held, Result, axis, ending, over, parameters_of, remark
from trunnion.results.drawing import drawing
from trunnion.results.outcome import Outcome
from trunnion.results.units import with_unit
from trunnion.results.verdict import MEANING, Verdict, verdicts
from trunnion.systems.system import System

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
TOLERANCE = 1e-11
SAMPLES = 512
AT_REST = 1e-7
"""Movement over a period, in units of the states' scale and size, that counts as none: what shooting leaves is less."""
COARSER = 30.0
"""How much larger than its own the tolerance is against which a motion's error is measured."""
RUNAWAY = 1e-4
"""Residual, in units of the states' scale, that no motion leaves which really closes."""
MOST_SHARES = 12
"""Repetitions within the period found that are looked for where there is no forcing."""
MOST_STEPS = 200_000
"""Steps of one trial motion; one that needs more will not close."""
SETTLING = (0, 40, 400)
"""Periods integrated from the start before shooting, tried one after the other."""


@dataclass(frozen=True, repr=False)
class PeriodicOrbit(Result):
    """A periodic motion and its stability.

    start (n,); period [s]; time (points,) and state (points, n) over one period, ends included; multipliers
    (n,) by falling modulus with multiplier_error (n,); spectral_radius and error_estimate leave out the
    trivial multiplier of an autonomous system that moves (one at rest has none: outcome "at rest"), and the
    ``speed_multiplier`` of a free line none of whose torques depends on the speed (NaN elsewhere); monodromy (n, n);
    liouville_defect: |ln det Φ − ∫tr ∂f/∂x dt|, NaN where a jump takes part; residual: of the period, in units of the
    states' scale; regime_changes: how often the motion changes its regime in a period.
    """

    system: System
    start: Array
    period: float
    time: Array
    state: Array
    multipliers: Complex
    multiplier_error: Array
    monodromy: Array
    spectral_radius: float
    error_estimate: float
    verdict: Verdict
    liouville_defect: float
    residual: float
    iterations: int
    outcome: Outcome
    trajectory: Trajectory
    speed_multiplier: float = float("nan")

    @property
    def growth_rate(self) -> float:
        """Growth of the fastest disturbance [1/s]; negative when it decays."""
        return float(np.log(self.spectral_radius) / self.period) if self.spectral_radius > 0 else -np.inf

    @property
    def _growth(self) -> str:
        if self.spectral_radius > self.error_estimate:
            return f"{self.growth_rate:+.6g} 1/s"
        most = np.log(self.spectral_radius + self.error_estimate) / self.period
        return f"below {most:+.3g} 1/s"

    @property
    def regime_changes(self) -> int:
        """How often the motion changes its regime in a period."""
        return len(self.trajectory.event_time)

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

    def declared(self) -> Iterator[Held]:
        """Every state over one period, and the multipliers."""
        yield axis("time", self.time, "s")
        for i, (name, unit) in enumerate(zip(self.system.states, self.system.units, strict=True)):
            yield over("time", name, self.state[:, i], unit)
        yield over("multiplier_number", "multiplier", self.multipliers, "1")
        yield over("multiplier_number", "multiplier_error", self.multiplier_error, "1")
        yield over("", "spectral_radius", self.spectral_radius, "1")
        yield over("", "error_estimate", self.error_estimate, "1")
        yield over("", "growth_rate", self.growth_rate, "1/s")
        yield over("", "period", self.period, "s")
        yield remark("system", self.system.name)
        yield remark("verdict", str(self.verdict))
        yield from ending(self.outcome)
        yield remark("residual", self.residual)
        yield remark("liouville_defect", self.liouville_defect)
        yield remark("tangents", "exact" if self.system.exact_tangents else "differenced")
        yield from parameters_of(self.system)

    def plot(self, axes: Axes | None = None, **options: Any) -> Axes:
        """Portrait of the orbit; see ``trunnion.plots.motion``."""
        return drawing(self, "plot")(self, axes, **options)

    def __str__(self) -> str:
        if not self.outcome.ok:
            return f"no periodic motion of {self.system.name}: {self.outcome}"
        changes = f", {self.regime_changes} changes of regime" if self.system.regimes else ""
        tangents = "" if self.system.exact_tangents else "; tangents differenced"
        what = "equilibrium" if self.outcome.kind == "at rest" else "periodic motion"
        rows = [
            with_unit(f"  {name}: {mean:.6g} ± {peak / 2:.6g}", unit)
            for name, mean, peak, unit in zip(
                self.system.states, self.mean, self.peak_to_peak, self.system.units, strict=True
            )
        ]
        return "\n".join(
            [
                f"{self.verdict} {what} of {self.system.name}, period {self.period:.8g} s{changes}: "
                f"{MEANING[self.verdict]}",
                f"  spectral radius {self.spectral_radius:.10g} ± {self.error_estimate:.1e}, growth rate "
                f"{self._growth}{tangents}",
                *rows,
                f"  {self.outcome}",
            ]
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
    settle : when shooting fails, integrate 40 and then 400 periods and shoot again from there.

    Returns
    -------
    An orbit whose ``outcome`` tells whether it was found; otherwise its numbers are NaN.

    Raises
    ------
    InputError : no start, no period.
    """
    if isinstance(periods, bool) or periods != int(periods) or periods < 1:
        raise InputError("must be a whole number from 1", key="periods", value=periods)
    if start is None and system.start is None:
        raise InputError("is missing", element=system.name, key="start", remedy=f"give {', '.join(system.states)}")
    first = system.start if start is None else system.checked(start, "start")
    assert first is not None
    forced = system.forcing_period is not None
    if forced and period is not None:
        raise InputError(
            "belongs to autonomous systems; this one is forced", element=system.name, key="period", value=period,
            remedy="give periods = 2 for a motion of twice the forcing period",
        )  # fmt: skip
    if not forced and (period is None or not (np.isfinite(period) and period > 0)):
        raise InputError(
            "must be guessed for an autonomous system", element=system.name, key="period", value=period,
            remedy="give a positive time in seconds, from a simulation",
        )  # fmt: skip
    length = periods * system.forcing_period if system.forcing_period is not None else float(period or 0.0)
    shots = Shots(system, phase, length, forced, tolerance)
    for count in SETTLING if settle else SETTLING[:1]:
        guess = first
        if count:
            run = integrate(
                system.equations, phase, phase + count * length, first,
                regime=system.regime_at(phase, first), tolerance=max(tolerance, 1e-8), dense=False,
            )  # fmt: skip
            if run.end is not End.REACHED:
                break
            guess = run.final[0]
        root = shots.solve(guess)
        if root.converged:
            break
    return judged(shots, root)


def torque_driven_orbit(
    at_speed: Callable[[float], System],
    speed: float,
    start: Array,
    *,
    neutral: Callable[[float], Callable[[System, Array], Neutral]],
    tolerance: float = TOLERANCE,
) -> tuple[PeriodicOrbit, float]:
    """The periodic motion of a line whose speed follows from its torques, and that speed [rad/s].

    ``at_speed`` observes the line from a frame that turns at a mean speed Ω, in which the motion closes after
    2π/Ω per turn for the right Ω only: unknown are the state and Ω, and the first rotation is zero at the start,
    which chooses one point of the orbit. As for any autonomous system one multiplier is 1 and is set aside.
    """
    n, phase = len(start), 0.0
    scale = np.append(np.asarray(at_speed(speed).scale), speed)
    last: list[Shots] = []

    def residual(z: Array) -> tuple[Array, Array]:
        r, slope = np.full(n + 1, np.nan), np.full((n + 1, n + 1), np.nan)
        if not 0.1 * speed < z[n] < 10 * speed:
            return r, slope
        shots, h = shots_at(float(z[n])), 1e-5 * speed
        shots.last = run = shots.run(z[:n], shots.length, tolerance)
        last[:] = [shots]
        beside = [shots_at(float(z[n]) + side * h) for side in (-1.0, 1.0)]
        ends = [other.run(z[:n], other.length, tolerance) for other in beside]
        if all(end.end is End.REACHED for end in (run, *ends)):
            r[:n], r[n] = run.final[0] - z[:n], z[0]
            slope[:n, :n] = run.final[1:].T - np.eye(n)
            slope[:n, n] = (ends[1].final[0] - ends[0].final[0]) / (2 * h)
            slope[n], slope[n, 0] = 0.0, 1.0
        return r, slope

    def shots_at(omega: float) -> Shots:
        system = at_speed(omega)
        assert system.forcing_period is not None
        return Shots(system, phase, system.forcing_period, False, tolerance, neutral=neutral(omega))

    root = solve(residual, np.append(start, speed), scale, tolerance=200 * tolerance)
    found = float(root.x[n])
    if root.converged:
        last[:] = [shots_at(found)]
        last[0].last = last[0].run(root.x[:n], last[0].length, tolerance)
    closed = replace(root, x=np.append(root.x[:n], last[0].length))
    return judged(last[0], closed), found


def speed_in_words(orbit: PeriodicOrbit) -> str:
    """What becomes of a change of the mean speed of a free line none of whose torques depends on the speed."""
    rate = float(np.log(orbit.speed_multiplier) / orbit.period) if orbit.speed_multiplier > 0 else np.nan
    return (
        f"no torque depends on the speed: a change of the mean speed goes at {rate:+.3g} 1/s (multiplier "
        f"{orbit.speed_multiplier:.10g}), which the verdict leaves out"
    )


@dataclass(frozen=True)
class Neutral:
    """Disturbances of a line that starts free: those that come back exactly (n, k), phase first; and where no torque
    depends on the speed but dampers do, the change of speed (n,), whose multiplier is near 1 and stated by itself."""

    returns: Array
    drifts: Array | None = None


@dataclass
class Shots:
    """Trial motions over one period, and the last one made.

    ``neutral``: of a line that starts free, from its system and the motion's start.
    """

    system: System
    phase: float
    length: float
    forced: bool
    tolerance: float
    last: Trajectory | None = None
    neutral: Callable[[System, Array], Neutral] | None = None

    def rests(self, run: Trajectory) -> bool:
        """Whether an autonomous motion stands still: it then has no phase, and so no multiplier 1 of its own. A line
        that turns has one, from its rotation."""
        size = np.asarray(self.system.scale) + np.abs(run.state).max(axis=0)
        return not self.forced and self.neutral is None and bool(np.all(np.ptp(run.state, axis=0) <= AT_REST * size))

    def run(self, x: Array, length: float, tolerance: float, dense: bool = False) -> Trajectory:
        block = np.vstack([x, np.eye(self.system.size)])
        return integrate(
            self.system.equations, self.phase, self.phase + length, block,
            regime=self.system.regime_at(self.phase, x), tolerance=tolerance, dense=dense, most_steps=MOST_STEPS,
        )  # fmt: skip

    def solve(self, guess: Array) -> Root:
        scale = np.asarray(self.system.scale)
        needed = 200 * self.tolerance
        if self.forced:
            return solve(self.forced_residual, guess, scale, tolerance=needed)
        anchor, flow = guess, self.system.rate_at(self.phase, guess)
        flow = flow / max(float(np.linalg.norm(flow / scale)), 1e-300) / scale**2

        def residual(z: Array) -> tuple[Array, Array]:
            n = self.system.size
            r, slope = np.full(n + 1, np.nan), np.full((n + 1, n + 1), np.nan)
            if not 0.1 * self.length < z[n] < 10 * self.length:
                return r, slope
            self.last = run = self.run(z[:n], float(z[n]), self.tolerance)
            if run.end is End.REACHED:
                r[:n], r[n] = run.final[0] - z[:n], flow @ (z[:n] - anchor)
                slope[:n, :n] = run.final[1:].T - np.eye(n)
                slope[:n, n] = self.system.rate_at(run.time, run.final[0], run.final_regime)
                slope[n] = np.append(flow, 0.0)
            return r, slope

        return solve(residual, np.append(guess, self.length), np.append(scale, self.length), tolerance=needed)

    def forced_residual(self, x: Array) -> tuple[Array, Array]:
        n = self.system.size
        self.last = run = self.run(x, self.length, self.tolerance)
        if run.end is not End.REACHED:
            return np.full(n, np.nan), np.full((n, n), np.nan)
        return run.final[0] - x, run.final[1:].T - np.eye(n)


def judged(shots: Shots, root: Root) -> PeriodicOrbit:
    """The orbit where shooting ended: its multipliers, their error and the verdict; or why there is none."""
    system, n = shots.system, shots.system.size
    assert shots.last is not None
    if not root.converged:
        return _failed(shots, root)
    x, length = root.x[:n], shots.length if shots.forced else float(root.x[n])
    run = shots.run(x, length, shots.tolerance, dense=True)
    coarse = shots.run(x, length, COARSER * shots.tolerance)
    matrix, scale = run.final[1:].T, np.asarray(system.scale)
    values, bound = multipliers_of(system, run, coarse, root.size)
    kept, off = values, bound
    speed, rests = np.nan, shots.rests(run)
    if shots.neutral is not None:
        scaled, error = scaled_matrix(system, run, coarse, root.size)
        kept, off, speed = beside_neutral(scaled, error, shots.neutral(system, x), scale)
    elif not (shots.forced or rests):
        others = np.delete(np.arange(n), int(np.argmin(np.abs(values - 1))))
        kept, off = values[others], bound[others]
    radius, radius_error = spectral_radius(kept, off) if len(kept) else (np.array(0.0), np.array(0.0))
    divergence = _divergence(system, run)
    undamped = bool(abs(divergence) < 1e-10 * n)
    sign, log_det = np.linalg.slogdet(matrix * scale[None, :] / scale[:, None])
    jumps = system.regimes is not None and system.regimes.jump is not None and len(run.event_time) > 0
    defect = float("nan") if jumps else float(abs(log_det - divergence)) if sign > 0 else float("inf")
    time = shots.phase + length * np.arange(SAMPLES + 1) / SAMPLES
    nearest = int(np.argmin(np.abs(values - 1)))
    left = float(np.abs(root.residual[:n] / scale).max())
    if shots.forced and shots.neutral is None and left > RUNAWAY and abs(values[nearest] - 1) <= bound[nearest]:
        # Relative to a motion that ran away, what is left is small.
        return _failed(shots, root, _unbounded(system, x))
    words = f"closes to {root.size:.1e} after {root.iterations} iterations"
    if rests:
        words = f"the motion is at rest: an equilibrium, of which every multiplier counts; {words}"
    elif (shares := _shares(shots, run, x, length)) > 1:
        words += f"; it closes {shares} times in this period: the least period is {length / shares:.8g} s"
    return PeriodicOrbit(
        system=system,
        start=x,
        period=length,
        time=time,
        state=run.at(time),
        multipliers=values,
        multiplier_error=bound,
        monodromy=matrix,
        spectral_radius=float(radius),
        error_estimate=float(radius_error),
        verdict=Verdict(int(verdicts(radius, radius_error, undamped))),
        liouville_defect=defect,
        residual=root.size,
        iterations=root.iterations,
        outcome=Outcome(True, "at rest" if rests else "found", words),
        trajectory=run,
        speed_multiplier=speed,
    )


def beside_neutral(scaled: Array, error: float, neutral: Neutral, scale: Array) -> tuple[Complex, Array, float]:
    """The multipliers to judge, their bounds, and the one of the line's speed where that is not judged with them."""
    aside = neutral.returns / scale[:, None]
    missed = float(np.linalg.norm(scaled @ aside[:, :1] - aside[:, :1]) / np.linalg.norm(aside[:, :1]))
    if missed > 1e-6 + 100 * error:  # something holds the phase after all
        aside = aside[:, :0]
    rest, basis = without(scaled, aside)
    values, bound = multipliers(rest, np.array(error))
    if neutral.drifts is None or not aside.shape[1]:
        return values, bound, np.nan
    place = along(rest, (neutral.drifts / scale) @ basis)
    return np.delete(values, place), np.delete(bound, place), float(values[place].real)


def multipliers_of(system: System, run: Trajectory, coarse: Trajectory, residual: float) -> tuple[Complex, Array]:
    """Multipliers (n,) of a closed motion by falling modulus, and what each may be off by (n,).

    run, coarse : the motion with its tangents, and again at ``COARSER`` times the tolerance; residual : how far it
    misses closing, in units of the states' scale.
    """
    scaled, error = scaled_matrix(system, run, coarse, residual)
    values, bound = multipliers(scaled, np.array(error))
    order = np.argsort(-np.abs(values))
    return values[order], bound[order]


def scaled_matrix(system: System, run: Trajectory, coarse: Trajectory, residual: float) -> tuple[Array, float]:
    """Φ (n, n) in units of the states' scales, and what it may be off by in the 2-norm."""
    scale = np.asarray(system.scale)
    scaled, rough = (r.final[1:].T * scale[None, :] / scale[:, None] for r in (run, coarse))
    # What a coarser tolerance changes bounds what is left; the orbit's own error moves Φ as well.
    error = float(np.linalg.norm(scaled - rough, 2)) / 3 + residual * float(np.linalg.norm(scaled, 2))
    if not system.exact_tangents:
        error += 1e-10 * float(np.linalg.norm(scaled, 2))
    return scaled, error


def _unbounded(system: System, x: Array) -> Outcome:
    worst = int(np.argmax(np.abs(x / np.asarray(system.scale))))
    return Outcome(
        False,
        "unbounded",
        f"a multiplier is 1 and no motion closes ({system.states[worst]} runs away to {x[worst]:.1e}): undamped at "
        "resonance the motion grows without bound; give damping or another frequency",
    )


def _shares(shots: Shots, run: Trajectory, x: Array, length: float) -> int:
    """How many times the motion repeats within ``length``."""
    system = shots.system
    most = MOST_SHARES
    if shots.forced:
        assert system.forcing_period is not None
        most = round(length / system.forcing_period)
    moved = np.ptp(run.state, axis=0) + 1e-300
    for share in range(most, 1, -1):
        if shots.forced and most % share:
            continue
        off = np.abs(run.at(np.array([shots.phase + length / share]))[0] - x)
        if np.all(off <= 1e-5 * moved) and not np.all(moved <= 1e-9 * np.asarray(system.scale)):
            return share
    return 1


def _failed(shots: Shots, root: Root, outcome: Outcome | None = None) -> PeriodicOrbit:
    system, n, nan = shots.system, shots.system.size, float("nan")
    assert shots.last is not None
    run = shots.last
    if outcome is None and run.end is not End.REACHED:
        guards = system.regimes.guards if system.regimes else ()
        broken = outcome_of(system, run, shots.tolerance, guards)
        outcome = Outcome(False, broken.kind, f"a trial motion failed: {broken.sentence}")
    elif outcome is None:
        outcome = Outcome(
            False,
            "not converged",
            f"shooting did not converge in {root.iterations} iterations (residual {root.size:.1e}); start closer, "
            "for example from the end of a longer simulation, or follow the motion from a parameter where it is known",
        )
    return PeriodicOrbit(
        system=system,
        start=root.x[:n],
        period=shots.length,
        time=run.time_of_state,
        state=run.state,
        multipliers=np.full(n, nan, dtype=complex),
        multiplier_error=np.full(n, nan),
        monodromy=np.full((n, n), nan),
        spectral_radius=nan,
        error_estimate=nan,
        verdict=Verdict.FAILED,
        liouville_defect=nan,
        residual=root.size,
        iterations=root.iterations,
        outcome=outcome,
        trajectory=run,
    )


_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(5)


def _divergence(system: System, run: Trajectory) -> float:
    """∫ tr ∂f/∂x dt over a run, from what is known of it or by Gauss's rule on every step."""
    known = system.divergence
    if known is not None:
        return float(known(system.parameters) if callable(known) else known) * (run.time - float(run.start[0]))
    total = 0.0
    for start, length, regime in zip(run.start, run.length, run.regime, strict=True):
        times = start + length * (_NODES + 1) / 2
        traces = [np.trace(system.jacobian(t, x, int(regime))) for t, x in zip(times, run.at(times), strict=True)]
        total += length / 2 * float(_WEIGHTS @ np.array(traces))
    return total
