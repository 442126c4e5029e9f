"""Propagators over short slabs of the period, interpolated over parameters and multiplied together.

Over a whole period at low speed the propagator oscillates through dozens of radians as parameters vary, and
needs many nodes; over a slab of a few radians it needs few. So slabs are patched first, at nodes that cost a
fraction of a period each, and the nodes of the chart's own patches become products of slabs.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from trunnion.numerics.jit import njit
from trunnion.numerics.patches.patches import Box, Grid, PatchedFunction, build
from trunnion.numerics.threads import on_threads

Array = NDArray[np.float64]
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
        """Propagator over all slabs on a grid, its error and trace; shapes (rows · columns, …), rows slow."""
        m, count = self.size, len(grid[0]) * len(grid[1])
        phi = np.broadcast_to(np.eye(m), (count, m, m)).copy()
        largest, error, trace = np.ones(count), np.zeros(count), np.zeros(count)
        for function in self.functions:
            values, bounds = _on_grid(function, grid, m * m + 1)
            _multiply(values, bounds, phi, largest, error, trace)
        return phi, error * largest**2, trace


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
    functions = []
    count = len(edges) - 1
    for at, end in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):

        def evaluate(grids: list[Grid], at: float = at, end: float = end) -> list[tuple[Array, Array]]:
            shapes = [(len(gu), len(gv)) for gu, gv in grids]
            us = np.concatenate([np.tile(gu, len(gv)) for gu, gv in grids])
            vs = np.concatenate([np.repeat(gv, len(gu)) for gu, gv in grids])
            phi, error, trace = propagate(us, vs, at, end - at)
            values = np.concatenate([phi.reshape(len(phi), -1), trace[:, None]], axis=1)
            bounds = np.repeat(error[:, None] / size, values.shape[1], axis=1)
            cuts = np.cumsum([a * b for a, b in shapes])[:-1]
            return list(zip(np.split(values, cuts), np.split(bounds, cuts), strict=True))

        functions.append(build(evaluate, [box], nowhere, nowhere, tolerance / count, nodes=SLAB_NODES, direct_below=-1))
        if functions[-1].stubborn:
            return None
    return Slabs(tuple(functions), size)


def on_grids(slabs: Slabs, grids: list[Grid], threads: int) -> list[tuple[Array, Array, Array]]:
    """``Slabs.propagators`` of several grids in parallel."""
    return on_threads(slabs.propagators, grids, threads)


def _on_grid(function: PatchedFunction, grid: Grid, quantities: int) -> tuple[Array, Array]:
    """Values (quantity, rows · columns) and Frobenius error bounds (rows · columns,) from the patches."""
    u, v = grid
    values = np.full((quantities, len(v), len(u)), np.nan)
    bounds = np.full((len(v), len(u)), np.nan)
    for patch in function.patches:
        rows = np.flatnonzero((v >= patch.box.v0) & (v <= patch.box.v1))
        columns = np.flatnonzero((u >= patch.box.u0) & (u <= patch.box.u1))
        if len(rows) and len(columns):
            values[:, rows[:, None], columns] = patch.grid(u[columns], v[rows])
            entries = patch.error_grid(u[columns], v[rows])[:-1]
            bounds[np.ix_(rows, columns)] = np.sqrt(np.sum(entries**2, axis=0))
    return values.reshape(quantities, -1), bounds.ravel()


@njit(cache=True, nogil=True, fastmath=True)
def _multiply(values, bounds, phi, largest, error, trace):  # type: ignore[no-untyped-def]
    m = phi.shape[1]
    spare = np.empty((m, m))
    for p in range(phi.shape[0]):
        square = 0.0
        for i in range(m):
            for j in range(m):
                spare[i, j] = 0.0
            for k in range(m):
                a = values[i * m + k, p]
                for j in range(m):
                    spare[i, j] += a * phi[p, k, j]
        for i in range(m):
            for j in range(m):
                phi[p, i, j] = spare[i, j]
                square += spare[i, j] * spare[i, j]
        largest[p] = max(largest[p], np.sqrt(square / m))
        error[p] += bounds[p]
        trace[p] += values[m * m, p]
