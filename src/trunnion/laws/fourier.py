"""Joints whose output runs ahead and behind by a few harmonics of a turn: tripods, ripple of ball joints.

    ψ = χ + Σ A_m sin(mχ + φ_m),   η = 1 + Σ m A_m cos(mχ + φ_m)

with whole orders m, in cycles per turn of the joint's own shaft. Angles in rad.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.laws.joint import TransmittedRotation


@dataclass(frozen=True)
class FourierLaw:
    """``orders`` m; ``amplitude`` A_m and ``phase`` φ_m [rad], one array each, which broadcast against χ."""

    orders: tuple[int, ...]
    amplitude: tuple[Array, ...]
    phase: tuple[Array, ...]
    turned: float = 0.0

    @property
    def numbers(self) -> tuple[Array, ...]:
        """All amplitudes and phases."""
        return (*self.amplitude, *self.phase)

    @property
    def nonuniform(self) -> bool:
        """See ``JointLaw``."""
        return any(bool(np.any(a)) for a in self.amplitude)

    @property
    def spread(self) -> float:
        """See ``JointLaw``: the ripple m A_m of the ratio, half of which each side order gets."""
        ripple = [float(np.max(np.abs(m * a))) / 2 for m, a in zip(self.orders, self.amplitude, strict=True)]
        return min(0.5, sum(ripple))

    def at(self, chi: Array) -> TransmittedRotation:
        """See ``JointLaw``."""
        chi = np.asarray(chi, dtype=float)
        output, ratio, slope, curvature = chi, np.ones_like(chi), np.zeros_like(chi), np.zeros_like(chi)
        for m, a, phase in zip(self.orders, self.amplitude, self.phase, strict=True):
            sine, cosine = a * np.sin(m * chi + phase), a * np.cos(m * chi + phase)
            output, ratio = output + sine, ratio + m * cosine
            slope, curvature = slope - m**2 * sine, curvature - m**3 * cosine
        return TransmittedRotation(output, ratio, slope, curvature)

    def third(self, chi: Array) -> Array:
        """See ``JointLaw``."""
        terms = zip(self.orders, self.amplitude, self.phase, strict=True)
        return sum((m**4 * a * np.sin(m * chi + phase) for m, a, phase in terms), start=np.zeros_like(chi))

    def straight(self) -> FourierLaw:
        """See ``JointLaw``."""
        return FourierLaw(self.orders, tuple(np.zeros_like(a) for a in self.amplitude), self.phase, self.turned)
