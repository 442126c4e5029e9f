"""From every resonance of the straight line to the region that it opens: a search of rows that samples nothing.

Where the straight line has ω_i + ω_j = N cycles in the period, two of its multipliers meet. We raise the joint angle in
steps, from nothing to the lowest row and then through the box, and track each resonance: the phases θ of all modes are
followed, and the speed is moved so that θ_i + θ_j stays N turns: θ goes nearly as 1/Ω, which makes the next speed
Ω(θ_i + θ_j)/2πN. If the two multipliers have parted there in modulus, this is a point of the region, and half of what
ln|σ| differs by tells its width: edges lie where the phases of the straight line would be apart by that much.

It sees how small a region is, but not a resonance of higher order than ``ORDERS`` or one that only steep angles make.
Differences ω_j − ω_i = N are not followed: stiffness matrices are symmetric, and two modes whose difference it is have
multipliers of one Krein signature, which pass each other and do not part while the stiffness stays positive definite.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from trunnion.arrays import Array, Complex, Flags, Places
from trunnion.equations.coefficients import Assembly
from trunnion.equations.topology import require_period
from trunnion.floquet.charts.chart_families import LineFamily
from trunnion.floquet.tongues.naming import eigenvalues, nearest_phases, partly_bent, straight_frequencies
from trunnion.floquet.tongues.region import Region
from trunnion.floquet.tongues.rows import BY_RESONANCES, BY_ROWS, TongueRow, looked_at, unstable_intervals
from trunnion.modes.resonance_speeds import sources

Multipliers = Callable[[Array], Complex]
"""Multipliers (resonances, 2n) at one speed of each."""

ORDERS = 12
"""Multiples of every exciting frequency."""
BENDS = 24
"""Steps from the straight line to the lowest row."""
LEVELS = 32
"""Steps from there to the highest."""
ROUNDS = 4
"""Speeds tried at each step."""
ON_THE_WAY, EXACT = 1e-8, 1e-12
"""Errors of the matrices followed, and of those at a row: that of two multipliers which meet is the root."""
NEAR, MET = 1e-4, 1e-9
"""How closely [rad] two phases are brought together on the way, and at a row."""
MEETS = 1e-3
"""Phases [rad] of two multipliers nearer than this have met: farther ones were lost on the way."""
PARTED = 1e-7
"""ln|σ| of less than this may be rounding."""
BESIDE = 0.05
"""Resonances of the straight line so far outside the speeds, as a share, may move in."""


@dataclass(frozen=True)
class TrackedResonances:
    """Resonances on their way through the box: modes i, j (elastic ones, from 0) and N cycles in the period with
    θ_i + θ_j = 2πN; speeds (levels, resonances) and phases (levels, resonances, modes) at the levels ``v``
    (levels,), rising."""

    region: Region
    pairs: Places
    v: Array
    speed: Array
    phase: Array

    def __len__(self) -> int:
        return len(self.pairs)

    @property
    def lost(self) -> int:
        """How many could not be followed to the last level."""
        return int(np.sum(np.abs(_off(self.phase[-1], self.pairs)) > MEETS))

    def rows(self, v: Array) -> list[TongueRow]:
        """Unstable intervals of rows ``v`` by the search along the row and by this one."""
        known = unstable_intervals(self.region, v)
        places = [self.stretches(row.v) for row in known]
        missed = [s[opened & ~_met(row, s).any(axis=0)] for row, (_, s, opened) in zip(known, places, strict=True)]
        both = looked_at(self.region, known, missed)
        return [_attributed(new, old, *own) for new, old, own in zip(both, known, places, strict=True)]

    def stretches(self, v: float) -> tuple[Places, Array, Flags]:
        """Resonances (stretches,) whose multipliers meet on the row at ``v``, stretches (stretches, 2) in u that hold
        their regions there, and whether they have opened one."""
        region = self.region
        k = int(np.clip(np.searchsorted(self.v, v) - 1, 0, len(self.v) - 2))
        share = (v - self.v[k]) / (self.v[k + 1] - self.v[k])
        speed, phase = (part[k] + share * (part[k + 1] - part[k]) for part in (self.speed, self.phase))
        along = _of(region, v, EXACT)
        speed, phase = _closed_in(along, speed, phase, self.pairs, MET)
        low, high = _heights(along(speed), phase[np.arange(len(self)), self.pairs[:, 0]])
        reach = 3 * np.maximum((high - low) / 2, PARTED) / (2 * np.pi * self.pairs[:, 2])  # of u = 1/Ω, as a share
        u = region.family.to_patch(speed, True)
        inside = (u >= region.box.u0) & (u <= region.box.u1)
        here = np.flatnonzero(inside & (np.abs(_off(phase, self.pairs)) < MEETS))
        ends = np.stack([u * (1 - reach), u * (1 + reach)], axis=1)[here]
        return here, np.clip(ends, region.box.u0, region.box.u1), high[here] > PARTED


def followed(region: Region) -> TrackedResonances | None:
    """Every resonance of a line over speed, followed through the box; None where x is not the speed of a line."""
    family = region.family
    if not isinstance(family, LineFamily) or not family.x.is_speed:
        return None
    v = np.linspace(region.box.v0, region.box.v1, LEVELS + 1)
    y, speeds, assembly = region.y(v), family.x.values, family.assembly
    modes = straight_frequencies(family, np.full(len(y), speeds.mean()), y)[0]
    elastic = np.flatnonzero((modes > 0).all(axis=0))
    turns = float(require_period(assembly.line, assembly.topology))
    pairs = _resonances(assembly, turns, len(elastic))
    i, j, cycles = pairs.T
    at = turns * (modes[:, elastic[i]] + modes[:, elastic[j]]) / cycles
    low, high = (1 - BESIDE) * speeds.min(), (1 + BESIDE) * speeds.max()
    near = ((at > low) & (at < high)).any(axis=0)
    pairs, speed = pairs[near], at[0, near]
    phase = 2 * np.pi * turns * modes[0, elastic] / speed[:, None]

    def bent(share: float) -> Multipliers:
        return lambda x: partly_bent(family, x, np.full(len(x), y[0]), np.full(len(x), share), region.threads)

    if not len(pairs):
        return TrackedResonances(region, pairs, v, np.zeros((len(v), 0)), np.zeros((len(v), 0, len(elastic))))
    shares = (np.arange(1, BENDS + 1) / BENDS) ** 0.5  # angles act by their squares
    *_, (speed, phase) = _along([bent(float(share)) for share in shares], speed, phase, pairs)
    steps = _along([_of(region, float(level), ON_THE_WAY) for level in v], speed, phase, pairs)
    return TrackedResonances(region, pairs, v, *(np.stack(part) for part in zip(*steps, strict=True)))


def in_words(found: TrackedResonances, by: list[int]) -> str:
    """What was followed, and which of the regions found ``by`` which searches."""
    lost = f", {found.lost} of them lost on the way" if found.lost else ""
    both, rows, resonances = (by.count(code) for code in (BY_ROWS | BY_RESONANCES, BY_ROWS, BY_RESONANCES))
    return (
        f"{len(found)} resonances up to order {ORDERS} were followed up the box{lost}; of {len(by)} regions {both} "
        f"came from both searches, {rows} from the rows alone, {resonances} from the resonances alone"
    )


def _resonances(assembly: Assembly, turns: float, modes: int) -> Places:
    """Resonances (resonances, 3): modes i ≤ j, cycles N in the period."""
    rates = {float(2 * source.rate) * turns for source in sources(assembly)}
    cycles = sorted({round(k * rate) for rate in rates for k in range(1, ORDERS + 1)})
    every = [(i, j, n) for n in cycles for j in range(modes) for i in range(j + 1)]
    return np.array(every, dtype=np.intp).reshape(-1, 3)


def _of(region: Region, v: float, tolerance: float) -> Multipliers:
    """Multipliers along a row, integrated."""

    def at(speed: Array) -> Complex:
        y = np.full(len(speed), float(region.y(np.array(v))))
        matrix, _, _ = region.family.matrices(speed, y, tolerance, region.threads)
        return eigenvalues(matrix)

    return at


def _along(steps: list[Multipliers], speed: Array, phase: Array, pairs: Places) -> list[tuple[Array, Array]]:
    """Speeds and phases at each of the steps, begun at those given; each from the two before."""
    found = [(speed, phase)]
    for step in steps:
        (x1, t1), (x0, t0) = found[-1], found[max(len(found) - 2, 0)]
        found.append(_closed_in(step, 2 * x1 - x0, 2 * t1 - t0, pairs, NEAR))
    return found[1:]


def _closed_in(step: Multipliers, speed: Array, phase: Array, pairs: Places, close: float) -> tuple[Array, Array]:
    """Speeds near those given at which the multipliers meet as closely as asked for, and the phases of all modes."""

    def read(at: Array, ahead: Array) -> Array:
        return np.stack([nearest_phases(*each) for each in zip(ahead, step(at), strict=True)])

    turns = 2 * np.pi * pairs[:, 2]
    best, phase = speed.copy(), read(speed, phase)
    shift = _off(phase, pairs) / turns
    for _ in range(ROUNDS):
        left = np.flatnonzero(np.abs(_off(phase, pairs)) > close)
        if not len(left):
            break
        # Beside the real axis, and where two have met, a phase has lost its direction: then the other way is tried.
        tried = best[left] * (1 + np.clip(shift[left], -0.1, 0.1))
        again = read(tried, phase[left] * (best[left] / tried)[:, None])
        off = _off(again, pairs[left])
        better = np.abs(off) < np.abs(_off(phase, pairs)[left])
        shift[left] = np.where(better, off / turns[left], -shift[left])
        best[left] = np.where(better, tried, best[left])
        phase[left] = np.where(better[:, None], again, phase[left])
    return best, phase


def _heights(values: Complex, phase: Array) -> tuple[Array, Array]:
    """ln|σ| of the two multipliers (points, 2n) that lie nearest to a phase (points,): the lower and the higher."""
    apart = np.abs(np.angle(values * np.exp(-1j * phase)[:, None])) + 10.0 * (np.abs(values) < 1e-9)
    two = np.take_along_axis(values, np.argsort(apart, axis=1)[:, :2], axis=1)
    height = np.sort(np.log(np.maximum(np.abs(two), 1e-300)), axis=1)
    return height[:, 0], height[:, 1]


def _off(phase: Array, pairs: Places) -> Array:
    """θ_i + θ_j − 2πN of each resonance."""
    own = np.arange(len(pairs))
    return phase[own, pairs[:, 0]] + phase[own, pairs[:, 1]] - 2 * np.pi * pairs[:, 2]


def _met(row: TongueRow, stretches: Array) -> Flags:
    """Which intervals of a row meet which stretches (intervals, stretches)."""
    return (row.low[:, None] <= stretches[:, 1]) & (stretches[:, 0] <= row.high[:, None])


def _attributed(row: TongueRow, rows_alone: TongueRow, which: Places, stretches: Array, opened: Flags) -> TongueRow:
    """The row with ``by`` and ``of``: which of its intervals each search found, and the resonances in each."""
    own = np.stack([rows_alone.low, rows_alone.high], axis=1)
    met = _met(row, stretches)
    by = BY_ROWS * _met(row, own).any(axis=1) + BY_RESONANCES * met[:, opened].any(axis=1)
    return replace(row, by=np.asarray(by, dtype=np.int8), of=tuple(frozenset(which[places].tolist()) for places in met))
