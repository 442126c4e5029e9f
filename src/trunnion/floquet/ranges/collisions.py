"""Where two modes of a line meet that joints and meshes may make grow together, and how fast they grow there.

Two modes can grow together where their Floquet exponents meet (``resonance_speeds``),

    Im λ_i(Ω) + Im λ_j(Ω) = cΩ,

c the cycles per turn with which joints and meshes excite, or a sum of multiples. There growth is fastest, over a
stretch as wide as it is fast, and beside it as slow as the straight line's. Meetings whose modes are damped more than
joints and meshes can feed are left out: order k of an unevenness S feeds no more than ωSᵏ. Of the others the two
exponents are followed to where they meet once joints have angles, which tells how fast the two grow there.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from fractions import Fraction

import numpy as np

from trunnion.arrays import Array, Flags, Integers, Places
from trunnion.equations.coefficients import joint_laws
from trunnion.equations.steady_base import has_periodic_base
from trunnion.floquet.ranges.exponents import REACH, ExponentOrders, KeptTrees, colliding_exponents
from trunnion.floquet.ranges.resonances import BESIDE, Modes, resonances
from trunnion.floquet.ranges.span import Span
from trunnion.steady.orders.groups import offsets
from trunnion.steady.orders.spectrum import order_spectrum

POINTS = 65
"""Speeds of an even grid at which the swing of joints is looked at."""
ORDERS = 12, 6
"""Multiples of an exciting frequency; of several their sums and differences, so many together."""
FED = 2.0
"""Factor on what joints and meshes are taken to feed."""
APART = (5e-3, 1e-3)
"""Shares of the speed by which the three speeds lie apart that tell where two exponents meet."""
RAISED = 0.5
"""Share of the straight line's decay from which growth at a meeting stands out."""
SLOWEST_BY = 0.05
"""Share by which a pair may decay faster at a meeting than the slowest mode of the straight line and still count."""
SAME_SUM = 0.1
"""Share by which joints change the sum of two decays: where it differs by more, other modes than the two were found."""
SETTLED = 0.05
"""Share of the sum of two decays by which the last step may still move them."""
MORE_THAN_NODES = 4
"""Speeds of which three stand for all."""
NEAR = 3.0
"""Distances of the three speeds by which the meeting may lie beside them and still have the growth that they tell."""
WIDEST = 10.0
"""Factor by which two modes that are damped differently grow over a wider stretch, at most."""


@dataclass(frozen=True)
class Collisions:
    """Where two exponents meet: speed (meeting,) [rad/s], the ``decay`` of the slower mode [1/s] there, half of the
    stretch [rad/s] over which they can grow, how fast they grow [1/s], NaN where that is not known, half of the stretch
    [rad/s] over which they do, nearly, 0 where they do not, the decay of the slowest mode of the straight line [1/s],
    the ``breadth`` [rad/s] of the bump in the decay of one that acts on the other: what both are damped by, and which
    modes of the straight line meet, ``first`` and ``second``, by how many ``step`` of the coefficients' harmonics."""

    speed: Array
    decay: Array
    width: Array
    growth: Array
    half: Array
    slowest: Array
    breadth: Array
    first: Places
    second: Places
    step: Integers

    def of(self, which: Flags) -> Collisions:
        """Some of them."""
        return Collisions(*(getattr(self, one.name)[which] for one in fields(self)))

    @staticmethod
    def together(parts: list[Collisions]) -> Collisions:
        """All of them."""
        none = [np.zeros(0)]
        names = [one.name for one in fields(Collisions)]
        return Collisions(*(np.concatenate([getattr(part, name) for part in parts] or none) for name in names))

    @property
    def raised(self) -> Flags:
        """Where growth stands out (meeting,), or may."""
        with np.errstate(invalid="ignore"):
            return np.asarray(~(self.growth <= -RAISED * np.maximum(self.decay, 0.0)))

    @property
    def matters(self) -> Flags:
        """Where the line may grow, or decay more slowly than beside (meeting,)."""
        with np.errstate(invalid="ignore"):
            return np.asarray(self.raised | ~(self.growth <= -(1 + SLOWEST_BY) * self.slowest))


