"""Where points go that look for a boundary: into cells of a grid whose corners do not agree, halved again and again.

A cell whose corners lie on both sides is halved along every refined axis; so is one of which a finer point on its face
says that the boundary enters it. All other cells are left as they are. Which points come next follows from the answers
alone, so that whoever goes on with a study comes to the same ones.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np

from trunnion.arrays import Flags, Places
from trunnion.studies.design import StudyAxis, StudyDesign

BELOW, ABOVE, UNKNOWN, ABSENT = 0, 1, 2, 3
"""Sides of a point: not on the side that is asked for, on it, failed or without a value, not computed."""


@dataclass(frozen=True)
class Refinement:
    """What boundary is looked for: of a number where it rises over ``level`` by more than ``noise``, of a word or
    verdict where it is ``value``; ``halvings`` of the cells that it passes, and at the ``most`` so many points."""

    quantity: str
    halvings: int
    most: int
    level: float = 0.0
    noise: float = 0.0
    value: str = ""

    @property
    def content(self) -> dict[str, Any]:
        """As JSON keeps it."""
        return dict(vars(self))

    @classmethod
    def of_content(cls, content: Mapping[str, Any]) -> Refinement:
        """What ``content`` says."""
        return cls(**content)


@dataclass(frozen=True, eq=False)
class Lattice:
    """The points that a first grid could come to by ``depth`` halvings of every axis of its own two points or more."""

    first: StudyDesign
    depth: int

    @cached_property
    def refined(self) -> Flags:
        """Which of the axes of the shape are halved: grids, no stated values and no sampled rows."""
        axes = [axis.grid is not None and len(axis.values) > 1 for axis in self.first.axes]
        return np.array(([False] if self.first.sampling else []) + axes)

    def counts(self, level: int) -> Places:
        """Points along every axis after so many halvings."""
        first = np.array(self.first.shape, dtype=np.int64)
        return np.where(self.refined, (first - 1) * 2**level + 1, first)

    def design(self, level: int, chosen: Places | None = None) -> StudyDesign:
        """The grid after so many halvings, or the ``chosen`` of its points."""
        axes = tuple(_halved(axis, level) for axis in self.first.axes)
        return StudyDesign(axes, self.first.sampling, chosen)

    def numbers(self, places: Places, level: int) -> Places:
        """Numbers in the finest grid of places (…, axes) of the grid of a level."""
        step = np.where(self.refined, 2 ** (self.depth - level), 1)
        found: Places = (places * step) @ self._strides
        return found

    def places(self, numbers: Places, level: int) -> Places:
        """Places (points, axes) in the grid of a level of points that it has, by their numbers in the finest one."""
        step = np.where(self.refined, 2 ** (self.depth - level), 1)
        fine = np.stack(np.unravel_index(numbers, tuple(self.counts(self.depth))), axis=-1)
        return np.asarray(fine // step, dtype=np.int64)

    @cached_property
    def _strides(self) -> Places:
        counts = self.counts(self.depth)
        return np.append(np.cumprod(counts[:0:-1])[::-1], 1).astype(np.int64)

    @cached_property
    def corners(self) -> Places:
        """Of a cell, from its first one: (corners, axes)."""
        return np.array(list(product(*[(0, 1) if one else (0,) for one in self.refined])), dtype=np.int64)

    @cached_property
    def neighbours(self) -> Places:
        """Of a cell: (neighbours, axes)."""
        found = np.array(list(product(*[(-1, 0, 1) if one else (0,) for one in self.refined])), dtype=np.int64)
        return np.asarray(found[(found != 0).any(axis=1)])

    def cells(self, level: int) -> Places:
        """Cells along every axis after so many halvings."""
        return self.counts(level) - self.refined


def _halved(axis: StudyAxis, level: int) -> StudyAxis:
    if axis.grid is None or len(axis.values) < 2 or not level:
        return axis
    low, high, points, log = axis.grid
    return StudyAxis.of_grid(axis.path, axis.unit, axis.nominal, low, high, (points - 1) * 2**level + 1, log)


@dataclass(frozen=True, eq=False)
class KnownSides:
    """Points of the finest grid whose sides are known, by rising numbers."""

    numbers: Places
    sides: Any

    def at(self, numbers: Places) -> Any:
        """Sides of points, ``ABSENT`` where they are not computed."""
        if not len(self.numbers):
            return np.full(numbers.shape, ABSENT, dtype=np.uint8)
        place = np.minimum(np.searchsorted(self.numbers, numbers), len(self.numbers) - 1)
        return np.where(self.numbers[place] == numbers, self.sides[place], ABSENT)


@dataclass(frozen=True, eq=False)
class Descent:
    """How far a search has come.

    level : the last one of which all points are known, −1 before the first grid is.
    crossed : cells (cells, axes) of that level with both sides at their corners.
    leaves : of every level up to it, cells that stay whole: all their corners on one side, and how many of these on the
        one that is asked for; how many have corners of which nothing is known.
    counts : crossed cells of these levels.
    missing : points that are to be computed, by their numbers in the finest grid; none at the end.
    deepest : the level of the finest of these.
    """

    level: int
    crossed: Places
    leaves: tuple[tuple[int, int, int], ...]
    counts: tuple[int, ...]
    missing: Places
    deepest: int


def descent(lattice: Lattice, known: KnownSides) -> Descent:
    """Follow the boundary through the points that are known, as far as they go."""
    forced: list[Places] = [np.zeros(0, dtype=np.int64) for _ in range(lattice.depth + 1)]
    while True:
        found, entered = _descended(lattice, known, forced)
        if not entered:
            return found
        for level, cells in entered.items():
            for above in range(level):
                step = np.where(lattice.refined, 2 ** (level - above), 1)
                forced[above] = np.union1d(forced[above], _flat(cells // step, lattice.cells(above)))


def _descended(lattice: Lattice, known: KnownSides, forced: list[Places]) -> tuple[Descent, dict[int, Places]]:
    """The same with cells that are ``forced`` to be halved; and cells that the boundary enters, by level, though they
    are in none that was halved."""
    leaves: list[tuple[int, int, int]] = []
    counts: list[int] = []
    crossed = reached = np.zeros((0, len(lattice.refined)), dtype=np.int64)
    missing: list[Places] = []
    entered: dict[int, Places] = {}
    level_reached, deepest = -1, -1
    active = np.stack(np.unravel_index(np.arange(int(np.prod(lattice.cells(0)))), tuple(lattice.cells(0))), axis=-1)
    for level in range(lattice.depth + 1):
        below, above, unknown, absent = _looked_at(lattice, known, active, level)
        if len(absent):
            missing.append(absent)
            deepest = level
        across = below & above
        crossed = active[across]
        beside = _entered(lattice, known, crossed, _flat(active, lattice.cells(level)), level)
        if len(beside):
            entered[level] = beside
        whole = ~across
        if level < lattice.depth:
            whole &= ~np.isin(_flat(active, lattice.cells(level)), forced[level])
        if not missing:
            sure = whole & ~unknown
            leaves.append((int(sure.sum()), int((sure & above).sum()), int((whole & unknown).sum())))
            counts.append(len(crossed))
            level_reached, reached = level, crossed
        if level < lattice.depth:
            parents = active[~whole]
            twice = np.where(lattice.refined, 2, 1)
            active = (parents[:, None, :] * twice + lattice.corners[None, :, :]).reshape(-1, len(twice))
    whole_list = np.unique(np.concatenate(missing)) if missing else np.zeros(0, dtype=np.int64)
    return Descent(level_reached, reached, tuple(leaves), tuple(counts), whole_list, deepest), entered


def _looked_at(
    lattice: Lattice, known: KnownSides, cells: Places, level: int
) -> tuple[Flags, Flags, Flags, Places]:  # fmt: skip
    """Whether cells have corners below, above and of which nothing is known; points that are not computed."""
    below, above, unknown = (np.zeros(len(cells), dtype=bool) for _ in range(3))
    missing: list[Places] = []
    for corner in lattice.corners:
        numbers = lattice.numbers(cells + corner, level)
        side = known.at(numbers)
        below |= side == BELOW
        above |= side == ABOVE
        unknown |= side >= UNKNOWN
        missing.append(np.unique(numbers[side == ABSENT]))
    return below, above, unknown, np.unique(np.concatenate(missing))


def _entered(lattice: Lattice, known: KnownSides, crossed: Places, ids: Places, level: int) -> Places:
    """Cells beside crossed ones, none of the ``ids`` looked at, whose known corners lie on both sides."""
    if not level:
        return crossed[:0]
    cells = lattice.cells(level)
    found: list[Places] = []
    for step in lattice.neighbours:
        beside = crossed + step
        beside = beside[((beside >= 0) & (beside < cells)).all(axis=1)]
        found.append(_flat(beside, cells))
    new = np.setdiff1d(np.unique(np.concatenate(found)), ids)
    beside = np.stack(np.unravel_index(new, tuple(cells)), axis=-1)
    below, above, _, _ = _looked_at(lattice, known, beside, level)
    return np.asarray(beside[below & above])


def _flat(cells: Places, counts: Places) -> Places:
    return np.asarray(np.ravel_multi_index(tuple(cells.T), tuple(counts)), dtype=np.int64)


def next_points(lattice: Lattice, known: KnownSides) -> tuple[Descent, StudyDesign | None]:
    """How far a search has come, and the points that it asks for next."""
    found = descent(lattice, known)
    if not len(found.missing):
        return found, None
    level = found.deepest
    places = lattice.places(found.missing, level)
    return found, lattice.design(level, np.sort(_flat(places, lattice.counts(level))))
