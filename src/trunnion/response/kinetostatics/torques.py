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

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.equations.kinematics import Rotations
from trunnion.equations.topology import LinkKind
from trunnion.errors import InputError
from trunnion.laws.joint import through
from trunnion.numerics import jets
from trunnion.response.kinetostatics.chain import ChainStep, KinematicChain
from trunnion.response.kinetostatics.motion import Drive


@dataclass(frozen=True)
class Torques:
    """Jets of transmitted torque [N m]: ``into[i]`` at the front of step i, ``out[i]`` behind it, where all that sits
    there is driven. A Shaft twists under its ``out``."""

    into: list[Array]
    out: list[Array]


def torques(chain: KinematicChain, drive: Drive, motion: Rotations, order: int, rigid: Rotations) -> Torques:
    """Torques of the loads, and of the inertias where they count.

    Parameters
    ----------
    order : of the jets of torque; those of ``motion`` must be at least as high.
    rigid : rotations of the rigid line, for inertias and loads that grow with the speed; by ``rates_needed`` higher.
    """
    size = order + 1
    zero = np.zeros((size, len(drive.input_angle)))
    out: list[Array] = [zero.copy() for _ in chain.steps]
    for end, asked in drive.output_torque.items():
        station = chain.behind[end]
        out[station][0] += np.sign(float(chain.steps[station].speed)) * asked
    into = [zero] * len(chain.steps)
    for i in range(len(chain.steps) - 1, -1, -1):
        step, parent = chain.steps[i], chain.steps[i].parent
        torque = out[i]
        sense = float(np.sign(float(step.speed)))
        if step.load:
            torque = torque + jets.constant(sense * step.load, torque)
        if _grows(step):
            torque = torque + _speed_load(step, jets.rate(rigid.jet(i))[:size], sense)
        if drive.inertia and step.inertia:
            torque = torque + step.inertia * _acceleration(rigid, i)[:size]
        out[i] = torque
        if step.cross and drive.pin_moment:
            power = np.sign(torque[0]) * sense
            torque = jets.multiply(
                torque, _with_friction(step, np.stack(motion.chi[i][:size]), power * drive.pin_moment)
            )
        elif step.orders:
            torque = jets.multiply(torque, np.stack(through(motion.passed[i][1:], motion.chi[i][:size])))
        elif step.link is LinkKind.RATIO:
            forward, back = step.lost
            torque = torque * np.where(torque[0] * sense > 0, 1 + forward, 1 - back) / step.ratio
        into[i] = torque
        if parent >= 0:
            out[parent] = out[parent] + torque
    return Torques(into, out)


def rates_needed(chain: KinematicChain, drive: Drive) -> int:
    """Order of the derivatives of the rotations that the torques depend on."""
    return 2 if drive.inertia else int(any(_grows(step) for step in chain.steps))


def _grows(step: ChainStep) -> bool:
    """Whether a load grows with the speed."""
    return step.viscous_load != 0 or step.quadratic_load != 0


def _acceleration(rotations: Rotations, station: int) -> Array:
    return jets.rate(jets.rate(rotations.jet(station)))


def _speed_load(step: ChainStep, speed: Array, sense: float) -> Array:
    """Jet of cω + qω|ω|; joints below 90° never turn the sense of rotation."""
    return step.viscous_load * speed + sense * step.quadratic_load * jets.multiply(speed, speed)


def refuse_locking(chain: KinematicChain, pin_moment: float) -> None:
    """A cross whose pin friction exceeds what its angle lets through would not turn."""
    for step in chain.steps:
        if step.cross and pin_moment * abs(np.tan(step.angle)) >= 1:
            raise InputError(
                f"locks under this friction (pin friction {pin_moment:.3g} of the moment it passes)",
                element=step.name,
                key="angle",
                value=step.angle,
                remedy="check coefficient, pin_radius and arm",
            )


def _with_friction(step: ChainStep, chi: Array, pin_moment: Array) -> Array:
    """M₁/M₂ as a jet; ``pin_moment`` is σκ′ at each angle."""
    sine, cosine = jets.sine_cosine(chi)
    d = -(np.sin(step.angle) ** 2) * jets.multiply(cosine, cosine)
    d[0] += 1.0
    bent = pin_moment * np.sin(abs(step.angle))
    above = jets.constant(np.cos(step.angle), d) + bent * np.sign(sine[0]) * sine
    below = d - bent * np.sign(cosine[0]) * jets.multiply(cosine, jets.square_root(d))
    return jets.divide(above, below)
