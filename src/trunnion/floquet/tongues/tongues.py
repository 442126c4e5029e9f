"""Every instability region in a box, as smooth curves with the resonance that names it.

Rows y = const are searched from end to end (``rows``), joined into tongues (``shapes``), and closed at their tips
(``ridges``). All that is printed of a tongue is solved for with integrations of its own at 1e-13; the patches only tell
where to look.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.equations.coefficients import Assembly
from trunnion.errors import ComputationError, InputError
from trunnion.floquet.charts.chart_families import LineFamily
from trunnion.floquet.charts.stability_chart import Task, chart_task
from trunnion.floquet.charts.steady_state_family import SteadyStateFamily
from trunnion.floquet.stability.stability import stability
from trunnion.floquet.tongues.boundary_traces import HALVINGS, BoundaryTrace, Search, joined
from trunnion.floquet.tongues.from_resonances import followed, in_words
from trunnion.floquet.tongues.levels import levels_of, own_value
from trunnion.floquet.tongues.naming import resonances
from trunnion.floquet.tongues.region import FAINT, Region, patched, unpatched
from trunnion.floquet.tongues.result import Tongue, Tongues, Unknown
from trunnion.floquet.tongues.ridges import ridge
from trunnion.floquet.tongues.rows import InstabilityKind, TongueRow, unstable_intervals
from trunnion.floquet.tongues.rows_by_collisions import SAMPLED_WORDS, WORDS, rows_by_collisions, sampled_rows
from trunnion.floquet.tongues.shapes import ClosedTrace, lost, shapes
from trunnion.modes.resonance_speeds import Resonance
from trunnion.results.quantity_axes import QuantityAxis
from trunnion.results.words import Words
from trunnion.systems.family import PeriodicLinearFamily

Range = Sequence[object]
Progress = Callable[[float], None]
Said = Callable[[str, list[BoundaryTrace]], str]
"""How rows were searched, from how many there are and how far apart, and from the strands found."""

ROWS = 65
PATCH_TOLERANCE = 1e-11
PASSIVE = (
    "nothing in the line varies with the angle and nothing feeds energy into it, looked at all over the box, its edges "
    "and corners included: nothing grows"
)
FASTEST = 5
"""Rows of a tongue that grow fastest in their middle, on which its largest growth rate is looked for."""


def tongues(
    line: Driveline | Assembly | PeriodicLinearFamily,
    x: Range,
    y: Range,
    *,
    speed: float | str | None = None,
    rows: int = ROWS,
    statically_twisted: bool = True,
    about_steady_state: bool = False,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Tongues:
    """All instability regions in a box of two parameters.

    Parameters
    ----------
    line : a driveline, or a ``PeriodicLinearFamily`` of your own.
    x, y : ``(parameter, low, high)``, parameters as of a chart, SI units. Tongues are followed along y: take an angle
        or a damping for it, and the speed for x.
    speed : input speed [rad/s] where neither axis is the speed; default the operating speed of the file.
    rows : values of y searched to begin with, more where tongues are born, close or meet.
    statically_twisted : as in ``stability``.
    about_steady_state : about the line's own periodic motion, as in ``stability_chart``.
    threads : default one per core.
    progress : called as progress(share done).

    Up to three unknowns every row is searched completely: every change of stability is a zero of one of three analytic
    functions, and their zeros on a row are all found. Longer lines are sampled, and so are those that are judged about
    their own motion. ``search`` in the result says which.

    Raises
    ------
    InputError : see ``stability_chart``; fewer than three rows.

    Examples
    --------
    >>> import trunnion as tn
    >>> line = tn.catalogue("two-shaft-cardan")
    >>> found = tn.tongues(line, ("speed", 1.5, 1.7), ("HookeJoint 1.angle", 0.05, 0.5), rows=9)
    >>> print(str(found).splitlines()[1])
      1  subharmonic ω₂: closes below at input speed 1.61804 rad/s, angle of HookeJoint 1 6.88441°; grows by up to
      0.04468 1/s
    """
    if isinstance(rows, bool) or not isinstance(rows, int | np.integer) or rows < 3:
        raise InputError("must be a whole number, 3 or more", key="rows", value=rows)
    task = task_of(line, x, y, speed, statically_twisted, "tongues", about_steady_state=about_steady_state)
    workers, report_progress = threads or os.cpu_count() or 1, progress or (lambda share: None)
    if task.family.analytic:
        region = patched(
            task.family, task.x.values, task.y.values, PATCH_TOLERANCE, workers, lambda s: report_progress(0.3 * s)
        )
    else:
        region = unpatched(task.family, task.x.values, task.y.values, workers)
    own = own_value(task.family.assembly, task.y) if isinstance(task.family, LineFamily) else None
    levels = np.sort(task.family.to_patch(levels_of(task.y, int(rows), own), False))
    search, said = _search(region)
    regions = regions_on(region, search, levels, lambda s: report_progress(0.3 + 0.6 * s))
    found = described(task, region, search, regions, said)
    report_progress(1.0)
    return found


@dataclass(frozen=True)
class Regions:
    """Regions as strands closed at their tips, and all ``rows`` that were searched for them."""

    shaped: list[ClosedTrace]
    rows: list[TongueRow]


def regions_on(
    region: Region, search: Search, levels: Array, report_progress: Progress, known: Sequence[TongueRow] = ()
) -> Regions:
    """Regions that meet the rows ``levels`` or those ``known``, with as many rows between as it takes to close them."""
    traces, rows = joined(search, levels, lambda s: report_progress(0.9 * s), known)
    shaped = shapes(region, search, traces)
    for _ in range(HALVINGS):
        if not len(open_ends := lost(shaped)):
            break
        between = np.unique([(end.last + end.beyond) / 2 for end in open_ends])
        traces, rows = joined(search, between, lambda s: None, rows)
        shaped = shapes(region, search, traces)
    report_progress(1.0)
    return Regions(shaped, rows)


def described(task: Task, region: Region, search: Search, regions: Regions, said: Said) -> Tongues:
    """The result: names, growth rates and what was searched."""
    shaped, searched = regions.shaped, regions.rows
    places: dict[BoundaryTrace | None, int] = {s.trace: k for k, s in enumerate(shaped)}
    growths, names = _growths(region, shaped), _names(region, shaped)
    find = _finder(region, search)
    found = [_tongue(task, region, find, s, g, n, places) for s, g, n in zip(shaped, growths, names, strict=True)]
    steps = np.diff([float(region.y(np.array(row.v))) for row in searched])
    undecided, open_ends = _unknown(region, searched), _open_ends(region, shaped)
    unit = speed_unit(task.line) if task.line else None
    across, up = (Words(unit).parameter(axis.label, axis.unit) for axis in (task.x, task.y))
    apart = float(np.abs(steps).max())
    first = said(f"{len(searched)} rows, at most {up.number(apart, 3)} apart,", [shape.trace for shape in shaped])
    return Tongues(
        tongues=_numbered(found), x_label=task.x.label, y_label=task.y.label, x_unit=task.x.unit, y_unit=task.y.unit,
        x_range=(float(task.x.values[0]), float(task.x.values[-1])),
        y_range=(float(task.y.values[0]), float(task.y.values[-1])), rate_unit="1/s" if task.line is not None else "1",
        rows=len(searched), row_step=apart,
        complete=region.complete and not undecided and not open_ends,
        search=first + _faint_words(shaped) + _unknown_words(undecided, across, up) + _open_words(open_ends, up),
        unknown=tuple(sorted((*undecided, *open_ends), key=lambda place: (place.y, place.x))), line=task.line,
        remarks=task.remarks, find=find, unit=unit,
    )  # fmt: skip


def task_of(
    line: Driveline | Assembly | PeriodicLinearFamily,
    x: Range,
    y: Range,
    speed: float | str | None,
    twisted: bool,
    analysis: str,
    *,
    about_steady_state: bool = False,
) -> Task:
    """What is to be searched, checked; ranges are ``(parameter, low, high)``."""
    for key, request in (("x", x), ("y", y)):
        if isinstance(request, str) or not isinstance(request, Sequence) or len(request) != 3:
            remedy = f'write {key}=("speed", 10, 200)'
            raise InputError("must be (parameter, low, high)", key=key, value=request, remedy=remedy)
    return chart_task(line, (*x, 2), (*y, 2), speed, twisted, analysis, about_steady_state=about_steady_state)


def rows_in_words(region: Region, apart: str) -> str:
    """How rows ``apart`` were searched."""
    if not region.by_coefficients:
        few = "more than three unknowns have no boundary functions that could be searched completely"
        return (
            f"{apart} were sampled ({few}), and looked at closely wherever two multipliers meet: both searches are "
            "heuristics, so narrow regions may be missing"
        )
    if region.uncovered:
        return f"{apart} were searched; {region.uncovered} parts of the box resisted and were sampled"
    return f"{apart} were searched completely; a region that lies wholly between two rows is not listed"


def _unknown(region: Region, rows: list[TongueRow]) -> tuple[Unknown, ...]:
    """Where rows could not be decided, each with the rows next to it: what lies between is not known either."""
    found = []
    for k, row in enumerate(rows):
        beside = (rows[max(k - 1, 0)].v, rows[min(k + 1, len(rows) - 1)].v)
        low, high = sorted(float(region.y(np.array(v))) for v in beside)
        ends = [(float(a), float(b)) for a, b in region.in_x(*row.unknown.T)]
        found += [Unknown(float(region.y(np.array(row.v))), x, (low, high)) for x in ends]
    return tuple(sorted(found, key=lambda place: (place.y, place.x)))


def _unknown_words(unknown: tuple[Unknown, ...], across: QuantityAxis, up: QuantityAxis) -> str:
    if not unknown:
        return ""
    rows, first = len({place.y for place in unknown}), unknown[0]
    return (
        f"; on {rows} of them it could not be told whether the motion grows, first at "
        f"{up.value(first.y)} for {across.said(np.array(first.x))}"
    )


def _faint_words(shaped: list[ClosedTrace]) -> str:
    if not any(any(shape.fades) for shape in shaped):
        return ""
    return f"; without damping, what grows by less than {FAINT:g} a period cannot be told from what does not grow"


def _open_ends(region: Region, shaped: list[ClosedTrace]) -> tuple[Unknown, ...]:
    """Ends of regions that were not found: between their last row and the next nothing is known."""
    found = []
    for end in lost(shaped):
        y, beyond = (float(region.y(np.array(v))) for v in (end.last, end.beyond))
        ((low, high),) = region.in_x(np.array([end.low]), np.array([end.high])).tolist()
        found.append(Unknown(y, (low, high), (min(y, beyond), max(y, beyond))))
    return tuple(found)


def _open_words(open_ends: tuple[Unknown, ...], up: QuantityAxis) -> str:
    if not open_ends:
        return ""
    first, many = open_ends[0], "1 region" if len(open_ends) == 1 else f"{len(open_ends)} regions"
    return f"; where {many} end was not found, first between {up.said(np.array(first.between))}"


def _search(region: Region) -> tuple[Search, Said]:
    """How rows are searched, and what there is to say of it when tongues are known."""
    alone = ""
    if region.family.passive:
        return partial(unstable_intervals, region), lambda apart, traces: PASSIVE
    if isinstance(region.family, SteadyStateFamily):
        rows = rows_by_collisions(region, region.family) if region.family.x.is_speed else sampled_rows(region)
        words = WORDS if region.family.x.is_speed else SAMPLED_WORDS
        return rows, lambda apart, traces: f"{apart} {words}"
    if not region.by_coefficients:
        found = followed(region)
        if found is not None:
            return (
                found.rows,
                lambda apart, traces: f"{rows_in_words(region, apart)}; {in_words(found, [s.by for s in traces])}",
            )
        line = isinstance(region.family, LineFamily)
        why = "x is not a speed" if line else "a family of your own has no straight line"
        alone = f"; resonances were not followed, as {why}"
    return lambda v: unstable_intervals(region, v), lambda apart, traces: rows_in_words(region, apart) + alone


def _finder(region: Region, search: Search) -> Callable[[float], Array]:
    def find(y: float) -> Array:
        v = float(region.family.to_patch(np.array(y), False))
        row = search(np.array([v]))[0]
        return region.in_x(row.low, row.high)

    return find


def _growths(region: Region, shapes: list[ClosedTrace]) -> list[tuple[float, tuple[float, float]]]:
    """The largest growth rate on the rows of each tongue and where it is."""
    owner = np.concatenate([np.full(len(s.v), k) for k, s in enumerate(shapes)] or [np.zeros(0)])
    v, low, high = (
        np.concatenate([getattr(s, part) for s in shapes] or [np.zeros(0)]) for part in ("v", "low", "high")
    )
    rough = _rate(region, (low + high) / 2, v, np.maximum(region.above_one((low + high) / 2, v), 0.0))
    own = [np.flatnonzero(owner == k) for k in range(len(shapes))]
    pick = np.concatenate([o[np.argsort(-rough[o])[:FASTEST]] for o in own] or [np.zeros(0, dtype=np.intp)])
    u, top, _ = ridge(region, low[pick], high[pick], v[pick])
    rate, x, y = _rate(region, u, v[pick], top), region.x(u), region.y(v[pick])
    found = []
    for k in range(len(shapes)):
        mine = np.flatnonzero(owner[pick] == k)
        best = mine[int(np.argmax(rate[mine]))]
        found.append((float(rate[best]), (float(x[best]), float(y[best]))))
    return found


def _rate(region: Region, u: Array, v: Array, over: Array) -> Array:
    """Growth rates [1/s] at points where ρ − 1 is ``over``."""
    family = region.family
    speed = family.table(region.x(u), region.y(v))[:, 0] if isinstance(family, LineFamily) else 1.0
    return np.asarray(np.log1p(over) / family.period * speed)


def _tongue(
    task: Task,
    region: Region,
    find: Callable[[float], Array],
    shape: ClosedTrace,
    growth: tuple[float, tuple[float, float]],
    named: Resonance | None,
    places: dict[BoundaryTrace | None, int],
) -> Tongue:
    trace = shape.trace
    y = _snapped(region.y(shape.v), task.y.values)
    ends = _snapped(np.sort(np.stack([region.x(shape.low), region.x(shape.high)]), axis=0), task.x.values)
    tip, top = (_point(region, t) for t in shape.tips)
    order = np.argsort(y, kind="stable")
    falling = bool(y[0] > y[-1])
    if falling:
        tip, top = top, tip
    return Tongue(
        number=places[trace], kind=str(InstabilityKind(trace.intervals[0].kind)), resonance=named, y=y[order],
        low=ends[0][order], high=ends[1][order], tip=tip if tip is not None else top,
        top=top if tip is not None else None, growth_rate=growth[0],
        growth_at=growth[1], joins=places.get(trace.into[1]), parts=places.get(trace.into[0]),
        cut=_cut(task, region, trace), fades=_fades(shape, falling), find=find,
    )  # fmt: skip


def _fades(shape: ClosedTrace, falling: bool) -> tuple[str, ...]:
    ends = shape.fades[::-1] if falling else shape.fades
    return tuple(name for name, fades in zip(("below", "above"), ends, strict=True) if fades)


def _snapped(y: Array, box: Array) -> Array:
    """Ends of the box exactly as they were asked for: there and back through 1/Ω or tan β they are rounded."""
    for end in box[[0, -1]]:
        y = np.where(np.abs(y - end) <= 1e-12 * np.ptp(box), end, y)
    return y


def _point(region: Region, place: tuple[float, float] | None) -> tuple[float, float] | None:
    return None if place is None else (float(region.x(np.array(place[0]))), float(region.y(np.array(place[1]))))


def _cut(task: Task, region: Region, trace: BoundaryTrace) -> tuple[str, ...]:
    clipped = [any(intervals.clipped[side] for intervals in trace.intervals) for side in (0, 1)]
    falling = float(region.x(np.array(region.box.u0))) > float(region.x(np.array(region.box.u1)))
    left, right = clipped[::-1] if falling else clipped
    sides = {
        f"low {task.x.label}": left, f"high {task.x.label}": right,
        f"low {task.y.label}": trace.beyond[0] is None and trace.into[0] is None,
        f"high {task.y.label}": trace.beyond[1] is None and trace.into[1] is None,
    }  # fmt: skip
    return tuple(name for name, is_cut in sides.items() if is_cut)


def _names(region: Region, shapes: list[ClosedTrace]) -> list[Resonance | None]:
    """The resonance of each tongue, at its tip where it has one."""
    if not isinstance(region.family, LineFamily) or not shapes:
        return [None] * len(shapes)
    if isinstance(region.family, SteadyStateFamily):
        return [_own_name(region, region.family, shape) for shape in shapes]
    begins = np.array([s.tips[0] or s.tips[1] or (s.trace.intervals[0].inside, s.trace.intervals[0].v) for s in shapes])
    kinds = np.array([s.trace.intervals[0 if s.tips[0] or not s.tips[1] else -1].kind for s in shapes])
    return resonances(region.family, region.x(begins[:, 0]), region.y(begins[:, 1]), kinds, region.threads)


def _own_name(region: Region, family: SteadyStateFamily, shape: ClosedTrace) -> Resonance | None:
    """The resonance of a region about the line's own motion, as ``stability`` names it where a free–free line grows."""
    assembly, first = family.assembly, shape.trace.intervals[0]
    if not assembly.topology.free:
        return None
    x, y = region.x(np.array([first.inside])), region.y(np.array([first.v]))
    row = family.table(x, y)[0]
    try:
        return stability(assembly.packed.line_at(row), float(row[0])).resonance
    except ComputationError:
        return None


def _numbered(found: list[Tongue]) -> tuple[Tongue, ...]:
    """By falling growth rate, numbered from 1, references to others with them."""
    ordered = sorted(found, key=lambda t: -t.growth_rate)
    number = {t.number: k for k, t in enumerate(ordered, start=1)}
    return tuple(
        replace(
            t,
            number=number[t.number],
            joins=None if t.joins is None else number[t.joins],
            parts=None if t.parts is None else number[t.parts],
        )
        for t in ordered
    )
