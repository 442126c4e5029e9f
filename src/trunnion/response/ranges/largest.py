"""The largest values of a response over a range of speeds, each with what it may be low by.

Within a piece (``span``) a response is smooth but near its poles. The search looks at an even grid, at every resonance
and beside it, and then wherever a larger value may hide:

- Between three neighbouring speeds every complex amplitude is read as (a + bΩ)/(Ω − p), which a resonance is close to
  its pole. Where the pole p so found lies by, and the amplitude there would bring the sum above the largest known, one
  looks.
- About the highest speeds a parabola tells where the top is and how high, until it tells nothing more.

It ends when nothing is expected to rise by more than ``tolerance`` of the largest. A maximum of curves meets no maximum
where one takes over from another: it bends upwards there, so tops are smooth.
"""

from __future__ import annotations

from bisect import bisect
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, fields, replace
from itertools import pairwise
from math import inf

import numpy as np

from trunnion.arrays import Array, Complex, Flags, Integers, Places
from trunnion.equations.coefficients import Assembly
from trunnion.floquet.ranges.resonances import Resonances
from trunnion.floquet.ranges.span import SmoothRange
from trunnion.numerics.curves import parabola
from trunnion.response.orders.response import response_of_spectrum
from trunnion.response.orders.result import OrderResponse
from trunnion.steady.orders.amplitudes import Range, joined
from trunnion.waiting import OutOfTime

POINTS = 65
"""Speeds of the even grid."""
PER_OCTAVE = 6
"""Speeds that each halving of the range gets at least."""
OCTAVES = 8
TOLERANCE = 1e-6
"""Share of the largest value that may still be missing."""
MOST_ROUNDS = 24
AT_ONCE = 6
"""Speeds that one quantity may ask for in a round."""
FLAT = 0.01
"""Share by which neighbours of a top may lie below it for a parabola through them to hold."""
BEND = 0.02
"""Error of a parabola's top, as a share of how far its ends lie below it: that of a resonance is a fifth."""
END = 0.1
"""How far a top beside the end of a piece may rise above the end, as a share of what the next speed lies below it."""
HIGH_ENOUGH = 0.7
"""Share of the largest value, roughly looked at, from which a top may turn out to be the largest."""
CAUTION = 1.5
"""Factor on what a pole is expected to add."""
CLOSE = 0.05
"""Share of the distance between neighbours within which a top has been looked at."""
SEEN = 0.15
"""Share of its half-width nearer than which a resonance has been looked at."""
SHARPENING, SHARP = 12, 1e-8
"""Rounds in which the speed of a top is located, and how closely, as a share."""
PASSED = 1e-6
"""How closely the speeds are located at which a level is passed, as a share."""
BRACKET = 0.05
"""Share of the distance of two speeds within which their chord is trusted to pass a level."""
NEXT, ROUNDING = 0.1, 1e-12
"""Shares of the width of a top, and of a speed, nearer than which two speeds count as one."""


@dataclass(frozen=True)
class SearchedQuantity:
    """What is largest somewhere: ``values`` (speed,), and amplitudes by order (speed, order) that make them up.

    ``squared``: values are the sum of squares of the amplitudes, as of heat; else of no more than their sum. ``level``:
    where values rise above it counts as well, everywhere. ``alike``: a name for the amplitudes and a factor; those of
    quantities with the same name are the same but for their factors.
    """

    values: Callable[[OrderResponse], Array]
    parts: Callable[[OrderResponse], Complex]
    squared: bool = False
    level: float = inf
    alike: tuple[Hashable, float] | None = None


@dataclass(frozen=True)
class Largest:
    """Largest values (quantity,) over the speeds of ``response``, at which of them, and what each may be low by
    (quantity,). Infinite where there is no steady state. ``ended``: what ended the search before it was done, as a
    clause, "" where it was done; then nothing is known of what a value may be low by, and errors are infinite."""

    response: OrderResponse
    at: Array
    value: Array
    error: Array
    ended: str = ""


