"""A slow flow whose spring is a cubic fitted to the oscillator's, in the dimensionless units (13)–(18)."""

from __future__ import annotations

from math import sqrt

from trunnion.analyses.perturbation.cubic_fit import CubicFit, cubic_fit
from trunnion.analyses.perturbation.slow_flow import SlowFlow
from trunnion.errors import InputError
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator


class FittedSlowFlow(SlowFlow):
    """A slow flow in the units T [s] and U with λ₁T² = 1 and |λ₂|T²U² = ε.

    Parameters
    ----------
    epsilon : ε > 0. Through (13)–(18) it scales U, μ, σ and B* so that every answer in u and t stays the same.
    fit_range : of the cubic fit of the force, by default three half gaps; decisive.
    """

    def __init__(
        self, oscillator: PiecewiseOscillator, *, epsilon: float = 0.01, fit_range: float | None = None
    ) -> None:
        super().__init__(oscillator)
        if not 0 < epsilon < float("inf"):
            raise InputError("must be positive", key="epsilon", value=epsilon, remedy="the paper takes 0.01")
        self.fit: CubicFit = cubic_fit(oscillator, fit_range)
        self.note = str(self.fit)
        self.epsilon = epsilon
        self.T = 1 / sqrt(self.fit.linear)
        self.U = sqrt(epsilon * self.fit.linear / abs(self.fit.cubic))
        self.softening = -1.0 if self.fit.cubic < 0 else 1.0
        self.mu = oscillator.damping / oscillator.inertia * self.T / (2 * epsilon)
        forces = (oscillator.mean_force, oscillator.force)
        self.B_0, self.B_1 = (f / oscillator.inertia * self.T**2 / (epsilon * self.U) for f in forces)
