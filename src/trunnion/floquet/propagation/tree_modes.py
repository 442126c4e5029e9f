"""All Floquet modes of a long line at one speed: most by Hill's blocks along the tree, what they leave in time.

Modes that nearly coincide, at the edge of a tongue or as those of equal parts far from each other, are not all found
by ``hill_line``. What the states v_i at τ = 0 of those that were found leave of all states, N orthogonal to them, is
carried through the period in time (``tree_propagation``). With r_i what a mode leaves unbalanced, more side orders
counted, the propagator Z obeys

    Z (V N) = (V N) [Σ C; 0 B] + E,    ‖E_i‖ ≤ T ‖Φ‖ ‖r_i‖,    ‖Φ‖ ≤ ‖V N‖ ‖(V N)⁻¹‖ max(1, ρ, ‖B‖),

so that all multipliers are known as those of a matrix that is known to ‖E (V N)⁻¹‖, and none is missing: V N is a basis
of all states. Where steep joints make many harmonics all states are carried in time.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property

import numpy as np

from trunnion.arrays import Array, Complex, Flags, Places
from trunnion.equations.aligned import rigid_rotation
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.linear import rigid_motions
from trunnion.equations.topology import Topology
from trunnion.floquet.propagation.cost_model import by_modes, in_time
from trunnion.floquet.propagation.hill_line import FollowedModes, HillLine, PeriodicMotionGiven
from trunnion.numerics.spectrum import bounds_of, without

REAL = 1e-9
"""Share of a multiplier below which its imaginary part is rounding."""
DEPENDENT, WORST_CONDITION = 1e-6, 1e6
"""Length of a mode's state beside those of others, and its condition, beyond which it is not taken into a basis."""
AT_REST = 1e-6
"""Distance of a multiplier from 1 below which it may be that of a rigid motion."""
NO_DISTANCE, LARGEST_CONDITION = 1e-14, 1e10
"""Distance of multipliers that rounding leaves, and the condition beyond which none is known."""
EPSILON = 1e-15
"""Share of a matrix's norm to which eigenvalues are found."""


@dataclass(frozen=True)
class FloquetModes:
    """multiplier, error (its bound), exponent [1/s] (m,), by falling modulus of the multiplier, of all 2n but those of
    rigid motions; states (2n, m): columns (x, dx/dτ) at τ = 0; trace: ∫ tr(M⁻¹C) dτ; liouville_defect: |ln det Z +
    ∫ tr(M⁻¹C) dτ| of the exponents; off: error of Z, in units of energy; carried: how many states were carried in time.
    """

    multiplier: Complex
    error: Array
    exponent: Complex
    states: Complex
    trace: float
    liouville_defect: float
    off: float
    carried: int


def floquet_modes(
    topo: Topology, co: LineCoefficients, turns: Fraction, about: PeriodicMotionGiven | None = None
) -> FloquetModes | None:
    """Of the one case of ``co``, whose coefficients repeat after ``turns`` of the input; None where nothing is known of
    them. ``about`` the motion that the line makes, by default that of rigid shafts; a shift of the phase of the motion
    of a free line is a rigid motion then."""
    line = HillLine(topo, co, turns, about)
    found = line.followed(*line.starts()) if _blocks_pay(line) else FollowedModes.nothing(line.n)
    if about is None:
        return _judged(line, found, rigid_motions(topo, co))
    shift = about.given.shift(rigid_rotation(topo)).T if topo.free else np.zeros((2 * line.n, 0))
    return _judged(line, found, shift)


def _blocks_pay(line: HillLine) -> bool:
    """Whether modes cost less than carrying all states, as of a straight line always."""
    return len(line.wide) == 1 or by_modes(line.n, len(line.wide), line.places_left) < in_time(line.n, line.steps)


