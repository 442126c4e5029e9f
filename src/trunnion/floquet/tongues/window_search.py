"""The search behind stable windows: regions by rows, then columns that must find no other.

A window is claimed only where complete columns confirm it: at both ends of the speeds, where every region meets one
that crosses a side of the box; at the speeds of resonances, where regions lie that cross none; at the tips found; and
at some between. Where a column is unstable and no region accounts for it, rows are put there until one does.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from trunnion.arrays import Array
from trunnion.floquet.charts.axes import lowest_speed
from trunnion.floquet.charts.chart_families import LineFamily
from trunnion.floquet.charts.stability_chart import Task
from trunnion.floquet.charts.steady_state_family import SteadyStateFamily
from trunnion.floquet.tongues.boundaries import MOST
from trunnion.floquet.tongues.boundary_traces import Search
from trunnion.floquet.tongues.columns import (
    Column,
    ColumnSearch,
    columns_as_rows,
    complete_columns,
    sampled_columns,
)
from trunnion.floquet.tongues.levels import levels_of, own_value
from trunnion.floquet.tongues.region import Region, patched, unpatched
from trunnion.floquet.tongues.result import Tongues
from trunnion.floquet.tongues.rows import unstable_intervals
from trunnion.floquet.tongues.rows_by_collisions import (
    WORDS,
    RowFamily,
    rows_by_collisions,
    sampled_rows,
    tops,
)
from trunnion.floquet.tongues.shapes import lost
from trunnion.floquet.tongues.tongues import (
    PASSIVE,
    PATCH_TOLERANCE,
    ROWS,
    Progress,
    Regions,
    described,
    regions_on,
)
from trunnion.waiting import OutOfTime, to_the_end

ROUNDS = 6
"""Times that rows are put where columns are unstable and no region is known."""
EVENLY, SAMPLED = 17, 9
"""Columns at equal steps of the speed, and those of lines whose columns are sampled."""
ROWS_OF_LONG_LINES = 17
QUICK_TURNS = 10.0
"""Times the slowest speed of charts from which boxes of short lines are patched."""
AT_LEVELS = 4
"""Every so many levels the resonances that may open are looked for; every other time each has a column."""
APART = 1e-4
"""Columns at resonances nearer to each other than this share of the box are one."""
FINER = 2
"""Places of a sampled column for every row."""
SLIVER = 1e-9
"""What a column has beyond a region's end by less than this share of the box is the error of either."""
UNNAMED, UNKNOWN = "a region that rows do not show", "no answer"
"""Region of an end that only columns found, and of one beyond which it could not be told whether the motion grows."""


@dataclass(frozen=True)
class SearchedColumn:
    """A column at the speed ``x`` [rad/s]; ``left_out``: from where to where, in y, it is unstable or unknown beyond
    the regions found, and which of the two."""

    x: float
    left_out: tuple[tuple[float, float, str], ...]


@dataclass(frozen=True)
class _SearchAxes:
    """How a box is searched along rows and along columns."""

    region: Region
    rows: Search
    columns: ColumnSearch
    words: Callable[[str, int], str]


def searched(task: Task, rows: int | None, report_progress: Progress) -> tuple[Tongues, list[SearchedColumn], str]:
    """Regions over speed and a parameter of a line, the columns that confirm them, and what ended the search before it
    was done, as a clause: without columns nothing is confirmed.

    Raises
    ------
    OutOfTime : the time was up before the rows were searched.
    """
    family = task.family
    assert isinstance(family, LineFamily)
    if rows is None:
        rows = ROWS if _completely(task, family) else ROWS_OF_LONG_LINES
    values = levels_of(task.y, rows, own_value(family.assembly, task.y))
    levels = np.sort(family.to_patch(values, False))
    ways = _ways(task, family, levels, lambda s: report_progress(0.3 * s))
    some = np.unique(np.append(levels[::AT_LEVELS], levels[-1]))
    met = [RowFamily(family).met(float(y)) for y in ways.region.y(some)]
    # A sampled column costs far more than a row, and such rows look at every meeting themselves.
    resonances = np.concatenate(
        [speed for speed, _ in met[::AT_LEVELS] if ways.region.by_coefficients] or [np.zeros(0)]
    )
    levels = np.unique(np.concatenate([levels, tops(some, met)]))
    regions = regions_on(ways.region, ways.rows, levels, lambda s: report_progress(0.3 + 0.3 * s))
    columns: list[Column] = []
    ended = ""
    try:
        for k in range(ROUNDS):
            if len(places := np.setdiff1d(_places(ways.region, regions, resonances), [column.u for column in columns])):
                columns += ways.columns(places)
            left_out = [part for column in columns for part in _left_out(ways.region, regions, column)]
            wanted = np.unique([(a + b) / 2 for a, b, _ in left_out])
            report_progress(0.6 + 0.3 * (k + 1) / ROUNDS)
            if not len(wanted):
                break
            regions = regions_on(ways.region, ways.rows, wanted, lambda s: None, regions.rows)
    except OutOfTime as error:
        ended = error.why
    words = ways.words
    with to_the_end():
        found = described(task, ways.region, ways.rows, regions, lambda apart, traces: words(apart, len(columns)))
        seen = [_seen(ways.region, regions, column) for column in columns]
    report_progress(1.0)
    return found, seen, ended


