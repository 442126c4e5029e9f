"""Strands closed at their tips, or where they leave the box through a side."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from trunnion.analyses.tongues.bracketing import bracketed
from trunnion.analyses.tongues.joining import Strand
from trunnion.analyses.tongues.region import FAINT, Region
from trunnion.analyses.tongues.ridges import TIP, ridge, tips

Array = NDArray[np.float64]
Points = tuple[Array, Array, Array, Array]
"""v, low, high and a point inside, each (rows,)."""
NEAR_TIP = (1 / 64, 1 / 16, 1 / 4)
"""Shares of the way from a tip to the next row at which its edges are solved for: edges part there like a square
root."""


@dataclass
class Shape:
    """A strand with its tips (u, v), and its intervals with those near the tips added; rising in v.

    fades: ends, 0 below and 1 above, at which it does not close: without damping the growth there has only become too
    small to be told from none.
    """

    strand: Strand
    below: tuple[float, float] | None
    above: tuple[float, float] | None
    fades: tuple[bool, bool]
    v: Array
    low: Array
    high: Array
    inside: Array


def shapes(region: Region, strands: list[Strand]) -> list[Shape]:
    """Close every strand that ends inside the box at its tip."""
    ends = [(k, end) for k, s in enumerate(strands) for end in (0, -1) if _ends_alone(s, end)]
    undamped = _undamped(region, [(strands[k], end) for k, end in ends])
    # Without damping one that was cut off by a side of the box before leaves through it.
    fades = {
        (k, end): faint and not any(strands[k].clipped[end]) for (k, end), faint in zip(ends, undamped, strict=True)
    }
    found = dict(zip(ends, _tips(region, [(strands[k], end) for k, end in ends]), strict=True))
    found |= {key: None for key, faint in zip(ends, undamped, strict=True) if faint and not fades[key]}
    closed = [(key, tip) for key, tip in found.items() if tip is not None]
    rows = [(tip, strands[k].v[end], strands[k].low[end], strands[k].high[end]) for (k, end), tip in closed]
    near = dict(zip([key for key, _ in closed], _near_tips(region, rows), strict=True))
    at_sides = [key for key, tip in found.items() if tip is None]
    near |= dict(zip(at_sides, _corners(region, [(strands[k], end) for k, end in at_sides]), strict=True))
    every = [
        _closed(
            s, [found.get((k, end)) for end in (0, -1)], [fades.get((k, end), False) for end in (0, -1)],
            [near[k, end] for end in (0, -1) if (k, end) in near],
        )
        for k, s in enumerate(strands)
    ]  # fmt: skip
    return [shape for shape in every if not _too_faint(region, shape)]


def lost(shaped: list[Shape]) -> Array:
    """Rows between those where a strand ends inside the box and those next to it, where no tip was found there: it is
    another tongue, joined or parted, that stands in its place."""
    between = []
    for shape in shaped:
        s = shape.strand
        for end, tip in ((0, shape.below), (-1, shape.above)):
            missing = s.below if end == 0 else s.above
            if tip is None and _ends_alone(s, end) and not any(s.clipped[end]) and not shape.fades[end]:
                assert missing is not None
                between.append((s.v[end] + missing.v) / 2)
    return np.unique(between)


def _undamped(region: Region, ends: list[tuple[Strand, int]]) -> list[bool]:
    """Whether nothing damps where strands end."""
    u, v = (np.array([getattr(s, part)[end] for s, end in ends]) for part in ("inside", "v"))
    return region.undamped(u, v).tolist() if ends else []


def _too_faint(region: Region, shape: Shape) -> bool:
    """Whether an undamped region grows nowhere by more than could be told from none: rows show shreds of it at most."""
    if not any(shape.fades):
        return False
    return bool(np.max(region.above_one((shape.low + shape.high) / 2, shape.v), initial=0.0) < FAINT)


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
    v = bracketed(lambda at, own: region.across(u[own], at), outside, inside, exact) if sides else inside
    crossed: list[Points] = []
    for k in range(len(ends)):
        own = [place for place, (end, _) in enumerate(sides) if end == k]
        # Of two sides, the one that it crosses further out.
        best = max(own, key=lambda place: abs(v[place] - inside[place]), default=None)
        at, place = (v[[best]], u[[best]]) if best is not None else (np.zeros(0), np.zeros(0))
        crossed.append((at, place, place, place))
    return crossed


def _closed(strand: Strand, tips: list[tuple[float, float] | None], fades: list[bool], near: list[Points]) -> Shape:
    own = tuple(np.array(part) for part in (strand.v, strand.low, strand.high, strand.inside))
    whole = [np.concatenate(column) for column in zip(own, *near, strict=True)]
    order = np.argsort(whole[0], kind="stable")
    below, above = (None if faint else tip for tip, faint in zip(tips, fades, strict=True))
    return Shape(strand, below, above, (fades[0], fades[1]), *(column[order] for column in whole))


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
