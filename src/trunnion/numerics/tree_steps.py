"""Products with A = K + sC + s²M on a tree, a few of whose places join harmonics, and steps of inverse iteration with
it, u = A(s)⁻¹A′(s)x.

Matrices and solutions of all places are never formed together: place by place the few numbers of one stay near the
processor, which is most of the time that long lines take.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Complex, Integers
from trunnion.numerics.condensation import Plan
from trunnion.numerics.tree_blocks import TreeBlock, joined_places

Three = tuple[Array, Array, Array]
"""K, C and M."""


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
        return self._times(self.own, self.coupling, (s, s * s), x, blocks)

    def stepped(self, s: Complex, x: Complex, blocks: list[TreeBlock], slopes: list[TreeBlock]) -> Complex:
        """u (n, case, h) of x (n, case, h) at s (case, h); ``blocks`` of A and ``slopes`` of A′ join harmonics."""
        own, coupling = ((c, m, np.zeros_like(k)) for k, c, m in (self.own, self.coupling))  # A′ = C + 2sM
        with np.errstate(all="ignore"):
            return self._eliminated(s, self._times(own, coupling, (2 * s, s), x, slopes), blocks)

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
