"""Periodic functions of an angle that also depend on a few parameters, with all that is left out bounded.

A ``Wave`` is f(τ, p) = Σ_m Σ_α c_αm T_α(p) e^{imsτ} + g(τ, p) for −1 ≤ p_v ≤ 1, with |g| ≤ ``rest`` for all τ, p:
a Fourier series in the angle, linear in the parameters, and with ``Terms`` also of their products
T_α = T_{α₁}(p₁) T_{α₂}(p₂) … of Chebyshev polynomials, for which 2 T_a T_b = T_{a+b} + T_{|a−b|} and |T_a| ≤ 1. What
products leave of higher order in p, harmonics beyond the last one kept, and rounding go into the rest (*Taylor models*,
after Makino and Berz, with Chebyshev and Fourier series in place of polynomials). Sums of moduli of harmonics bound a
wave from above. Whoever takes each product for a parameter of its own bounds more than there is.

Rounding. Sums and products of IEEE doubles are right to u = 2⁻⁵³; a product of two waves is a sum of less than
n = 2 (harmonics) + (pairs of rows) + 16 terms in any order, so its error is below 4nu times the product of both sums of
moduli (Higham, Accuracy and Stability of Numerical Algorithms, 3.1 and 3.6). ``ROUND`` u is twice that of every term.
Bounds are computed in the same arithmetic and widened by ``OUTWARD``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from trunnion.arrays import Array, Complex

UNIT = 2.0**-53
ROUND = 8 * UNIT
OUTWARD = 1 + 1e-12
"""Widens sums of up to some thousand positive terms, which rounding may have left short."""
LIBRARY = 16 * UNIT
"""Error of exp(ix) for |x| < 1000, of which C libraries reach one or two units in the last place."""
SMALL = 1e-19
"""A term of a series this small is counted in its rest."""
BESIDE = 1e-3
"""So is one this small beside what the rest already is."""
INVERTED = 2
"""Newton's steps to an inverse with products of parameters."""


Exponents = tuple[int, ...]


@dataclass(frozen=True)
class _Pairs:
    """Products of rows ``one`` and ``two`` (pairs,), and the ``share`` (made, pairs) of each in the rows ``made``, of
    which the first ``kept`` are rows of a wave; None where each makes one row, in that order."""

    one: Array
    two: Array
    made: Array
    share: Array | None
    kept: int

    @classmethod
    def of(cls, one: Array, two: Array, share: Array, kept: int) -> _Pairs:
        """By shares in all rows, with ``kept`` of a wave."""
        made: Array = np.asarray(np.flatnonzero(share.any(axis=1)))
        share, kept = share[made], int((made < kept).sum())
        if len(made) == len(one) == np.count_nonzero(share) > 0:
            order = share.argmax(axis=1)
            return cls(one[order], two[order], made, None, kept)
        return cls(one, two, made, share, kept)


