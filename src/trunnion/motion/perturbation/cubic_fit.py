"""A cubic in place of a piecewise linear force: g(u)/m ≈ λ₁u + λ₂u³, by least squares over |u| ≤ range.

The range is a choice, and a decisive one: perturbation inherits everything from λ₁ and λ₂.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np

from trunnion.errors import InputError
from trunnion.motion.perturbation.slow_flow import SlowFlow
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator

DEFAULT = 3.0
"""Range in half gaps where none is given: the middle of what is usual."""


@dataclass(frozen=True)
class CubicFit:
    """linear λ₁ [1/s²] and cubic λ₂ [1/(s² m²)], the range [m], and the largest misfit over it [m/s²]."""

    linear: float
    cubic: float
    range: float
    misfit: float

    def __str__(self) -> str:
        return (
            f"λ₁ = {self.linear:.6g}, λ₂ = {self.cubic:.6g} from |u| ≤ {self.range:.4g}, "
            f"off by up to {self.misfit:.2g}; another range gives another answer"
        )


def half_gap(oscillator: PiecewiseOscillator) -> float:
    """The nearest breakpoint's distance from 0.

    Raises
    ------
    InputError : no breakpoints.
    """
    if not oscillator.breakpoints:
        raise InputError(
            "has no gap: its response is the linear one", element=oscillator.name, key="breakpoints", value=(),
            remedy="use forced response formulas, or give a gap",
        )  # fmt: skip
    return min(abs(b) for b in oscillator.breakpoints)


def cubic_fit(oscillator: PiecewiseOscillator, fit_range: float | None = None) -> CubicFit:
    """λ₁ and λ₂ minimising ∫(g/m − λ₁u − λ₂u³)² du over |u| ≤ ``fit_range``, by default three half gaps.

    Raises
    ------
    InputError : a range that does not reach beyond the gap; a fit without positive stiffness at rest.
    """
    gap = half_gap(oscillator)
    r = DEFAULT * gap if fit_range is None else float(fit_range)
    if not (np.isfinite(r) and r > gap):
        raise InputError(
            "does not reach beyond the gap, so the fit would be linear", element=oscillator.name, key="fit_range",
            value=r, remedy=f"choose more than {gap:.6g}, about the largest motion expected",
        )  # fmt: skip
    knots = np.unique(np.clip([-r, *oscillator.breakpoints, r], -r, r))
    nodes, weights = np.polynomial.legendre.leggauss(4)
    half = np.diff(knots)[:, None] / 2
    u = (knots[:-1, None] + half * (1 + nodes)).ravel()
    weight = (half * weights).ravel()
    force = oscillator.restoring(u) / oscillator.inertia
    # In units of the range, which keeps the two equations well apart.
    s = u / r
    powers = np.stack([s, s**3])
    matrix = (powers * weight) @ powers.T
    one, three = np.linalg.solve(matrix, (powers * weight) @ force)
    if not one > 0:
        raise InputError(
            f"gives no positive stiffness at rest (λ₁ = {one / r:.3g})", element=oscillator.name, key="fit_range",
            value=r, remedy="choose a larger range",
        )  # fmt: skip
    grid = np.linspace(-r, r, 2001)
    miss = oscillator.restoring(grid) / oscillator.inertia - one * (grid / r) - three * (grid / r) ** 3
    return CubicFit(float(one / r), float(three / r**3), r, float(np.abs(miss).max()))


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
