"""A family of lines over a box: patches to search by, and integration of single points to settle by."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from trunnion.arrays import Array, Flags, Places
from trunnion.floquet.charts.chart_families import ChartFamily
from trunnion.floquet.charts.chart_pixels import Pixels, judge, judge_matrices, undamped
from trunnion.floquet.tongues.boundaries import MOST, parted
from trunnion.numerics.chain.characteristic import without_ones
from trunnion.numerics.patches import patches
from trunnion.numerics.patches.patches import Box, Evaluate, Grid, Patch, PatchedFunction

SHARPEST = 1e-13
"""Error asked of single integrations, which settle what patches suggest."""
COARSE, UNDAMPED = 1e-10, 1e-6
"""Errors of ρ above this are looked into where they leave the verdict open; without damping, where every stable point
is open, only above the second."""
FAINT = UNDAMPED
"""Growth ρ − 1 over a period that is told from none without damping."""
NODES = 48
"""Samples of a piece of a row that no patch covers."""
EASIER = (1.0, 30.0, 1000.0)
"""Tolerances to patch to, over the one asked for, until one is settled: errors of patches say which it was."""
MOST_BOXES = 300
"""Boxes within which a tolerance settles; below the rounding of a stiff line's coefficients none ever does."""
GROUP = 100
"""Times the tolerance asked for, to which a stiff line's largest multipliers are known: what they then leave open, as
stretches where a boundary may just be touched, is looked at by integration."""
LOOKED_AT = 100_000
"""Points of a picture that would cost about as much to look at as the rows of a search."""
PIECES = 8
"""Into how many pieces such a stretch is cut."""


@dataclass(frozen=True)
class PatchRows:
    """Rows of one patch: their places, the stretch of u, cosine series (rows, q, J) of θ = arccos of u, errors (rows,
    q).

    ``undamped`` (rows,) where the trace of the damping vanishes. The last quantity of a patch, that trace, is left out.
    """

    rows: Places
    u0: float
    u1: float
    series: Array
    errors: Array
    undamped: Flags

    def u(self, theta: Array) -> Array:
        """θ → u."""
        return (self.u0 + self.u1) / 2 + (self.u1 - self.u0) / 2 * np.cos(theta)


