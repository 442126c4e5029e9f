"""What a window shows of an amplitude that changes while it lasts: the middle of the polynomial nearest to it.

Of amplitudes Y(s), −1 ≤ s ≤ 1, least squares give the value in the middle of the polynomial p of degree d for which
∫ ρ |Y − p|² ds is least, ρ the density of samples: a mean of Y by weights, not Y(0). For even samples and d = 2 the
weights are (9 − 15s²)/8 ds. Where Y is known, of a line say, its mean is what to compare; where it is not, terms of
higher degree in the residual tell how far the mean is off.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial import legendre

from trunnion.arrays import Array, Complex

HIGHER = (2, 4, 6)
"""Degrees beyond that of a window's polynomials that residuals are searched for; odd ones vanish in the middle."""


def middle_weights(degree: int, density: Array, nodes: int) -> Array:
    """Weights (node, kind) at Gauss's ``nodes`` of a window that give the middle of the polynomial of a ``degree``.

    density : of samples (node, kind), in any unit.
    """
    s, step = legendre.leggauss(nodes)
    powers = s[:, None] ** np.arange(degree + 1)
    weight = step[:, None] * density
    normal = np.einsum("qk,qi,qj->kij", weight, powers, powers)
    first = np.linalg.inv(normal)[:, 0]
    return np.asarray(weight * (powers @ first.T))


def missed_in_the_middle(
    residual: Array, s: Array, phase: Array, orders: Array, degree: int, noise: float
) -> tuple[Array, Array]:
    """How far the middle of polynomials of a ``degree`` is off (order,), by the residuals (sample,) of a window, and
    what ``noise``, the standard deviation of a sample, makes that look like by chance, both rms.

    A Legendre polynomial of the residual adds its coefficient times its value in the middle.
    """
    turned = residual[:, None] * np.exp(-1j * np.multiply.outer(phase, orders))
    found, chance = np.zeros(len(orders)), 0.0
    for beyond in HIGHER:
        wave = legendre.legval(s, np.eye(degree + beyond + 1)[-1])
        middle = float(legendre.legval(0.0, np.eye(degree + beyond + 1)[-1]))
        power = float(wave @ wave)
        coefficient: Complex = 2 * (wave @ turned) / power
        found += np.abs(middle * coefficient) ** 2
        chance += 4 * (noise * middle) ** 2 / power
    return np.sqrt(found), np.full(len(orders), np.sqrt(chance))