@dataclass(frozen=True)
class PossiblePeaks:
    """Speeds (place,) [rad/s] at which more may hide, how high (place,), and how wide (place,) [rad/s] the top is."""

    speed: Array
    height: Array
    scale: Array

    def of(self, which: Flags | Integers) -> PossiblePeaks:
        """Some of them."""
        return PossiblePeaks(self.speed[which], self.height[which], self.scale[which])

    def over(self, top: float) -> PossiblePeaks:
        """Heights as shares of ``top``."""
        return replace(self, height=self.height / top)


@dataclass(frozen=True)
class Poles:
    """Resonances of some amplitudes that stand between three neighbours, and how high each order is there and beside,
    the speeds known by then: ``at`` (pole,) [rad/s], the ``middle`` of the three (pole,) [rad/s], the ``order`` (pole,)
    by its column, its amplitude ``there`` (pole,), and the half-``width`` (pole,) [rad/s]."""

    at: Array
    middle: Array
    order: Integers
    there: Array
    width: Array

    def of(self, which: Flags | Integers) -> Poles:
        """Some of them."""
        return Poles(*(getattr(self, one.name)[which] for one in fields(self)))

    def with_others(self, others: Poles) -> Poles:
        """All of both, in the order of their neighbours."""
        every = Poles(*(np.concatenate([getattr(o, one.name) for o in (self, others)]) for one in fields(self)))
        return every.of(np.argsort(every.middle, kind="stable"))

    def seen_from(self, x: Array, f: Complex) -> SeenPoles:
        """Beside the amplitudes ``f`` (speed, order) at speeds ``x`` (speed,); without those that were looked at."""
        place = np.clip(np.searchsorted(x, self.at), 1, len(x) - 1)
        low, high = x[place - 1], x[place]
        share = (self.at - low) / (high - low)
        unseen = np.flatnonzero(np.minimum(np.abs(self.at - low), np.abs(high - self.at)) > SEEN * self.width)
        here = (1 - share) * np.abs(f[place - 1, self.order]) + share * np.abs(f[place, self.order])
        scale = np.minimum(self.width, high - low)
        return SeenPoles(self.at, place, share, self.there, here, scale).of(unseen)


@dataclass(frozen=True)
class SeenPoles:
    """Resonances ``at`` (pole,) [rad/s], each between the speeds at ``place`` - 1 and ``place``, at this ``share`` of
    the way; the amplitude ``there`` and what the speeds beside it show ``here``; ``scale`` (pole,) [rad/s]: how wide
    the top is."""

    at: Array
    place: Places
    share: Array
    there: Array
    here: Array
    scale: Array

    def of(self, which: Flags | Integers) -> SeenPoles:
        """Some of them."""
        return SeenPoles(*(getattr(self, one.name)[which] for one in fields(self)))

    def worth_a_look(self, v: Array, wanted: SearchAim, factor: float, *, squared: bool) -> PossiblePeaks:
        """Of a quantity with values ``v`` (speed,), whose amplitudes are those of the resonances times a factor."""
        there, here = self.there, self.here
        gain = factor * np.maximum(there**2 - here**2 if squared else there - here, 0.0)
        before, behind = v[self.place - 1], v[self.place]
        height = (1 - self.share) * before + self.share * behind + CAUTION * gain
        good = wanted.by(height, np.maximum(before, behind))
        return PossiblePeaks(self.at[good], height[good], self.scale[good])


def _together(parts: Sequence[PossiblePeaks]) -> PossiblePeaks:
    some = [part for part in parts if len(part.speed)]
    if len(some) == 1:
        return some[0]
    none = np.zeros(0)
    return PossiblePeaks(
        *(np.concatenate([none, *(getattr(part, key) for part in some)]) for key in ("speed", "height", "scale"))
    )