@dataclass(frozen=True)
class Region:
    """A family over a box in its patch variables (u from x, v from y), with patches that cover it."""

    family: ChartFamily
    function: PatchedFunction
    box: Box
    threads: int

    @property
    def by_coefficients(self) -> bool:
        """Whether the patches hold coefficients (of a stiff line those of its largest multipliers), or matrices."""
        if not self.family.analytic:
            return False
        if self.function.patches:
            return all(len(patch.error) - 1 <= MOST for patch in self.function.patches)
        return 2 * self.family.size <= MOST

    @property
    def complete(self) -> bool:
        """Whether rows are searched for every zero, from end to end, or nothing can grow."""
        return self.family.passive or self.by_coefficients and not self.uncovered

    @property
    def uncovered(self) -> int:
        """Boxes that did not converge as patches."""
        return len(self.function.direct)

    def x(self, u: Array) -> Array:
        """Values of the parameter along u."""
        return self.family.from_patch(np.asarray(u, dtype=float), True)

    def y(self, v: Array) -> Array:
        """Values of the parameter along v."""
        return self.family.from_patch(np.asarray(v, dtype=float), False)

    def in_x(self, low: Array, high: Array) -> Array:
        """Intervals in u as rising intervals (intervals, 2) of the parameter along u."""
        pairs = np.sort(np.stack([self.x(low), self.x(high)], axis=-1), axis=-1).reshape(-1, 2)
        return pairs[np.argsort(pairs[:, 0])]

    def judged(self, u: Array, v: Array) -> Pixels:
        """Points integrated by themselves: radius, its error, critical multiplier, verdict, each (points,)."""
        x, y = self.x(u), self.y(v)
        if not len(x):
            return Pixels.failed((0,))
        if (stepped := self.family.in_numpy(x, y)) is not None:
            return stepped
        if not self.family.set_aside:
            return self._judged(*self._matrices(x, y), x, y)
        order, back = _by_rows(v)
        values, bounds = self.family.evaluate(x[order], y[order], SHARPEST, self.threads)
        return judge(values.T.copy(), bounds.T.copy(), self.family.size, self.family.set_aside).at(back)

    def _matrices(self, x: Array, y: Array) -> tuple[Array, Array, Array]:
        order, back = _by_rows(y)
        matrix, error, trace = self.family.matrices(x[order], y[order], SHARPEST, self.threads)
        return matrix[back], error[back], trace[back]

    def _judged(self, matrix: Array, error: Array, trace: Array, x: Array, y: Array) -> Pixels:
        """Once more what the matrix leaves open: fast modes make its error far larger than that of ρ."""
        found = judge_matrices(matrix, error, trace)
        coarse = found.error > np.where(undamped(trace, self.family.size), UNDAMPED, COARSE)
        open_ = np.flatnonzero((np.abs(found.radius - 1) <= found.error) & coarse)
        if len(open_) and (better := self.family.settled(x[open_], y[open_])) is not None:
            found.put_better(better, open_)
        return found

    def undamped(self, u: Array, v: Array) -> Flags:
        """Where nothing damps (points,)."""
        x, y = self.x(u), self.y(v)
        if self.family.in_numpy(x, y) is not None:  # which damped lines alone are
            return np.zeros(len(x), dtype=bool)
        return undamped(self._matrices(x, y)[2], self.family.size)

    def across(self, u: Array, v: Array) -> Array:
        """A function (points,) with a slope at the edges of regions: positive where unstable.

        Without damping that of ``boundaries.parted``, else ρ − 1, where what is 1 to within its error counts as stable.
        """
        if not len(u):
            return np.zeros(0)
        x, y = self.x(u), self.y(v)
        if (stepped := self.family.in_numpy(x, y)) is not None:
            return _over(stepped)
        if self.family.set_aside:
            return _over(self.judged(u, v))
        matrix, error, trace = self._matrices(x, y)
        damped = ~(undamped(trace, self.family.size) & np.isfinite(matrix).all(axis=(1, 2)))
        across = np.empty(len(u))
        across[~damped] = parted(np.asarray(np.linalg.eigvals(matrix[~damped]), dtype=complex))
        if damped.any():
            own = (part[damped] for part in (matrix, error, trace, x, y))
            across[damped] = _over(self._judged(*own))
        return across

    def above_one(self, u: Array, v: Array) -> Array:
        """Spectral radius less 1 (points,)."""
        return self.judged(u, v).radius - 1

    def pieces(self, v: Array) -> Iterator[PatchRows]:
        """The rows at ``v`` (rows,), patch by patch; every row is covered from end to end."""
        for patch in self.function.patches:
            inside = self._rows_of(patch.box, v)
            if len(inside):
                yield self._along(patch, inside, v[inside])
        for box in self.function.direct:
            inside = self._rows_of(box, v)
            edges = np.linspace(box.u0, box.u1, PIECES + 1)
            for a, b in pairwise(edges.tolist() if len(inside) else []):
                yield self._integrated(a, b, inside, v[inside])

    def _rows_of(self, box: Box, v: Array) -> Places:
        """Rows that belong to a box: those on an edge between two boxes to the upper one."""
        below = v < box.v1 if box.v1 < self.box.v1 * (1 + 1e-12) - 1e-300 and box.v1 != self.box.v1 else v <= box.v1
        return np.flatnonzero((v >= box.v0) & below)

    def _along(self, patch: Patch, rows: Places, v: Array) -> PatchRows:
        weights = patch.weights(v)
        series = np.einsum("ri,qij->rqj", weights, patch.coefficients)
        _, block = patch.blocks(np.array([patch.box.u0]), v)
        errors = patch.error.max(axis=2)[:, block].T
        return self._piece(rows, patch.box.u0, patch.box.u1, series, errors)

    def _integrated(self, u0: float, u1: float, rows: Places, v: Array) -> PatchRows:
        from scipy.fft import dct

        nodes = (u0 + u1) / 2 + (u1 - u0) / 2 * np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)
        values, bounds = self.family.evaluate(
            self.x(np.tile(nodes, len(rows))), self.y(np.repeat(v, NODES)), 1e-12, self.threads
        )
        samples = values.reshape(len(rows), NODES, -1).transpose(0, 2, 1)
        series = dct(samples, type=2, axis=2) / NODES
        series[:, :, 0] /= 2
        tail = np.abs(series[:, :, -4:]).sum(axis=2)
        return self._piece(rows, u0, u1, series, bounds.reshape(len(rows), NODES, -1).max(axis=1) + tail)

    def _piece(self, rows: Places, u0: float, u1: float, series: Array, errors: Array) -> PatchRows:
        still = undamped(np.abs(series[:, -1]).sum(axis=1), self.family.size)
        series, errors = series[:, :-1], errors[:, :-1]
        aside = self.family.set_aside
        if self.by_coefficients and aside:
            # (σ − 1) divides out of the polynomial, a linear operation: coefficient by coefficient of the series, where
            # e₀ = 1 stands in the constant term alone.
            series, errors = _set_aside(series, errors, aside)
        return PatchRows(rows, u0, u1, series, errors, still)


