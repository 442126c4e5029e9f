"""How a chart is built, and built anew in another way where its own check fails.

A chart interpolates, and interpolation rests on assumptions that nobody has proved for every line: that the
tails of the series tell the error, that slabs are smooth, that half a period suffices. So every chart compares
random pixels with direct integration over whole periods, at a thousandth of its tolerance. Where one differs by
more than its estimate, no estimate can be trusted and the chart is built in the next way of ``FALLBACKS``, each of
which assumes less; a chart that fails in every way is refused.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextvars import copy_context
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from trunnion.arrays import Array, Flags, Places
from trunnion.errors import ComputationError, InputError
from trunnion.floquet.charts.chart_families import ChartFamily, LineFamily
from trunnion.floquet.charts.chart_pixels import Pixels, judge, judge_matrices, judge_rows
from trunnion.numerics.batch import BATCH
from trunnion.numerics.patches import patches
from trunnion.numerics.patches.patches import Box, Patch, PatchedFunction
from trunnion.numerics.threads import on_threads
from trunnion.results.chart import SpotCheck
from trunnion.results.verdict import Verdict

Progress = Callable[[float], None]
Matrices = Callable[[Array, Array, float, int], tuple[Array, Array, Array]]
"""Points (x, y), tolerance, threads → monodromy matrices, their errors and ∫ tr(M⁻¹C) dτ."""

SPOTS = 24
"""Random pixels at which a chart checks itself."""
FEW = 2000
"""Pixels for each of which hundreds of steps of dense matrices may be spent to decide them."""
DIRECT_BYTES = 512 * 2**20
"""Memory for matrices of points that are integrated by themselves together."""
AT_ONCE = 200_000
"""Numbers of a patch that are turned into pixels together."""
COLUMNS = 8_000_000
"""Numbers of a patch along columns of pixels, which stay in memory while their rows are shown."""
FEWEST_ROWS = 4
"""Rows of pixels together, however long: weighted sums of several take a third of the time a row."""
SAMPLING = 0.7
"""Share of the progress that building the function makes; showing its pixels makes the rest."""
UNEVEN = 0.4713
"""Where boxes are divided for smaller patches: not in the middle, so that no node stands where one stood."""


@dataclass(frozen=True)
class ChartStrategy:
    """One way of building a chart.

    ``name`` as results carry it; ``said``: how a note puts it; ``share`` of the tolerance asked for; ``smaller``
    patches, without slabs; ``half_windows``: half periods where symmetry allows; ``patched``: patches at all.
    """

    name: str
    said: str
    share: float = 1.0
    smaller: bool = False
    half_windows: bool = True
    patched: bool = True


FALLBACKS = (
    ChartStrategy("patches", "patches"),
    ChartStrategy("smaller patches", "smaller patches at a tenth of the tolerance", 0.1, smaller=True),
    ChartStrategy(
        "whole periods",
        "smaller patches at a tenth of the tolerance, integrated over whole periods",
        0.1, smaller=True, half_windows=False,
    ),
    ChartStrategy(
        "pixel by pixel",
        "every pixel integrated by itself over whole periods at a tenth of the tolerance",
        0.1, half_windows=False, patched=False,
    ),
)  # fmt: skip


@dataclass(frozen=True)
class BuiltChart:
    """A chart's pixels and what stands behind them: strategy, family, tolerance and check.

    ``failed``: what the checks of the ways before found.
    """

    strategy: ChartStrategy
    family: ChartFamily
    tolerance: float
    function: PatchedFunction
    pixels: Pixels
    check: SpotCheck
    failed: tuple[SpotCheck, ...]

    @property
    def remarks(self) -> list[str]:
        """What a reader of the chart must know of how it was built."""
        said = []
        if self.failed:
            ratio = max(check.worst_ratio for check in self.failed)
            said.append(
                f"its check found the chart as first built off by {ratio:.2g} times its error estimate; "
                f"it was built anew from {self.strategy.said}"
            )
        if count := self.function.unconverged:
            many = f"{count} small regions" if count > 1 else "1 small region"
            said.append(f"{many} did not converge as patches: integrated pixel by pixel")
        return said


def strategy_named(name: str) -> ChartStrategy:
    """The way of ``FALLBACKS`` that a saved chart names."""
    for strategy in FALLBACKS:
        if strategy.name == name:
            return strategy
    raise InputError(
        "is not a way of building charts", element="chart", key="way", value=name, remedy="compute it again"
    )


def family_for(strategy: ChartStrategy, family: ChartFamily) -> ChartFamily:
    """The family as this way integrates it."""
    return family if strategy.half_windows else family.over_whole_periods()


def build(
    family: ChartFamily, x: Array, y: Array, tolerance: float, threads: int, report_progress: Progress
) -> BuiltChart:
    """Pixels (y, x) in the first way of ``FALLBACKS`` whose check passes.

    Raises
    ------
    ComputationError : the check fails in every way.
    """
    failed: list[SpotCheck] = []

    def sharp() -> RefinedPixels:
        return spots_known(family, x, y, tolerance, threads, SPOTS * (1 + len(failed)))

    # What the check compares with asks nothing of the chart. Functions of a user's own stay on one thread.
    beside = threads > 1 and isinstance(family, LineFamily)
    with ThreadPoolExecutor(1) as aside:
        first = aside.submit(copy_context().run, sharp) if beside else None
        for strategy in FALLBACKS:
            own, asked = family_for(strategy, family), tolerance * strategy.share
            if strategy.smaller and not strategy.half_windows and own is family:
                continue  # it never used half periods, so this was tried before
            function = _patched(strategy, own, x, y, asked, threads, lambda share: report_progress(SAMPLING * share))
            pixels = fill(own, function, x, y, asked, threads, report_progress)
            check = compared(sharp() if first is None else first.result(), pixels)
            first = None
            if not check.worst_ratio > 1:
                return BuiltChart(strategy, own, asked, function, pixels, check, tuple(failed))
            failed.append(check)
    worst = failed[-1]
    raise ComputationError(
        f"the chart failed its own check in each of {len(failed)} ways of building it: points integrated anew move the "
        f"spectral radius by {worst.worst_difference:.1e}, {worst.worst_ratio:.2g} times the error estimated; "
        "raise the tolerance, or ask stability() for single points"
    )


def _patched(
    strategy: ChartStrategy,
    family: ChartFamily,
    x: Array,
    y: Array,
    tolerance: float,
    threads: int,
    report_progress: Progress,
) -> PatchedFunction:
    u, v = family.to_patch(x, True), family.to_patch(y, False)
    box = Box.around(u, v)
    if not strategy.patched or box.u0 == box.u1 or box.v0 == box.v1:
        return PatchedFunction((), (box,))
    if not strategy.smaller:
        for way in (family.leading, family.whole_matrices):
            if (few := way(box, len(u) * len(v), tolerance / 4, threads, report_progress)) is not None:
                return few
    sampler = family.sampler(box, len(u) * len(v), tolerance / 4, threads, slabs=not strategy.smaller)
    boxes = [part for whole in sampler.boxes for part in (_quarters(whole) if strategy.smaller else [whole])]
    return patches.build(
        sampler.evaluate, boxes, u, v, tolerance / 4, direct_below=sampler.direct_below, tick=report_progress
    )


def _quarters(box: Box) -> list[Box]:
    """Four parts that share no node with the whole."""
    u, v = box.u0 + UNEVEN * (box.u1 - box.u0), box.v0 + UNEVEN * (box.v1 - box.v0)
    return [Box(a, b, c, d) for a, b in ((box.u0, u), (u, box.u1)) for c, d in ((box.v0, v), (v, box.v1))]


def fill(
    family: ChartFamily,
    function: PatchedFunction,
    x: Array,
    y: Array,
    tolerance: float,
    threads: int,
    report_progress: Progress = lambda share: None,
) -> Pixels:
    """Every pixel, patch by patch in parallel, the rest by direct integration."""
    pixels_in_all = len(x) * len(y)

    def tell(done: int) -> None:
        report_progress(SAMPLING + (1 - SAMPLING) * done / pixels_in_all)

    def judged(patch: Patch, u: Array) -> Callable[[Array], Pixels]:
        along = patch.columns(u)
        return lambda v: judge_rows(patch, along, u, v, family.size, family.set_aside)

    pixels, left = shown(function, family.to_patch(x, True), family.to_patch(y, False), judged, threads, tell)
    r, c = np.nonzero(left)
    batch_size = int(np.clip(DIRECT_BYTES // (32 * (2 * family.size) ** 2), 1, 65536))
    for start in range(0, len(r), batch_size):
        here = (r[start : start + batch_size], c[start : start + batch_size])
        values, bounds = family.evaluate(x[here[1]], y[here[0]], tolerance / 4, threads)
        found = judge(np.ascontiguousarray(values.T), np.ascontiguousarray(bounds.T), family.size, family.set_aside)
        pixels.put(here, found)
        tell(pixels_in_all - len(r) + start + len(found.radius))
    decide(family, pixels, x, y, tolerance, threads)
    return pixels


def shown(
    function: PatchedFunction,
    u: Array,
    v: Array,
    judged: Callable[[Patch, Array], Callable[[Array], Pixels]],
    threads: int,
    tell: Callable[[int], None] = lambda done: None,
) -> tuple[Pixels, Flags]:
    """Pixels (v, u) of all patches, and which are left; ``judged``: (patch, u) → v → its pixels; ``tell`` is called
    with the pixels done so far."""
    pixels, left = Pixels.failed((len(v), len(u))), np.ones((len(v), len(u)), dtype=bool)

    def fill_strip(task: tuple[Callable[[Array], Pixels], slice, slice]) -> None:
        judge_strip, rows, columns = task
        pixels.put((rows, columns), judge_strip(v[rows]))

    # One patch may cover most of the pixels, so threads share strips.
    tasks, held = [], 0
    parts = [
        (patch, rows, some)
        for patch, rows, columns in function.parts(u, v)
        for some in _strips(columns, _whole_batches(COLUMNS // patch.coefficients[..., 0].size))
    ]
    for k, (patch, rows, columns) in enumerate(parts):
        judge_strip = judged(patch, u[columns])
        width = (columns.stop - columns.start) * len(patch.error)
        tasks += [(judge_strip, part, columns) for part in _strips(rows, max(FEWEST_ROWS, AT_ONCE // width))]
        left[rows, columns] = False
        held += (columns.stop - columns.start) * patch.coefficients[..., 0].size
        if held >= COLUMNS // 2 or k == len(parts) - 1:
            on_threads(fill_strip, tasks, threads)
            tell(int(np.count_nonzero(~left)))
            tasks, held = [], 0
    return pixels, left


class RefinedPixels(NamedTuple):
    """Some of a chart's pixels, known more sharply: ``found`` (spot,) of ``rows`` and ``columns``."""

    found: Pixels
    rows: Places
    columns: Places