def first_speeds(pieces: Sequence[SmoothRange], met: Resonances, points: int = POINTS) -> list[Array]:
    """Speeds to begin with, by piece: evenly, closer towards slow ones, and about every resonance."""
    low, high = pieces[0].low, pieces[-1].high
    even = np.linspace(low, high, points)
    octaves = np.geomspace(max(low, high / 2**OCTAVES), high, PER_OCTAVE * OCTAVES + 1) if low < high else even
    width = np.maximum(met.width, 1e-9 * met.speed)
    about = (met.speed[:, None] + width[:, None] * np.array([-1.0, 0.0, 1.0])).ravel()
    every = np.concatenate([even, octaves, about])
    return [_within(every, piece) for piece in pieces]


def thinned(
    around: OrderResponse, pieces: Sequence[SmoothRange], quantities: Sequence[SearchedQuantity], points: int
) -> list[Array]:
    """Speeds to begin with after a rough look ``around``, by piece: few evenly, and about every top that may be the
    largest."""
    x = around.speed
    kept = [np.linspace(pieces[0].low, pieces[-1].high, points)]
    for quantity in quantities:
        v = quantity.values(around)
        least = min(HIGH_ENOUGH * float(np.where(np.isfinite(v), v, np.inf).max()), quantity.level)
        inner = np.flatnonzero((v[1:-1] >= v[:-2]) & (v[1:-1] >= v[2:]) & (v[1:-1] >= least)) + 1
        kept += [x[inner], x[inner - 1], x[inner + 1], x[[int(np.argmax(v))]]]
    every = np.concatenate(kept)
    return [_within(every, piece) for piece in pieces]


def _within(speeds: Array, piece: SmoothRange) -> Array:
    inside = speeds[(speeds > piece.low) & (speeds < piece.high)]
    return np.unique(np.concatenate([[piece.low], inside, [piece.high]]))


def search(
    assembly: Assembly,
    respond: Callable[[Array], OrderResponse],
    first: Sequence[Array],
    quantities: Sequence[SearchedQuantity],
    *,
    tolerance: float = TOLERANCE,
    rounds: int = MOST_ROUNDS,
    passed: float = PASSED,
    known: OrderResponse | None = None,
) -> Largest:
    """The largest values of ``quantities`` over pieces that begin with the speeds ``first``.

    ``respond`` : the response at speeds (speed,), not judged. ``passed`` : how closely the speeds are located at which
    a level is passed, as a share. ``known`` : the response at ``first``, where it is known already.

    Raises
    ------
    InputError, ComputationError : as of ``respond``. OutOfTime : the time was up before the first speeds were known.
    """
    seen = _SearchedRanges(assembly, respond, quantities)
    seen.look([np.asarray(part) for part in first], known)
    try:
        for _ in range(rounds):
            wanted = seen.wanted(tolerance)
            if not sum(map(len, wanted)):
                break
            seen.look(wanted)
        seen.close_in(passed)
    except OutOfTime as error:
        found = seen.largest(tolerance)
        return replace(found, error=np.full(len(found.value), inf), ended=error.why)
    return seen.largest(tolerance)


