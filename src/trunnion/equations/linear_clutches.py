"""Clutches in linear equations: the spring and damper that each is on average at the motion it states.

Linear equations have no dry friction. Where a clutch states ``linear_amplitude`` and ``linear_frequency`` it stands
for its mean stiffness and loss over that swing, about the twist at which its spring carries the static torque.
"""

from __future__ import annotations

import numpy as np

from trunnion.driveline.clutches import Clutch
from trunnion.driveline.driveline import Driveline
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.mean_clutch import states_a_motion
from trunnion.errors import InputError


def mean_by_load(line: Driveline) -> bool:
    """Whether the mean of a clutch that states a motion depends on the torque that it carries: it has stages."""
    return any(isinstance(e, Clutch) and states_a_motion(e) and e.breakpoints for e in line.elements)


def with_mean_clutches(assembly: Assembly, speed: float) -> Driveline:
    """The line with a Shaft in the place of every clutch that states a motion, as at input ``speed`` [rad/s].

    Raises
    ------
    InputError : a line with a common damping ratio, which leaves no room for the loss of the clutch.
    """
    line = assembly.line
    friction_elements = [
        name for name, element in zip(line.names, line.elements, strict=True) if states_a_motion(element)
    ]
    if not friction_elements:
        return line
    if line.damping_ratio is not None:
        raise InputError(
            "has a loss of its own beside the line's damping_ratio, which the periodic steady state of a free–free "
            "line with joint angles does not tell apart",
            element=friction_elements[0],
            key="friction",
            remedy="give the shafts damping instead",
        )
    torque = static_torques(assembly, speed)
    elements = tuple(
        element.linear(torque=torque[place]).model_copy(update={"name": element.name})
        if isinstance(element, Clutch) and states_a_motion(element)
        else element
        for place, element in enumerate(line.elements)
    )
    return line.model_copy(update={"elements": elements})


def static_torques(assembly: Assembly, speed: float) -> dict[int, float]:
    """Torque [N m] that each spring carries at a steady input ``speed``, by its place in the line."""
    table, topo = assembly.table(1, speed), assembly.topology
    static = assembly.static_torque(table)
    return {i: float(static[0, e]) for e, compliance in enumerate(topo.compliances) for i in compliance.shafts}


def stand_ins(line: Driveline) -> tuple[str, ...]:
    """One sentence for every clutch that linear equations take at the motion it states."""
    if not any(states_a_motion(element) for element in line.elements):
        return ()
    assembly = assemble(line)
    speed = line.operation.speed if line.operation and line.operation.speed else 0.0
    torque = static_torques(assembly, speed)
    found = []
    for place, (name, element) in enumerate(zip(line.names, line.elements, strict=True)):
        if isinstance(element, Clutch) and element.linear_amplitude and element.linear_frequency:
            stiffness, damping, _ = element.mean(torque=torque[place])
            swing, hertz = np.rad2deg(element.linear_amplitude), element.linear_frequency / (2 * np.pi)
            found.append(
                f"{name} rubs and stands for a shaft of {stiffness:.4g} N m/rad and {damping:.3g} "
                f"N m s/rad, its mean over a swing of ± {swing:.3g} deg at {hertz:.3g} Hz; tn.linearity_check tells "
                "how far that holds"
            )
    return tuple(found)