def spots_known(family: ChartFamily, x: Array, y: Array, tolerance: float, threads: int, count: int) -> RefinedPixels:
    """``count`` random pixels (y, x) by integration over whole periods at a thousandth of the tolerance.

    The same pixels for the same shape: a chart built anew is asked first where it failed before.
    """
    rows, columns = spots((len(y), len(x)), count)
    values, bounds = family.over_whole_periods().evaluate(x[columns], y[rows], sharply(tolerance), threads)
    return RefinedPixels(judge(values.T.copy(), bounds.T.copy(), family.size, family.set_aside), rows, columns)


def sharply(tolerance: float) -> float:
    """The tolerance of what checks or decides pixels."""
    return max(tolerance * 1e-3, 1e-13)


def spots(shape: tuple[int, int], count: int) -> tuple[Places, Places]:
    """Rows and columns of ``count`` random pixels of a chart of ``shape`` (y, x)."""
    shares = np.random.default_rng(shape[0] * shape[1]).random((count, 2))
    return (shares[:, 0] * shape[0]).astype(int), (shares[:, 1] * shape[1]).astype(int)


def compared(known: RefinedPixels, pixels: Pixels) -> SpotCheck:
    """What pixels (y, x) of a chart are off from ``known``."""
    found, rows, columns = known
    off = np.abs(found.radius - pixels.radius[rows, columns])
    # Without error and without estimate is not off.
    ratio = off / np.maximum(pixels.error[rows, columns] + found.error, 1e-300)
    finite = np.isfinite(ratio)
    if not finite.any():
        return SpotCheck(len(rows), float("nan"), float("nan"))
    return SpotCheck(len(rows), float(ratio[finite].max()), float(off[finite].max()))