def _completely(task: Task, family: LineFamily) -> bool:
    """Whether the box is patched, in which rows and columns are searched for every zero: of short lines whose shafts
    are not so stiff that a slow turn spans many of their cycles, which takes minutes."""
    slowest = float(np.min(task.x.values))
    return family.analytic and 2 * family.size <= MOST and slowest >= QUICK_TURNS * lowest_speed(family.assembly)


def _ways(task: Task, family: LineFamily, levels: Array, report_progress: Callable[[float], None]) -> _SearchAxes:
    threads = os.cpu_count() or 1
    if family.passive:
        region = unpatched(family, task.x.values, task.y.values, threads)
        return _SearchAxes(region, partial(unstable_intervals, region), lambda u: [], lambda apart, columns: PASSIVE)
    if not _completely(task, family):
        region = unpatched(family, task.x.values, task.y.values, threads)
        finer = np.interp(np.arange(FINER * (len(levels) - 1) + 1) / FINER, np.arange(len(levels)), levels)
        columns = sampled_columns(region, finer)
        if isinstance(family, SteadyStateFamily):
            columns = columns_as_rows(sampled_rows(unpatched(family.turned, task.y.values, task.x.values, threads)))
        return _SearchAxes(
            region, rows_by_collisions(region, family), columns,
            lambda apart, columns: f"{apart} {WORDS}; columns were sampled at {columns} speeds",
        )  # fmt: skip
    region = patched(family, task.x.values, task.y.values, PATCH_TOLERANCE, threads, report_progress)
    return _SearchAxes(
        region, partial(unstable_intervals, region), complete_columns(region),
        lambda apart, columns: _in_words(region, apart, columns),
    )  # fmt: skip


def _in_words(region: Region, apart: str, columns: int) -> str:
    both = f"{apart} and columns at {columns} speeds"
    if region.uncovered:
        return f"{both} were searched; {region.uncovered} parts of the box resisted and were sampled"
    return f"{both} were searched completely; a region that meets neither is not listed"


def _places(region: Region, regions: Regions, resonances: Array) -> Array:
    """Places u of columns: both ends, tips, speeds of resonances, and some evenly between."""
    family, box = region.family, region.box
    x = np.sort(region.x(np.array([box.u0, box.u1])))
    even = family.to_patch(np.linspace(x[0], x[1], EVENLY if region.by_coefficients else SAMPLED)[1:-1], True)
    tips = [tip[0] for shape in regions.shaped for tip in shape.tips if tip is not None]
    met = np.sort(family.to_patch(resonances, True))
    met = met[np.diff(met, prepend=-np.inf) > APART * (box.u1 - box.u0)]
    every = np.concatenate([[box.u0, box.u1], even, tips, met])
    return np.unique(every[(every >= box.u0) & (every <= box.u1)])


def _left_out(region: Region, regions: Regions, column: Column) -> list[tuple[float, float, str]]:
    """Parts, in v, of the unstable and unknown ranges of a column that no region covers."""
    sliver = SLIVER * (region.box.v1 - region.box.v0)
    known = [(low - sliver, high + sliver) for low, high in _covered(regions)]
    parts = [(a, b, UNNAMED) for a, b in column.unstable.tolist()]
    # Between two zeros the verdict does not change: a row that crosses there has decided it, or is unknown itself.
    heights = np.array([row.v for row in regions.rows])
    parts += [(a, b, UNKNOWN) for a, b in column.unknown.tolist() if not np.any((heights >= a) & (heights <= b))]
    return [(a, b, name) for begin, end, name in parts for a, b in _without(begin, end, known)]


def _covered(regions: Regions) -> list[tuple[float, float]]:
    """Ranges of v, by their low ends, over which regions reach or nothing is known."""
    covered = [(float(shape.v.min()), float(shape.v.max())) for shape in regions.shaped]
    covered += [(min(end.last, end.beyond), max(end.last, end.beyond)) for end in lost(regions.shaped)]
    rows = regions.rows
    for k, row in enumerate(rows):
        if len(row.unknown):
            covered.append((rows[max(k - 1, 0)].v, rows[min(k + 1, len(rows) - 1)].v))
    return sorted(covered)


def _without(begin: float, end: float, covered: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """What of a range, which may be a single place, is not covered."""
    left, at = [], begin
    for low, high in covered:
        if high <= at or low > end:
            continue
        if low > at:
            left.append((at, low))
        at = high
    if at < end or at == begin:
        left.append((at, end))
    return left


def _seen(region: Region, regions: Regions, column: Column) -> SearchedColumn:
    parts = [(*sorted(region.y(np.array([a, b])).tolist()), name) for a, b, name in _left_out(region, regions, column)]
    return SearchedColumn(float(region.x(np.array(column.u))), tuple(parts))
