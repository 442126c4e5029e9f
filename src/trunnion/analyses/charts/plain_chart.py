"""A line's chart in plain NumPy, for an installation that has not compiled the kernels of charts yet.

What a report shows takes few monodromy matrices, or is a picture of some thousand points: seconds here, a tenth of that
in compiled kernels, and most of a minute to compile them. Every step is that of ``building``: patches of the largest
multipliers (``few_nodes``) or pixel by pixel, pixels on a border judged once more, a check at random pixels by another
method, Runge–Kutta steps of order 8 over whole periods. Where any of it would take long, ``building`` does.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from trunnion.analyses.charts.building import (
    LADDER,
    SPOTS,
    Built,
    Spots,
    compared,
    decide_stiff,
    sharply,
    spots,
)
from trunnion.analyses.charts.chart_families import LineFamily
from trunnion.analyses.charts.chart_pixels import Pixels, judge_matrices, put_better
from trunnion.analyses.charts.few_nodes import SHARE, leading_patches
from trunnion.analyses.charts.leading_group import symmetric_functions, told_apart
from trunnion.analyses.charts.plain_pixels import plain_pixels
from trunnion.analyses.charts.prices import pixel_price, step_price
from trunnion.analyses.linear.carried_modes import propagated
from trunnion.equations.first_order import LineRates
from trunnion.equations.linear import periodic_linear_system
from trunnion.errors import ComputationError
from trunnion.numerics.chain.exponential_monodromy import exponential_monodromies, marched
from trunnion.numerics.patches.patches import Box, PatchedFunction, between
from trunnion.results.verdict import Verdict, verdicts

Array = NDArray[np.float64]
MOST_WORK, MOST_FIRST = 60_000, 240_000
"""Exponential steps of twelve states: about two seconds for a report, and eight for a chart that would be compiled."""
MOST_PIXELS, MOST_ALONE = 100_000, 2_000
"""Of a picture; of one that is integrated pixel by pixel."""
FEW = 64
"""Pixels that are judged one by one."""


@dataclass(frozen=True)
class PlainPoints:
    """Points (x, y) of a family, stepped in NumPy; see ``leading_group.Points``."""

    family: LineFamily
    x: Array
    y: Array
    rates: LineRates

    @classmethod
    def of(cls, family: LineFamily, x: Array, y: Array) -> PlainPoints:
        """The points with their equations."""
        return cls(family, x, y, family.rates(x, y))

    @property
    def steps(self) -> int:
        """See ``Points``."""
        return self.rates.steps

    @property
    def count(self) -> int:
        """See ``Points``."""
        return len(self.x)

    @property
    def states(self) -> int:
        """See ``Points``."""
        return 2 * self.family.size

    @np.errstate(over="ignore", invalid="ignore")  # steps that are far too long overflow, and are halved
    def monodromies(self, which: NDArray[np.intp], steps: int) -> tuple[Array, Array]:
        """See ``Points``."""
        return marched(self.rates, which, self.states, self.family.period, steps), self.rates.trace[which]

    def and_also(self, other: PlainPoints) -> PlainPoints:
        """See ``Points``."""
        return PlainPoints.of(self.family, np.append(self.x, other.x), np.append(self.y, other.y))


@dataclass(frozen=True)
class Plain:
    """A family as ``few_nodes`` samples it, and as axes that change nothing are found, in NumPy."""

    family: LineFamily

    def rates(self, x: Array, y: Array) -> LineRates:
        """See ``LineFamily``."""
        return self.family.rates(x, y)

    def exponentials(self, x: Array, y: Array) -> PlainPoints:
        """Points (x, y) to be stepped."""
        return PlainPoints.of(self.family, x, y)

    def from_patch(self, value: Array, of_x: bool) -> Array:
        """See ``LineFamily``."""
        return self.family.from_patch(value, of_x)

    def differ(self, x: Array, y: Array) -> bool:
        """See ``LineFamily``."""
        return told_apart(self.exponentials(x, y))

    def decisive(self, x: Array, y: Array) -> Array:
        """Quantities (points, …) that decide the stability, known to some 1e-12."""
        matrix, _, trace = self.matrices(x, y, 1e-12)
        return np.column_stack([symmetric_functions(np.linalg.eigvals(matrix).astype(complex)), trace])

    def matrices(self, x: Array, y: Array, tolerance: float) -> tuple[Array, Array, Array]:
        """Monodromy matrices of points (x, y) by Runge–Kutta steps, their errors and ∫ tr(M⁻¹C) dτ."""
        family = self.family
        runs = []
        for row in family.table(x, y):
            system = periodic_linear_system(family.assembly, row[None], statically_twisted=family.statically_twisted)
            runs.append(propagated(system, tolerance))
        matrices = np.array([run.scaled_monodromy for run in runs])
        return matrices, np.array([run.error for run in runs]), np.array([run.damping_trace for run in runs])


def build_plainly(
    family: LineFamily,
    x: Array,
    y: Array,
    tolerance: float,
    tell: Callable[[float], None],
    most_work: int = MOST_WORK,
) -> Built | None:
    """The chart, or None where it takes more than ``most_work`` steps, fails its check, or leaves much undecided."""
    u, v = family.to_patch(x, True), family.to_patch(y, False)
    box, size = Box(float(u.min()), float(u.max()), float(v.min()), float(v.max())), len(u) * len(v)
    if not family.uncompiled or size > MOST_PIXELS or box.u0 == box.u1 or box.v0 == box.v1:
        return None
    plain, way = Plain(family), LADDER[0]
    affordable = most_work * step_price(12) / SHARE + size * pixel_price(6)
    function = leading_patches(plain, box, size, tolerance / 4, 1, affordable, tell, even_all=True)
    if function is not None:
        pixels = _pixels(function, u, v, family.size)
    elif size <= MOST_ALONE:
        function, way = PatchedFunction((), (box,)), LADDER[-1]
        pixels = _alone(family, x, y, tolerance)
    else:
        return None
    try:
        if not _decided(plain, pixels, x, y, tolerance):
            return None
        rows, columns = spots(pixels.verdict.shape, SPOTS)
        sharp = judge_matrices(*plain.matrices(x[columns], y[rows], sharply(tolerance)))
    except ComputationError:
        return None
    check = compared(Spots(sharp, rows, columns), pixels)
    return None if check.worst_ratio > 1 else Built(way, family, tolerance, function, pixels, check, ())


def _pixels(function: PatchedFunction, u: Array, v: Array, size: int) -> Pixels:
    shape = (len(v), len(u))
    whole = Pixels(
        np.full(shape, np.nan), np.full(shape, np.nan), np.full(shape, np.nan, dtype=complex),
        np.full(shape, Verdict.FAILED, dtype=np.int8),
    )  # fmt: skip
    for patch in function.patches:
        here = between(v, patch.box.v0, patch.box.v1), between(u, patch.box.u0, patch.box.u1)
        part = plain_pixels(patch, u[here[1]], v[here[0]], size)
        whole.radius[here], whole.error[here] = part.radius, part.error
        whole.critical[here], whole.verdict[here] = part.critical, part.verdict
    return whole


def _alone(family: LineFamily, x: Array, y: Array, tolerance: float) -> Pixels:
    """Every pixel from steps that are halved until it is known to ``tolerance``, or until its verdict is sure."""
    rates = family.rates(np.tile(x, len(y)), np.repeat(y, len(x)))
    found = exponential_monodromies(
        rates, len(x) * len(y), 2 * family.size, family.period, tolerance=tolerance, least_steps=rates.steps
    )
    code = verdicts(found.radius, found.error, np.abs(rates.trace) < 1e-12 * family.size)
    shape = (len(y), len(x))
    return Pixels(
        found.radius.reshape(shape), found.error.reshape(shape), found.critical.reshape(shape), code.reshape(shape)
    )


def _decided(plain: Plain, pixels: Pixels, x: Array, y: Array, tolerance: float) -> bool:
    """Judge undecided pixels anew, in place; False where there are too many."""
    rows, columns = np.nonzero(pixels.verdict == Verdict.UNDECIDED)
    if len(rows) > FEW:
        return False
    if len(rows):
        found = judge_matrices(*plain.matrices(x[columns], y[rows], sharply(tolerance)))
        put_better(found, pixels, rows, columns)
        decide_stiff(plain.family, pixels, x, y)
    return True
