"""A function of two variables as adaptive Chebyshev patches, known to a stated error everywhere.

The quantities interpolated are analytic (characteristic coefficients or entries of the monodromy matrix,
never multipliers). A rectangle is sampled at Chebyshev nodes of the first kind; where the last coefficients
are not small it is halved along the offending variable. A rectangle with fewer pixels than nodes is left to
direct evaluation.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np
from scipy.fft import dct

from trunnion.arrays import Array, Places
from trunnion.numerics.patches.chebyshev_rows import weighted_sums

Grid = tuple[Array, Array]
Evaluate = Callable[[list[Grid]], list[tuple[Array, Array]]]
"""Grids (u (columns,), v (rows,)) → values and error bounds on each, (rows · columns, quantities), rows slow."""

NODES = 48
"""Nodes per variable: enough for two dozen oscillations, and a multiple of the kernel's lanes."""
BLOCKS = 8
"""Blocks per variable in which the errors of samples are kept; divides every number of nodes used."""
TAIL = 4
"""Trailing coefficients that must be small."""
NEARLY = 0.3
"""Of an allowed tail, what one row may show of that of a patch."""
DEEPEST = 14
"""Halvings after which a patch counts as not converging."""


MOST_EVALUATIONS = 1_500_000
"""Samples after which what has not converged is left to direct evaluation."""


@dataclass(frozen=True)
class Box:
    """Rectangle u₀ ≤ u ≤ u₁, v₀ ≤ v ≤ v₁ in the patch variables."""

    u0: float
    u1: float
    v0: float
    v1: float

    @classmethod
    def around(cls, u: Array, v: Array) -> Box:
        """The rectangle that values of u and v span."""
        return cls(float(u.min()), float(u.max()), float(v.min()), float(v.max()))

    def halves(self, along_u: bool, along_v: bool) -> Iterator[Box]:
        """The two or four parts, or the whole."""
        um, vm = (self.u0 + self.u1) / 2, (self.v0 + self.v1) / 2
        for ua, ub in ((self.u0, um), (um, self.u1)) if along_u else ((self.u0, self.u1),):
            for va, vb in ((self.v0, vm), (vm, self.v1)) if along_v else ((self.v0, self.v1),):
                yield Box(ua, ub, va, vb)

    def contains(self, u: float, v: float) -> bool:
        """Whether the point lies in the rectangle, edges included (and rounding forgiven)."""
        du, dv = 1e-12 * (abs(self.u0) + abs(self.u1)), 1e-12 * (abs(self.v0) + abs(self.v1))
        return self.u0 - du <= u <= self.u1 + du and self.v0 - dv <= v <= self.v1 + dv


@dataclass(frozen=True)
class Patch:
    """coefficients (quantity, i, j) of T_i(v) T_j(u); error (quantity, BLOCKS, BLOCKS) in blocks of nodes.

    Samples are known better in some parts of a patch than in others, so their errors are kept by block; the
    interpolation error is in all of them.
    """

    box: Box
    coefficients: Array
    error: Array

    def grid(self, u: Array, v: Array) -> Array:
        """Values on the grid of ``u`` and ``v`` inside the box; shape (quantity, v, u)."""
        return self.rows(self.columns(u), v)

    def columns(self, u: Array) -> Array:
        """Coefficients of T_i(v) along each column ``u``; shape (quantity, i, u)."""
        across = _chebyshev(_to_unit(u, self.box.u0, self.box.u1), self.coefficients.shape[2])
        out = np.empty((1, self.coefficients.shape[0] * self.coefficients.shape[1], len(u)))
        weighted_sums(self.coefficients.reshape(out.shape[1], -1), across[None], out)
        return out.reshape(*self.coefficients.shape[:2], len(u))

    def weights(self, v: Array) -> Array:
        """T_i(v) of rows ``v``; shape (v, i)."""
        up = _chebyshev(_to_unit(v, self.box.v0, self.box.v1), self.coefficients.shape[1])
        return np.ascontiguousarray(up.T)

    def rows(self, columns: Array, v: Array) -> Array:
        """Values on rows ``v`` of ``columns``; shape (quantity, v, u)."""
        out = np.empty((len(columns), len(v), columns.shape[2]))
        weighted_sums(self.weights(v), columns, out)
        return out

    def blocks(self, u: Array, v: Array) -> tuple[Places, Places]:
        """The blocks of errors that columns ``u`` and rows ``v`` fall into."""
        return _block(_to_unit(u, self.box.u0, self.box.u1)), _block(_to_unit(v, self.box.v0, self.box.v1))

    def error_grid(self, u: Array, v: Array) -> Array:
        """Error bounds on the same grid; shape (quantity, v, u)."""
        columns, rows = self.blocks(u, v)
        return self.error[:, rows[:, None], columns]


