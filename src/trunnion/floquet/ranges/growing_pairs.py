"""Two modes that grow together, followed by themselves: at many speeds for the cost of one look at all modes of a line.

One exponent that grows shows that the line is unstable at a speed; that it is stable takes all of them. So within the
stretch over which a pair is seen to grow one need not look, and its ends are where that growth is 0, which a look on
either side confirms.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np

from trunnion.arrays import Array, Flags, Places
from trunnion.equations.steady_base import has_periodic_base
from trunnion.floquet.ranges.collisions import Collisions, kept_trees
from trunnion.floquet.ranges.exponents import ExponentOrders, KeptTrees, colliding_exponents
from trunnion.floquet.ranges.resonances import Modes
from trunnion.floquet.ranges.span import Span
from trunnion.numerics.bracketing import bracketed

LONG = 40
"""Unknowns from which on a look at all modes costs so much more."""
LAYERS = 6
"""Of side orders: what is left out shifts an exponent by the twelfth power of the joints' spread."""
SETTLED = 1e-3
"""Share of the sum of two decays by which the last step may still move an exponent that is known."""
OUTWARD = (0.3, 0.6, 0.85, 1.05, 1.4, 2.0)
"""Shares of half a stretch at which one looks in turn whether growth has ended; at the first it has to last."""
SURE = 3
"""How many of them are looked at together."""
REACHES = 0.85
"""Share of half a stretch that has to lie within those known for its pair not to be followed."""
LARGE = 0.5
"""Share of the fastest growth of a meeting from which on it is looked at, whatever grows there besides."""


