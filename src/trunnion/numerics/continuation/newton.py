"""Newton's method for a fixed point x = P(x), with steps cut back until the residual falls."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Map = Callable[[Array], tuple[Array, Array]]
"""x → P(x) − x, (m,), and its derivative, (m, m); NaN where P cannot be computed."""


@dataclass(frozen=True)
class Root:
    """Where the iteration ended: x, the residual there and its derivative, the residual's size in units of
    the scale, the number of iterations, and whether it is small enough."""

    x: Array
    residual: Array
    derivative: Array
    size: float
    iterations: int
    converged: bool


def solve(residual: Map, start: Array, scale: Array, *, tolerance: float, most: int = 30) -> Root:
    """Solve r(x) = 0 to |r_i| ≤ tolerance · (scale_i + |x_i|).

    A full step is halved up to six times while the residual does not fall. After the tolerance is met one more
    step is taken, which costs little and squares the error.
    """

    def size_of(r: Array, x: Array) -> float:
        with np.errstate(invalid="ignore"):
            return float(np.max(np.abs(r) / (scale + np.abs(x)))) if np.all(np.isfinite(r)) else np.inf

    x = np.array(start, dtype=float)
    r, slope = residual(x)
    size = size_of(r, x)
    best = Root(x, r, slope, size, 0, size <= tolerance)
    for count in range(1, most + 1):
        if not np.isfinite(size):
            break
        done = size <= tolerance
        step = np.linalg.lstsq(slope * scale[None, :], -r, rcond=1e-13)[0] * scale
        for halving in range(7):
            trial = x + step / 2**halving
            r_new, slope_new = residual(trial)
            new = size_of(r_new, trial)
            if new < size:
                break
        if not new < size:
            break
        x, r, slope, size = trial, r_new, slope_new, new
        best = Root(x, r, slope, size, count, size <= tolerance)
        if done:
            break
    return best
