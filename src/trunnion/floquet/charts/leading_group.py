"""The largest multipliers of many monodromy matrices as one group: what a chart of a stiff line interpolates.

Most modes of a stiff line die within a period. Where the d largest multipliers stay apart from the rest in modulus,
their elementary symmetric functions e₁ … e_d are analytic in every parameter, as all coefficients of the
characteristic polynomial are, and as smooth as those few modes: few nodes resolve them, and what the others leave in
the matrix has no part in them.
"""

from __future__ import annotations

from typing import Protocol, Self

import numpy as np

from trunnion.arrays import Array, Complex, Places
from trunnion.floquet.charts.cost_model import pixel_cost, step_cost
from trunnion.numerics.batch import BATCH
from trunnion.numerics.chain.characteristic import LARGEST
from trunnion.numerics.chain.exponential_monodromy import MOST_STEPS
from trunnion.numerics.threads import on_threads

FAINT = 0.01
"""Least difference of ln|σ| between neighbours that parts a group from the rest."""
ROUGH = 0.05
"""To how much ln|σ| must be known before groups are looked for."""
FALLS = 24
"""Fall of the change from one halving to the next that shows order 6, whose own is 64."""
NOTABLE = 1e-3
"""Of the largest multiplier, what one must be to matter for the group."""
WORTH_A_THREAD = 10_000
"""Microseconds of work for which a thread of its own is begun."""
TELLING = 100
"""Difference over its error at which two points are told apart without a second look."""


class GridPoints(Protocol):
    """Lines over one period whose monodromy matrices come from exponential steps."""

    @property
    def steps(self) -> int:
        """As many as see the fastest coefficient."""

    @property
    def count(self) -> int:
        """Number of points."""

    @property
    def states(self) -> int:
        """Size of the matrices."""

    def monodromies(self, which: Places, steps: int) -> tuple[Array, Array]:
        """Z (point, m, m) and ∫ tr(M⁻¹C) dτ (point,) of the points ``which``, by so many steps."""

    def and_also(self, other: Self) -> Self:
        """These points and then those of ``other``."""


