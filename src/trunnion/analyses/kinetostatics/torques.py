"""Torques over a turn, from the loads back to the drive.

The cross is massless and its bearings pass no moment along their pins (but friction), so the moment it passes
on is m = λn along its normal. With n·e₁ = cos β/√D on the input axis and n·e₂ = √D on the output axis
(D = 1 − sin²β cos²χ), M₁/M₂ = cos β/D = η: the balance of power. Friction in the pins adds Aa + Bb (see
``friction``), with which, for power going from input to output (σ = 1) or back (σ = −1),

    M₁/M₂ = (cos β + σκ′ sin β |sin χ|) / (D − σκ′ sin β |cos χ| √D).

A transmitted torque is positive where it drives the line behind it in the sense of positive rotation; it is
minus the shaft's torque as the dynamics count it (positive with the twist).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from trunnion.analyses.kinetostatics.chain import Chain, Link, Step
from trunnion.analyses.kinetostatics.motion import Motion
from trunnion.errors import InputError
from trunnion.laws import hooke
from trunnion.numerics import jets

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Torques:
    """Jets of transmitted torque [N m]: ``into[i]`` at the front of step i, ``out[i]`` behind it.

    ``spring[i]`` is what the Shaft of step i twists under (its ends differ where the tube has inertia).
    """

    into: list[Array]
    out: list[Array]
    spring: dict[int, Array]


def torques(
    chain: Chain,
    motion: Motion,
    order: int,
    *,
    output_torque: Mapping[int, float] | None = None,
    pin_moment: float = 0.0,
    speeds: list[Array] | None = None,
    inertial: list[Array] | None = None,
) -> Torques:
    """Torques of the loads, and of the inertias where their accelerations are given.

    Parameters
    ----------
    order : of the jets of torque; those of ``motion`` must be at least as high.
    output_torque : [N m] by step at the end of a branch, beside the Disks' own loads; positive resists rotation.
    pin_moment : κ′ of the crosses.
    speeds : jet of the speed of every station [rad/s], for the loads that grow with it.
    inertial : jet of the acceleration of every station [rad/s²].
    """
    zero = np.zeros_like(motion.angle[0][: order + 1])
    out: list[Array] = [zero.copy() for _ in chain.steps]
    for end, asked in (output_torque or {}).items():
        out[end][0] += np.sign(chain.mean_ratio(end)) * asked
    into, spring = [zero] * len(chain.steps), {}
    for i in range(len(chain.steps) - 1, -1, -1):
        step = chain.steps[i]
        torque = out[i]
        if step.link is Link.RIGID:
            sense = float(np.sign(chain.mean_ratio(i)))
            torque = torque + jets.constant(sense * step.load, torque)
            if speeds is not None:
                torque = torque + _speed_load(step, speeds[i][: order + 1], sense)
        if inertial is not None and step.far_inertia:
            torque = torque + step.far_inertia * inertial[i][: order + 1]
        if step.link is Link.SHAFT:
            spring[i] = torque
            if inertial is not None and step.near_inertia:
                torque = torque + step.near_inertia * inertial[step.parent][: order + 1]
        elif step.link is Link.HOOKE:
            power = np.sign(torque[0]) * np.sign(chain.mean_ratio(i))
            factor = _hooke_factor(step, motion.chi[i][: order + 1], power * pin_moment)
            torque = jets.multiply(torque, factor)
        elif step.link is Link.RIPPLE and step.law is not None:
            torque = jets.multiply(torque, step.law.ratio_jet(motion.chi[i][: order + 1]))
        elif step.link is Link.RATIO:
            torque = torque / step.ratio
        into[i] = torque
        if step.parent >= 0:
            out[step.parent] = out[step.parent] + torque
    return Torques(into, out, spring)


def _speed_load(step: Step, speed: Array, sense: float) -> Array:
    """Jet of cω + qω|ω|; joints below 90° never turn the sense of rotation."""
    return step.viscous_load * speed + sense * step.quadratic_load * jets.multiply(speed, speed)


def refuse_locking(chain: Chain, pin_moment: float) -> None:
    """A cross whose pin friction exceeds what its angle lets through would not turn."""
    for step in chain.steps:
        if step.link is Link.HOOKE and pin_moment * abs(np.tan(step.angle)) >= 1:
            raise InputError(
                f"locks under this friction (pin friction {pin_moment:.3g} of the moment it passes)",
                element=step.name,
                key="angle",
                value=step.angle,
                remedy="check coefficient, pin_radius and arm",
            )


def _hooke_factor(step: Step, chi: Array, pin_moment: Array) -> Array:
    """M₁/M₂ as a jet; ``pin_moment`` is σκ′ at each angle."""
    d, sine, cosine = hooke.law(step.angle).denominator_jet(chi)
    straight = jets.constant(np.cos(step.angle), d)
    if not np.any(pin_moment):
        return jets.divide(straight, d)
    bent = pin_moment * np.sin(abs(step.angle))
    above = straight + bent * np.sign(sine[0]) * sine
    below = d - bent * np.sign(cosine[0]) * jets.multiply(cosine, jets.square_root(d))
    return jets.divide(above, below)