@dataclass(frozen=True, eq=False)
class Terms:
    """Which products T_α of Chebyshev polynomials rows of waves are: ``exponents`` α of each, all 0 first, then those
    of single parameters. With each, all of lower exponents are there."""

    exponents: tuple[Exponents, ...]

    def __len__(self) -> int:
        return len(self.exponents)

    @cached_property
    def row(self) -> dict[Exponents, int]:
        """By exponents."""
        return {one: k for k, one in enumerate(self.exponents)}

    def power(self, parameter: int, degree: int) -> int | None:
        """The row of T_degree of one parameter, from 1; None where it is not kept."""
        if parameter > len(self.exponents[0]):
            return None
        return self.row.get(tuple(degree * (v == parameter) for v in range(1, 1 + len(self.exponents[0]))))

    def rows(self, lower: Terms) -> list[int]:
        """Where those of ``lower`` stand among these."""
        return [self.row[one] for one in lower.exponents]

    @cached_property
    def _all_pairs(self) -> tuple[Array, Array, Array]:
        """Rows of pairs and where they go: those whose highest term is kept, and all powers of the first parameter, of
        which boxes are widest."""
        powers = self.power(1, 2) is not None
        alone = [k for k, one in enumerate(self.exponents) if powers and not any(one[1:])]
        pairs, goes, made = list[tuple[int, int]](), list[tuple[int, int, float]](), dict(self.row)
        for a, one in enumerate(self.exponents):
            for b, two in enumerate(self.exponents):
                if tuple(x + y for x, y in zip(one, two, strict=True)) in self.row or (a in alone and b in alone):
                    ends = _ends(one, two)
                    goes += [(made.setdefault(end, len(made)), len(pairs), 1 / len(ends)) for end in ends]
                    pairs.append((a, b))
        share = np.zeros((len(made), len(pairs)))
        for to, pair, part in goes:
            share[to, pair] += part
        first, second = np.array(pairs).T
        return first, second, share

    @cached_property
    def left(self) -> Array:
        """1 for each pair of rows whose product is not taken, 0 elsewhere (rows, rows)."""
        found = np.ones((len(self), len(self)))
        one, two, _ = self._all_pairs
        found[one, two] = 0.0
        return found

    @cached_property
    def _known(self) -> dict[tuple[bytes, bytes], _Pairs]:
        return {}

    def pairs(self, one: Array, two: Array) -> _Pairs:
        """Of rows that are not empty (rows,)."""
        key = one.tobytes(), two.tobytes()
        if key not in self._known:
            first, second, share = self._all_pairs
            some = one[first] & two[second]
            self._known[key] = _Pairs.of(first[some], second[some], share[:, some], len(self))
        return self._known[key]


def _ends(one: Exponents, two: Exponents) -> list[Exponents]:
    """T_one T_two is the mean of the terms with these."""
    found: list[Exponents] = [()]
    for a, b in zip(one, two, strict=True):
        found = [(*start, end) for start in found for end in ((a + b, abs(a - b)) if a and b else (a + b,))]
    return found


@lru_cache(maxsize=64)
def terms_of(parameters: int, degree: int, first: int = 0) -> Terms:
    """All whose exponents add up to ``degree`` at most, and of the first parameter those to ``first``."""
    found: list[Exponents] = [(0,) * parameters]
    level = found
    for _ in range(degree):
        more = [(*one[:v], one[v] + 1, *one[v + 1 :]) for one in level for v in range(parameters)]
        level = list(dict.fromkeys(more))
        found += level
    if parameters:
        found += [(k, *(0,) * (parameters - 1)) for k in range(degree + 1, first + 1)]
    return Terms(tuple(found))