@dataclass(frozen=True)
class _Basis:
    """Of all states in units of energy: ``modes`` (2n, m), of length 1, of each pair one, which are ``pair`` (m,), with
    their multipliers; what they leave unbalanced over their length (m,); ``others`` (2n, d), orthonormal and orthogonal
    to them."""

    exponent: Complex
    multiplier: Complex
    modes: Complex
    pair: Flags
    left: Array
    others: Array

    @cached_property
    def whole(self) -> Array:
        """Real vectors of all: Re v, Im v of pairs, N (2n, 2n)."""
        return np.concatenate([self.modes.real, self.modes.imag[:, self.pair], self.others], axis=1)

    def completed(self) -> tuple[_Basis, Array, Array]:
        """With all that they leave, the inverse of the whole, and the length of its rows that belong to the modes (m,);
        fewer modes where some depend on the others."""
        basis = self if len(self.modes) == self.whole.shape[1] else self._independent()
        while True:
            try:
                inverse = np.asarray(np.linalg.inv(basis.whole))
            except np.linalg.LinAlgError:
                basis = basis._independent()
                continue
            rows = basis.lengths(inverse)
            good = rows < WORST_CONDITION
            if good.all():
                return basis, inverse, rows
            basis = basis._of(good)

    def _of(self, kept: Flags) -> _Basis:
        basis = _Basis(
            self.exponent[kept],
            self.multiplier[kept],
            self.modes[:, kept],
            self.pair[kept],
            self.left[kept],
            self.others[:, :0],
        )
        if not (whole := basis.whole).shape[1]:
            return replace(basis, others=np.eye(len(whole)))
        return replace(basis, others=np.linalg.qr(whole, mode="complete")[0][:, whole.shape[1] :])

    def _independent(self) -> _Basis:
        """The modes without those that depend on ones before them."""
        owner = np.repeat(np.arange(len(self.pair)), 1 + self.pair)
        second = np.flatnonzero(np.diff(owner, prepend=-1) == 0)
        vectors = self.modes.real[:, owner]
        vectors[:, second] = self.modes.imag[:, self.pair]
        depends = np.ones(len(owner), dtype=bool)
        most = min(vectors.shape)
        depends[:most] = np.abs(np.diagonal(np.linalg.qr(vectors, mode="r"))) < DEPENDENT
        kept = np.ones(len(self.pair), dtype=bool)
        kept[owner[depends]] = False
        return self._of(kept)

    def carried(self, rest: _Rest, onto: Complex, value: Complex, both: Places) -> Complex:
        """Vectors (2n, d) of the multipliers of the ``rest``; ``onto`` (m, d): what falls back onto the modes in a
        period; ``value``: multipliers of these and, behind them, of the conjugates of pairs, which are ``both``."""
        back = np.arange(len(both)) >= len(self.pair)
        own = _mirrored(self.modes, both, back)
        onto = np.where(back[:, None], onto[both].conj(), onto[both])
        apart = rest.multiplier - value[:, None]
        beside = onto @ rest.vectors / np.where(np.abs(apart) < NO_DISTANCE, NO_DISTANCE, apart)
        return np.asarray(self.others @ rest.vectors + own @ beside)

    def lengths(self, inverse: Array) -> Array:
        """Those of the rows of the ``inverse`` that belong to the modes (m,), of pairs (Re − i Im)/2."""
        m = len(self.pair)
        square = np.einsum("ij,ij->i", inverse, inverse)
        found = square[:m]
        found[self.pair] = (found[self.pair] + square[m : m + int(self.pair.sum())]) / 4
        return np.asarray(np.sqrt(found))


def _judged(line: HillLine, found: FollowedModes, aside: Array) -> FloquetModes | None:
    turned = np.exp(found.value * line.time)
    known = np.isfinite(found.value)
    if aside.shape[1]:
        known &= np.abs(turned - 1) > AT_REST
    found, turned = found.of(known), turned[known]
    v = line.energies(found.rotation, found.rate)
    size = np.linalg.norm(v, axis=0)
    v, left = v / size, found.left / size
    pair = np.abs(turned.imag) > REAL * np.abs(turned)
    if not pair.all():
        largest = np.take_along_axis(v, np.abs(v).argmax(axis=0)[None], axis=0)[0]
        v = np.where(pair, v, v * (np.abs(largest) / largest))
    basis, inverse, rows = _Basis(found.value, turned, v, pair, left, np.zeros((2 * line.n, 0))).completed()
    return _proven(line, basis, inverse, rows, aside)


