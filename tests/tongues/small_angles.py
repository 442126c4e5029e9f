"""Averaging of a straight line that a small joint angle excites: widths and tips of tongues in closed form.

A joint bent by a small β has η = 1 + ½β² cos 2χ + O(β⁴), so the stiffness behind it varies by β² K₁ cos 2χ with
K₁ = −½k(u e_pᵀ + e_p uᵀ), u = e_i − e_p. ``docs/tongues.md`` derives what follows from it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Averaged:
    """Two equal shafts (k = J = 1) and a disk of inertia γ at the end, dampings c = 2ζ; modes to first order in β²."""

    gamma: float
    zeta: float = 0.0

    def modes(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Frequencies, decay rates, and κ = Φᵀ K₁ Φ."""
        stiffness = np.array([[2.0, -1.0], [-1.0, 1.0]])
        root = np.diag([1.0, self.gamma**-0.5])
        squares, shapes = np.linalg.eigh(root @ stiffness @ root)
        phi = root @ shapes
        first = -0.5 * np.array([[-2.0, 1.0], [1.0, 0.0]])
        return np.sqrt(squares), self.zeta * squares, phi.T @ first @ phi

    def speed(self, i: int, j: int) -> float:
        omega = self.modes()[0]
        return float((omega[i] + omega[j]) / 2)

    def strength(self, i: int, j: int) -> float:
        """G/β²: half the width of the undamped tongue in Ω for β = 1."""
        omega, _, kappa = self.modes()
        return float(abs(kappa[i, j]) / (4 * np.sqrt(omega[i] * omega[j])))

    def width(self, i: int, j: int, beta: float) -> float:
        """Width in Ω at a joint angle."""
        _, decay, _ = self.modes()
        g, both = self.strength(i, j) * beta**2, decay[i] + decay[j]
        if both == 0:
            return 2 * g
        return float(both * np.sqrt(g**2 / (decay[i] * decay[j]) - 1))

    def tip(self, i: int, j: int) -> float:
        """Angle at which the tongue closes."""
        _, decay, _ = self.modes()
        return float(np.sqrt(np.sqrt(decay[i] * decay[j]) / self.strength(i, j)))
