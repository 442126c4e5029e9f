"""Two shafts and two disks behind a constant speed with a Hooke's joint between: radii integrated without the package.

With φ the turn of the disk in front of the joint, η = dψ/dφ = cos β / (1 − sin²β cos²φ), and δ small rotations,

    J₁ δ₁″ = −k₁ δ₁ − c₁ δ₁′ + η (k₂ q + c₂ q′),   J₂ δ₂″ = −k₂ q − c₂ q′,
    q = δ₂ − η δ₁,   q′ = δ₂′ − η δ₁′ − Ω (dη/dφ) δ₁.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

import trunnion as tn

PHASE, FINE = 0.03, 0.004
"""Radians of the faster mode in a step: the classical Runge–Kutta method then errs by some 1e-9 over half a turn, and
radii by up to 2e-6 where two multipliers meet; and those that leave 1e-9 there."""


@dataclass(frozen=True)
class TwoDisks:
    """Stiffnesses, dampings and inertias of both shafts and disks, and the joint's angle; numbers, or arrays
    (points,) where many lines are looked at."""

    k1: float
    c1: float
    j1: float
    angle: float
    k2: float
    c2: float
    j2: float

    def line(self) -> tn.Driveline:
        """The same for the package."""
        return tn.Driveline(
            [
                tn.ConstantSpeed(),
                tn.Shaft(stiffness=self.k1, damping=self.c1),
                tn.Disk(inertia=self.j1),
                tn.HookeJoint(angle=self.angle),
                tn.Shaft(stiffness=self.k2, damping=self.c2),
                tn.Disk(inertia=self.j2),
            ]
        )

    def frequencies(self) -> np.ndarray:
        """Of the straight line [rad/s], rising."""
        stiffness = np.array([[self.k1 + self.k2, -self.k2], [-self.k2, self.k2]])
        root = np.diag([self.j1**-0.5, self.j2**-0.5])
        return np.sqrt(np.linalg.eigvalsh(root @ stiffness @ root))

    def radius(self, speed: np.ndarray, phase: float = FINE, **changed: np.ndarray) -> np.ndarray:
        """Spectral radii (points,) over half a turn at speeds [rad/s], with numbers ``changed`` (points,) at each."""
        own = replace(self, **changed)
        fast = np.sqrt((own.k1 + 2 * own.k2) / own.j1 + own.k2 / own.j2) / speed
        steps = int(np.ceil(np.pi * np.max(fast) / phase))
        h, state = np.pi / steps, np.broadcast_to(np.eye(4), (len(speed), 4, 4))
        at = self._matrix(own, speed, 0.0)
        for step in range(steps):
            middle, end = (self._matrix(own, speed, (step + share) * h) for share in (0.5, 1.0))
            a = at @ state
            b = middle @ (state + h / 2 * a)
            c = middle @ (state + h / 2 * b)
            d = end @ (state + h * c)
            state, at = state + h / 6 * (a + 2 * b + 2 * c + d), end
        return np.asarray(np.abs(np.linalg.eigvals(state)).max(axis=1))

    @staticmethod
    def _matrix(own: TwoDisks, speed: np.ndarray, phi: float) -> np.ndarray:
        """d(δ₁, δ₂, δ₁′, δ₂′)/dφ, (points, 4, 4), the derivatives taken by φ."""
        sine = np.sin(own.angle) ** 2
        below = 1 - sine * np.cos(phi) ** 2
        eta = np.cos(own.angle) / below
        slope = -np.cos(own.angle) * sine * np.sin(2 * phi) / below**2
        k1, c1, k2, c2 = own.k1 / speed**2, own.c1 / speed, own.k2 / speed**2, own.c2 / speed
        # Torque of the second shaft, as factors of δ₁, δ₂, δ₁′, δ₂′.
        torque = [-eta * k2 - slope * c2, k2, -eta * c2, c2]
        rows = np.zeros((len(speed), 4, 4))
        rows[:, 0, 2] = rows[:, 1, 3] = 1.0
        for place, (factor, held) in enumerate(zip(torque, (-k1, 0.0, -c1, 0.0), strict=True)):
            rows[:, 2, place] = (held + eta * factor) / own.j1
            rows[:, 3, place] = -factor / own.j2
        return rows
