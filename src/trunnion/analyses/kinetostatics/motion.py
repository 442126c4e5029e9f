"""Rotation of every station over the input angle: exact kinematics, walked from the drive to the load.

Each station carries the angle a of its fork (fork offsets included) as a jet, so that speed and
acceleration come with it. A joint takes χ = a − plane and gives a = ψ(χ) by its law; the output fork of a Hooke's
joint stands a quarter turn from its input fork. A shaft adds its fork offset and its twist; a ratio divides. These are
S2's relations (2), (3), (5) and (6) with the twist's own rate kept.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from trunnion.analyses.kinetostatics.chain import JOINTS, Chain, Link, Step
from trunnion.laws import hooke
from trunnion.laws.joint import JointLaw

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Motion:
    """Jets [rad] by station: ``angle`` of the fork; at joint steps ``chi``, input angle from their plane."""

    angle: list[Array]
    chi: dict[int, Array]


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
    chain: Chain,
    drive: Array,
    twist: Mapping[int, Array] | None = None,
    *,
    angle: Mapping[int, Array] | None = None,
    plane: Mapping[int, Array] | None = None,
    fork_offset: Mapping[int, Array] | None = None,
) -> Motion:
    """Fork angles of all stations.

    Parameters
    ----------
    drive : jet of the input rotation, shape (order + 1, …).
    twist : jet of the twist of Shaft steps [rad] (far end minus near end); missing ones are rigid.
    angle, plane, fork_offset : replace the line's numbers of single steps, angles those of Hooke's joints; they
        broadcast against ``drive[0]``, so that many variants are walked at once.
    """
    angle, plane, fork_offset, twist = angle or {}, plane or {}, fork_offset or {}, twist or {}
    stations, chis = [drive], {}
    for i, step in enumerate(chain.steps[1:], start=1):
        a = stations[step.parent]
        if step.link in JOINTS:
            chis[i] = chi = _shifted(a, -np.asarray(plane.get(i, step.plane)))
            a = _joint_output(step, hooke.law(angle[i]) if i in angle else step.law, chi)
        elif step.link is Link.SHAFT:
            a = _shifted(a, np.asarray(fork_offset.get(i, step.fork_offset)))
            if i in twist:
                a = a + twist[i]
        elif step.link is Link.RATIO:
            a = a / step.ratio
        stations.append(a)
    return Motion(stations, chis)


def assembled(chain: Chain) -> list[float]:
    """Fork angle [rad] of every station of the unloaded line at input angle 0: where rotations count from."""
    return [float(a[0]) for a in walk(chain, np.zeros(1)).angle]


def _joint_output(step: Step, law: JointLaw | None, chi: Array) -> Array:
    if law is None:
        return chi
    output = law.output_jet(chi)
    output[0] += law.turned + step.fork_offset
    return output


def _shifted(a: Array, by: Array) -> Array:
    shape = np.broadcast_shapes(a.shape[1:], by.shape)
    shifted = np.array(np.broadcast_to(a, (len(a), *shape)))
    shifted[0] += by
    return shifted
