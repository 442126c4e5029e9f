"""The unstable intervals of rows y = const.

Up to three unknowns every change of stability is a zero of a boundary function, and the zeros along a row are all found
(``series_roots``). Between two of them the verdict does not change, so one point integrated by itself decides. Edges
are then solved for with points of their own, so that they owe nothing to the patches.

More unknowns are sampled, in two passes: by eigenvalues of interpolated matrices, denser where a local maximum of the
radius comes near 1; and where two multipliers meet (``multiplier_collisions``), however narrow the region there.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from enum import IntEnum
from functools import partial
from itertools import chain

import numpy as np

from trunnion.arrays import Array, Codes, Complex, Flags, Places
from trunnion.floquet.tongues.boundaries import boundary_functions
from trunnion.floquet.tongues.multiplier_collisions import multiplier_collisions
from trunnion.floquet.tongues.region import PatchRows, Region
from trunnion.floquet.tongues.series_roots import row_roots
from trunnion.numerics.bracketing import bracketed
from trunnion.results.verdict import Verdict

Marks = tuple[Places, Array, Places, Array]
"""Rows and places u of marks between which the verdict does not change; rows and ends (stretches, 2) of what is to be
looked at closely."""

TIGHT = 1e-7
"""Half of the first bracket about a zero of the patches, as a share of the box."""
OPEN_ERROR = 1e-6
"""An error of ρ above which an open verdict is not an answer; below, ρ is 1 as far as anybody asks."""
EXACT = 1e-14
"""How closely edges are solved, as a share of the box."""
LOOKS = 9
"""Points looked at in a stretch where a boundary may just be touched, in each of ``ZOOMS`` rounds."""
ZOOMS = 4


BY_ROWS, BY_RESONANCES = 1, 2
"""Which search found an interval."""


class InstabilityKind(IntEnum):
    """How the multipliers leave the unit circle; codes of arrays."""

    POSITIVE = 0
    NEGATIVE = 1
    COMPLEX = 2

    def __str__(self) -> str:
        return {0: "real positive", 1: "real negative", 2: "complex pair"}[self]


def kind_of(critical: Complex) -> Codes:
    """Kinds of critical multipliers."""
    real = np.abs(critical.imag) <= 1e-9 * np.abs(critical)
    return np.where(
        ~real, InstabilityKind.COMPLEX, np.where(critical.real > 0, InstabilityKind.POSITIVE, InstabilityKind.NEGATIVE)
    ).astype(np.int8)


@dataclass(frozen=True)
class TongueRow:
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
    kind: Codes
    clipped: Flags
    unknown: Array
    by: Codes
    of: tuple[frozenset[int], ...]

    def __len__(self) -> int:
        return len(self.low)


def unstable_intervals(region: Region, v: Array) -> list[TongueRow]:
    """The unstable intervals of rows ``v``, each found from end to end."""
    v = np.atleast_1d(np.asarray(v, dtype=float))
    if region.family.passive:
        return [stable_row(float(own)) for own in v]
    found = (_zeros(piece) if region.by_coefficients else _sampled(region, piece) for piece in region.pieces(v))
    row, at, close_row, close = (np.concatenate(part) for part in zip(*chain.from_iterable(found), strict=True))
    return settled(region, v, (row, at), (np.zeros(0, dtype=np.intp), np.zeros(0)), (close_row, close))


def stable_row(v: float) -> TongueRow:
    """A row on which nothing grows."""
    none = np.zeros(0)
    return TongueRow(
        v=v, low=none, high=none, inside=none, kind=none.astype(np.int8), clipped=np.zeros((0, 2), bool),
        unknown=np.zeros((0, 2)), by=none.astype(np.int8), of=(),
    )  # fmt: skip


def unknown_row(region: Region, v: float) -> TongueRow:
    """A row of which nothing is known."""
    return replace(stable_row(v), unknown=np.array([[region.box.u0, region.box.u1]]))


def looked_at(region: Region, rows: list[TongueRow], stretches: list[Array]) -> list[TongueRow]:
    """Rows with what lies in ``stretches`` (stretches, 2) of each row added to what was known of it."""
    known = [k for k, own in enumerate(stretches) if len(own)]
    if not known:
        return rows
    ends = [np.concatenate([rows[k].low[~rows[k].clipped[:, 0]], rows[k].high[~rows[k].clipped[:, 1]]]) for k in known]
    peaks, close = [rows[k].inside for k in known], [stretches[k] for k in known]
    v = np.array([rows[k].v for k in known])
    found = dict(zip(known, settled(region, v, _of_rows(ends), _of_rows(peaks), _of_rows(close)), strict=True))
    return [replace(found[k], unknown=row.unknown) if k in found else row for k, row in enumerate(rows)]


def _of_rows(parts: list[Array]) -> tuple[Places, Array]:
    return np.repeat(np.arange(len(parts)), [len(part) for part in parts]), np.concatenate(parts)


def _zeros(piece: PatchRows) -> Iterator[Marks]:
    """Rows and places of all zeros of boundary functions on a piece, and of stretches that may touch one."""
    for undamped in (False, True):
        own = np.flatnonzero(piece.undamped == undamped)
        if len(own):
            functions = partial(boundary_functions, undamped=undamped)
            found = row_roots(piece.series[own], piece.errors[own], functions, piece.series.shape[1] - 1)
            touched = piece.u(found.touched)
            yield piece.rows[own[found.row]], piece.u(found.theta), piece.rows[own[found.touched_row]], touched


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


def _sampled(region: Region, piece: PatchRows) -> Iterator[Marks]:
    """The same from samples of the spectral radius: changes of sign of ρ − 1, and local maxima below it."""
    theta = np.pi * np.arange(SAMPLES + 1) / SAMPLES
    u = piece.u(theta)

    def multipliers(at: Array, r: int) -> Complex:
        return _multipliers(region, np.cos(np.arange(piece.series.shape[2]) * at[:, None]) @ piece.series[r].T)

    for r, row in enumerate(piece.rows):
        values = multipliers(theta, r)
        over = np.abs(values).max(axis=1) - 1
        # Without damping ρ is 1 where stable: its rounding has either sign and would hide where regions begin.
        grows = over > ROUNDING
        changes = np.flatnonzero(grows[:-1] != grows[1:])
        top = np.flatnonzero((over[1:-1] >= over[:-2]) & (over[1:-1] >= over[2:])) + 1
        top = top[~grows[top] & (-over[top] < NEAR * np.abs(over).mean()) & ~piece.undamped[r]]
        _, met = multiplier_collisions(lambda at, own, r=r: multipliers(at, r), theta, values[None])  # type: ignore[misc]
        reach = np.abs(piece.u(np.maximum(met - BESIDE, 0)) - piece.u(np.minimum(met + BESIDE, np.pi)))
        beside = [np.stack([u[top - 1], u[top + 1]], axis=1), piece.u(met)[:, None] + reach[:, None] * [-0.5, 0.5]]
        close = np.concatenate(beside)
        yield np.full(len(changes), row), (u[changes] + u[changes + 1]) / 2, np.full(len(close), row), close


def _multipliers(region: Region, entries: Array) -> Complex:
    """Eigenvalues (points, m) of monodromy matrices by their entries (points, m²), those set aside left out."""
    m = 2 * region.family.size
    values = np.asarray(np.linalg.eigvals(entries.reshape(-1, m, m)), dtype=complex)
    if region.family.set_aside:
        keep = np.argsort(np.abs(values - 1), axis=1)[:, region.family.set_aside :]
        values = np.take_along_axis(values, keep, axis=1)
    return values


def settled(
    region: Region, v: Array, marks: tuple[Places, Array], peaks: tuple[Places, Array], close: tuple[Places, Array]
) -> list[TongueRow]:
    """Verdicts of the gaps between marks, then edges where they change.

    Each of rows and places: ``marks``, between which the verdict does not change, ``peaks``, points inside regions, and
    ``close``, stretches (stretches, 2) to be looked at closely.
    """
    row, ends = close[0], np.sort(close[1], axis=1)
    best, top = _highest(region, v[row], ends)
    # A stretch whose highest point is unstable is a gap of its own with that point in it; where the top is an end, the
    # region goes on beyond it.
    beyond = ends + (ends[:, 1:] - ends[:, :1]) * (best[:, None] == ends) * [-1.0, 1.0]
    row, best, beyond = row[top > 0], best[top > 0], beyond[top > 0]
    owner, at = np.concatenate([marks[0], np.repeat(row, 2)]), np.concatenate([marks[1], beyond.ravel()])
    peaked, peak = np.concatenate([peaks[0], row]), np.concatenate([peaks[1], best])
    gaps = [_gaps(region, at[owner == r], peak[peaked == r]) for r in range(len(v))]
    which, every = _of_rows(gaps)
    found = region.judged(every[:, 2], v[which])
    unstable = found.radius - 1 > found.error
    decided = (found.verdict != Verdict.UNDECIDED) | (found.error < OPEN_ERROR)
    return _edges(region, v, every, which, unstable, np.where(decided, found.radius, np.nan), kind_of(found.critical))


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
        decided = np.isfinite(height)
        here = np.where(decided, height, -np.inf).argmax(axis=1)
        reached = np.take_along_axis(height, here[:, None], 1)[:, 0]
        at = np.take_along_axis(u, here[:, None], 1)[:, 0]
        best[left], top[left] = np.where(reached > top[left], at, best[left]), np.fmax(top[left], reached)
        step = (high - low)[left] / (LOOKS - 1)
        low[left], high[left] = np.maximum(low[left], best[left] - step), np.minimum(high[left], best[left] + step)
        # Meetings lie in the middle of their stretches: where nothing rises there, no region hides.
        flat = reached - np.where(decided, height, np.inf).min(axis=1) < RISES * np.abs(reached)
        left = left[~(top[left] > 0) & ~(flat & (not region.by_coefficients))]
        if not len(left):
            break
    return best, top


def _gaps(region: Region, at: Array, peaks: Array) -> Array:
    """Gaps (gaps, 3) of a row: ends and a point inside, by rising u."""
    low, high = region.box.u0, region.box.u1
    places = np.unique(np.clip(np.concatenate([[low, high], at]), low, high))
    gaps = np.stack([places[:-1], places[1:], (places[:-1] + places[1:]) / 2], axis=1)
    gaps[np.clip(np.searchsorted(places, peaks) - 1, 0, len(gaps) - 1), 2] = peaks
    return gaps


def _edges(
    region: Region,
    v: Array,
    gaps: Array,
    which: Places,
    unstable: Flags,
    radius: Array,
    kinds: Codes,
) -> list[TongueRow]:
    """Rows from gaps and their verdicts: neighbouring unstable gaps are one interval, their ends are solved for."""
    same = which[1:] == which[:-1]
    changes = np.flatnonzero(same & (unstable[1:] != unstable[:-1]))
    edge = np.full(len(gaps), np.nan)  # behind each gap
    edge[changes] = solved(region, v[which[changes]], gaps, changes, unstable)
    # Intervals by their first and last gap, and whether those are the first and last of the row.
    first = np.flatnonzero(unstable & ~np.append(False, same & unstable[:-1]))
    last = np.flatnonzero(unstable & ~np.append(same & unstable[1:], False))
    clipped = np.stack([np.append(True, ~same)[first], np.append(~same, True)[last]], axis=1)
    low = np.where(clipped[:, 0], region.box.u0, edge[first - 1])
    high = np.where(clipped[:, 1], region.box.u1, edge[last])
    top = np.array([a + radius[a : b + 1].argmax() for a, b in zip(first, last, strict=True)], dtype=np.intp)
    rows = []
    for r in range(len(v)):
        own = which[first] == r
        unknown = gaps[(which == r) & np.isnan(radius), :2]
        by, of = np.full(own.sum(), BY_ROWS, dtype=np.int8), (frozenset[int](),) * int(own.sum())
        inside, kind = gaps[top[own], 2], kinds[top[own]]
        row = TongueRow(
            v=float(v[r]), low=low[own], high=high[own], inside=inside, kind=kind, clipped=clipped[own],
            unknown=unknown, by=by, of=of,
        )  # fmt: skip
        rows.append(row)
    return rows


def solved(region: Region, v: Array, gaps: Array, changes: Places, unstable: Flags) -> Array:
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
