"""Helpers of analyses of long motions: how they end, how long a turn takes, how large they are, whether they repeat."""

from __future__ import annotations

import numpy as np

from trunnion.analyses.motion.integration_outcomes import GROWN, outcome_of
from trunnion.arrays import Array
from trunnion.numerics.integration.integration import integrate
from trunnion.numerics.integration.tangents import Motion
from trunnion.results.outcome import Outcome
from trunnion.systems.system import System

LONGEST_REPEAT = 64
"""Returns after which a motion that has not closed is not called periodic."""
CLOSED = 1e-5
"""Distance between a point and its return, over the size of the motion, that counts as none."""
ROUNDED = 1e-8
"""The same over the scale of the system, for motions that have come to rest."""


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


def wrapped(points: Array, turning: tuple[int, ...]) -> Array:
    """Points (m, n) with the angles among their states between −π and π."""
    out = np.array(points, dtype=float)
    for i in turning:
        out[:, i] = np.angle(np.exp(1j * out[:, i]))
    return out


def repeat_of(points: Array, size: Array, scale: Array, turning: tuple[int, ...] = ()) -> int:
    """The smallest number of points after which the later half of (m, n) comes back to itself; 0 if none does."""
    later = points[len(points) // 2 :]
    if len(later) < 4:
        return 0
    size = size.copy()
    for i in turning:
        size[i] = min(size[i], 2 * np.pi)
    allowed = CLOSED * size + ROUNDED * (scale + np.abs(later).max(axis=0))
    for k in range(1, min(LONGEST_REPEAT, len(later) // 3) + 1):
        apart = later[k:] - later[:-k]
        for i in turning:
            apart[:, i] = np.angle(np.exp(1j * apart[:, i]))
        if np.all(np.abs(apart) <= allowed):
            return k
    return 0
