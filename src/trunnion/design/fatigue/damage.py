"""Damage of cycles by an S–N curve, after Palmgren and Miner: D = Σ n/N.

    N = N₀ (S₀/S)^k                     the curve, fully reversed; below S₀ the same, with 2k − 1, or no damage
    S = S_a/(1 − |S_m|/S_u)             Goodman's line
    S = S_a + M |S_m|                   for |S_m| ≤ S_a                          FKM guideline, shear
    S = (1 + M)(S_a + M/3 |S_m|)/(1 + M/3)      up to |S_m| ≤ 3 S_a
    S = (1 + M)² S_a/(1 + M/3)          beyond

S_a and S_m are the amplitude and the mean of a cycle. A shaft in torsion bears a mean of either sign alike, so its
magnitude counts. Palmgren and Miner's sum (1945) knows no order of loads; the exponent 2k − 1 is Haibach's; the fields
of the FKM guideline are given in form, M is the user's.
"""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array
from trunnion.design.fatigue.cycles import Cycles
from trunnion.driveline.sn_curves import SNCurve


def reversed_amplitude(curve: SNCurve, amplitude: Array, mean: Array) -> Array:
    """The amplitude (cycles,) about zero that does what each cycle does; infinite where its mean alone breaks."""
    size = np.abs(mean)
    if curve.ultimate is not None:
        left = 1 - size / curve.ultimate
        return np.where(left > 0, amplitude / np.where(left > 0, left, 1.0), np.inf)
    if curve.mean_sensitivity is None:
        return amplitude
    m = curve.mean_sensitivity
    middle = (1 + m) * (amplitude + m / 3 * size) / (1 + m / 3)
    high = (1 + m) ** 2 * amplitude / (1 + m / 3)
    return np.where(size <= amplitude, amplitude + m * size, np.where(size <= 3 * amplitude, middle, high))


def cycles_to_failure(curve: SNCurve, amplitude: Array) -> Array:
    """N (cycles,) of fully reversed amplitudes; infinite where nothing is damaged."""
    with np.errstate(divide="ignore", over="ignore"):
        share = curve.amplitude / amplitude
        slope = np.full_like(share, curve.slope)
        below = share > 1
        if curve.miner == "modified":
            slope[below] = 2 * curve.slope - 1
        found = curve.cycles * share**slope
    return np.where(below, np.inf, found) if curve.miner == "original" else found


def damage(curve: SNCurve, cycles: Cycles, more: float = 0.0) -> Array:
    """n/N (cycles,) of each; ``more``: what every amplitude may be low by."""
    amplitude = reversed_amplitude(curve, cycles.amplitude + more, cycles.mean)
    with np.errstate(divide="ignore"):
        return np.asarray(cycles.count / cycles_to_failure(curve, amplitude))
