"""A line's chart in plain NumPy, for an installation that has not compiled the kernels of charts yet.

What a report shows takes few monodromy matrices, or is a picture of some thousand points: seconds here, a tenth of
that in compiled kernels, and most of a minute to compile them. Every step is that of ``building``: patches of the
largest multipliers (``leading_group``) or pixel by pixel, pixels on a border judged once more, a check at random
pixels by another method, Runge–Kutta steps of order 8 over whole periods. Where any of it would take long,
``building`` does.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from trunnion.arrays import Array, Places
from trunnion.equations.first_order import LineRates
from trunnion.equations.linear import periodic_linear_system
from trunnion.errors import ComputationError
from trunnion.floquet.charts.building import (
    FALLBACKS,
    SPOTS,
    BuiltChart,
    RefinedPixels,
    compared,
    decide,
    sharply,
    shown,
    spots,
)
from trunnion.floquet.charts.chart_families import LineFamily
from trunnion.floquet.charts.chart_pixels import Pixels, judge_matrices
from trunnion.floquet.charts.cost_model import pixel_cost, step_cost
from trunnion.floquet.charts.leading_group import distinguished, symmetric_functions
from trunnion.floquet.charts.multiplier_interpolation import SHARE, corners_of, leading_patches
from trunnion.floquet.charts.numpy_pixels import numpy_pixels
from trunnion.floquet.propagation.floquet_modes import propagated
from trunnion.numerics.chain.exponential_monodromy import marched
from trunnion.numerics.patches.patches import Box, PatchedFunction
from trunnion.results.verdict import Verdict

MOST_WORK, MOST_FIRST = 60_000, 240_000
"""Exponential steps of twelve states: about two seconds for a report, and eight for a chart that would be compiled."""
MOST_PIXELS, MOST_ALONE = 100_000, 2_000
"""Of a picture; of one that is integrated pixel by pixel."""
FEW = 64
"""Pixels that are judged one by one."""


@dataclass(frozen=True)
class NumpyPoints:
    """Points of a line, stepped in NumPy; see ``leading_group.Points``."""

    rates: LineRates

    @property
    def steps(self) -> int:
        """See ``Points``."""
        return self.rates.steps

    @property
    def count(self) -> int:
        """See ``Points``."""
        return len(self.rates.table)

    @property
    def states(self) -> int:
        """See ``Points``."""
        return 2 * self.rates.root.shape[1]

    @np.errstate(over="ignore", invalid="ignore")  # steps that are far too long overflow, and are halved
    def monodromies(self, which: Places, steps: int) -> tuple[Array, Array]:
        """See ``Points``."""
        return marched(self.rates, which, self.states, self.rates.period, steps), self.rates.trace[which]

    def and_also(self, other: NumpyPoints) -> NumpyPoints:
        """See ``Points``."""
        both = np.concatenate([self.rates.table, other.rates.table])
        return NumpyPoints(LineRates.of(self.rates.assembly, both, self.rates.twisted))


@dataclass(frozen=True)
class NumpyAxisTest:
    """What tells whether an axis of a family changes anything, in NumPy."""

    family: LineFamily

    def differ(self, x: Array, y: Array) -> bool:
        """See ``ChartFamily``."""
        return distinguished(NumpyPoints(self.family.rates(x, y)))

    def decisive(self, x: Array, y: Array) -> Array:
        """Quantities (points, …) that decide the stability, known to some 1e-12."""
        matrix, _, trace = self.matrices(x, y, 1e-12)
        return np.column_stack([symmetric_functions(np.linalg.eigvals(matrix).astype(complex)), trace])

    def matrices(self, x: Array, y: Array, tolerance: float, threads: int = 1) -> tuple[Array, Array, Array]:
        """Monodromy matrices of points (x, y) by Runge–Kutta steps, their errors and ∫ tr(M⁻¹C) dτ."""
        family = self.family
        runs = []
        for row in family.table(x, y):
            system = periodic_linear_system(family.assembly, row[None], statically_twisted=family.statically_twisted)
            runs.append(propagated(system, tolerance))
        matrices = np.array([run.scaled_monodromy for run in runs])
        return matrices, np.array([run.error for run in runs]), np.array([run.damping_trace for run in runs])


def build_with_numpy(
    family: LineFamily,
    x: Array,
    y: Array,
    tolerance: float,
    report_progress: Callable[[float], None],
    most_work: int = MOST_WORK,
) -> BuiltChart | None:
    """The chart, or None where it takes more than ``most_work`` steps, fails its check, or leaves much undecided."""
    u, v = family.to_patch(x, True), family.to_patch(y, False)
    box, size = Box.around(u, v), len(u) * len(v)
    if not family.uncompiled or size > MOST_PIXELS or box.u0 == box.u1 or box.v0 == box.v1:
        return None

    def points(u: Array, v: Array) -> NumpyPoints:
        return NumpyPoints(family.rates(family.from_patch(u, True), family.from_patch(v, False)))

    strategy, matrices = FALLBACKS[0], NumpyAxisTest(family).matrices
    affordable = most_work * step_cost(12) / SHARE + size * pixel_cost(6)
    corners = points(*corners_of(box)).rates
    function = leading_patches(points, corners, box, size, tolerance / 4, 1, affordable, report_progress, even_all=True)
    if function is not None:
        pixels, _ = shown(function, u, v, lambda patch, u: partial(numpy_pixels, patch, u, size=family.size), 1)
    elif size <= MOST_ALONE:
        function, strategy = PatchedFunction((), (box,)), FALLBACKS[-1]
        pixels = _alone(family, x, y, tolerance)
    else:
        return None
    try:
        if np.count_nonzero(pixels.verdict == Verdict.UNDECIDED) > FEW:
            return None
        decide(family, pixels, x, y, tolerance, 1, matrices)
        rows, columns = spots(pixels.verdict.shape, SPOTS)
        sharp = judge_matrices(*matrices(x[columns], y[rows], sharply(tolerance)))
    except ComputationError:
        return None
    check = compared(RefinedPixels(sharp, rows, columns), pixels)
    return None if check.worst_ratio > 1 else BuiltChart(strategy, family, tolerance, function, pixels, check, ())


def _alone(family: LineFamily, x: Array, y: Array, tolerance: float) -> Pixels:
    """Every pixel from steps that are halved until it is known to ``tolerance``, or until its verdict is sure."""
    rates = family.rates(np.tile(x, len(y)), np.repeat(y, len(x)))
    return family.step_halving(rates, tolerance).shaped((len(y), len(x)))
