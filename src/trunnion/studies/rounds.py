"""The rounds of a study that looks for a boundary: what its store knows, and the part that comes next."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from trunnion.studies.design import StudyAxis, StudyDesign
from trunnion.studies.parts import StudyPart
from trunnion.studies.points import DONE
from trunnion.studies.quantities import StudyQuantity
from trunnion.studies.refinement import ABOVE, ABSENT, BELOW, UNKNOWN, KnownSides, Lattice, Refinement, next_points
from trunnion.studies.store import Store

PIECES = 64
"""Blocks of a round, at least, where its points are calls: it is to be shared by many workers."""


def asked_of(store: Store) -> tuple[StudyDesign, Refinement | None, StudyDesign]:
    """What a store was asked for last: its points, the boundary that they look for, and its first grid."""
    last = store.parts[-1]
    if last.refinement is None:
        return last.design, None, last.design
    lattice = Lattice(_first(last.design, last.first), last.refinement.halvings)
    return known_points(store, lattice), last.refinement, lattice.first


def _first(design: StudyDesign, shape: tuple[int, ...]) -> StudyDesign:
    """The first grid of which a design has finer points."""
    axes = []
    for axis, points in zip(design.axes, shape[-len(design.axes) :], strict=True):
        if axis.grid is None or len(axis.values) == points:
            axes.append(axis)
            continue
        low, high, _, log = axis.grid
        axes.append(StudyAxis.of_grid(axis.path, axis.unit, axis.nominal, low, high, points, log))
    return StudyDesign(tuple(axes), design.sampling)


def known_points(store: Store, lattice: Lattice) -> StudyDesign:
    """All points of a store that stand in the finest grid of a lattice."""
    whole = lattice.design(lattice.depth)
    found = []
    for part in store.parts:
        for first in range(0, part.points, 1 << 18):
            numbers = part.numbers(first, min(first + (1 << 18), part.points))
            places = whole.places(part.design, numbers)
            found.append(places[places >= 0])
    return lattice.design(lattice.depth, np.unique(np.concatenate(found)))


def sides_of(refinement: Refinement, quantity: StudyQuantity, status: Any, values: Any) -> Any:
    """On which side of the boundary points are, by their status and what is kept of the quantity."""
    done = np.asarray(status) == DONE
    if quantity.kind == "word":
        above, known = quantity.shown(values) == refinement.value, done
    elif quantity.kind == "code":
        code = quantity.codes[quantity.meanings.index(refinement.value)]
        above, known = values == code, done & np.isfinite(values)
    else:
        above, known = values - refinement.level > refinement.noise, done & np.isfinite(values)
    sides = np.where(above, ABOVE, BELOW).astype(np.uint8)
    sides[~known] = UNKNOWN
    sides[np.asarray(status) == 0] = ABSENT
    return sides


@dataclass
class BoundarySearch:
    """A search for a boundary from a first grid, which remembers what it has read of a store."""

    refinement: Refinement
    first: StudyDesign
    read: set[int] = field(default_factory=set)
    known: KnownSides = field(default_factory=lambda: KnownSides(np.zeros(0, dtype=np.int64), np.zeros(0, np.uint8)))

    @cached_property
    def lattice(self) -> Lattice:
        """The grids that it may come to."""
        return Lattice(self.first, self.refinement.halvings)

    def next_round(self, store: Store) -> tuple[Store, str]:
        """The store with a part of the points that are asked for next, itself at the end; and why it ended before.

        All that the store was asked for so far is done.
        """
        for part in store.parts:
            if part.number not in self.read:
                self.read.add(part.number)
                self._learn(store, part)
        found, design = next_points(self.lattice, self.known)
        if design is None:
            return store, ""
        if len(self.known.numbers) + design.size > self.refinement.most:
            why = f"halving number {found.level + 1} of {self.refinement.halvings} needs {design.size} points more"
            return store, f"{why}, and {self.refinement.most} are the most"
        block = store.parts[0].block
        if not store.question.batched:
            block = min(block, max(1, design.size // PIECES))
        return store.extended(design, block, self.refinement, self.first.shape), ""

    def _learn(self, store: Store, part: StudyPart) -> None:
        quantity = next(one for one in store.question.quantities if one.path == self.refinement.quantity)
        whole = self.lattice.design(self.lattice.depth)
        numbers, sides = [self.known.numbers], [self.known.sides]
        for first, last, found in store.stretches(part):
            if found is None:
                continue
            places = whole.places(part.design, part.numbers(first, last))
            here = places >= 0
            numbers.append(places[here])
            sides.append(sides_of(self.refinement, quantity, found.status, found.values[quantity.path])[here])
        kept, order = np.unique(np.concatenate(numbers), return_index=True)
        self.known = KnownSides(kept, np.concatenate(sides)[order])
