"""``transient``: what happens when torques act on a line over time, speed or angle, from any speed or from rest."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from trunnion.driveline.applied_torque import AppliedTorque, FrictionTorque
from trunnion.driveline.arguments import one_number, one_speed
from trunnion.driveline.brakes import Brake
from trunnion.driveline.disturbances import Disturbance
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import Rotor
from trunnion.driveline.operating_speed import operating_speed
from trunnion.driveline.scenarios import LevelCrossing, Scenario
from trunnion.driveline.vehicle import Vehicle
from trunnion.equations.coefficients import Assembly
from trunnion.equations.line_system import LineSystem, line_system
from trunnion.equations.steady_base import imbalance
from trunnion.errors import InputError
from trunnion.motion.simulation.simulate import positive_time
from trunnion.motion.transients.engines import on_throws
from trunnion.motion.transients.place import Place
from trunnion.motion.transients.prepare import Actions, actions_of, follow, prepared_line, refuse_others, require_begun
from trunnion.motion.transients.result import Transient
from trunnion.numerics.integration.integration import MOST_STEPS, TOLERANCE
from trunnion.waiting import keeps_time


@keeps_time
def transient(
    line: Driveline | Assembly,
    duration: float | Scenario | str | None = None,
    *,
    torque: Sequence[AppliedTorque] = (),
    friction: Sequence[FrictionTorque] = (),
    disturbance: Sequence[Disturbance] = (),
    crossing: Sequence[LevelCrossing] = (),
    speed: float | str | None = None,
    phase: float = 0.0,
    start: ArrayLike | None = None,
    tolerance: float = TOLERANCE,
    most_steps: int = MOST_STEPS,
    within: float | None = None,
    progress: Callable[[float], None] | None = None,
) -> Transient:
    """Follow a line while torques act on its disks: starts, blows, faults, brakes.

    Parameters
    ----------
    line : a ``Driveline`` (or its ``Assembly``).
    duration : [s]; or a ``Scenario``, or the name of one of the line's, which says all that follows.
    torque : what acts over time, speed or angle; several on one disk add up, and come to what the description puts
        there. A disk with a drive_share that is given a torque is driven by that instead.
    friction : dry friction that resists disks and keeps them at rest.
    disturbance : short circuits, bites, impacts, tip-ins and brakes by name, which add to both.
    crossing : levels that are watched; the run ends at the first that ``ends``.
    speed : of the input when it begins [rad/s], by default the file's operating speed; 0 is standstill and negative
        turns backwards. Drives with a share go on giving what balances the loads at that speed, which must not be
        negative then.
    phase : angle [rad] of the input when it begins.
    start : initial state (2n,): deviations [rad] from uniform rotation at t = 0 and their rates [rad/s]; by default
        turning evenly, twisted by the loads where they balance, and without twist elsewhere.
    tolerance : error allowed per step.
    most_steps : steps after which the run ends.
    within : seconds of computing after which it ends with what it has.
    progress : called as progress(share done); ``stop`` of a ``time_limit`` around it ends the run with what it has.

    Returns
    -------
    Transient; its ``outcome`` says how it ended, and a failure keeps what was computed.

    Raises
    ------
    InputError : no duration; a torque, friction or crossing where there is nothing for it; times beyond a table; some
        drives with a share given a torque and others not; an excitation that varies with speed; a run that ends where
        it begins, as where a torque says nothing at its first speed.

    Examples
    --------
    >>> import trunnion as tn
    >>> disks = tn.Disk(name="motor", inertia=0.5), tn.Disk(name="mill", inertia=2.0)
    >>> line = tn.Driveline([disks[0], tn.Shaft(stiffness=2e4, damping=4.0), disks[1]])
    >>> blow = tn.AppliedTorque(on="mill", time=[0, 0.1, 0.15], torque=[0, -300, 0], between="steps")
    >>> run = tn.transient(line, 0.3, torque=[blow], speed=100.0)
    >>> run.outcome.kind, round(float(run.whole.speed(0.3)[0]), 6), run.energy.error < 1e-8
    ('reached', 94.0, True)
    """
    description = line.line if isinstance(line, Assembly) else line
    name = ""
    if isinstance(duration, str):
        duration = description.scenario(duration)
    if isinstance(duration, Scenario):
        scenario = duration
        if torque or friction or crossing or disturbance:
            raise InputError("already says what acts", key="scenario", value=scenario.name, remedy="give a duration")
        duration, name = scenario.duration, scenario.name
        torque, friction, crossing = scenario.torque, scenario.friction, scenario.crossing
        disturbance = scenario.disturbance
        speed = scenario.speed if speed is None else speed
    length = positive_time(duration, "give seconds, or the name of a scenario")
    refuse_others(disturbance, Disturbance, "disturbance")
    torque = [*torque, *(made for one in disturbance for made in one.torques)]
    friction = [*friction, *(made for one in disturbance for made in one.frictions)]
    refuse_others(torque, AppliedTorque, "torque")
    refuse_others(friction, FrictionTorque, "friction")
    asked = actions_of(*on_throws(torque, friction, description.parts), crossing)
    begin = operating_speed(description, None) if speed is None else one_speed(speed, "speed")
    if not np.isfinite(begin):
        raise InputError("must be finite", key="speed", value=begin)
    prepared, acting = prepared_line(description, asked, begin)
    if not prepared.assembly.topology.free and not begin > 0:
        raise InputError(
            "is prescribed by a ConstantSpeed and must be positive", key="speed", value=begin,
            remedy="leave out the ConstantSpeed, so that the line starts by its torques",
        )  # fmt: skip
    given = {one.on for one in asked[0]}
    sharing = [name for name, e in description.parts if getattr(e, "drive_share", None) and name not in given]
    if begin < 0 and sharing:
        raise InputError(
            "gives what balances the loads in the line's sense of rotation, and not backwards", element=sharing[0],
            key="drive_share", remedy="start at a positive speed, or give the drive a torque",
        )  # fmt: skip
    angle = one_number(phase, "phase", "np.pi / 2, say")
    state = _start(prepared, _balanced(description, prepared, asked, begin), start, begin, angle)
    place = Place(0.0, state, angle=angle, speed=begin)
    found = follow(prepared, place, length, acting, tolerance, most_steps, progress=progress)
    require_begun(found.outcome, found.pieces)
    return Transient.of(prepared, found, asked, tolerance, 0.0, name, description)


def _balanced(line: Driveline, prepared: LineSystem, asked: Actions, speed: float) -> LineSystem:
    """The line with what balances its loads at the start: its machines by their curves, unless a torque on any of them
    adds to that."""
    given = {one.on for one in asked[0]}
    machines = {name for name, e in line.parts if isinstance(e, Rotor) and e.tangent}
    rolling = {
        name for name, e in line.parts if isinstance(e, Brake) or (isinstance(e, Vehicle) and e.rolling_resistance)
    }
    driving = {name for name, e in line.parts if getattr(e, "drive_share", None)}
    if not (machines or rolling) or speed <= 0 or (machines | driving) & given:
        return prepared
    return line_system(line, speed, leaves=True, slips=True, linearised=True)


def _start(prepared: LineSystem, balanced: LineSystem, start: ArrayLike | None, speed: float, angle: float) -> Any:
    if start is not None:
        return prepared.system.checked_start(start)
    assembly = balanced.assembly
    loaded = speed != 0 and not imbalance(assembly, assembly.table(1, abs(speed)))[0]
    state = balanced.twisted(angle) if loaded else prepared.rest(angle)
    if speed <= 0:  # joints turn backwards, or not at all
        n = assembly.topology.size
        state[n : 2 * n] *= -1.0 if speed < 0 else 0.0
    return state
