"""Secondary couples: what a joint's moment does to its forks beside turning them.

The cross passes m = λn + Aa + Bb (n its normal, a and b its pin axes, A and B friction; see ``torques``). The
input shaft feels −m and the output shaft +m; what is not along the shaft's axis bends it. In each shaft's
*rotating* frame (its fork arm, axis × arm):

    input fork    (−A,  λ sin β sin χ/√D − B cos β/√D)   → M₁ tan β sin χ without friction
    output fork   ( B,  λ sin β cos χ − A √D)            → M₂ tan β cos ψ without friction

which is S2's (4). In the *standing* frame (u in the joint plane toward the side the line bends to, v = axis
× u normal to it) the input fork's arm stands at χ from u and the output fork's at ψ + 90°, so that each
couple is a steady part −½ M tan β along u plus one of the same size that turns with the shaft at twice its
speed. A constant-velocity joint passes its moment along the bisector of the two axes: −M tan(β/2) along u
on both shafts, steady. (A tripod does so on average; ±0.3 % at 9°, ±0.5 % at 20°, three times a turn.)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.equations.kinematics import Rotations
from trunnion.laws.hooke import QUARTER_TURN
from trunnion.response.kinetostatics.chain import KinematicChain
from trunnion.response.kinetostatics.torques import Torques


@dataclass(frozen=True)
class Couples:
    """Couple on each fork [N m], input and output fork of each joint in turn.

    ``standing`` and ``rotating`` have shape (fork, 2, point); ``member[f]`` is the shaft fork f belongs to;
    ``friction_power`` (point,) is what the pins of all crosses turn into heat [W].
    """

    names: tuple[str, ...]
    member: tuple[int, ...]
    standing: Array
    rotating: Array
    friction_power: Array


def secondary_couples(chain: KinematicChain, motion: Rotations, passed: Torques, pin_moment: float) -> Couples:
    """Couples on all forks of the line."""
    points = len(motion.angle[0][0])
    names, member, standing, rotating, heat = [], [], [], [], np.zeros(points)
    for i in chain.joints:
        step = chain.steps[i]
        chi, behind = motion.chi[i][0], motion.angle[i][0]
        names += [f"{step.name} in", f"{step.name} out"]
        member += [chain.steps[step.parent].member, step.member]
        if step.cross:
            speeds = motion.angle[step.parent][1], motion.angle[i][1]
            on_input, on_output, lost = _cross(step.angle, chi, passed.out[i][0], speeds, pin_moment)
            heat = heat + lost
            rotating += [on_input, on_output]
            standing += [turned(on_input, chi), turned(on_output, motion.passed[i][0] + QUARTER_TURN)]
        else:
            steady = np.zeros((2, 2, points))
            steady[0, 0], steady[1, 0] = passed.into[i][0], passed.out[i][0]
            steady *= -np.tan(step.angle / 2)
            standing += [steady[0], steady[1]]
            rotating += [turned(steady[0], -chi), turned(steady[1], -behind)]
    shape = (len(names), 2, points)
    return Couples(tuple(names), tuple(member), np.reshape(standing, shape), np.reshape(rotating, shape), heat)


def cross_tilts(chain: KinematicChain, motion: Rotations) -> Array:
    """Tilt [rad] of the cross in every fork (fork, point), in the order of ``Couples``; NaN where there is no cross.

    In each fork the other fork's pins tip out of the plane square to the shaft, with a at the input, b at the output:

        input fork   sin θ₁ = b·e₁,  tan θ₁ = tan β sin χ        output fork   sin θ₂ = a·e₂ = sin β cos χ

    which is S2's (4).
    """
    tilts = []
    for i in chain.joints:
        step, chi = chain.steps[i], motion.chi[i][0]
        if step.cross:
            tilts += [np.arctan(np.tan(step.angle) * np.sin(chi)), np.arcsin(np.sin(step.angle) * np.cos(chi))]
        else:
            tilts += [np.full(len(chi), np.nan)] * 2
    return np.reshape(tilts, (len(tilts), len(motion.angle[0][0])))


def _cross(
    angle: float, chi: Array, torque_out: Array, speeds: tuple[Array, Array], pin_moment: float
) -> tuple[Array, Array, Array]:
    """Couples on both forks of a cross in their rotating frames, and the heat of its pins.

    From the torque M₂ it passes on and the speeds of its two shafts. The cross swings in its input fork with
    ω₂ sin β cos χ and in its output fork with ω₁ sin β sin χ/√D.
    """
    sine, cosine = np.sin(angle) * np.sin(chi), np.sin(angle) * np.cos(chi)
    root = np.sqrt(1 - cosine**2)
    swing_a, swing_b = speeds[1] * cosine, speeds[0] * sine / root
    along_normal = torque_out / (root - pin_moment * np.sign(torque_out * swing_a) * cosine)
    friction = pin_moment * np.abs(along_normal)
    friction_a, friction_b = -friction * np.sign(swing_a), friction * np.sign(swing_b)
    on_input = (-friction_a, (along_normal * sine - friction_b * np.cos(angle)) / root)
    on_output = (friction_b, along_normal * cosine - friction_a * root)
    return np.stack(on_input), np.stack(on_output), friction * (np.abs(swing_a) + np.abs(swing_b))


def turned(vector: Array, by: Array) -> Array:
    """Components (2, point) in a frame, given those in one that stands ``by`` [rad] further round."""
    c, s = np.cos(by), np.sin(by)
    return np.stack([c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]])
