"""Rotation of every station over the input angle: exact kinematics, walked from the drive to the load.

Each station carries the angle a of its fork (fork offsets included) as a jet, so that speed and
acceleration come with it. A Hooke's joint takes χ = a − plane and gives a = ψ(χ) + 90° (its output fork
stands a quarter turn from its input fork); ψ̇ = η(χ) χ̇ is integrated term by term. A shaft adds its fork
offset and its twist; a ratio divides. These are S2's relations (2), (3), (5) and (6) with the twist's own
rate kept.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from trunnion.analyses.kinetostatics.chain import JOINTS, Chain, Link, Step
from trunnion.laws import hooke
from trunnion.numerics import jets

Array = NDArray[np.float64]
QUARTER_TURN = np.pi / 2


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
    angle, plane, fork_offset : replace the line's numbers of single steps; they broadcast against
        ``drive[0]``, so that many variants are walked at once.
    """
    angle, plane, fork_offset, twist = angle or {}, plane or {}, fork_offset or {}, twist or {}
    stations, chis = [drive], {}
    for i, step in enumerate(chain.steps[1:], start=1):
        a = stations[step.parent]
        if step.link in JOINTS:
            chis[i] = chi = _shifted(a, -np.asarray(plane.get(i, step.plane)))
            a = _joint_output(step, chi, angle.get(i, step.angle))
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


def hooke_denominator(chi: Array, angle: Array | float) -> tuple[Array, Array, Array]:
    """Jets of D = 1 − sin²β cos²χ, sin χ and cos χ."""
    sine, cosine = jets.sine_cosine(chi)
    d = -(np.sin(angle) ** 2) * jets.multiply(cosine, cosine)
    d[0] += 1.0
    return d, sine, cosine


def _joint_output(step: Step, chi: Array, angle: Array | float) -> Array:
    if step.link is Link.IDEAL:
        return chi
    if step.link is Link.TRIPOD:
        sine, _ = jets.sine_cosine(3 * chi)
        return chi + step.amplitude * sine
    start = hooke.output_angle(chi[0], angle) + QUARTER_TURN + step.fork_offset
    if len(chi) == 1:
        return start[None]
    lower = chi[:-1]
    d, _, _ = hooke_denominator(lower, angle)
    rate = jets.divide(jets.multiply(jets.constant(np.cos(angle), lower), jets.rate(chi)), d)
    return jets.integral(rate, start)


def _shifted(a: Array, by: Array) -> Array:
    shape = np.broadcast_shapes(a.shape[1:], by.shape)
    shifted = np.array(np.broadcast_to(a, (len(a), *shape)))
    shifted[0] += by
    return shifted


def tripod_ratio(step: Step, chi: Array) -> Array:
    """Jet of a tripod joint's η = 1 + 3A cos 3χ."""
    _, cosine = jets.sine_cosine(3 * chi)
    ratio = 3 * step.amplitude * cosine
    ratio[0] += 1.0
    return ratio