class ConvergingMultipliers:
    """Multipliers (point, m) at a growing number of points, of N/2, N and 2N ``steps``; ``work``: what was done so far,
    in steps, eigenvalues counted as the steps that they cost.

    Those of N/2 steps are NaN until a point is sharpened. trace (point,): ∫ tr(M⁻¹C) dτ over the period.
    """

    def __init__(self, points: GridPoints, threads: int) -> None:
        self.points, self.threads, self.work = points, threads, 0.0
        self.cost = step_cost(points.states)
        self.eigenvalues = pixel_cost(points.states) / self.cost
        self.fine, self.coarse, self.coarser = (np.empty((0, points.states), complex) for _ in range(3))
        self.norm, self.trace, self.steps = np.empty(0), np.empty(0), np.empty(0, dtype=np.intp)
        self._add(points.count)

    def add(self, points: GridPoints) -> None:
        """Multipliers of further points."""
        self.points = self.points.and_also(points)
        self._add(points.count)

    def _add(self, count: int) -> None:
        which, first = len(self.steps) + np.arange(count), self.points.steps
        coarse, _, _ = self._multipliers(which, first)
        fine, norm, trace = self._multipliers(which, 2 * first)
        self.coarser = np.concatenate([self.coarser, np.full_like(coarse, np.nan)])
        self.coarse, self.fine = np.concatenate([self.coarse, coarse]), np.concatenate([self.fine, fine])
        self.norm, self.trace = np.concatenate([self.norm, norm]), np.concatenate([self.trace, trace])
        self.steps = np.concatenate([self.steps, np.full(count, 2 * first)])

    def rough(self) -> Places:
        """Points whose larger multipliers are not yet known well enough to tell groups apart."""
        with np.errstate(divide="ignore", invalid="ignore"):
            fine, coarse = (np.log(np.abs(part[:, : LARGEST + 1])) for part in (self.fine, self.coarse))
            moved = np.where(fine > fine[:, :1] + np.log(NOTABLE), np.abs(fine - coarse), 0.0)
        return np.flatnonzero(~(moved.max(axis=1) < ROUGH))

    def sharpen(self, which: Places) -> None:
        """Twice the steps at the points ``which``."""
        for steps in np.unique(self.steps[which])[::-1].tolist():  # the least last: none is taken up twice
            some = which[self.steps[which] == steps]
            self.coarser[some], self.coarse[some] = self.coarse[some], self.fine[some]
            self.fine[some], self.norm[some], self.trace[some] = self._multipliers(some, 2 * steps)
            self.steps[some] = 2 * steps

    def _multipliers(self, which: Places, steps: int) -> tuple[Complex, Array, Array]:
        self.work += len(which) * (steps + self.eigenvalues)

        def run(some: Places) -> tuple[Complex, Array, Array]:
            # Steps that are far too long overflow, and are halved.
            z, trace = self.points.monodromies(some, steps)
            with np.errstate(over="ignore", invalid="ignore"):
                norm = np.linalg.norm(z, axis=(1, 2))
            finite = np.asarray(np.isfinite(z).all(axis=(1, 2)))
            values = np.linalg.eigvals(np.where(finite[:, None, None], z, 0.0)).astype(complex)
            values[~finite] = np.nan
            order = np.argsort(-np.abs(values), axis=1)
            return np.take_along_axis(values, order, axis=1), norm, trace

        worth = len(which) * (steps * self.cost) / WORTH_A_THREAD
        pieces = np.array_split(which, max(1, min(self.threads, len(which) // BATCH, int(worth))))
        values, norm, trace = zip(*on_threads(run, pieces, len(pieces)), strict=True)
        return np.concatenate(values), np.concatenate(norm), np.concatenate(trace)


def group_sizes(values: Complex) -> list[int]:
    """How many multipliers, at most ``LARGEST``, stand apart from the rest at all points of ``values`` (point, m).

    ``values`` by falling modulus.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        logarithm = np.log(np.abs(values))
        gap = np.where(np.isneginf(logarithm[:, 1:]), np.inf, logarithm[:, :-1] - logarithm[:, 1:]).min(axis=0)
    gap = np.append(gap, np.inf)[:LARGEST]  # all of them are apart from nothing
    return [int(k) + 1 for k in np.flatnonzero(gap >= FAINT)]


def symmetric_functions(values: Complex) -> Array:
    """e₁ … e_d (point, d) of multipliers (point, d)."""
    count, d = values.shape
    e = np.zeros((count, d + 1), dtype=complex)
    e[:, 0] = 1
    for k in range(d):
        e[:, 1 : k + 2] = e[:, 1 : k + 2] + values[:, k : k + 1] * e[:, : k + 1]
    return np.asarray(e[:, 1:].real)


def settle(found: ConvergingMultipliers, d: int, tolerance: float, most_work: float) -> bool:
    """Halve steps until e₁ … e_d of every point are known to ``tolerance`` of their size (1 at least).

    False where more than ``most_work`` steps would not do.
    """
    while True:
        values, errors, rounding = known(found, d)
        allowed = np.maximum(tolerance * np.maximum(np.abs(values).max(axis=0), 1.0), 2 * rounding)
        left = np.flatnonzero(~(errors <= allowed).all(axis=1))
        if not len(left):
            return True
        if found.work > most_work or found.steps[left].max() >= MOST_STEPS:
            return False
        found.sharpen(left)


@np.errstate(over="ignore", invalid="ignore")  # as steps that are far too long overflow
def known(found: ConvergingMultipliers, d: int) -> tuple[Array, Array, Array]:
    """e₁ … e_d, their errors, and what of them is rounding, each (point, d).

    The error is the change from N to 2N steps. Where the change before was larger by ``FALLS``, the order of the method
    shows, and the next would be smaller by as much: a third of that is claimed.
    """
    coarser, coarse, fine = (symmetric_functions(part[:, :d]) for part in (found.coarser, found.coarse, found.fine))
    # Rounding of the matrix reaches every multiplier; that of their products is far smaller.
    rounding = (
        1e-15 * found.points.states * found.norm[:, None] * np.maximum(np.abs(fine).max(axis=1, keepdims=True), 1.0)
    )
    change, before = np.abs(fine - coarse), np.abs(coarse - coarser)
    falls = before.max(axis=1) >= FALLS * change.max(axis=1)
    change = np.where(falls[:, None], np.maximum(change, change.max(axis=1, keepdims=True) / 4) * (3 / FALLS), change)
    return fine, change + rounding, rounding


def distinguished(both: GridPoints) -> bool:
    """Whether e₁ … e_m of two cases differ by far more than steps that are too long can make them."""
    found = ConvergingMultipliers(both, 1)
    for _ in range(3):
        values, errors, _ = known(found, both.states)
        noise = errors.sum(axis=0)
        if np.isfinite(noise).all() and bool((np.abs(values[1] - values[0]) > TELLING * noise).any()):
            return True
        found.sharpen(np.arange(2))
    return False
