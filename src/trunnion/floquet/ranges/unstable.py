"""Unstable speeds of a line over a range: every resonance that may open looked at, every end closed in on.

Two modes grow together about the speeds where their exponents meet (``collisions``). So one looks at every meeting
whose pair may grow or decay more slowly than all else and, where its growth stands out, beside it; at an even grid for
all else; about the fastest growth until it has settled; and between two tops of what is unstable.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Flags, Places
from trunnion.floquet.charts.axes import lowest_speed
from trunnion.floquet.ranges.collisions import RAISED, Collisions, exponent_collisions
from trunnion.floquet.ranges.growing_pairs import GrowingPairs
from trunnion.floquet.ranges.slow_speeds import slow_enough
from trunnion.floquet.ranges.span import Gap, SmoothRange, Span
from trunnion.floquet.stability.stability_over_speed import StabilityOverSpeed
from trunnion.numerics.bracketing import bracketed
from trunnion.numerics.curves import parabola
from trunnion.results.verdict import Verdict

POINTS = 65
"""Speeds of the even grid."""
APART = 25
"""Speeds at equal ratios, over eight octaves at most."""
ROUNDS = 12
SETTLED = 1e-3
"""Share of the fastest growth, or of the slowest decay, that may still be missing."""
ASTRAY = np.array([-4.0, -3.0, -2.0, -1.0, 1.0, 2.0, 3.0, 4.0]) * 1.5e-3
"""Shares of the speed beside a meeting at which one looks too where more than two modes act on each other, so that its
place is not known closely."""
SPARSE = (1, 2, 4)
"""Every first, second or fourth of them on either side: as few as still lie within a third of the meeting's breadth."""
BEYOND = 0.04
"""Share of a stretch over which two modes grow by which one looks beyond and within its ends."""
ENDS = 1e-7
"""How closely the ends of unstable ranges are located, as a share of the speed."""
CLOSER, CONFIRMED = 0.05, 0.45
"""Shares of that to which a pair by itself locates an end, and at which looks on its two sides confirm it."""
VALLEYS = 6
"""Times that one halves the way from the slowest growth between two tops to its neighbours."""
SLOWEST = 20.0
"""Factor below the lowest speed of a chart down to which growth is computed."""

Judge = Callable[[Array], StabilityOverSpeed]


@dataclass(frozen=True)
class UnstableRanges:
    """``along``: stability at all speeds looked at, rising; ``ranges``: unstable from where to where [rad/s]; ``slow``:
    speed [rad/s] up to which the line is stable by a bound, 0 without; ``gaps``: what was not looked at;
    ``about_steady_state``: of a driven line, whether about the periodic motion that it makes and not its static twist;
    ``not_followed``: why not, where its joints swing."""

    along: StabilityOverSpeed
    ranges: tuple[tuple[float, float], ...]
    slow: float
    gaps: tuple[Gap, ...]
    about_steady_state: bool = False
    not_followed: str = ""

    @property
    def undecided(self) -> Flags:
        """Where it could not be decided (speed,)."""
        return np.asarray((self.along.verdict != Verdict.STABLE) & (self.along.verdict != Verdict.UNSTABLE))

    def stable_part(self, pieces: tuple[SmoothRange, ...]) -> list[SmoothRange]:
        """Pieces without what is unstable in them."""
        left = list(pieces)
        for low, high in self.ranges:
            left = [part for piece in left for part in piece.without(low, high)]
        return left


def unstable_ranges(
    span: Span,
    judge: Judge,
    *,
    points: int = POINTS,
    apart: int = APART,
    swing: float | None = None,
    bound: bool = True,
    closely: float = ENDS,
) -> UnstableRanges:
    """Of a line that joints or meshes vary; ``judge``: its stability at speeds (speed,); ``swing``: how far the inputs
    of joints swing at most [rad], where that is known; ``points``, ``apart``: even speeds, and those at equal ratios,
    that one begins with; ``bound``: whether slow speeds are left to one about rigid shafts; ``closely``: how ends are
    located, as a share of the speed.

    Raises
    ------
    InputError : as of ``judge``.
    """
    slow, gaps, start = _slow_end(span, bound)
    low, high = max(span.start, start), span.high
    if low >= high:
        low = high
    even = np.linspace(low, high, points)
    octaves = np.geomspace(max(low, high / 2**8), high, apart)
    met = exponent_collisions(span, low, high, swing)
    met = met.of(met.matters)
    alone = met.raised & (swing is None)  # which follows modes about the static twist
    pairs = GrowingPairs.of(span, met.of(alone), CLOSER * ENDS)
    lost = np.array([at for gap in span.lost for at in (gap.low, (gap.low + gap.high) / 2, gap.high)])
    lost = np.concatenate([lost[(lost >= low) & (lost <= high)], [low, high], pairs.looked_at])
    first = np.setdiff1d(np.concatenate([even, octaves, met.speed]), lost)
    along = judge(np.unique(np.concatenate([first[~pairs.grows(first)], lost])))
    along = _beside_met(along, judge, met.of(met.raised), (low, high), pairs)
    for _ in range(ROUNDS):
        wanted = _rising(along)
        if not len(wanted):
            break
        along = along.beside(judge(wanted))
    for _ in range(ROUNDS):
        wanted = _beside_top(along)
        if not len(wanted):
            break
        along = along.beside(judge(wanted))
    along, ranges = closed_in(between_tops(along, judge), judge, closely)
    inside = np.any([(along.speed > gap.low) & (along.speed < gap.high) for gap in span.lost], axis=0)
    return UnstableRanges(along.of(np.broadcast_to(~inside, along.speed.shape)), ranges, slow, (*gaps, *span.lost))


