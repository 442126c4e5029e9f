"""Systems of a tree whose places hold some harmonics each, of which a few entries join different ones.

Where nothing joins them each harmonic is a tree of scalars, which ``condensation`` takes out. What is left are few
places whose entries are matrices, of all harmonics by all. They are a tree, which is eliminated from its leaves, unless
entries join places of different branches: then taking one out joins those that it was joined to.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from trunnion.arrays import Complex, Flags, Integers
from trunnion.numerics.condensation import Condensed, Plan
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


@dataclass(frozen=True)
class _TakenOut:
    """One place of what is left, taken out: the inverse of its matrix, and that times the couplings with each of the
    ``fronts`` from the right and from the left."""

    fronts: tuple[int, ...]
    inverse: Complex
    behind: tuple[Complex, ...]
    ahead: tuple[Complex, ...]


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
    def _taken_out(self) -> list[_TakenOut]:
        """What is left, by its number there, taken out from the last place on."""
        own, couplings = self._left()
        found = list[_TakenOut]()
        with np.errstate(all="ignore"):
            for k in reversed(range(len(own))):
                inverse, fronts = _inverse(own[k]), tuple(sorted(a for a, b in couplings if b == k and a < k))
                behind = tuple(inverse @ couplings[k, a] for a in fronts)
                ahead = tuple(couplings[a, k] @ inverse for a in fronts)
                for a in fronts:
                    for b, part in zip(fronts, behind, strict=True):
                        less = couplings[a, k] @ part
                        if a == b:
                            own[a] -= less
                        else:
                            couplings[a, b] = couplings[a, b] - less if (a, b) in couplings else -less
                found.append(_TakenOut(fronts, inverse, behind, ahead))
        return found[::-1]

    def _left(self) -> tuple[list[Complex], dict[tuple[int, int], Complex]]:
        """Matrices (case, h, h) of the places that are left and of their couplings, by their numbers."""
        condensed, cases, count = self._condensed, *self.own.shape[1:]
        number, every = {one: k for k, one in enumerate(self.plan.left.tolist())}, np.arange(count)

        def diagonal(values: Complex) -> Complex:
            made = np.zeros((cases, count, count), dtype=complex)
            made[:, every, every] = values
            return made

        own = [diagonal(values) for values in condensed.own]
        couplings = {}
        for a, b, values in condensed.couplings():
            couplings[a, b], couplings[b, a] = diagonal(values), diagonal(values)
        nothing = np.zeros((cases, count), dtype=complex)
        for block in self.blocks:
            a, b = number[block.row], number[block.column]
            if a != b and (a, b) not in couplings:
                couplings[a, b], couplings[b, a] = diagonal(nothing), diagonal(nothing)
            (own[a] if a == b else couplings[a, b])[:, block.far, block.near] += block.values
        return own, couplings

    def eliminated(self, right: Complex, *, transposed: bool = False) -> Complex:
        """Solutions (n, case, h) under ``right`` (n, case, h), as elimination without exchange of pivots gives them."""
        x = self._condensed.reduced(right.astype(complex))
        if len(self.plan.left):
            x[self.plan.left] = self._left_solved(x[self.plan.left], transposed)
        return self._condensed.expanded(x)

    def _left_solved(self, x: Complex, transposed: bool) -> Complex:
        """Solutions (m, case, h) of what is left, in place."""
        with np.errstate(all="ignore"):
            for k in reversed(range(len(x))):
                one = self._taken_out[k]
                for a, part in zip(one.fronts, one.behind if transposed else one.ahead, strict=True):
                    x[a] -= _applied(part, x[k], transposed)
            for k, one in enumerate(self._taken_out):
                x[k] = _applied(one.inverse, x[k], transposed)
                for a, part in zip(one.fronts, one.ahead if transposed else one.behind, strict=True):
                    x[k] -= _applied(part, x[a], transposed)
        return x

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


def _applied(matrix: Complex, x: Complex, transposed: bool) -> Complex:
    """Products (case, h) of matrices (case, h, h) with x (case, h)."""
    return np.asarray((x[:, None] @ matrix)[:, 0] if transposed else (matrix @ x[..., None])[..., 0])


def _inverse(matrix: Complex) -> Complex:
    """Inverses (case, h, h); NaN where there is none."""
    try:
        return np.asarray(np.linalg.inv(matrix))
    except np.linalg.LinAlgError:
        found = np.full_like(matrix, np.nan)
        for one, made in zip(matrix, found, strict=True):
            try:
                made[:] = np.linalg.inv(one)
            except np.linalg.LinAlgError:
                continue
        return found
