"""Tripod joint: three trunnions at 120° on one shaft run in three straight, axial tracks of the other.

Measured between its two momentary axes a tripod joint passes rotation unchanged at any bend angle β. But its
spider does not stay on the housing's axis: it circles it three times a turn, on a radius R tan²(β/2), and so
swings the shaft that carries it about its far end, a distance L away. Seen from a shaft that stands still
behind that far end (an ideal joint in line with the mean direction), the swing turns the output by

    ψ = χ + A sin 3χ,     A = ½ (R/L) tan β tan²(β/2)

with χ = 0 where one arm lies in the joint plane, on the outer side of the bend. The rigid joint solved in
space (tests) has this third harmonic within 5e-5 of it and all others below 1e-4 of it. If the spider is
driven instead of driving, ψ = χ − A sin 3χ, its inverse within A². Angles in rad; all functions broadcast.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.laws.fourier import FourierLaw


def amplitude(angle: ArrayLike, radius_over_length: ArrayLike) -> Array:
    """A [rad] for bend angle β and R/L, tripod radius over length of the shaft that carries the spider."""
    return np.asarray(radius_over_length) / 2 * np.tan(angle) * np.tan(np.asarray(angle) / 2) ** 2


def law(angle: ArrayLike, radius_over_length: ArrayLike) -> FourierLaw:
    """ψ = χ + A sin 3χ; of a driving spider take −A."""
    return FourierLaw((3,), (amplitude(angle, radius_over_length),), (np.zeros(()),))
