"""Folds of a curve of periodic motions between neighbours that are known, however narrow, from the tangents at both.

Where a curve turns back between two motions its tangents there say so. Let x(z) be the parameter along the way from one
motion to the other, a cubic. If it falls anywhere between, then at one of the ends the tangent dz/dx differs by more
than a half from the secant: with x′ at both ends between ⅔ and 2 of its mean, Simpson's rule keeps x′ at the middle
above ½ of it, and the parabola through the three does not reach zero. A resonance between two motions turns their
tangents against the secant as well. So neighbours whose tangents agree with the secant belong together; between others
motions are put, all of a round at once, until what does not agree is narrow, and is followed from both sides.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, fields, replace

import numpy as np

from trunnion.arrays import Array, Flags, Places
from trunnion.numerics import harmonics as fourier
from trunnion.steady.free.free_balance import FreeBalance, SteadyStates
from trunnion.steady.free.periodic_steady_states import (
    ALIKE,
    LEAP,
    NONE,
    BranchWalk,
    Break,
    KnownSteadyState,
    SteadyStateCurve,
    apart,
    merged,
)

STRAIGHT = 0.5
"""Share of a change by which tangents may differ from it."""
TOUCHING = 1e-3
"""Share of a swing that counts as no change."""
HALVINGS = 6
"""Rounds in which motions are put between."""
BESIDE = 1e-4
"""Step of differences by the parameter, over the distance of neighbours."""
LEAST_LEAP = 1e-4
"""Share of its swing by which a motion may change in one step at least."""


def step_of(values: Array) -> float:
    """Of differences by a parameter that is known at ``values`` (value,), rising."""
    return float(BESIDE * np.diff(values).min()) if len(values) > 1 else BESIDE * abs(float(values[0]))


def slopes(curve: SteadyStateCurve, values: Array) -> Array:
    """d rows / d value (value, n, 2h + 1) of the motions at ``values`` (value,), rising."""
    return _slopes(curve.balance, curve.at_all(values), step_of(values))


def folds_between(curve: SteadyStateCurve, values: Array, slope: Array) -> tuple[Break, ...]:
    """Breaks of a curve between the lowest and the highest of ``values`` (value,), rising, and between all of them.

    ``slope`` : d rows / d value (value, n, 2h + 1) of ``curve.at_all(values)``.
    """
    motions = curve.at_all(values)
    usable = np.flatnonzero(motions.found & motions.resolved)
    low, high = float(values[0]), float(values[-1])
    if not len(usable):
        return (Break(low, high, NONE),)
    ends, at = BranchWalk(curve, low, high), values[usable].tolist()
    pairs = Stretches.of(values[usable], motions.rows[usable], slope[usable])
    found = [*ends.outside(at[0], low), *folds_of(curve, pairs, low, high), *ends.outside(at[-1], high)]
    return tuple(ends.with_outer_motions(one, at) for one in merged(found))


def folds_of(curve: SteadyStateCurve, pairs: Stretches, low: float, high: float) -> tuple[Break, ...]:
    """Breaks between ``pairs`` of motions that a curve knows, which goes from ``low`` to ``high``."""
    closer = copy(curve)
    closer.known = dict(curve.known)
    walk, found = BranchWalk(closer, low, high), list[Break]()
    for a, b in _narrowed(closer, pairs):
        change = apart(closer.known[a].rows, closer.known[b].rows) / max(closer.known[a].swing, ALIKE)
        leap = min(LEAP, max(change / 4, LEAST_LEAP))
        found += replace(walk, leap=leap).between([(a, b)])
    return tuple(merged(found))


def _slopes(balance: FreeBalance, motions: SteadyStates, step: float) -> Array:
    return np.asarray(balance.changes(motions, [balance.rows(motions.value + step)])[0] / step)


@dataclass(frozen=True)
class Stretches:
    """Pairs of neighbours: values (pair, 2), rows and their slopes (pair, 2, n, 2h + 1); least: change [rad] that
    counts as none (pair,)."""

    value: Array
    rows: Array
    slope: Array
    least: Array

    @classmethod
    def of(cls, value: Array, rows: Array, slope: Array) -> Stretches:
        """Between neighbours of a sequence."""
        swing = np.abs(rows[..., 1:]).max(axis=(1, 2))
        least = np.maximum(ALIKE, TOUCHING * np.maximum(swing[1:], swing[:-1]))
        ends = [np.stack([each[:-1], each[1:]], axis=1) for each in (value, rows, slope)]
        return cls(ends[0], ends[1], ends[2], least)

    @property
    def bent(self) -> Flags:
        """Whether the tangents of a pair (pair,) differ from its secant so far that the curve may turn back between;
        the mean, which loads move at will, aside."""
        reach = np.diff(self.value, axis=1)[..., None, None]
        change = np.diff(self.rows, axis=1)[:, 0]
        off = _size(self.slope * reach - change[:, None]).max(axis=1)
        return np.asarray(~(off <= STRAIGHT * _size(change) + self.least))

    def part(self, which: Places | Flags) -> Stretches:
        """Some of them."""
        return Stretches(*(getattr(self, each.name)[which] for each in fields(self)))

    def middles(self) -> Array:
        """Where motions halfway are looked for (pair, n, 2h + 1): by the tangents, unless they lead far away."""
        change = np.diff(self.rows, axis=1)[:, 0]
        reach = np.diff(self.value, axis=1)[:, 0]
        aside = (self.slope[:, 0] - self.slope[:, 1]) * (reach / 8)[:, None, None]
        far = ~(_size(aside) <= _size(change))
        return np.asarray(self.rows.mean(axis=1) + np.where(far[:, None, None], 0.0, aside))


def _size(rows: Array) -> Array:
    """Of all harmonics but the mean."""
    return np.asarray(np.sqrt((rows[..., 1:] ** 2).sum(axis=(-2, -1))))


def _narrowed(curve: SteadyStateCurve, pairs: Stretches) -> list[tuple[float, float]]:
    """Pairs of values between which the curve may turn back, with motions put between where that tells; ``curve``
    knows them then."""
    balance, left = curve.balance, []
    for _ in range(HALVINGS):
        pairs = pairs.part(pairs.bent)
        if not len(pairs.value):
            break
        middle = pairs.value.mean(axis=1)
        found = balance.solve(middle, fourier.order(pairs.rows), pairs.middles())
        good = found.found & found.resolved
        left += [(float(a), float(b)) for a, b in pairs.value[~good]]
        for i in np.flatnonzero(good):
            curve.known[float(middle[i])] = KnownSteadyState.of(found, i)
        if not good.any():
            return left
        slope = _slopes(balance, found, BESIDE * float(np.diff(pairs.value).min()))
        pairs = _halves(pairs, middle, found.rows, slope, good)
    return left + [(float(a), float(b)) for a, b in pairs.part(pairs.bent).value]


def _halves(pairs: Stretches, middle: Array, rows: Array, slope: Array, good: Flags) -> Stretches:
    """Both halves of those pairs that have a motion between."""
    parts = []
    for old, new in ((pairs.value, middle), (pairs.rows, rows), (pairs.slope, slope)):
        first, last = old[good][:, 0], old[good][:, 1]
        parts.append(np.concatenate([np.stack([first, new[good]], axis=1), np.stack([new[good], last], axis=1)]))
    return Stretches(parts[0], parts[1], parts[2], np.tile(pairs.least[good], 2))
