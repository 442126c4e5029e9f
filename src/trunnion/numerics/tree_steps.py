"""Products with A = K + sC + s²M on a tree, a few of whose places join harmonics, and steps of inverse iteration with
it, u = A(s)⁻¹A′(s)x.

Matrices and solutions of all places are never formed together: place by place the few numbers of one stay near the
processor, which is most of the time that long lines take. Of longer ones all that joins no harmonics is compiled
(``tree_columns``).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from trunnion.arrays import Array, Complex, Integers
from trunnion.numerics.condensation import Plan
from trunnion.numerics.tree_blocks import TreeBlock, joined_places

Three = tuple[Array, Array, Array]
"""K, C and M."""
COMPILED = 40
"""Places from which on compiled code pays, were it only for one look at a line."""


@dataclass(frozen=True)
class TreePencil:
    """``own`` and ``coupling`` (n, 1) or (n, case) of K, C and M, to the place ``parent`` (n,) in front, of what joins
    no harmonics and is symmetric; blocks stand at places that the ``plan`` keeps."""

    plan: Plan
    parent: Integers
    own: Three
    coupling: Three

    def times(self, s: Complex, x: Complex, blocks: list[TreeBlock]) -> Complex:
        """Ax (n, case, h) of x (n, case, h) at s (case, h); ``blocks`` of A join harmonics."""
        if len(self.parent) >= COMPILED:
            return self._times_in_columns(s, x, blocks, slope=False)
        return self._times(self.own, self.coupling, (s, s * s), x, blocks)

    def stepped(self, s: Complex, x: Complex, blocks: list[TreeBlock], slopes: list[TreeBlock]) -> Complex:
        """u (n, case, h) of x (n, case, h) at s (case, h); ``blocks`` of A and ``slopes`` of A′ join harmonics."""
        if len(self.parent) >= COMPILED:
            return self._eliminated_in_columns(s, self._times_in_columns(s, x, slopes, slope=True), blocks)
        own, coupling = ((c, m, np.zeros_like(k)) for k, c, m in (self.own, self.coupling))  # A′ = C + 2sM
        with np.errstate(all="ignore"):
            return self._eliminated(s, self._times(own, coupling, (2 * s, s), x, slopes), blocks)

    def _times_in_columns(self, s: Complex, x: Complex, blocks: list[TreeBlock], *, slope: bool) -> Complex:
        """As ``times``, or of the ``slope`` A′."""
        from trunnion.numerics.tree_columns import multiply_columns

        out = np.empty(x.shape, dtype=complex)
        flat = np.ascontiguousarray(x).reshape(len(x), -1)
        multiply_columns(self.parent, *self._numbers, slope, s.reshape(-1), flat, out.reshape(flat.shape))
        for block in blocks:
            block.add_times(x, out)
        return out

    def _eliminated_in_columns(self, s: Complex, right: Complex, blocks: list[TreeBlock]) -> Complex:
        """A⁻¹ of ``right`` (n, case, h), in place."""
        from trunnion.numerics.tree_columns import condense_columns, expand_columns

        plan, flat = self.plan, right.reshape(len(right), -1)
        edges = np.array([e for _, _, e in plan.edges], dtype=np.int64)
        shares = np.empty((len(plan.rows), 2, flat.shape[1]), dtype=complex)
        pivots, joined = (np.empty((count, flat.shape[1]), dtype=complex) for count in (len(plan.left), len(edges)))
        condense_columns(plan.rows, plan.left, edges, *self._numbers, s.reshape(-1), flat, shares, pivots, joined)
        if len(plan.left):
            number = {place: k for k, place in enumerate(plan.left.tolist())}
            ends = [(number[a], number[b]) for a, b, _ in plan.edges]
            couplings = [(a, b, one.reshape(s.shape)) for (a, b), one in zip(ends, joined, strict=True)]
            places = joined_places(plan.left, pivots.reshape(-1, *s.shape), couplings, blocks)
            right[plan.left] = places.solved(right[plan.left])
        expand_columns(plan.rows, shares, flat)
        return right

    @cached_property
    def _numbers(self) -> tuple[Array, Array]:
        """``own`` and ``coupling`` (3, n, 1 or case)."""
        return np.array(self.own), np.array(self.coupling)

    def _times(
        self, own: Three, coupling: Three, powers: tuple[Complex, Complex], x: Complex, blocks: list[TreeBlock]
    ) -> Complex:
        """(K + p₁C + p₂M)x of such numbers and ``blocks``."""
        own, coupling = _columns(own), _columns(coupling)
        out, part = np.empty_like(x), np.empty_like(powers[0])
        for i in range(len(x)):
            np.multiply(_summed(own, i, powers, part), x[i], out=out[i])
        for i in np.flatnonzero(self.parent >= 0).tolist():
            p = int(self.parent[i])
            if not any(one[i].any() for one in coupling):
                continue
            both = _summed(coupling, i, powers, part)
            out[i] += both * x[p]
            out[p] += both * x[i]
        for block in blocks:
            block.add_times(x, out)
        return out

    def _eliminated(self, s: Complex, right: Complex, blocks: list[TreeBlock]) -> Complex:
        """A⁻¹ of ``right`` (n, case, h), in place."""
        squared, part = s * s, np.empty_like(s)
        own, coupling = _columns(self.own), _columns(self.coupling)

        def at(three: Three, i: int) -> Complex:
            return _summed(three, i, (s, squared), part)

        pivot: dict[int, Complex] = {}

        def own_of(i: int) -> Complex:
            if i not in pivot:
                pivot[i] = at(own, i)
            return pivot[i]

        made = dict[int, Complex]()
        size, back = len(self.parent), []
        for step in self.plan.steps:
            i = step.place
            over = 1 / own_of(i)
            del pivot[i]
            parts = [made[e] if e >= size else at(coupling, e) for e in step.edges]
            shares = [one * over for one in parts]
            for a, one, share in zip(step.neighbours, parts, shares, strict=True):
                own_of(a).__isub__(np.multiply(share, one, out=part))
                right[a] -= np.multiply(share, right[i], out=part)
            if step.new >= 0:
                found = shares[0] * parts[1]
                made[step.new] = np.negative(found, out=found)
            right[i] *= over
            back.append((i, step.neighbours, shares))
        left = self.plan.left
        if len(left):
            number = {place: k for k, place in enumerate(left.tolist())}
            edges = [(number[a], number[b], made[e] if e >= size else at(coupling, e)) for a, b, e in self.plan.edges]
            joined = joined_places(left, np.array([own_of(i) for i in left.tolist()]), edges, blocks)
            right[left] = joined.solved(right[left])
        for i, neighbours, shares in reversed(back):
            for a, share in zip(neighbours, shares, strict=True):
                right[i] -= np.multiply(share, right[a], out=part)
        return right


def _columns(three: Three) -> Three:
    """With an axis (n, case, 1) of harmonics."""
    k, c, m = (one[:, :, None] for one in three)
    return k, c, m


def _summed(three: Three, i: int, powers: tuple[Complex, Complex], part: Complex) -> Complex:
    """Of a place, K + p₁C + p₂M (case, h); ``part`` is written over."""
    k, c, m = (one[i] for one in three)
    found = powers[0] * c
    found += k
    if m.any():
        found += np.multiply(powers[1], m, out=part)
    return found
