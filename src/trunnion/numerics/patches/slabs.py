"""Propagators over short slabs of the period, interpolated over parameters and multiplied together.

Over a whole period at low speed the propagator oscillates through dozens of radians as parameters vary, and
needs many nodes; over a slab of a few radians it needs few. So slabs are patched first, at nodes that cost a
fraction of a period each, and the nodes of the chart's own patches become products of slabs.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.numerics.batch import BATCH
from trunnion.numerics.jit import njit
from trunnion.numerics.patches.patches import Box, Grid, PatchedFunction, build, grid_by_grid
from trunnion.numerics.rows import load, spread, store

Propagate = Callable[[Array, Array, float, float], tuple[Array, Array, Array]]
"""(u, v, begin, length) → propagators (points, m, m), errors (points,), ∫tr(M⁻¹C)dτ (points,)."""

RADIANS = 28.0
"""Phase of the fastest mode across a slab: then a few dozen nodes resolve it over any range of speed."""


SLAB_NODES = 40
"""Nodes per variable: half of RADIANS and what a smooth function needs besides."""


@dataclass(frozen=True)
class Slabs:
    """Patched slabs in order; their quantities are the m² entries and ∫tr(M⁻¹C)dτ."""

    functions: tuple[PatchedFunction, ...]
    size: int

    def propagators(self, grid: Grid) -> tuple[Array, Array, Array]:
        """Propagator over all slabs on a grid of a multiple of ``BATCH`` points, its error and trace; shapes
        (rows · columns, …), rows slow."""
        m, count = self.size, len(grid[0]) * len(grid[1])
        phi = np.zeros((count // BATCH, m * m, BATCH))
        phi[:, :: m + 1] = 1.0
        largest, error, trace = np.ones(count), np.zeros(count), np.zeros(count)
        room = np.empty(2 * m * m * BATCH + BATCH)
        for function in self.functions:
            values, bounds = _on_grid(function, grid, m * m + 1)
            _multiply(values, bounds, m, phi, largest, error, trace, room)
        return phi.transpose(0, 2, 1).reshape(count, m, m), error * largest**2, trace


def slab_edges(frequency: float, tau: Array, weight: Array) -> Array:
    """Edges of slabs of about ``RADIANS`` each of the highest mode, ``frequency`` (per unit τ) times ``weight``.

    ``weight`` (time,) over ``tau`` (time,) tells how much faster than the input the fastest part turns: near the
    peak of a steep joint a shaft passes through many radians in little input angle.
    """
    steps = np.diff(tau) * (weight[1:] + weight[:-1]) / 2
    passed = np.concatenate([[0.0], np.cumsum(steps)]) * frequency
    count = max(1, int(np.ceil(passed[-1] / RADIANS)))
    return np.interp(np.linspace(0.0, passed[-1], count + 1), passed, tau)


def build_slabs(propagate: Propagate, box: Box, edges: Array, size: int, tolerance: float) -> Slabs | None:
    """Patch the slabs between ``edges`` over ``box``, together to ``tolerance``; None if one resists."""
    nowhere = np.zeros(0)
    functions = list[PatchedFunction]()
    count = len(edges) - 1
    for at, end in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):

        def sampled(u: Array, v: Array, at: float = at, end: float = end) -> tuple[Array, Array]:
            phi, error, trace = propagate(u, v, at, end - at)
            values = np.concatenate([phi.reshape(len(phi), -1), trace[:, None]], axis=1)
            return values, np.repeat(error[:, None] / size, values.shape[1], axis=1)

        # What had to be divided for one slab has to be for its neighbour.
        boxes = [patch.box for patch in functions[-1].patches] if functions else [box]
        functions.append(
            build(grid_by_grid(sampled), boxes, nowhere, nowhere, tolerance / count, nodes=SLAB_NODES, direct_below=-1)
        )
        if functions[-1].unconverged:
            return None
    return Slabs(tuple(functions), size)


def _on_grid(function: PatchedFunction, grid: Grid, quantities: int) -> tuple[Array, Array]:
    """Values (quantity, point) and Frobenius error bounds (point,) from the patches, rows slow."""
    u, v = grid
    values = np.full((quantities, len(v), len(u)), np.nan)
    bounds = np.full((len(v), len(u)), np.nan)
    for patch, rows, columns in function.parts(u, v):
        values[:, rows, columns] = patch.grid(u[columns], v[rows])
        of_u, of_v = patch.blocks(u[columns], v[rows])
        bounds[rows, columns] = np.sqrt(np.sum(patch.error[:-1] ** 2, axis=0))[of_v[:, None], of_u]
    return values.reshape(quantities, -1), bounds.ravel()


@njit(nogil=True, fastmath=True)
def _multiply(values, bounds, m, phi, largest, error, trace, room):  # type: ignore[no-untyped-def]
    """phi (block, m², lane) times the slab's, ``values`` (m² + 1, point) with its trace; room (2m² + 1) lanes."""
    size, every, zero = m * m * BATCH, values.shape[1], spread(0.0)  # type: ignore[call-arg, var-annotated]
    flat, left, product, squares = values.reshape(-1), room[:size], room[size : 2 * size], room[2 * size :]
    for block in range(len(phi)):
        right, at = phi[block].reshape(-1), block * BATCH
        for entry in range(m * m):
            store(left, entry * BATCH, load(flat, entry * every + at, zero))
        square = zero
        for i in range(0, size, m * BATCH):
            for j in range(0, m * BATCH, BATCH):
                total = zero
                for k in range(m):
                    total = total + load(left, i + k * BATCH, zero) * load(right, k * m * BATCH + j, zero)
                store(product, i + j, total)
                square = square + total * total
        for entry in range(0, size, BATCH):  # setting slices to each other takes two seconds to compile
            store(right, entry, load(product, entry, zero))
        store(squares, 0, square)
        for lane in range(BATCH):
            p = at + lane
            largest[p] = max(largest[p], np.sqrt(squares[lane] / m))
            error[p] += bounds[p]
            trace[p] += values[m * m, p]
