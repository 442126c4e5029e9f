"""The periodic motion of a free–free line, at the mean speed asked for.

Nothing prescribes its rotation, so that any phase of the motion is one as well: unknown are the state but for the
first rotation, which is held where it starts, and the torque that drives beyond the balance of the loads, to cover
what dampers and speed fluctuation take: P(x; torque) = x in a frame that turns at the mean speed. Where no drive keeps
the speed, the speed is unknown in place of the torque.

The disturbance that shifts the phase, x′ + R Ω, comes back exactly: its multiplier 1 is set aside by that vector.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.driveline.elements import Loaded
from trunnion.driveline.parameters import SPEED
from trunnion.equations.aligned import rigid_rotation
from trunnion.equations.coefficients import joint_laws
from trunnion.equations.line_system import LineSystem
from trunnion.equations.steady_base import loaded_by_speed, require_balance, require_share
from trunnion.errors import InputError
from trunnion.numerics.integration.integration import IntegrationEnd
from trunnion.steady.shooting.periodic_orbit import (
    LONGEST,
    MOST_STEPS,
    TOLERANCE,
    PeriodicOrbit,
    judged,
    shooting_problem,
)
from trunnion.steady.shooting.shooting_problem import IntegratedShooting, NeutralDisturbances, Phase, close
from trunnion.systems.maps import IntegratedMap
from trunnion.systems.system import System

BESIDE = 1e-5
"""Step of differences by the mean speed, over it."""
SMALL = 1e-3
"""Step of differences by the drives' torque, over the one that counts as one: over that the motion bends, and Newton's
steps would gain a digit or two each."""


def kept_speed_orbit(
    line: LineSystem,
    start: ArrayLike | None = None,
    *,
    tolerance: float = TOLERANCE,
    settle: bool = True,
    extra: float = 0.0,
    driven: Callable[[float], System] | None = None,
) -> PeriodicOrbit:
    """The periodic motion of a free line at its mean speed ``line.speed``; its last value is the torque at the input
    [N m] that its drives give beyond the balance of the loads.

    ``extra`` : a guess of that. ``driven`` : torque beyond the balance → system, by default those of ``line`` as
    described.

    Raises
    ------
    InputError : excited in time or without a common period.
    """
    require_periodic(line)
    first = line.twisted() if start is None else line.system.checked_start(start)
    torque = torque_scale(line)
    driving = IntegratedMap(driven or line.with_drive, (0.0,), (SMALL * torque,), 0.0, 1, tolerance, MOST_STEPS)
    neutral = neutral_motions(line)

    def fixed(guess: Array) -> IntegratedShooting:
        scale = np.asarray(driving.system.scale)
        return replace(shooting_problem(driving, Phase.fixed(0, float(guess[0]), scale), (torque,)), neutral=neutral)

    return judged(*close(first, fixed, (extra,), settle=settle))


def torque_driven_orbit(line: LineSystem, speed: float, start: Array, *, tolerance: float = TOLERANCE) -> PeriodicOrbit:
    """The periodic motion of a line whose speed follows from its torques; its last value is that speed [rad/s], guessed
    as ``speed``.

    The line is observed from a frame that turns at a mean speed Ω, in which the motion closes after 2π/Ω per turn for
    the right Ω only: unknown are the state and Ω, and the first rotation is zero at the start, which chooses one point
    of the orbit. As for any autonomous system one multiplier is 1 and is set aside.
    """
    turning = IntegratedMap(line.varied("speed"), (speed,), (BESIDE * speed,), 0.0, 1, tolerance, MOST_STEPS)
    phase = Phase.fixed(0, 0.0, np.asarray(turning.system.scale))
    problem = shooting_problem(turning, phase, (speed,), (speed / LONGEST, speed * LONGEST))
    problem.neutral = neutral_motions(line)
    return judged(problem, problem.solve(np.append(start, speed)))


def is_periodic(line: LineSystem) -> bool:
    """Whether the motion of a free line can close: a frequency in time has no fixed ratio to a speed that is free."""
    return line.period_turns is not None and not line.timed


def require_kept_speed(line: LineSystem) -> None:
    """Refuse a free line whose drives keep no speed that is asked for, or whose motion cannot close."""
    require_periodic(line)
    assembly = line.assembly
    row = assembly.table(1, line.speed)
    require_balance(assembly, row)
    if loaded_by_speed(assembly):
        require_share(assembly)  # a constant torque balances at one speed only


def require_periodic(line: LineSystem) -> None:
    """Refuse a free line whose motion cannot close."""
    if not is_periodic(line):
        raise InputError(
            "is free–free and is excited in time or without a common period: its motion does not close",
            element="driveline",
            remedy="put a ConstantSpeed in front, give orders instead of frequencies, or simulate it",
        )


def neutral_motions(line: LineSystem) -> Callable[[System, Array], NeutralDisturbances]:
    """(system, state at t = 0) → the line's neutral disturbances in the frame that turns at the system's mean speed.

    A shift of the phase comes back exactly; without angled joints, loads by speed and excitation a change of the speed
    does as well.
    """
    topo, n = line.assembly.topology, line.assembly.topology.size
    turn = rigid_rotation(topo)
    others = np.zeros(line.system.size - 2 * n)  # sliders of clutches keep their deflection
    faster = np.concatenate([np.zeros(n), turn, others])
    column = line.assembly.packed.column
    columns = [column(i, key) for _, i in topo.disks for key in ("viscous_load", "quadratic_load", "drag_area")]
    loads = [place for place in columns if place >= 0]
    curved = any(rotor.loaded_by_speed and not isinstance(rotor, Loaded) for _, rotor in topo.rotors)
    unsteady = [one.columns[0] for one in line.torques]

    def at(system: System, x: Array) -> NeutralDisturbances:
        by_speed = curved or _any(line, system, loads)
        steady = not (by_speed or _nonuniform(line, system) or _any(line, system, unsteady))
        speed = system.parameters[SPEED]
        moved = np.concatenate([turn * speed, np.zeros(n), others])
        shift = system.rate_at(0.0, x, system.regime_at(0.0, x)) + moved
        if steady:
            return NeutralDisturbances(np.stack([shift, faster], axis=1))
        if by_speed:
            return NeutralDisturbances(shift[:, None])
        return NeutralDisturbances(shift[:, None], faster, partial(speed_grows, line, system, x))

    return at


def speed_grows(line: LineSystem, system: System, x: Array, tangents: Array) -> bool | None:
    """Whether a change of the mean speed of the closed motion from x does, under torques that stay as they are: a
    motion grows faster that takes the less torque the faster it is. None where that cannot be computed.

    A motion closes beside it where (Φ − I) dx + ∂P/∂Ω dΩ + ∂P/∂T dT = 0; ``tangents`` : Φ.
    """
    speed, labels = system.parameters[SPEED], line.assembly.packed.labels
    row = np.array([[system.parameters[label] for label in labels]])
    per_torque, torque = line.drive_numbers(row)[0], SMALL * torque_scale(line)

    def driven(more: float) -> System:
        return system.with_fields(numbers_of=lambda values: system.numbers + more * per_torque)

    ends = []
    for beside in (
        system.with_parameters({SPEED: speed * (1 - BESIDE)}),
        system.with_parameters({SPEED: speed * (1 + BESIDE)}),
        driven(-torque),
        driven(torque),
    ):
        run = IntegratedMap.of(beside).run(x[None])
        if run.end is not IntegrationEnd.REACHED:
            return None
        ends.append(run.final[0])
    by_speed, by_torque = (ends[1] - ends[0]) / (2 * BESIDE * speed), (ends[3] - ends[2]) / (2 * torque)
    n = len(x)
    whole = np.zeros((n + 1, n + 1))
    whole[:n, :n], whole[:n, n], whole[n, 0] = tangents - np.eye(n), by_torque * torque, 1.0
    try:
        rise = float(np.linalg.solve(whole, np.append(-by_speed, 0.0))[-1])
    except np.linalg.LinAlgError:
        return None
    return rise < 0 if np.isfinite(rise) and rise else None


def _any(line: LineSystem, system: System, places: Iterable[int]) -> bool:
    """Whether any of some numbers of the line is other than 0 in ``system``."""
    return any(system.parameters[line.assembly.packed.labels[i]] for i in places)


def _nonuniform(line: LineSystem, system: System) -> bool:
    """Whether any joint of the line is bent in ``system``."""
    table = np.array([[system.parameters[label] for label in line.assembly.packed.labels]])
    return any(law.nonuniform for law in joint_laws(line.assembly, table))


def torque_scale(line: LineSystem) -> float:
    """The torque [N m] at the input that changes the speed over a period by what counts as one in error control."""
    topo, system = line.assembly.topology, line.system
    assert system.forcing_period is not None
    co = line.untwisted(line.assembly.table(1, line.speed))
    inertia = float(co.inertia[0] @ topo.mean_speeds**2)
    return float(np.asarray(system.scale)[topo.size]) * inertia / float(system.forcing_period)