@dataclass(frozen=True)
class Wave:
    """``parts`` (rows, 2K + 1): harmonics −K … K of the middle, then of what each parameter adds, then of products,
    where it has ``terms``."""

    parts: Complex
    rest: float
    terms: Terms | None = None

    @cached_property
    def sizes(self) -> Complex:
        """Bounds of the middle and of each parameter's part (1 + parameters,)."""
        return np.abs(self.parts).sum(axis=1) * OUTWARD

    @cached_property
    def kept(self) -> float:
        """A bound of what is not in the rest."""
        return float(self.sizes.sum()) * OUTWARD

    @cached_property
    def size(self) -> float:
        """A bound of |f|."""
        return (self.kept + self.rest) * OUTWARD

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

    @cached_property
    def filled(self) -> Array:
        """Which rows are not empty (rows,)."""
        return np.asarray(self.parts.any(axis=1))

    @cached_property
    def reach(self) -> int:
        """The last harmonic that is not 0."""
        some = np.flatnonzero(self.parts.any(axis=0))
        return int(np.abs(some - self.last).max(initial=0))

    def cut(self, terms: Terms) -> Wave:
        """With those terms alone; what the others bring goes to the rest."""
        if self.terms is None or self.terms is terms:
            assert len(self.parts) == len(terms)
            return self
        rows = self.terms.rows(terms)
        others = np.delete(self.sizes, rows).sum()
        return Wave(self.parts[rows], (self.rest + float(others)) * OUTWARD, terms)

    @property
    def middle(self) -> Wave:
        """As the middle of all parameters makes it, without what is left out."""
        return Wave(self.parts[:1], 0.0)

    def __add__(self, other: Wave | complex) -> Wave:
        if not isinstance(other, Wave):
            other = constant(other, self)
        parts = self.parts + other.parts
        rest = (self.rest + other.rest + ROUND * (self.size + other.size)) * OUTWARD
        return Wave(parts, rest, self.terms or other.terms)

    __radd__ = __add__

    def __neg__(self) -> Wave:
        return Wave(-self.parts, self.rest, self.terms)

    def __sub__(self, other: Wave | complex) -> Wave:
        return self + (-other)

    def __rsub__(self, other: complex) -> Wave:
        return -self + other

    def __mul__(self, other: Wave | complex) -> Wave:
        if not isinstance(other, Wave):
            rest = (self.rest * abs(other) + ROUND * self.size * abs(other)) * OUTWARD
            return Wave(self.parts * other, rest, self.terms)
        count, last, terms = self.parts.shape[0], self.last, self.terms or other.terms
        known = terms or terms_of(count - 1, 1)
        pairs = known.pairs(self.filled, other.filled)
        parts, lost = np.zeros_like(self.parts), 0.0
        if len(pairs.made):
            reach = self.reach + other.reach
            whole = _convolved(self._shown[pairs.one], other._shown[pairs.two], real=self.real and other.real)
            if pairs.share is not None:
                whole = (pairs.share @ whole.view(float)).view(complex)
            out = max(0, reach - last)
            inside = whole[:, out : 2 * reach + 1 - out]
            lost += np.abs(whole[:, :out]).sum() + np.abs(whole[:, 2 * reach + 1 - out :]).sum()
            lost += np.abs(inside[pairs.kept :]).sum()
            near = min(reach, last)
            parts[pairs.made[: pairs.kept], last - near : last + near + 1] = inside[: pairs.kept]
        rest = lost + float(self.sizes @ known.left @ other.sizes)
        rest += self.size * other.rest + self.rest * (other.size - other.rest)
        rest += ROUND * (4 * last + len(pairs.one) + 16) * self.size * other.size
        return Wave(parts, float(rest) * OUTWARD, terms)

    @cached_property
    def real(self) -> bool:
        """Whether it is, to the last figure."""
        return bool(np.array_equal(self._shown, self._shown[:, ::-1].conj()))

    @cached_property
    def _shown(self) -> Complex:
        """Without the harmonics beyond its reach."""
        return self.parts[:, self.last - self.reach : self.last + self.reach + 1]

    __rmul__ = __mul__

    def conjugate(self) -> Wave:
        """Its complex conjugate for real τ and p."""
        return Wave(self.parts[:, ::-1].conj(), self.rest, self.terms)

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
        made = Wave(guess, 0.0, self.terms)
        left = 1.0 - self * made
        for _ in range(INVERTED):  # Newton's steps, for products of what parameters move
            if not left.kept > left.rest:
                break
            made = Wave((made + made * left).parts, 0.0, self.terms)
            left = 1.0 - self * made
        if not left.size < 1:
            raise ZeroDivisionError
        return Wave(made.parts, made.size * left.size / (1 - left.size) * OUTWARD, self.terms)

    def exp(self) -> Wave:
        """e^f, by its series of a 2^k-th part, squared k times; the mean apart."""
        mean = self.mean
        small = self - mean
        halvings = max(0, math.ceil(math.log2(max(small.size, 1e-300))) + 2)
        small = small * 0.5**halvings
        found, term, k, bound = small + 1.0, small, 1, small.size
        while bound > max(SMALL, BESIDE * found.rest):
            k += 1
            term = term * small * (1 / k)
            found = found + term
            bound = bound * small.size / k
        found = Wave(found.parts, (found.rest + 2 * bound) * OUTWARD, found.terms)
        for _ in range(halvings):
            found = found * found
        scale = complex(np.exp(mean))
        made = found * scale
        rest = (made.rest + LIBRARY * (1 + abs(mean)) * abs(scale) * found.size) * OUTWARD
        return Wave(made.parts, rest, made.terms)

    def shifted(self, harmonics: int) -> Wave:
        """f e^{ihsτ}."""
        parts, last = np.zeros_like(self.parts), self.last
        if abs(harmonics) > 2 * last:
            return Wave(parts, self.size, self.terms)
        if harmonics >= 0:
            parts[:, harmonics:] = self.parts[:, : 2 * last + 1 - harmonics]
            lost = np.abs(self.parts[:, 2 * last + 1 - harmonics :]).sum()
        else:
            parts[:, :harmonics] = self.parts[:, -harmonics:]
            lost = np.abs(self.parts[:, :-harmonics]).sum()
        return Wave(parts, (self.rest + float(lost)) * OUTWARD, self.terms)