def decide(
    family: ChartFamily,
    pixels: Pixels,
    x: Array,
    y: Array,
    tolerance: float,
    threads: int,
    matrices: Matrices | None = None,
) -> None:
    """Judge undecided pixels (y, x) anew, in place, from monodromy matrices of their own: the family's by default.

    Stiff and soft shafts together make coefficients so large that their rounding hides roots which the matrix
    still shows; there are few such pixels in most charts.
    """
    rows, columns = np.nonzero(pixels.verdict == Verdict.UNDECIDED)
    if family.set_aside or not 0 < len(rows) <= family.affordable:
        return
    found = judge_matrices(*(matrices or family.matrices)(x[columns], y[rows], sharply(tolerance), threads))
    pixels.put_better(found, rows, columns)
    _decide_stiff(family, pixels, x, y)


def _decide_stiff(family: ChartFamily, pixels: Pixels, x: Array, y: Array) -> None:
    """Once more for what is left, by the multipliers themselves of steps that are halved until they stay.

    What fast modes leave in the matrix makes its error far larger than theirs.
    """
    rows, columns = np.nonzero(pixels.verdict == Verdict.UNDECIDED)
    if not 0 < len(rows) <= FEW or (found := family.settled(x[columns], y[rows])) is None:
        return
    pixels.put_better(found, rows, columns)


def _strips(rows: slice, step: int) -> list[slice]:
    """``rows`` in strips of ``step``: bounded memory, and work for every thread's cache."""
    return [slice(a, min(a + step, rows.stop)) for a in range(rows.start, rows.stop, step)]


def _whole_batches(count: int) -> int:
    """No more columns than ``count``, of many as many as kernels take without a rest."""
    return count - count % BATCH if count > BATCH else max(1, count)
