"""Stability over any two parameters, as a function known to a stated error everywhere.

The chart samples analytic quantities at the nodes of adaptive Chebyshev patches, interpolates them to the
pixels and finds multipliers there; small regions are evaluated pixel by pixel. At the end it checks itself
at random pixels by direct integration at a much smaller tolerance, and is built in another way where that
check fails (see ``building``). Where its kernels would have to be compiled and NumPy takes less time, NumPy builds it.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from trunnion.arrays import Array, Codes, Complex
from trunnion.driveline.converter_balance import refuse_converters
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import operating_speed, speed_unit
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.first_order import LARGEST_DENSE
from trunnion.equations.released import NOT_ALIKE, refuse_pendulums
from trunnion.equations.steady_base import (
    has_periodic_base,
    refuse_lags,
    require_no_steady_state,
    require_own_motion,
    require_short_ties,
    require_steady_base,
    require_tree,
)
from trunnion.equations.topology import require_period
from trunnion.errors import InputError
from trunnion.features import left_out
from trunnion.floquet.charts.axes import AxisRequest, ChartAxis, axis, check_corners, moves_nothing, user_axis
from trunnion.floquet.charts.building import BuiltChart, build, decide, family_for, fill, strategy_named
from trunnion.floquet.charts.chart_families import ChartFamily, LineFamily
from trunnion.floquet.charts.chart_pixels import judge, multipliers_of, tells_all
from trunnion.floquet.charts.cost_model import (
    compiling_pays,
    instead_of_compiling,
    long_chart_bytes,
    long_chart_seconds,
)
from trunnion.floquet.charts.numpy_chart import MOST_FIRST, NumpyAxisTest, build_with_numpy
from trunnion.floquet.charts.user_families import StoredPatches, UserFamily
from trunnion.numerics.memory import require_estimate
from trunnion.numerics.patches.patches import PatchedFunction
from trunnion.numerics.workers import shared_with, workers_of_client
from trunnion.results.chart import ChartPoint, StabilityChart, is_log, require_pixels
from trunnion.results.verdict import Verdict
from trunnion.systems.family import PeriodicLinearFamily

if TYPE_CHECKING:
    from trunnion.floquet.charts.steady_state_chart import SteadyStateChart

Progress = Callable[[float], None]
ABOUT_STEADY_STATES = "periodic steady states"
"""How ``StabilityChart.way`` names charts about the line's own motion."""
CHART = "stability_chart"
"""The row of the features table that speaks of charts, which show how fast disturbances decay or grow."""
IN_NUMPY, SHARPEST = 0.01, 1e-12
"""Share of the tolerance that is asked for in NumPy: the kernels, too, know their samples that much better."""