@dataclass(frozen=True)
class PatchedFunction:
    """Patches that converged, and rectangles left to direct evaluation."""

    patches: tuple[Patch, ...]
    direct: tuple[Box, ...]
    evaluations: int = 0
    unconverged: int = field(default=0)

    def parts(self, u: Array, v: Array) -> Iterator[tuple[Patch, slice, slice]]:
        """Every patch that holds any of the grid ``u`` × ``v``, with the rows and columns that lie in it."""
        for patch in self.patches:
            rows, columns = between(v, patch.box.v0, patch.box.v1), between(u, patch.box.u0, patch.box.u1)
            if rows.stop > rows.start and columns.stop > columns.start:
                yield patch, rows, columns

    def find(self, u: float, v: float) -> Patch | None:
        """The patch that contains a point, or None."""
        return next((p for p in self.patches if p.box.contains(u, v)), None)


def grid_by_grid(function: Callable[[Array, Array], tuple[Array, Array]]) -> Evaluate:
    """``function`` of points (u, v) on several grids, by one call for all their points."""

    def evaluate(grids: list[Grid]) -> list[tuple[Array, Array]]:
        u = np.concatenate([np.tile(gu, len(gv)) for gu, gv in grids])
        v = np.concatenate([np.repeat(gv, len(gu)) for gu, gv in grids])
        values, bounds = function(u, v)
        cuts = np.cumsum([len(gu) * len(gv) for gu, gv in grids])[:-1]
        return list(zip(np.split(values, cuts), np.split(bounds, cuts), strict=True))

    return evaluate


def build(
    evaluate: Evaluate,
    boxes: list[Box],
    u_pixels: Array,
    v_pixels: Array,
    tolerance: float,
    *,
    nodes: int = NODES,
    direct_below: float = 0.8 * NODES**2,
    tick: Callable[[float], None] = lambda share: None,
) -> PatchedFunction:
    """Patch ``boxes`` until every quantity is known to ``tolerance`` (relative to its size on the patch).

    Each rectangle is sampled at ``nodes`` × ``nodes`` points. Rectangles with at most ``direct_below`` of the
    pixels ``u_pixels`` × ``v_pixels`` are left to direct evaluation; ``tick`` is called with the share settled.
    """
    patches: list[Patch] = []
    direct: list[Box] = []
    todo = [(box, 0) for box in boxes]
    evaluations = unconverged = 0
    whole = sum((box.u1 - box.u0) * (box.v1 - box.v0) for box in boxes)
    settled = 0.0
    while todo:
        sampled: list[tuple[Box, int]] = []
        for part, depth in todo:
            pixels = _inside(u_pixels, part.u0, part.u1) * _inside(v_pixels, part.v0, part.v1)
            spent = depth > DEEPEST or evaluations > MOST_EVALUATIONS
            if pixels <= direct_below or spent:
                direct.append(part)
                settled += (part.u1 - part.u0) * (part.v1 - part.v0)
                unconverged += spent or depth > 0
            else:
                sampled.append((part, depth))
        todo = []
        for part, depth, values, errors in _sample(evaluate, sampled, nodes):
            evaluations += nodes**2
            coefficients, tail_u, tail_v, error = _transform(values, errors, nodes, tolerance)
            along_u, along_v = bool(tail_u > 1), bool(tail_v > 1)
            if along_u or along_v:
                todo += [(half, depth + 1) for half in part.halves(along_u, along_v)]
            else:
                patches.append(_trimmed(part, coefficients, error, 1e-3 * tolerance))
                settled += (part.u1 - part.u0) * (part.v1 - part.v0)
            tick(min(settled / whole, 1.0))
    return PatchedFunction(tuple(patches), tuple(direct), evaluations, unconverged)


BATCH = 24
"""Boxes sampled in one call: enough to keep every thread busy, few enough to bound memory."""


def _sample(evaluate: Evaluate, boxes: list[tuple[Box, int]], nodes: int) -> Iterator[tuple[Box, int, Array, Array]]:
    unit = np.cos(np.pi * (np.arange(nodes) + 0.5) / nodes)
    for start in range(0, len(boxes), BATCH):
        batch = boxes[start : start + BATCH]
        grids = [(_from_unit(unit, b.u0, b.u1), _from_unit(unit, b.v0, b.v1)) for b, _ in batch]
        for (box, depth), (values, errors) in zip(batch, evaluate(grids), strict=True):
            yield box, depth, values, errors


