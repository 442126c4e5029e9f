"""A function of two variables from few samples: Chebyshev grids whose degree grows in each direction by itself.

Nodes are those of the second kind, cos(πj/n), so a grid with twice the degree keeps every sample. A direction is
refined while its last coefficients are not small.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.fft import dct

from trunnion.arrays import Array, Flags
from trunnion.numerics.patches.patches import BLOCKS, Box, Patch

FIRST_DEGREES = (8, 4)
"""Of u and v."""
HIGHEST_DEGREE = 128
LAST = 2
"""Trailing coefficients that must be small: two, as every other may vanish by symmetry."""


@dataclass(frozen=True)
class Grid:
    """Degrees of u and v; nodes from +1 to −1 of the box's sides."""

    box: Box
    along_u: int
    along_v: int

    @property
    def shape(self) -> tuple[int, int]:
        """(rows, columns) = (nodes of v, nodes of u)."""
        return self.along_v + 1, self.along_u + 1

    def nodes(self) -> tuple[Array, Array]:
        """u and v of every node, rows slow."""
        b = self.box
        u, v = chebyshev_places(b.u0, b.u1, self.along_u), chebyshev_places(b.v0, b.v1, self.along_v)
        return np.tile(u, len(v)), np.repeat(v, len(u))

    def refined(self, of_u: bool, of_v: bool) -> tuple[Grid, Flags]:
        """A grid of twice the degree, and which of its nodes (all, rows slow) stood in this one."""
        finer = Grid(self.box, self.along_u * (1 + of_u), self.along_v * (1 + of_v))
        known = np.zeros(finer.shape, dtype=bool)
        known[:: 1 + of_v, :: 1 + of_u] = True
        return finer, known.ravel()


def chebyshev_places(low: float, high: float, degree: int) -> Array:
    """The nodes of one direction, from ``high`` to ``low``."""
    return np.asarray((low + high) / 2 + (high - low) / 2 * np.cos(np.pi * np.arange(degree + 1) / degree))


@dataclass(frozen=True)
class ChebyshevSeries:
    """coefficients (quantity, i, j) of T_i(v) T_j(u); tail_u, tail_v (quantity,): sums of the last ones."""

    coefficients: Array
    tail_u: Array
    tail_v: Array

    @classmethod
    def of(cls, grid: Grid, values: Array) -> ChebyshevSeries:
        """``values`` (node, quantity)."""
        samples = values.T.reshape(-1, *grid.shape)
        c = dct(dct(samples, type=1, axis=1), type=1, axis=2) / (grid.along_u * grid.along_v)
        for axis in (1, 2):
            ends = np.moveaxis(c, axis, 0)
            ends[0] /= 2
            ends[-1] /= 2
        size = np.abs(c)
        return cls(c, size[:, :, -LAST:].sum(axis=(1, 2)), size[:, -LAST:, :].sum(axis=(1, 2)))

    def patch(self, box: Box, error: Array) -> Patch:
        """As a patch whose samples are known to ``error`` (quantity,).

        Interpolation may enlarge errors of single nodes by the logarithm of their number in each direction.
        """
        enlarged = np.prod([1 + 2 / np.pi * np.log(k) for k in self.coefficients.shape[1:]])
        bound = enlarged * error + 2 * (self.tail_u + self.tail_v)
        spread = np.broadcast_to(bound[:, None, None], (len(bound), BLOCKS, BLOCKS)).copy()
        return Patch(box, np.ascontiguousarray(self.coefficients), spread)
