"""Derivatives by differences of fourth order, from one side where the other is refused.

f′ ≈ (f₋₂ − 8f₋₁ + 8f₁ − f₂)/12h,    f′ ≈ (−25f₀ + 48f₁ − 36f₂ + 16f₃ − 3f₄)/12h

A largest value has kinks, where another place or curve becomes the largest one or a sum cancels: the slopes on the two
sides differ, and what the central formula gives between them is not a derivative.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from trunnion.arrays import Array, Flags

Values = Callable[[float], Array | None]
"""What a line beside one shows, by the share of a parameter's size that it lies away; None where it is refused."""
CENTRAL = np.array([-2.0, -1.0, 1.0, 2.0])
WEIGHTS = np.array([1.0, -8.0, 8.0, -1.0]) / 12
FORWARD = np.array([0.0, 1.0, 2.0, 3.0, 4.0])
FORWARD_WEIGHTS = np.array([-25.0, 48.0, -36.0, 16.0, -3.0]) / 12
STEP = 1e-4
"""Share of a parameter's size by which lines are moved."""
SMOOTH_STEP = 1e-3
"""The same where a function is a low polynomial of it, as coefficients of the equations are."""


KINK = 0.05
"""Share of the steepest change at which the two sides' slopes differ too much for one derivative."""

ROUNDING = 1e-10
"""Change that may be rounding, of values of order one, in the unit of the function."""


def central(values: NDArray[Any], step: float) -> NDArray[Any]:
    """Derivative of values (4, …) at −2, −1, 1 and 2 steps."""
    return np.asarray(np.tensordot(WEIGHTS, values, 1) / step)


def slope(values: Values, step: float = STEP) -> tuple[Array, Array] | None:
    """Derivative of ``values(share)`` at 0 and its error, each as an array; None where both sides are refused.

    The error is the distance to the derivative of second order, which is the larger error of the two, and at least half
    of what the slopes on the two sides differ by; where these are those of a kink, the derivative is NaN.
    """
    here = values(0.0)
    if here is None:
        return None
    ahead, back = values(step), values(-step)
    if ahead is not None and back is not None:
        if np.array_equal(ahead, here) and np.array_equal(back, here):
            return np.zeros_like(here), np.zeros_like(here)  # nothing of what is looked at holds the parameter
        found = [values(step * k) for k in CENTRAL]
        if all(one is not None for one in found):
            rows = np.array(found, dtype=float)
            fine = np.tensordot(WEIGHTS, rows, 1) / step
            error = np.abs(fine - (rows[2] - rows[1]) / (2 * step))
            apart = np.abs(_gap(here, rows)) / step
            return np.where(_kinked(here, rows), np.nan, fine), np.maximum(error, apart / 2)
    for side in (step, -step):
        found = [values(side * k) for k in FORWARD]
        if all(one is not None for one in found):
            rows = np.array(found, dtype=float)
            fine = np.tensordot(FORWARD_WEIGHTS, rows, 1) / side
            return fine, np.abs(fine - (-3 * rows[0] + 4 * rows[1] - rows[2]) / (2 * side))
    return None


def _kinked(here: Array, rows: Array) -> Flags:
    """Whether the function bends at once: its bend over two steps is twice that over one, where a smooth one's is four
    times it and rounding's is anything."""
    far, near = rows[0] + rows[3] - 2 * here, rows[1] + rows[2] - 2 * here
    rise = np.abs(rows - here).max(axis=0)
    large = (np.abs(_gap(here, rows)) > KINK * rise) & (rise > ROUNDING * np.maximum(np.abs(here), 1.0))
    return np.asarray(large & (np.abs(far - 2 * near) < 0.2 * np.abs(near)))


def _gap(here: Array, rows: Array) -> Array:
    """What the slopes of second order on the two sides differ by, times the step; ``rows`` as in ``central``."""
    far_back, back, ahead, far_ahead = rows
    return np.asarray(((4 * ahead - far_ahead) + (4 * back - far_back) - 6 * here) / 2)