def halved_across(evaluate: Evaluate, strips: list[Box], along_u: bool, tolerance: float) -> list[Box]:
    """Strips side by side along u (or v), halved in the other direction where a row of samples there asks for it.

    The row stands at each strip's upper end. It costs a fiftieth of a patch, which would be sampled for nothing where
    it turns out too wide.
    """
    first, unit = strips[0], np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)
    if along_u:
        grid = (np.array([box.u1 for box in strips]), _from_unit(unit, first.v0, first.v1))
    else:
        grid = (_from_unit(unit, first.u0, first.u1), np.array([box.v1 for box in strips]))
    ((values, _),) = evaluate([grid])
    samples = np.moveaxis(values.reshape(len(grid[1]), len(grid[0]), -1), 0 if along_u else 1, 0)
    tail = np.abs(dct(samples, type=2, axis=0)[-TAIL:]).max(axis=0) / NODES
    wide = (tail > NEARLY * tolerance * np.maximum(np.abs(samples).max(axis=0), 1.0)).any(axis=1)
    return [
        part for box, two in zip(strips, wide, strict=True) for part in box.halves(two and not along_u, two and along_u)
    ]


def _transform(values: Array, errors: Array, nodes: int, tolerance: float) -> tuple[Array, float, float, Array]:
    """Chebyshev coefficients, the tails along u and v over what they may be, and the error of each quantity.

    A tail may be ``tolerance`` times the quantity's size, or the error of its samples where that is larger:
    no more can be known from them.
    """
    quantities = values.shape[1]
    samples = values.T.reshape(quantities, nodes, nodes)
    coefficients = dct(dct(samples, type=2, axis=1), type=2, axis=2) / nodes**2
    coefficients[:, 0, :] /= 2
    coefficients[:, :, 0] /= 2
    size = np.abs(coefficients)
    tail_u, tail_v = size[:, :, -TAIL:].max(axis=2).sum(axis=1), size[:, -TAIL:, :].max(axis=1).sum(axis=1)
    allowed = tolerance * np.maximum(np.abs(samples).max(axis=(1, 2)), 1.0)
    # The median: a corner that is badly known is not a reason to resolve the rest badly.
    allowed = np.maximum(allowed, np.median(errors, axis=0))
    worst_u, worst_v = (tail_u / allowed).max(), (tail_v / allowed).max()
    if not np.isfinite(worst_u + worst_v):
        return coefficients, np.inf, np.inf, np.full((quantities, BLOCKS, BLOCKS), np.inf)
    # Interpolation at these nodes enlarges node errors by less than log(nodes) in each variable; in practice
    # errors of neighbouring nodes are alike and are not enlarged at all.
    side = nodes // BLOCKS
    blocks = errors.T.reshape(quantities, BLOCKS, side, BLOCKS, side).max(axis=(2, 4))
    return coefficients, float(worst_u), float(worst_v), blocks + (tail_u + tail_v)[:, None, None]


def _trimmed(box: Box, coefficients: Array, error: Array, tolerance: float) -> Patch:
    """A patch without the trailing coefficients that together stay below ``tolerance``; the error keeps them."""
    size = np.abs(coefficients)
    scale = np.maximum(size.max(axis=(1, 2)), 1.0)[:, None]
    rows = np.cumsum(size.sum(axis=2)[:, ::-1], axis=1)[:, ::-1]
    columns = np.cumsum(size.sum(axis=1)[:, ::-1], axis=1)[:, ::-1]
    i = max(1, int(np.count_nonzero((rows > tolerance * scale).any(axis=0))))
    j = max(1, int(np.count_nonzero((columns > tolerance * scale).any(axis=0))))
    dropped = 2 * tolerance * scale[:, 0]
    return Patch(box, np.ascontiguousarray(coefficients[:, :i, :j]), error + dropped[:, None, None])


def between(axis: Array, low: float, high: float) -> slice:
    """Places of a monotonic axis that lie between two values."""
    inside = np.flatnonzero((axis >= low) & (axis <= high))
    return slice(int(inside[0]), int(inside[-1]) + 1) if len(inside) else slice(0, 0)


def _inside(pixels: Array, low: float, high: float) -> int:
    return int(np.count_nonzero((pixels >= low) & (pixels <= high)))


def _to_unit(x: Array, low: float, high: float) -> Array:
    return np.clip((2 * x - low - high) / (high - low), -1.0, 1.0)


def _from_unit(t: Array, low: float, high: float) -> Array:
    return (low + high) / 2 + (high - low) / 2 * t


def _block(t: Array) -> Places:
    """The block of nodes that a coordinate in [−1, 1] falls into; nodes run from +1 to −1."""
    return np.minimum((np.arccos(t) / np.pi * BLOCKS).astype(np.intp), BLOCKS - 1)


def _chebyshev(t: Array, count: int) -> Array:
    """T_i(t), shape (count, points)."""
    return np.cos(np.arange(count)[:, None] * np.arccos(t)[None, :])