def stability_chart(
    line: Driveline | Assembly | PeriodicLinearFamily,
    x: AxisRequest,
    y: AxisRequest,
    *,
    speed: float | str | None = None,
    tolerance: float = 1e-9,
    statically_twisted: bool = True,
    about_steady_state: bool = False,
    threads: int | None = None,
    client: Any = None,
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
    about_steady_state : about the periodic motion that the line really makes, under its loads and joints and without
        its excitations, instead of the motion of rigid shafts. A free–free line with joint angles is always judged
        about it. Every point costs milliseconds; points at which several motions exist are not judged.
    threads : default one per core.
    client : a ``distributed.Client``, with whose workers the integrations of a driveline are shared where they take
        longer than sending them; the chart is the same to the bit. What interpolates and judges pixels stays here,
        and so does a chart about the line's own motion.
    progress : called as progress(share done) from the calling thread.

    Returns
    -------
    StabilityChart, arrays of shape (y, x); ``chart.at(x, y)`` answers anywhere in its box.

    Raises
    ------
    InputError : see ``axes.axis``; both axes the same; no speed.
    ComputationError : the chart's check of itself fails in every way of building it.
    KeyboardInterrupt : passed on; nothing is kept.

    Examples
    --------
    >>> import trunnion as tn
    >>> line = tn.catalogue("two-shaft-cardan")
    >>> tn.stability_chart(line, ("speed", 1.0, 3.0, 20), ("HookeJoint 1.angle", 0.0, 0.5, 10))
    <StabilityChart: stability chart, speed × HookeJoint 1.angle, 20 × 10 points: 193 stable, 7 unstable>
    """
    require_pixels(*(_points_of(request) for request in (x, y)))
    workers = workers_of_client(client)
    if isinstance(line, PeriodicLinearFamily):
        require_no_steady_state(about_steady_state)
    elif about_steady_state or _always_about_steady_state(assemble(line), x, y):
        return _about_steady_states(assemble(line), x, y, speed, tolerance, progress or (lambda share: None))
    task = chart_task(line, x, y, speed, statically_twisted, numpy_only=not compiling_pays())
    if not tolerance > 0 or not np.isfinite(tolerance):
        raise InputError("must be positive and finite", key="tolerance", value=tolerance, remedy="1e-9, say")
    report_progress, built = progress or (lambda share: None), None
    if isinstance(task.family, LineFamily) and not compiling_pays():
        with instead_of_compiling():
            asked = max(tolerance * IN_NUMPY, SHARPEST)
            built = build_with_numpy(task.family, task.x.values, task.y.values, asked, report_progress, MOST_FIRST)
    with shared_with(workers):
        return _chart(task, built, tolerance, statically_twisted, threads, report_progress)


def _always_about_steady_state(assembly: Assembly, x: AxisRequest, y: AxisRequest) -> bool:
    """Whether the line is free–free and has angles, or an axis gives it some."""
    if not assembly.topology.free or assembly.topology.graph:
        return False
    across, up = axis(assembly, x, "x")[0], axis(assembly, y, "y")[0]
    corners = assembly.table(4)
    across.columns.put(corners, across.values[[0, 0, -1, -1]])
    up.columns.put(corners, up.values[[0, -1, 0, -1]])
    return has_periodic_base(assembly, corners)


def _steady_state_task(
    assembly: Assembly, x: AxisRequest, y: AxisRequest, speed: float | str | None, analysis: str
) -> Task:
    """What is to be searched about the line's own motion."""
    across, up, said, base, own = _own_axes(assembly, x, y, speed)
    from trunnion.floquet.charts.steady_state_family import SteadyStateFamily

    family = SteadyStateFamily.about(assembly, across, up, base, own)
    left = (finding.sentence for finding in left_out(analysis, assembly.line))
    remarks = (*said, "judged about the line's own periodic motion, without its excitations", *left)
    return Task(family, across, up, None if np.isnan(base) else base, assembly.line, remarks)


def _own_axes(
    assembly: Assembly, x: AxisRequest, y: AxisRequest, speed: float | str | None
) -> tuple[ChartAxis, ChartAxis, list[str], float, SteadyStateChart]:
    """As ``_axes_of``, and the motions over both axes."""
    require_period(assembly.line, assembly.topology)
    across, up, said, base = _axes_of(assembly, x, y, speed)
    require_own_motion(assembly, _corners(assembly, across, up, base))
    from trunnion.floquet.charts.steady_state_chart import SteadyStateChart

    return across, up, said, base, SteadyStateChart.of(assembly, _request(across), _request(up), base)


def _about_steady_states(
    assembly: Assembly,
    x: AxisRequest,
    y: AxisRequest,
    speed: float | str | None,
    tolerance: float,
    report_progress: Progress,
) -> StabilityChart:
    across, up, said, base, chart = _own_axes(assembly, x, y, speed)
    found = chart.pixels(across.values, up.values, lambda share: report_progress(0.95 * share))
    check = chart.check(found, across.values, up.values)
    report_progress(1.0)
    left = (finding.sentence for finding in left_out(CHART, assembly.line))
    return StabilityChart(
        x=across.values, y=up.values, x_parameter=across.parameter, y_parameter=up.parameter, x_unit=across.unit,
        y_unit=up.unit, spectral_radius=found.every.radius, error_estimate=found.every.error,
        critical_multiplier=found.every.critical, verdict=found.every.verdict,
        speed=None if np.isnan(base) else base, period=chart.period, tolerance=tolerance, statically_twisted=True,
        remarks=(*said, *found.remarks(chart, across.values, up.values), *left), line=assembly.line,
        function=chart.function, evaluate_point=chart.point, resample=chart.resampled,
        spot_check=check if check.points else None, way=ABOUT_STEADY_STATES, unit=speed_unit(assembly.line),
        folds=tuple((y, one.low, one.high) for y, one in found.folds),
        column_folds=tuple((x, one.low, one.high) for x, one in found.column_folds),
    )  # fmt: skip


def _request(own: ChartAxis) -> AxisRequest:
    """An axis as it is asked for: its ends and as many points as are there."""
    low, high = float(own.values[0]), float(own.values[-1])
    return (own.parameter, low, high, len(own.values), own.scale)


def chart_of_report(
    assembly: Assembly, x: AxisRequest, y: AxisRequest, tolerance: float, progress: Progress | None = None
) -> StabilityChart:
    """As ``stability_chart`` of a driveline, in plain NumPy where that takes seconds: nothing is compiled then."""
    report_progress, task = progress or (lambda share: None), chart_task(assembly, x, y, None, True, numpy_only=True)
    assert isinstance(task.family, LineFamily)
    built = build_with_numpy(task.family, task.x.values, task.y.values, tolerance, report_progress)
    return _chart(task, built, tolerance, True, None, report_progress)


def _chart(
    task: Task,
    built: BuiltChart | None,
    tolerance: float,
    twisted: bool,
    threads: int | None,
    report_progress: Progress,
) -> StabilityChart:
    """What was built, by compiled kernels if it is not yet, as a result."""
    workers = threads or os.cpu_count() or 1
    if built is None:
        built = build(task.family, task.x.values, task.y.values, tolerance, workers, report_progress)
    report_progress(1.0)
    x_axis, y_axis, pixels = task.x, task.y, built.pixels
    remarks = [*task.remarks, *built.remarks]
    if isinstance(task.family, UserFamily):
        remarks += task.family.failures(x_axis.values, y_axis.values, pixels.verdict == Verdict.FAILED, tolerance)
    return StabilityChart(
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
        statically_twisted=twisted,
        remarks=tuple(remarks),
        line=task.line,
        unit=speed_unit(task.line) if task.line else "rad/s",
        function=built.function,
        evaluate_point=_pointwise(built.family, built.function, built.tolerance),
        resample=_resampler(built.family, built.function, built.tolerance, workers),
        spot_check=built.check,
        way=built.strategy.name,
    )


def _points_of(request: AxisRequest) -> int:
    """The points an axis asks for, as far as it can be read; what is wrong with it is said later."""
    asked = request[3] if isinstance(request, Sequence) and not isinstance(request, str) and len(request) > 3 else 1
    return int(asked) if isinstance(asked, int | np.integer) else 1


@dataclass(frozen=True)
class Task:
    """What is to be searched: a family over two axes, the speed where neither is it, the line, and what to say."""

    family: ChartFamily
    x: ChartAxis
    y: ChartAxis
    speed: float | None
    line: Driveline | None
    remarks: tuple[str, ...]


def chart_task(
    line: Driveline | Assembly | PeriodicLinearFamily,
    x: AxisRequest,
    y: AxisRequest,
    speed: float | str | None,
    twisted: bool,
    analysis: str = CHART,
    *,
    numpy_only: bool = False,
    about_steady_state: bool = False,
) -> Task:
    """A line or family over two of its parameters, checked; ``analysis`` is whose row of the features table speaks.

    ``numpy_only``: nothing is compiled for it, where the line suits that. ``about_steady_state`` as of
    ``stability_chart``.

    Raises
    ------
    InputError : see ``stability_chart``.
    """
    if not isinstance(line, PeriodicLinearFamily):
        if about_steady_state or _always_about_steady_state(assemble(line), x, y):
            return _steady_state_task(assemble(line), x, y, speed, analysis)
        return _line_task(line, x, y, speed, twisted, analysis, numpy_only)
    require_no_steady_state(about_steady_state)
    if speed is not None:
        raise InputError("belongs to drivelines", key="speed", value=speed, remedy="a family has its own parameters")
    return _user_task(line, x, y)


def _line_task(
    line: Driveline | Assembly,
    x: AxisRequest,
    y: AxisRequest,
    speed: float | str | None,
    twisted: bool,
    analysis: str,
    numpy_only: bool,
) -> Task:
    assembly = assemble(line)
    refuse_converters(assembly.line, "charts do")
    require_period(assembly.line, assembly.topology)
    across, up, clipped, base = _axes_of(assembly, x, y, speed)
    corners = _corners(assembly, across, up, base)
    require_steady_base(assembly, corners)
    if has_periodic_base(assembly, corners):
        require_tree(assembly, "charts do")
    refuse_pendulums(assembly.line, NOT_ALIKE)
    family = family_of(assembly, across, up, base, twisted)
    _refuse_too_long(family)
    if (straight := family.of_straight) is not None:
        refuse_lags(assembly, straight, growing=analysis != CHART)

    said = [finding.sentence for finding in left_out(analysis, assembly.line)]
    remarks = (*clipped, *_idle(family, across, up, "line", numpy_only), *said)
    return Task(family, across, up, None if np.isnan(base) else base, assembly.line, remarks)


def family_of(assembly: Assembly, x: ChartAxis, y: ChartAxis, speed: float, twisted: bool) -> LineFamily:
    """A line over two axes, as what integrates it takes it."""
    if not assembly.topology.graph:
        return LineFamily(assembly, x, y, speed, twisted)
    from trunnion.floquet.charts.tied_family import TiedLineFamily

    return TiedLineFamily(assembly, x, y, speed, twisted)


def _axes_of(
    assembly: Assembly, x: AxisRequest, y: AxisRequest, speed: float | str | None
) -> tuple[ChartAxis, ChartAxis, list[str], float]:
    """Both axes, what was clipped of them, and the speed [rad/s] where neither is it, else NaN."""
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
    check_corners(assembly, across, up)
    swept = across.is_speed or up.is_speed
    if swept and speed is not None:
        raise InputError("is an axis already", key="speed", value=speed, remedy="leave speed out")
    base = float("nan") if swept else operating_speed(assembly.line, speed)
    return across, up, [said for said in (said_x, said_y) if said], base


def _corners(assembly: Assembly, across: ChartAxis, up: ChartAxis, base: float) -> Array:
    """Packed numbers (4, column) at the corners of a chart."""
    corners = assembly.table(4, base)
    across.columns.put(corners, across.values[[0, 0, -1, -1]])
    up.columns.put(corners, up.values[[0, -1, 0, -1]])
    return corners


def _refuse_too_long(family: LineFamily) -> None:
    """Refuse a chart of a long line that would not end, or fill the memory."""
    size, pixels = family.size, len(family.x.values) * len(family.y.values)
    require_short_ties(family.assembly)
    if size <= LARGEST_DENSE or family.assembly.topology.graph:
        return
    ends = family.x.values[[0, 0, -1, -1]], family.y.values[[0, -1, 0, -1]]
    seconds = long_chart_seconds(size, pixels, family.phase(*ends), family.needs_stages)
    remedy = "ask for fewer points, join neighbouring parts, or ask stability() at single speeds"
    require_estimate(size, f"a chart of {pixels} points", seconds, long_chart_bytes(size, pixels), remedy=remedy)


def _idle(family: ChartFamily, x: ChartAxis, y: ChartAxis, what: str, numpy_only: bool = False) -> list[str]:
    """Sentences about axes that change nothing."""

    def decisive(x: Array, y: Array) -> Array:
        return family.evaluate(x, y, 1e-12, 1)[0]

    differ = family.differ
    if numpy_only and isinstance(family, LineFamily) and family.uncompiled:
        decisive, differ = NumpyAxisTest(family).decisive, NumpyAxisTest(family).differ
    return [
        f"{own.label} changes nothing in this {what}"
        for own in (x, y)
        if moves_nothing(decisive, x, y, own is x, differ)
    ]


def _middle(x: Array, y: Array) -> tuple[float, float]:
    return float(np.median(x)), float(np.median(y))


def _user_task(family: PeriodicLinearFamily, x: AxisRequest, y: AxisRequest) -> Task:
    """A family of one's own over two of its parameters, checked."""
    across, up = user_axis(family, x, "x"), user_axis(family, y, "y")
    if across.label == up.label:
        raise InputError("stands on both axes", key=across.label, remedy="give y another parameter")
    family.require_period(dict(zip((across.label, up.label), _middle(across.values, up.values), strict=True)))
    own = UserFamily(family, across.label, up.label, _middle(across.values, up.values))
    return Task(own, across, up, None, None, tuple(_idle(own, across, up, "family")))


def _pointwise(
    family: ChartFamily, function: PatchedFunction, tolerance: float
) -> Callable[[float, float], ChartPoint]:
    def at(x: float, y: float) -> ChartPoint:
        u, v = float(family.to_patch(np.array(x), True)), float(family.to_patch(np.array(y), False))
        where, patch = (np.array([x]), np.array([y])), function.find(u, v)
        if patch is not None:
            values, bounds = (
                part(np.array([u]), np.array([v])).reshape(-1, 1) for part in (patch.grid, patch.error_grid)
            )
        else:
            values, bounds = (part.T.copy() for part in family.evaluate(*where, tolerance / 4, 1))
        found = judge(values, bounds, family.size, family.set_aside)
        # Patches of a stiff line tell its largest multipliers alone.
        every = values if tells_all(values, family.size) else family.evaluate(*where, tolerance / 4, 1)[0].T
        found = found.shaped((1, 1))
        decide(family, found, *where, tolerance, 1)
        return ChartPoint(
            x=x,
            y=y,
            spectral_radius=found.radius.item(),
            error_estimate=found.error.item(),
            verdict=Verdict(found.verdict.item()),
            multipliers=multipliers_of(every[:, 0], family.size, family.set_aside),
            interpolated=patch is not None,
        )

    return at


def _resampler(
    family: ChartFamily, function: PatchedFunction, tolerance: float, threads: int
) -> Callable[[Array, Array], tuple[Array, Array, Complex, Codes]]:
    return lambda x, y: fill(family, function, x, y, tolerance, threads)


def load_chart(path: str | os.PathLike[str], *, family: PeriodicLinearFamily | None = None) -> StabilityChart:
    """Read a chart that ``StabilityChart.save`` wrote; it answers ``at`` and ``zoom`` as before.

    A chart of a family of your own is in the file without its function: give ``family`` again, or regions that
    were not patched are out of reach of ``at`` and ``zoom``.

    Parameters
    ----------
    path : of the file.
    family : the function it was made from, where that is one's own.

    Examples
    --------
    >>> import trunnion as tn
    >>> from tempfile import TemporaryDirectory
    >>> line = tn.catalogue("two-shaft-cardan")
    >>> chart = tn.stability_chart(line, ("speed", 1.0, 3.0, 20), ("HookeJoint 1.angle", 0.0, 0.5, 10))
    >>> with TemporaryDirectory() as folder:
    ...     chart.save(f"{folder}/chart.npz")
    ...     print(tn.load_chart(f"{folder}/chart.npz").at(2.0, 0.3))
    stable: spectral radius 0.999400 (error 8e-11)
    """
    from trunnion.results.chart import read_chart

    chart = read_chart(path)
    assert chart.function is not None
    own: ChartFamily | None
    if family is not None:
        own = UserFamily(family, chart.x_label, chart.y_label, _middle(chart.x, chart.y))
    elif chart.line is None:
        own = StoredPatches(chart) if chart.function.patches else None
    elif chart.way == ABOUT_STEADY_STATES:
        return _read_about_steady_states(chart)
    else:
        own = family_of_chart(chart)
    if own is None:
        return chart
    way = strategy_named(chart.way)
    own, tolerance = family_for(way, own), chart.tolerance * way.share
    return replace(
        chart,
        evaluate_point=_pointwise(own, chart.function, tolerance),
        resample=_resampler(own, chart.function, tolerance, os.cpu_count() or 1),
    )


def _read_about_steady_states(chart: StabilityChart) -> StabilityChart:
    """A chart read from a file that answers as before."""
    from trunnion.floquet.charts.steady_state_chart import SteadyStateChart

    assert chart.line is not None
    requests = [
        (label, float(values[0]), float(values[-1]), len(values), "log" if is_log(values) else "linear")
        for label, values in ((chart.x_parameter, chart.x), (chart.y_parameter, chart.y))
    ]
    speed = float("nan") if chart.speed is None else chart.speed
    own = SteadyStateChart.of(assemble(chart.line), requests[0], requests[1], speed)
    return replace(chart, evaluate_point=own.point, resample=own.resampled)


def family_of_chart(chart: StabilityChart) -> LineFamily:
    """The family behind a chart of a driveline."""
    assert chart.line is not None
    assembly = assemble(chart.line)
    ends = [
        (label, float(values.min()), float(values.max()), 2 if len(values) > 1 else 1)
        for label, values in ((chart.x_parameter, chart.x), (chart.y_parameter, chart.y))
    ]
    (across, _), (up, _) = axis(assembly, ends[0], "x"), axis(assembly, ends[1], "y")
    speed = float("nan") if chart.speed is None else chart.speed
    return family_of(assembly, across, up, speed, chart.statically_twisted)
