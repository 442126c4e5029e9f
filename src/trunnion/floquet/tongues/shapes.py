"""Strands closed at their tips, or where they leave the box through a side."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from trunnion.arrays import Array, Places
from trunnion.floquet.tongues.boundary_traces import BoundaryTrace, Search
from trunnion.floquet.tongues.region import FAINT, Region
from trunnion.floquet.tongues.ridges import TIP, ridge, tips
from trunnion.numerics.bracketing import bracketed

WindowEnd = tuple[BoundaryTrace, int]
"""A strand and which of its ends, 0 below and −1 above."""
Point = tuple[float, float]
NEAR_TIP = (1 / 64, 1 / 16, 1 / 4)
"""Shares of the way from a tip to the next row at which its edges are solved for: edges part there like a square
root."""
AT_TIP = 1e-9
"""How far from 1 beyond its error ρ may be at a tip, whose place is solved for to as much."""
ACROSS_TIP = 0.02
"""Share of the way between two rows by which the rows stand above and below a tip that confirm it."""


@dataclass
class ClosedTrace:
    """A strand with its tips (u, v) below and above, and its intervals with those near the tips added; rising in v.

    fades: ends at which it does not close: without damping the growth there has only become too small to be told from
    none.
    """

    trace: BoundaryTrace
    tips: tuple[Point | None, ...]
    fades: tuple[bool, ...]
    v: Array
    low: Array
    high: Array
    inside: Array


class OpenEnd(NamedTuple):
    """An end of a strand without a tip: its last row, the next one, without it, and its interval in u on the last."""

    last: float
    beyond: float
    low: float
    high: float


def shapes(region: Region, search: Search, traces: list[BoundaryTrace]) -> list[ClosedTrace]:
    """Close every strand that ends inside the box at its tip, where rows on either side confirm it."""
    ends = [(trace, end) for trace in traces for end in (0, -1) if _ends_alone(trace, end)]
    undamped = dict(zip(ends, _undamped(region, ends), strict=True))
    # Without damping one that was cut off by a side of the box before leaves through it.
    fades = {(s, end): faint and not any(s.intervals[end].clipped) for (s, end), faint in undamped.items()}
    found = dict(zip(ends, _confirmed(region, search, ends, _tips(region, ends)), strict=True))
    found |= {end: None for end in ends if undamped[end] and not fades[end]}
    closed = {end: tip for end, tip in found.items() if tip is not None}
    at_sides = [end for end in ends if found[end] is None]
    near = dict(zip(closed, _near_tips(region, closed), strict=True))
    near |= dict(zip(at_sides, _corners(region, at_sides), strict=True))
    every = []
    for trace in traces:
        own = [(trace, end) for end in (0, -1)]
        rows = np.array(
            [(intervals.v, intervals.low, intervals.high, intervals.inside) for intervals in trace.intervals]
        ).T
        whole = np.concatenate([rows, *(near[end] for end in own if end in near)], axis=1)
        faint = tuple(fades.get(end, False) for end in own)
        tops = tuple(None if fades.get(end) else found.get(end) for end in own)
        every.append(ClosedTrace(trace, tops, faint, *whole[:, np.argsort(whole[0], kind="stable")]))
    return [shape for shape in every if not _too_faint(region, shape)]


def lost(shaped: list[ClosedTrace]) -> list[OpenEnd]:
    """Ends of strands inside the box at which no tip was found: the region goes on beyond, or is another one, joined or
    parted, that stands in its place. A row between tells."""
    found = []
    for shape in shaped:
        for end in (0, -1):
            last, missing = shape.trace.intervals[end], shape.trace.beyond[end]
            closes = shape.tips[end] is not None or shape.fades[end] or any(last.clipped)
            if missing is not None and _ends_alone(shape.trace, end) and not closes:
                found.append(OpenEnd(last.v, missing.v, last.low, last.high))
    return found


def _undamped(region: Region, ends: list[WindowEnd]) -> list[bool]:
    """Whether nothing damps where strands end."""
    u, v = (np.array([getattr(s.intervals[end], part) for s, end in ends]) for part in ("inside", "v"))
    return region.undamped(u, v).tolist() if ends else []


def _too_faint(region: Region, shape: ClosedTrace) -> bool:
    """Whether an undamped region grows nowhere by more than could be told from none: rows show shreds of it at most."""
    if not any(shape.fades):
        return False
    return bool(np.max(region.above_one((shape.low + shape.high) / 2, shape.v), initial=0.0) < FAINT)


def _ends_alone(trace: BoundaryTrace, end: int) -> bool:
    """Whether the strand simply ends there: not at the box, and not in another tongue."""
    return trace.beyond[end] is not None and trace.into[end] is None


def _tips(region: Region, ends: list[WindowEnd]) -> list[Point | None]:
    if not ends:
        return []
    known = []
    for trace, end in ends:
        missing, last = trace.beyond[end], trace.intervals[end]
        assert missing is not None
        step = min(1, len(trace.intervals) - 1)
        further = trace.intervals[step if end == 0 else -1 - step]
        centre, run = (last.low + last.high) / 2, further.v - last.v
        slope = ((further.low + further.high) / 2 - centre) / run if run else 0.0
        left = max(missing.high[missing.high <= centre], default=region.box.u0)
        right = min(missing.low[missing.low >= centre], default=region.box.u1)
        known.append((missing.v, last.v, centre, slope, last.high - last.low, left, right))
    outside, inside, centre_at, slope_at, width, *walls = np.array(known).T
    u, v, good = tips(region, outside, inside, centre_at, slope_at, width, np.stack(walls, axis=1))
    # A tongue that shrinks to nothing at a side of the box goes on outside.
    edge = 1e-9 * (region.box.u1 - region.box.u0)
    good &= (u > region.box.u0 + edge) & (u < region.box.u1 - edge)
    return [(a, b) if ok else None for a, b, ok in zip(u.tolist(), v.tolist(), good.tolist(), strict=True)]


def _confirmed(region: Region, search: Search, ends: list[WindowEnd], found: list[Point | None]) -> list[Point | None]:
    """Tips at which ρ is 1 to within its error, and above and below which rows differ by one interval.

    A ridge that leans more than its last rows tell may leave the stretch in which the tip is looked for: what is found
    there then is no tip, the region goes on, and a row beyond it still has the interval.
    """
    places = [k for k, tip in enumerate(found) if tip is not None]
    if not places:
        return found
    u, v = np.array([found[k] for k in places], dtype=float).T
    at = region.judged(u, v)
    touches = np.abs(at.radius - 1) <= at.error + AT_TIP
    beyond = np.array([_step_beyond(*ends[k]) for k in places])
    either = [len(row) for row in search(np.concatenate([v - ACROSS_TIP * beyond, v + ACROSS_TIP * beyond]))]
    inside, outside = np.array(either).reshape(2, -1)
    good = touches & (inside > outside)
    confirmed = {k for k, kept in zip(places, good.tolist(), strict=True) if kept}
    return [tip if k in confirmed else None for k, tip in enumerate(found)]


def _step_beyond(trace: BoundaryTrace, end: int) -> float:
    """From the last row of a strand to the next row, in which it is missing."""
    missing = trace.beyond[end]
    assert missing is not None
    return missing.v - trace.intervals[end].v


def _corners(region: Region, ends: list[WindowEnd]) -> list[Array]:
    """Where strands that leave through a side of the box cross it, beyond their last row; nothing for the others.

    As rows v, low, high and a point inside, all (4, points).
    """
    sides = [(k, side) for k, (trace, end) in enumerate(ends) for side in (0, 1) if trace.intervals[end].clipped[side]]
    u = np.array([region.box.u1 if side else region.box.u0 for _, side in sides])
    leaving = [ends[k] for k, _ in sides]
    inside = np.array([trace.intervals[end].v for trace, end in leaving])
    missing = [trace.beyond[end] for trace, end in leaving]
    outside = np.array([row.v for row in missing if row is not None])
    exact = TIP * (region.box.v1 - region.box.v0)
    v = bracketed(lambda at, own: region.across(u[own], at), outside, inside, exact) if sides else inside
    crossed = np.array([v, u, u, u])
    found = []
    for k in range(len(ends)):
        own = [place for place, (end, _) in enumerate(sides) if end == k]
        # Of two sides, the one that it crosses further out.
        found.append(crossed[:, sorted(own, key=lambda place: -abs(v[place] - inside[place]))[:1]])
    return found


def _near_tips(region: Region, closed: dict[WindowEnd, Point]) -> list[Array]:
    """Edges between tips (u, v) and the rows next to them, where they can be bracketed; tip included.

    As rows v, low, high and a point inside, all (4, points).
    """
    if not closed:
        return []
    beside = [trace.intervals[end] for trace, end in closed]
    tip = np.repeat(np.array(list(closed.values())), len(NEAR_TIP), axis=0)
    v, low, high = np.repeat(
        np.array([(intervals.v, intervals.low, intervals.high) for intervals in beside]), len(NEAR_TIP), axis=0
    ).T
    share = np.tile(NEAR_TIP, len(closed))
    at = tip[:, 1] + share * (v - tip[:, 1])
    middle = tip[:, 0] + share * ((low + high) / 2 - tip[:, 0])
    reach = 0.75 * np.sqrt(share) * (high - low) + 2 * np.abs(middle - tip[:, 0])
    top, height, _ = ridge(region, middle - reach, middle + reach, at)
    outer = np.stack([np.maximum(top - 2 * reach, region.box.u0), np.minimum(top + 2 * reach, region.box.u1)])
    over = region.above_one(outer.ravel(), np.tile(at, 2)).reshape(2, -1)
    good = np.flatnonzero((height > 0) & (over < 0).all(axis=0))
    exact = 1e-13 * (region.box.u1 - region.box.u0)

    def above(u: Array, own: Places) -> Array:
        return region.above_one(u, at[good[own]])

    left, right = (bracketed(above, side[good], top[good], exact) for side in outer)
    found = []
    for k, (u0, v0) in enumerate(closed.values()):
        own = good // len(NEAR_TIP) == k
        rows = np.stack([at[good[own]], left[own], right[own], top[good[own]]])
        found.append(np.append(rows, [[v0], [u0], [u0], [u0]], axis=1))
    return found
