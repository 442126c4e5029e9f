"""Numbers an engineer compares: irregularity, equivalent angle, peaks, what stands and what turns."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array

ROUNDING = 1e-12
"""Irregularity that is rounding."""


def irregularity(speed: Array, mean: float) -> float:
    """(largest − smallest)/mean of speeds over the turns computed [-]; 0 where it is only rounding."""
    low, high = extremes(speed)
    nonuniform = float((high - low) / abs(mean))
    return nonuniform if nonuniform > ROUNDING else 0.0


def equivalent_angle(irregularity: ArrayLike) -> Array:
    """Bend angle [rad] of the one Hooke's joint with this irregularity U = tan β sin β.

    With c = cos β: c² + Uc − 1 = 0.
    """
    u = np.asarray(irregularity, dtype=float)
    # sin² β = U c, which keeps its figures where β is small and c close to 1
    cosine = (np.sqrt(u**2 + 4) - u) / 2
    return np.arcsin(np.sqrt(u * cosine))


def phasor_angle(angles: ArrayLike, phases: ArrayLike) -> Array:
    """Equivalent angle [rad] of several joints by the small-angle rule |Σ βᵢ² e^{2jχᵢ}|^½.

    Parameters
    ----------
    angles, phases : bend angles βᵢ and input angles χᵢ of the joints from their own planes at one instant
        [rad]; the joints along the last axis.
    """
    phasors = np.asarray(angles) ** 2 * np.exp(2j * np.asarray(phases))
    return np.sqrt(np.abs(phasors.sum(axis=-1)))


REACH = 3
"""Samples to either side of the largest one that its refinement looks at."""
_OFFSETS = np.arange(-REACH, REACH + 1)
_TO_POWERS = np.linalg.inv(np.vander(_OFFSETS.astype(float), increasing=True))
"""Coefficients of the polynomial through values at the offsets, in rising powers of the distance in samples."""


def extremes(values: Array) -> tuple[Array, Array]:
    """Smallest and largest value of curves sampled along the last axis, refined by a polynomial through 7 samples.

    The samples cover a turn whose end is left out: the last is followed by the first, where the curve closes. The
    ratio of a joint at 45° is met to 1e-9 from 180 samples, and to rounding from 720. At a corner, where
    no polynomial fits, the answer is off by up to the step between two samples.
    """
    return -_peak(-values), _peak(values)


def _peak(values: Array) -> Array:
    n = values.shape[-1]
    at = np.expand_dims(np.argmax(values, axis=-1), -1)
    top = np.take_along_axis(values, at, -1)[..., 0]
    if n <= 2 * REACH:
        return top
    near = np.take_along_axis(values, (at + _OFFSETS) % n, -1) - top[..., None]
    below, above = near[..., REACH - 1], near[..., REACH + 1]
    bend, slope = below + above, (above - below) / 2
    # a line whose ratios do not bring it back to its start has no neighbours across the ends
    steps = np.abs(np.diff(values, axis=-1))
    gap = np.abs(values[..., 0] - values[..., -1])
    closed = gap <= 3 * np.maximum(steps[..., 0], steps[..., -1])
    inside = ((at[..., 0] >= REACH) & (at[..., 0] < n - REACH) | closed) & (bend < 0)
    vertex = np.divide(-slope, bend, out=np.zeros_like(top), where=inside)
    rise = -(slope**2) / np.where(inside, 2 * bend, 1.0)
    refined = _vertex(near @ _TO_POWERS.T, vertex)
    smooth = inside & (np.abs(refined - rise) <= np.abs(bend) / 8)
    return top + np.where(smooth, refined, 0.0)


def _vertex(powers: Array, start: Array) -> Array:
    """Largest value of polynomials (..., degree + 1) in rising powers near ``start``, by Newton's method."""
    place = start
    for _ in range(5):
        slope, bend = _value(powers, place, 1), _value(powers, place, 2)
        step = np.divide(slope, bend, out=np.zeros_like(place), where=bend < 0)
        place = np.clip(place - step, -1.0, 1.0)
    return _value(powers, place, 0)


def _value(powers: Array, place: Array, derivative: int) -> Array:
    total = np.zeros_like(place)
    for k in range(powers.shape[-1] - 1, derivative - 1, -1):
        total = total * place + powers[..., k] * math.perm(k, derivative)
    return total


def largest(values: Array) -> Array:
    """Largest magnitude along the last axis, refined as in ``extremes``."""
    low, high = extremes(values)
    return np.maximum(-low, high)


@dataclass(frozen=True)
class Parts:
    """What a vector that repeats with its shaft's rotation is made of.

    ``steady`` stands still: its components along u and v. ``once`` turns with the shaft, ``twice`` at twice
    its speed, ``twice_back`` at twice its speed the other way: amplitudes. ``largest`` is the largest
    magnitude.
    """

    steady: tuple[float, float]
    once: float
    twice: float
    twice_back: float
    largest: float

    @property
    def two_per_turn(self) -> float:
        """Largest deflection of the two-per-turn part, in whatever direction it is largest."""
        return self.twice + self.twice_back


def parts(vector: Array, angle: Array) -> Parts:
    """Split a vector (2, point) along u and v by the shaft's mean rotation ``angle`` [rad] at each point.

    z = F_u + jF_v = Σ c_k e^{jkφ}; positive k turn in the sense of rotation. The points must cover whole
    turns of the shaft.
    """
    z = vector[0] + 1j * vector[1]
    c = {k: complex(np.mean(z * np.exp(-1j * k * angle))) for k in (0, 1, 2, -2)}
    size = float(largest(np.abs(z)))
    return Parts((c[0].real, c[0].imag), abs(c[1]), abs(c[2]), abs(c[-2]), size)
