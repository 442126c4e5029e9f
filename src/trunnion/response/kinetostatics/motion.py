"""Rotation of every station over the input angle: exact kinematics, by the walk of ``equations.kinematics``.

Each station carries the angle a of its fork (fork offsets included) as a jet, so that speed and
acceleration come with it. A joint takes χ = a − plane and gives a = ψ(χ) by its law; the output fork of a Hooke's
joint stands a quarter turn from its input fork. A shaft adds its fork offset and its twist; a ratio divides. These are
S2's relations (2), (3), (5) and (6) with the twist's own rate kept.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.equations import kinematics
from trunnion.equations.kinematics import Rotations, StationKinematics
from trunnion.equations.topology import LinkKind
from trunnion.laws import hooke
from trunnion.response.kinetostatics.chain import KinematicChain


@dataclass(frozen=True)
class Drive:
    """What is done to the line: input, torque [N m] by the element at an end, pin friction, whether inertias count."""

    input_angle: Array
    speed: float
    acceleration: float
    output_torque: Mapping[int, float]
    pin_moment: float
    inertia: bool

    def jet(self, order: int) -> Array:
        """Jet of the input rotation."""
        return drive_jet(self.input_angle, self.speed, self.acceleration, order)


def drive_jet(input_angle: Array, speed: float, acceleration: float, order: int) -> Array:
    """The input: at each angle [rad] it turns with ``speed`` [rad/s] and ``acceleration`` [rad/s²]."""
    jet = np.zeros((order + 1, *np.shape(input_angle)))
    jet[0] = input_angle
    if order > 0:
        jet[1] = speed
    if order > 1:
        jet[2] = acceleration / 2
    return jet


def walk(
    chain: KinematicChain,
    drive: Array,
    twist: Mapping[int, Array] | None = None,
    *,
    angle: Mapping[int, Array] | None = None,
    plane: Mapping[int, Array] | None = None,
    fork_offset: Mapping[int, Array] | None = None,
) -> Rotations:
    """Fork angles of all stations.

    Parameters
    ----------
    drive : jet of the input rotation, shape (order + 1, …).
    twist : jet of the twist of Shaft steps [rad] (far end minus near end); missing ones are rigid.
    angle, plane, fork_offset : replace the line's numbers of single steps, angles those of Hooke's joints; they
        broadcast against ``drive[0]``, so that many variants are walked at once.
    """
    angle, plane, fork_offset, twist = angle or {}, plane or {}, fork_offset or {}, twist or {}
    places = []
    for i, step in enumerate(chain.steps[1:], start=1):
        shift: list[Array] = []
        if step.link is LinkKind.SHAFT:
            shift = [np.asarray(fork_offset.get(i, step.fork_offset))]
        elif step.law is not None:
            shift = [-np.asarray(plane.get(i, step.plane))]
        if i in twist:
            shift = [shift[0] + twist[i][0], *twist[i][1:]]
        law = hooke.law(angle[i]) if i in angle else step.law
        places.append(StationKinematics(step.parent, shift, law, step.ratio))
    return kinematics.walk(places, list(drive))


def assembled(chain: KinematicChain) -> list[float]:
    """Fork angle [rad] of every station of the unloaded line at input angle 0: where rotations count from."""
    return [float(a[0]) for a in walk(chain, np.zeros(1)).angle]
