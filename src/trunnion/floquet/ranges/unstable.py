"""Unstable speeds of a line over a range: every resonance that may open looked at, every end closed in on.

Two modes can grow together where their Floquet exponents meet (``resonance_speeds``),

    Im λ_i(Ω) + Im λ_j(Ω) = cΩ,

c the cycles per turn with which joints and meshes excite, or a sum of multiples. There growth is fastest, over a
stretch as wide as it is fast, and beside it as slow as the straight line's. So one looks at every meeting and beside
it, at an even grid for all else, and about the fastest growth until it has settled. Meetings whose modes are damped
more than joints and meshes can feed are left out: order k of an unevenness S feeds no more than ωSᵏ.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from trunnion.arrays import Array, Flags, Places
from trunnion.equations.coefficients import joint_laws
from trunnion.equations.steady_base import has_periodic_base
from trunnion.floquet.charts.axes import lowest_speed
from trunnion.floquet.ranges.exponents import ExponentOrders, colliding_exponents
from trunnion.floquet.ranges.resonances import BESIDE, Modes, resonances
from trunnion.floquet.ranges.slow_speeds import slow_enough
from trunnion.floquet.ranges.span import Gap, SmoothRange, Span
from trunnion.floquet.stability.stability_over_speed import StabilityOverSpeed
from trunnion.numerics.curves import parabola
from trunnion.results.verdict import Verdict
from trunnion.steady.orders.groups import offsets
from trunnion.steady.orders.spectrum import order_spectrum

POINTS = 65
"""Speeds of the even grid."""
PER_OCTAVE = 3
ORDERS = 12, 6
"""Multiples of an exciting frequency; of several their sums and differences, so many together."""
FED = 2.0
"""Factor on what joints and meshes are taken to feed."""
ROUNDS = 12
APART = (5e-3, 1e-3)
"""Shares of the speed by which the three speeds lie apart that tell where two exponents meet."""
SETTLED = 1e-3
"""Share of the fastest growth, or of the slowest decay, that may still be missing."""
RAISED = 0.5
"""Share of the straight line's decay from which growth at a meeting is looked at more closely."""
ENDS = 1e-7
"""How closely the ends of unstable ranges are located, as a share of the speed."""
SLOWEST = 20.0
"""Factor below the lowest speed of a chart down to which growth is computed."""

Judge = Callable[[Array], StabilityOverSpeed]


@dataclass(frozen=True)
class UnstableRanges:
    """``along``: stability at all speeds looked at, rising; ``ranges``: unstable from where to where [rad/s]; ``slow``:
    speed [rad/s] up to which the line is stable by a bound, 0 without; ``gaps``: what was not looked at."""

    along: StabilityOverSpeed
    ranges: tuple[tuple[float, float], ...]
    slow: float
    gaps: tuple[Gap, ...]

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


def unstable_ranges(span: Span, judge: Judge, *, points: int = POINTS, swing: float | None = None) -> UnstableRanges:
    """Of a line that joints or meshes vary; ``judge``: its stability at speeds (speed,); ``swing``: how far the inputs
    of joints swing at most [rad], where that is known.

    Raises
    ------
    InputError : as of ``judge``.
    """
    slow, gaps, start = _slow_end(span)
    low, high = max(span.start, start), span.high
    if low >= high:
        low = high
    even = np.linspace(low, high, points)
    octaves = np.geomspace(max(low, high / 2**8), high, 8 * PER_OCTAVE + 1)
    met, damping, width = exponent_collisions(span, low, high, swing)
    lost = np.array([at for gap in span.lost for at in (gap.low, (gap.low + gap.high) / 2, gap.high)])
    along = judge(np.unique(np.concatenate([even, octaves, met, lost[(lost >= low) & (lost <= high)]])))
    along = _beside_met(along, judge, met, damping, width, (low, high))
    for _ in range(ROUNDS):
        wanted = _rising(along)
        if not len(wanted):
            break
        along = along.beside(judge(wanted))
    along, ranges = closed_in(along, judge)
    inside = np.any([(along.speed > gap.low) & (along.speed < gap.high) for gap in span.lost], axis=0)
    return UnstableRanges(along.of(np.broadcast_to(~inside, along.speed.shape)), ranges, slow, (*gaps, *span.lost))


