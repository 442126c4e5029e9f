"""Hooke's (Cardan, universal) joint: output angle, speed ratio and their derivatives.

χ is the input angle measured from the joint plane (the plane of the two shaft axes): χ = 0 when the
input fork lies in that plane. With bend angle β and t = tan²(β/2)

    ψ = atan(tan χ / cos β)  (unwrapped)  =  χ + atan[t sin 2χ / (1 − t cos 2χ)]
    η = dψ/dχ = cos β / D,   D = 1 − sin²β cos²χ

so η runs from 1/cos β (χ = 0) to cos β (χ = 90°). Papers that start with the fork square to the plane
write sin²χ instead of cos²χ: the same joint 90° later. The second form of ψ needs no unwrapping.
The output fork stands 90° from the input fork; that quarter turn is added by the assembly of a line,
not here. All functions broadcast over numpy arrays; angles in rad.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def output_angle(chi: ArrayLike, angle: ArrayLike) -> Array:
    """ψ(χ) [rad], continuous in χ, with ψ(0) = 0."""
    chi = np.asarray(chi, dtype=float)
    t = np.tan(np.asarray(angle, dtype=float) / 2) ** 2
    return np.asarray(chi + np.arctan2(t * np.sin(2 * chi), 1 - t * np.cos(2 * chi)))


def ratio(chi: ArrayLike, angle: ArrayLike) -> Array:
    """η = dψ/dχ [1], between cos β and 1/cos β."""
    return np.cos(angle) / _denominator(chi, angle)


def ratio_slope(chi: ArrayLike, angle: ArrayLike) -> Array:
    """dη/dχ [1/rad] = −cos β sin²β sin 2χ / D²."""
    sine2 = np.sin(angle) ** 2
    return -np.cos(angle) * sine2 * np.sin(2 * np.asarray(chi)) / _denominator(chi, angle) ** 2


def ratio_curvature(chi: ArrayLike, angle: ArrayLike) -> Array:
    """d²η/dχ² [1/rad²] = −2 cos β sin²β (cos 2χ / D² − sin²β sin²2χ / D³)."""
    sine2 = np.sin(angle) ** 2
    d = _denominator(chi, angle)
    two_chi = 2 * np.asarray(chi)
    return -2 * np.cos(angle) * sine2 * (np.cos(two_chi) / d**2 - sine2 * np.sin(two_chi) ** 2 / d**3)


def irregularity(angle: ArrayLike) -> Array:
    """U = η_max − η_min = tan β sin β [1]."""
    return np.tan(angle) * np.sin(angle)


def mean_square_ratio(angle: ArrayLike) -> Array:
    """⟨η²⟩ over a turn of the input = (cos β + 1/cos β)/2 [1]."""
    c = np.cos(angle)
    return (c + 1 / c) / 2


def largest_lead(angle: ArrayLike) -> Array:
    """Largest |ψ − χ| [rad]: sin δ = tan²(β/2)."""
    return np.arcsin(np.tan(np.asarray(angle, dtype=float) / 2) ** 2)


def _denominator(chi: ArrayLike, angle: ArrayLike) -> Array:
    return np.asarray(1 - np.sin(angle) ** 2 * np.cos(chi) ** 2)
