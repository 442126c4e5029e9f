"""Averaging to first order: the same paper's second derivation, equations (53)–(62), made without multiple scales.

u* = a cos(t* + φ), u̇* = −a sin(t* + φ) with a(t*), φ(t*) put into (19) and solved for their rates (57, 58):

    ȧ  =  sin(t* + φ) · ε F,    aφ̇ = cos(t* + φ) · ε F,
    F = u*³ + 2μu̇* − B₀* − B₁* cos ω*t*       (the other side of (19) with its sign, divided by ε)

and then averaged over the fast time. The averages are taken here as what they are, means over samples of the fast
phase (exact: F times a sine is a trigonometric polynomial of degree four), with the slow angle (1 − ω*)t* + φ = −β
held, not by the formulas (61), (62), to which they are compared in the tests.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

from trunnion.motion.perturbation.cubic_fit import FittedSlowFlow
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator

SAMPLES = 16
"""Of the fast phase; six are enough for degree four."""
_FAST = 2 * np.pi * np.arange(SAMPLES) / SAMPLES
_COS, _SIN = np.cos(_FAST), np.sin(_FAST)


class Averaging(FittedSlowFlow):
    """The averaged rates of an oscillator with a cubic in place of its force; parameters as ``FittedSlowFlow``."""

    method = "averaging"

    def rates(self, amplitude: float, phase: float, frequency: float) -> tuple[float, float]:
        """dA/dt and dβ/dt: means over the fast phase t* + φ of the rates (57) and (58)."""
        a = amplitude / self.U
        u, velocity = a * _COS, -a * _SIN
        # ω*t* = (t* + φ) + β, as β = (ω* − 1)t* − φ.
        force = self.softening * u**3 + 2 * self.mu * velocity - self.B_0 - self.B_1 * np.cos(_FAST + phase)
        a_ = self.epsilon * float(np.mean(_SIN * force))
        phi_ = self.epsilon * float(np.mean(_COS * force)) / a
        return a_ * self.U / self.T, (frequency * self.T - 1 - phi_) / self.T

    def frequencies(self, amplitude: float) -> tuple[float, float] | None:
        """Where both rates vanish: β from the first, ω from the second."""
        at = self.rates(amplitude, 0.0, 0.0)[0], self.rates(amplitude, np.pi / 2, 0.0)[0]
        if at[1] < 0:
            return None
        lag = 0.0 if at[0] == 0 else brentq(lambda b: self.rates(amplitude, b, 0.0)[0], 0.0, np.pi / 2, xtol=1e-14)
        # At zero frequency the second rate is minus the steady frequency.
        found = sorted(-self.rates(amplitude, b, 0.0)[1] for b in (lag, np.pi - lag))
        if found[1] <= 0:
            return None
        return (found[0] if found[0] > 0 else float("nan")), found[1]


def averaging(oscillator: PiecewiseOscillator, *, epsilon: float = 0.01, fit_range: float | None = None) -> Averaging:
    """The slow flow of a piecewise oscillator to first order, by averaging over the fast phase; see ``Averaging``.

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
    Averaging: ``response(low, high)`` gives amplitudes over frequency [rad/s] with their stability, ``rates`` and
    ``frequencies`` the flow itself.

    Raises
    ------
    InputError : a fit range inside the gap, ε not positive, no force, damping that does not always act.

    Examples
    --------
    >>> import trunnion as tn
    >>> gap = tn.PiecewiseOscillator.gap(half_gap=1.0, damping=0.05, mean_force=0.2, force=0.4, frequency=0.7)
    >>> flow = tn.averaging(gap)
    >>> [round(frequency, 4) for frequency in flow.frequencies(2.0)]
    [0.4075, 0.8859]
    """
    return Averaging(oscillator, epsilon=epsilon, fit_range=fit_range)
