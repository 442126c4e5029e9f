"""Double-Cardan joint: two crosses on a common centre yoke, its two inner forks in line.

A centring device keeps the yoke in the plane of symmetry, so that both crosses bend by half the angle β and
the joint passes rotation unchanged. Without one the yoke points from one cross centre to the other: with the
centres at distances a and b from the point where the two axes meet, the sine rule in that triangle gives

    sin β₁ / b = sin β₂ / a,    β₁ + β₂ = β,

so β₁ = β₂ only for a = b. What remains is a pair of unequal Hooke's joints, ψ = atan(tan χ · cos β₂ / cos
β₁). Angles in rad, measured from the joint plane (χ = 0: input fork in it); all functions broadcast.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.laws.hooke import CrossLaw


def halves(angle: ArrayLike, distance_ratio: ArrayLike = 1.0) -> tuple[Array, Array]:
    """β₁, β₂ [rad] for a bend β and ``distance_ratio`` a/b: first centre's distance over the second's [-].

    From the sine rule tan β₁ = sin β/(a/b + cos β); a/b = 1 gives the centred joint's halves.
    """
    angle, distance_ratio = np.asarray(angle, dtype=float), np.asarray(distance_ratio, dtype=float)
    first = np.arctan2(np.sin(angle), distance_ratio + np.cos(angle))
    return first, angle - first


def law(angle: ArrayLike, distance_ratio: ArrayLike = 1.0) -> CrossLaw:
    """Both crosses bent in one plane, as one: tan ψ = tan χ · cos β₂/cos β₁.

    The second cross sees the yoke a quarter turn later, so it takes back what the first has added. Its
    t = (cos β₂ − cos β₁)/(cos β₂ + cos β₁) = tan(β/2) tan((β₁ − β₂)/2); the two quarter turns of the forks are taken
    back, so that the joint counts as one that passes rotation unchanged.
    """
    first, second = halves(angle, distance_ratio)
    return CrossLaw(np.tan(np.asarray(angle) / 2) * np.tan((first - second) / 2), turned=0.0)