def _slow_end(span: Span) -> tuple[float, tuple[Gap, ...], float]:
    """The bound below which nothing grows, what lies between it and what can be computed, and where to begin."""
    least = lowest_speed(span.assembly) / SLOWEST
    if span.start >= least:
        return 0.0, (), span.start
    slow = 0.0 if span.put else slow_enough(span.assembly)
    if slow >= span.high:
        return slow, (), span.high
    begin = max(least, slow, span.start)
    if slow >= least or begin >= span.high:
        return slow, (), min(begin, span.high)
    why = "its shafts are too stiff for so slow a turn: stability is not computed there"
    return slow, (Gap(max(slow, span.low), least, why),), begin


def exponent_collisions(span: Span, low: float, high: float, swing: float | None = None) -> tuple[Array, Array, Array]:
    """Speeds (meeting,) at which two exponents meet, the decay of the slower mode [1/s] there, and half of the stretch
    [rad/s] over which they can grow; ``swing`` as of ``unstable_ranges``."""
    modes, none = Modes.of(span), np.zeros(0)
    if not modes.value.shape[1] or low >= high or not span.assembly.topology.rates:
        return none, none, none
    fed = min(_nonuniformity(span) + (_swing(span) if swing is None else swing), 1.0)
    sides = ExponentOrders.of(span.assembly)
    rates = {int(rate * sides.turns) for rate in span.assembly.topology.rates}
    every = {step / sides.turns: k for step, k in offsets(rates, ORDERS[min(len(rates), 2) - 1]).items() if step > 0}
    found = [_of_cycles(span, modes, sides, cycles, FED * fed**k) for cycles, k in every.items()]
    speed, decay, width = (np.concatenate(part) for part in zip(*found, strict=True))
    inside = (speed >= low) & (speed <= high)
    return speed[inside], decay[inside], width[inside]


def _of_cycles(
    span: Span, modes: Modes, sides: ExponentOrders, cycles: Fraction, share: float
) -> tuple[Array, Array, Array]:
    """The same of what excites with so many ``cycles`` per turn and feeds a ``share`` of a frequency."""
    i, j = np.triu_indices(modes.value.shape[1])
    c = float(cycles)
    with np.errstate(invalid="ignore"):
        off = modes.value.imag[:, i] + modes.value.imag[:, j] - c * modes.speed[:, None]
        place, pair = np.nonzero((off[:-1] <= 0) != (off[1:] <= 0))
        (fast, decay), (other, beside) = (
            (modes.value.imag[place, m[pair]], -modes.value.real[place, m[pair]]) for m in (i, j)
        )
        own = np.sqrt(np.maximum(decay * beside, 0.0))
        open_ones = own <= share * np.maximum(fast, other)  # never so of a mode that does not oscillate
    place, pair, own = place[open_ones], pair[open_ones], own[open_ones]
    before, after = off[place, pair], off[place + 1, pair]
    speed = modes.speed[place] + (modes.speed[1] - modes.speed[0]) * before / (before - after)
    if len(speed):
        speed = _followed(span, modes, sides, cycles, (i[pair], j[pair]), speed)
    return speed, np.minimum(decay, beside)[open_ones], np.maximum(own / c, 1e-9 * speed)