@dataclass(frozen=True)
class GrowingPairs:
    """Of the ``met`` of a ``span``, whose growth is known and above 0 over a stretch that is known; ends of stretches
    are located ``closely``, as a share of the speed."""

    span: Span
    met: Collisions
    closely: float

    @classmethod
    def of(cls, span: Span, met: Collisions, closely: float) -> GrowingPairs:
        """None of a line whose other modes cost no more."""
        long = span.assembly.topology.size >= LONG and not has_periodic_base(span.assembly)
        with np.errstate(invalid="ignore"):
            known = (met.growth > 0) & (met.half > 0) & long
        return cls(span, met.of(known), closely)

    @cached_property
    def _modes(self) -> Modes:
        return Modes.of(self.span)

    @cached_property
    def _sides(self) -> ExponentOrders:
        return ExponentOrders.of(self.span.assembly, LAYERS)

    @cached_property
    def _kept(self) -> KeptTrees | None:
        return kept_trees(self.span)

    def growth(self, pair: Places, speed: Array) -> Array:
        """How fast each ``pair`` (case,) grows [1/s] at a ``speed`` (case,); NaN where that does not settle."""
        found, steps, turns = np.full(len(speed), np.nan), self.met.step[pair], self._sides.turns
        for step in np.unique(steps).tolist():
            some = np.flatnonzero(steps == step)
            modes = (self.met.first[pair[some]], self.met.second[pair[some]])
            one, two = (self._modes.at(speed[some], mode.astype(np.intp)) for mode in modes)
            both, moved = colliding_exponents(
                self.span.assembly, self._sides, self.span.table(speed[some]), Fraction(int(step)) / turns,
                (one[0], two[0]), (one[1], two[1]), statically_twisted=self.span.statically_twisted, kept=self._kept,
            )  # fmt: skip
            with np.errstate(invalid="ignore"):
                known = moved <= SETTLED * np.abs(both.sum(axis=1).real)
            found[some] = np.where(known, both.real.max(axis=1), np.nan)
        return found

    @cached_property
    def stretches(self) -> Array:
        """From where to where each pair grows (pair, 2) [rad/s]; NaN where it lies within the stretch of others, is not
        seen to grow about its meeting, or its ends are not found. Those that fewer harmonics join go first: what takes
        many to meet is often the same growth once more."""
        met = self.met
        found = np.full((len(met.speed), 2), np.nan)
        for step in np.unique(met.step).tolist():
            known = _joined(found)
            low, high = (met.speed + side * REACHES * met.half for side in (-1.0, 1.0))
            new = ~((low[:, None] > known[:, 0]) & (high[:, None] < known[:, 1])).any(axis=1)
            pair = np.flatnonzero(new & (met.step == step))
            if len(pair):
                found[pair] = self._stretch(pair)
        return found

    def _stretch(self, pair: Places) -> Array:
        """That of each ``pair`` (case,)."""
        speed, half, shares = self.met.speed[pair], self.met.half[pair], np.array(OUTWARD[:SURE])
        every = np.array([0.0, *-shares, *shares])
        growth = self.growth(np.repeat(pair, len(every)), (speed[:, None] + half[:, None] * every).ravel())
        growth = growth.reshape(-1, len(every))
        found = np.full((len(pair), 2), np.nan)
        with np.errstate(invalid="ignore"):
            grows = (growth[:, [0, 1, 1 + SURE]] > 0).all(axis=1)
        for end, known in enumerate((growth[:, 1 : 1 + SURE], growth[:, 1 + SURE :])):
            found[grows, end] = self._end(pair[grows], 2.0 * end - 1.0, known[grows])
        found[np.isnan(found).any(axis=1)] = np.nan
        return found

    def _end(self, pair: Places, side: float, known: Array) -> Array:
        """Where each ``pair`` (case,) ceases to grow on a ``side``, whose growth at the first shares of its stretch is
        ``known`` (case, share)."""
        speed, half = self.met.speed[pair], side * self.met.half[pair]
        within, beyond = (np.full((2, len(pair)), np.nan) for _ in range(2))  # speed and growth
        waiting = np.arange(len(pair))
        for k, share in enumerate(OUTWARD):
            at = speed[waiting] + share * half[waiting]
            now = known[waiting, k] if k < SURE else self.growth(pair[waiting], at)
            with np.errstate(invalid="ignore"):
                over, on = now < 0, now > 0
            beyond[:, waiting[over]], within[:, waiting[on]] = (at[over], now[over]), (at[on], now[on])
            waiting = waiting[on]
        ended = np.flatnonzero(np.isfinite(beyond[0]))
        lost, end = np.zeros(len(ended), dtype=bool), np.full(len(pair), np.nan)

        def growth(at: Array, which: Places) -> Array:
            found = self.growth(pair[ended[which]], at)
            lost[which] |= np.isnan(found)
            return found

        if len(ended):
            (low, begin), (high, over) = within[:, ended], beyond[:, ended]
            found = bracketed(growth, low, high, self.closely * speed[ended], (begin, over))
            end[ended] = np.where(lost, np.nan, found)
        return end

    @cached_property
    def joined(self) -> Array:
        """Stretches (stretch, 2) [rad/s] over which some pair grows, those that overlap as one, by rising speed."""
        return _joined(self.stretches)

    @property
    def looked_at(self) -> Array:
        """Speeds that stand for the stretches: where growth is fastest in each, and where it is all but the fastest."""
        met = self.met
        inside = (met.speed[:, None] > self.joined[:, 0]) & (met.speed[:, None] < self.joined[:, 1])
        top = np.where(inside, met.growth[:, None], -np.inf).argmax(axis=0) if len(met.speed) else np.zeros(0, np.intp)
        fast = met.growth >= LARGE * met.growth.max(initial=0.0)
        return np.unique(np.concatenate([met.speed[top[inside.any(axis=0)]], met.speed[fast]]))

    def grows(self, speed: Array) -> Flags:
        """Where one of them is seen to grow (speed,)."""
        low, high = self.joined.T
        return np.asarray(((speed[:, None] > low) & (speed[:, None] < high)).any(axis=1))

    def followed(self, speed: Array) -> Flags:
        """Which meetings (speed,) are those of pairs whose stretch is known."""
        return np.isin(speed, self.met.speed[np.isfinite(self.stretches).all(axis=1)])


def _joined(stretches: Array) -> Array:
    """The known of some stretches (any, 2), those that overlap as one, by rising speed."""
    known = stretches[np.isfinite(stretches).all(axis=1)]
    found = list[list[float]]()
    for low, high in known[np.argsort(known[:, 0])].tolist():
        if found and low <= found[-1][1]:
            found[-1][1] = max(found[-1][1], high)
        else:
            found.append([low, high])
    return np.array(found).reshape(-1, 2)
