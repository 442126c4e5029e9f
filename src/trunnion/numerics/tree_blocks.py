"""Systems of a tree whose places hold some harmonics each, of which a few entries join different ones.

Where nothing joins them each harmonic is a tree of scalars, which ``condensation`` takes out; what is left are the
places of such entries, all their harmonics together.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from trunnion.arrays import Complex, Flags, Integers
from trunnion.numerics.condensation import Condensed, Plan
from trunnion.numerics.sparse_matrices import Part, SparseMatrices

BALANCED = 2e-13
"""What a solution may leave unbalanced at a place, over what acts there."""
DENSE = 2_000_000
"""Complex numbers of the condensed matrices that are solved at once."""


@dataclass(frozen=True)
class Block:
    """What a varying entry is at some s: ``values`` (case, pair) at harmonics ``far`` and ``near`` (pair,)."""

    row: int
    column: int
    far: Integers
    near: Integers
    values: Complex

    @cached_property
    def transposed(self) -> Block:
        """Rows and columns exchanged."""
        order = np.argsort(self.near, kind="stable")
        return Block(self.column, self.row, self.near[order], self.far[order], self.values[:, order])

    def add_times(self, x: Complex, out: Complex) -> None:
        """Add the product with x (n, case, h) to ``out``."""
        if not len(self.far):
            return
        first = np.flatnonzero(np.diff(self.far, prepend=-1))
        product = np.add.reduceat(self.values * x[self.column][:, self.near], first, axis=1)
        out[self.row][:, self.far[first]] += product


class TreeMatrix:
    """Matrices of some cases: ``own`` and ``coupling`` (n, case, h), to the place ``parent`` (n,) in front, of what
    joins no harmonics and is symmetric, and the ``blocks`` of what does, at places that the plan keeps."""

    def __init__(self, plan: Plan, parent: Integers, own: Complex, coupling: Complex, blocks: list[Block]) -> None:
        self.plan, self.parent, self.own, self.coupling, self.blocks = plan, parent, own, coupling, blocks
        self._tied = np.flatnonzero(parent >= 0)

    @property
    def transposed(self) -> TreeMatrix:
        """Its transpose: what does not vary is symmetric."""
        made = TreeMatrix(self.plan, self.parent, self.own, self.coupling, [b.transposed for b in self.blocks])
        if "_condensed" in self.__dict__:
            made.__dict__["_condensed"] = self._condensed
        return made

    def of(self, cases: Any) -> TreeMatrix:
        """Some of the cases."""
        blocks = [replace(b, values=b.values[cases]) for b in self.blocks]
        return TreeMatrix(self.plan, self.parent, self.own[:, cases], self.coupling[:, cases], blocks)

    def times(self, x: Complex) -> Complex:
        """Products (n, case, h) with x (n, case, h)."""
        out = self.own * x
        for i in self._tied:
            p = self.parent[i]
            out[i] += self.coupling[i] * x[p]
            out[p] += self.coupling[i] * x[i]
        for block in self.blocks:
            block.add_times(x, out)
        return np.asarray(out)

    @cached_property
    def _condensed(self) -> Condensed:
        return Condensed(self.plan, self.own.copy(), self.coupling.copy())

    def eliminated(self, right: Complex) -> Complex:
        """Solutions (n, case, h) under ``right`` (n, case, h), as elimination without exchange of pivots gives them."""
        x = self._condensed.reduced(right.astype(complex))
        left = self.plan.left
        if len(left):
            x[left] = self._left_solved(x[left])
        return self._condensed.expanded(x)

    def _left_solved(self, right: Complex) -> Complex:
        """Solutions (m, case, h) of what is left."""
        m, cases, count = right.shape
        size, found = m * count, np.empty((cases, m, count), dtype=complex)
        alone = self.own.shape[1] == 1
        at_once = cases if alone else max(1, DENSE // size**2)
        b = np.moveaxis(right, 0, 1)
        for begin in range(0, cases, at_once):
            some = slice(begin, begin + at_once)
            matrix = self._left(slice(None) if alone else some)
            found[some] = matrix.solved(b[some].reshape(-1, size)).reshape(-1, m, count)
        return np.moveaxis(found, 1, 0)

    def _left(self, cases: slice) -> SparseMatrices:
        """The matrices of what is left, unknowns in the order (place, harmonic)."""
        condensed, count = self._condensed, self.own.shape[2]
        m, every = len(self.plan.left), np.arange(count)
        place = np.arange(m)[:, None] * count + every
        own = np.moveaxis(condensed.own[:, cases], 1, 0)
        parts: list[Part] = [(place, place, own.reshape(len(own), -1))]
        for a, b, coupling in condensed.couplings():
            parts += [(place[a], place[b], coupling[cases]), (place[b], place[a], coupling[cases])]
        number = {one: k for k, one in enumerate(self.plan.left.tolist())}
        for block in self.blocks:
            row, column = place[number[block.row]], place[number[block.column]]
            parts.append((row[block.far], column[block.near], block.values[cases]))
        return SparseMatrices.added(m * count, parts)

    def whole(self) -> SparseMatrices:
        """All numbers, unknowns in the order (place, harmonic)."""
        n, cases, count = self.own.shape
        place = np.arange(n)[:, None] * count + np.arange(count)
        tied, front = place[self._tied], place[self.parent[self._tied]]
        coupling = np.moveaxis(self.coupling[self._tied], 1, 0)
        parts: list[Part] = [
            (place, place, np.moveaxis(self.own, 1, 0)), (tied, front, coupling), (front, tied, coupling)
        ]  # fmt: skip
        parts += [(place[b.row][b.far], place[b.column][b.near], b.values) for b in self.blocks]
        return SparseMatrices.added(n * count, parts)

    def solved(self, right: Complex) -> Complex:
        """Solutions (n, case, h) under ``right`` (n, case, h), balanced to rounding: refined where elimination lost
        figures, by bands with exchange of pivots where that does not do. NaN where a matrix is singular."""
        x = self.eliminated(right)
        poor = self._unbalanced(x, right)
        if not poor.any():
            return x
        with np.errstate(invalid="ignore", over="ignore"):
            x[:, poor] += self._of(poor).eliminated((right - self.times(x))[:, poor])
        poor = self._unbalanced(x, right)
        for case in np.flatnonzero(poor):
            one = self.of([case]).whole()
            given = right[:, case].reshape(1, -1)
            x[:, case] = one.solved(given).reshape(x[:, case].shape)
        return x

    def _of(self, cases: Flags) -> TreeMatrix:
        return self if self.own.shape[1] == 1 else self.of(cases)

    def _unbalanced(self, x: Complex, right: Complex) -> Flags:
        """Cases whose solution leaves more than rounding (case,)."""
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            rest = np.abs(right - self.times(x)).max(axis=2)
            acting = np.abs(right).max(axis=2) + np.abs(self.own * x).max(axis=2)
            share = np.where(rest > 0, rest / acting, np.where(np.isnan(rest), np.nan, 0.0))
            return np.asarray(~(share <= BALANCED).all(axis=0))