def exponent_collisions(span: Span, low: float, high: float, swing: float | None = None) -> Collisions:
    """Where two exponents meet that joints and meshes may make grow; ``swing`` as of ``unstable_ranges``."""
    modes = Modes.of(span)
    if not modes.value.shape[1] or low >= high or not span.assembly.topology.rates:
        return Collisions.together([])
    joints, meshes = _nonuniformity(span)
    fed = min(4 * joints + meshes + (_swing(span) if swing is None else swing), 1.0)
    left_out = (joints + meshes / 2) ** (2 * REACH)
    sides = ExponentOrders.of(span.assembly)
    rates = {int(rate * sides.turns) for rate in span.assembly.topology.rates}
    every = {step / sides.turns: k for step, k in offsets(rates, ORDERS[min(len(rates), 2) - 1]).items() if step > 0}
    kept = kept_trees(span)
    parts = [_of_cycles(span, modes, sides, cycles, FED * fed**k, left_out, kept) for cycles, k in every.items()]
    found = Collisions.together(parts)
    return found.of((found.speed >= low) & (found.speed <= high))


def kept_trees(span: Span) -> KeptTrees | None:
    """Blocks that all speeds of a range share, of a line whose numbers do not follow the speed."""
    if span.put:
        return None
    speeds = np.linspace(span.start, span.high, MORE_THAN_NODES)
    return KeptTrees(span.assembly, span.table(speeds), span.statically_twisted)


def _of_cycles(
    span: Span,
    modes: Modes,
    sides: ExponentOrders,
    cycles: Fraction,
    share: float,
    left_out: float,
    kept: KeptTrees | None,
) -> Collisions:
    """The same of what excites with so many ``cycles`` per turn and feeds a ``share`` of a frequency; ``left_out``: the
    share by which harmonics that are not looked at shift it."""
    i, j = np.triu_indices(modes.value.shape[1])
    c = float(cycles)
    with np.errstate(invalid="ignore"):
        off = modes.value.imag[:, i] + modes.value.imag[:, j] - c * modes.speed[:, None]
        place, pair = np.nonzero((off[:-1] <= 0) != (off[1:] <= 0))
        (fast, decay), (other, beside) = (
            (modes.value.imag[place, m[pair]], -modes.value.real[place, m[pair]]) for m in (i, j)
        )
        own, fastest = np.sqrt(np.maximum(decay * beside, 0.0)), np.maximum(fast, other)
        open_ones = own <= share * fastest  # never so of a mode that does not oscillate
    place, pair, own = place[open_ones], pair[open_ones], own[open_ones]
    before, after = off[place, pair], off[place + 1, pair]
    speed = modes.speed[place] + (modes.speed[1] - modes.speed[0]) * before / (before - after)
    growth, half = np.zeros(0), np.zeros(0)
    if len(speed):
        speed, growth, half = _followed(span, modes, sides, cycles, (i[pair], j[pair]), speed, kept)
    # Modes that are damped differently grow together over a wider stretch: by the mean of both decays, over √(δ₁δ₂).
    with np.errstate(divide="ignore", invalid="ignore"):
        half = half * np.nan_to_num(np.clip((decay + beside)[open_ones] / (2 * own), 1.0, WIDEST), nan=1.0)
    slowest = np.where(np.isnan(modes.value.real), np.inf, -modes.value.real).min(axis=1)
    slowest = np.minimum(slowest[place], slowest[place + 1])
    return Collisions(
        speed, np.minimum(decay, beside)[open_ones], np.maximum(own / c, 1e-9 * speed),
        growth + left_out * fastest[open_ones], half, slowest, breadth=(decay + beside)[open_ones] / c,
        first=i[pair], second=j[pair], step=np.full(len(speed), int(cycles * sides.turns), dtype=np.int64),
    )  # fmt: skip


