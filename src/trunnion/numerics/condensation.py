"""Linear systems whose matrix has the pattern of a tree, condensed to a few of its places: the others are eliminated.

    A x = b,  A symmetric,  A[i, i] = own[i],  A[i, parent[i]] = A[parent[i], i] = coupling[i]

A place with one neighbour, or with two, is taken out; two neighbours are coupled then, and the pattern stays a tree.
What is left are the places *kept*, for which something else holds besides, and where three or more branches meet that
lead to some of them. All numbers are arrays, so that many systems of one pattern are solved together. No pivots are
exchanged: a part of the tree in resonance by itself may cost figures, which the caller sees from the residual.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from trunnion.arrays import Complex, Flags, Integers, Places


@dataclass(frozen=True)
class Step:
    """Taking out ``place``: its neighbours, and where the coupling to each stands; ``new``: where that of two
    neighbours to each other goes, −1 with fewer."""

    place: int
    neighbours: tuple[int, ...]
    edges: tuple[int, ...]
    new: int


@dataclass(frozen=True)
class Plan:
    """In which order a tree is condensed: ``steps``; ``left`` (m,) are the places that stay, ascending, and ``edges``
    the pairs of them that are coupled, each with the place of its coupling; ``couplings``: how many there are in all.
    """

    size: int
    steps: tuple[Step, ...]
    left: Places
    edges: tuple[tuple[int, int, int], ...]
    couplings: int

    @staticmethod
    def of(parent: Integers, kept: Flags) -> Plan:
        """``parent`` (n,) of each place, smaller than it, or −1; the places ``kept`` (n,) stay."""
        n = len(parent)
        beside: list[dict[int, int]] = [{} for _ in range(n)]
        for i, p in enumerate(parent.tolist()):
            if p >= 0:
                beside[i][p] = beside[p][i] = i
        steps, count = list[Step](), n
        waiting = [i for i in range(n - 1, -1, -1) if not kept[i]]
        while True:
            later = list[int]()
            for i in waiting:
                if len(beside[i]) > 2:
                    later.append(i)
                    continue
                around = beside[i]
                for a in around:
                    del beside[a][i]
                new = -1
                if len(around) == 2:
                    new, count = count, count + 1
                    a, b = around
                    beside[a][b] = beside[b][a] = new
                steps.append(Step(i, tuple(around), tuple(around.values()), new))
                beside[i] = {}
            if len(later) == len(waiting):
                break
            waiting = later
        left = np.array(sorted({*np.flatnonzero(kept).tolist(), *waiting}), dtype=np.intp)
        edges = tuple((a, b, e) for a in left.tolist() for b, e in beside[a].items() if a < b)
        return Plan(n, tuple(steps), left, edges, count)

    @cached_property
    def rows(self) -> Integers:
        """The steps (step, 6): place, two neighbours, where the couplings to them stand, and ``new``; −1 for none."""
        none = (-1, -1)
        rows = [(s.place, *(*s.neighbours, *none)[:2], *(*s.edges, *none)[:2], s.new) for s in self.steps]
        return np.array(rows, dtype=np.int64).reshape(-1, 6)


class Condensed:
    """One or many trees of a pattern, condensed.

    own (m, …) and coupling (m, m, …)-wise by ``Plan.edges``: the matrix of the places that are left.
    """

    def __init__(self, plan: Plan, own: Complex, coupling: Complex) -> None:
        """``own`` and ``coupling`` (n, …), of a place without parent anything; both are kept and written over."""
        self.plan = plan
        self._pivot, self._coupling = own, list(coupling) + [None] * (plan.couplings - plan.size)
        self._over: list[Complex] = []
        self._shares: list[tuple[Complex, ...]] = []
        with np.errstate(all="ignore"):
            for step in plan.steps:
                over = 1 / own[step.place]
                parts = [self._coupling[e] for e in step.edges]
                shares = tuple(part * over for part in parts)
                for a, part, share in zip(step.neighbours, parts, shares, strict=True):
                    own[a] -= share * part
                if step.new >= 0:
                    self._coupling[step.new] = -shares[0] * parts[1]
                self._over.append(over)
                self._shares.append(shares)

    @property
    def own(self) -> Complex:
        """The diagonal (m, …) of what is left."""
        return self._pivot[self.plan.left]

    def couplings(self) -> Iterator[tuple[int, int, Complex]]:
        """Pairs among ``Plan.left`` by their number there, and the entry [i, j] = [j, i] (…)."""
        number = {place: k for k, place in enumerate(self.plan.left.tolist())}
        for a, b, e in self.plan.edges:
            yield number[a], number[b], self._coupling[e]

    def reduced(self, right: Complex) -> Complex:
        """``right`` (n, …), in place, so that its places that are left stand for all of it."""
        acted = [bool(row.any()) for row in right]
        with np.errstate(all="ignore"):
            for step, shares in zip(self.plan.steps, self._shares, strict=True):
                if acted[step.place]:
                    for a, share in zip(step.neighbours, shares, strict=True):
                        right[a] -= share * right[step.place]
                        acted[a] = True
        return right

    def expanded(self, x: Complex) -> Complex:
        """The solution (n, …), in place: ``x`` at places that are left, and what ``reduced`` made of b elsewhere."""
        with np.errstate(all="ignore"):
            for step, over, shares in zip(
                reversed(self.plan.steps), reversed(self._over), reversed(self._shares), strict=True
            ):
                own = x[step.place]
                own *= over
                for a, share in zip(step.neighbours, shares, strict=True):
                    own -= share * x[a]
        return x
