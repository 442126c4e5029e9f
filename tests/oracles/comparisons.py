"""Comparing sets of multipliers, and multipliers of anybody's matrices."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import linear_sum_assignment

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


def set_distance(a: Any, b: Any) -> float:
    """Largest distance between two sets of multipliers under the best pairing."""
    cost = np.abs(np.asarray(a)[:, None] - np.asarray(b)[None, :])
    rows, columns = linear_sum_assignment(cost)
    return float(cost[rows, columns].max())


def floquet(
    matrix_of: Callable[[float], tuple[Array, Array]], size: int, period: float, rtol: float = 1e-12
) -> Complex:
    """Multipliers of x″ + E(τ)x′ + P(τ)x = 0 by DOP853; ``matrix_of(τ)`` returns E, P."""

    def slopes(tau: float, flat: Array) -> Array:
        damping, stiffness = matrix_of(tau)
        state = flat.reshape(2 * size, 2 * size)
        return np.concatenate([state[size:], -stiffness @ state[:size] - damping @ state[size:]]).ravel()

    run = solve_ivp(slopes, (0.0, period), np.eye(2 * size).ravel(), method="DOP853", rtol=rtol, atol=1e-14)
    return np.linalg.eigvals(run.y[:, -1].reshape(2 * size, 2 * size))
