"""Stability over any two parameters, as a function known to a stated error everywhere.

The chart samples analytic quantities at the nodes of adaptive Chebyshev patches, interpolates them to the
pixels and finds multipliers there; small regions are evaluated pixel by pixel. At the end it checks itself
at random pixels by direct integration at a much smaller tolerance.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from trunnion.analyses.charts.axes import Axis, AxisRequest, axis, moves_nothing, own_axis
from trunnion.analyses.charts.chart_families import ChartFamily, LineFamily, OwnFamily, PatchesAlone
from trunnion.analyses.charts.chart_pixels import Pixels, judge, judge_matrices, judge_rows, multipliers_of
from trunnion.analyses.features import left_out
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import operating_speed
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.steady_base import refuse_own_motion, require_steady_base
from trunnion.equations.topology import require_period
from trunnion.errors import InputError
from trunnion.numerics.patches.patches import Box, Patch, PatchedFunction, build
from trunnion.numerics.threads import on_threads
from trunnion.results.chart import ChartPoint, SpotCheck, StabilityChart
from trunnion.results.verdict import Verdict
from trunnion.systems.family import PeriodicLinearFamily

Array = NDArray[np.float64]
Progress = Callable[[float], None]
SPOTS = 24
"""Random pixels at which a chart checks itself."""


def stability_chart(
    line: Driveline | Assembly | PeriodicLinearFamily,
    x: AxisRequest,
    y: AxisRequest,
    *,
    speed: float | None = None,
    tolerance: float = 1e-9,
    statically_twisted: bool = True,
    threads: int | None = None,
    progress: Progress | None = None,
) -> StabilityChart:
    """Verdict, spectral radius and its error over two parameters.

    Parameters
    ----------
    line : a driveline, or a ``PeriodicLinearFamily`` of your own.
    x, y : ``(parameter, low, high, points)``, optionally with ``"log"`` at the end. For a driveline a
        parameter is a path ("speed", "HookeJoint 1.angle", "factor of Shaft *.damping") or a ``Parameter``,
        values in SI; for a family it is the name of one of its parameters.
    speed : input speed [rad/s] where neither axis is the speed; default the operating speed of the file.
    tolerance : error asked of the interpolated quantities, relative to their size where that exceeds 1.
        Multipliers that collide are known to its square root; the error estimate of each pixel says so.
    statically_twisted : as in ``stability``.
    threads : default one per core.
    progress : called as progress(share done) from the calling thread.

    Returns
    -------
    StabilityChart, arrays of shape (y, x); ``chart.at(x, y)`` answers anywhere in its box.

    Raises
    ------
    InputError : see ``axes.axis``; both axes the same; no speed.
    KeyboardInterrupt : passed on; nothing is kept.
    """
    task = (
        _own_task(line, x, y)
        if isinstance(line, PeriodicLinearFamily)
        else _line_task(line, x, y, speed, statically_twisted)
    )
    if isinstance(line, PeriodicLinearFamily) and speed is not None:
        raise InputError("belongs to drivelines", key="speed", value=speed, remedy="a family has its own parameters")
    if not tolerance > 0 or not np.isfinite(tolerance):
        raise InputError("must be positive and finite", key="tolerance", value=tolerance, remedy="1e-9, say")
    workers = threads or os.cpu_count() or 1
    tell = progress or (lambda share: None)
    x_axis, y_axis = task.x, task.y
    function = _patched(task.family, x_axis.values, y_axis.values, tolerance, workers, tell)
    pixels = _fill(task.family, function, x_axis.values, y_axis.values, tolerance, workers)
    tell(1.0)
    remarks = list(task.remarks)
    if function.stubborn:
        many = f"{function.stubborn} small regions" if function.stubborn > 1 else "1 small region"
        remarks.append(f"{many} did not converge as patches: integrated pixel by pixel")
    if isinstance(task.family, OwnFamily):
        remarks += task.family.failures(x_axis.values, y_axis.values, pixels.verdict == Verdict.FAILED, tolerance)
    chart = StabilityChart(
        x=x_axis.values,
        y=y_axis.values,
        x_parameter=x_axis.parameter,
        y_parameter=y_axis.parameter,
        x_unit=x_axis.unit,
        y_unit=y_axis.unit,
        spectral_radius=pixels.radius,
        error_estimate=pixels.error,
        critical_multiplier=pixels.critical,
        verdict=pixels.verdict,
        speed=task.speed,
        period=task.family.period,
        tolerance=tolerance,
        statically_twisted=statically_twisted,
        remarks=tuple(remarks),
        line=task.line,
        function=function,
        evaluate_point=_pointwise(task.family, function, tolerance),
        resample=_resampler(task.family, function, tolerance, workers),
    )
    return _self_checked(chart, task.family, tolerance, workers)


@dataclass(frozen=True)
class _Task:
    family: ChartFamily
    x: Axis
    y: Axis
    speed: float | None
    line: Driveline | None
    remarks: tuple[str, ...]


def _line_task(line: Driveline | Assembly, x: AxisRequest, y: AxisRequest, speed: float | None, twisted: bool) -> _Task:
    assembly = line if isinstance(line, Assembly) else assemble(line)
    require_period(assembly.line, assembly.topology)
    across, said_x = axis(assembly, x, "x")
    up, said_y = axis(assembly, y, "y")
    both = set(across.columns.index.tolist()) & set(up.columns.index.tolist())
    if both:
        name = assembly.packed.labels[min(both)]
        raise InputError(
            f"is moved by both axes ({across.label} and {up.label}), so one would overwrite the other",
            key=name,
            remedy="give y a parameter that leaves it alone",
        )
    refuse_own_motion(
        assembly,
        "ask stability at single speeds, or put a ConstantSpeed in front for a chart",
        bends=across.is_joint_angle or up.is_joint_angle,
    )
    swept = across.is_speed or up.is_speed
    if swept and speed is not None:
        raise InputError("is an axis already", key="speed", value=speed, remedy="leave speed out")
    base = float("nan") if swept else operating_speed(assembly.line, speed)
    corners = assembly.table(4, base)
    across.columns.put(corners, across.values[[0, 0, -1, -1]])
    up.columns.put(corners, up.values[[0, -1, 0, -1]])
    require_steady_base(assembly, corners)
    family = LineFamily(assembly, across, up, base, twisted)

    said = [finding.sentence for finding in left_out("stability_chart", assembly.line)]
    remarks = tuple(s for s in (said_x, said_y, *_idle(family, across, up, "line"), *said) if s)
    return _Task(family, across, up, None if swept else base, assembly.line, remarks)


def _idle(family: ChartFamily, x: Axis, y: Axis, what: str) -> list[str]:
    """Sentences about axes that change nothing."""

    def decisive(x: Array, y: Array) -> Array:
        return family.evaluate(x, y, 1e-12, 1)[0]

    return [f"{own.label} changes nothing in this {what}" for own in (x, y) if moves_nothing(decisive, x, y, own is x)]


def _middle(x: Array, y: Array) -> tuple[float, float]:
    return float(np.median(x)), float(np.median(y))


def _own_task(family: PeriodicLinearFamily, x: AxisRequest, y: AxisRequest) -> _Task:
    across, up = own_axis(family, x, "x"), own_axis(family, y, "y")
    if across.label == up.label:
        raise InputError("stands on both axes", key=across.label, remedy="give y another parameter")
    family.require_period(dict(zip((across.label, up.label), _middle(across.values, up.values), strict=True)))
    own = OwnFamily(family, across.label, up.label, _middle(across.values, up.values))
    return _Task(own, across, up, None, None, tuple(_idle(own, across, up, "family")))


def _patched(
    family: ChartFamily, x: Array, y: Array, tolerance: float, threads: int, tell: Progress
) -> PatchedFunction:
    u, v = family.to_patch(x, True), family.to_patch(y, False)
    box = Box(float(u.min()), float(u.max()), float(v.min()), float(v.max()))
    if box.u0 == box.u1 or box.v0 == box.v1:
        return PatchedFunction((), (box,))

    sampler = family.sampler(box, len(u) * len(v), tolerance / 4, threads)
    return build(sampler.evaluate, sampler.boxes, u, v, tolerance / 4, direct_below=sampler.direct_below, tick=tell)


def _fill(family: ChartFamily, function: PatchedFunction, x: Array, y: Array, tolerance: float, threads: int) -> Pixels:
    """Every pixel, patch by patch in parallel, the rest by direct integration."""
    shape = (len(y), len(x))
    radius, error = np.full(shape, np.nan), np.full(shape, np.nan)
    critical, verdict = np.full(shape, np.nan, dtype=complex), np.full(shape, Verdict.FAILED, dtype=np.int8)
    left = np.ones(shape, dtype=bool)
    u, v = family.to_patch(x, True), family.to_patch(y, False)

    def fill_strip(task: tuple[Patch, Array, slice, slice]) -> None:
        patch, along, rows, columns = task
        found = judge_rows(patch, along, u[columns], v[rows], family.size, family.rigid_body)
        radius[rows, columns], error[rows, columns] = found.radius, found.error
        critical[rows, columns], verdict[rows, columns] = found.critical, found.verdict

    # One patch may cover most of the pixels, so threads share strips.
    tasks = []
    for patch in function.patches:
        rows, columns = _between(v, patch.box.v0, patch.box.v1), _between(u, patch.box.u0, patch.box.u1)
        if rows.stop > rows.start and columns.stop > columns.start:
            width = (columns.stop - columns.start) * len(patch.error)
            along = patch.columns(u[columns])
            tasks += [(patch, along, part, columns) for part in _strips(rows, width)]
            left[rows, columns] = False
    on_threads(fill_strip, tasks, threads)
    r, c = np.nonzero(left)
    for start in range(0, len(r), 65536):
        here = (r[start : start + 65536], c[start : start + 65536])
        values, bounds = family.evaluate(x[here[1]], y[here[0]], tolerance / 4, threads)
        found = judge(np.ascontiguousarray(values.T), np.ascontiguousarray(bounds.T), family.size, family.rigid_body)
        radius[here], error[here], critical[here], verdict[here] = (
            found.radius,
            found.error,
            found.critical,
            found.verdict,
        )
    pixels = Pixels(radius, error, critical, verdict)
    _decide(family, pixels, x, y, tolerance, threads)
    return pixels


def _decide(family: ChartFamily, pixels: Pixels, x: Array, y: Array, tolerance: float, threads: int) -> None:
    """Judge undecided pixels (y, x) anew, in place, from monodromy matrices of their own.

    Stiff and soft shafts together make coefficients so large that their rounding hides roots which the matrix
    still shows; there are few such pixels in most charts.
    """
    rows, columns = np.nonzero(pixels.verdict == Verdict.UNDECIDED)
    if family.rigid_body or not 0 < len(rows) <= family.affordable:
        return
    found = judge_matrices(*family.matrices(x[columns], y[rows], max(tolerance * 1e-3, 1e-13), threads))
    better = found.error < pixels.error[rows, columns]
    here = rows[better], columns[better]
    pixels.radius[here], pixels.error[here] = found.radius[better], found.error[better]
    pixels.critical[here], pixels.verdict[here] = found.critical[better], found.verdict[better]


def _between(axis: Array, low: float, high: float) -> slice:
    """Places of a monotonic axis that lie between two values."""
    inside = np.flatnonzero((axis >= low) & (axis <= high))
    return slice(int(inside[0]), int(inside[-1]) + 1) if len(inside) else slice(0, 0)


def _strips(rows: slice, per_row: int, limit: int = 200_000) -> list[slice]:
    """Rows in strips of at most ``limit`` numbers: bounded memory, and work for every thread's cache."""
    step = max(1, limit // max(per_row, 1))
    return [slice(a, min(a + step, rows.stop)) for a in range(rows.start, rows.stop, step)]


def _pointwise(
    family: ChartFamily, function: PatchedFunction, tolerance: float
) -> Callable[[float, float], ChartPoint]:
    def at(x: float, y: float) -> ChartPoint:
        u, v = float(family.to_patch(np.array(x), True)), float(family.to_patch(np.array(y), False))
        patch = function.find(u, v)
        if patch is not None:
            values, bounds = (
                part(np.array([u]), np.array([v])).reshape(-1, 1) for part in (patch.grid, patch.error_grid)
            )
        else:
            values, bounds = (part.T.copy() for part in family.evaluate(np.array([x]), np.array([y]), tolerance / 4, 1))
        found = judge(values, bounds, family.size, family.rigid_body)
        grid = Pixels(found.radius[None], found.error[None], found.critical[None], found.verdict[None])
        _decide(family, grid, np.array([x]), np.array([y]), tolerance, 1)
        found = Pixels(grid.radius[0], grid.error[0], grid.critical[0], grid.verdict[0])
        return ChartPoint(
            x=x,
            y=y,
            spectral_radius=float(found.radius[0]),
            error_estimate=float(found.error[0]),
            verdict=Verdict(int(found.verdict[0])),
            multipliers=multipliers_of(values[:, 0], family.size, family.rigid_body),
            interpolated=patch is not None,
        )

    return at


def _resampler(
    family: ChartFamily, function: PatchedFunction, tolerance: float, threads: int
) -> Callable[[Array, Array], tuple[Array, Array, NDArray[np.complex128], NDArray[np.int8]]]:
    def resample(x: Array, y: Array) -> tuple[Array, Array, NDArray[np.complex128], NDArray[np.int8]]:
        pixels = _fill(family, function, x, y, tolerance, threads)
        return pixels.radius, pixels.error, pixels.critical, pixels.verdict

    return resample


def _self_checked(chart: StabilityChart, family: ChartFamily, tolerance: float, threads: int) -> StabilityChart:
    """Compare random pixels with direct integration; enlarge the error estimates if one falls short."""
    rng = np.random.default_rng(chart.verdict.size)
    rows, columns = rng.integers(0, len(chart.y), SPOTS), rng.integers(0, len(chart.x), SPOTS)
    values, bounds = family.evaluate(chart.x[columns], chart.y[rows], max(tolerance * 1e-3, 1e-13), threads)
    found = judge(values.T.copy(), bounds.T.copy(), family.size, family.rigid_body)
    off = np.abs(found.radius - chart.spectral_radius[rows, columns])
    allowed = chart.error_estimate[rows, columns] + found.error
    # Without error and without estimate is not off.
    ratio = float(np.nanmax(off / np.maximum(allowed, 1e-300))) if np.isfinite(off).any() else float("nan")
    check = SpotCheck(SPOTS, ratio, float(np.nanmax(off)) if np.isfinite(off).any() else float("nan"))
    if not ratio > 1:
        return replace(chart, spot_check=check)
    return replace(
        chart.with_errors_times(2 * ratio),
        spot_check=check,
        remarks=(
            *chart.remarks,
            f"a spot check was off by {ratio:.1f} times its estimate; all were enlarged",
        ),
    )


def load_chart(path: str | os.PathLike[str], *, family: PeriodicLinearFamily | None = None) -> StabilityChart:
    """Read a chart that ``StabilityChart.save`` wrote; it answers ``at`` and ``zoom`` as before.

    A chart of a family of your own is in the file without its function: give ``family`` again, or regions that
    were not patched are out of reach of ``at`` and ``zoom``.
    """
    from trunnion.results.chart import read_chart

    chart = read_chart(path)
    assert chart.function is not None
    own: ChartFamily | None
    if family is not None:
        own = OwnFamily(family, chart.x_label, chart.y_label, _middle(chart.x, chart.y))
    elif chart.line is None:
        own = PatchesAlone.of(chart.function, chart.period)
    else:
        own = _family_of_line(chart, chart.line)
    if own is None:
        return chart
    return replace(
        chart,
        evaluate_point=_pointwise(own, chart.function, chart.tolerance),
        resample=_resampler(own, chart.function, chart.tolerance, os.cpu_count() or 1),
    )


def _family_of_line(chart: StabilityChart, line: Driveline) -> LineFamily:
    assembly = assemble(line)
    ends = [
        (label, float(values.min()), float(values.max()), 2 if len(values) > 1 else 1)
        for label, values in ((chart.x_parameter, chart.x), (chart.y_parameter, chart.y))
    ]
    (across, _), (up, _) = axis(assembly, ends[0], "x"), axis(assembly, ends[1], "y")
    speed = float("nan") if chart.speed is None else chart.speed
    return LineFamily(assembly, across, up, speed, chart.statically_twisted)
