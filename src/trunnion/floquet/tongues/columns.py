"""Columns x = const of a box, each searched along y from end to end: what regions found by rows must explain.

Every region that crosses a side of the box meets a column at an end of it, however narrow the box is, and one that lies
between two rows meets a column where it is wider than columns stand apart.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from trunnion.arrays import Array, Flags
from trunnion.floquet.charts.chart_families import LineFamily
from trunnion.floquet.tongues.boundary_traces import Search
from trunnion.floquet.tongues.region import Region, turned
from trunnion.floquet.tongues.rows import OPEN_ERROR, unstable_intervals
from trunnion.results.verdict import Verdict


@dataclass(frozen=True)
class Column:
    """The column at ``u``: its unstable ranges and those of which nothing is known, each (ranges, 2) in v."""

    u: float
    unstable: Array
    unknown: Array


ColumnSearch = Callable[[Array], list[Column]]
"""Columns at u."""


def complete_columns(region: Region) -> ColumnSearch:
    """Columns of a region that is known by coefficients: every zero of the boundary functions is found."""
    family = region.family
    assert isinstance(family, LineFamily)
    about = turned(replace(family, x=family.y, y=family.x), region.function, region.threads)

    return columns_as_rows(partial(unstable_intervals, about))


def columns_as_rows(search: Search) -> ColumnSearch:
    """Columns that are the rows of the box turned about, found by ``search`` there."""

    def columns(u: Array) -> list[Column]:
        return [Column(row.v, np.stack([row.low, row.high], axis=1), row.unknown) for row in search(u)]

    return columns


def sampled_columns(region: Region, v: Array) -> ColumnSearch:
    """Columns of any region, looked at in the places ``v`` (places,), rising."""

    def search(u: Array) -> list[Column]:
        found = region.judged(np.repeat(u, len(v)), np.tile(v, len(u)))
        grows = (found.radius - 1 > found.error).reshape(len(u), len(v))
        decided = ((found.verdict != Verdict.UNDECIDED) | (found.error < OPEN_ERROR)).reshape(grows.shape)
        return [
            Column(place, _stretches(own, v), _stretches(~known, v))
            for place, own, known in zip(u.tolist(), grows, decided, strict=True)
        ]

    return search


def _stretches(inside: Flags, v: Array) -> Array:
    """Stretches (stretches, 2) from the first to the last of neighbouring places that are held."""
    edges = np.diff(np.concatenate([[0], inside.astype(int), [0]]))
    return np.stack([v[np.flatnonzero(edges > 0)], v[np.flatnonzero(edges < 0) - 1]], axis=1)