class _SearchedRanges:
    """What is known of some quantities, piece by piece."""

    def __init__(
        self, assembly: Assembly, respond: Callable[[Array], OrderResponse], quantities: Sequence[SearchedQuantity]
    ) -> None:
        self.assembly, self.respond, self.quantities = assembly, respond, quantities
        self.response: OrderResponse | None = None
        self.ranges: dict[str, Range] = {}  # over the cycle, what every look computed anyway
        self.values = np.zeros((0, len(quantities)))
        self.piece = np.zeros(0, dtype=np.intp)
        self.looks = 0
        self.look_of = np.zeros(0, dtype=np.intp)  # the look (speed,) in which each was new
        # By amplitudes and piece, as after a look.
        self.poles: dict[tuple[Hashable, int], tuple[int, Poles, SeenPoles]] = {}
        self.columns: tuple[list[float], list[float]] = [], []  # order and frequency of the amplitudes
        self.parabolas: dict[int, tuple[int, Parabolas]] = {}  # by piece, as after a look
        self.parts: tuple[int, int, Complex] = (0, -1, np.zeros((0, 0), dtype=complex))  # after a look, of a quantity

    def look(self, wanted: Sequence[Array], known: OrderResponse | None = None) -> None:
        """Take in the speeds ``wanted`` of each piece, where they are ``known`` as they are."""
        speeds = np.concatenate(list(wanted))
        piece = np.repeat(np.arange(len(wanted)), [len(part) for part in wanted])
        new = known or self.respond(speeds)
        values = np.stack([q.values(new) for q in self.quantities], axis=1) if self.quantities else self.values[:0]
        before, ranges = None if self.response is None else self.ranges, new.known_ranges
        parts = [new.spectrum] if self.response is None else [self.response.spectrum, new.spectrum]
        del new, known
        self.response = None  # of many speeds it is large
        together, order = joined(parts)
        self.ranges = {
            name: one.rows(order) if before is None else before[name].with_rows(one).rows(order)
            for name, one in ranges.items()
            if before is None or name in before
        }
        self.response = response_of_spectrum(self.assembly, together, remarked=False)
        columns = self.response.order.tolist(), self.response.frequency.tolist()
        if columns != self.columns:  # an order that is not worth listing any more, or is now
            self.columns, self.poles = columns, {}
        self.values = np.concatenate([self.values, values.reshape(len(speeds), -1)])[order]
        self.piece = np.concatenate([self.piece, piece])[order]
        self.looks += 1
        self.look_of = np.concatenate([self.look_of, np.full(len(speeds), self.looks)])[order]

    @property
    def _runs(self) -> list[slice]:
        """Where each piece stands among the speeds."""
        ends = np.searchsorted(self.piece, np.arange(self.piece[-1] + 2)).tolist()
        return [slice(a, b) for a, b in pairwise(ends)]

    def wanted(self, tolerance: float) -> list[Array]:
        """Speeds at which a larger value may hide, by piece."""
        found: list[list[PossiblePeaks]] = [[] for _ in self._runs]
        for q in range(len(self.quantities)):
            top = self._top(q)
            if np.isfinite(top) and top > 0:
                every = self._hidden(q, top, tolerance)
                ranked = np.sort(np.concatenate([one.height for one in every]))[::-1]
                least = ranked[AT_ONCE - 1] if len(ranked) >= AT_ONCE else -np.inf
                for k, one in enumerate(every):
                    found[k].append(one.of(one.height >= least).over(top))
        return [self._apart(_together(part), run) for part, run in zip(found, self._runs, strict=True)]

    def close_in(self, passed: float) -> None:
        """Look where quantities pass their levels, until that is located."""
        while True:
            wanted = [
                self._apart(_together([self._passes(q, run, passed) for q in self._levels]), run) for run in self._runs
            ]
            if not sum(map(len, wanted)):
                break
            self.look(wanted)

    @property
    def _levels(self) -> list[int]:
        return [q for q, quantity in enumerate(self.quantities) if np.isfinite(quantity.level)]

    def _passes(self, q: int, run: slice, passed: float) -> PossiblePeaks:
        """On either side of where a chord passes the level between neighbours that it lies between, and in their middle
        where that is elsewhere."""
        assert self.response is not None
        x, v = self.response.speed[run], self.values[run, q]
        above = ~(v <= self.quantities[q].level)
        here = np.flatnonzero((above[1:] != above[:-1]) & (x[1:] - x[:-1] > passed * x[1:]))
        wide, low, high = x[here + 1] - x[here], v[here], v[here + 1]
        with np.errstate(invalid="ignore"):
            share = (self.quantities[q].level - low) / (high - low)
        known = np.isfinite(low) & np.isfinite(high)  # else the middle
        reach = np.maximum(BRACKET * wide, passed * x[here] / 3)
        middle, chord = x[here] + wide / 2, x[here] + wide * np.where(known, share, 0.5)
        apart = np.abs(middle - chord) > reach
        wanted = np.concatenate([chord - reach, chord + reach, middle])
        inside = (wanted > np.tile(x[here], 3)) & (wanted < np.tile(x[here + 1], 3))
        inside[2 * len(here) :] &= apart
        return PossiblePeaks(wanted, np.ones(len(wanted)), np.tile(reach, 3)).of(inside)

    def _top(self, q: int) -> float:
        column = self.values[:, q]
        return float(np.max(np.where(np.isfinite(column), column, np.inf), initial=0.0))

    def _hidden(self, q: int, top: float, tolerance: float) -> list[PossiblePeaks]:
        """Where quantity ``q`` may rise above its ``top``, by piece."""
        assert self.response is not None
        aim = SearchAim(top * (1 + tolerance / 4), self.quantities[q].level)
        found = []
        for k, run in enumerate(self._runs):
            x, v = self.response.speed[run], self.values[run, q]
            if len(x) < 3:
                found.append(_together([]))
                continue
            tops = self._parabolas(k, run).tops(x, v, q, aim)
            found.append(_together([tops, *_ends(x, v, aim), self._resonances(q, k, run, v, aim)]))
        return found

    def _parabolas(self, k: int, run: slice) -> Parabolas:
        """Of all quantities in piece ``k``."""
        assert self.response is not None
        look, kept = self.parabolas.get(k, (0, None))
        if kept is None or look < self.looks:
            kept = Parabolas.of(self.response.speed[run], self.values[run])
            self.parabolas[k] = self.looks, kept
        return kept

    def _resonances(self, q: int, k: int, run: slice, v: Array, aim: SearchAim) -> PossiblePeaks:
        """Of quantity ``q``, ``v`` (speed,) in piece ``k``."""
        quantity = self.quantities[q]
        name, factor = quantity.alike or ((q,), 1.0)
        look, known, seen = self.poles.get((name, k), (0, None, None))
        if seen is None or look < self.looks and (self.look_of[run] > look).any():
            known, seen = self._poles(q, run, look, known, factor)
        assert known is not None
        self.poles[name, k] = self.looks, known, seen
        return seen.worth_a_look(v, aim, factor, squared=quantity.squared)

    def _poles(self, q: int, run: slice, look: int, kept: Poles | None, factor: float) -> tuple[Poles, SeenPoles]:
        """Of the amplitudes of quantity ``q`` in a piece; those are kept about which no speed is new since a look."""
        assert self.response is not None
        x, f = self.response.speed[run], self._parts(q)[run] / factor
        about = _beside(self.look_of[run] > look)
        found = _poles(x, f, np.flatnonzero(about) + 1)
        if kept is not None:
            found = kept.of(~about[np.searchsorted(x, kept.middle) - 1]).with_others(found)
        return found, found.seen_from(x, f)

    def _parts(self, q: int) -> Complex:
        """Amplitudes (speed, order) of quantity ``q``, those of the last that was asked for kept."""
        look, of, parts = self.parts
        if look != self.looks or of != q:
            assert self.response is not None
            parts = self.quantities[q].parts(self.response)
            parts = parts if np.all(np.isfinite(parts)) else np.nan_to_num(parts)
            self.parts = self.looks, q, parts
        return parts

    def _apart(self, wanted: PossiblePeaks, run: slice) -> Array:
        """Speeds that are not next to each other, nor to known ones: of several at one top the highest."""
        assert self.response is not None
        known = self.response.speed[run].tolist()
        found: list[float] = []
        for i in np.argsort(-wanted.height):
            speed, near = float(wanted.speed[i]), NEXT * float(wanted.scale[i]) + ROUNDING * float(wanted.speed[i])
            place = bisect(known, speed)
            closest = min((abs(speed - one) for one in known[max(place - 1, 0) : place + 1]), default=np.inf)
            if closest > ROUNDING * speed and all(abs(speed - one) > near for one in found):
                found.append(speed)
        return np.sort(np.array(found))

    def largest(self, tolerance: float) -> Largest:
        """What was found, with what is still expected to hide."""
        assert self.response is not None
        at, value, error = (np.zeros(len(self.quantities)) for _ in range(3))
        for q in range(len(self.quantities)):
            column = np.where(np.isfinite(self.values[:, q]), self.values[:, q], np.inf)
            place = int(np.argmax(column))
            at[q], value[q] = place, column[place]
            if np.isfinite(value[q]) and value[q] > 0:
                hidden = [one.height for one in self._hidden(q, value[q], tolerance)]
                more = np.max(np.concatenate(hidden), initial=value[q]) - value[q]
                bend = max(self._bend(q, run, place) for run in self._runs)
                error[q] = max(more, bend, tolerance / 4 * value[q])  # less than that is not looked for
        response = response_of_spectrum(self.assembly, self.response.spectrum).knowing(self.ranges)
        return Largest(response, at.astype(np.intp), value, error)

    def _bend(self, q: int, run: slice, place: int) -> float:
        """By how much the top at ``place`` may be low, if it lies in this piece."""
        assert self.response is not None
        i = place - run.start
        if not 0 < i < run.stop - run.start - 1:
            return 0.0
        x, v = self.response.speed[run], self.values[run, q]
        _, height, fall = parabola(x, v, np.array([i]))
        return float(np.nanmax([height[0] - v[i], 0.0]) + BEND * fall[0])


