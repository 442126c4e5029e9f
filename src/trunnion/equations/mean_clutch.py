"""The spring and damper that a clutch is on average at the motion it states."""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.clutches import Clutch
from trunnion.driveline.elements import Element
from trunnion.driveline.parameters import PackedLine
from trunnion.equations.stage_laws import SLIPS, stage_law
from trunnion.errors import InputError
from trunnion.laws import friction


def states_a_motion(element: Element) -> bool:
    """Whether it is a clutch that states the motion at which linear equations take it."""
    return isinstance(element, Clutch) and element.linear_amplitude is not None


def mean_clutch(
    packed: PackedLine, table: Array, place: int, torque: Array, viscous: Array
) -> tuple[Array, Array, Array]:
    """What stands for the clutch at ``place`` under a static ``torque`` (case,) [N m], at the rows of ``table``.

    Middle [rad] of the swing, stiffness [N m/rad] and damping [N m s/rad], (case,) each.

    ``viscous`` : damping (case,) of its spring [N m s/rad].

    Raises
    ------
    InputError : no stage of its spring carries the torque.
    """
    column, clutch = packed.column, packed.line.elements[place]
    assert isinstance(clutch, Clutch)
    law = stage_law(packed.line, place, column, table)
    amplitude, frequency = (_positive(packed, table, place, key) for key in ("amplitude", "frequency"))
    middle = friction.middle_under(law, torque, amplitude)
    if np.isnan(middle).any():
        raise InputError(
            f"has no stage that carries its load of {float(torque[np.isnan(middle)][0]):g} N m: it slips",
            element=law.name, remedy=SLIPS,
        )  # fmt: skip
    stiffness = friction.over_a_cycle(law, middle, amplitude)[1]
    lost = np.zeros(len(table))
    for i in range(1, len(clutch.friction) + 1):
        holds, spring = (table[:, column(place, f"friction {i} {key}")] for key in ("torque", "stiffness"))
        stiffness = stiffness + friction.mean_stiffness(holds, spring, amplitude)
        lost += friction.lost_per_cycle(holds, spring, amplitude)
    if not law.softest_damped:
        acts = np.arange(law.slopes.shape[1]) != np.argmin(law.slopes, axis=1)[:, None]
        viscous = viscous * friction.damped_share(law, acts, middle, amplitude)
    return middle, stiffness, viscous + lost / (np.pi * amplitude**2 * frequency)


def _positive(packed: PackedLine, table: Array, place: int, key: str) -> Array:
    numbers = table[:, packed.column(place, f"linear_{key}")]
    if not np.all(numbers > 0):
        name = packed.line.names[place]
        raise InputError("must be positive", element=name, key=f"linear_{key}", value=float(numbers.min()))
    return np.asarray(numbers)
