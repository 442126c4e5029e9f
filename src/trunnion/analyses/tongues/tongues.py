"""Every instability region in a box, as smooth curves with the resonance that names it.

Rows y = const are searched from end to end (``rows``), joined into tongues (``joining``), and closed at their tips
(``ridges``). All that is printed of a tongue is solved for with integrations of its own at 1e-13; the patches only tell
where to look.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from trunnion.analyses.charts.stability_chart import Task, line_task, own_task
from trunnion.analyses.linear.resonance_speeds import Resonance
from trunnion.analyses.tongues.bracketing import bracketed
from trunnion.analyses.tongues.from_resonances import followed, in_words
from trunnion.analyses.tongues.joining import Search, Strand, joined
from trunnion.analyses.tongues.naming import resonances
from trunnion.analyses.tongues.region import Region, patched
from trunnion.analyses.tongues.result import Tongue, Tongues, Unknown, by_growth
from trunnion.analyses.tongues.ridges import TIP, ridge, tips
from trunnion.analyses.tongues.rows import Kind, Row, unstable_intervals
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.errors import InputError
from trunnion.results.quantity_axes import QuantityAxis, parameter_axis
from trunnion.systems.family import PeriodicLinearFamily

Array = NDArray[np.float64]
Range = Sequence[object]
Progress = Callable[[float], None]
Points = tuple[Array, Array, Array, Array]
"""v, low, high and a point inside, each (rows,)."""

ROWS = 65
PATCH_TOLERANCE = 1e-11
FASTEST = 5
"""Rows of a tongue that grow fastest in their middle, on which its largest growth rate is looked for."""
NEAR_TIP = (1 / 64, 1 / 16, 1 / 4)
"""Shares of the way from a tip to the next row at which its edges are solved for: edges part there like a square
root."""


def tongues(
    line: Driveline | Assembly | PeriodicLinearFamily,
    x: Range,
    y: Range,
    *,
    speed: float | None = None,
    rows: int = ROWS,
    statically_twisted: bool = True,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Tongues:
    """All instability regions in a box of two parameters.

    Parameters
    ----------
    line : a driveline, or a ``PeriodicLinearFamily`` of your own.
    x, y : ``(parameter, low, high)``, parameters as of a chart, SI units. Tongues are followed along y: take an angle
    or a
        damping for it, and the speed for x.
    speed : input speed [rad/s] where neither axis is the speed; default the operating speed of the file.
    rows : values of y searched to begin with, more where tongues are born, close or meet.

    Up to three unknowns every row is searched completely: every change of stability is a zero of one of three analytic
    functions, and their zeros on a row are all found. Longer lines are sampled. ``search`` in the result says which.

    Raises
    ------
    InputError : see ``stability_chart``; fewer than three rows.
    """
    if isinstance(rows, bool) or not isinstance(rows, int | np.integer) or rows < 3:
        raise InputError("must be a whole number, 3 or more", key="rows", value=rows)
    task = task_of(line, x, y, speed, statically_twisted, "tongues")
    workers, tell = threads or os.cpu_count() or 1, progress or (lambda share: None)
    region = patched(task.family, task.x.values, task.y.values, PATCH_TOLERANCE, workers, lambda s: tell(0.3 * s))
    levels = np.sort(task.family.to_patch(np.linspace(task.y.values[0], task.y.values[-1], int(rows)), False))
    search, words = _search(task, region, line, statically_twisted)
    strands, searched = joined(search, levels, lambda s: tell(0.3 + 0.5 * s))
    shaped = _shapes(region, strands)
    tell(0.9)
    places = {id(s.strand): k for k, s in enumerate(shaped)}
    growths, names = _growths(task, region, shaped), _names(task, region, shaped, line, statically_twisted)
    find = _finder(region, search)
    found = [_tongue(task, region, find, s, g, n, places) for s, g, n in zip(shaped, growths, names, strict=True)]
    tell(1.0)
    steps = np.diff([float(region.y(np.array(row.v))) for row in searched])
    unknown = _unknown(region, searched)
    unit = speed_unit(task.line) if task.line else None
    across, up = (parameter_axis(axis.label, axis.unit, unit) for axis in (task.x, task.y))
    return Tongues(
        _numbered(found),
        task.x.label,
        task.y.label,
        task.x.unit,
        task.y.unit,
        (float(task.x.values[0]), float(task.x.values[-1])),
        (float(task.y.values[0]), float(task.y.values[-1])),
        "1/s" if task.line is not None else "1",
        len(searched),
        float(np.abs(steps).max()),
        region.by_coefficients and not region.uncovered,
        _search_words(region, len(searched), up.number(float(np.abs(steps).max()), 3))
        + words(strands)
        + _unknown_words(unknown, across, up),
        unknown,
        task.line,
        task.remarks,
        find,
    )


def task_of(
    line: Driveline | Assembly | PeriodicLinearFamily,
    x: Range,
    y: Range,
    speed: float | None,
    twisted: bool,
    analysis: str,
) -> Task:
    """What is to be searched, checked; ranges are ``(parameter, low, high)``."""
    for key, request in (("x", x), ("y", y)):
        if isinstance(request, str) or not isinstance(request, Sequence) or len(request) != 3:
            remedy = f'write {key}=("speed", 10, 200)'
            raise InputError("must be (parameter, low, high)", key=key, value=request, remedy=remedy)
    across, up = (*x, 2), (*y, 2)
    if isinstance(line, PeriodicLinearFamily):
        if speed is not None:
            remedy = "a family has its own parameters"
            raise InputError("belongs to drivelines", key="speed", value=speed, remedy=remedy)
        return own_task(line, across, up)
    return line_task(line, across, up, speed, twisted, analysis)


def _search_words(region: Region, rows: int, step: str) -> str:
    apart = f"{rows} rows, at most {step} apart,"
    if not region.by_coefficients:
        few = "more than three unknowns have no boundary functions that could be searched completely"
        return (
            f"{apart} were sampled ({few}), and looked at closely wherever two multipliers meet: both searches are "
            "heuristics, so narrow regions may be missing"
        )
    if region.uncovered:
        return f"{apart} were searched; {region.uncovered} parts of the box resisted and were sampled"
    return f"{apart} were searched completely; a region that lies wholly between two rows is not listed"


def _unknown(region: Region, rows: list[Row]) -> tuple[Unknown, ...]:
    """Where rows could not be told, each with the rows next to it: what lies between is not known either."""
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


def _search(
    task: Task, region: Region, line: Driveline | Assembly | PeriodicLinearFamily, twisted: bool
) -> tuple[Search, Callable[[list[Strand]], str]]:
    """How rows are searched, and what there is to say of it when tongues are known."""
    if not region.by_coefficients and not isinstance(line, PeriodicLinearFamily):
        assembly = line if isinstance(line, Assembly) else assemble(line)
        found = followed(task, assembly, region, twisted)
        if found is not None:
            return found.rows, lambda strands: "; " + in_words(found, [s.by for s in strands])
    alone = ""
    if not region.by_coefficients:
        why = "a family of your own has no straight line" if isinstance(line, PeriodicLinearFamily) else "x is no speed"
        alone = f"; resonances were not followed, as {why}"
    return lambda v: unstable_intervals(region, v), lambda strands: alone


def _finder(region: Region, search: Search) -> Callable[[float], Array]:
    def find(y: float) -> Array:
        v = float(region.family.to_patch(np.array(y), False))
        row = search(np.array([v]))[0]
        return region.in_x(row.low, row.high)

    return find


@dataclass
class _Shape:
    """A strand with its tips (u, v), and its intervals with those near the tips added; rising in v."""

    strand: Strand
    below: tuple[float, float] | None
    above: tuple[float, float] | None
    v: Array
    low: Array
    high: Array
    inside: Array


def _shapes(region: Region, strands: list[Strand]) -> list[_Shape]:
    """Close every strand that ends inside the box at its tip."""
    ends = [(k, end) for k, s in enumerate(strands) for end in (0, -1) if _ends_alone(s, end)]
    found = dict(zip(ends, _tips(region, [(strands[k], end) for k, end in ends]), strict=True))
    closed = [(key, tip) for key, tip in found.items() if tip is not None]
    rows = [(tip, strands[k].v[end], strands[k].low[end], strands[k].high[end]) for (k, end), tip in closed]
    near = dict(zip([key for key, _ in closed], _near_tips(region, rows), strict=True))
    at_sides = [key for key, tip in found.items() if tip is None]
    near |= dict(zip(at_sides, _corners(region, [(strands[k], end) for k, end in at_sides]), strict=True))
    return [
        _closed(s, [found.get((k, end)) for end in (0, -1)], [near[k, end] for end in (0, -1) if (k, end) in near])
        for k, s in enumerate(strands)
    ]


def _ends_alone(strand: Strand, end: int) -> bool:
    """Whether the strand simply ends there: not at the box, and not in another tongue."""
    return (
        strand.below is not None and strand.parts is None
        if end == 0
        else strand.above is not None and strand.joins is None
    )


def _tips(region: Region, ends: list[tuple[Strand, int]]) -> list[tuple[float, float] | None]:
    if not ends:
        return []
    outside, inside, centre, slope, width, walls = [], [], [], [], [], []
    for strand, end in ends:
        missing = strand.below if end == 0 else strand.above
        assert missing is not None
        at, further = (0, min(1, len(strand.v) - 1)) if end == 0 else (-1, max(-2, -len(strand.v)))
        outside.append(missing.v)
        inside.append(strand.v[at])
        centre.append((strand.low[at] + strand.high[at]) / 2)
        beyond = (strand.low[further] + strand.high[further]) / 2
        run = strand.v[further] - strand.v[at]
        slope.append((beyond - centre[-1]) / run if run else 0.0)
        width.append(strand.high[at] - strand.low[at])
        left = [float(h) for h in missing.high if h <= centre[-1]]
        right = [float(a) for a in missing.low if a >= centre[-1]]
        walls.append((max(left, default=region.box.u0), min(right, default=region.box.u1)))
    u, v, good = tips(region, *(np.array(part) for part in (outside, inside, centre, slope, width, walls)))
    # A tongue that shrinks to nothing at a side of the box goes on outside.
    edge = 1e-9 * (region.box.u1 - region.box.u0)
    good &= (u > region.box.u0 + edge) & (u < region.box.u1 - edge)
    return [(a, b) if ok else None for a, b, ok in zip(u.tolist(), v.tolist(), good.tolist(), strict=True)]


def _corners(region: Region, ends: list[tuple[Strand, int]]) -> list[Points]:
    """Where strands that leave through a side of the box cross it, beyond their last row; nothing for the others."""
    sides = [(k, side) for k, (strand, end) in enumerate(ends) for side in (0, 1) if strand.clipped[end][side]]
    u = np.array([region.box.u1 if side else region.box.u0 for _, side in sides])
    inside = np.array([ends[k][0].v[ends[k][1]] for k, _ in sides])
    missing = [ends[k][0].below if ends[k][1] == 0 else ends[k][0].above for k, _ in sides]
    outside = np.array([row.v for row in missing if row is not None])
    exact = TIP * (region.box.v1 - region.box.v0)
    v = bracketed(lambda at, own: region.above_one(u[own], at), outside, inside, exact) if sides else inside
    crossed: list[Points] = []
    for k in range(len(ends)):
        own = [place for place, (end, _) in enumerate(sides) if end == k]
        # Of two sides, the one that it crosses further out.
        best = max(own, key=lambda place: abs(v[place] - inside[place]), default=None)
        at, place = (v[[best]], u[[best]]) if best is not None else (np.zeros(0), np.zeros(0))
        crossed.append((at, place, place, place))
    return crossed


def _closed(strand: Strand, tips: list[tuple[float, float] | None], near: list[Points]) -> _Shape:
    own = tuple(np.array(part) for part in (strand.v, strand.low, strand.high, strand.inside))
    whole = [np.concatenate(column) for column in zip(own, *near, strict=True)]
    order = np.argsort(whole[0], kind="stable")
    return _Shape(strand, tips[0], tips[1], *(column[order] for column in whole))


def _near_tips(region: Region, ends: list[tuple[tuple[float, float], float, float, float]]) -> list[Points]:
    """Edges between tips (u, v) and the rows next to them (v, low, high), where they can be bracketed; tip included."""
    if not ends:
        return []
    tip = np.repeat(np.array([end[0] for end in ends]), len(NEAR_TIP), axis=0)
    v, low, high = np.repeat(np.array([end[1:] for end in ends]), len(NEAR_TIP), axis=0).T
    share = np.tile(NEAR_TIP, len(ends))
    at = tip[:, 1] + share * (v - tip[:, 1])
    middle = tip[:, 0] + share * ((low + high) / 2 - tip[:, 0])
    reach = 0.75 * np.sqrt(share) * (high - low) + 2 * np.abs(middle - tip[:, 0])
    top, height = ridge(region, middle - reach, middle + reach, at)
    outer = np.stack([np.maximum(top - 2 * reach, region.box.u0), np.minimum(top + 2 * reach, region.box.u1)])
    over = region.above_one(outer.ravel(), np.tile(at, 2)).reshape(2, -1)
    good = np.flatnonzero((height > 0) & (over < 0).all(axis=0))
    exact = 1e-13 * (region.box.u1 - region.box.u0)

    def above(u: Array, own: NDArray[np.intp]) -> Array:
        return region.above_one(u, at[good[own]])

    left, right = (bracketed(above, side[good], top[good], exact) for side in outer)
    found = []
    for k, end in enumerate(ends):
        own = np.flatnonzero(good // len(NEAR_TIP) == k)
        rows = (at[good[own]], left[own], right[own], top[good[own]])
        point = (end[0][1], end[0][0], end[0][0], end[0][0])
        found.append(tuple(np.append(row, place) for row, place in zip(rows, point, strict=True)))
    return found  # type: ignore[return-value]


def _growths(task: Task, region: Region, shapes: list[_Shape]) -> list[tuple[float, tuple[float, float]]]:
    """The largest growth rate on the rows of each tongue and where it is."""
    owner = np.concatenate([np.full(len(s.v), k) for k, s in enumerate(shapes)] or [np.zeros(0)])
    v, low, high = (
        np.concatenate([getattr(s, part) for s in shapes] or [np.zeros(0)]) for part in ("v", "low", "high")
    )
    rough = _rate(task, region, (low + high) / 2, v, np.maximum(region.above_one((low + high) / 2, v), 0.0))
    own = [np.flatnonzero(owner == k) for k in range(len(shapes))]
    pick = np.concatenate([o[np.argsort(-rough[o])[:FASTEST]] for o in own] or [np.zeros(0, dtype=np.intp)])
    u, top = ridge(region, low[pick], high[pick], v[pick])
    rate, x, y = _rate(task, region, u, v[pick], top), region.x(u), region.y(v[pick])
    found = []
    for k in range(len(shapes)):
        mine = np.flatnonzero(owner[pick] == k)
        best = mine[int(np.argmax(rate[mine]))]
        found.append((float(rate[best]), (float(x[best]), float(y[best]))))
    return found


def _rate(task: Task, region: Region, u: Array, v: Array, over: Array) -> Array:
    """Growth rates [1/s] at points where ρ − 1 is ``over``."""
    return np.asarray(np.log1p(over) / region.family.period * _speed(task, region.x(u), region.y(v)))


def _tongue(
    task: Task,
    region: Region,
    find: Callable[[float], Array],
    shape: _Shape,
    growth: tuple[float, tuple[float, float]],
    named: Resonance | None,
    places: dict[int, int],
) -> Tongue:
    strand = shape.strand
    y = _snapped(region.y(shape.v), task.y.values)
    ends = _snapped(np.sort(np.stack([region.x(shape.low), region.x(shape.high)]), axis=0), task.x.values)
    tip, top = (_point(region, t) for t in (shape.below, shape.above))
    order = np.argsort(y, kind="stable")
    if y[0] > y[-1]:
        tip, top = top, tip
    return Tongue(
        places[id(strand)],
        str(Kind(strand.kind[0])),
        named,
        y[order],
        ends[0][order],
        ends[1][order],
        tip if tip is not None else top,
        top if tip is not None else None,
        *growth,
        None if strand.joins is None else places[id(strand.joins)],
        None if strand.parts is None else places[id(strand.parts)],
        _cut(task, region, strand),
        find,
    )


def _snapped(y: Array, box: Array) -> Array:
    """Ends of the box exactly as they were asked for: there and back through 1/Ω or tan β they are rounded."""
    for end in box[[0, -1]]:
        y = np.where(np.abs(y - end) <= 1e-12 * np.ptp(box), end, y)
    return y


def _point(region: Region, place: tuple[float, float] | None) -> tuple[float, float] | None:
    return None if place is None else (float(region.x(np.array(place[0]))), float(region.y(np.array(place[1]))))


def _cut(task: Task, region: Region, strand: Strand) -> tuple[str, ...]:
    clipped = np.array(strand.clipped, dtype=bool).reshape(-1, 2).max(axis=0)
    falling = float(region.x(np.array(region.box.u0))) > float(region.x(np.array(region.box.u1)))
    left, right = clipped[::-1] if falling else clipped
    sides = {
        f"low {task.x.label}": left, f"high {task.x.label}": right,
        f"low {task.y.label}": strand.below is None and strand.parts is None,
        f"high {task.y.label}": strand.above is None and strand.joins is None,
    }  # fmt: skip
    return tuple(name for name, is_cut in sides.items() if is_cut)


def _speed(task: Task, x: Array, y: Array) -> Array | float:
    if task.line is None:
        return 1.0
    if task.speed is not None:
        return task.speed
    own, values = (task.x, x) if task.x.is_speed else (task.y, y)
    table = np.zeros((len(values), int(own.columns.index.max()) + 1))
    own.columns.put(table, values)
    return np.asarray(table[:, 0])


def _names(
    task: Task, region: Region, shapes: list[_Shape], line: Driveline | Assembly | PeriodicLinearFamily, twisted: bool
) -> list[Resonance | None]:
    """The resonance of each tongue, at its tip where it has one."""
    if isinstance(line, PeriodicLinearFamily):
        return [None] * len(shapes)
    assembly = line if isinstance(line, Assembly) else assemble(line)
    begins = np.array([s.below or s.above or (s.inside[0], s.v[0]) for s in shapes]).reshape(-1, 2)
    kinds = np.array([s.strand.kind[0 if s.below or not s.above else -1] for s in shapes])
    return resonances(task, assembly, region.x(begins[:, 0]), region.y(begins[:, 1]), kinds, twisted, region.threads)


def _numbered(found: list[Tongue]) -> tuple[Tongue, ...]:
    """By falling growth rate, numbered from 1, references to others with them."""
    from dataclasses import replace

    ordered = by_growth(found)
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