def _proven(line: HillLine, basis: _Basis, inverse: Array, rows: Array, aside: Array) -> FloquetModes | None:
    m, several = len(basis.pair), np.flatnonzero(basis.pair)
    d = basis.others.shape[1]
    rigid = line.energies(aside[: line.n], aside[line.n :] * line.speed)
    later, off = line.carried(basis.others) if d else (basis.others, 0.0)
    if not np.isfinite(later).all():
        return None
    share = inverse @ later
    rest = _Rest.of(share[m + len(several) :], basis.others.T @ rigid)
    onto = share[:m].astype(complex)
    onto[several] = (share[several] - 1j * share[m : m + len(several)]) / 2
    both = np.concatenate([np.arange(m), several])
    back = np.arange(len(both) + len(rest.multiplier)) >= m
    back[len(both) :] = False
    value = np.where(back[: len(both)], basis.multiplier[both].conj(), basis.multiplier[both])
    vectors, condition = basis.modes, rows[both]
    exponent = np.where(back[: len(both)], basis.exponent[both].conj(), basis.exponent[both])
    if d:
        carried = basis.carried(rest, onto, value, both)
        vectors = np.concatenate([vectors, carried / np.linalg.norm(carried, axis=0)], axis=1)
        exponent = np.concatenate([exponent, line.exponents(rest.multiplier, carried)])
    source = np.concatenate([both, m + np.arange(len(rest.multiplier))])
    if d:
        condition = _conditions(_mirrored(vectors, source, back), rigid)
    multiplier = np.concatenate([value, rest.multiplier])
    grown = max(1.0, float(np.abs(multiplier).max(initial=0.0)), rest.norm)
    moved = line.time * _norm(basis.whole) * _norm(inverse.T) * grown * basis.left[both] * rows[both]
    off = float(np.hypot(np.linalg.norm(moved), off))
    error = bounds_of(multiplier, condition, off + EPSILON * rest.norm * (d > 0))
    order = np.argsort(-np.abs(multiplier), kind="stable")
    rotation, rate = line.states(vectors)
    states = np.concatenate([rotation, rate / line.speed])
    return FloquetModes(
        multiplier[order],
        error[order],
        exponent[order],
        _mirrored(states / np.abs(states).max(axis=0), source[order], back[order]),
        line.trace,
        abs(float(exponent.real.sum()) * line.time + line.trace),
        off,
        d,
    )


def _mirrored(columns: Complex, source: Places, back: Flags) -> Complex:
    """The columns ``source``, those that are ``back`` as their conjugates."""
    found = columns[:, source]
    found.imag[:, back] *= -1
    return found


def _conditions(vectors: Complex, rigid: Array) -> Array:
    """Of multipliers with such ``vectors`` (2n, m) of length 1, beside what is ``rigid``."""
    whole = np.concatenate([vectors, rigid / np.linalg.norm(rigid, axis=0)], axis=1)
    try:
        found = np.linalg.norm(np.linalg.inv(whole), axis=1)[: vectors.shape[1]]
    except np.linalg.LinAlgError:
        found = np.full(vectors.shape[1], np.inf)
    return np.asarray(np.where(found < LARGEST_CONDITION, found, LARGEST_CONDITION))


@dataclass(frozen=True)
class _Rest:
    """Multipliers and vectors (d, d − k) of the block (d, d) that a basis leaves, without what is rigid (d, k); its
    norm."""

    multiplier: Complex
    vectors: Complex
    norm: float

    @staticmethod
    def of(block: Array, rigid: Array) -> _Rest:
        if not len(block):
            return _Rest(np.zeros(0, complex), np.zeros((0, 0), complex), 0.0)
        norm, k = float(np.linalg.norm(block, 2)), rigid.shape[1]
        if not k:
            value, vectors = np.linalg.eig(block)
            return _Rest(value.astype(complex), vectors.astype(complex), norm)
        within = np.linalg.qr(rigid)[0]
        left, beside = without(block, rigid)
        value, vectors = np.linalg.eig(left)
        apart = value[:, None, None] * np.eye(k) - within.T @ block @ within
        turn = np.linalg.solve(apart, (within.T @ block @ beside @ vectors).T[..., None])[..., 0].T
        return _Rest(value.astype(complex), beside @ vectors + within @ turn, norm)


def _norm(matrix: Array) -> float:
    """No less than the 2-norm, and hardly more where the columns are all but orthogonal."""
    return float(np.sqrt(np.abs(matrix.T @ matrix).sum(axis=0).max()))