def _slow_end(span: Span, bound: bool) -> tuple[float, tuple[Gap, ...], float]:
    """The bound below which nothing grows, what lies between it and what can be computed, and where to begin."""
    least = lowest_speed(span.assembly) / SLOWEST
    if span.start >= least:
        return 0.0, (), span.start
    slow = 0.0 if span.put or not bound else slow_enough(span.assembly)
    if slow >= span.high:
        return slow, (), span.high
    begin = max(least, slow, span.start)
    if slow >= least or begin >= span.high:
        return slow, (), min(begin, span.high)
    why = "its shafts are too stiff for so slow a turn: stability is not computed there"
    return slow, (Gap(max(slow, span.low), least, why),), begin


def _beside_met(
    along: StabilityOverSpeed, judge: Judge, met: Collisions, ends: tuple[float, float], pairs: GrowingPairs
) -> StabilityOverSpeed:
    """With two speeds beside every meeting at which growth stands out, of the pair's and of the line's: just beyond the
    stretch over which the two grow, where that is known, and just within where growth has ended beyond; on both sides
    of where one of the ``pairs`` ceases to grow."""
    if not len(met.speed):
        return along
    place, looked = _places(along, met.speed)
    growth = np.where(looked, along.growth_rate[place], np.nan_to_num(met.growth))  # in the stretch of a pair none is
    with np.errstate(invalid="ignore"):
        out = growth > -RAISED * np.maximum(met.decay, 0.0)
    astray = _astray(met.of(np.isnan(met.growth)))  # growth at a wrong place tells nothing of the right one
    seen = (pairs.joined[..., None] * (1 + CONFIRMED * ENDS * np.array([-1.0, 1.0]))).ravel()
    out &= ~pairs.followed(met.speed)
    met, known = met.of(out), ((growth > 0) & (met.half > 0))[out]
    away = np.where(known, (1 + BEYOND) * met.half, 0.5 * met.width)
    beside = met.speed[:, None] + away[:, None] * np.array([-1.0, 1.0])
    top = met.speed[known, None] + 0.5 * met.width[known, None] * np.array([-1.0, 1.0])  # the line's is not the pair's
    along = _looked(along, judge, seen, ends)
    beside_them = np.concatenate([beside.ravel(), top.ravel(), astray])
    along = _looked(along, judge, beside_them[~pairs.grows(beside_them)], ends)
    place, looked = _places(along, beside)
    looked |= (beside <= ends[0]) | (beside >= ends[1])
    ended = looked & (along.verdict[place] == Verdict.STABLE)
    within = (met.speed[:, None] + (1 - BEYOND) * met.half[:, None] * np.array([-1.0, 1.0]))[ended & known[:, None]]
    return _looked(along, judge, within[~pairs.grows(within)], ends)


def _places(along: StabilityOverSpeed, speed: Array) -> tuple[Places, Flags]:
    """Where each ``speed`` stands among those looked at, and whether it does."""
    place = np.minimum(np.searchsorted(along.speed, speed), len(along.speed) - 1)
    return place, np.asarray(along.speed[place] == speed)


def _astray(met: Collisions) -> Array:
    """Speeds beside meetings whose place is not known closely."""
    count = np.abs(np.rint(ASTRAY / np.abs(ASTRAY).min()))
    step = np.abs(ASTRAY).min() * met.speed[:, None] * np.array(SPARSE)
    sparse = np.array(SPARSE)[np.maximum((3 * step <= met.breadth[:, None]).sum(axis=1), 1) - 1]
    return np.asarray((met.speed[:, None] * (1 + ASTRAY))[count % sparse[:, None] == 0])


def _looked(along: StabilityOverSpeed, judge: Judge, at: Array, ends: tuple[float, float]) -> StabilityOverSpeed:
    """With speeds ``at`` that lie between the ``ends``."""
    new = np.setdiff1d(at[(at > ends[0]) & (at < ends[1])], along.speed)
    return along.beside(judge(new)) if len(new) else along