@dataclass(frozen=True)
class SearchAim:
    """What is worth a look: more than is known, or anything above a level where nothing is known to be."""

    more: float
    level: float

    def by(self, height: Array, known: Array) -> Flags:
        """Whether a ``height`` (place,) beside values that are ``known`` (place,) is."""
        with np.errstate(invalid="ignore"):
            return np.asarray((height > self.more) | ((height > self.level) & (known <= self.level)))


def _beside(new: Flags) -> Flags:
    """Which of the inner places have one that is ``new`` within two places: these tell what stands there."""
    near = new.copy()
    for apart in (1, 2):
        near[apart:] |= new[:-apart]
        near[:-apart] |= new[apart:]
    return near[1:-1]


@dataclass(frozen=True)
class Parabolas:
    """Through every three neighbours, of every quantity (inner place, quantity): where their tops are, how high these
    may be, NaN without one, and the largest of the three values; ``highest`` (quantity,) of all that they may be."""

    where: Array
    above: Array
    known: Array
    highest: Array

    @classmethod
    def of(cls, x: Array, v: Array) -> Parabolas:
        """Of values ``v`` (speed, quantity) at speeds ``x`` (speed,)."""
        finite = np.isfinite(v)
        with np.errstate(invalid="ignore", over="ignore"):
            where, height, fall = parabola(x[:, None], v, np.arange(1, len(x) - 1))
            above = height + np.where(fall > FLAT * height, BEND * fall, 0.0)
        above[~(finite[:-2] & finite[1:-1] & finite[2:])] = np.nan
        highest = np.where(np.isnan(above), -inf, above).max(axis=0, initial=-inf)
        return cls(where, above, np.maximum(np.maximum(v[:-2], v[1:-1]), v[2:]), highest)

    def tops(self, x: Array, v: Array, q: int, wanted: SearchAim) -> PossiblePeaks:
        """Places to look at for tops of quantity ``q`` that may be the largest: those of parabolas, and between them
        and their neighbours where these lie too far below."""
        if not self.highest[q] > min(wanted.more, wanted.level):
            return _together([])
        inner = np.flatnonzero(wanted.by(self.above[:, q], self.known[:, q])) + 1
        if not len(inner):
            return _together([])
        where, above = self.where[inner - 1, q], self.above[inner - 1, q]
        place = np.clip(np.searchsorted(x, where), 1, len(x) - 1)
        low, high = x[place - 1], x[place]
        # A top that has been looked at is closed in on from both sides.
        known = np.minimum(where - low, high - where) < CLOSE * (high - low)
        nearer = np.where(where - low < high - where, low, high)
        left, right = (nearer + x[inner - 1]) / 2, (nearer + x[inner + 1]) / 2
        both = [np.concatenate([one, one[known]]) for one in (above, high - low)]
        return PossiblePeaks(np.concatenate([np.where(known, left, where), right[known]]), *both)


