"""Dampers for one mode at their best, by the ratio μ of the ring's inertia to the effective inertia of the mode.

Houdaille's damper, a ring in oil without a spring: all resonance curves over ω/ω_n, whatever the damping, go through
one point besides 0, at (ω/ω_n)² = 2/(2 + μ), whose height is (2 + μ)/μ over the static twist. The damping whose curve
is highest there is the best:

    ζ = c/(2 J_r ω_n) = 1/√(2 (1 + μ)(2 + μ)).

A ring on a spring and a damper (Den Hartog, *Mechanical Vibrations*, 4th ed., section 3.3): two such points, which are
equally high, √((2 + μ)/μ), where the ring alone on its spring has the frequency ω_n/(1 + μ); and a damping between the
two whose curves are highest in one or the other,

    c/(2 J_r ω_n) = √(3 μ/(8 (1 + μ)³)).

Minimising the peak itself takes a little more damping (0.2208 for 0.2165 at μ = 1).
"""

from __future__ import annotations

from math import sqrt


def viscous_optimum(ratio: float) -> tuple[float, float]:
    """Damping ratio c/(2 J_r ω_n) and largest amplification of a ring in oil."""
    return 1 / sqrt(2 * (1 + ratio) * (2 + ratio)), (2 + ratio) / ratio


def tuned_optimum(ratio: float) -> tuple[float, float, float]:
    """Tuning ω_ring/ω_n, damping ratio c/(2 J_r ω_n), and the amplification at both fixed points."""
    return 1 / (1 + ratio), sqrt(3 * ratio / (8 * (1 + ratio) ** 3)), sqrt((2 + ratio) / ratio)