def chebyshev_rows(count: int, powers: int) -> list[int]:
    """Of ``count`` rows those of 1, p₁, T₂(p₁) …, of which the ``powers`` stand last."""
    return [*range(min(count, 2)), *range(count - powers, count)]


def constant(value: complex, like: Wave) -> Wave:
    """A constant of the same shape."""
    parts = np.zeros_like(like.parts)
    parts[0, like.last] = value
    return Wave(parts, 0.0)


def affine(
    value: float,
    slopes: dict[int, float],
    parameters: int,
    last: int,
    rest: float = 0.0,
    terms: Terms | None = None,
) -> Wave:
    """value + Σ p_v slope_v, without harmonics; ``slopes`` by number of the row, from 1 to ``parameters``."""
    parts = np.zeros((1 + parameters, 2 * last + 1), dtype=complex)
    parts[0, last] = value
    for v, slope in slopes.items():
        parts[v, last] += slope
    return Wave(parts, rest, terms)


def turning(order: float, phase: Wave, wave: Wave, harmonics: int) -> Wave:
    """exp(i·order·(phase + wave)) e^{i harmonics sτ}."""
    return ((phase + wave) * (1j * order)).exp().shifted(harmonics)


def ahead(moved: Wave) -> Wave:
    """Im(−log(1 − f)) = Im Σ f^k/k, |f| < 1; ``ZeroDivisionError`` elsewhere."""
    size = moved.size
    if not size < 0.999:
        raise ZeroDivisionError
    found, power, k = moved, moved, 1
    while power.size / (1 - size) > max(SMALL, BESIDE * found.rest) and k < 2000:
        k += 1
        power = power * moved
        found = found + power * (1 / k)
        if power.rest > 0.5 * power.size:  # nothing but its rest is left
            break
    bound = power.size / (1 - size) * size
    found = Wave(found.parts, (found.rest + bound) * OUTWARD, found.terms)
    return (found - found.conjugate()) * (-0.5j)


def _convolved(one: Complex, two: Complex, *, real: bool) -> Complex:
    """Row by row; of ``real`` ones half is enough."""
    if one.shape[1] > two.shape[1]:
        one, two = two, one
    few, wide = one.shape[1], two.shape[1]
    found = np.zeros((len(one), few + wide - 1), dtype=complex)
    middle = (few + wide - 1) // 2 if real else 0
    for k in range(few):
        low = max(k, middle)
        found[:, low : k + wide] += one[:, k : k + 1] * two[:, low - k :]
    if real:
        found[:, middle] = found[:, middle].real
        found[:, :middle] = found[:, :middle:-1].conj()
    return found


def _on_grid(parts: Complex, times: int) -> Complex:
    """Values at ``times`` even angles of a turn, rows alike; floating point, for guesses alone."""
    last = parts.shape[1] // 2
    spread = np.zeros((len(parts), times), dtype=complex)
    spread[:, : last + 1], spread[:, times - last :] = parts[:, last:], parts[:, :last]
    return np.fft.ifft(spread, axis=1) * times


def _harmonics(values: Complex, last: int) -> Complex:
    found = np.fft.fft(values, axis=1) / values.shape[1]
    return np.concatenate([found[:, values.shape[1] - last :], found[:, : last + 1]], axis=1)
