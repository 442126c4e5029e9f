"""Systems of a tree whose places hold some harmonics each, of which a few entries join different ones.

Where nothing joins them each harmonic is a tree of scalars, which ``condensation`` takes out. What is left are few
places whose entries are matrices, of all harmonics by all (``joined_places``).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from trunnion.arrays import Complex, Flags, Integers
from trunnion.numerics.condensation import Condensed, Plan
from trunnion.numerics.joined_places import JoinedPlaces
from trunnion.numerics.sparse_matrices import Part, SparseMatrices

BALANCED = 2e-13
"""What a solution may leave unbalanced at a place, over what acts there."""
AT_ONCE = 500_000
"""Complex numbers of the matrices of what is left, of cases that are solved at once."""


@dataclass(frozen=True)
class TreeBlock:
    """An entry that joins harmonics: ``values`` (case, pair) at harmonics ``far`` and ``near`` (pair,), by rising
    ``far``."""

    row: int
    column: int
    far: Integers
    near: Integers
    values: Complex

    @cached_property
    def transposed(self) -> TreeBlock:
        """Rows and columns exchanged."""
        order = np.argsort(self.near, kind="stable")
        return TreeBlock(self.column, self.row, self.near[order], self.far[order], self.values[:, order])

    def add_times(self, x: Complex, out: Complex) -> None:
        """Add the product with x (n, case, h) to ``out``."""
        if not len(self.far):
            return
        first = np.flatnonzero(np.diff(self.far, prepend=-1))
        product = np.add.reduceat(self.values * x[self.column][:, self.near], first, axis=1)
        out[self.row][:, self.far[first]] += product


def joined_places(
    left: Integers, own: Complex, couplings: Iterable[tuple[int, int, Complex]], blocks: Iterable[TreeBlock]
) -> JoinedPlaces:
    """The places ``left`` (m,) of a plan: ``own`` (m, case, h) and ``couplings`` by their numbers among these, of what
    joins no harmonics, and the ``blocks`` of what does."""
    number, (cases, count) = {one: k for k, one in enumerate(left.tolist())}, own.shape[1:]
    diagonals = list(own)
    joined = {pair: values for a, b, values in couplings for pair in ((a, b), (b, a))}

    def whole(values: Complex | None) -> Complex:
        if values is not None and values.ndim > 2:
            return values
        made = np.zeros((cases, count, count), dtype=complex)
        if values is not None:
            made[:, np.arange(count), np.arange(count)] = values
        return made

    for block in blocks:
        a, b = number[block.row], number[block.column]
        if a == b:
            one = diagonals[a] = whole(diagonals[a])
        else:
            one = joined[a, b] = whole(joined.get((a, b)))
            joined.setdefault((b, a), np.zeros((cases, count), dtype=complex))
        one[:, block.far, block.near] += block.values
    return JoinedPlaces(diagonals, joined)


class TreeMatrix:
    """Matrices of some cases: ``own`` and ``coupling`` (n, case, h), to the place ``parent`` (n,) in front, of what
    joins no harmonics and is symmetric, and the ``blocks`` of what does, at places that the plan keeps."""

    def __init__(self, plan: Plan, parent: Integers, own: Complex, coupling: Complex, blocks: list[TreeBlock]) -> None:
        self.plan, self.parent, self.own, self.coupling, self.blocks = plan, parent, own, coupling, blocks
        self._tied = np.flatnonzero(parent >= 0)

    def of(self, cases: Any) -> TreeMatrix:
        """Some of the cases."""
        blocks = [replace(b, values=b.values[cases]) for b in self.blocks]
        return TreeMatrix(self.plan, self.parent, self.own[:, cases], self.coupling[:, cases], blocks)

    def times(self, x: Complex, *, transposed: bool = False) -> Complex:
        """Products (n, case, h) with x (n, case, h), of the transpose where that is asked for."""
        out = self.own * x
        for i in self._tied:
            p = self.parent[i]
            out[i] += self.coupling[i] * x[p]
            out[p] += self.coupling[i] * x[i]
        for block in self.blocks:
            (block.transposed if transposed else block).add_times(x, out)
        return np.asarray(out)

    @cached_property
    def _condensed(self) -> Condensed:
        return Condensed(self.plan, self.own.copy(), self.coupling.copy())

    @cached_property
    def _joined(self) -> JoinedPlaces:
        condensed = self._condensed
        return joined_places(self.plan.left, condensed.own, condensed.couplings(), self.blocks)

    def eliminated(self, right: Complex, *, transposed: bool = False) -> Complex:
        """Solutions (n, case, h) under ``right`` (n, case, h), as elimination without exchange of pivots gives them."""
        x = self._condensed.reduced(right.astype(complex))
        if len(self.plan.left):
            x[self.plan.left] = self._joined.solved(x[self.plan.left], transposed=transposed)
        return self._condensed.expanded(x)

    def whole(self) -> SparseMatrices:
        """All numbers, unknowns in the order (place, harmonic)."""
        n, _, count = self.own.shape
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
        figures, by bands with exchange of pivots where that does not do. NaN where a matrix is singular.

        One case of matrices serves any number of right sides.
        """
        if len(parts := list(self._parts())) > 1:
            return np.concatenate([self.of(some).solved(right[:, some]) for some in parts], axis=1)
        x = self.eliminated(right)
        poor = self._unbalanced(x, right)
        if not poor.any():
            return x
        with np.errstate(invalid="ignore", over="ignore"):
            x[:, poor] += self._of(poor).eliminated((right - self.times(x))[:, poor])
        poor = self._unbalanced(x, right)
        for case in np.flatnonzero(poor):
            one = self.of([0] if self.own.shape[1] == 1 else [case]).whole()
            x[:, case] = one.solved(right[:, case].reshape(1, -1)).reshape(x[:, case].shape)
        return x

    def _parts(self) -> Iterator[slice]:
        """The cases, so many together that what is left of them fits into memory."""
        _, cases, count = self.own.shape
        batch_size = max(1, AT_ONCE // max(1, 3 * len(self.plan.left) * count**2))
        yield from (slice(begin, begin + batch_size) for begin in range(0, cases, batch_size))

    def _of(self, cases: Flags) -> TreeMatrix:
        return self if self.own.shape[1] == 1 or cases.all() else self.of(cases)

    def _unbalanced(self, x: Complex, right: Complex) -> Flags:
        """Cases whose solution leaves more than rounding (case,)."""
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            rest = np.abs(right - self.times(x)).max(axis=2)
            acting = np.abs(right).max(axis=2) + np.abs(self.own * x).max(axis=2)
            share = np.where(rest > 0, rest / acting, np.where(np.isnan(rest), np.nan, 0.0))
            return np.asarray(~(share <= BALANCED).all(axis=0))
