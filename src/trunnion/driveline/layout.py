"""From a drawing to a driveline: joint centres and end axes in space → joint angles, planes, fork offsets.

With e_j the direction of shaft j (from the drive to the load), joint j bends shaft j−1 into shaft j:

    cos β_j = e_{j−1}·e_j,    normal of its plane n_j = e_{j−1} × e_j / sin β_j
    ϑ_j = angle from n_{j−1} to n_j about e_{j−1}, positive in the sense of rotation

and two equal angles cancel when the fork offset of the shaft between them is ϑ (mod 180°). For a drive that
turns left-handed about e all planes and offsets change sign.

The joint-by-joint way of drawings, a vertical and a horizontal angle per joint, is ``combined_angle``; the
angles α_i, ν_ij, β_ij of the cardan literature (S2) are ``cardan_angles``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Flags
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import ConstantSpeed, Disk
from trunnion.driveline.joints import HookeJoint
from trunnion.driveline.quantities import ANGLE, DEGREE, LENGTH, QuantityKind, parse
from trunnion.driveline.shafts import Shaft
from trunnion.errors import InputError

COLLINEAR = 1e-9
"""Bend angle [rad] below which a joint has no plane of its own."""


@dataclass(frozen=True, eq=False)
class Layout:
    """Joints of a line in space.

    Attributes
    ----------
    centres : (joint, 3) joint centres [m].
    axes : (shaft, 3) unit directions of the shafts, from the drive to the load.
    angles : (joint,) bend angles β [rad].
    planes : (joint,) planes ϑ relative to the previous joint's [rad], positive in the sense of rotation; the
        first is 0. A joint without bend keeps the plane before it.
    lengths : (joint − 1,) distances between neighbouring centres [m].
    straight : (joint,) true where the two axes are in line, so that the joint's phase has no meaning.
    right_handed : whether the line turns right-handed about its axes.
    """

    centres: Array
    axes: Array
    angles: Array
    planes: Array
    lengths: Array
    straight: Flags
    right_handed: bool = True

    @property
    def homokinetic_offsets(self) -> Array:
        """Fork offset of each shaft between two joints that makes equal angles cancel [rad], (joint − 1,)."""
        return (self.planes[1:] + np.pi / 2) % np.pi - np.pi / 2

    def driveline(
        self,
        shafts: Sequence[Shaft] | None = None,
        *,
        fork_offsets: ArrayLike | None = None,
        load_torque: float = 0.0,
        inertia: float = 1.0,
    ) -> Driveline:
        """A driveline with these joints.

        Parameters
        ----------
        shafts : one more than there are joints; by default of 1e6 N m/rad (which a rigid analysis never
            sees).
        fork_offsets : of the shafts between the joints [rad]; by default the homokinetic ones. Those of
            ``shafts`` are replaced.
        load_torque, inertia : of the Disk at the end [N m, kg m²].
        """
        n = len(self.angles)
        given = list(shafts) if shafts is not None else [Shaft(stiffness=1e6) for _ in range(n + 1)]
        if len(given) != n + 1:
            raise InputError(
                f"has {len(given)} shafts for {n} joints",
                element="layout",
                key="shafts",
                remedy=f"give {n + 1}: one before, between and behind the joints",
            )
        offsets = self.homokinetic_offsets if fork_offsets is None else np.asarray(fork_offsets, dtype=float)
        if offsets.shape != (n - 1,):
            raise InputError(
                "must have one value for each shaft between two joints",
                element="layout",
                key="fork_offsets",
                value=list(offsets.ravel()),
                remedy=f"give {n - 1}",
            )
        joints = [HookeJoint(angle=float(a), plane=float(p)) for a, p in zip(self.angles, self.planes, strict=True)]
        between = [shaft.but(fork_offset=float(x)) for shaft, x in zip(given[1:-1], offsets, strict=True)]
        return jointed(joints, [given[0], *between, given[-1]], Disk(inertia=inertia, load_torque=load_torque))

    def shaft_lengths(self, line: Driveline) -> dict[str, float]:
        """Length [m] of each shaft between two joints by its name in ``line``, for ``kinetostatics``."""
        names = [n for n, e in line.parts if isinstance(e, Shaft)]
        return {name: float(length) for name, length in zip(names[1:-1], self.lengths, strict=True)}

    def __str__(self) -> str:
        rows = [f"layout of {len(self.angles)} joints"]
        for j, (beta, plane) in enumerate(zip(self.angles, self.planes, strict=True)):
            row = f"  joint {j + 1}: angle {beta / DEGREE:.4f} deg"
            if self.straight[j]:
                row += ", axes in line (its plane is that of the joint before)"
            elif j:
                row += f", plane {plane / DEGREE:.4f} deg from that of joint {j}"
            rows.append(row)
        rows += [
            f"  shaft {j + 2}: {length:.4f} m, homokinetic fork offset {offset / DEGREE:.4f} deg"
            for j, (length, offset) in enumerate(zip(self.lengths, self.homokinetic_offsets, strict=True))
        ]
        return "\n".join(rows)

    __repr__ = __str__


def jointed(joints: Sequence[HookeJoint], shafts: Sequence[Shaft], load: Disk, name: str | None = None) -> Driveline:
    """A driven line of a shaft before, between and behind its joints, and a load at its end."""
    bends = [element for pair in zip(joints, shafts[1:], strict=True) for element in pair]
    return Driveline([ConstantSpeed(), shafts[0], *bends, load], name=name)


def layout(
    points: Sequence[Sequence[float | str]] | Array,
    input_axis: Sequence[float] | Array,
    output_axis: Sequence[float] | Array,
    *,
    right_handed: bool = True,
) -> Layout:
    """Angles, planes and homokinetic fork offsets of joints in space.

    Parameters
    ----------
    points : (joint, 3) joint centres [m], from the drive to the load.
    input_axis, output_axis : (3,) directions of the first and the last shaft, *along the line*: from the
        drive toward joint 1, and from the last joint toward the load; of any length.
    right_handed : the input turns right-handed about ``input_axis`` (clockwise when looking along it).

    Raises
    ------
    InputError : coincident centres, a bend of 90° or more, an axis without direction or against the line.

    Examples
    --------
    >>> import trunnion as tn
    >>> found = tn.layout([[0, 0, 0], [1, 0, -0.1]], input_axis=[1, 0, 0], output_axis=[1, 0, 0])
    >>> print(found)
    layout of 2 joints
      joint 1: angle 5.7106 deg
      joint 2: angle 5.7106 deg, plane 180.0000 deg from that of joint 1
      shaft 2: 1.0050 m, homokinetic fork offset 0.0000 deg
    """
    centres = _centres(points)
    ends = [_direction(input_axis, "input_axis"), _direction(output_axis, "output_axis")]
    between = np.diff(centres, axis=0)
    lengths = np.linalg.norm(between, axis=1)
    size = max(float(np.max(np.abs(centres - centres[0]))), 1e-6)
    for j, length in enumerate(lengths):
        if length < 1e-9 * size:
            raise InputError(
                "lie at the same place",
                element="layout",
                key=f"points {j + 1} and {j + 2}",
                value=[float(x) for x in centres[j]],
                remedy="give every joint its own centre; a joint of two crosses is a DoubleCardanJoint",
            )
    axes = np.vstack([ends[0], between / lengths[:, None], ends[1]])
    cross = np.cross(axes[:-1], axes[1:])
    cosine = np.einsum("jk,jk->j", axes[:-1], axes[1:])
    angles = np.arctan2(np.linalg.norm(cross, axis=1), cosine)
    _bendable(angles, len(centres))
    straight = angles < COLLINEAR
    planes = _planes(axes, cross, straight)
    return Layout(centres, axes, angles, planes if right_handed else -planes, lengths, straight, right_handed)


def _planes(axes: Array, cross: Array, straight: Flags) -> Array:
    """Angle of each joint's normal from that of the last angled joint, about the shaft in front of it."""
    planes = np.zeros(len(cross))
    normal = None
    for j, product in enumerate(cross):
        if straight[j]:
            continue
        own = product / np.linalg.norm(product)
        if normal is not None:
            planes[j] = np.arctan2(axes[j] @ np.cross(normal, own), normal @ own)
        normal = own
    return planes


