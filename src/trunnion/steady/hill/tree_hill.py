"""Hill's blocks of a long line: what does not vary is eliminated along the tree, harmonic by harmonic.

The equations are those of ``hill``. Joints and meshes make only the rotations next to them vary; everywhere else the
harmonics do not meet, and each is a tree of scalars. Condensed (``numerics.condensation``), a line of any length leaves
the rotations beside its joints, some harmonics of each. The cost grows with its length, and so does the memory.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Complex, Flags, Integers
from trunnion.equations.aligned import rigid_rotation
from trunnion.equations.topology import Topology
from trunnion.equations.tree_matrices import TreeMatrices
from trunnion.numerics.condensation import Plan
from trunnion.numerics.tree_blocks import TreeBlock, TreeMatrix
from trunnion.numerics.tree_steps import TreePencil
from trunnion.steady.hill.hill import interpolated
from trunnion.steady.hill.straight import about_first, bounded

CONSTANT = 1e-15
"""Share of its size by which an entry may vary over the period and count as constant: rounding."""
NEGLIGIBLE = 2e-16
"""Share of the largest below which Fourier coefficients of an entry are left out."""


@dataclass(frozen=True)
class Varying:
    """One entry of the matrices that varies: its ``row`` and ``column`` among the unknowns, the harmonics ``apart``
    (d,) that it couples, and the Fourier coefficients (node, d) of K, C and M."""

    row: int
    column: int
    apart: Integers
    parts: tuple[Complex, Complex, Complex]


class TreeHill:
    """Fourier coefficients of a batch of long lines over one period; solves any carrier and any span of harmonics.

    As ``hill.HillBlocks``, with the entries of a tree, and those beside it, in place of n × n matrices.
    """

    def __init__(
        self, topo: Topology, matrices: TreeMatrices, loss: Array, step: Array, *, linearised: bool = False
    ) -> None:
        """See ``HillBlocks``."""
        self.topo, self.loss, self.step, self.linearised = topo, loss, step, linearised
        self.parent, self.times = matrices.parent, matrices.wave.shape[1]
        self.varying: list[Varying] = []
        three = matrices.three
        self.own, moves = _constant(*(part.own for part in three))
        self.coupling, sways = _constant(*(part.down for part in three))
        differ = np.any([np.abs(part.down - part.up).max(axis=2) > CONSTANT * np.abs(part.down).max(axis=2)
                         for part in three], axis=(0, 2))  # fmt: skip
        sways = (sways | differ) & (self.parent >= 0)
        # Of a diagonal entry the mean stays among what does not vary, which then tells its size.
        for mean, part in zip(self.own, three, strict=True):
            mean[moves] = part.own[moves].mean(axis=2)
        for mean in self.coupling:
            mean[sways] = 0.0
        kept = moves.copy()
        for i in np.flatnonzero(moves).tolist():
            self._vary(i, i, [part.own[i] for part in three])
        for i in np.flatnonzero(sways).tolist():
            p = int(self.parent[i])
            kept[[i, p]] = True
            self._vary(i, p, [part.down[i] for part in three])
            self._vary(p, i, [part.up[i] for part in three])
        for one in matrices.beside:
            kept[[one.row, one.column]] = True
            self._vary(one.row, one.column, one.parts)
        steady = (np.ptp(matrices.ratio, axis=1) <= CONSTANT * np.abs(matrices.ratio).max(axis=1)).all(axis=0)
        self.ratio = [self._ratio(matrices.ratio[..., e], one) for e, one in enumerate(steady.tolist())]
        for e, (far, near) in enumerate(topo.ends):
            if loss[:, e].any() and near >= 0 and self.ratio[e].shape[1] > 1:
                kept[[max(far, near), near]] = True
        self.plan = Plan.of(self.parent, kept)

    def _vary(self, row: int, column: int, parts: Sequence[Array]) -> None:
        series = [np.fft.fft(part, axis=1) / self.times for part in parts]
        size = [np.abs(part).max(axis=0) for part in series]
        apart = np.fft.fftfreq(self.times, 1 / self.times).round().astype(np.int64)
        strong = np.any([one > NEGLIGIBLE * one.max() for one in size], axis=0) & (2 * np.abs(apart) < self.times)
        strong[0] &= row != column
        k, c, m = (part[:, strong] for part in series)
        self.varying.append(Varying(row, column, apart[strong], (k, c, m)))

    def _ratio(self, ratio: Array, steady: bool) -> Complex:
        """Fourier coefficients (node, time) of a spring's ratio, (node, 1) of one that is ``steady``."""
        if steady:
            return ratio[:, :1].astype(complex)
        return np.asarray(np.fft.fft(ratio, axis=1) / self.times)

    def at(self, s: Complex, harmonics: Integers, weights: Array | None = None, *, slope: bool = False) -> TreeMatrix:
        """The matrices at s (case, h) [1/s] of the ``harmonics`` (h,), or their ``slope`` by s."""
        power = (0.0, 1.0, 2.0 * s) if slope else (1.0, s, s * s)

        def summed(parts: Iterable[Array]) -> Complex:
            k, c, m = (np.asarray(interpolated(weights, part.T).T)[:, :, None] for part in parts)
            found = power[0] * k + power[1] * c
            return np.asarray(found + power[2] * m if m.any() else found + np.zeros_like(s))

        own, coupling = summed(self.own).astype(complex), summed(self.coupling).astype(complex)
        blocks = [self._block(entry, s, harmonics, weights, slope) for entry in self.varying]
        if self.loss.any() and not slope:
            blocks += self._add_loss(own, coupling, np.sign(s.imag), harmonics, weights)
        return TreeMatrix(self.plan, self.parent, own, coupling, blocks)

    def felt(self, s: Complex, harmonics: Integers, x: Complex) -> Complex:
        """Ax (n, case, h) of x (n, case, h), of matrices A at s as of ``at``."""
        if self.loss.any():
            return self.at(s, harmonics).times(x)
        blocks = [self._block(one, s, harmonics, None, slope=False) for one in self.varying]
        return self._pencil(None).times(s, x, blocks)

    def stepped(self, s: Complex, harmonics: Integers, x: Complex, weights: Array | None = None) -> Complex:
        """A⁻¹A′x (n, case, h) of x (n, case, h), of matrices A at s as of ``at``: a step of inverse iteration."""
        if self.loss.any():
            right = self.at(s, harmonics, weights, slope=True).times(x)
            return self.at(s, harmonics, weights).eliminated(right)
        blocks, slopes = ([self._block(one, s, harmonics, weights, of) for one in self.varying] for of in (False, True))
        return self._pencil(weights).stepped(s, x, blocks, slopes)

    def _pencil(self, weights: Array | None) -> TreePencil:
        """With entries at the nodes, or at the cases that ``weights`` carry to."""

        def every(three: tuple[Array, ...]) -> tuple[Array, Array, Array]:
            k, c, m = (np.asarray(interpolated(weights, part.T).T) for part in three)
            return k, c, m

        return TreePencil(self.plan, self.parent, every(self.own), every(self.coupling))

    def _block(self, entry: Varying, s: Complex, h: Integers, weights: Array | None, slope: bool) -> TreeBlock:
        meant = h[:, None] - entry.apart  # pairs come by their far harmonic
        place = np.minimum(np.searchsorted(h, meant), len(h) - 1)
        far, at = np.nonzero(h[place] == meant)
        near = place[far, at]
        k, c, m = (interpolated(weights, part)[:, at] for part in entry.parts)
        v = s[:, near]
        values = c + 2 * v * m if slope else k + v * (c + v * m)
        return TreeBlock(entry.row, entry.column, far, near, np.asarray(values))

    def _add_loss(
        self, own: Complex, coupling: Complex, sign: Array, h: Integers, weights: Array | None
    ) -> list[TreeBlock]:
        """Add damping whatever the frequency of springs whose ratio does not vary; blocks of the others."""
        blocks = []
        apart = h[:, None] - h[None, :]
        inside = 2 * np.abs(apart) < self.times
        far_h, near_h = (part.ravel() for part in np.indices(apart.shape))
        for e, (far, near) in enumerate(self.topo.ends):
            if not self.loss[:, e].any():
                continue
            loss = 1j * interpolated(weights, self.loss[:, e, None]) * sign
            if far >= 0:
                own[far] += loss
            if near < 0:
                continue
            ratio = interpolated(weights, self.ratio[e])
            if ratio.shape[1] == 1:
                own[near] += ratio**2 * loss
                if far >= 0:
                    coupling[far] -= ratio * loss
                continue
            wave = np.where(inside, ratio[:, apart % self.times], 0.0)
            parts = [(near, near, wave @ (loss[:, :, None] * wave))]
            if far >= 0:
                parts += [(far, near, -loss[:, :, None] * wave), (near, far, -wave * loss[:, None, :])]
            blocks += [TreeBlock(a, b, far_h, near_h, v.reshape(len(v), -1)) for a, b, v in parts]
        return blocks

    def solve(self, weights: Array | None, carrier: Array, harmonics: Integers, rim: Flags, right: Complex) -> Complex:
        """X (case, h, n) of G (node, h, n), as ``HillBlocks.solve``; harmonics on the rim are solved with all."""
        s = 1j * (carrier[:, None] + harmonics * self.step[:, None])
        matrix = self.at(np.asarray(interpolated(weights, s)), harmonics, weights)
        g = np.ascontiguousarray(np.moveaxis(interpolated(weights, right), 2, 0))
        if self.topo.free and not carrier.any() and (harmonics == 0).any():
            x = self._held(matrix, int(np.flatnonzero(harmonics == 0)[0]), g)
        else:
            turn = rigid_rotation(self.topo) if self.topo.free else np.zeros(len(g))
            x = about_first(matrix, g, turn) if self.linearised else bounded(matrix, g, matrix.solved(g), turn)
        return np.ascontiguousarray(np.moveaxis(x, 0, 2))

    def _held(self, matrix: TreeMatrix, still: int, right: Complex) -> Complex:
        """Solutions of a line that nothing holds: what turns it as a whole at the harmonic ``still`` is taken to be
        zero, by as much stiffness as the line has.

        The turn of the whole line joins all places, which no tree does: the first is held in its place, and both are
        exchanged by two more columns.
        """
        turn = rigid_rotation(self.topo) / np.linalg.norm(rigid_rotation(self.topo))
        weight = np.abs(matrix.own[..., still]).max(axis=0)
        matrix.own[0, :, still] += weight
        columns = np.zeros((2, *right.shape), dtype=complex)
        columns[0, :, :, still], columns[1, 0, :, still] = turn[:, None], 1.0
        x, p, q = (matrix.solved(part) for part in (right, *columns))
        both = np.stack([p, q])

        def seen(y: Complex) -> Complex:
            return np.stack([turn @ y[..., still], y[0, :, still]])

        size = np.stack([1 / weight, -1 / weight])
        little = np.stack([seen(one) for one in both], axis=1) + size[:, None] * np.eye(2)[:, :, None]
        share = np.linalg.solve(np.moveaxis(little, 2, 0), seen(x).T[..., None])[..., 0]
        return np.asarray(x - np.einsum("kncs,ck->ncs", both, share))


def _constant(*parts: Array) -> tuple[tuple[Array, ...], Flags]:
    """Entries (n, node, time) at the first time, (n, node), and which of them vary (n,)."""
    vary = [np.ptp(part, axis=2) > CONSTANT * np.abs(part).max(axis=2) for part in parts]
    return tuple(part[..., 0].copy() for part in parts), np.any(vary, axis=(0, 2))
