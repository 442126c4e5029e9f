"""S5: a gear pair with backlash as one nondimensional equation (Rezaee and Farshidianfar), Table 1.

ü + (c/I)u̇ + (k/I) f(u) = B₀ + B₁ cos ωt, f of slope α within ±b and 1 outside.
"""

from __future__ import annotations

from math import pi

from trunnion.systems.piecewise_oscillator import PiecewiseOscillator


def gear_rattle(
    *,
    mean_force: float = 0.05,
    force: float = 0.03,
    half_gap: float = pi / 18,
    damping: float = 0.05,
    inside: float = 0.25,
    stiffness: float = 1.0,
    inertia: float = 1.0,
    frequency: float = 0.8,
) -> PiecewiseOscillator:
    """The paper's gear pair; its frequencies are nondimensional.

    Parameters
    ----------
    mean_force, force : B₀ and B₁.
    half_gap : b, 10° in the paper [rad].
    damping, inside, stiffness, inertia : c, α, k, I.
    frequency : ω of a single motion; a frequency response sets its own.
    """
    return PiecewiseOscillator.gap(
        half_gap, stiffness, inside, damping, mean_force * inertia, force * inertia, frequency, inertia=inertia,
        name="gear pair",
    )  # fmt: skip
