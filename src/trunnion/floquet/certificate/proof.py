"""Whether a periodic P proves a box stable: a theorem, checked with every rounding bounded.

Let ż = A(τ, p)z with τ = Ωt, A periodic, and P(τ, p) Hermitian and periodic. If

    N = Ω P′ + A*P + PA < 0 for all τ,     P(0, p) > 0,

then every solution decays: V = z*Pz falls strictly, over a period by Φ*P(0)Φ < P(0), Φ the monodromy matrix, and with
P(0) > 0 that is Stein's inequality, which puts all multipliers inside the unit circle (Stein 1952; Bittanti and
Colaneri, Periodic Systems, 2009).

P is that of ``periodic_lyapunov``: P = W*P_yW with harmonics that are floating-point numbers, and so exactly known;
nothing is asked of how they were found. N is taken in modal coordinates, U*NU, with any invertible U. With
A = A₀ + Σ p_v A_v + R from ``box_equations``,

    U*NU = N₀ + Σ p_v N_v + Σ p_v p_w N_vw + (what R, rounding and WU ≠ I leave),

each a Fourier series in τ. Its mean on the diagonal for p = 0 is kept as it is, all else is bounded entry by entry by
sums of moduli. So U*NU ≤ C in the sense x*U*NUx ≤ |x|ᵀC|x|, with a real symmetric C whose entries beside the diagonal
are not negative. Where the first parameter has powers, products go by degrees of its Chebyshev polynomials, and each
degree is bounded by its sum of moduli. If a vector v > 0 has Cv < 0, C is negative definite (a symmetric M-matrix,
Berman and Plemmons), and so is N. The same test is made of −P(0, p) after a congruence.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.floquet.certificate.box_equations import BoxMatrix
from trunnion.floquet.certificate.periodic_lyapunov import LyapunovSeries, ModalBox
from trunnion.floquet.certificate.waves import OUTWARD, UNIT, chebyshev_rows

HALVINGS = 12
"""With which a decay rate is found."""


@dataclass(frozen=True)
class BoxVerdict:
    """``proved``; ``excess``: what C brings against the smallest decay, 1 where it just fails; ``blame`` (1 + ranges,):
    what each parameter brings of it; ``decay``: rate [1/s] at which every disturbance dies out at least, 0 where
    nothing is proved."""

    proved: bool
    excess: float
    blame: Array
    decay: float = 0.0


def check(box: BoxMatrix, modal: ModalBox, found: LyapunovSeries) -> BoxVerdict:
    """Whether P proves that all lines of a box are stable."""
    return _checked(box, modal, found)[0]


def check_tube(box: BoxMatrix, modal: ModalBox, found: LyapunovSeries, left: Array) -> tuple[BoxVerdict, float]:
    """The same, and the least V at which V falls where z′ = Az + R, |R| ≤ ``left`` (D,) in modal coordinates; infinite
    where nothing is proved.

    With half the decay rate, C + 2μP ≤ −c < 0 is still an M-matrix. A vector s ≥ 0 with cs ≥ g = |P||R| has
    2|y|ᵀg ≤ |y|ᵀc|y| + sᵀcs, so that V′ ≤ −2μV + sᵀcs.
    """
    verdict, bound = _checked(box, modal, found)
    if not verdict.proved or bound is None or not verdict.decay > 0:
        return verdict, np.inf
    rate = verdict.decay / 2
    c = bound.whole + 2 * rate * bound.energy
    c = -(c + 4 * UNIT * np.abs(bound.whole))
    pushed = bound.energy @ left * OUTWARD
    try:
        s = np.linalg.solve(c, pushed * (1 + 1e-6) + 1e-300)
    except np.linalg.LinAlgError:
        return verdict, np.inf
    if not np.all(s >= 0):
        return verdict, np.inf
    own, off = np.diagonal(c), np.maximum(np.diag(np.diagonal(c)) - c, 0.0)
    if not np.all(own * s * (1 - 4 * UNIT) >= (off @ s) * OUTWARD + pushed):
        return verdict, np.inf
    return verdict, float(s @ (own * s)) * OUTWARD / (2 * rate)


def _checked(box: BoxMatrix, modal: ModalBox, found: LyapunovSeries) -> tuple[BoxVerdict, _Bound | None]:
    many = len(box.parts) - 1
    if not (np.isfinite(found.parts).all() and np.isfinite(box.parts).all() and np.isfinite(box.rest).all()):
        return BoxVerdict(False, np.inf, np.ones(many)), None
    with np.errstate(all="ignore"):
        bound = _Bound.of(box, modal, found)
        proved, excess, weight = _negative(bound.whole)
        proved = proved and bound.invertible and _positive(found)
        blame = np.array([weight @ one @ weight for one in bound.each[: many - box.powers]])
        decay = _decay(bound, float(modal.decay.min())) if proved else 0.0
    return BoxVerdict(bool(proved), excess, np.nan_to_num(blame), decay), bound


def _decay(bound: _Bound, most: float) -> float:
    """A rate μ with N + 2μP < 0, so that V falls as e^(−2μt) at least: halved in on."""
    low, high = 0.0, 2 * most
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        moved = bound.whole + 2 * middle * bound.energy
        proved = _negative(moved + 4 * UNIT * (np.abs(moved) + np.abs(bound.whole)))[0]
        low, high = (middle, high) if proved else (low, middle)
    return low


@dataclass(frozen=True)
class _Bound:
    """C (D, D), what each parameter brings of it (parameters, D, D), in the same sense a bound of P,
    and whether WU ≠ I is so small that W has an inverse."""

    whole: Array
    each: Array
    energy: Array
    invertible: bool

    @classmethod
    def of(cls, box: BoxMatrix, modal: ModalBox, found: LyapunovSeries) -> _Bound:
        many, size = len(box.parts) - 1, len(modal.decay)
        last, sides = box.last, found.parts.shape[1] // 2
        speed, half = box.speed
        # W A U: a product of three, each sum of D terms; complex products cost a factor.
        h = modal.to_modes @ box.parts @ modal.modes
        error = 8 * (size + 4) * UNIT
        to, fro = np.abs(modal.to_modes), np.abs(modal.modes)
        own = np.abs(box.parts).sum(axis=1)
        left_out = (to @ (2 * error * own.sum(axis=0) + box.rest) @ fro) * OUTWARD
        h_sizes = np.abs(h).sum(axis=1) * OUTWARD
        p_sizes = np.abs(found.parts).sum(axis=1) * OUTWARD
        turn = np.abs(np.arange(-sides, sides + 1)) * box.rate
        turned = (np.abs(found.parts) * turn[:, None, None]).sum(axis=1) * OUTWARD
        p_all, turned_all, h_all = p_sizes.sum(axis=0), turned.sum(axis=0), h_sizes.sum(axis=0) + left_out
        fastest = speed + half
        # W U = I + e.
        e = np.abs(modal.to_modes @ modal.modes - np.eye(size)) + error * (to @ fro)
        near = np.eye(size) + e
        # Products of P and H by harmonics: (2K + 1) sums of D terms each, and their sums over parameters.
        rounding = 8 * (size + 2 * min(last, sides) + 2 * many + 4 * box.powers + 16) * UNIT
        rest = p_all @ left_out
        rest = rest + rounding * (p_all @ h_all + fastest * turned_all)
        rest = rest + fastest * (e.T @ turned_all @ near + turned_all @ e) / 2 + e.T @ p_all @ h_all
        rest = (rest + rest.T) * OUTWARD
        terms = _products(found.parts, h)
        order = 1j * np.arange(-sides, sides + 1)[:, None, None] * box.rate
        pad = [(last, last), (0, 0), (0, 0)]

        def with_turn(series: Complex, p: Complex, by: float) -> Complex:
            return np.asarray(series + np.pad(order * p * by, pad))

        rows = chebyshev_rows(many + 1, box.powers) if box.powers else [0]
        alone = [v for v in range(1, many + 1) if v not in rows]
        degrees = [np.zeros((2 * (sides + last) + 1, size, size), dtype=complex) for _ in range(2 * len(rows) - 1)]
        for a, b in np.ndindex(len(rows), len(rows)):
            made = terms(rows[a], rows[b])
            if b < 2:  # the turn of P_a at the speed's mean, and at what of it the first parameter moves
                made = made + np.pad(order * found.parts[rows[a]] * ((speed, half)[b] / 2), pad)
            for to in (a + b, abs(a - b)):
                degrees[to] += made / 2
        middle = _hermitian(degrees[0])
        centre = sides + last
        c = np.abs(middle).sum(axis=0) + rest
        mean = middle[centre]
        c += np.diag(np.diagonal(mean).real - np.abs(np.diagonal(mean)))
        each = np.zeros((many, size, size))
        for one in degrees[1:]:
            each[0] += np.abs(_hermitian(one)).sum(axis=0)
        for v in alone:
            if not (h[v].any() or found.parts[v].any() or (v == 1 and half)):
                continue
            first = _hermitian(terms(0, v) + terms(v, 0))
            first = with_turn(first, found.parts[v], speed)
            if v == 1:
                first = with_turn(first, found.parts[0], half)
            each[v - 1] += np.abs(first).sum(axis=0)
            square = _hermitian(terms(v, v))
            if v == 1:
                square = with_turn(square, found.parts[1], half)
            # p² runs from 0 to 1: half of it is there on average.
            diagonal = np.maximum(np.diagonal(square[centre]).real, 0.0)
            wide = np.abs(square).sum(axis=0)
            wide[np.diag_indices(size)] += diagonal - np.abs(np.diagonal(square[centre]))
            each[v - 1] += wide
            for w in [*(w for w in alone if w > v), *rows[1:]]:
                both = _hermitian(terms(v, w) + terms(w, v))
                if v == 1 or w == 1:
                    both = with_turn(both, found.parts[w if v == 1 else v], half)
                share = np.abs(both).sum(axis=0) / 2
                each[v - 1] += share
                each[0 if w in rows else w - 1] += share
        whole = c + each.sum(axis=0) + 16 * many * UNIT * np.abs(c)
        off = ~np.eye(size, dtype=bool)
        whole = (whole + whole.T) / 2
        whole[off] *= OUTWARD
        whole[~off] += 1e-12 * np.abs(whole).sum(axis=1)
        energy = near.T @ (p_all * OUTWARD) @ near * OUTWARD
        return cls(whole, each, (energy + energy.T) / 2, bool(e.sum(axis=1).max() < 0.5))


def _products(p: Complex, h: Complex):  # type: ignore[no-untyped-def]
    """Σ P_{m−k} H_k by harmonics m, of any two parts."""
    sides, last, size = p.shape[1] // 2, h.shape[1] // 2, p.shape[2]
    known: dict[tuple[int, int], Complex] = {}

    def product(v: int, w: int) -> Complex:
        if (v, w) not in known:
            found = np.zeros((2 * (sides + last) + 1, size, size), dtype=complex)
            if p[v].any():
                rows = p[v].reshape(-1, size)
                for k in range(2 * last + 1):
                    if h[w, k].any():
                        found[k : k + 2 * sides + 1] += (rows @ h[w, k]).reshape(-1, size, size)
            known[v, w] = found
        return known[v, w]

    return product


def _hermitian(series: Complex) -> Complex:
    """X + X* by harmonics."""
    return np.asarray(series + series[::-1].conj().swapaxes(1, 2))


def _negative(c: Array) -> tuple[bool, float, Array]:
    """Whether a symmetric C without negative entries beside its diagonal is negative definite; how near it comes to
    failing (1: at the limit), and a vector that shows where."""
    size = len(c)
    own = -np.diagonal(c)
    if not np.isfinite(c).all():
        return False, np.inf, np.ones(size)
    off = c + np.diag(own)
    scale = np.sqrt(np.where(own > 0, own, 1.0))
    values, vectors = np.linalg.eigh(off / scale[:, None] / scale[None, :])
    excess = float(values[-1]) if np.all(own > 0) else np.inf
    weight = np.abs(vectors[:, -1]) / scale
    if not excess < 1:
        return False, excess, weight
    try:
        v = np.linalg.solve(-c, scale)
    except np.linalg.LinAlgError:
        return False, excess, weight
    if not np.all(v > 0):
        return False, excess, weight
    falls = off @ v * (1 + 4 * size * UNIT) * OUTWARD < own * v * (1 - 4 * UNIT)
    return bool(falls.all()), excess, weight


def _positive(found: LyapunovSeries) -> bool:
    """Whether P(0, p) > 0 for all p: −X*PX with X near P₀^(−1/2) is tested as N is."""
    at = found.parts.sum(axis=1)
    size, terms = at.shape[-1], found.parts.shape[1]
    middle = (at[0] + at[0].conj().T) / 2
    values, vectors = np.linalg.eigh(middle)
    if not values[0] > 0:
        return False
    x = vectors / np.sqrt(values)
    wide = np.abs(x)
    rounding = 8 * (2 * size + terms + 8) * UNIT
    slack = rounding * (wide.T @ np.abs(found.parts).sum(axis=(0, 1)) @ wide)
    moved = x.conj().T @ at @ x
    c = np.abs(moved).sum(axis=0) + slack
    c = (c + c.T) / 2
    own = np.diagonal(moved[0]).real
    c[np.diag_indices(size)] += -own - np.abs(own)
    return _negative(c)[0]
