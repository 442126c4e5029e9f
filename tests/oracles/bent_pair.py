"""Two disks with a bent joint and a shaft between them, free–free: equations over the angle φ of the first disk,
written out here.

With ψ the joint's law, η = ψ′, q the twist beyond that of the mean load T̄ and w₀, w₁ the speeds,

    w₀ q′ = w₁ − η w₀,   w₀ J₀w₀′ = drive + T̄ + η f,   w₀ J₁w₁′ = −(T + c w₁ + d w₁²) − f,
    f = −T̄ + k q + c_s (w₁ − η w₀).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import trunnion as tn

Array = NDArray[np.float64]
PERIOD = np.pi
"""Of a Hooke's joint [rad]."""


@dataclass(frozen=True)
class BentPair:
    """``middle`` speed [rad/s] at which T̄ = T + c w + d w² is the mean load."""

    middle: float
    engine: float = 1.2
    inertia: float = 0.8
    stiffness: float = 9e3
    damping: float = 20.0
    angle: float = 0.25
    plane: float = 0.4
    load_torque: float = 60.0
    viscous: float = 0.4
    quadratic: float = 4e-3
    extra: float = 0.0

    @property
    def line(self) -> tn.Driveline:
        """The package's own description."""
        return tn.Driveline([
            tn.Disk(name="engine", inertia=self.engine, drive_share=1.0),
            tn.HookeJoint(name="joint", angle=self.angle, plane=self.plane),
            tn.Shaft(name="shaft", stiffness=self.stiffness, damping=self.damping),
            tn.Disk(
                name="load", inertia=self.inertia, load_torque=self.load_torque, viscous_load=self.viscous,
                quadratic_load=self.quadratic,
            ),
        ])  # fmt: skip

    def at(self, **numbers: float) -> BentPair:
        """With other numbers."""
        return replace(self, **numbers)

    @property
    def mean(self) -> float:
        """T̄ [N m]."""
        return self.load_torque + self.viscous * self.middle + self.quadratic * self.middle**2

    def rates(self, phi: float, x: Array) -> Array:
        """x′ of x = (q, w₀, w₁)."""
        q, w0, w1 = x
        c, s = np.cos(self.angle), np.sin(self.angle)
        eta = c / (1 - s**2 * np.cos(phi - self.plane) ** 2)
        relative = w1 - eta * w0
        f = -self.mean + self.stiffness * q + self.damping * relative
        load = self.load_torque + self.viscous * w1 + self.quadratic * w1**2
        # The joint's phase goes with the input alone: its output twists behind it.
        return np.array([
            relative, (self.mean + self.extra + eta * f) / self.engine, (-load - f) / self.inertia
        ]) / w0  # fmt: skip

    def slopes(self, phi: float, x: Array) -> Array:
        """By x, from complex steps."""
        columns = [self.rates(phi, x + 1e-30j * one).imag / 1e-30 for one in np.eye(3)]
        return np.array(columns).T

    def flown(self, x: Array) -> tuple[Array, Array]:
        """States at 33 even angles of a period from ``x`` at φ = 0, and the matrix of the period."""

        def both(phi: float, y: Array) -> Array:
            return np.concatenate([self.rates(phi, y[:3]), (self.slopes(phi, y[:3]) @ y[3:].reshape(3, 3)).ravel()])

        angles = np.linspace(0, PERIOD, 33)
        made = solve_ivp(
            both, (0, PERIOD), np.concatenate([x, np.eye(3).ravel()]), "DOP853", angles, rtol=1e-11, atol=1e-12
        )  # fmt: skip
        return made.y[:3].T, made.y[3:, -1].reshape(3, 3)

    def periodic(self, x: Array) -> tuple[Array, Array]:
        """The periodic motion near ``x``: states at 33 even angles of a period, and its multipliers."""
        for _ in range(8):
            path, matrix = self.flown(x)
            step = np.linalg.solve(matrix - np.eye(3), x - path[-1])
            x = x + step
            if np.abs(step).max() < 1e-9 * np.abs(x).max():
                break
        path, matrix = self.flown(x)
        assert np.abs(path[-1] - path[0]).max() < 1e-8 * np.abs(x).max()
        return path, np.linalg.eigvals(matrix)
