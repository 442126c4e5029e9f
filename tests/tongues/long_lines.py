"""Random lines of more than three unknowns, and their regions at small angles by averaging."""

from __future__ import annotations

import numpy as np

import trunnion as tn


def long_line(seed: int, shafts: int, damping: float) -> tn.Driveline:
    """A line of random shafts and disks with joints behind the first and the third; damping [s] times stiffness."""
    parts: list[tn.Element] = [tn.ConstantSpeed()]
    for i, (k, j) in enumerate(numbers(seed, shafts)):
        parts += [tn.Shaft(stiffness=k, damping=damping * k), tn.Disk(inertia=j)]
        if i in (0, 2):
            parts.append(tn.HookeJoint(angle=0.02))
    return tn.Driveline(parts)


def numbers(seed: int, shafts: int) -> list[tuple[float, float]]:
    """Stiffness and inertia of each shaft and disk."""
    rng = np.random.default_rng(seed)
    return [(1e4 * 10 ** rng.uniform(-0.3, 0.3), 0.1 * 10 ** rng.uniform(-0.3, 0.3)) for _ in range(shafts)]


class Small:
    """Frequencies of the straight line and widths of its undamped regions to first order in β²: ``docs/tongues.md``."""

    def __init__(self, seed: int, shafts: int) -> None:
        stiffness, first = np.zeros((shafts, shafts)), np.zeros((shafts, shafts))
        every = numbers(seed, shafts)
        for i, (k, _) in enumerate(every):
            u = np.eye(shafts)[i] - (np.eye(shafts)[i - 1] if i else 0.0)
            stiffness += k * np.outer(u, u)
            if i in (
                1,
                3,
            ):  # forks of one shaft stand in one plane: the second joint is a quarter turn behind the first
                p = np.eye(shafts)[i - 1]
                first -= (2 - i) * k / 2 * (np.outer(u, p) + np.outer(p, u))
        root = np.array([j for _, j in every]) ** -0.5
        squares, shapes = np.linalg.eigh(root[:, None] * stiffness * root)
        phi = root[:, None] * shapes
        self.omega, self.kappa = np.sqrt(squares), phi.T @ first @ phi

    def width(self, i: int, j: int, beta: float) -> float:
        """Width in Ω at an angle of all joints."""
        return float(beta**2 * abs(self.kappa[i, j]) / (2 * np.sqrt(self.omega[i] * self.omega[j])))