def _rising(along: StabilityOverSpeed) -> Array:
    """Speeds at which growth may be faster than the fastest known, or begin where none is known."""
    known = np.isfinite(along.growth_rate)
    x, v = along.speed[known], along.growth_rate[known]
    if len(x) < 3:
        return np.zeros(0)
    inner = np.arange(1, len(x) - 1)
    where, height, _ = parabola(x, v, inner)
    least = SETTLED * max(abs(v.max()), 1e-300)
    three = np.maximum(np.maximum(v[:-2], v[1:-1]), v[2:])
    with np.errstate(invalid="ignore"):
        good = (height > v.max() + least) | ((height > least) & (three <= 0))
    where = np.unique(where[good])
    near = np.abs(where - x[np.clip(np.searchsorted(x, where), 0, len(x) - 1)])
    before = np.abs(where - x[np.clip(np.searchsorted(x, where) - 1, 0, len(x) - 1)])
    return np.asarray(where[np.minimum(near, before) > ENDS * where])


def _beside_top(along: StabilityOverSpeed) -> Array:
    """Speeds halfway from the fastest growth to its neighbours, where one of them grows so much more slowly that a
    narrow top between them may be missed."""
    known = np.isfinite(along.growth_rate)
    x, v, error = along.speed[known], along.growth_rate[known], along.error[known]
    if len(x) < 2:
        return np.zeros(0)
    k = int(v.argmax())
    beside = np.array([i for i in (k - 1, k + 1) if 0 <= i < len(x)])
    least = 4 * SETTLED * abs(v[k]) + 2 * error[k] * x[k] / along.period
    if (v[k] - v[beside]).max() <= least:
        return np.zeros(0)
    return np.asarray((x[k] + x[beside])[np.abs(x[k] - x[beside]) > ENDS * x[k]] / 2)


def between_tops(along: StabilityOverSpeed, judge: Judge) -> StabilityOverSpeed:
    """With speeds from the slowest growth between two tops of what is unstable halfway to its neighbours, and again,
    where a little of the range between them may be stable."""
    for _ in range(VALLEYS):
        x, v, grows = along.speed, along.growth_rate, along.verdict == Verdict.UNSTABLE
        with np.errstate(invalid="ignore"):
            low = (v[1:-1] <= v[:-2]) & (v[1:-1] <= v[2:])
        k = 1 + np.flatnonzero(low & grows[:-2] & grows[1:-1] & grows[2:])
        apart = np.concatenate([x[k] - x[k - 1], x[k + 1] - x[k]])
        between = np.concatenate([x[k - 1] + x[k], x[k] + x[k + 1]]) / 2
        between = np.unique(between[apart > ENDS * np.tile(x[k], 2)])
        if not len(between):
            break
        along = along.beside(judge(between))
    return along


def closed_in(
    along: StabilityOverSpeed, judge: Judge, closely: float = ENDS
) -> tuple[StabilityOverSpeed, tuple[tuple[float, float], ...]]:
    """With the ends of what is unstable located, ``closely`` as a share of the speed, and the ranges."""
    change = _changes(along)
    change = change[along.speed[change + 1] - along.speed[change] > closely * along.speed[change + 1]]
    low, high = along.speed[change], along.speed[change + 1]
    looked_at = [along]

    def excess(speed: Array, _: Places) -> Array:
        found = judge(speed)
        looked_at.append(found)
        return _excess(found)

    if len(change):
        known = _excess(along.of(change)), _excess(along.of(change + 1))
        bracketed(excess, low, high, closely * high / 2, known)
        for found in looked_at[1:]:
            along = along.beside(found)
    change = _changes(along)
    grows = along.verdict == Verdict.UNSTABLE
    starts, ends = (along.speed[change[grows[change + 1]] + 1].tolist(), along.speed[change[grows[change]]].tolist())
    if len(grows) and grows[0]:
        starts.insert(0, float(along.speed[0]))
    if len(grows) and grows[-1]:
        ends.append(float(along.speed[-1]))
    return along, tuple(zip(starts, ends, strict=True))


def _changes(along: StabilityOverSpeed) -> Places:
    """Places (change,) after which a line is unstable that was not, or no more."""
    grows = along.verdict == Verdict.UNSTABLE
    return np.flatnonzero(grows[1:] != grows[:-1])


def _excess(along: StabilityOverSpeed) -> Array:
    """How far radii lie above 1 beyond doubt: above 0 where the line is unstable and nowhere else."""
    size = np.maximum(np.abs(np.nan_to_num(along.radius - 1 - along.error, nan=1.0, posinf=1.0, neginf=1.0)), 1e-300)
    return np.where(along.verdict == Verdict.UNSTABLE, size, -size)
