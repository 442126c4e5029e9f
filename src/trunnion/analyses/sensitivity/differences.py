"""Derivatives by differences of fourth order, from one side where the other is refused.

f′ ≈ (f₋₂ − 8f₋₁ + 8f₁ − f₂)/12h,    f′ ≈ (−25f₀ + 48f₁ − 36f₂ + 16f₃ − 3f₄)/12h
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
CENTRAL = np.array([-2.0, -1.0, 1.0, 2.0])
WEIGHTS = np.array([1.0, -8.0, 8.0, -1.0]) / 12
FORWARD = np.array([0.0, 1.0, 2.0, 3.0, 4.0])
FORWARD_WEIGHTS = np.array([-25.0, 48.0, -36.0, 16.0, -3.0]) / 12
STEP = 1e-4
"""Share of a parameter's size by which lines are moved."""
SMOOTH_STEP = 1e-3
"""The same where a function is a low polynomial of it, as coefficients of the equations are."""


def central(values: Array, step: float) -> Array:
    """Derivative of values (4, …) at −2, −1, 1 and 2 steps."""
    return np.asarray(np.tensordot(WEIGHTS, values, 1) / step)


def slope(values: Callable[[float], Array | None], step: float = STEP) -> tuple[Array, Array] | None:
    """Derivative of ``values(share)`` at 0 and its error, each as an array; None where both sides are refused.

    The error is the distance to the derivative of second order, which is the larger error of the two.
    """
    here = values(0.0)
    if here is None:
        return None
    if values(step) is not None and values(-step) is not None:
        found = [values(step * k) for k in CENTRAL]
        if all(one is not None for one in found):
            rows = np.array(found, dtype=float)
            fine = np.tensordot(WEIGHTS, rows, 1) / step
            return fine, np.abs(fine - (rows[2] - rows[1]) / (2 * step))
    for side in (step, -step):
        found = [values(side * k) for k in FORWARD]
        if all(one is not None for one in found):
            rows = np.array(found, dtype=float)
            fine = np.tensordot(FORWARD_WEIGHTS, rows, 1) / side
            return fine, np.abs(fine - (-3 * rows[0] + 4 * rows[1] - rows[2]) / (2 * side))
    return None