def _followed(
    span: Span, modes: Modes, sides: ExponentOrders, cycles: Fraction, pair: tuple[Places, Places], speed: Array
) -> Array:
    """Where two exponents meet once joints have angles, from where those of the straight line do.

    Their difference squared is smooth where they meet and where they have parted: −c²((Ω − Ω₀)² − w²), nearly. Three
    speeds tell Ω₀.
    """
    begin = speed.copy()
    for wide in APART:
        three = speed[:, None] * (1 + wide * np.array([-1.0, 0.0, 1.0]))
        flat = three.ravel()
        one, two = (modes.at(flat, np.repeat(mode, 3)) for mode in pair)
        found = colliding_exponents(
            span.assembly, sides, span.table(flat), cycles, (one[0], two[0]), (one[1], two[1])
        )  # fmt: skip
        square = -((found[:, 0] - found[:, 1]) ** 2).real.reshape(three.shape)
        low, middle, high = square.T
        with np.errstate(divide="ignore", invalid="ignore"):
            step = wide * speed * (low - high) / (2 * (low - 2 * middle + high))
            good = np.isfinite(step) & (np.abs(speed + step - begin) <= BESIDE * begin)
        speed = np.where(good, speed + step, speed)
    return speed


def _nonuniformity(span: Span) -> float:
    """How much joints and meshes vary stiffness and inertia, as a share of either."""
    table = span.table(np.linspace(span.start, span.high, 5))
    coefficients = span.assembly.coefficients(table, any_frequency=True)
    joints = sum(4 * float(np.max(law.spread)) for law in joint_laws(span.assembly, table))
    shares = (sum(np.abs(one.amplitude) for one in wave.harmonics) for wave in coefficients.waves)
    return joints + sum(float(np.max(share)) for share in shares)


def _swing(span: Span) -> float:
    """How far the inputs of joints swing [rad] in the periodic steady state of a line that has one, at its resonances
    too, by linear theory: what it feeds beside the joints' unevenness."""
    if not has_periodic_base(span.assembly):
        return 0.0
    speed = np.unique(np.concatenate([np.linspace(span.start, span.high, POINTS), resonances(span).speed]))
    table = span.table(speed) if span.put else None
    found = order_spectrum(span.assembly, speed, table=table, rough=True)
    return float(np.nan_to_num(found.joint_rotations, nan=1.0, posinf=1.0).max(initial=0.0))


def _beside_met(
    along: StabilityOverSpeed, judge: Judge, met: Array, decay: Array, width: Array, ends: tuple[float, float]
) -> StabilityOverSpeed:
    """With two speeds beside every meeting at which growth stands out."""
    if not len(met):
        return along
    growth = along.growth_rate[np.searchsorted(along.speed, met)]
    with np.errstate(invalid="ignore"):
        out = growth > -RAISED * np.maximum(decay, 0.0)
    beside = (met[out, None] + 0.5 * width[out, None] * np.array([-1.0, 1.0])).ravel()
    beside = np.setdiff1d(beside[(beside > ends[0]) & (beside < ends[1])], along.speed)
    return along.beside(judge(beside)) if len(beside) else along


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


def closed_in(
    along: StabilityOverSpeed, judge: Judge, closely: float = ENDS
) -> tuple[StabilityOverSpeed, tuple[tuple[float, float], ...]]:
    """With the ends of what is unstable located, ``closely`` as a share of the speed, and the ranges."""
    grows = along.verdict == Verdict.UNSTABLE
    change = np.flatnonzero(grows[1:] != grows[:-1])
    low, high, rises = along.speed[change].copy(), along.speed[change + 1].copy(), grows[change + 1]
    left = np.arange(len(change))
    extra = along.of(np.zeros(0, dtype=np.intp))
    while len(left):
        middle = (low[left] + high[left]) / 2
        found = judge(middle)
        up = (found.verdict == Verdict.UNSTABLE) == rises[left]
        high[left], low[left] = np.where(up, middle, high[left]), np.where(up, low[left], middle)
        extra = extra.beside(found)
        left = left[high[left] - low[left] > closely * high[left]]
    starts, ends = list(high[rises]), list(low[~rises])
    if len(grows) and grows[0]:
        starts.insert(0, float(along.speed[0]))
    if len(grows) and grows[-1]:
        ends.append(float(along.speed[-1]))
    ranges = tuple((float(a), float(b)) for a, b in zip(starts, ends, strict=True))
    return along.beside(extra), ranges
