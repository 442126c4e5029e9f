"""What a passage begins with: two rising speeds, torques that last, a line that nothing prescribes the speed of."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from trunnion.driveline.applied_torque import AppliedTorque, FrictionTorque
from trunnion.driveline.arguments import one_speed, speeds_of
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.scenarios import Scenario
from trunnion.equations.coefficients import Assembly
from trunnion.equations.line_system import LineSystem
from trunnion.errors import InputError
from trunnion.motion.transients.prepare import Actions, actions_of, prepared_line


def ends_of(speeds: Sequence[float | str]) -> tuple[float, float]:
    """First and last speed [rad/s].

    Raises
    ------
    InputError : they are not two, or do not rise.
    """
    ends = [one_speed(one, "speeds") for one in speeds] if len(speeds) == 2 else speeds_of(speeds).tolist()
    if len(ends) != 2 or not np.all(np.isfinite(ends)) or not 0 <= ends[0] < ends[1]:
        remedy = '("0 rpm", "1500 rpm"), say'
        raise InputError("must be two rising speeds", key="speeds", value=list(speeds), remedy=remedy)
    return float(ends[0]), float(ends[1])


def lasting(
    line: Driveline | Assembly,
    torque: Sequence[AppliedTorque],
    friction: Sequence[FrictionTorque],
    scenario: Scenario | str | None = None,
) -> Actions:
    """What acts, or what does in a scenario, tables lasting beyond their ends.

    Raises
    ------
    InputError : a scenario that is not there, or beside torques; a formula or a function of time without an end.
    """
    if scenario is not None:
        description = line.line if isinstance(line, Assembly) else line
        stated = description.scenario(scenario) if isinstance(scenario, str) else scenario
        if torque or friction:
            problem = "already says what acts"
            raise InputError(problem, key="scenario", value=stated.name, remedy="leave out torque and friction, or it")
        torque, friction = stated.torques, stated.frictions
    for one in torque:
        if one.by_program and "time" in one.depends and one.until is None:
            raise InputError(
                "goes on changing with time, so that nothing settles", element=f"torque on {one.on}", key="until",
                remedy="say until when it acts, or let it depend on speed and angle alone",
            )  # fmt: skip
    return actions_of([one.but(hold=True) for one in torque], friction, ())


def begun_line(line: Driveline, asked: Actions, first: float) -> tuple[LineSystem, Actions]:
    """The line, ready to be followed from its ``first`` speed [rad/s], and all that acts on it.

    Raises
    ------
    InputError : a ConstantSpeed; no torque, neither given nor of a machine; what ``transient`` refuses.
    """
    prepared, acting = prepared_line(line, asked, first)
    if not prepared.assembly.topology.free:
        raise InputError(
            "prescribes the speed, so that nothing can capture the line", element="driveline", key="ConstantSpeed",
            remedy="leave it out, and put a Disk of the drive's inertia in its place",
        )  # fmt: skip
    if not acting[0]:
        raise InputError(
            "is missing", key="torque", remedy='give tn.AppliedTorque(on="motor", …), or a Motor in the line'
        )
    return prepared, acting
