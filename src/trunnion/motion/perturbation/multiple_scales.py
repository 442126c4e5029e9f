"""Multiple scales to first order: M. Rezaee and A. Farshidianfar, gear rattle with damping, equations (9)–(50).

In the paper's letters, ü + (c/I)u̇ + λ₁u + λ₂u³ = B₀ + B₁ cos ωt with t* = t/T, u* = u/U and

    λ₁T² = 1                 (13, printed with λ₁²)       λ₂T²U² = ε          (14)
    μ = cT/(2εI)             (15)                         ω* = ωT = 1 + εσ    (16, 34)
    εB₀* = B₀T²/U            (17)                         εB₁* = B₁T²/U       (18)

becomes (19); with u* = A e^{iT₀} + cc the terms that would grow vanish if

    2iA′ + 2iμA + 3A²Ā − ½B₁* e^{iσT₁} = 0                                    (37)

in the slow time T₁ = εt*. With A = ½a e^{iψ} and β = σT₁ − ψ that is (42) and (43), whose steady states are

    μ²a² + (σ − ⅜a²)²a² = ¼B₁*²                                              (49)

B₀* drops out at this order: the static deflection is not seen. Nor does ε matter, see ``FittedSlowFlow``.
"""

from __future__ import annotations

import cmath
from math import sqrt

from trunnion.motion.perturbation.cubic_fit import FittedSlowFlow
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator


class MultipleScales(FittedSlowFlow):
    """The slow flow (37) of an oscillator; parameters as ``FittedSlowFlow``."""

    method = "multiple scales"

    def solvability(self, A: complex, T_1: float, sigma: float) -> complex:
        """A′ from (37)."""
        drive = 0.5 * self.B_1 * cmath.exp(1j * sigma * T_1)
        return (drive - self.softening * 3 * A * A * A.conjugate()) / 2j - self.mu * A

    def rates(self, amplitude: float, phase: float, frequency: float) -> tuple[float, float]:
        """dA/dt and dβ/dt from (37) at T₁ = 0, where ψ = −β."""
        sigma = (frequency * self.T - 1) / self.epsilon
        a = amplitude / self.U
        A = 0.5 * a * cmath.exp(-1j * phase)
        # A′ = ½(a′ + iaψ′)e^{iψ}
        turned = 2 * self.solvability(A, 0.0, sigma) * cmath.exp(1j * phase)
        slow = self.epsilon / self.T
        return turned.real * self.U * slow, (sigma - turned.imag / a) * slow

    def frequencies(self, amplitude: float) -> tuple[float, float] | None:
        """σ from (49)."""
        a = amplitude / self.U
        inside = (0.5 * self.B_1 / a) ** 2 - self.mu**2
        if inside < 0:
            return None
        backbone, width = self.softening * 0.375 * a**2, sqrt(inside)
        low, high = ((1 + self.epsilon * (backbone + s * width)) / self.T for s in (-1, 1))
        if high <= 0:
            return None
        return (low if low > 0 else float("nan")), high


def multiple_scales(
    oscillator: PiecewiseOscillator, *, epsilon: float = 0.01, fit_range: float | None = None
) -> MultipleScales:
    """The slow flow of a piecewise oscillator to first order, by multiple scales; see ``MultipleScales``.

    The force of the oscillator is replaced by λ₁x + λ₂x³, which changes where resonances stand: see how the answer
    moves with ``fit_range``, and compare with ``piecewise_branch``, which takes the force as it is.

    Parameters
    ----------
    oscillator : a ``PiecewiseOscillator`` with damping that always acts and one harmonic of force.
    epsilon : ε > 0, the small number of the method [-]; every answer in x and t is the same whatever it is.
    fit_range : |x| up to which a cubic is fitted to the force, in units of x; by default three half gaps. It decides
        the answer: choose about the largest motion expected.

    Returns
    -------
    MultipleScales: ``response(low, high)`` gives amplitudes over frequency [rad/s] with their stability, ``rates`` and
    ``frequencies`` the flow itself.

    Raises
    ------
    InputError : a fit range inside the gap, ε not positive, no force, damping that does not always act.

    Examples
    --------
    >>> import trunnion as tn
    >>> gap = tn.PiecewiseOscillator.gap(half_gap=1.0, damping=0.05, mean_force=0.2, force=0.4, frequency=0.7)
    >>> flow = tn.multiple_scales(gap)
    >>> [round(frequency, 4) for frequency in flow.frequencies(2.0)]
    [0.4075, 0.8859]
    """
    return MultipleScales(oscillator, epsilon=epsilon, fit_range=fit_range)
