"""All Floquet modes of a long driven line at one speed, each by Hill's blocks eliminated along the tree.

A free motion Re[e^{λt} Σ_h X_h e^{ihbΩt}] obeys A(λ) X = 0 (``ranges.exponents``). Every mode is followed from that of
the line's mean matrices by inverse iteration,

    A(λ) u = A′(λ) x,    λ − x*x/x*u,

all of them together, in as many harmonics as the joints' spread asks for. What the states v_i of 2n modes at τ = 0
prove: where they are linearly independent, V = (v_1 … v_2n), nothing is missing, for a matrix of 2n states has no more
multipliers. With r_i what a mode leaves unbalanced, more side orders counted, the propagator is Z = (V Σ + E) V⁻¹,

    ‖E_i‖ ≤ T ‖Φ‖ ‖r_i‖,    ‖Φ‖ ≤ ‖V‖ ‖V⁻¹‖ max(1, ρ),

so that all multipliers are known as those of a matrix that is known to ‖E V⁻¹‖.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from trunnion.arrays import Array, Complex, Flags, Integers
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.topology import Topology
from trunnion.equations.tree_matrices import TreeEntries, TreeMatrices, tree_matrices
from trunnion.numerics.spectrum import bounds_of
from trunnion.steady.orders.sidebands import side_orders, spreads
from trunnion.steady.orders.tree_hill import TreeHill
from trunnion.waiting import keep_time

DECADES, WIDER = 9.0, 4.0
"""Side orders are taken until their shares fall below 10^−9; what is left out shows in those of four decades more."""
STEPS, PLANE_STEPS = 8, 4
SETTLED = 1e-10
"""Share of |λ| by which the last step may move it: the next would move it by the square of that."""
MOST_NUMBERS = 1_500_000
"""Complex numbers of a batch of modes."""
BESIDE, MOST_BESIDE, MOST_TOGETHER = 0.1, 3, 12
"""Distance of exponents, over the rate of the coefficients, up to which modes are found together; how many beside each,
and in all."""
ALIKE = 1e-8
"""Distance below which two exponents are those of one mode."""
REAL = 1e-9
"""Share of a multiplier below which its imaginary part is rounding."""
LEAST = 1e-12
"""Share of the largest squared frequency that stands for the least in units of energy."""
LONGEST = 400
"""Unknowns up to which the propagator of all states is taken where modes are not told apart."""
STEEP = 340.0
"""Cubed harmonics over squared unknowns from which on that propagator costs a third of the modes: joints of 60°."""
WORST_CONDITION = 1e7
"""Of the modes' states, above which they do not count as independent."""


@dataclass(frozen=True)
class FloquetModes:
    """multiplier, error (its bound), exponent [1/s] (2n,), by falling modulus of the multiplier; states (2n, 2n):
    columns (x, dx/dτ) at τ = 0; trace: ∫ tr(M⁻¹C) dτ; liouville_defect: |ln det Z + ∫ tr(M⁻¹C) dτ| of the exponents;
    off: error of Z, in units of energy."""

    multiplier: Complex
    error: Array
    exponent: Complex
    states: Complex
    trace: float
    liouville_defect: float
    off: float


def floquet_modes(topo: Topology, co: LineCoefficients, turns: Fraction) -> FloquetModes | None:
    """Of the one case of ``co``, whose coefficients repeat after ``turns`` of the input; None where some mode is not
    found."""
    if topo.still or not _pays(topo, co, turns):  # the turn of what no spring holds is not a mode by itself
        return None
    line = HillLine(topo, co, turns)
    start, shape = line.starts()
    found = line.followed(start, shape)
    if (lost := line.lost(found.value)).any():
        found = line.parted(start, shape, found, lost)
    return line.judged(found) if np.isfinite(found.value).all() else None


def _pays(topo: Topology, co: LineCoefficients, turns: Fraction) -> bool:
    """Whether blocks of so many harmonics as a steep joint makes cost less than the matrices of the period."""
    count = len(_harmonics(spreads(topo, co, turns), DECADES + WIDER))
    return topo.size > LONGEST or count**3 < STEEP * topo.size**2


