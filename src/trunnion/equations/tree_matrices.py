"""The linearised equations of a line as entries of its tree: memory that grows with its length, not its square.

Masses are diagonal, and stiffness and damping join a rotation to the one in front of it only, so that all the numbers
of an n × n matrix are n on the diagonal and one beside it in either direction for each rotation that has one in front.
Entries that joints and meshes do not touch are the same at every time. Of a line with loops and differentials a tree
is taken as well, and what it leaves of the matrices is kept ``beside`` it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Integers
from trunnion.equations.aligned import loaded_matrices
from trunnion.equations.given_rotation import GivenRotation
from trunnion.equations.graph_entries import EntryProducts
from trunnion.equations.graph_matrices import ends_of, graph_matrices
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.linear import Place, put_entries, stiffness_waves, varies
from trunnion.equations.topology import Topology


class TreeEntries:
    """Entries of matrices (case, time) whose pattern is a tree: ``own`` (n, case, time) on the diagonal, ``down``
    [i, parent] and ``up`` [parent, i] beside it."""

    def __init__(self, parent: Integers, cases: int, times: int) -> None:
        self.parent = parent
        self.own, self.down, self.up = (np.zeros((len(parent), cases, times)) for _ in range(3))

    def _of(self, row: Place, column: Place) -> tuple[Array, Place]:
        """The array that holds such entries, and by which of the two they lie in it."""
        if np.array_equal(row, column):
            return self.own, row
        return (self.down, row) if np.array_equal(self.parent[row], column) else (self.up, column)

    def __getitem__(self, place: tuple[Place, Place]) -> Array:
        every, at = self._of(*place)
        return np.asarray(every[at])

    def __setitem__(self, place: tuple[Place, Place], values: Array) -> None:
        every, at = self._of(*place)
        every[at] = values


@dataclass(frozen=True)
class EntryBeside:
    """An entry that is none of the tree's: its ``row`` and ``column``, and its ``parts`` K, C and M (case, time)."""

    row: int
    column: int
    parts: tuple[Array, Array, Array]


@dataclass(frozen=True)
class TreeMatrices:
    """Matrices in time of ``linear.LineMatrices``, entry by entry.

    ``parent`` (n,) is the rotation in front of each, −1 without; forcing (case, time, n); ratio and wave (case, time,
    compliance) as of ``LineMatrices``; ``beside`` the tree what closes loops. Of such a line without forcing.
    """

    parent: Integers
    mass: TreeEntries
    damping: TreeEntries
    stiffness: TreeEntries
    forcing: Array
    ratio: Array
    wave: Array
    beside: tuple[EntryBeside, ...] = ()

    @property
    def three(self) -> tuple[TreeEntries, TreeEntries, TreeEntries]:
        """K, C and M."""
        return self.stiffness, self.damping, self.mass


def parents(topo: Topology) -> Integers:
    """The rotation in front of each unknown (n,): −1 where there is none or it is prescribed."""
    found = np.full(topo.size, -1, dtype=np.int64)
    for far, near in topo.ends:
        if far >= 0:
            found[far] = near
    return found


def tree_matrices(
    topo: Topology, coefficients: LineCoefficients, tau: Array, given: GivenRotation | None = None
) -> TreeMatrices:
    """M, C, K and forcing in physical time at input angles ``tau`` [rad]; of a tree about a motion that is ``given``,
    by default that of rigid shafts."""
    if topo.graph:
        return _of_graph(topo, coefficients, tau)
    parent, shape = parents(topo), (len(coefficients.speed), len(tau))
    mass, damping, stiffness = (TreeEntries(parent, *shape) for _ in range(3))
    forcing = np.zeros((topo.size, *shape)).transpose(1, 2, 0)
    ratio, wave = put_entries(topo, coefficients, tau, mass, damping, stiffness, forcing, given)
    return TreeMatrices(parent, mass, damping, stiffness, forcing, ratio, wave)


def _of_graph(topo: Topology, co: LineCoefficients, tau: Array) -> TreeMatrices:
    """Each unknown hangs on the last of those before it that it is joined to."""
    shape, wave = (len(co.speed), len(tau)), stiffness_waves(topo, co, tau)
    if varies(co):
        products = EntryProducts(topo, list(zip(*ends_of(topo), strict=True)), [(one.on, one.by) for one in co.across])
        found = graph_matrices(topo, co, tau, wave, products)
        rows, columns, three = products.rows, products.places, (found.stiffness, found.damping, found.mass)
    else:
        same = loaded_matrices(topo, co, co.speed)
        whole = [np.broadcast_to(part[:, None], (*shape, topo.size, topo.size))
                 for part in (same.stiffness, same.damping, same.inertia)]  # fmt: skip
        joined = np.any([part[:, 0].any(axis=0) for part in whole], axis=0)
        rows, columns = np.nonzero(joined | joined.T | np.eye(topo.size, dtype=bool))
        k, c, m = (np.asarray(part[..., rows, columns]) for part in whole)
        three = k, c, m
    parent = np.full(topo.size, -1, dtype=np.int64)
    np.maximum.at(parent, rows, np.where(columns < rows, columns, -1))
    stiffness, damping, mass = (TreeEntries(parent, *shape) for _ in range(3))
    beside = list[EntryBeside]()
    for entry, (i, j) in enumerate(zip(rows.tolist(), columns.tolist(), strict=True)):
        values = [part[..., entry] for part in three]
        if i == j or j == parent[i] or i == parent[j]:
            for matrix, one in zip((stiffness, damping, mass), values, strict=True):
                matrix[i, j] = one
        else:
            beside.append(EntryBeside(i, j, (values[0], values[1], values[2])))
    nothing = np.zeros((*shape, topo.size))
    return TreeMatrices(parent, mass, damping, stiffness, nothing, np.ones_like(wave), wave, tuple(beside))
