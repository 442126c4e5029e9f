"""Dry friction in a spring: Jenkins elements, a spring of stiffness k in series with a slider that holds T.

The deflection x of the spring follows the twist q while the slider sticks, |x| ≤ δ = T/k, and stands still at ± δ
while it slips, so the torque kx is T there. Over a cycle of amplitude A ≥ δ it encloses 4T(A − δ). Several in parallel
make any symmetric hysteresis of Masing's kind; with springs beside them the bilinear hysteretic oscillator of Caughey
(1960) and Masri (1975). Angles in rad.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.laws.spring import StageSpring

ROUNDING = 1e-14
"""Mean torque over that of the stiffest stage at the amplitude, that counts as none."""
HALVINGS = 60
"""Of the bracket about a middle: from the amplitude down to rounding."""


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


def over_a_cycle(spring: StageSpring, middle: ArrayLike, amplitude: ArrayLike) -> tuple[Array, Array]:
    """Mean torque [N m] and in-phase torque over twist [N m/rad] of a spring with stages at q = middle + A cos θ.

    Each knot κ adds its change of slope times A (sin φ − φ c)/π to the mean and (φ − ½ sin 2φ)/π to the slope, with
    c = (κ − middle)/A and cos φ = c between −1 and 1. Broadcast over the cases (…,) of the spring.
    """
    middle, amplitude = np.asarray(middle, dtype=float), np.asarray(amplitude, dtype=float)
    place = (spring.knots - middle[..., None]) / amplitude[..., None]
    angle, jump = np.arccos(np.clip(place, -1.0, 1.0)), np.diff(spring.slopes, axis=-1)
    mean = spring.slopes[..., 0] * middle + spring.offsets[..., 0]
    mean = mean + amplitude / np.pi * np.sum(jump * (np.sin(angle) - angle * place), axis=-1)
    return mean, spring.slopes[..., 0] + np.sum(jump * _beyond(angle), axis=-1)


def _beyond(angle: Array) -> Array:
    """Share of a cosine's fundamental beyond the knot that it passes at ± ``angle``."""
    return np.asarray((angle - np.sin(2 * angle) / 2) / np.pi)


def damped_share(spring: StageSpring, damped: Array, middle: Array, amplitude: Array) -> Array:
    """Share of a viscous damper's loss over the cycle that is left when it acts in the ``damped`` stages (…, n + 1)."""
    angle = np.arccos(np.clip((spring.knots - middle[..., None]) / amplitude[..., None], -1.0, 1.0))
    acts = damped.astype(float)
    return np.asarray(acts[..., 0] + np.sum(np.diff(acts, axis=-1) * _beyond(angle), axis=-1))


def middle_under(spring: StageSpring, torque: ArrayLike, amplitude: ArrayLike) -> Array:
    """Twist [rad] about which a swing of ± ``amplitude`` has the mean ``torque`` [N m]; NaN where no stage carries it.

    The mean over a swing lies between the torques at its ends, which brackets the middle within ± A of the static
    twist; halved until it stands still.
    """
    torque, amplitude = np.broadcast_arrays(np.asarray(torque, dtype=float), np.asarray(amplitude, dtype=float))
    stage = spring.stage_under(torque)
    slope, offset = spring.of(spring.slopes, stage), spring.of(spring.offsets, stage)
    static = np.divide(torque - offset, slope, out=np.full(torque.shape, np.nan), where=slope > 0)
    static = np.where(torque == 0, 0.0, static)
    low, high = static - amplitude, static + amplitude
    for _ in range(HALVINGS if spring.knots.shape[-1] else 0):
        middle = (low + high) / 2
        above = over_a_cycle(spring, middle, amplitude)[0] > torque
        low, high = np.where(above, low, middle), np.where(above, middle, high)
    middle = (low + high) / 2
    # Within free play the mean is 0 over a whole range of middles: about no twist, then.
    still = np.abs(over_a_cycle(spring, np.zeros_like(torque), amplitude)[0])
    idle = (torque == 0) & (still <= ROUNDING * amplitude * spring.slopes.max(axis=-1))
    return np.where(idle, 0.0, middle)