@dataclass(frozen=True)
class _Found:
    """Exponents (mode,), their rotation and its rate at τ = 0 (n, mode), and Σ_h ‖r_h‖ in units of √mass (mode,)."""

    value: Complex
    rotation: Complex
    rate: Complex
    left: Array

    def of(self, which: Flags) -> _Found:
        return _Found(self.value[which], self.rotation[:, which], self.rate[:, which], self.left[which])

    @staticmethod
    def together(parts: list[_Found]) -> _Found:
        keys = ("value", "rotation", "rate", "left")
        return _Found(*(np.concatenate([getattr(part, key) for part in parts], axis=-1) for key in keys))


class HillLine:
    """Its equations over a period, in a narrow and a wide set of harmonics."""

    def __init__(self, topo: Topology, co: LineCoefficients, turns: Fraction) -> None:
        fall = spreads(topo, co, turns)
        self.narrow, self.wide = (_harmonics(fall, decades) for decades in (DECADES, DECADES + WIDER))
        times = 1 << int(np.ceil(np.log2(max(64, 4 * int(np.ptp(self.wide)) + 4))))
        period = 2 * np.pi * float(turns)
        matrices = tree_matrices(topo, co, period * np.arange(times) / times)
        self.n, self.speed = topo.size, float(co.speed[0])
        self.rate, self.time = self.speed / float(turns), period / self.speed
        mass, damping = matrices.mass.own[:, 0], matrices.damping.own[:, 0]
        self.root = np.sqrt(mass.mean(axis=1))
        self.trace = float((damping / mass).mean(axis=1).sum()) * self.time
        self.blocks = TreeHill(topo, matrices, np.zeros((1, len(topo.compliances))), np.array([self.rate]))
        self._mean = [_mean(part, matrices) for part in (matrices.stiffness, matrices.damping)]

    @property
    def mean_stiffness(self) -> Array:
        """The symmetric part of K's mean over the period (n, n)."""
        return self._mean[0]

    def starts(self) -> tuple[Complex, Complex]:
        """Exponents (mode,) of the mean matrices, of each pair one, and shapes (mode, n): damping between undamped
        modes is left out."""
        stiffness, damping = (part / (self.root[:, None] * self.root) for part in self._mean)
        square, basis = self._modes = np.linalg.eigh(stiffness)
        half = np.einsum("ij,ik,kj->j", basis, damping, basis, optimize=True) / 2
        root = np.sqrt((half**2 - square).astype(complex))
        above = root.imag != 0
        value = np.concatenate([-half + root, (-half - root)[~above]])
        shape = (basis / self.root[:, None]).T
        return value, np.concatenate([shape, shape[~above]]).astype(complex)

    def followed(self, value: Complex, shape: Complex) -> _Found:
        """From exponents (mode,) and shapes (mode, n) on; NaN where one does not settle."""
        inside, parts = np.searchsorted(self.wide, self.narrow), []
        batch_size = max(1, MOST_NUMBERS // (self.n * len(self.wide)))
        for begin in range(0, len(value), batch_size):
            keep_time()
            some = slice(begin, begin + batch_size)
            near = np.zeros((self.n, len(value[some]), len(self.narrow)), dtype=complex)
            near[..., int(np.searchsorted(self.narrow, 0))] = shape[some].T
            found, near = self._settled(value[some], near, self.narrow)
            x = np.zeros((*near.shape[:2], len(self.wide)), dtype=complex)
            x[..., inside] = near
            if len(self.wide) > len(self.narrow):
                found, x = self._settled(found, x, self.wide)
            parts.append(self._seen(found, x, self.wide))
        return _Found.together(parts)

    def _seen(self, value: Complex, x: Complex, h: Integers) -> _Found:
        s = value[:, None] + 1j * h * self.rate
        left = self.blocks.at(s, h).times(x) / self.root[:, None, None]
        total = np.sqrt((np.abs(left) ** 2).sum(axis=0)).sum(axis=1)
        return _Found(value, x.sum(axis=2), (x * s).sum(axis=2), total)

    def _settled(self, value: Complex, x: Complex, h: Integers) -> tuple[Complex, Complex]:
        value, x = value.copy(), x.copy()
        left = np.arange(len(value))
        for _ in range(STEPS):
            one = x[:, left] / _size(x[:, left])
            s = value[left, None] + 1j * h * self.rate
            right = self.blocks.at(s, h, slope=True).times(one)
            u = self.blocks.at(s, h).eliminated(right)
            with np.errstate(all="ignore"):
                change = 1 / (one.conj() * u).sum(axis=(0, 2))
                u = u / _size(u)
            good = np.isfinite(u).all(axis=(0, 2)) & np.isfinite(change)
            value[left] = np.where(good, value[left] - change, np.nan)
            x[:, left[good]] = u[:, good]
            with np.errstate(invalid="ignore"):
                left = left[good & (np.abs(change) > SETTLED * np.abs(value[left]))]
            if not len(left):
                break
        value[left] = np.nan
        return value, x

    def lost(self, value: Complex) -> Flags:
        """Which exponents (mode,) did not settle or are those of another mode as well."""
        known = np.flatnonzero(np.isfinite(value))
        v = value[known]
        still = np.abs(v.imag) < ALIKE * self.rate  # its own conjugate
        itself = np.eye(len(v), dtype=bool)
        alike = np.minimum(
            np.where(itself, np.inf, self._apart(v[:, None], v)),
            np.where(itself & still, np.inf, self._apart(v[:, None], v.conj())),
        )
        lost = np.ones(len(value), dtype=bool)
        lost[known] = (alike < ALIKE).any(axis=1)
        return lost

    def _apart(self, one: Complex, other: Complex) -> Array:
        """How far exponents lie apart but for whole multiples of i times the rate, over the rate."""
        off = (one - other) / self.rate
        return np.abs(off.real + 1j * (off.imag - np.round(off.imag)))

    def parted(self, start: Complex, shape: Complex, found: _Found, lost: Flags) -> _Found:
        """With the modes that are ``lost`` found anew, together with those that begin beside them."""
        kept, again = ~lost, list[_Found]()
        left = lost.copy()
        for i in np.flatnonzero(lost).tolist():
            if left[i]:
                members = self._together(start, i, lost)
                beside = [j for j, _, _ in members]
                kept[beside] = left[beside] = False
                again.append(self._plane(start, shape, members))
        whole = found.of(kept)
        for part in again:
            for m in np.flatnonzero(np.isfinite(part.value)).tolist():
                one = part.value[m : m + 1]
                known = np.minimum(self._apart(one, whole.value), self._apart(one, whole.value.conj()))
                if not (known < ALIKE).any():
                    whole = _Found.together([whole, part.of(np.arange(len(part.value)) == m)])
        return whole

    def _together(self, start: Complex, i: int, lost: Flags) -> list[tuple[int, bool, int]]:
        """Modes to be found with i, as of ``_beside``: those beside it, and beside those of them that are lost too."""
        frame, waiting = {(i, False): 0}, [(i, False)]
        while waiting and len(frame) < MOST_TOGETHER:
            j, conjugate = waiting.pop(0)
            for other, turned, k in self._beside(start, j)[1:]:
                key, away = (other, conjugate != turned), frame[j, conjugate] + (-k if conjugate else k)
                if key not in frame and abs(away) <= self.wide[-1]:
                    frame[key] = away
                    waiting += [key] if lost[other] else []
        return [(j, conjugate, k) for (j, conjugate), k in frame.items()]

    def _beside(self, start: Complex, i: int) -> list[tuple[int, bool, int]]:
        """Modes j that begin near the exponent of i, or whose conjugates do, but for k times the rate: (j, conjugate,
        k), i itself the first."""
        every = []
        for conjugate, other in ((False, start), (True, start.conj())):
            k = np.round((start[i] - other).imag / self.rate)
            apart = self._apart(start[i], other)
            good = np.flatnonzero((apart < BESIDE) & (np.abs(k) <= self.wide[-1]))
            every += [(float(apart[j]), int(j), conjugate, int(k[j])) for j in good if conjugate or j != i]
        return [(i, False, 0), *((j, conjugate, k) for _, j, conjugate, k in sorted(every)[:MOST_BESIDE])]

    def _plane(self, start: Complex, shape: Complex, members: list[tuple[int, bool, int]]) -> _Found:
        """The modes of a plane that those of the ``members`` begin."""
        h = np.unique(np.concatenate([self.wide - k for _, _, k in members]))
        x = np.zeros((self.n, len(members), len(h)), dtype=complex)
        value = np.empty(len(members), dtype=complex)
        for m, (j, conjugate, k) in enumerate(members):
            x[:, m, int(np.searchsorted(h, -k))] = shape[j].conj() if conjugate else shape[j]
            value[m] = (start[j].conj() if conjugate else start[j]) + 1j * k * self.rate
        for _ in range(PLANE_STEPS):
            middle = value.mean(keepdims=True)
            s = middle[:, None] + 1j * h * self.rate
            flat = np.linalg.qr(np.moveaxis(x, 1, 2).reshape(-1, len(members)))[0]
            one = np.moveaxis(flat.reshape(self.n, len(h), -1), 2, 1)
            u = self.blocks.at(s, h).eliminated(self.blocks.at(s, h, slope=True).times(one))
            if not np.isfinite(u).all():
                break
            share, turned = np.linalg.eig(np.einsum("nmh,nkh->mk", one.conj(), u))
            value, x = middle - 1 / share, np.einsum("nmh,mk->nkh", u, turned)
        value, x = self._settled(value, x, h)
        return self._seen(value, x, h)

    def judged(self, found: _Found) -> FloquetModes | None:
        """What their states prove, None where that is nothing."""
        n, root, value = self.n, self.root[:, None], found.value
        states = np.stack([found.rotation, found.rate])
        # In units of energy of the mean line's modes, undamped modes of a straight line are orthogonal.
        square, basis = self._modes
        frequency = np.sqrt(np.maximum(np.abs(square), LEAST * np.abs(square).max()))
        v = (basis.T @ (states * root)) * np.stack([frequency, np.ones(n)])[..., None]
        v = v.reshape(2 * n, -1)
        size = np.linalg.norm(v, axis=0)
        left, v = found.left / size, v / size
        turned = np.exp(value * self.time)
        pair = np.abs(turned.imag) > REAL * np.abs(turned)
        largest = np.take_along_axis(v, np.abs(v).argmax(axis=0)[None], axis=0)[0]
        v = np.where(pair, v, v * (np.abs(largest) / largest))
        real = np.concatenate([v.real, v.imag[:, pair]], axis=1)
        if real.shape[1] != 2 * n:
            return None
        try:
            inverse = np.linalg.inv(real)
        except np.linalg.LinAlgError:
            return None
        rows = np.where(pair[:, None], inverse[: len(value)] / 2, inverse[: len(value)]).astype(complex)
        rows[pair] -= 0.5j * inverse[len(value) :]
        condition = np.linalg.norm(rows, axis=1)  # of columns of length 1
        if not condition.max() < WORST_CONDITION:
            return None
        both = np.concatenate([np.arange(len(value)), np.flatnonzero(pair)])
        back = np.arange(len(both)) >= len(value)
        exponent = np.where(back, value[both].conj(), value[both])
        rotations, rates = (np.where(back, part[:, both].conj(), part[:, both]) for part in states)
        multiplier = np.exp(exponent * self.time)
        norm = _norm(real) * _norm(inverse.T) * max(1.0, float(np.abs(multiplier).max()))
        off = float(np.linalg.norm(self.time * norm * left[both] * condition[both]))
        error = bounds_of(multiplier, condition[both], off)
        order = np.argsort(-np.abs(multiplier), kind="stable")
        carried = np.concatenate([rotations, rates / self.speed])[:, order]
        defect = abs(float(exponent.real.sum()) * self.time + self.trace)
        return FloquetModes(
            multiplier[order],
            error[order],
            exponent[order],
            carried / np.abs(carried).max(axis=0),
            self.trace,
            defect,
            off,
        )


def _harmonics(fall: dict[int, float], decades: float) -> Integers:
    return np.array(sorted(side_orders(fall, decades)), dtype=np.int64)


def _mean(entries: TreeEntries, matrices: TreeMatrices) -> Array:
    """The symmetric part of a matrix's mean over the period (n, n)."""
    own, down, up = (part[:, 0].mean(axis=1) for part in (entries.own, entries.down, entries.up))
    found, tied = np.diag(own), np.flatnonzero(matrices.parent >= 0)
    front = matrices.parent[tied]
    found[tied, front] = found[front, tied] = (down[tied] + up[tied]) / 2
    return found


def _size(x: Complex) -> Array:
    """Euclidean norm of each case (case, 1) of x (n, case, h)."""
    return np.asarray(np.sqrt((np.abs(x) ** 2).sum(axis=(0, 2)))[:, None])


def _norm(matrix: Array) -> float:
    """No less than the 2-norm, and hardly more where the columns are all but orthogonal."""
    return float(np.sqrt(np.abs(matrix.T @ matrix).sum(axis=0).max()))
