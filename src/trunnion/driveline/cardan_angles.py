"""The angles of the cardan literature (S2 and its series): α_i, ν_ij, β_ij, and what they are here.

α_i is the bend of joint i; of the shaft ij between joints i and j, ν_ij is the angle between its two forks
and β_ij the angle between the two joint planes. Both are counted against the sense of rotation, so that its
relation (2), φ⁰_j1 = β_ij + φ⁰_i2 − ν_ij − 90°, is χ_j = ψ_i + 90° + fork_offset − plane (mod 180°) with

    fork_offset = −ν_ij,    plane = −β_ij.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import ConstantSpeed, Disk, Element, HookeJoint, Shaft
from trunnion.errors import InputError

RIGID = 1e3
"""Stiffness of the end shafts over that of the stiffest one between the joints."""


def cardan_line(
    alpha: Sequence[float],
    nu: Sequence[float],
    beta: Sequence[float],
    *,
    start: float = 0.0,
    stiffness: Sequence[float] | float = 1e6,
    load_torque: float = 0.0,
    name: str | None = None,
) -> Driveline:
    """A driveline from S2's angles [rad].

    Parameters
    ----------
    alpha : α_i of every joint.
    nu, beta : ν_ij and β_ij of every shaft between two joints, one fewer than joints.
    start : φ⁰ of joint 1, the angle of its input fork from its plane at input angle 0.
    stiffness : c_ij of the shafts between the joints [N m/rad], one for each or one for all.
    load_torque : at the output [N m].
    """
    n = len(alpha)
    for key, values in (("nu", nu), ("beta", beta)):
        if len(values) != n - 1:
            raise InputError(
                f"has {len(values)} values for {n} joints",
                key=key,
                value=list(values),
                remedy=f"give {n - 1}",
            )
    c = [float(stiffness)] * (n - 1) if isinstance(stiffness, int | float) else [float(k) for k in stiffness]
    if len(c) != n - 1:
        raise InputError(f"has {len(c)} values for {n} joints", key="stiffness", value=c, remedy=f"give {n - 1}")
    rigid = RIGID * max(c, default=1.0)
    elements: list[Element] = [ConstantSpeed(), Shaft(stiffness=rigid, fork_offset=start, name="input shaft")]
    for i in range(n):
        plane = -beta[i - 1] if i else 0.0
        elements.append(HookeJoint(angle=alpha[i], plane=plane))
        if i < n - 1:
            elements.append(Shaft(stiffness=c[i], fork_offset=-nu[i], name=f"intermediate shaft {i + 1}"))
    elements += [Shaft(stiffness=rigid, name="output shaft"), Disk(inertia=1.0, load_torque=load_torque)]
    return Driveline(elements, name=name)


def initial_phases(
    alpha: Sequence[float], nu: Sequence[float], beta: Sequence[float], start: float = 0.0
) -> list[float]:
    """φ⁰_i1 of every joint [rad] by S2's relation (2), unwrapped: what it starts from at input angle 0."""
    from trunnion.joints import hooke

    phases = [start]
    for a, v, b in zip(alpha[:-1], nu, beta, strict=True):
        phases.append(b + float(hooke.output_angle(phases[-1], a)) - v - pi / 2)
    return phases
