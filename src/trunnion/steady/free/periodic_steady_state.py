"""A line with joint angles, about its own periodic motion: the base of the stability of one that is free–free, and of
one behind a prescribed speed where it is asked for.

About the motion of rigid shafts at constant input speed, which is not a motion of a free line, its rigid-body pair
grows by 0.36 β²Ω (two equal inertias, one joint): an artefact. Excitations of disks and transmission errors, whose
periods are others, are left out: they do not change how a small disturbance grows.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.equations.aligned import aligned_matrices, frequencies
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.harmonics import unexcited
from trunnion.equations.line_system import LineSystem, line_system
from trunnion.equations.linear import line_matrices
from trunnion.equations.linear_clutches import with_mean_clutches
from trunnion.equations.steady_base import refuse_dragged, require_balance
from trunnion.errors import ComputationError
from trunnion.modes.mode_content import ModeMotion, floquet_pair
from trunnion.numerics.integration.integration import IntegrationEnd, integrate
from trunnion.steady.free.periodic_steady_states import SteadyStatesBySpeed
from trunnion.steady.free.several_motions import BENT, FAR, require_one_motion
from trunnion.steady.shooting.free_orbit import kept_speed_orbit
from trunnion.steady.shooting.periodic_orbit import TOLERANCE, PeriodicOrbit, periodic_orbit
from trunnion.systems.maps import IntegratedMap

SAMPLES = 256
PER_CYCLE = 8
"""Samples at least per cycle of the highest mode."""


@dataclass(frozen=True)
class PeriodicSteadyState:
    """The motion at ``speed`` [rad/s], of a free line its last value the torque [N m at the input] beyond the balance;
    ``assembly`` is the line without excitations."""

    orbit: PeriodicOrbit
    assembly: Assembly
    speed: float

    def mode_motion(self, multiplier: complex) -> ModeMotion | None:
        """How the Floquet mode of a multiplier and its adjoint move over the period; None for a double multiplier.

        Modes are those of the means of M and K about the motion of rigid shafts, which is near.
        """
        topo, orbit, system = self.assembly.topology, self.orbit, self.orbit.system
        co = self.assembly.coefficients(self.assembly.table(1, self.speed))
        turn = self.speed * orbit.period
        mean = line_matrices(topo, co, turn * np.arange(SAMPLES) / SAMPLES)
        highest = float(frequencies(aligned_matrices(topo, co), still=topo.still).max()) * orbit.period / (2 * np.pi)
        scale = np.repeat([1.0, 1 / self.speed], topo.size)
        times = orbit.period * np.linspace(0, 1, max(SAMPLES, PER_CYCLE * int(np.ceil(highest))) + 1)
        state, over = orbit.start, []
        for now, after in zip(times[:-1], times[1:], strict=True):
            block = np.concatenate([state[None], np.eye(2 * topo.size)])
            regime = system.regime_at(now, state)
            block = integrate(system.equations, now, after, block, regime=regime, tolerance=1e-8, dense=False).final
            state = block[0]
            over.append(block[1:].T * scale[:, None] / scale)
        pair = floquet_pair(orbit.monodromy * scale[:, None] / scale, multiplier)
        if pair is None:
            return None
        right, left = [pair[0]], [pair[1]]
        for continued in over[:-1]:
            right.append(continued @ right[-1])
        for continued in reversed(over):
            left.append(left[-1] @ continued)
        exponent = np.log(multiplier) / turn
        return ModeMotion(
            np.array(right),
            np.array(left[:0:-1]),
            exponent,
            turn,
            mean.mass[0].mean(0),
            mean.stiffness[0].mean(0) / self.speed**2,
        )


def periodic_steady_state(line: Driveline, speed: float, *, tolerance: float = TOLERANCE) -> PeriodicSteadyState:
    """The periodic motion of a line at (mean) input ``speed`` [rad/s], without its exciters.

    ``tolerance`` : of its integration.

    Raises
    ------
    InputError : torques that do not balance.
    ComputationError : no motion found, or several at this speed.
    """
    prepared = line_system(assemble(with_mean_clutches(assemble(unexcited(line)), speed)), speed, linearised=True)
    refuse_dragged(prepared.assembly)
    require_balance(prepared.assembly, prepared.assembly.table(1, speed))
    start = prepared.twisted()
    orbit = _closed(prepared, start, 0.0, tolerance)
    if not orbit.outcome.ok or _far(prepared, orbit, start):
        orbit = _followed(line, prepared, speed, tolerance) or orbit
        if not orbit.outcome.ok:
            orbit = _closed(prepared, start, 0.0, tolerance, settle=True)
    if not orbit.outcome.ok:
        raise ComputationError(f"no periodic motion of the line was found to judge: {orbit.outcome}")
    return PeriodicSteadyState(orbit, prepared.assembly, speed)


def _closed(line: LineSystem, start: Array, extra: float, tolerance: float, *, settle: bool = False) -> PeriodicOrbit:
    if line.assembly.topology.free:
        return kept_speed_orbit(line, start, tolerance=tolerance, settle=settle, extra=extra)
    return periodic_orbit(line.system, start=start, tolerance=tolerance, settle=settle)


def _far(line: LineSystem, orbit: PeriodicOrbit, start: Array) -> bool:
    """Whether a motion is so far from that of rigid shafts, and the way to it so bent, that others may have the same
    speed: the orbit's own derivative leads back to ``start`` where it is not."""
    n, apart = line.assembly.topology.size, start - orbit.start
    scale = np.repeat([1.0, 1 / line.speed], n)
    if np.abs(apart[: 2 * n] * scale).max() <= FAR:
        return False
    run = IntegratedMap.of(orbit.system).run(start[None])
    if run.end is not IntegrationEnd.REACHED:
        return True
    closing, left = orbit.monodromy - np.eye(len(start)), run.final[0] - start
    if line.assembly.topology.free:  # a phase is kept
        closing, left = np.vstack([closing, np.eye(len(start))[:1]]), np.append(left, 0.0)
    off = np.linalg.lstsq(closing, left)[0] - apart
    return bool(np.abs(off[: 2 * n] * scale).max() > BENT * np.abs(apart[: 2 * n] * scale).max())


def _followed(line: Driveline, prepared: LineSystem, speed: float, tolerance: float) -> PeriodicOrbit | None:
    """The motion that goes on to ``speed`` from slower and from faster ones; None where harmonics do not tell.

    Raises
    ------
    ComputationError : the motions fold back, and several have this speed.
    """
    curve = SteadyStatesBySpeed(line)
    if curve.obstacle:
        return None
    require_one_motion(curve, line, speed)
    motions = curve.at_all(np.array([speed]))
    if not (motions.found[0] and motions.resolved[0]):
        return None
    orbit = _closed(prepared, motions.states[0, 0], float(motions.torque[0]), tolerance)
    return orbit if orbit.outcome.ok else None