def _ends(x: Array, v: Array, wanted: SearchAim) -> list[PossiblePeaks]:
    """Middles of the first and the last stretch where the end is the highest and rises too steeply for a parabola: of a
    resonance that stands beyond it the top may lie before it."""
    found = []
    for end, beside in ((0, 1), (-1, -2)):
        fall = v[end] - v[beside]
        height = v[end] + END * fall
        if fall > FLAT * v[end] and wanted.by(np.array([height]), v[[end]])[0]:
            middle, apart = (x[end] + x[beside]) / 2, abs(x[end] - x[beside])
            found.append(PossiblePeaks(np.array([middle]), np.array([height]), np.array([apart])))
    return found


def _poles(x: Array, f: Complex, middles: Integers) -> Poles:
    """Resonances of amplitudes ``f`` (speed, order) between the neighbours of ``middles`` (index into speeds)."""
    i = middles
    x0, x1, x2 = x[i - 1, None], x[i, None], x[i + 1, None]
    f0, f1, f2 = f[i - 1], f[i], f[i + 1]
    first = (f1 - f0) / (x1 - x0)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        bend = ((f2 - f1) / (x2 - x1) - first) / (x2 - x0)
        g0, g1, g2 = x0 * f0, x1 * f1, x2 * f2
        pole = ((g2 - g1) / (x2 - x1) - (g1 - g0) / (x1 - x0)) / (x2 - x0) / bend
        residue = -first * (x0 - pole) * (x1 - pole)
        at = pole.real
        there = np.abs(f1 + residue * (1 / (at - pole) - 1 / (x1 - pole)))
    low, high = x[np.maximum(i - 2, 0), None], x[np.minimum(i + 2, len(x) - 1), None]
    with np.errstate(invalid="ignore"):
        near: Flags = np.isfinite(there) & (at > low) & (at < high)
    m, k = np.nonzero(near)
    return Poles(at[m, k], x[i][m], k, there[m, k], np.abs(pole.imag[m, k]))


def sharpened(
    respond: Callable[[Array], OrderResponse], quantity: SearchedQuantity, speeds: tuple[float, float, float]
) -> float:
    """The speed [rad/s] of the top of ``quantity`` that lies between the outer two of ``speeds``, near the middle one:
    far closer than its value needs it, for what is differentiated there."""
    x = np.array(speeds)
    v = quantity.values(respond(x))
    for _ in range(SHARPENING):
        top = int(np.clip(np.argmax(v), 1, len(x) - 2))
        where = float(parabola(x, v, np.array([top]))[0][0])
        if not np.isfinite(where):
            where = float(x[top])
        near = np.abs(x - where).min()
        reach = np.clip(2 * near, SHARP * where, (x[top + 1] - x[top - 1]) / 4)
        new = np.setdiff1d(np.clip(where + reach * np.array([-1.0, 0.0, 1.0]), x[0], x[-1]), x)
        if len(new) == 0 or (near <= SHARP * where and x[top + 1] - x[top - 1] < 1e3 * SHARP * where):
            break
        x, v = np.concatenate([x, new]), np.concatenate([v, quantity.values(respond(new))])
        order = np.argsort(x)
        x, v = x[order], v[order]
    return float(x[int(np.argmax(v))])