def _by_rows(v: Array) -> tuple[Places, Places]:
    """An order of points, and the way back: those with the same angles share the joints' laws where they stand
    together."""
    order = np.argsort(v, kind="stable")
    return order, np.argsort(order)


def _over(found: Pixels) -> Array:
    """ρ − 1, below zero where it is 1 to within its error."""
    over = found.radius - 1
    stable = np.where(over == 0, -1e-300, over - 2 * found.error * (over > 0))
    return np.asarray(np.where(np.abs(over) > found.error, over, stable))


def _set_aside(series: Array, errors: Array, aside: int) -> tuple[Array, Array]:
    rows, m, terms = series.shape
    flat = series.transpose(1, 0, 2).reshape(m, -1)
    known = np.repeat(errors.T[:, :, None], terms, axis=2).reshape(m, -1)
    zero = np.zeros_like(flat)
    with_one, bounds = without_ones(flat, known, aside)
    constant, _ = without_ones(zero, zero, aside)
    only = np.zeros((rows, terms))
    only[:, 0] = 1.0
    # ``without_ones`` adds e₀ = 1 to every column; only the constant terms have it.
    left = with_one - constant * (1 - only.reshape(-1))
    shape = (len(left), rows, terms)
    return left.reshape(shape).transpose(1, 0, 2), bounds.reshape(shape)[:, :, 0].T


def patched(
    family: ChartFamily, x: Array, y: Array, tolerance: float, threads: int, report_progress: Callable[[float], None]
) -> Region:
    """Patch a family over the box that the values ``x`` and ``y`` span, however few points a picture of it would
    have.

    Of a stiff line by its largest multipliers alone where those stand apart and cost less: none of the others is ever
    the first to leave the unit circle.
    """
    if family.passive:
        return unpatched(family, x, y, threads)
    u, v = family.to_patch(x, True), family.to_patch(y, False)
    box = Box.around(u, v)
    if (few := family.leading(box, LOOKED_AT, GROUP * tolerance / 4, threads, report_progress)) is not None:
        return Region(family, few, box, threads)
    kinks = [family.to_patch(own, of_x) for own, of_x in zip(family.kinks, (True, False), strict=True)]
    for share in EASIER:
        asked, most = share * tolerance / 4, MOST_BOXES if share != EASIER[-1] else np.inf
        sampler = family.sampler(box, 1_000_000, asked, threads)
        try:
            built = patches.build(
                _at_most(most, sampler.evaluate), _cut(sampler.boxes, *kinks), u, v, asked, direct_below=-1,
                tick=report_progress,
            )  # fmt: skip
        except _NeverSettlesError:
            continue
        break
    return Region(family, built, box, threads)


def _cut(boxes: list[Box], u: Array, v: Array) -> list[Box]:
    """Boxes cut where the quantities have kinks, so that they are smooth in each."""

    def parts(low: float, high: float, at: Array) -> list[tuple[float, float]]:
        inside = np.unique(at[(at > low) & (at < high)]).tolist()
        return list(pairwise([low, *inside, high]))

    return [
        Box(*across, *up) for one in boxes for across in parts(one.u0, one.u1, u) for up in parts(one.v0, one.v1, v)
    ]


class _NeverSettlesError(Exception):
    """Patches are halved on and on: the tolerance asked for lies below the rounding of what they hold."""


def _at_most(most: float, evaluate: Evaluate) -> Evaluate:
    """``evaluate`` until it was asked for more than ``most`` grids."""
    asked = 0

    def counted(grids: list[Grid]) -> list[tuple[Array, Array]]:
        nonlocal asked
        asked += len(grids)
        if asked > most:
            raise _NeverSettlesError
        return evaluate(grids)

    return counted


def unpatched(family: ChartFamily, x: Array, y: Array, threads: int) -> Region:
    """The same box without patches: every row is integrated piece by piece."""
    box = Box.around(family.to_patch(x, True), family.to_patch(y, False))
    return Region(family, PatchedFunction((), (box,)), box, threads)


def turned(family: ChartFamily, function: PatchedFunction, threads: int) -> Region:
    """The region of a chart whose rows are the chart's columns; ``family`` has the chart's axes exchanged."""
    patches_ = tuple(
        Patch(_turned(p.box), np.ascontiguousarray(p.coefficients.swapaxes(1, 2)), p.error.swapaxes(1, 2))
        for p in function.patches
    )
    direct = tuple(_turned(box) for box in function.direct)
    every = [p.box for p in patches_] + list(direct)
    box = Box(min(b.u0 for b in every), max(b.u1 for b in every), min(b.v0 for b in every), max(b.v1 for b in every))
    return Region(family, PatchedFunction(patches_, direct), box, threads)


def _turned(box: Box) -> Box:
    return Box(box.v0, box.v1, box.u0, box.u1)
