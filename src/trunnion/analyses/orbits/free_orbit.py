"""The periodic motion of a line that starts free, at the mean speed asked for.

Nothing prescribes its rotation, so that any phase of the motion is one as well: unknown are the state but for the
first rotation, which is held where it starts, and the torque that drives beyond the balance of the loads, to cover
what dampers and speed fluctuation take. P(x; torque) = x in a frame that turns at the mean speed,

    m equations in (torque, x₂ … x_m).

The disturbance that shifts the phase, x′ + R Ω, comes back exactly: its multiplier 1 is set aside by that vector.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from trunnion.analyses.orbits.periodic_orbit import TOLERANCE, Neutral, PeriodicOrbit, Shots, judged
from trunnion.driveline.elements import Disk
from trunnion.equations.coefficients import Assembly
from trunnion.equations.line_system import LineSystem
from trunnion.equations.steady_base import require_balance, require_share
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
    line: LineSystem,
    start: ArrayLike | None = None,
    *,
    tolerance: float = TOLERANCE,
    settle: bool = True,
    driven: Callable[[float], System] | None = None,
) -> FreeOrbit:
    """The periodic motion of a free line at its mean speed ``line.speed``.

    ``driven`` : torque beyond the balance → system, by default those of ``line`` as described.

    Raises
    ------
    InputError : excited in time or without a common period.
    """
    require_closing(line)
    first = line.twisted() if start is None else line.system.checked(start, "start")
    problem = _KeptSpeed(line, driven or line.with_drive, tolerance)
    for count in SETTLING if settle else SETTLING[:1]:
        guess = first
        if count:
            system = problem.driven(0.0)
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


def closes(line: LineSystem) -> bool:
    """Whether the motion of a free line can close: a frequency in time has no fixed ratio to a speed that is free."""
    return line.period_turns is not None and not line.time_harmonics


def require_kept_speed(line: LineSystem) -> None:
    """Refuse a free line whose drives keep no speed that is asked for, or whose motion cannot close."""
    require_closing(line)
    assembly = line.assembly
    row = assembly.table(1, line.speed)
    require_balance(assembly, row)
    if loaded_by_speed(assembly):
        require_share(assembly)  # a constant torque balances at one speed only


def require_closing(line: LineSystem) -> None:
    """Refuse a free line whose motion cannot close."""
    if not closes(line):
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
    column, elements = line.assembly.packed.column, line.assembly.line.elements
    loads = [column(i, key) for _, i in topo.disks for key in ("viscous_load", "quadratic_load")]
    unsteady = [column(topo.stations[s].element, "angle") for s in (*topo.joints, *topo.tripods)]
    for _, i in topo.disks:
        count = len(getattr(elements[i], "excitation", None) or ())
        unsteady += [column(i, f"excitation {h} amplitude") for h in range(1, count + 1)]

    def at(system: System, x: Array) -> Neutral:
        by_speed = _any(line, system, loads)
        steady = not (by_speed or _any(line, system, unsteady))
        shift = system.rate_at(0.0, x, system.regime_at(0.0, x)) + np.append(turn * speed, np.zeros(n))
        if steady:
            return Neutral(np.stack([shift, faster], axis=1))
        return Neutral(shift[:, None], None if by_speed else faster)

    return at


def _any(line: LineSystem, system: System, places: Iterable[int]) -> bool:
    """Whether any of some numbers of the line is other than 0 in ``system``."""
    return any(system.parameters[line.assembly.packed.labels[i]] for i in places)


def loaded_by_speed(assembly: Assembly) -> bool:
    """Whether any load of the line depends on the speed."""
    disks = [element for element in assembly.line.elements if isinstance(element, Disk)]
    return any(disk.viscous_load or disk.quadratic_load for disk in disks)


def torque_scale(line: LineSystem) -> float:
    """The torque [N m] at the input that changes the speed over a period by what counts as one in error control."""
    topo, system = line.assembly.topology, line.system
    assert system.forcing_period is not None
    co = line.assembly.coefficients(line.assembly.table(1, line.speed), statically_twisted=False, free_play=True)
    inertia = float(co.inertia[0] @ np.array([float(q) for q in topo.speed_ratio]) ** 2)
    return float(np.asarray(system.scale)[topo.size]) * inertia / float(system.forcing_period)


class _KeptSpeed:
    """P(x; torque) = x with the first rotation held."""

    def __init__(self, line: LineSystem, driven: Callable[[float], System], tolerance: float) -> None:
        self.line, self.driven, self.tolerance = line, driven, tolerance
        system = driven(0.0)
        assert system.forcing_period is not None
        self.length = float(system.forcing_period)
        self.scale = np.array(system.scale, dtype=float)
        self.scale[0] = torque_scale(line)
        self.anchor = 0.0
        self.last: Trajectory | None = None

    def shots(self, torque: float) -> Shots:
        neutral = neutral_motions(self.line, self.line.speed)
        return Shots(self.driven(torque), 0.0, self.length, True, self.tolerance, neutral=neutral)

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
        system = self.driven(torque)
        run = integrate(
            system.equations, 0.0, self.length, x, regime=system.regime_at(0.0, x), tolerance=self.tolerance,
            dense=False,
        )  # fmt: skip
        return run.final[0] if run.end is End.REACHED else None
