"""The angles of the cardan literature (S2 and its series): α_i, ν_ij, β_ij, and what they are here.

α_i is the bend of joint i; of the shaft ij between joints i and j, ν_ij is the angle between its two forks
and β_ij the angle between the two joint planes. Both are counted against the sense of rotation, so that its
relation (2), φ⁰_j1 = β_ij + φ⁰_i2 − ν_ij − 90°, is χ_j = ψ_i + 90° + fork_offset − plane (mod 180°) with

    fork_offset = −ν_ij,    plane = −β_ij.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from numbers import Real
from typing import Any

import numpy as np

from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import Disk
from trunnion.driveline.joints import HookeJoint
from trunnion.driveline.layout import jointed
from trunnion.driveline.quantities import ANGLE, STIFFNESS, TORQUE, QuantityKind, parse
from trunnion.driveline.shafts import Shaft
from trunnion.errors import InputError

Angles = Sequence[float | str]
RIGID = 1e3
"""Stiffness of the end shafts over that of the stiffest one between the joints."""


def cardan_line(
    alpha: Angles,
    nu: Angles,
    beta: Angles,
    *,
    start: float | str = 0.0,
    stiffness: Sequence[float | str] | float | str = 1e6,
    load_torque: float | str = 0.0,
    name: str | None = None,
) -> Driveline:
    """A driveline from S2's angles [rad, or text with a unit].

    Parameters
    ----------
    alpha : α_i of every joint.
    nu, beta : ν_ij and β_ij of every shaft between two joints, one fewer than joints.
    start : φ⁰ of joint 1, the angle of its input fork from its plane at input angle 0.
    stiffness : c_ij of the shafts between the joints [N m/rad], one for each or one for all.
    load_torque : at the output [N m].
    name : of the line; none by default.

    Examples
    --------
    >>> import trunnion as tn
    >>> line = tn.cardan_line(["10 deg", "10 deg"], nu=["90 deg"], beta=["0 deg"])
    >>> line.names[2:5], round(line.elements[4].angle, 4)
    (('HookeJoint 1', 'intermediate shaft 1', 'HookeJoint 2'), 0.1745)
    """
    n = len(_numbers(alpha, "alpha"))
    if not n:
        raise InputError("has no joint", key="alpha", remedy='write alpha=["12 deg", "12 deg"], say')
    turned, inclined = _one_per_shaft(nu, "nu", n), _one_per_shaft(beta, "beta", n)
    one = isinstance(stiffness, str | Real)
    c = _one_per_shaft([stiffness] * (n - 1) if one else stiffness, "stiffness", n, STIFFNESS)
    given: Sequence[Any] = alpha  # as written, so that a refusal shows "95 deg"
    first, load = _numbers([start], "start")[0], _numbers([load_torque], "load_torque", TORQUE)[0]
    rigid = RIGID * max(c, default=1.0)
    planes = [0.0, *(-angle for angle in inclined)]
    joints = [HookeJoint(angle=angle, plane=plane) for angle, plane in zip(given, planes, strict=True)]
    shafts = [
        Shaft(stiffness=rigid, fork_offset=first, name="input shaft"),
        *(Shaft(stiffness=c[i], fork_offset=-turned[i], name=f"intermediate shaft {i + 1}") for i in range(n - 1)),
        Shaft(stiffness=rigid, name="output shaft"),
    ]
    return jointed(joints, shafts, Disk(inertia=1.0, load_torque=load), name)


def _one_per_shaft(values: object, key: str, joints: int, kind: QuantityKind = ANGLE) -> list[float]:
    found = _numbers(values, key, kind)
    if len(found) != joints - 1:
        raise InputError(
            f"must have one value fewer than the {joints} joints, and has {len(found)}",
            key=key,
            value=found,
            remedy=f"give {joints - 1}",
        )
    return found


def _numbers(values: Any, key: str, kind: QuantityKind = ANGLE) -> list[float]:
    if isinstance(values, str | Mapping) or not np.iterable(values):
        raise InputError("is not a list", key=key, value=values, remedy=f'write {key}=["{kind.example}"], say')
    try:
        return [parse(value, kind) for value in values]
    except InputError as error:
        raise error.but(key=key) from None
