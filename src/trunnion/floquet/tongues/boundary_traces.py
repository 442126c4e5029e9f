"""Tongues from the intervals of rows: which interval of one row continues which of the next.

Two intervals belong together where each, moved on as its tongue moved so far, meets the other and nothing else. Where
that is not clear a row is put between. Two that hold the same followed resonance belong together wherever they lie.
What stays unclear between rows that cannot be told apart is a tongue that joins another or parts from it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import reduce
from operator import or_
from typing import NamedTuple

import numpy as np

from trunnion.arrays import Array
from trunnion.floquet.tongues.rows import TongueRow

Search = Callable[[Array], list[TongueRow]]
"""The unstable intervals of rows v."""

HALVINGS = 6
"""Times that rows are put between two rows."""
ALIKE = 1e-12
"""Share of v below which two rows are one: their values came about in two ways."""
ALONE = 0.25
"""An interval that meets no other continues the nearest one if that is nearer than this share of the second nearest."""

FAR = 20.0
"""Nor does it where the nearest is farther than so many of their widths."""


class TongueInterval(NamedTuple):
    """An interval of a row, as ``TongueRow`` has them."""

    v: float
    low: float
    high: float
    inside: float
    kind: int
    clipped: list[bool]
    by: int
    of: frozenset[int]


@dataclass(eq=False)
class BoundaryTrace:
    """One tongue as intervals of consecutive rows, rising in v.

    Below and above: ``beyond`` are the rows next to its ends in which it is missing (None at the edge of the box), and
    ``into`` the strands it comes out of or runs into.
    """

    beyond: list[TongueRow | None]
    into: list[BoundaryTrace | None]
    intervals: list[TongueInterval] = field(default_factory=list)

    @property
    def by(self) -> int:
        """Which searches found any of its intervals, as ``TongueRow.by``."""
        return reduce(or_, (one.by for one in self.intervals))

    def moved(self, v: float) -> tuple[float, float]:
        """Its interval as it would be at ``v`` if it went on as it came: as the edge that moved less, since the other
        may have leapt where another tongue joined or parted."""
        last = self.intervals[-1]
        if len(self.intervals) < 2:
            return last.low, last.high
        before = self.intervals[-2]
        share = (v - last.v) / (last.v - before.v)
        shift = share * min(last.low - before.low, last.high - before.high, key=abs)
        return last.low + shift, last.high + shift


def _held(row: TongueRow, k: int) -> TongueInterval:
    low, high, inside, kind, clipped, by = (
        part[k].tolist() for part in (row.low, row.high, row.inside, row.kind, row.clipped, row.by)
    )
    return TongueInterval(row.v, low, high, inside, kind, clipped, by, row.of[k])


def joined(
    search: Search, v: Array, report_progress: Callable[[float], None], known: Sequence[TongueRow] = ()
) -> tuple[list[BoundaryTrace], list[TongueRow]]:
    """All tongues that meet the rows ``v``, those ``known`` or rows put between them; and all these rows."""
    rows = _rising([*known, *search(v)])
    for depth in range(HALVINGS + 1):
        traces, unclear = _strung(rows, final=depth == HALVINGS)
        report_progress((depth + 1) / (HALVINGS + 2))
        if not unclear:
            break
        between = np.array([(rows[k].v + rows[k + 1].v) / 2 for k in unclear])
        rows = _rising([*rows, *search(between)])
    return traces, rows


def _rising(rows: Sequence[TongueRow]) -> list[TongueRow]:
    """Rows in the order of their v, one of those whose values differ by rounding."""
    rising: list[TongueRow] = []
    for row in sorted(rows, key=lambda row: row.v):
        if not rising or row.v - rising[-1].v > ALIKE * abs(row.v):
            rising.append(row)
    return rising


def _strung(rows: list[TongueRow], *, final: bool) -> tuple[list[BoundaryTrace], list[int]]:
    """Strands through rows, and the rows after which a row between would help (none if ``final``)."""
    traces: list[BoundaryTrace] = []
    ends: list[BoundaryTrace] = []
    unclear: list[int] = []
    for k, row in enumerate(rows):
        before = rows[k - 1] if k else None
        pairs, doubtful = _matched(
            [s.moved(row.v) for s in ends],
            list(zip(row.low.tolist(), row.high.tolist(), strict=True)),
            [(a, b) for a, s in enumerate(ends) for b, of in enumerate(row.of) if s.intervals[-1].of & of],
        )
        if doubtful and not final and before is not None:
            unclear.append(k - 1)
        following: list[BoundaryTrace] = []
        for b in range(len(row)):
            own = [ends[a] for a, other in pairs if other == b]
            # The widest goes on where several join.
            free = [trace for trace in own if trace not in following]
            trace = max(free, key=lambda s: s.intervals[-1].high - s.intervals[-1].low, default=None)
            if trace is None:
                trace = BoundaryTrace([before, None], [own[0] if own else None, None])
                traces.append(trace)
            trace.intervals.append(_held(row, b))
            following.append(trace)
        for a, trace in enumerate(ends):
            if trace not in following:
                into = [following[b] for own, b in pairs if own == a]
                trace.beyond[1], trace.into[1] = row, into[0] if into else None
        ends = following
    return traces, unclear


Interval = tuple[float, float]


def _matched(
    before: list[Interval], after: list[Interval], known: list[tuple[int, int]]
) -> tuple[list[tuple[int, int]], bool]:
    """Pairs (of ``before``, of ``after``) that belong together, ``known`` ones among them, and whether the others are
    doubtful."""
    if known:
        left = [a for a in range(len(before)) if a not in {a for a, _ in known}]
        right = [b for b in range(len(after)) if b not in {b for _, b in known}]
        pairs, doubtful = _matched([before[a] for a in left], [after[b] for b in right], [])
        return known + [(left[a], right[b]) for a, b in pairs], doubtful
    pairs = [(a, b) for a, x in enumerate(before) for b, y in enumerate(after) if x[0] <= y[1] and y[0] <= x[1]]
    met_before, met_after = [a for a, _ in pairs], [b for _, b in pairs]
    doubtful = len(set(met_before)) < len(pairs) or len(set(met_after)) < len(pairs)
    for a, x in enumerate(before):
        if a in met_before:
            continue
        lonely = [b for b in range(len(after)) if b not in met_after]
        if not lonely:
            continue
        b = min(lonely, key=lambda own: _apart(x, after[own]))
        rivals = [_apart(x, y) for k, y in enumerate(after) if k != b]
        rivals += [_apart(z, after[b]) for k, z in enumerate(before) if k != a]
        distance = _apart(x, after[b])
        wide = (x[1] - x[0]) + (after[b][1] - after[b][0])
        if distance < ALONE * min(rivals, default=np.inf) and distance < FAR * wide:
            pairs.append((a, b))
            met_after.append(b)
            doubtful |= distance > wide
    ended = len({a for a, _ in pairs}) < len(before)
    begun = len({b for _, b in pairs}) < len(after)
    # One that ends and one that begins between the same two rows may be one that moved.
    return pairs, doubtful or (ended and begun)


def _apart(x: Interval, y: Interval) -> float:
    return max(x[0] - y[1], y[0] - x[1], 0.0)
