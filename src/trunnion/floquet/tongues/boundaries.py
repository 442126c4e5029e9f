"""Functions of the characteristic coefficients that vanish where stability changes.

With Σ_k (−1)^k e_k σ^{m−k} the characteristic polynomial P of the monodromy matrix, a multiplier crosses the unit
circle at 1 where P(1) = 0, at −1 where P(−1) = 0, and as a complex pair where the last but one Hurwitz determinant of
(1 − s)^m P((1 + s)/(1 − s)) vanishes, which is ∏_{i<j}(1 − σ_iσ_j) but for a factor. All three are polynomials in e
and so analytic in every parameter.

Without damping multipliers come as σ, 1/σ and the third is zero everywhere. Then y = σ + 1/σ has a polynomial of half
the degree, and complex quadruples are born where its discriminant vanishes.
"""

from __future__ import annotations

from functools import cache
from math import comb

import numpy as np

from trunnion.arrays import Array, Complex

MOST = 6
"""Coefficients up to which these functions are used; beyond, coefficients are too ill-conditioned."""


def boundary_functions(e: Array, undamped: bool) -> Array:
    """(functions, …) of coefficients e (m, …) with m = 2, 4 or 6; two functions for m = 2 without damping.

    The highest power of e in any of them is m − 1.
    """
    m = len(e)
    signs = (-1.0) ** np.arange(1, m + 1)
    at_one = 1 + np.tensordot(signs, e, 1)
    at_minus_one = 1 + e.sum(axis=0)
    if not undamped:
        return np.stack([at_one, at_minus_one, _hurwitz(e)])
    if m == 2:
        return np.stack([at_one, at_minus_one])
    return np.stack([at_one, at_minus_one, _discriminant(e)])


@cache
def _to_half_plane(m: int) -> Array:
    """Matrix from (1, −e₁, e₂, …) to the coefficients of (1 − s)^m P((1 + s)/(1 − s)), s⁰ first."""
    rows = [np.polynomial.polynomial.polypow([1.0, 1.0], m - k) for k in range(m + 1)]
    minus = [np.array([comb(k, i) * (-1.0) ** i for i in range(k + 1)]) for k in range(m + 1)]
    return np.stack([np.convolve(a, b) for a, b in zip(rows, minus, strict=True)], axis=1)


def _hurwitz(e: Array) -> Array:
    m = len(e)
    signs = (-1.0) ** np.arange(1, m + 1)
    signed = np.concatenate([np.ones((1, *e.shape[1:])), np.moveaxis(signs * np.moveaxis(e, 0, -1), -1, 0)])
    a = np.tensordot(_to_half_plane(m), signed, 1)
    if m == 2:
        return np.asarray(a[1])
    if m == 4:
        return np.asarray(a[1] * a[2] * a[3] - a[0] * a[3] ** 2 - a[1] ** 2 * a[4])
    return _fifth(*a)


def _fifth(a0: Array, a1: Array, a2: Array, a3: Array, a4: Array, a5: Array, a6: Array) -> Array:
    """The fifth Hurwitz determinant of Σ a_k s^k, written out: cheaper than a matrix at every point."""
    first = a1 * a5 * (2 * a4 * a5 - 3 * a3 * a6) - a0 * a5**3 + a2 * a3 * a5**2 + a3**2 * (a3 * a6 - a4 * a5)
    second = a6 * (2 * a2 * a5 + a3 * a4 - a1 * a6) - a4**2 * a5
    return np.asarray(a0 * first + a1 * (a1 * second + a2 * (a3 * (a4 * a5 - a3 * a6) - a2 * a5**2)))


def _discriminant(e: Array) -> Array:
    if len(e) == 4:
        return np.asarray(e[0] ** 2 - 4 * (e[1] - 2))
    b, c, d = -e[0], e[1] - 3, -(e[2] - 2 * e[0])
    return np.asarray(18 * b * c * d - 4 * b**3 * d + b**2 * c**2 - 4 * c**3 - 27 * d**2)


def parted(multipliers: Complex) -> Array:
    """Of all multipliers (points, 2n) of undamped lines, a number (points,) that is positive where two have parted in
    modulus, with a slope where they do: (ln ρ)² − (Δθ/2)² of the two whose phases are nearest, conjugates included.

    Two that meet are e^{iθ ± √D} with D smooth through 0; all others stand on the circle and farther apart.
    """
    phase = np.sort(np.abs(np.angle(multipliers)), axis=1)[:, ::2]  # each stands there twice, as conjugates or real
    half = np.concatenate([phase[:, :1], np.diff(phase, axis=1) / 2, np.pi - phase[:, -1:]], axis=1)
    return np.asarray(np.log(np.abs(multipliers).max(axis=1)) ** 2 - half.min(axis=1) ** 2)
