"""The equations of a long line at one speed over a period: Hill's blocks, modes followed by them, states in time.

A free motion Re[e^{λt} Σ_h X_h e^{ihbΩt}] obeys A(λ) X = 0 (``ranges.exponents``). Every mode is followed from that of
the line's mean matrices by inverse iteration,

    A(λ) u = A′(λ) x,    λ − x*x/x*u,

all of them together: roughly in a few harmonics, then in as many as the joints' spread asks for. A mode whose harmonics
fall more slowly, as those that meet other modes do, is followed on in more of them. What a mode leaves unbalanced is
seen in harmonics beyond its own. Some may not settle, be found twice, or not be known well in the most harmonics.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import TypeVar

import numpy as np
from scipy import linalg

from trunnion.arrays import Array, Complex, Flags, Integers
from trunnion.equations.given_rotation import GivenRotation
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.topology import Topology
from trunnion.equations.tree_matrices import EntryBeside, TreeMatrices, tree_matrices
from trunnion.floquet.propagation.tree_propagation import SHORTER, TreePropagation, rounding
from trunnion.steady.hill.tree_hill import TreeHill
from trunnion.steady.orders.sidebands import LARGEST_SPREAD, LEAST_SPREAD, side_orders, spreads
from trunnion.waiting import keep_time

ROUGH, DECADES, BEYOND = 4.0, (13.0, 18.0, 25.0), 3.0
"""Side orders are taken until their shares fall below 10^−4 for a start, then below 10^−13; below less for modes that
leave more beside these, which shows in those of three decades more."""
STEPS = 8
SETTLED, ROUGHLY = 1e-10, 1e-4
"""Share of |λ| by which the last step may move it, the next would by the square of that; and for a start."""
BALANCED, POOR = 1e-11, 1e-8
"""What a mode may leave over a period, as a share of its state, and from where on it is not known."""
MOST_NUMBERS = 1_500_000
"""Complex numbers of a batch of modes."""
LEAST = 1e-12
"""Share of the largest squared frequency below which a mode turns as a whole."""
SEEN, SURE = 8, 3.0
"""States whose error is seen, mixtures where there are more, and the factor by which mixtures may show too little."""


States = TypeVar("States", Array, Complex)
"""Real or complex."""


@dataclass(frozen=True)
class FollowedModes:
    """Exponents [1/s] (mode,), their rotation and its rate at τ = 0 (n, mode), and what they leave unbalanced,
    Σ_h ‖r_h‖ in units of √mass (mode,)."""

    value: Complex
    rotation: Complex
    rate: Complex
    left: Array

    def of(self, which: Flags) -> FollowedModes:
        """Some of the modes."""
        return FollowedModes(self.value[which], self.rotation[:, which], self.rate[:, which], self.left[which])

    @staticmethod
    def together(parts: list[FollowedModes]) -> FollowedModes:
        """The modes of all ``parts``."""
        keys = ("value", "rotation", "rate", "left")
        return FollowedModes(*(np.concatenate([getattr(part, key) for part in parts], axis=-1) for key in keys))

    @staticmethod
    def nothing(n: int) -> FollowedModes:
        """No mode of ``n`` unknowns."""
        empty = np.zeros((n, 0), dtype=complex)
        return FollowedModes(empty[0], empty, empty, np.zeros(0))


@dataclass(frozen=True)
class PeriodicMotionGiven:
    """The periodic motion that a line makes, ``given``, one that is known less well, ``rough``, from whose difference
    the error follows, and its largest ``swing`` [rad]."""

    given: GivenRotation
    rough: GivenRotation
    swing: float

    def spreads(self, fall: dict[int, float]) -> dict[int, float]:
        """Decades by which harmonics fall, of joints that would do so by ``fall``: where they stand swings too."""
        most = -float(np.log10(np.clip(self.swing, LEAST_SPREAD, LARGEST_SPREAD)))
        return {rate: min(one, most) for rate, one in fall.items()}


class HillLine:
    """Its equations over a period, in a few harmonics and in all that matter."""

    def __init__(
        self, topo: Topology, co: LineCoefficients, turns: Fraction, about: PeriodicMotionGiven | None = None
    ) -> None:
        """``about`` : by default the motion of rigid shafts."""
        fall = spreads(topo, co, turns)
        if about:
            fall = about.spreads(fall)
        self._few, *self._more = (_harmonics(fall, d) for d in (ROUGH, *DECADES, DECADES[-1] + BEYOND))
        # Of a straight line nothing varies.
        times = 1 << int(np.ceil(np.log2(max(64 if fall else 1, 4 * int(np.ptp(self._more[-1])) + 4))))
        period = 2 * np.pi * float(turns)
        tau = period * np.arange(times) / times
        matrices = tree_matrices(topo, co, tau, about.given if about else None)
        self.n, self.speed = topo.size, float(co.speed[0])
        self.rate, self.time = self.speed / float(turns), period / self.speed
        self._mean = [_mean(matrices, k) for k in range(3)]
        self.root = np.sqrt(np.diagonal(self._mean[2]))
        self.trace = _decay(matrices) * self.time
        lossless, rate = np.zeros((1, len(topo.compliances))), np.array([self.rate])
        self.blocks = TreeHill(topo, matrices, lossless, rate)
        self._rough = TreeHill(topo, tree_matrices(topo, co, tau, about.rough), lossless, rate) if about else None
        self._at_rest = topo.still if about else 0

    @cached_property
    def _modes(self) -> tuple[Array, Array]:
        """Squared frequencies (n,) and shapes (n, n) of the mean line without damping, in units of √mass."""
        over = self.root[:, None] * self.root
        square, basis = linalg.eigh(self._mean[0] / over, None if self._diagonal else self._mean[2] / over)
        return square, basis

    @cached_property
    def _diagonal(self) -> bool:
        """Whether no mass is joined to another."""
        return np.count_nonzero(self._mean[2]) == self.n

    @cached_property
    def _to_modes(self) -> Array:
        """The inverse of the shapes (n, n)."""
        basis = self._modes[1]
        return np.asarray(basis.T if self._diagonal else basis.T @ (self._mean[2] / (self.root[:, None] * self.root)))

    @cached_property
    def _frequency(self) -> Array:
        """In units of energy of the mean line's modes, undamped modes of a straight line are orthogonal. What turns as
        a whole has that of the slowest vibration."""
        square = np.abs(self._modes[0])
        vibrates = square > LEAST * square.max()
        return np.asarray(np.sqrt(np.where(vibrates, square, square[vibrates].min(initial=square.max()))))

    @property
    def wide(self) -> Integers:
        """The harmonics that most modes are followed in."""
        return self._more[0]

    @property
    def mean_stiffness(self) -> Array:
        """The symmetric part of K's mean over the period (n, n)."""
        return self._mean[0]

    @property
    def mean_mass(self) -> Array:
        """The mean of M over the period (n, n)."""
        return self._mean[2]

    @property
    def places_left(self) -> int:
        """Unknowns beside what varies, whose harmonics are eliminated together."""
        return len(self.blocks.plan.left)

    @cached_property
    def _propagation(self) -> TreePropagation:
        return TreePropagation(self.blocks)

    @cached_property
    def steps(self) -> int:
        """Steps of a period in which states are carried."""
        return self._propagation.steps(float(np.abs(self.starts()[0]).max()))

    def starts(self) -> tuple[Complex, Complex]:
        """Exponents (mode,) of the mean matrices, of each pair one, and shapes (mode, n), of what vibrates: damping
        between undamped modes is left out."""
        square, basis = self._modes
        moves = np.abs(square) > LEAST * np.abs(square).max()
        # About a motion of its own what turns a line as a whole has a mean stiffness.
        moves[np.argsort(np.abs(square))[: self._at_rest]] = False
        square, basis = square[moves], basis[:, moves]
        damping = self._mean[1] / (self.root[:, None] * self.root)
        half = np.einsum("ij,ij->j", basis, damping @ basis) / 2
        root = np.sqrt((half**2 - square).astype(complex))
        above = root.imag != 0
        value = np.concatenate([-half + root, (-half - root)[~above]])
        shape = (basis / self.root[:, None]).T
        return value, np.concatenate([shape, shape[~above]]).astype(complex)

    def followed(self, value: Complex, shape: Complex) -> FollowedModes:
        """From exponents (mode,) and shapes (mode, n) on; NaN where one does not settle."""
        parts = []
        batch_size = max(1, MOST_NUMBERS // (self.n * len(self.wide)))
        for begin in range(0, len(value), batch_size):
            keep_time()
            some = slice(begin, begin + batch_size)
            x = np.zeros((self.n, len(value[some]), len(self._few)), dtype=complex)
            x[..., int(np.searchsorted(self._few, 0))] = shape[some].T
            found = value[some]
            if len(self._few) < len(self.wide):
                found, x = self._settled(found, x, self._few, ROUGHLY)
            parts.append(self._closely(found, _within(x, self._few, self.wide)))
        return FollowedModes.together(parts)

    def _closely(self, value: Complex, x: Complex, stage: int = 0) -> FollowedModes:
        """In the harmonics of a ``stage``, and in those of the next what they leave too much in."""
        h, beyond = self._more[stage : stage + 2]
        value, x = self._settled(value, x, h)
        found, share = self._seen(value, _within(x, h, beyond), beyond)
        if stage == len(self._more) - 2 or not (more := share > BALANCED).any():
            return found.of(share <= POOR)
        rest = self._closely(value[more], _within(x[:, more], h, beyond), stage + 1)
        return FollowedModes.together([found.of(share <= BALANCED), rest])

    def _seen(self, value: Complex, x: Complex, h: Integers) -> tuple[FollowedModes, Array]:
        """Modes x (n, mode, h), and what they leave over a period, as a share of their states (mode,)."""
        s = value[:, None] + 1j * h * self.rate
        felt = self.blocks.felt(s, h, x)
        left, rate = self._total(felt), np.einsum("nch,ch->nc", x, s)
        share = self.time * left / np.linalg.norm(rate * self.root[:, None], axis=0)
        if self._rough:
            left = left + self._total(self._rough.felt(s, h, x) - felt)
        return FollowedModes(value, x.sum(axis=2), rate, left), share

    def _total(self, left: Complex) -> Array:
        """Σ_h ‖r_h‖ (mode,) of torques r (n, mode, h), in units of √mass."""
        over = self.root**-2
        square = np.einsum("nch,nch,n->ch", left.real, left.real, over)
        square += np.einsum("nch,nch,n->ch", left.imag, left.imag, over)
        return np.asarray(np.sqrt(square).sum(axis=1))

    def _settled(self, value: Complex, x: Complex, h: Integers, closely: float = SETTLED) -> tuple[Complex, Complex]:
        value, x = value.copy(), x / _size(x)
        left = np.arange(len(value))
        for _ in range(STEPS):
            one = x if len(left) == len(value) else np.ascontiguousarray(x[:, left])
            s = value[left, None] + 1j * h * self.rate
            u = self.blocks.stepped(s, h, one)
            with np.errstate(all="ignore"):
                change, size = 1 / np.einsum("nch,nch->c", one.conj(), u), _size(u)
                u /= size
            good = np.isfinite(size[:, 0]) & np.isfinite(change)
            value[left] = np.where(good, value[left] - change, np.nan)
            x[:, left[good]] = u[:, good]
            with np.errstate(invalid="ignore"):
                left = left[good & (np.abs(change) > closely * np.abs(value[left]))]
            if not len(left):
                break
        value[left] = np.nan
        return value, x

    def energies(self, rotation: States, rate: States) -> States:
        """States (2n, m) in units of energy, of rotations and their rates [1/s] (n, m)."""
        turned = _turned(self._to_modes, np.concatenate([rotation, rate], axis=1) * self.root[:, None])
        count = rotation.shape[1]
        return np.concatenate([turned[:, :count] * self._frequency[:, None], turned[:, count:]])

    def states(self, energies: States) -> tuple[States, States]:
        """Rotations and rates [1/s] (n, m) of ``energies`` (2n, m)."""
        basis = self._modes[1] / self.root[:, None]
        return _turned(basis, energies[: self.n] / self._frequency[:, None]), _turned(basis, energies[self.n :])

    def exponents(self, multiplier: Complex, energies: Complex) -> Complex:
        """Of ``multiplier`` (m,), among all that differ by multiples of i times the rate those at which the states turn
        most."""
        rotation, rate = (part * self.root[:, None] for part in self.states(energies))
        turns = (rotation.conj() * rate).sum(axis=0).imag / np.maximum((np.abs(rotation) ** 2).sum(axis=0), 1e-300)
        least = np.log(np.where(multiplier == 0, 1e-300, multiplier)) / self.time
        return np.asarray(least + 1j * self.rate * np.round((turns - least.imag) / self.rate))

    def carried(self, energies: Array) -> tuple[Array, float]:
        """States (2n, m) one period later, and the Frobenius norm of their error: from shorter steps, about a motion
        that is known less well where there is one, of mixtures of them where there are many."""
        count, carry, steps = energies.shape[1], self._propagation, self.steps
        later = self.energies(*carry.carried(*self.states(energies), steps))
        mixed, sure = np.eye(count), 1.0
        if count > SEEN:
            mixed, sure = np.random.default_rng(0).normal(size=(count, SEEN)) / np.sqrt(SEEN), SURE
        carry = TreePropagation(self._rough) if self._rough else carry
        again = self.energies(*carry.carried(*self.states(energies @ mixed), int(np.ceil(SHORTER * steps))))
        off = sure * float(np.linalg.norm(again - later @ mixed))
        return later, off + rounding(steps) * float(np.linalg.norm(later))


def _turned(matrix: Array, x: States) -> States:
    """The product of a real matrix with columns x (n, m), real or complex: without imaginary parts that are zero."""
    if not np.iscomplexobj(x):
        return np.asarray(matrix @ x)
    return np.asarray((matrix @ np.ascontiguousarray(x).view(float)).view(complex))


def _within(x: Complex, h: Integers, more: Integers) -> Complex:
    """x (n, mode, h) of harmonics ``h`` among ``more``."""
    found = np.zeros((*x.shape[:2], len(more)), dtype=complex)
    found[..., np.searchsorted(more, h)] = x
    return found


def _harmonics(fall: dict[int, float], decades: float) -> Integers:
    return np.array(sorted(side_orders(fall, decades)), dtype=np.int64)


def _mean(matrices: TreeMatrices, kind: int) -> Array:
    """The symmetric part of the mean of K, C or M over the period (n, n)."""
    entries = matrices.three[kind]
    own, down, up = (part[:, 0].mean(axis=1) for part in (entries.own, entries.down, entries.up))
    found, tied = np.diag(own), np.flatnonzero(matrices.parent >= 0)
    front = matrices.parent[tied]
    found[tied, front] = found[front, tied] = (down[tied] + up[tied]) / 2
    for one in matrices.beside:
        half = float(one.parts[kind][0].mean()) / 2
        found[one.row, one.column] += half
        found[one.column, one.row] += half
    return found


def _decay(matrices: TreeMatrices) -> float:
    """The mean of tr(M⁻¹C) [1/s]."""
    mass, damping = matrices.mass.own[:, 0], matrices.damping.own[:, 0]
    tied = np.flatnonzero(matrices.parent >= 0)
    tied = tied[matrices.mass.down[tied, 0].any(axis=1)]
    pairs = [(i, int(matrices.parent[i])) for i in tied.tolist()]
    beside = {(one.row, one.column): one for one in matrices.beside}
    pairs += [(i, j) for (i, j), one in beside.items() if i > j and one.parts[2].any()]
    joined = sorted({i for pair in pairs for i in pair})
    alone = np.setdiff1d(np.arange(len(mass)), joined)
    found = float((damping[alone] / mass[alone]).mean(axis=1).sum())
    if joined:
        m, c = (_block(matrices, beside, joined, kind) for kind in (2, 1))
        found += float(np.trace(np.linalg.solve(m, c), axis1=1, axis2=2).mean())
    return found


def _block(matrices: TreeMatrices, beside: dict[tuple[int, int], EntryBeside], places: list[int], kind: int) -> Array:
    """K, C or M of some places (time, m, m)."""
    entries = matrices.three[kind]
    found = np.zeros((entries.own.shape[2], len(places), len(places)))
    for a, i in enumerate(places):
        for b, j in enumerate(places):
            if i == j or matrices.parent[i] == j or matrices.parent[j] == i:
                found[:, a, b] = entries[i, j][0]
            elif (i, j) in beside:
                found[:, a, b] = beside[i, j].parts[kind][0]
    return found


def _size(x: Complex) -> Array:
    """Euclidean norm of each case (case, 1) of x (n, case, h)."""
    square = np.einsum("nch,nch->c", x.real, x.real) + np.einsum("nch,nch->c", x.imag, x.imag)
    return np.asarray(np.sqrt(square)[:, None])
