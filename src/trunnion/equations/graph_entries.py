"""Which entries the matrices of a line with loops and differentials have: few, however long it is.

A station turns with one unknown, behind a differential with those of its legs, and a spring twists with those of both
its ends. Unknowns that no spring and no station shares may stand in one column, so that the rotations of all stations
are a narrow array; a sum of products of its rows is kept entry by entry.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Protocol

import numpy as np
from scipy import sparse

from trunnion.arrays import Array, Integers, Places
from trunnion.equations.topology import LinkKind, Topology


class Products(Protocol):
    """What becomes of Σ_r w_r left_rᵀ right_r; ``columns`` (n,) says where each unknown stands in left and right."""

    columns: Places

    def of_stations(self, left: Array, weight: Array, right: Array) -> Array:
        """Rows are stations."""
        ...

    def of_springs(self, left: Array, weight: Array, right: Array) -> Array:
        """Rows are compliances."""
        ...

    def of_pair(self, on: int, left: Array, by: int, right: Array) -> Array:
        """One row of the station ``on`` times one of the station ``by``."""
        ...


class WholeProducts:
    """As matrices (case, time, n, n)."""

    def __init__(self, size: int) -> None:
        self.columns = np.arange(size)

    def of_stations(self, left: Array, weight: Array, right: Array) -> Array:
        """Products with weights (case, time, row)."""
        return np.asarray((left * weight[..., None]).swapaxes(-1, -2) @ right)

    of_springs = of_stations

    def of_pair(self, on: int, left: Array, by: int, right: Array) -> Array:
        """Of rows (case, time, n)."""
        return np.asarray(left[..., :, None] * right[..., None, :])


class EntryProducts:
    """As entries (case, time, entry) at ``rows`` and ``places`` (entry,)."""

    def __init__(self, topo: Topology, ends: Sequence[tuple[int, int]], pairs: Iterable[tuple[int, int]]) -> None:
        """``ends`` : far and near station of every compliance; ``pairs`` of stations of which the torque on one goes
        with the speed of the other."""
        self._stations = _turned_by(topo)
        springs = [tuple(sorted({*self._stations[far], *self._stations[near]})) for far, near in ends]
        every = {(i, j) for group in (*self._stations, *springs) for i in group for j in group}
        every |= {(i, j) for on, by in pairs for i in self._stations[on] for j in self._stations[by]}
        every |= {(j, i) for i, j in every} | {(i, i) for i in range(topo.size)}
        self._number = {place: k for k, place in enumerate(sorted(every))}
        self.rows, self.places = np.array(sorted(every), dtype=np.int64).reshape(-1, 2).T
        self.columns = _columns(topo.size, [*self._stations, *springs])
        self._of_stations, self._of_springs = (self._terms(groups) for groups in (self._stations, springs))

    def _terms(self, groups: Sequence[tuple[int, ...]]) -> tuple[Integers, sparse.csr_array]:
        """Row and both columns (3, term) of every product of two numbers of one row, and the entry it adds to."""
        terms = [(r, i, j) for r, group in enumerate(groups) for i in group for j in group]
        entry = [self._number[i, j] for _, i, j in terms]
        row, i, j = np.array(terms, dtype=np.int64).reshape(-1, 3).T
        ones = np.ones(len(terms))
        return np.stack([row, self.columns[i], self.columns[j]]), sparse.csr_array(
            (ones, (entry, np.arange(len(terms)))), shape=(len(self.rows), len(terms))
        )

    def of_stations(self, left: Array, weight: Array, right: Array) -> Array:
        """Products of rows (case, time, row, column) with weights (case, time, row)."""
        return self._summed(self._of_stations, left, weight, right)

    def of_springs(self, left: Array, weight: Array, right: Array) -> Array:
        """Products of rows (case, time, row, column) with weights (case, time, row)."""
        return self._summed(self._of_springs, left, weight, right)

    def _summed(self, terms: tuple[Integers, sparse.csr_array], left: Array, weight: Array, right: Array) -> Array:
        (row, i, j), to_entries = terms
        each = left[..., row, i] * weight[..., row] * right[..., row, j]
        return np.asarray((to_entries @ each.reshape(-1, len(row)).T).T.reshape(*each.shape[:-1], len(self.rows)))

    def of_pair(self, on: int, left: Array, by: int, right: Array) -> Array:
        """Of rows (case, time, column)."""
        found = np.zeros((*np.broadcast_shapes(left.shape[:-1], right.shape[:-1]), len(self.rows)))
        for i in self._stations[on]:
            for j in self._stations[by]:
                found[..., self._number[i, j]] += left[..., self.columns[i]] * right[..., self.columns[j]]
        return found


def _turned_by(topo: Topology) -> list[tuple[int, ...]]:
    """The unknowns that turn each station."""
    found = list[tuple[int, ...]]()
    for station in topo.stations:
        place = topo.coordinate[station.group]
        if station.link is LinkKind.SUM:
            found.append(tuple(sorted({i for one, _ in station.of for i in found[one]})))
        elif station.link in (LinkKind.JOINT, LinkKind.RATIO):
            found.append(found[station.before])
        else:
            found.append((place,) if place >= 0 else ())
    return found


def _columns(size: int, groups: Iterable[tuple[int, ...]]) -> Places:
    """A column for each unknown (n,), different ones for the unknowns of any one group."""
    beside: list[set[int]] = [set() for _ in range(size)]
    for group in groups:
        for i in group:
            beside[i].update(group)
    found = np.full(size, -1, dtype=np.intp)
    for i in range(size):
        taken = {int(found[j]) for j in beside[i]}
        found[i] = next(k for k in range(size) if k not in taken)
    return found
