"""S1 in twists, integrated without the package: the oracle for edges and tips of tongues."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp


def radius(speed: float, beta: float, gamma: float = 1.0, zeta: float = 0.001) -> float:
    """Spectral radius over half a turn of two equal shafts, α = μ = 1, with the signs of the re-derived equations."""

    def matrices(t: float) -> tuple[np.ndarray, np.ndarray]:
        d = 1 - np.sin(beta) ** 2 * np.sin(t) ** 2
        c, s2 = np.cos(beta), np.sin(beta) ** 2
        eta = c / d
        first = c * s2 * np.sin(2 * t) / d**2
        second = c * s2 * (2 * np.cos(2 * t) / d**2 + 2 * s2 * np.sin(2 * t) ** 2 / d**3)
        z, over = 2 * zeta / speed, 1 / speed**2
        e = [[z, -z * eta], [2 * first - z * eta, z * (eta**2 + 1 / gamma)]]
        p = [[over, -eta * over], [second - eta * over, over * (eta**2 + 1 / gamma)]]
        return np.array(e), np.array(p)

    def rates(t: float, x: np.ndarray) -> np.ndarray:
        e, p = matrices(t)
        y = x.reshape(4, 4)
        return np.concatenate([y[2:], -e @ y[2:] - p @ y[:2]]).ravel()

    end = solve_ivp(rates, (0, np.pi), np.eye(4).ravel(), method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    return float(np.abs(np.linalg.eigvals(end.reshape(4, 4))).max())