def _followed(
    span: Span,
    modes: Modes,
    sides: ExponentOrders,
    cycles: Fraction,
    pair: tuple[Places, Places],
    speed: Array,
    kept: KeptTrees | None,
) -> tuple[Array, Array, Array]:
    """Where two exponents meet once joints have angles, from where those of the straight line do; how fast they grow
    there, no less than they do, NaN where that is not known; and over which stretch, were both damped alike.

    Their difference squared is smooth where they meet and where they have parted: −c²((Ω − Ω₀)² − w²), nearly. Three
    speeds tell Ω₀ and w.
    """
    begin, growth, half = speed.copy(), np.full(len(speed), np.nan), np.zeros(len(speed))
    for wide in APART:
        three = speed[:, None] * (1 + wide * np.array([-1.0, 0.0, 1.0]))
        flat = three.ravel()
        one, two = (modes.at(flat, np.repeat(mode, 3)) for mode in pair)
        found, moved = colliding_exponents(
            span.assembly, sides, span.table(flat), cycles, (one[0], two[0]), (one[1], two[1]),
            statically_twisted=span.statically_twisted, kept=kept,
        )  # fmt: skip
        square = -((found[:, 0] - found[:, 1]) ** 2).real.reshape(three.shape)
        low, middle, high = square.T
        with np.errstate(divide="ignore", invalid="ignore"):
            bend = low - 2 * middle + high
            step = wide * speed * (low - high) / (2 * bend)
            good = np.isfinite(step) & (np.abs(speed + step - begin) <= BESIDE * begin)
            sum_of_two = found.sum(axis=1).real.reshape(three.shape)
            straight = (one[0] + two[0]).real.reshape(three.shape)
            parted = np.sqrt(np.maximum((low - high) ** 2 / (8 * bend) - middle, 0.0))
            grown = np.maximum(parted**2 - sum_of_two[:, 1] ** 2, 0.0)
            top = np.maximum((sum_of_two[:, 1] + parted) / 2, found.real.max(axis=1).reshape(three.shape).max(axis=1))
            same = (np.abs(sum_of_two - straight) <= SAME_SUM * np.abs(straight)).all(axis=1)
            last = moved.reshape(three.shape).max(axis=1)
            near = good & same & (bend > 0) & (np.abs(step) <= NEAR * wide * speed)
            near &= last <= SETTLED * np.abs(straight[:, 1])
            growth = np.where(near, top + last, np.nan)
            half = np.where(near & (top > 0), wide * speed * np.sqrt(2 * grown / bend), 0.0)
        speed = np.where(good, speed + step, speed)
    if has_periodic_base(span.assembly):  # the motion that it makes varies it too
        growth[:], half[:] = np.nan, 0.0
    return speed, growth, half


def _nonuniformity(span: Span) -> tuple[float, float]:
    """The spreads of all joints, and how much meshes vary stiffness, as a share of it."""
    table = span.table(np.linspace(span.start, span.high, 5))
    coefficients = span.assembly.coefficients(table, any_frequency=True)
    joints = sum(float(np.max(law.spread)) for law in joint_laws(span.assembly, table))
    shares = (sum(np.abs(one.amplitude) for one in wave.harmonics) for wave in coefficients.waves)
    return joints, sum(float(np.max(share)) for share in shares)


def _swing(span: Span) -> float:
    """How far the inputs of joints swing [rad] in the periodic steady state of a line that has one, at its resonances
    too, by linear theory: what it feeds beside the joints' unevenness."""
    if not has_periodic_base(span.assembly):
        return 0.0
    speed = np.unique(np.concatenate([np.linspace(span.start, span.high, POINTS), resonances(span).speed]))
    table = span.table(speed) if span.put else None
    found = order_spectrum(span.assembly, speed, table=table, rough=True)
    return float(np.nan_to_num(found.joint_rotations, nan=1.0, posinf=1.0).max(initial=0.0))
