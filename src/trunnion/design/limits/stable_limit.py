"""The largest value of a parameter up to which a line is stable, over speed, and what else binds.

Along the parameter, at one speed, stability changes only where a boundary function vanishes; ``tongues.rows`` finds all
of these zeros for lines of up to three unknowns, so that every unstable range is known however narrow, and with them
the stable ranges above. Longer lines are sampled. Edges are solved for with integrations of their own at 1e-13.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.design.limits.other_limits import SCAN, Reached, other_limits
from trunnion.design.limits.result import LimitKind, StableLimit
from trunnion.driveline.arguments import one_number, speeds_of
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.driveline.parameters import Parameter
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.released import NOT_ALIKE, refuse_pendulums
from trunnion.errors import InputError
from trunnion.features import left_out
from trunnion.floquet.charts.building import family_for, strategy_named
from trunnion.floquet.charts.stability_chart import ABOUT_STEADY_STATES, Task, family_of_chart
from trunnion.floquet.tongues.boundaries import MOST
from trunnion.floquet.tongues.region import NODES, PIECES, Region, patched, turned, unpatched
from trunnion.floquet.tongues.rows import TongueRow, unknown_row, unstable_intervals
from trunnion.floquet.tongues.rows_by_collisions import SAMPLED_WORDS, sampled_rows
from trunnion.floquet.tongues.tongues import PASSIVE, PATCH_TOLERANCE, task_of
from trunnion.floquet.tongues.windows import StableWindows, stable_windows
from trunnion.results.chart import StabilityChart, require_pixels
from trunnion.results.finding import Finding, Gravity
from trunnion.waiting import OutOfTime, keeps_time, limited, to_the_end

Progress = Callable[[float], None]
HIGHEST = float(np.deg2rad(60.0))
ASIDE = 1e-3
"""Share by which a box about a single speed reaches to either side."""
AT_ONCE, FEW_AT_ONCE = 500, 48
"""Speeds searched together: bounded memory, and steps of progress; with a time limit."""


@keeps_time
def stable_limit(
    line: Driveline | Assembly,
    parameter: str | Parameter,
    speeds: ArrayLike,
    *,
    low: float = 0.0,
    high: float = HIGHEST,
    margin: float = 0.0,
    between: bool = True,
    scan: int = SCAN,
    tolerance: float = PATCH_TOLERANCE,
    about_steady_state: bool = False,
    within: float | None = None,
    progress: Progress | None = None,
) -> StableLimit:
    """The largest stable value of ``parameter`` at each of ``speeds`` [rad/s], the stable ranges above, and what binds.

    Parameters
    ----------
    line : a ``Driveline`` or its ``Assembly``.
    parameter : as for a chart: "HookeJoint 1.angle", "HookeJoint *.angle", "factor of Shaft *.stiffness".
    speeds : one or more input speeds [rad/s].
    low, high : range that is searched, SI units; by default 0 to 60° for angles.
    margin : share by which the range from the lowest to the highest speed is widened at either end for ``between``.
    between : answers for every speed between the lowest and the highest too (``whole`` in the result; see
        ``stable_windows``); False for the speeds alone.
    scan : steps of the grid on which the limits of the description are compared.
    tolerance : of the patches that tell where to look; edges are solved for by themselves.
    about_steady_state : about the line's own periodic motion, as in ``stability_chart``.
    within : seconds that it may take; the limit is unknown at speeds that were not reached, and ``ended`` says so.
    progress : called as progress(share done).

    Undecided points (the spectral radius is 1 to within its error) and marginal ones (undamped lines) do not
    count as unstable.

    Raises
    ------
    InputError : as ``stability_chart``; no speed, or one that is not positive.

    Examples
    --------
    >>> import trunnion as tn
    >>> found = tn.stable_limit(tn.catalogue("two-shaft-cardan"), "HookeJoint 1.angle", [1.601913], high=0.5)
    >>> print(found.sentence)
    Stable at 1.60191 rad/s up to angle of HookeJoint 1 17.1889°, set at 1.60191 rad/s.
    """
    remedy = "tn.rpm(np.linspace(300, 3000, 200))"
    speed = speeds_of(speeds, remedy)
    if not np.all(np.isfinite(speed)) or not np.all(speed > 0):
        raise InputError("must be positive numbers", key="speeds", remedy=remedy)
    if not 0 < one_number(tolerance, "tolerance", "1e-11, say") < 1:
        raise InputError("must lie between 0 and 1", key="tolerance", value=tolerance, remedy="1e-11, say")
    if isinstance(scan, bool) or not isinstance(scan, int | np.integer) or scan < 2:
        raise InputError("must be a whole number of steps, 2 or more", key="scan", value=scan)
    require_pixels(len(speed), int(scan) + 1)
    assembly, report_progress = assemble(line), progress or (lambda share: None)
    refuse_pendulums(assembly.line, NOT_ALIKE)
    ends = float(speed.min()), float(speed.max())
    if ends[0] == ends[1]:
        ends = ends[0] * (1 - ASIDE), ends[1] * (1 + ASIDE)
    task = task_of(
        assembly, (parameter, low, high), ("speed", *ends), None, True, "stable_limit",
        about_steady_state=about_steady_state,
    )  # fmt: skip
    workers = os.cpu_count() or 1
    region = _region(task, len(speed), tolerance, workers, lambda s: report_progress(0.6 * s))
    at = np.unique(np.clip(speed, task.y.values[0], task.y.values[-1]))
    rows, ended = _rows_in_time(region, at)
    report_progress(0.7)
    every = between and len(at) > 1
    end = 0.8 if every else 1.0
    span = float(task.x.values[0]), float(task.x.values[-1])
    others: Reached = (), ""
    whole = None
    try:
        others = other_limits(
            assembly, task.x.columns, at, *span, int(scan), lambda s: report_progress(0.7 + (end - 0.7) * s)
        )
        if every:
            whole = stable_windows(
                assembly,
                parameter,
                low,
                high,
                ends,
                margin=margin,
                about_steady_state=about_steady_state,
                progress=lambda s: report_progress(end + (1 - end) * s),
            )
    except OutOfTime as error:
        ended = error.why
        others = others if others[1] else ((), f"limits of the description are not compared: {ended}")
    report_progress(1.0)
    with to_the_end():
        return replace(_result(assembly, task, region, at, rows, others, whole), ended=ended)


def limit_of_chart(chart: StabilityChart, speeds: ArrayLike = (), *, own: bool = False) -> StableLimit:
    """The limit of a chart's y parameter, by the patches of the chart; other limits are not compared.

    Parameters
    ----------
    chart : of a driveline with the speed along x, freshly computed or read by ``load_chart``.
    speeds : inside the chart's x axis [rad/s]; those outside are moved to its nearest end.
    own : add the chart's own speeds.
    """
    if chart.way == ABOUT_STEADY_STATES:
        raise InputError(
            "is about the line's own motion and has no patches to search", element="chart",
            remedy="ask stable_limit of the line",
        )  # fmt: skip
    if chart.x_label != "speed" or chart.line is None or chart.function is None or min(len(chart.x), len(chart.y)) < 2:
        raise InputError("needs a chart of a driveline with the speed along x", element="chart")
    own_family, workers = family_of_chart(chart), os.cpu_count() or 1
    turned_about = replace(own_family, x=own_family.y, y=own_family.x)
    family = family_for(strategy_named(chart.way), turned_about)
    task = Task(family, turned_about.x, turned_about.y, None, chart.line, ())
    if chart.function.patches:
        region = turned(family, chart.function, workers)
    else:
        region = patched(task.family, task.x.values, task.y.values, PATCH_TOLERANCE, workers, lambda s: None)
    asked = np.clip(np.asarray(speeds, dtype=float), chart.x.min(), chart.x.max())
    at = np.unique(np.concatenate([asked, chart.x] if own else [asked]))
    return _result(assemble(chart.line), task, region, at, _rows(region, at), ((), ""), None)


def _region(task: Task, speeds: int, tolerance: float, workers: int, report_progress: Progress) -> Region:
    """The box to search; few rows of a long line cost less than one patch of its matrices."""
    if (
        task.family.passive
        or not task.family.analytic
        or 2 * task.family.size > MOST
        and speeds * NODES * PIECES < NODES**2
    ):
        return unpatched(task.family, task.x.values, task.y.values, workers)
    return patched(task.family, task.x.values, task.y.values, tolerance, workers, report_progress)


def _rows(region: Region, speed: Array) -> list[TongueRow]:
    """Unstable ranges of the parameter at every speed (speed,)."""
    rows: list[TongueRow] = []
    search = partial(unstable_intervals, region) if region.family.analytic else sampled_rows(region)
    for start in range(0, len(speed), AT_ONCE):
        rows += search(region.family.to_patch(speed[start : start + AT_ONCE], False))
    return rows


def _rows_in_time(region: Region, speed: Array) -> tuple[list[TongueRow], str]:
    """The same, unknown at speeds that a time limit left out, and what ended the search, as a clause.

    With a limit a few speeds at a time, spread over all of them, so that whatever is known covers the range.

    Raises
    ------
    OutOfTime : the time was up before the first of them were known.
    """
    if not limited() or len(speed) <= FEW_AT_ONCE:
        return _rows(region, speed), ""
    parts = -(-len(speed) // FEW_AT_ONCE)
    rows: list[TongueRow | None] = [None] * len(speed)
    ended = ""
    try:
        for first in range(parts):
            for k, row in zip(range(first, len(speed), parts), _rows(region, speed[first::parts]), strict=True):
                rows[k] = row
    except OutOfTime as error:
        if all(row is None for row in rows):
            raise
        ended = error.why
    v = region.family.to_patch(speed, False)
    return [row or unknown_row(region, float(v[k])) for k, row in enumerate(rows)], ended


def _result(
    assembly: Assembly,
    task: Task,
    region: Region,
    speed: Array,
    rows: list[TongueRow],
    others: Reached,
    whole: StableWindows | None,
) -> StableLimit:
    low, high = float(task.x.values[0]), float(task.x.values[-1])
    unstable = tuple(region.in_x(row.low, row.high) for row in rows)
    at_once = np.array([bool(len(row) and row.clipped[0, 0]) for row in rows])
    unknown = tuple(region.in_x(*row.unknown.reshape(-1, 2).T) for row in rows)
    failed = np.array([_begins_unknown(*both) for both in zip(unstable, unknown, strict=True)])
    some = np.array([len(ranges) > 0 for ranges in unstable])
    kind = np.where(~some, LimitKind.BEYOND, np.where(at_once, LimitKind.AT_ONCE, LimitKind.CROSSING))
    kind = np.where(failed, LimitKind.UNKNOWN, kind).astype(np.int8)
    limit = np.array([float(ranges[0, 0]) if len(ranges) else high for ranges in unstable])
    limit[failed] = np.nan
    said = left_out("stable_limit", assembly.line)
    known = {finding.sentence for finding in said}
    notes = tuple(Finding(Gravity.NOTE, f"{r[0].upper()}{r[1:]}") for r in task.remarks if r not in known)
    return StableLimit(
        parameter=task.x.label, unit=task.x.unit, speed=speed, limit=limit, kind=kind, unstable=unstable,
        unknown=unknown, low=low, high=high, complete=region.complete,
        search=_search_words(region), others=others[0], others_search=others[1], whole=whole, findings=(*said, *notes),
        speed_unit=speed_unit(assembly.line),
    )  # fmt: skip


def _begins_unknown(unstable: Array, unknown: Array) -> bool:
    """Whether something of a row is not known that lies below its first unstable range, or the row has none."""
    return bool(len(unknown) and (not len(unstable) or unknown[0, 0] < unstable[0, 0]))


def _search_words(region: Region) -> str:
    if not region.family.analytic:
        return f"stability about the line's own motion: values of the parameter {SAMPLED_WORDS}"
    if region.family.passive:
        return PASSIVE
    if not region.by_coefficients:
        few = "more than three unknowns have no boundary functions that could be searched completely"
        return f"stability sampled along the parameter, edges solved for: {few}, so narrow ranges may be missing"
    if region.uncovered:
        return (
            f"every zero of the boundary functions, but {region.uncovered} parts of the box resisted and were sampled"
        )
    return "every zero of the boundary functions along the parameter was found at each speed, edges solved for"
