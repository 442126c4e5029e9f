"""The periodic motion of a line that starts free, at the mean speed asked for.

Nothing prescribes its rotation, so that any phase of the motion is one as well: unknown are the state but for the
first rotation, which is held where it starts, and the torque that drives beyond the balance of the loads, to cover
what dampers and speed fluctuation take. P(x; torque) = x in a frame that turns at the mean speed,

    m equations in (torque, x₂ … x_m).

The disturbance that shifts the phase, x′ + R Ω, comes back exactly: its multiplier 1 is set aside by that vector.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from trunnion.analyses.orbits.periodic_orbit import TOLERANCE, Neutral, PeriodicOrbit, Shots, judged
from trunnion.driveline.elements import Disk
from trunnion.equations.coefficients import Assembly
from trunnion.equations.line_system import LineSystem
from trunnion.equations.steady_base import bent
from trunnion.errors import InputError
from trunnion.numerics.continuation.newton import Root, solve
from trunnion.numerics.integration.integration import End, Trajectory, integrate
from trunnion.systems.system import System

Array = NDArray[np.float64]
SETTLING = (0, 60)
"""Periods integrated from the start before shooting, tried one after the other."""


@dataclass(frozen=True)
class FreeOrbit:
    """The motion, and the torque at the input [N m] that its drives give beyond the balance of the loads."""

    orbit: PeriodicOrbit
    extra_torque: float


def kept_speed_orbit(
    line: LineSystem, start: ArrayLike | None = None, *, tolerance: float = TOLERANCE, settle: bool = True
) -> FreeOrbit:
    """The periodic motion of a free line at its mean speed ``line.speed``.

    Raises
    ------
    InputError : excited in time or without a common period.
    """
    require_closing(line)
    first = line.twisted() if start is None else line.system.checked(start, "start")
    problem = _KeptSpeed(line, tolerance)
    for count in SETTLING if settle else SETTLING[:1]:
        guess = first
        if count:
            system = line.system
            run = integrate(
                system.equations, 0.0, count * problem.length, first,
                regime=system.regime_at(0.0, first), tolerance=1e-8, dense=False,
            )  # fmt: skip
            if run.end is not End.REACHED:
                break
            guess = run.final[0]
        root = problem.solve(guess)
        if root.converged:
            break
    torque = float(root.x[0])
    shots = problem.shots(torque)
    state = np.append(problem.anchor, root.x[1:])
    shots.last = problem.last if not root.converged else shots.run(state, shots.length, tolerance)
    return FreeOrbit(judged(shots, replace(root, x=state)), torque)


def require_closing(line: LineSystem) -> None:
    """Refuse a free line whose motion cannot close."""
    if line.period_turns is None or line.time_harmonics:
        raise InputError(
            "starts free and is excited in time or without a common period: its motion does not close",
            element="driveline",
            remedy="put a ConstantSpeed in front, give orders instead of frequencies, or simulate it",
        )


def neutral_motions(line: LineSystem, speed: float) -> Callable[[System, Array], Neutral]:
    """(system, state at t = 0) → the line's neutral disturbances in the frame that turns at ``speed``.

    A shift of the phase comes back exactly; without bent joints, loads by speed and excitation a change of the speed
    does as well.
    """
    topo, n = line.assembly.topology, line.assembly.topology.size
    turn = np.array([float(topo.speed_ratio[topo.reference[g]]) for g, c in enumerate(topo.coordinate) if c >= 0])
    faster = np.append(np.zeros(n), turn)
    by_speed = loaded_by_speed(line.assembly)
    steady = not (bent(line.assembly) or by_speed or line.excited or topo.tripods)

    def at(system: System, x: Array) -> Neutral:
        shift = system.rate_at(0.0, x, system.regime_at(0.0, x)) + np.append(turn * speed, np.zeros(n))
        if steady:
            return Neutral(np.stack([shift, faster], axis=1))
        return Neutral(shift[:, None], None if by_speed else faster)

    return at


def loaded_by_speed(assembly: Assembly) -> bool:
    """Whether any load of the line depends on the speed."""
    disks = [element for element in assembly.line.elements if isinstance(element, Disk)]
    return any(disk.viscous_load or disk.quadratic_load for disk in disks)


class _KeptSpeed:
    """P(x; torque) = x with the first rotation held."""

    def __init__(self, line: LineSystem, tolerance: float) -> None:
        self.line, self.tolerance = line, tolerance
        system = line.system
        assert system.forcing_period is not None
        self.length = float(system.forcing_period)
        topo = line.assembly.topology
        co = line.assembly.coefficients(line.assembly.table(1, line.speed), statically_twisted=False, free_play=True)
        inertia = float(co.inertia[0] @ np.array([float(q) for q in topo.speed_ratio]) ** 2)
        # The torque that changes the speed over a period by what counts as one in error control.
        self.scale = np.array(system.scale, dtype=float)
        self.scale[0] = self.scale[topo.size] * inertia / self.length
        self.anchor = 0.0
        self.last: Trajectory | None = None

    def shots(self, torque: float) -> Shots:
        neutral = neutral_motions(self.line, self.line.speed)
        return Shots(self.line.with_drive(torque), 0.0, self.length, True, self.tolerance, neutral=neutral)

    def solve(self, guess: Array) -> Root:
        self.anchor = float(guess[0])
        return solve(self.residual, np.append(0.0, guess[1:]), self.scale, tolerance=200 * self.tolerance)

    def residual(self, z: Array) -> tuple[Array, Array]:
        n, x = len(z), np.append(self.anchor, z[1:])
        shots, h = self.shots(float(z[0])), float(self.scale[0])
        self.last = run = shots.run(x, self.length, self.tolerance)
        below, above = (self._end(x, float(z[0]) + side * h) for side in (-1.0, 1.0))
        if run.end is not End.REACHED or below is None or above is None:
            return np.full(n, np.nan), np.full((n, n), np.nan)
        slope = run.final[1:].T - np.eye(n)
        slope[:, 0] = (above - below) / (2 * h)
        return np.asarray(run.final[0] - x), slope

    def _end(self, x: Array, torque: float) -> Array | None:
        system = self.line.with_drive(torque)
        run = integrate(
            system.equations, 0.0, self.length, x, regime=system.regime_at(0.0, x), tolerance=self.tolerance,
            dense=False,
        )  # fmt: skip
        return run.final[0] if run.end is End.REACHED else None
