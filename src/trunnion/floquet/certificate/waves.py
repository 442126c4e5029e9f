"""Periodic functions of an angle that also depend on a few parameters, with all that is left out bounded.

A ``Wave`` is f(τ, p) = Σ_m (c_0m + Σ_v p_v c_vm) e^{imsτ} + g(τ, p) for −1 ≤ p_v ≤ 1, with |g| ≤ ``rest`` for all τ, p:
a Fourier series in the angle, linear in the parameters. What products leave of second order in p, harmonics beyond the
last one kept, and rounding go into the rest (*Taylor models*, after Makino and Berz, with Fourier series in place of
polynomials). Sums of moduli of harmonics bound a wave from above.

Of the first parameter more can be kept: with ``powers`` the last rows are those of the Chebyshev polynomials
T₂(p₁), T₃(p₁) …, for which 2 T_a T_b = T_{a+b} + T_{|a−b|} and |T_a| ≤ 1. Whoever takes each for a parameter of its own
bounds more than there is.

Rounding. Sums and products of IEEE doubles are right to u = 2⁻⁵³; a product of two waves is a sum of less than
n = 2 (harmonics) + 4 (parameters) + 16 terms in any order, so its error is below 4nu times the product of both sums of
moduli (Higham, Accuracy and Stability of Numerical Algorithms, 3.1 and 3.6). ``ROUND`` u is twice that of every term.
Bounds are computed in the same arithmetic and widened by ``OUTWARD``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np

from trunnion.arrays import Complex

UNIT = 2.0**-53
ROUND = 8 * UNIT
OUTWARD = 1 + 1e-12
"""Widens sums of up to some thousand positive terms, which rounding may have left short."""
LIBRARY = 16 * UNIT
"""Error of exp(ix) for |x| < 1000, of which C libraries reach one or two units in the last place."""
SMALL = 1e-19
"""A term of a series this small is counted in its rest."""


@dataclass(frozen=True)
class Wave:
    """``parts`` (1 + parameters + powers, 2K + 1): harmonics −K … K of the middle, then of what each parameter adds."""

    parts: Complex
    rest: float
    powers: int = 0

    @cached_property
    def sizes(self) -> Complex:
        """Bounds of the middle and of each parameter's part (1 + parameters,)."""
        return np.abs(self.parts).sum(axis=1) * OUTWARD

    @cached_property
    def size(self) -> float:
        """A bound of |f|."""
        return (float(self.sizes.sum()) + self.rest) * OUTWARD

    @property
    def last(self) -> int:
        """K."""
        return self.parts.shape[1] // 2

    @property
    def mean(self) -> complex:
        """The middle's mean over a turn."""
        return complex(self.parts[0, self.last])

    @property
    def still(self) -> bool:
        """Whether nothing moves it, neither angle nor parameters."""
        return float(self.sizes.sum()) <= abs(self.mean) * OUTWARD

    def along(self, parameter: int) -> Wave:
        """What one parameter alone makes of it, without its rest; beside the first where that has powers, of which the
        middle holds a part."""
        parts = np.zeros_like(self.parts)
        kept = [*(chebyshev_rows(len(parts), self.powers) if self.powers else [0]), parameter]
        parts[kept] = self.parts[kept]
        return Wave(parts, 0.0, self.powers)

    def __add__(self, other: Wave | complex) -> Wave:
        if not isinstance(other, Wave):
            other = constant(other, self)
        parts = self.parts + other.parts
        rest = (self.rest + other.rest + ROUND * (self.size + other.size)) * OUTWARD
        return Wave(parts, rest, max(self.powers, other.powers))

    __radd__ = __add__

    def __neg__(self) -> Wave:
        return Wave(-self.parts, self.rest, self.powers)

    def __sub__(self, other: Wave | complex) -> Wave:
        return self + (-other)

    def __rsub__(self, other: complex) -> Wave:
        return -self + other

    def __mul__(self, other: Wave | complex) -> Wave:
        if not isinstance(other, Wave):
            rest = (self.rest * abs(other) + ROUND * self.size * abs(other)) * OUTWARD
            return Wave(self.parts * other, rest, self.powers)
        count, last, powers = self.parts.shape[0], self.last, max(self.powers, other.powers)
        parts, lost = np.zeros_like(self.parts), 0.0
        rows = chebyshev_rows(count, powers) if powers else [0]
        alone = [v for v in range(1, count) if v not in rows]
        degrees: dict[int, Complex] = {}
        for a, b in product(range(len(rows)), repeat=2):
            one, two = self.parts[rows[a]], other.parts[rows[b]]
            if not (a or b) or (one.any() and two.any()):
                whole = np.convolve(one, two)
                ends = (a + b, abs(a - b)) if a and b else (a + b,)
                for degree in ends:
                    share: Complex = np.asarray(whole / len(ends), dtype=complex)
                    degrees[degree] = degrees[degree] + share if degree in degrees else share
        for degree, whole in degrees.items():
            lost += np.abs(whole[:last]).sum() + np.abs(whole[3 * last + 1 :]).sum()
            if degree < len(rows):
                parts[rows[degree]] = whole[last : 3 * last + 1]
            else:
                lost += np.abs(whole[last : 3 * last + 1]).sum()
        for v in alone:
            if self.parts[v].any() or other.parts[v].any():
                whole = np.convolve(self.parts[0], other.parts[v]) + np.convolve(self.parts[v], other.parts[0])
                lost += np.abs(whole[:last]).sum() + np.abs(whole[3 * last + 1 :]).sum()
                parts[v] = whole[last : 3 * last + 1]
        along, along_others = self.sizes[rows[1:]].sum(), other.sizes[rows[1:]].sum()
        moved, others = self.sizes[alone].sum(), other.sizes[alone].sum()
        rest = lost + moved * (others + along_others) + along * others
        rest += self.size * other.rest + self.rest * (other.size - other.rest)
        rest += ROUND * (2 * last + 2 * count + 4 * powers + 16) * self.size * other.size
        return Wave(parts, float(rest) * OUTWARD, powers)

    __rmul__ = __mul__

    def conjugate(self) -> Wave:
        """Its complex conjugate for real τ and p."""
        return Wave(self.parts[:, ::-1].conj(), self.rest, self.powers)

    def inverse(self) -> Wave:
        """1/f; ``ZeroDivisionError`` where f may vanish.

        A guess g of 1/f is right to |g| r/(1 − r) with r a bound of |1 − fg|.
        """
        last, count = self.last, self.parts.shape[0]
        times = 4 * last + 2
        values = _on_grid(self.parts[:1], times)[0]
        if not np.abs(values).min() > 0:
            raise ZeroDivisionError
        over = 1 / values
        guess = np.zeros_like(self.parts)
        guess[0] = _harmonics(over[None], last)[0]
        if count > 1 and self.parts[1:].any():
            guess[1:] = _harmonics(-(over**2) * _on_grid(self.parts[1:], times), last)
        made = Wave(guess, 0.0, self.powers)
        for _ in range(self.powers):  # Newton's steps, for the products of what the first parameter moves
            made = Wave((made * (2.0 - self * made)).parts, 0.0, self.powers)
        left = (1.0 - self * made).size
        if not left < 1:
            raise ZeroDivisionError
        return Wave(made.parts, made.size * left / (1 - left) * OUTWARD, self.powers)

    def exp(self) -> Wave:
        """e^f, by its series of a 2^k-th part, squared k times; the mean apart."""
        mean = self.mean
        small = self - mean
        halvings = max(0, math.ceil(math.log2(max(small.size, 1e-300))) + 2)
        small = small * 0.5**halvings
        found, term, k, bound = small + 1.0, small, 1, small.size
        while bound > SMALL:
            k += 1
            term = term * small * (1 / k)
            found = found + term
            bound = bound * small.size / k
        found = Wave(found.parts, (found.rest + 2 * bound) * OUTWARD, found.powers)
        for _ in range(halvings):
            found = found * found
        scale = complex(np.exp(mean))
        made = found * scale
        rest = (made.rest + LIBRARY * (1 + abs(mean)) * abs(scale) * found.size) * OUTWARD
        return Wave(made.parts, rest, made.powers)

    def shifted(self, harmonics: int) -> Wave:
        """f e^{ihsτ}."""
        parts, last = np.zeros_like(self.parts), self.last
        if abs(harmonics) > 2 * last:
            return Wave(parts, self.size, self.powers)
        if harmonics >= 0:
            parts[:, harmonics:] = self.parts[:, : 2 * last + 1 - harmonics]
            lost = np.abs(self.parts[:, 2 * last + 1 - harmonics :]).sum()
        else:
            parts[:, :harmonics] = self.parts[:, -harmonics:]
            lost = np.abs(self.parts[:, :-harmonics]).sum()
        return Wave(parts, (self.rest + float(lost)) * OUTWARD, self.powers)


