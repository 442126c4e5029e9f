"""The linearised equations of a line as entries of its tree: memory that grows with its length, not its square.

Masses are diagonal, and stiffness and damping join a rotation to the one in front of it only, so that all the numbers
of an n × n matrix are n on the diagonal and one beside it in either direction for each rotation that has one in front.
Entries that joints and meshes do not touch are the same at every time.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Integers
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.linear import Place, put_entries
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
class TreeMatrices:
    """Matrices in time of ``linear.LineMatrices``, entry by entry.

    ``parent`` (n,) is the rotation in front of each, −1 without; forcing (case, time, n); ratio and wave (case, time,
    compliance) as of ``LineMatrices``.
    """

    parent: Integers
    mass: TreeEntries
    damping: TreeEntries
    stiffness: TreeEntries
    forcing: Array
    ratio: Array
    wave: Array


def parents(topo: Topology) -> Integers:
    """The rotation in front of each unknown (n,): −1 where there is none or it is prescribed."""
    found = np.full(topo.size, -1, dtype=np.int64)
    for far, near in topo.ends:
        if far >= 0:
            found[far] = near
    return found


def tree_matrices(topo: Topology, coefficients: LineCoefficients, tau: Array) -> TreeMatrices:
    """M, C, K and forcing in physical time at input angles ``tau`` [rad]."""
    parent, shape = parents(topo), (len(coefficients.speed), len(tau))
    mass, damping, stiffness = (TreeEntries(parent, *shape) for _ in range(3))
    forcing = np.zeros((topo.size, *shape)).transpose(1, 2, 0)
    ratio, wave = put_entries(topo, coefficients, tau, mass, damping, stiffness, forcing)
    return TreeMatrices(parent, mass, damping, stiffness, forcing, ratio, wave)