def _bendable(angles: Array, joints: int) -> None:
    for j, angle in enumerate(angles):
        if angle < np.pi / 2 - 1e-9:
            continue
        remedy = "no joint bends that far; check the order of the points"
        if j in (0, joints - 1) and angle > np.pi / 2 + 1e-9:
            which = "input_axis" if j == 0 else "output_axis"
            remedy = f"axes and points contradict: {which} must point from drive to load, turn its sign"
        raise InputError(
            f"bends by {angle / DEGREE:.4g} deg, and must stay below 90 deg",
            element="layout",
            key=f"joint {j + 1}",
            remedy=remedy,
        )


def _centres(points: Any) -> Array:
    remedy = "write points=[(0, 0, 0), (1.3, 0, -0.1)], one (x, y, z) in metres for each joint"
    try:
        rows = [[_coordinate(x, LENGTH, "points") for x in point] for point in points]
    except TypeError:
        raise InputError("are not points", element="layout", key="points", value=points, remedy=remedy) from None
    if not rows or any(len(row) != 3 for row in rows):
        raise InputError(
            "must have three coordinates each", element="layout", key="points", value=points, remedy=remedy
        )
    return np.array(rows)


def _direction(axis: Any, key: str) -> Array:
    remedy = "write (1, 0, 0), say"
    try:
        vector = np.array([float(x) for x in axis])
    except (TypeError, ValueError):
        raise InputError("is not a direction", element="layout", key=key, value=axis, remedy=remedy) from None
    size = float(np.linalg.norm(vector))
    if vector.shape != (3,) or not np.isfinite(size) or size == 0:
        raise InputError("has no direction", element="layout", key=key, value=list(axis), remedy=remedy)
    return vector / size


def _coordinate(value: Any, kind: QuantityKind, key: str) -> float:
    try:
        return parse(value, kind)
    except InputError as error:
        raise error.but(element="layout", key=key) from None


def combined_angle(vertical: float | str, horizontal: float | str) -> tuple[float, float]:
    """Bend angle and plane [rad] of a joint drawn by its angles in side view and plan view [rad].

    tan β = √(tan²v + tan²h); the plane is measured from the vertical toward the horizontal, the same way for
    every joint of a line, so that a joint's ``plane`` is the difference from the joint before.

    Parameters
    ----------
    vertical : angle v in side view [rad, or text with a unit].
    horizontal : angle h in plan view [rad, or text with a unit].

    Examples
    --------
    >>> import trunnion as tn
    >>> angle, plane = tn.combined_angle("3 deg", "4 deg")
    >>> round(angle, 5), round(plane, 5)
    (0.08716, 0.92764)
    """
    sides = []
    for key, value in (("vertical", vertical), ("horizontal", horizontal)):
        side = _coordinate(value, ANGLE, key)
        if not abs(side) < np.pi / 2:
            raise InputError("must be less than 90 deg", key=key, value=value, remedy='write "12 deg", say')
        sides.append(np.tan(side))
    return float(np.arctan(np.hypot(*sides))), float(np.arctan2(sides[1], sides[0]))
