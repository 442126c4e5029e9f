"""Charts of long lines: whole monodromy matrices on grids whose degree each direction chooses for itself.

Every entry of Z is an entire function of 1/Ω, of which the highest mode's phase over a period is the fastest wave: a
grid that resolves that wave leaves nothing between its nodes, however narrow a tongue is. Angles, stiffness and the
like need few nodes. A line of nodes along either direction tells the degrees, and the whole grid is sampled once.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.fft import dct

from trunnion.arrays import Array
from trunnion.numerics.patches.nested import ChebyshevSeries, Grid, chebyshev_places
from trunnion.numerics.patches.patches import Box, Patch, PatchedFunction

Sample = Callable[[Array, Array], tuple[Array, Array, Array]]
"""Nodes (u, v) → monodromy matrices (node, m, m), their errors (node,) and ∫ tr(M⁻¹C) dτ (node,)."""
DEEPEST = 4
"""Halvings of a box whose degrees would be too high."""
FIRST_DEGREE, HIGHEST_DEGREE = 6, 192
SHARPER, RESERVE = 0.5, 3
"""Share of the tolerance that one line of nodes is asked for, and degrees beyond those that it asks for: other lines
may ask for more."""
TOGETHER = 128
"""Nodes that are sampled at once: few enough that progress is seen."""
BLOCK = 2000
"""Entries that are turned into coefficients at once."""


def matrix_patches(
    sample: Sample,
    box: Box,
    states: int,
    tolerance: float,
    most_nodes: float,
    most_bytes: float,
    report_progress: Callable[[float], None],
) -> PatchedFunction | None:
    """Patches over ``box`` of the entries of Z, ``states`` squared, and of ∫ tr(M⁻¹C) dτ; the Frobenius norm of what
    a series leaves out lies below ``tolerance`` of the largest entry (1 at least).

    None where that takes more than ``most_nodes`` matrices, or more than ``most_bytes`` to keep.
    """
    todo, patches, nodes, kept, whole = [(box, 0)], list[Patch](), 0.0, 0.0, 0.0
    while todo:
        part, depth = todo.pop()
        share, patch = 0.5**depth, None
        grid, spent, split_u = _grid(sample, part, tolerance, most_nodes - nodes)
        nodes += spent
        if grid is not None:
            count = grid.shape[0] * grid.shape[1]
            nodes, kept = nodes + count, kept + 8.0 * count * states**2
            if nodes > most_nodes or kept > most_bytes:
                return None

            def tell(done: float, before: float = whole, part_of: float = share) -> None:
                report_progress(before + part_of * done)

            patch, split_u = _patch(sample, grid, tolerance, tell)
        if patch is not None:
            patches.append(patch)
            whole += share
        elif depth == DEEPEST or nodes > most_nodes:
            return None
        else:
            todo += [(half, depth + 1) for half in part.halves(split_u, not split_u)]
    return PatchedFunction(tuple(patches), (), int(nodes))


def _grid(sample: Sample, box: Box, tolerance: float, most_nodes: float) -> tuple[Grid | None, float, bool]:
    """The grid that a line of nodes along either direction asks for, None where its degrees are too high; the nodes
    spent, infinitely many where the grid would take more than ``most_nodes``; whether to halve u for lower degrees."""
    up = _NodeLine(sample, box, False, SHARPER * tolerance, HIGHEST_DEGREE)
    if up.degree is None:
        return None, up.nodes, False
    affordable = (most_nodes - up.nodes) / (up.degree + 1)
    across = _NodeLine(sample, box, True, SHARPER * tolerance, min(HIGHEST_DEGREE, affordable))
    spent = up.nodes + across.nodes
    if across.degree is None:
        return None, spent if affordable >= HIGHEST_DEGREE else np.inf, True
    return Grid(box, across.degree, up.degree), spent, True


class _NodeLine:
    """Nodes along one direction of a box, where the other is largest: the slowest, the steepest; ``degree``: what that
    direction needs, None where more than ``highest``."""

    def __init__(self, sample: Sample, box: Box, along_u: bool, tolerance: float, highest: float) -> None:
        low, high = (box.u0, box.u1) if along_u else (box.v0, box.v1)
        degree, values, self.nodes = FIRST_DEGREE // 2, np.empty((0, 0)), 0
        self.degree: int | None = None
        while self.degree is None and 2 * degree <= highest:
            degree *= 2
            places = chebyshev_places(low, high, degree)
            fresh = np.ones(degree + 1, dtype=bool)
            fresh[:: 2 if len(values) else degree + 2] = not len(values)
            at = places[fresh]
            other = np.full(len(at), box.v1 if along_u else box.u1)
            found, error, _ = sample(*((at, other) if along_u else (other, at)))
            self.nodes += len(at)
            wider = np.empty((degree + 1, found[0].size))
            wider[fresh] = found.reshape(len(at), -1)
            if len(values):
                wider[::2] = values
            values = wider
            size = np.linalg.norm(dct(values, type=1, axis=0), axis=1) / degree
            left_out = np.cumsum(size[::-1])[::-1]
            allowed = max(tolerance * max(1.0, np.abs(values).max()), float(error.max()))
            needed = int(np.count_nonzero(~(left_out <= allowed)))
            if needed < degree - 1:
                self.degree = min(needed + RESERVE, degree)


def _patch(
    sample: Sample, grid: Grid, tolerance: float, report_progress: Callable[[float], None]
) -> tuple[Patch | None, bool]:
    """The patch of a grid, None where its tails are too large; whether u is what needs more."""
    u, v = grid.nodes()
    values, error, trace = list[Array](), 0.0, list[Array]()
    for begin in range(0, len(u), TOGETHER):
        some = slice(begin, begin + TOGETHER)
        found, off, damping = sample(u[some], v[some])
        values.append(found.reshape(len(found), -1))
        trace.append(damping)
        error = max(error, float(off.max()) if np.isfinite(off).all() else np.inf)
        report_progress(min(1.0, (begin + TOGETHER) / len(u)))
    every = np.concatenate(values)
    values.clear()
    blocks = [slice(b, b + BLOCK) for b in range(0, every.shape[1], BLOCK)]
    series = [ChebyshevSeries.of(grid, every[:, b]) for b in blocks]
    damped = ChebyshevSeries.of(grid, np.concatenate(trace)[:, None])
    allowed = max(tolerance * max(1.0, float(np.abs(every).max())), error)
    tail_u, tail_v = (
        float(np.linalg.norm(np.concatenate(t))) for t in zip(*((s.tail_u, s.tail_v) for s in series), strict=True)
    )
    if not max(tail_u, tail_v) <= allowed:
        return None, tail_u > tail_v
    # Spread so that the Frobenius norm of the entries' bounds is the bound of the matrix.
    each = np.full(every.shape[1], error / np.sqrt(every.shape[1]))
    whole = ChebyshevSeries(
        np.concatenate([*(s.coefficients for s in series), damped.coefficients]),
        *(np.concatenate([getattr(s, key) for s in [*series, damped]]) for key in ("tail_u", "tail_v")),
    )
    return whole.patch(grid.box, np.append(each, 1e-12 * np.abs(damped.coefficients).max())), True
