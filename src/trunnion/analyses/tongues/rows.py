"""The unstable intervals of rows y = const.

Up to three unknowns every change of stability is a zero of a boundary function, and the zeros along a row are all found
(``series_roots``). Between two of them the verdict does not change, so one point integrated by itself decides. Edges
are then solved for with points of their own, so that they owe nothing to the patches.

More unknowns are sampled, in two passes: by eigenvalues of interpolated matrices, denser where a local maximum of the
radius comes near 1; and where two multipliers meet (``meetings``), however narrow the region there.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from trunnion.analyses.tongues.boundaries import boundary_functions, degree
from trunnion.analyses.tongues.bracketing import bracketed
from trunnion.analyses.tongues.meetings import meetings
from trunnion.analyses.tongues.region import Piece, Places, Region
from trunnion.analyses.tongues.series_roots import row_roots
from trunnion.results.verdict import Verdict

Array = NDArray[np.float64]

TIGHT = 1e-7
"""Half of the first bracket about a zero of the patches, as a share of the box."""
UNTOLD = 1e-6
"""An error of ρ above which an open verdict is no answer; below, ρ is 1 as far as anybody asks."""
EXACT = 1e-14
"""How closely edges are solved, as a share of the box."""
LOOKS = 9
"""Points looked at in a stretch where a boundary may just be touched, in each of ``ZOOMS`` rounds."""
ZOOMS = 4


BY_ROWS, BY_RESONANCES = 1, 2
"""Which search found an interval."""


class Kind(IntEnum):
    """How the multipliers leave the unit circle; codes of arrays."""

    POSITIVE = 0
    NEGATIVE = 1
    COMPLEX = 2

    def __str__(self) -> str:
        return {0: "real positive", 1: "real negative", 2: "complex pair"}[self]


def kind_of(critical: NDArray[np.complex128]) -> NDArray[np.int8]:
    """Kinds of critical multipliers."""
    real = np.abs(critical.imag) <= 1e-9 * np.abs(critical)
    return np.where(~real, Kind.COMPLEX, np.where(critical.real > 0, Kind.POSITIVE, Kind.NEGATIVE)).astype(np.int8)


@dataclass(frozen=True)
class Row:
    """Unstable intervals of the row at ``v``, rising: ``low``, ``high``, a point ``inside`` each, all in u; ``kind``
    there.

    ``clipped`` (intervals, 2): whether an end is the end of the box; ``unknown`` (stretches, 2): from where to where, u
    rising, the motion could not be computed, or not closely enough to tell whether it grows; ``by``: which searches
    found an interval, bits ``BY_ROWS`` and ``BY_RESONANCES``; ``of``: for each interval the numbers of the resonances
    that lie in it, where resonances were followed.
    """

    v: float
    low: Array
    high: Array
    inside: Array
    kind: NDArray[np.int8]
    clipped: NDArray[np.bool_]
    unknown: Array
    by: NDArray[np.int8]
    of: tuple[frozenset[int], ...]

    def __len__(self) -> int:
        return len(self.low)


def unstable_intervals(region: Region, v: Array) -> list[Row]:
    """The unstable intervals of rows ``v``, each found from end to end."""
    v = np.atleast_1d(np.asarray(v, dtype=float))
    marks = _Marks.none(len(v))
    for piece in region.pieces(v):
        marks.add(*(_zeros(piece) if region.by_coefficients else _sampled(region, piece, v)))
    return _settled(region, v, marks)


def looked_at(region: Region, rows: list[Row], stretches: list[Array]) -> list[Row]:
    """Rows with what lies in ``stretches`` (stretches, 2) of each row added to what was known of it."""
    known = [k for k, own in enumerate(stretches) if len(own)]
    marks = _Marks.none(len(known))
    for place, k in enumerate(known):
        row = rows[k]
        marks.at[place] += [*row.low[~row.clipped[:, 0]].tolist(), *row.high[~row.clipped[:, 1]].tolist()]
        marks.peaks[place] += row.inside.tolist()
        marks.close[place] += [(a, b) for a, b in stretches[k].tolist()]
    found = (
        dict(zip(known, _settled(region, np.array([rows[k].v for k in known]), marks), strict=True)) if known else {}
    )
    return [replace(found[k], unknown=row.unknown) if k in found else row for k, row in enumerate(rows)]


class _Marks:
    """Places on rows between which the verdict does not change, points inside regions, and stretches to be looked at
    closely."""

    def __init__(self, rows: int) -> None:
        self.at: list[list[float]] = [[] for _ in range(rows)]
        self.peaks: list[list[float]] = [[] for _ in range(rows)]
        self.close: list[list[tuple[float, float]]] = [[] for _ in range(rows)]

    @classmethod
    def none(cls, rows: int) -> _Marks:
        return cls(rows)

    def add(self, row: Places, u: Array, touched_row: Places, touched: Array) -> None:
        for r, place in zip(row.tolist(), u.tolist(), strict=True):
            self.at[r].append(place)
        for r, ends in zip(touched_row.tolist(), touched.tolist(), strict=True):
            self.close[r].append((min(ends), max(ends)))


def _zeros(piece: Piece) -> tuple[Places, Array, Places, Array]:
    """Rows and places of all zeros of boundary functions on a piece, and of stretches that may touch one."""
    parts = []
    for undamped in (False, True):
        own = np.flatnonzero(piece.undamped == undamped)
        if len(own):
            functions = _functions(undamped)
            found = row_roots(piece.series[own], piece.errors[own], functions, degree(piece.series.shape[1]))
            touched = piece.u(found.touched)
            parts.append(
                (piece.rows[own[found.row]], piece.u(found.theta), piece.rows[own[found.touched_row]], touched)
            )
    return tuple(np.concatenate(part) for part in zip(*parts, strict=True))  # type: ignore[return-value]


def _functions(undamped: bool):  # type: ignore[no-untyped-def]
    return lambda e: boundary_functions(e, undamped)


SAMPLES = 512
"""Points of a piece of a row at which eigenvalues are looked at, of lines of more than three unknowns."""
ROUNDING = 1e-9
"""ρ − 1 of interpolated matrices below this may be rounding; regions that grow by less are found as meetings."""
BESIDE = np.pi / SAMPLES / 4
"""Half of the stretch about a meeting of two multipliers that is looked at closely, in θ."""
RISES = 0.02
"""A stretch of a sampled row is left alone where ρ rises in it by less than this share of 1 − ρ."""
NEAR = 0.5
"""A local maximum of the radius is looked at closely where 1 − ρ there is below this share of its mean."""


def _sampled(region: Region, piece: Piece, v: Array) -> tuple[Places, Array, Places, Array]:
    """The same from samples of the spectral radius: changes of sign of ρ − 1, and local maxima below it."""
    theta = np.pi * np.arange(SAMPLES + 1) / SAMPLES
    rows, places, touched_rows, touched = [], [], [], []
    u = piece.u(theta)

    def multipliers(at: Array, r: int) -> NDArray[np.complex128]:
        return _multipliers(region, np.cos(np.arange(piece.series.shape[2]) * at[:, None]) @ piece.series[r].T)

    for r in range(len(piece.rows)):
        values = multipliers(theta, r)
        over = np.abs(values).max(axis=1) - 1
        # Without damping ρ is 1 where stable: its rounding has either sign and would hide where regions begin.
        grows = over > ROUNDING
        changes = np.flatnonzero(grows[:-1] != grows[1:])
        places += ((u[changes] + u[changes + 1]) / 2).tolist()
        rows += [int(piece.rows[r])] * len(changes)
        top = np.flatnonzero((over[1:-1] >= over[:-2]) & (over[1:-1] >= over[2:])) + 1
        top = top[~grows[top] & (-over[top] < NEAR * np.abs(over).mean()) & ~piece.undamped[r]]
        stretches = [(u[k - 1], u[k + 1]) for k in top]
        _, met = meetings(lambda at, own, r=r: multipliers(at, r), theta, values[None])  # type: ignore[misc]
        at, reach = (
            piece.u(met),
            np.abs(piece.u(np.maximum(met - BESIDE, 0)) - piece.u(np.minimum(met + BESIDE, np.pi))),
        )
        stretches += zip(at - reach / 2, at + reach / 2, strict=True)
        touched += stretches
        touched_rows += [int(piece.rows[r])] * len(stretches)
    return (
        np.array(rows, dtype=np.intp), np.array(places),
        np.array(touched_rows, dtype=np.intp), np.array(touched).reshape(-1, 2),
    )  # fmt: skip


def _multipliers(region: Region, entries: Array) -> NDArray[np.complex128]:
    """Eigenvalues (points, m) of monodromy matrices by their entries (points, m²), those set aside left out."""
    m = 2 * region.family.size
    values = np.asarray(np.linalg.eigvals(entries.reshape(-1, m, m)), dtype=complex)
    if region.family.set_aside:
        keep = np.argsort(np.abs(values - 1), axis=1)[:, region.family.set_aside :]
        values = np.take_along_axis(values, keep, axis=1)
    return values


def _settled(region: Region, v: Array, marks: _Marks) -> list[Row]:
    """Verdicts of the gaps between marks, then edges where they change."""
    row, stretch = _flat(marks.close)
    best, top = _highest(region, v[row], stretch) if len(row) else (np.zeros(0), np.zeros(0))
    for r, place, ends, height in zip(row.tolist(), best.tolist(), stretch.tolist(), top.tolist(), strict=True):
        # A stretch whose highest point is unstable is a gap of its own with that point in it.
        if height > 0:
            marks.peaks[r].append(place)
            wide = ends[1] - ends[0]  # where the top is an end, the region goes on beyond it
            marks.at[r] += [ends[0] - wide * (place == ends[0]), ends[1] + wide * (place == ends[1])]
    gaps = [_gaps(region, at, peak) for at, peak in zip(marks.at, marks.peaks, strict=True)]
    which = np.concatenate([np.full(len(g), r) for r, g in enumerate(gaps)]).astype(np.intp)
    probes = np.concatenate([g[:, 2] for g in gaps])
    found = region.judged(probes, v[which])
    unstable = found.radius - 1 > found.error
    kinds = kind_of(found.critical)
    told = (found.verdict != Verdict.UNDECIDED) | (found.error < UNTOLD)
    return _edges(region, v, gaps, which, unstable, np.where(told, found.radius, np.nan), kinds)


def _flat(close: Iterable[list[tuple[float, float]]]) -> tuple[Places, Array]:
    pairs = [(r, ends) for r, own in enumerate(close) for ends in own]
    return np.array([r for r, _ in pairs], dtype=np.intp), np.array([e for _, e in pairs]).reshape(-1, 2)


def _highest(region: Region, v: Array, stretch: Array) -> tuple[Array, Array]:
    """Where ρ is highest in stretches of rows ``v`` (stretches, 2), or above 1, and ρ − 1 less its error there."""
    low, high = stretch[:, 0].copy(), stretch[:, 1].copy()
    best, top = (low + high) / 2, np.full(len(low), -np.inf)
    left = np.arange(len(low))
    for _ in range(ZOOMS):
        shares = np.linspace(0, 1, LOOKS)
        u = low[left, None] + (high - low)[left, None] * shares
        found = region.judged(u.ravel(), np.repeat(v[left], LOOKS))
        height = (found.radius - 1 - found.error).reshape(u.shape)
        told = np.isfinite(height)
        here = np.where(told, height, -np.inf).argmax(axis=1)
        reached = np.take_along_axis(height, here[:, None], 1)[:, 0]
        at = np.take_along_axis(u, here[:, None], 1)[:, 0]
        best[left], top[left] = np.where(reached > top[left], at, best[left]), np.fmax(top[left], reached)
        step = (high - low)[left] / (LOOKS - 1)
        low[left], high[left] = np.maximum(low[left], best[left] - step), np.minimum(high[left], best[left] + step)
        # Meetings lie in the middle of their stretches: where nothing rises there, no region hides.
        flat = reached - np.where(told, height, np.inf).min(axis=1) < RISES * np.abs(reached)
        left = left[~(top[left] > 0) & ~(flat & (not region.by_coefficients))]
        if not len(left):
            break
    return best, top


def _gaps(region: Region, at: list[float], peaks: list[float]) -> Array:
    """Gaps (gaps, 3) of a row: ends and a point inside, by rising u."""
    places = np.unique(np.clip([region.box.u0, *at, region.box.u1], region.box.u0, region.box.u1))
    gaps = np.stack([places[:-1], places[1:], (places[:-1] + places[1:]) / 2], axis=1)
    for peak in peaks:
        k = int(np.clip(np.searchsorted(places, peak) - 1, 0, len(gaps) - 1))
        gaps[k, 2] = peak
    return gaps


def _edges(
    region: Region,
    v: Array,
    gaps: list[Array],
    which: Places,
    unstable: NDArray[np.bool_],
    radius: Array,
    kinds: NDArray[np.int8],
) -> list[Row]:
    """Rows from gaps and their verdicts: neighbouring unstable gaps are one interval, their ends are solved for."""
    every = np.concatenate(gaps)
    changes = np.flatnonzero((which[1:] == which[:-1]) & (unstable[1:] != unstable[:-1]))
    edge = dict(
        zip(changes.tolist(), solved(region, v[which[changes]], every, changes, unstable).tolist(), strict=True)
    )
    rows = []
    for r in range(len(v)):
        own = np.flatnonzero(which == r)
        low, high, inside, kind, clipped = [], [], [], [], []
        k = 0
        while k < len(own):
            if not unstable[own[k]]:
                k += 1
                continue
            first = k
            while k + 1 < len(own) and unstable[own[k + 1]]:
                k += 1
            members = own[first : k + 1]
            top = members[int(np.argmax(radius[members]))]
            clipped.append((first == 0, k == len(own) - 1))
            low.append(region.box.u0 if first == 0 else edge[int(own[first - 1])])
            high.append(region.box.u1 if k == len(own) - 1 else edge[int(own[k])])
            inside.append(every[top, 2])
            kind.append(kinds[top])
            k += 1
        rows.append(
            Row(
                float(v[r]), np.array(low), np.array(high), np.array(inside), np.array(kind, dtype=np.int8),
                np.array(clipped, dtype=bool).reshape(-1, 2), every[own[np.isnan(radius[own])], :2],
                np.full(len(low), BY_ROWS, dtype=np.int8), (frozenset(),) * len(low),
            )
        )  # fmt: skip
    return rows


def solved(region: Region, v: Array, gaps: Array, changes: Places, unstable: NDArray[np.bool_]) -> Array:
    """Where ρ passes 1 between gap ``changes`` and the next, near the mark between them."""
    guess = gaps[changes, 1]
    a, b = gaps[changes, 2], gaps[changes + 1, 2]
    if not len(changes):
        return guess
    wide = region.box.u1 - region.box.u0
    near = np.minimum(TIGHT * wide, 0.5 * np.minimum(guess - a, b - guess))
    low, high = guess - near, guess + near
    rises = unstable[changes + 1]

    def signed(u: Array, pick: Places) -> Array:
        return region.across(u, v[pick])

    ends = signed(np.concatenate([low, high]), np.tile(np.arange(len(v)), 2)).reshape(2, -1)
    good = np.where(rises, (ends[0] < 0) & (ends[1] > 0), (ends[0] > 0) & (ends[1] < 0))
    low, high = np.where(good, low, a), np.where(good, high, b)
    return bracketed(signed, low, high, EXACT * wide)
