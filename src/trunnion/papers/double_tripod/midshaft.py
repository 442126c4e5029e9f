"""The midshaft's boundary problem (11), (15), (16) of S4, which the paper replaces by fixed ends and then drops.

A shaft of length L, polar moment J and density ρ carries a tripod of inertia I at each end. Without the joints' torque,
which is A = 3.65e-5 of their stiffness, (15) and (16) read I φ̈ = ± GJ ∂φ/∂x, and φ = (a cos kx + b sin kx) cos ωt with
ω = kc, c = √(G/ρ), gives for x = kL and r = I/(ρJL) of either end

    (r₁ + r₂) x cos x = (r₁ r₂ x² − 1) sin x.

r = 0 (free ends) gives the printed ν_k = k c/2L. Heavy tripods, r → ∞, let every ν_k come down to ν_{k−1}, and the
first to 0: the same list, with other shapes.
"""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array
from trunnion.papers.double_tripod.published import MIDSHAFT_LENGTH, WAVE_SPEED


def midshaft_frequencies(ratios: tuple[float, float], count: int = 5) -> Array:
    """Natural frequencies [Hz] of the midshaft with tripods of ``ratios`` r₁, r₂ at its ends, the lowest ``count``."""
    from scipy.optimize import brentq

    first, second = ratios

    def balance(x: float) -> float:
        return float((first + second) * x * np.cos(x) - (first * second * x**2 - 1) * np.sin(x))

    # One root in each (k − 1)π < x ≤ kπ: the left side changes its sign between their ends.
    roots = [brentq(balance, (k - 1) * np.pi + 1e-9, k * np.pi + 1e-9, xtol=1e-13) for k in range(1, count + 1)]
    return np.array(roots) * WAVE_SPEED / (2 * np.pi * MIDSHAFT_LENGTH)


def ratio_that_meets(order: int, frequency: float) -> float:
    """The r of both ends that brings ν of ``order`` down to a ``frequency`` [Hz] between ν_{order−1} and ν_order."""
    from scipy.optimize import brentq

    def above(r: float) -> float:
        return float(midshaft_frequencies((r, r), order)[-1] - frequency)

    return float(brentq(above, 1e-9, 1e3, xtol=1e-12))
