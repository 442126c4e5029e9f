"""Averaging of the exact piecewise force: no cubic, no range to choose, and the mean is seen.

For x = x̄ + A cos θ the force g(x)/m has the mean n₀ and the fundamental N·A (N the describing function):

    n₀(A, x̄) = 1/2π ∮ g dθ,    N(A, x̄) = 1/πA ∮ g cos θ dθ.

Each breakpoint b with a change of slope Δ adds Δ·max(0, x − b) to a line, and of that both are known in closed form
with ϑ = arccos((b − x̄)/A):  n₀: Δ(A sin ϑ − (b − x̄)ϑ)/π,   N: Δ(ϑ − sin ϑ cos ϑ)/π.

x̄ follows from n₀ = B₀/m. Averaged over a period of the excitation (Krylov–Bogoliubov about cos ωt):

    2ω Ȧ = −cωA + B₁ sin β,     2ωA β̇ = (ω² − N)A + B₁ cos β      (c and B₁ over m),

steady where (N − ω²)² + c²ω² = (B₁/A)². Unlike first order in ε this stays right far from one frequency.
"""

from __future__ import annotations

from functools import lru_cache
from math import acos, cos, pi, sin, sqrt

import numpy as np
from scipy.optimize import brentq

from trunnion.motion.perturbation.slow_flow import SlowFlow
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator


def describing_function(oscillator: PiecewiseOscillator, amplitude: float, mean: float) -> tuple[float, float]:
    """n₀ and N of the restoring force over the mass, for x = mean + amplitude · cos θ, amplitude > 0.

    >>> gap = PiecewiseOscillator.gap(half_gap=1.0, stiffness=4.0)
    >>> describing_function(gap, 0.5, 0.0), describing_function(PiecewiseOscillator((), (4.0,)), 2.0, 0.5)
    ((0.0, 0.0), (2.0, 4.0))
    """
    m, slopes = oscillator.inertia, oscillator.slopes
    constant, stiffness = slopes[0] * mean + oscillator.offsets[0], slopes[0]
    for b, before, after in zip(oscillator.breakpoints, slopes[:-1], slopes[1:], strict=True):
        reach = (b - mean) / amplitude
        angle = 0.0 if reach >= 1 else pi if reach <= -1 else acos(reach)
        step = (after - before) / pi
        constant += step * (amplitude * sin(angle) - (b - mean) * angle)
        stiffness += step * (angle - sin(angle) * cos(angle))
    return constant / m, stiffness / m


class DescribingFunction(SlowFlow):
    """The averaged rates of the exact piecewise oscillator.

    Parameters
    ----------
    oscillator : with one harmonic of force and damping that always acts.

    >>> gap = PiecewiseOscillator.gap(half_gap=1.0, damping=0.05, mean_force=0.2, force=0.4)
    >>> [round(frequency, 4) for frequency in DescribingFunction(gap).frequencies(2.0)]
    [0.448, 0.7718]
    """

    method = "describing function"
    note = "averaging of the exact piecewise force; the mean from the mean force; no fit"

    def __init__(self, oscillator: PiecewiseOscillator) -> None:
        super().__init__(oscillator)
        m = oscillator.inertia
        self.c, self.B_1, self.B_0 = oscillator.damping / m, oscillator.force / m, oscillator.mean_force / m
        self.mean = lru_cache(maxsize=None)(self._mean)  # type: ignore[method-assign]

    def _mean(self, amplitude: float) -> float:
        """x̄ with n₀(A, x̄) = B₀; n₀ rises with x̄."""
        o = self.oscillator
        if o.mean_force == 0 and _odd(o):
            return 0.0
        reach = amplitude + max(map(abs, o.breakpoints), default=0.0) + 1e-12

        def excess(x: float) -> float:
            return describing_function(o, amplitude, x)[0] - self.B_0

        while excess(-reach) > 0 or excess(reach) < 0:
            if reach > 1e12:
                return float("nan")  # no spring carries the mean force
            reach *= 2
        return float(brentq(excess, -reach, reach, xtol=1e-15, rtol=1e-14))

    def stiffness(self, amplitude: float) -> float:
        """N at the mean that belongs to an amplitude."""
        return describing_function(self.oscillator, amplitude, self.mean(amplitude))[1]

    def rates(self, amplitude: float, phase: float, frequency: float) -> tuple[float, float]:
        """dA/dt and dβ/dt."""
        w = frequency
        turning = (w * w - self.stiffness(amplitude)) + self.B_1 * cos(phase) / amplitude
        return -0.5 * self.c * amplitude + self.B_1 * sin(phase) / (2 * w), turning / (2 * w)

    def frequencies(self, amplitude: float) -> tuple[float, float] | None:
        """The positive roots of (ω²)² − (2N − c²)ω² + N² − (B₁/A)² = 0."""
        n = self.stiffness(amplitude)
        half = n - 0.5 * self.c**2
        inside = half**2 - n**2 + (self.B_1 / amplitude) ** 2
        if not inside >= 0 or half + sqrt(inside) <= 0:
            return None
        low, high = half - sqrt(inside), half + sqrt(inside)
        return (sqrt(low) if low > 0 else float("nan")), sqrt(high)


def _odd(oscillator: PiecewiseOscillator) -> bool:
    knots, slopes = np.array(oscillator.breakpoints), np.array(oscillator.slopes)
    return bool(np.array_equal(knots, -knots[::-1]) and np.array_equal(slopes, slopes[::-1]))
