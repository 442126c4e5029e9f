"""Helpers of analyses of long motions: how they end, how long a turn takes, how large they are."""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array
from trunnion.numerics.integration.integration import integrate
from trunnion.numerics.integration.tangents import Motion
from trunnion.results.outcome import Outcome
from trunnion.steady.shooting.integration_outcomes import GROWN, outcome_of
from trunnion.systems.system import System


def failure(system: System, motion: Motion, length: float, before: str) -> Outcome:
    """What stopped a motion: met again in the interpreter, which can say what it was."""
    again = integrate(
        system.equations, motion.time, motion.time + length, motion.state, regime=motion.regime,
        tolerance=motion.tolerance, most_steps=motion.most_steps, dense=False,
    )  # fmt: skip
    told = outcome_of(system, again, motion.tolerance, system.regimes.guards if system.regimes else ())
    if told.ok:
        return Outcome(False, "refused", f"{before}the tangents could not be followed any further")
    return Outcome(False, told.kind, f"{before}{told.sentence}")


def usual_time(system: System, state: Array, tolerance: float, steps: int = 32) -> float:
    """A time in which the motion of an autonomous system gets about once around, rounded to one figure.

    Where a system comes to rest the integrator's steps grow without bound, so the fastest rate of its linear
    part bounds the time too: at the end of a trial, or at the start if the trial runs away.
    """
    trial = integrate(
        system.equations, 0.0, 1e9, state, regime=system.regime_at(0.0, state), tolerance=tolerance,
        most_steps=2000, dense=False,
    )  # fmt: skip
    half = trial.length[trial.steps // 4 :]
    interval = steps * float(np.median(half)) if len(half) else 1.0
    last = trial.state[-1]
    away = not np.all(np.abs(last) <= GROWN * np.maximum(np.abs(state), np.asarray(system.scale)))
    last, regime = (state, system.regime_at(0.0, state)) if away else (last, trial.final_regime)
    matrix = system.jacobian(0.0, last, regime)
    if np.all(np.isfinite(matrix)):
        fastest = float(np.max(np.abs(np.linalg.eigvals(matrix))))
        interval = min(interval, 2 * np.pi / fastest) if fastest > 0 else min(interval, 1.0)
    power = 10.0 ** np.floor(np.log10(interval))
    return float(max(np.floor(interval / power), 1.0) * power)


def motion_size(system: System, state: Array, interval: float, tolerance: float) -> Array:
    """Largest minus smallest value (n,) of each state over the next few intervals."""
    run = integrate(
        system.equations,
        0.0,
        8 * interval,
        state,
        regime=system.regime_at(0.0, state),
        tolerance=tolerance,
        dense=False,
    )
    return np.ptp(run.state, axis=0) if run.steps else np.zeros(system.size)
