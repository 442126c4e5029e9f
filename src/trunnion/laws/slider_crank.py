"""Inertia torque of the reciprocating mass of a slider crank, exactly.

The piston stands at x = r (cos θ + √(1 − λ² sin² θ)/λ), λ = r/l; its mass m adds J(θ) = m (dx/dθ)² to the crank, which
at constant speed ω takes the torque −½ J′ ω² from it. To first order in λ

    T = m r² ω² (λ/4 sin θ − ½ sin 2θ − ¾ λ sin 3θ − …)

as every textbook of engine dynamics has it (Den Hartog, Mechanical Vibrations, ch. 5); the coefficients here are those
of the exact mechanism.
"""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array

SAMPLES = 1024
"""Over a turn: the harmonics fall off as (λ/2)^n, to rounding long before."""


def crank_inertia(angle: Array, share: float) -> Array:
    """J(θ)/(m r²), λ = ``share``; mean ½ nearly."""
    root = np.sqrt(1 - (share * np.sin(angle)) ** 2)
    return np.asarray((np.sin(angle) * (1 + share * np.cos(angle) / root)) ** 2)


def inertia_harmonics(share: float, orders: int) -> tuple[Array, float]:
    """b_n (orders,) of T = m r² ω² Σ b_n sin nθ, n from 1, and the mean of J/(m r²)."""
    angle = 2 * np.pi * np.arange(SAMPLES) / SAMPLES
    spectrum = np.fft.rfft(crank_inertia(angle, share)) / SAMPLES
    # J = J₀ + 2 Σ a_n cos nθ, so −½ J′ = Σ n a_n sin nθ.
    n = np.arange(1, orders + 1)
    return n * spectrum.real[1 : orders + 1], float(spectrum.real[0])
