"""Numbers an engineer compares: irregularity, equivalent angle, peaks, what stands and what turns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


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


def extremes(values: Array) -> tuple[Array, Array]:
    """Smallest and largest value of curves sampled along the last axis, refined by a parabola.

    The samples cover a turn whose end is left out: the last is followed by the first, where the curve closes.
    """
    return -_peak(-values), _peak(values)


def _peak(values: Array) -> Array:
    n = values.shape[-1]
    at = np.expand_dims(np.argmax(values, axis=-1), -1)
    below, top, above = (np.take_along_axis(values, (at + k) % n, -1)[..., 0] for k in (-1, 0, 1))
    bend, slope = below - 2 * top + above, (above - below) / 2
    # a line whose ratios do not bring it back to its start has no neighbour across the ends
    steps = np.abs(np.diff(values, axis=-1))
    gap = np.abs(values[..., 0] - values[..., -1])
    inside = (at[..., 0] > 0) & (at[..., 0] < n - 1) | (gap <= 3 * np.maximum(steps[..., 0], steps[..., -1]))
    return top + np.divide(-(slope**2), 2 * bend, out=np.zeros_like(top), where=inside & (bend < 0))


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
