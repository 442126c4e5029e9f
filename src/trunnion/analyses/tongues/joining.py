"""Tongues from the intervals of rows: which interval of one row continues which of the next.

Two intervals belong together where each, moved on as its tongue moved so far, meets the other and nothing else. Where
that is not clear a row is put between. Two that hold the same followed resonance belong together wherever they lie.
What stays unclear between rows that cannot be told apart is a tongue that joins another or parts from it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from trunnion.analyses.tongues.rows import Row

Array = NDArray[np.float64]
Search = Callable[[Array], list[Row]]
"""The unstable intervals of rows v."""

HALVINGS = 6
"""Times that rows are put between two rows."""
ALONE = 0.25
"""An interval that meets no other continues the nearest one if that is nearer than this share of the second nearest."""

FAR = 20.0
"""Nor does it where the nearest is farther than so many of their widths."""


@dataclass
class Strand:
    """One tongue as intervals of consecutive rows: v, low and high (u), a point inside, kind; rising in v.

    ``below`` and ``above`` are the rows next to its ends in which it is missing (None at the edge of the box);
    ``joins`` and ``parts`` are the strands it runs into or comes out of; ``by``: which searches found any of its
    intervals, as ``Row.by``; ``of``: resonances in the last one.
    """

    v: list[float] = field(default_factory=list)
    low: list[float] = field(default_factory=list)
    high: list[float] = field(default_factory=list)
    inside: list[float] = field(default_factory=list)
    kind: list[int] = field(default_factory=list)
    clipped: list[tuple[bool, bool]] = field(default_factory=list)
    by: int = 0
    of: frozenset[int] = frozenset()
    below: Row | None = None
    above: Row | None = None
    joins: Strand | None = None
    parts: Strand | None = None

    def take(self, row: Row, k: int) -> None:
        """Add interval ``k`` of a row."""
        self.v.append(row.v)
        self.low.append(float(row.low[k]))
        self.high.append(float(row.high[k]))
        self.inside.append(float(row.inside[k]))
        self.kind.append(int(row.kind[k]))
        self.clipped.append((bool(row.clipped[k, 0]), bool(row.clipped[k, 1])))
        self.by |= int(row.by[k])
        self.of = row.of[k]

    def moved(self, v: float) -> tuple[float, float]:
        """Its interval as it would be at ``v`` if it went on as it came: as the edge that moved less, since the other
        may have leapt where another tongue joined or parted."""
        if len(self.v) < 2:
            return self.low[-1], self.high[-1]
        share = (v - self.v[-1]) / (self.v[-1] - self.v[-2])
        shift = share * min(self.low[-1] - self.low[-2], self.high[-1] - self.high[-2], key=abs)
        return self.low[-1] + shift, self.high[-1] + shift


def joined(
    search: Search, v: Array, tell: Callable[[float], None], known: Sequence[Row] = ()
) -> tuple[list[Strand], list[Row]]:
    """All tongues that meet the rows ``v``, those ``known`` or rows put between them; and all these rows."""
    rows = sorted([*known, *search(v)], key=lambda row: row.v)
    for depth in range(HALVINGS + 1):
        strands, unclear = _strung(rows, final=depth == HALVINGS)
        tell((depth + 1) / (HALVINGS + 2))
        if not unclear:
            break
        between = np.array([(rows[k].v + rows[k + 1].v) / 2 for k in unclear])
        rows = sorted([*rows, *search(between)], key=lambda row: row.v)
    return strands, rows


def _strung(rows: list[Row], *, final: bool) -> tuple[list[Strand], list[int]]:
    """Strands through rows, and the rows after which a row between would help (none if ``final``)."""
    strands: list[Strand] = []
    ends: list[Strand] = []
    unclear: list[int] = []
    for k, row in enumerate(rows):
        before = rows[k - 1] if k else None
        pairs, doubtful = _matched(
            [s.moved(row.v) for s in ends],
            list(zip(row.low.tolist(), row.high.tolist(), strict=True)),
            [(a, b) for a, s in enumerate(ends) for b, of in enumerate(row.of) if s.of & of],
        )
        if doubtful and not final and before is not None:
            unclear.append(k - 1)
        following: list[Strand] = []
        taken: dict[int, Strand] = {}
        for b in range(len(row)):
            own = [a for a, other in pairs if other == b and ends[a] not in taken.values()]
            # The widest goes on where several join.
            chosen = max(own, key=lambda a: ends[a].high[-1] - ends[a].low[-1], default=None)
            strand = Strand(below=before) if chosen is None else ends[chosen]
            if chosen is None:
                strands.append(strand)
                source = [a for a, other in pairs if other == b]
                strand.parts = ends[source[0]] if source else None
            taken[b] = strand
            strand.take(row, b)
            following.append(strand)
        for a, strand in enumerate(ends):
            if strand not in following:
                strand.above = row
                into = [b for own, b in pairs if own == a]
                strand.joins = taken[into[0]] if into else None
        ends = following
    return strands, unclear


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