def chebyshev_rows(count: int, powers: int) -> list[int]:
    """Of ``count`` rows those of 1, p₁, T₂(p₁) …"""
    return [*range(min(count, 2)), *range(count - powers, count)]


def constant(value: complex, like: Wave) -> Wave:
    """A constant of the same shape."""
    parts = np.zeros_like(like.parts)
    parts[0, like.last] = value
    return Wave(parts, 0.0)


def affine(value: float, slopes: dict[int, float], parameters: int, last: int, rest: float = 0.0) -> Wave:
    """value + Σ p_v slope_v, without harmonics; ``slopes`` by number of the parameter, from 1."""
    parts = np.zeros((1 + parameters, 2 * last + 1), dtype=complex)
    parts[0, last] = value
    for v, slope in slopes.items():
        parts[v, last] += slope
    return Wave(parts, rest)


def turning(order: float, phase: Wave, wave: Wave, harmonics: int) -> Wave:
    """exp(i·order·(phase + wave)) e^{i harmonics sτ}."""
    return ((phase + wave) * (1j * order)).exp().shifted(harmonics)


def ahead(moved: Wave) -> Wave:
    """Im(−log(1 − f)) = Im Σ f^k/k, |f| < 1; ``ZeroDivisionError`` elsewhere."""
    size = moved.size
    if not size < 0.999:
        raise ZeroDivisionError
    found, power, k = moved, moved, 1
    while power.size / (1 - size) > SMALL and k < 2000:
        k += 1
        power = power * moved
        found = found + power * (1 / k)
        if power.rest > 0.5 * power.size:  # nothing but its rest is left
            break
    bound = power.size / (1 - size) * size
    found = Wave(found.parts, (found.rest + bound) * OUTWARD, found.powers)
    return (found - found.conjugate()) * (-0.5j)


def _on_grid(parts: Complex, times: int) -> Complex:
    """Values at ``times`` even angles of a turn, rows alike; floating point, for guesses alone."""
    last = parts.shape[1] // 2
    spread = np.zeros((len(parts), times), dtype=complex)
    spread[:, : last + 1], spread[:, times - last :] = parts[:, last:], parts[:, :last]
    return np.fft.ifft(spread, axis=1) * times


def _harmonics(values: Complex, last: int) -> Complex:
    found = np.fft.fft(values, axis=1) / values.shape[1]
    return np.concatenate([found[:, values.shape[1] - last :], found[:, : last + 1]], axis=1)
