"""One disk on a clutch held by a drive, many at once, in even steps: nothing is located and nothing is solved.

    J q″ = −k q − c q′ − Σ kᵢ xᵢ − M + F cos ωt,      xᵢ ← clip(xᵢ + Δq, ± Tᵢ/kᵢ)

by velocity Verlet, the damper implicit. A slider follows the step of the twist as far as it holds, which is its law for
any twist that does not turn within the step. The error falls with the square of the step.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class RubbingDisks:
    """Disks (line,): inertia, spring, damping, load M, force F and its frequency ω [rad/s]; holds and series (line,
    slider): torque and stiffness of the sliders, 0 and 1 where a line has fewer."""

    inertia: np.ndarray
    spring: np.ndarray
    damping: np.ndarray
    load: np.ndarray
    force: np.ndarray
    omega: np.ndarray
    holds: np.ndarray
    series: np.ndarray

    @property
    def reach(self) -> np.ndarray:
        """Deflection (line, slider) at which each slider slips."""
        return self.holds / self.series

    def rest(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Twist and rate (line,) and deflections (line, slider) of lines without twist."""
        return np.zeros_like(self.load), np.zeros_like(self.load), np.zeros_like(self.holds)

    def torque(self, q: np.ndarray, v: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Of the clutch (line,)."""
        return self.spring * q + self.damping * v + (self.series * x).sum(axis=1)

    def period(
        self, q: np.ndarray, v: np.ndarray, x: np.ndarray, steps: int
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """State after one period of the force; lowest, highest and mean torque (line,) in it."""
        step = 2 * np.pi / self.omega / steps
        low, high, total = np.full_like(q, np.inf), np.full_like(q, -np.inf), np.zeros_like(q)
        a = (self.force - self.load - self.torque(q, v, x)) / self.inertia
        for i in range(1, steps + 1):
            moved = step * v + step**2 / 2 * a
            q, x = q + moved, np.clip(x + moved[:, None], -self.reach, self.reach)
            push = self.force * np.cos(2 * np.pi * i / steps) - self.load - self.torque(q, 0.0 * v, x)
            v = (v + step / 2 * (a + push / self.inertia)) / (1 + self.damping * step / (2 * self.inertia))
            a = (push - self.damping * v) / self.inertia
            now = self.torque(q, v, x)
            low, high, total = np.minimum(low, now), np.maximum(high, now), total + now
        return q, v, x, low, high, total / steps
