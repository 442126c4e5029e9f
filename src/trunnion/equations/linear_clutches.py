"""Clutches in linear equations: the spring and damper that each is on average at the motion it states.

Linear equations have no dry friction. Where a clutch states ``linear_amplitude`` and ``linear_frequency`` it stands
for its mean stiffness and loss over that swing, about the twist at which its spring carries the static torque.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.clutches import Clutch
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import Element
from trunnion.equations.loads import mean_load, static_torque, station_loads
from trunnion.equations.stage_laws import spring_damping, stage_law
from trunnion.errors import InputError
from trunnion.laws import friction

if TYPE_CHECKING:
    from trunnion.equations.coefficients import Assembly


@dataclass(frozen=True)
class MeanClutch:
    """What stands for a clutch, (case,) each: middle [rad] of the swing, stiffness [N m/rad], damping [N m s/rad]."""

    middle: Array
    stiffness: Array
    damping: Array


def states_a_motion(element: Element) -> bool:
    """Whether it is a clutch that states the motion at which linear equations take it."""
    return isinstance(element, Clutch) and element.linear_amplitude is not None


def mean_by_load(line: Driveline) -> bool:
    """Whether the mean of a clutch that states a motion depends on the torque that it carries: it has stages."""
    return any(isinstance(e, Clutch) and states_a_motion(e) and e.breakpoints for e in line.elements)


def mean_clutch(
    assembly: Assembly, table: Array, place: int, torque: Array, viscous: Array | None = None
) -> MeanClutch:
    """The clutch at ``place`` on average under a static ``torque`` (case,) [N m], at the rows of ``table``.

    ``viscous`` : damping (case,) of its spring, by default that of its description.

    Raises
    ------
    InputError : no stage of its spring carries the torque.
    """
    column, clutch = assembly.packed.column, assembly.line.elements[place]
    assert isinstance(clutch, Clutch)
    law = stage_law(assembly.line, place, column, table)
    amplitude, frequency = (_positive(assembly, table, place, key) for key in ("amplitude", "frequency"))
    middle = friction.middle_under(law, torque, amplitude)
    if np.isnan(middle).any():
        raise InputError(
            f"has no stage that carries its load of {float(torque[np.isnan(middle)][0]):g} N·m", element=law.name,
            remedy="raise its outermost stiffness",
        )  # fmt: skip
    stiffness = friction.over_a_cycle(law, middle, amplitude)[1]
    lost = np.zeros(len(table))
    for i in range(1, len(clutch.friction) + 1):
        holds, spring = (table[:, column(place, f"friction {i} {key}")] for key in ("torque", "stiffness"))
        stiffness = stiffness + friction.mean_stiffness(holds, spring, amplitude)
        lost += friction.lost_per_cycle(holds, spring, amplitude)
    damping = spring_damping(clutch, place, column, table) if viscous is None else viscous
    if not law.softest_damped:
        acts = np.arange(law.slopes.shape[1]) != np.argmin(law.slopes, axis=1)[:, None]
        damping = damping * friction.damped_share(law, acts, middle, amplitude)
    return MeanClutch(middle, stiffness, damping + lost / (np.pi * amplitude**2 * frequency))


def _positive(assembly: Assembly, table: Array, place: int, key: str) -> Array:
    numbers = table[:, assembly.packed.column(place, f"linear_{key}")]
    if not np.all(numbers > 0):
        name = assembly.line.names[place]
        raise InputError("must be positive", element=name, key=f"linear_{key}", value=float(numbers.min()))
    return np.asarray(numbers)


def with_mean_clutches(assembly: Assembly, speed: float) -> Driveline:
    """The line with a Shaft in the place of every clutch that states a motion, as at input ``speed`` [rad/s].

    Raises
    ------
    InputError : a line with a common damping ratio, which leaves no room for the loss of the clutch.
    """
    line = assembly.line
    rubbing = [name for name, element in zip(line.names, line.elements, strict=True) if states_a_motion(element)]
    if not rubbing:
        return line
    if line.damping_ratio is not None:
        raise InputError(
            "has a loss of its own beside the line's damping_ratio, which the own motion of a free bent line does not "
            "tell apart",
            element=rubbing[0],
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
    static = static_torque(topo, mean_load(topo, station_loads(topo, assembly.packed.column, table), table[:, 0]))
    return {i: float(static[0, e]) for e, compliance in enumerate(topo.compliances) for i in compliance.shafts}


def stand_ins(line: Driveline) -> tuple[str, ...]:
    """One sentence for every clutch that linear equations take at the motion it states."""
    from trunnion.equations.coefficients import assemble

    if not any(states_a_motion(element) for element in line.elements):
        return ()
    assembly = assemble(line)
    speed = line.operation.speed if line.operation and line.operation.speed else 0.0
    torque = static_torques(assembly, speed)
    found = []
    for place, (name, element) in enumerate(zip(line.names, line.elements, strict=True)):
        if isinstance(element, Clutch) and element.linear_amplitude and element.linear_frequency:
            shaft = element.linear(torque=torque[place])
            swing, hertz = np.rad2deg(element.linear_amplitude), element.linear_frequency / (2 * np.pi)
            found.append(
                f"{name} rubs and stands for a shaft of {shaft.stiffness:.4g} N·m/rad and {shaft.damping:.3g} "
                f"N·m·s/rad, its mean over a swing of ± {swing:.3g} deg at {hertz:.3g} Hz; tn.linearity_check tells "
                "how far that holds"
            )
    return tuple(found)
