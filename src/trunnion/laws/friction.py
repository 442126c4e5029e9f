"""Dry friction in a spring: Jenkins elements, a spring of stiffness k in series with a slider that holds T.

The deflection x of the spring follows the twist q while the slider sticks, |x| ≤ δ = T/k, and stands still at ± δ
while it slips, so the torque kx is T there. Over a cycle of amplitude A ≥ δ it encloses 4T(A − δ). Several in parallel
make any symmetric hysteresis of Masing's kind; with springs beside them the bilinear hysteretic oscillator of Caughey
(1960) and Masri (1975). Angles in rad.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def lost_per_cycle(torque: ArrayLike, stiffness: ArrayLike, amplitude: ArrayLike) -> Array:
    """Energy [J] that one element takes in a cycle of the twist between ± ``amplitude``: 4T(A − T/k)."""
    torque, amplitude = np.asarray(torque, dtype=float), np.asarray(amplitude, dtype=float)
    return np.asarray(4 * torque * np.maximum(amplitude - torque / np.asarray(stiffness), 0.0))


def mean_stiffness(torque: ArrayLike, stiffness: ArrayLike, amplitude: ArrayLike) -> Array:
    """In-phase torque over twist [N m/rad] of the fundamental of one element at q = A cos θ.

    k (θ* − ½ sin 2θ*)/π with cos θ* = 1 − 2δ/A; k while it does not slip (Caughey 1960).
    """
    stiffness = np.asarray(stiffness, dtype=float)
    slip = np.asarray(torque, dtype=float) / stiffness / np.asarray(amplitude, dtype=float)
    turned = np.arccos(np.clip(1 - 2 * slip, -1.0, 1.0))
    return np.asarray(stiffness * (turned - np.sin(2 * turned) / 2) / np.pi)


def mean_slope(knots: Array, slopes: Array, amplitude: float) -> float:
    """The same of a spring with stages: slopes (n + 1,) between rising knots (n,) [rad], the torque 0 at no twist.

    (1/πA) ∮ f(A cos θ) cos θ dθ, piece by piece: each kink at κ, |κ| < A, adds (φ − ½ sin 2φ)/π of its change of
    slope with cos φ = |κ|/A, on its own side of no twist.
    """
    middle = float(slopes[int(np.sum(knots < 0))])
    total = middle
    for kink, below, above in zip(knots, slopes[:-1], slopes[1:], strict=True):
        beyond, inside = (above, below) if kink >= 0 else (below, above)
        angle = np.arccos(min(abs(kink) / amplitude, 1.0))
        total += (beyond - inside) * (angle - np.sin(2 * angle) / 2) / np.pi
    return float(total)
