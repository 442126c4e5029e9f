"""Where modes meet what excites them: the speeds about which a response changes fast, and how fast.

A harmonic of order K (cycles per turn of the input) and frequency ν meets mode m where

    |KΩ + ν| = Im λ_m(Ω),     half-width |Re λ_m|/|K|.

Orders are those of disks and transmission errors; of joints and meshes whose stiffness varies; and the side orders
that these make of all. λ_m is an eigenvalue of the loaded straight line, behind angled joints the Floquet exponent that
grows out of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from trunnion.arrays import Array, Complex, Flags, Places
from trunnion.equations.coefficients import Assembly
from trunnion.equations.harmonics import line_harmonics
from trunnion.equations.steady_base import has_joint_angles
from trunnion.equations.topology import require_period
from trunnion.errors import InputError
from trunnion.floquet.ranges.exponents import ExponentOrders, floquet_exponents
from trunnion.floquet.ranges.span import Span
from trunnion.laws.harmonic import forward
from trunnion.modes.loaded_modes import loaded_modes
from trunnion.steady.orders.groups import offsets

LAYERS = 2
"""Side orders of side orders that are looked for."""
BESIDE = 0.1
"""Share of a speed by which angled joints may shift a resonance into the range."""
ROUNDS = 4
GRID = 65
"""Speeds at which the modes of a line are known whose damping depends on the speed."""


@dataclass(frozen=True)
class Resonances:
    """speed (resonance,) [rad/s], half-width in it (resonance,) [rad/s]; the order and frequency [rad/s] that meet
    there, KΩ + ν > 0, and the mode, from 0."""

    speed: Array
    width: Array
    order: Array
    frequency: Array
    mode: Places


@dataclass(frozen=True)
class Modes:
    """Damped modes of the straight line: values (speed, mode) [1/s] and shapes (speed, n, mode) at ``speed``."""

    speed: Array
    value: Complex
    shape: Complex

    @classmethod
    def of(cls, span: Span) -> Modes:
        """Over a range, and a little beyond where all that the line states reaches that far.

        Raises
        ------
        InputError : a curve or a table that ends within the range.
        """
        try:
            return cls._between(span, (1 - BESIDE) * span.start, (1 + BESIDE) * span.high)
        except InputError:
            return cls._between(span, span.start, span.high)

    @classmethod
    def _between(cls, span: Span, low: float, high: float) -> Modes:
        speed = np.linspace(low, high, GRID)
        return cls(speed, *loaded_modes(span.assembly, speed, span.table(speed)))

    def at(self, speed: Array, mode: Places) -> tuple[Complex, Complex]:
        """Value (case,) and shape (case, n) of each ``mode`` (case,) at a ``speed`` (case,)."""
        place = np.clip(np.searchsorted(self.speed, speed), 1, len(self.speed) - 1)
        share = np.clip((speed - self.speed[place - 1]) / (self.speed[place] - self.speed[place - 1]), 0, 1)
        value = (1 - share) * self.value[place - 1, mode] + share * self.value[place, mode]
        return value, self.shape[place, :, mode]


def varies(assembly: Assembly) -> bool:
    """Whether an angled joint or a mesh makes the coefficients vary."""
    return has_joint_angles(assembly) or any(mesh.stiffness_rates for mesh in assembly.topology.meshes)


def orders_acting(assembly: Assembly) -> tuple[Array, Array]:
    """Orders (pair,) and frequencies beside them (pair,) [rad/s] of all that can shake the line and goes with its
    speed."""
    pairs = {(one.order, one.frequency) for one in line_harmonics(assembly) if one.acts}
    if varies(assembly):
        turns = require_period(assembly.line, assembly.topology)
        steps = offsets({int(rate * turns) for rate in assembly.topology.rates}, LAYERS)
        pairs = {(order + step / turns, at) for order, at in {*pairs, (Fraction(0), 0.0)} for step in steps}
    kept = sorted({(forward(order, at) * order, forward(order, at) * at) for order, at in pairs if order})
    found = np.array([(float(order), at) for order, at in kept]).reshape(-1, 2)
    return found[:, 0], found[:, 1]


def resonances(span: Span) -> Resonances:
    """All that lie within a range.

    Raises
    ------
    InputError : a line without a period.
    """
    order, frequency = orders_acting(span.assembly)
    modes = Modes.of(span)
    # Of either sign: one that stands still on the way meets each mode before and behind.
    order, frequency = (np.concatenate([part, -part]) for part in (order, frequency))
    met = (np.multiply.outer(order, modes.speed) + frequency[:, None])[:, :, None]  # (pair, speed, 1)
    with np.errstate(invalid="ignore"):
        off = met - modes.value.imag
        pair, place, mode = np.nonzero((off[:, :-1] <= 0) != (off[:, 1:] <= 0))
    before, after = off[pair, place, mode], off[pair, place + 1, mode]
    known = np.isfinite(before) & np.isfinite(after)
    pair, place, mode = pair[known], place[known], mode[known]
    before, after = before[known], after[known]
    step = modes.speed[1] - modes.speed[0]
    speed = modes.speed[place] + step * before / (before - after)
    value = modes.at(speed, mode)[0]
    if varies(span.assembly) and len(speed):
        speed, value = _shifted(span, modes, mode, order[pair], frequency[pair], speed)
    with np.errstate(invalid="ignore"):
        inside = (speed >= span.start) & (speed <= span.high)
    width = np.abs(value.real) / np.abs(order[pair])
    return Resonances(speed[inside], width[inside], order[pair][inside], frequency[pair][inside], mode[inside])


def _shifted(
    span: Span, modes: Modes, mode: Places, order: Array, frequency: Array, speed: Array
) -> tuple[Array, Complex]:
    """Where the same meet once joints have angles, and the exponents there."""
    sides = ExponentOrders.of(span.assembly)
    start, shape = modes.at(speed, mode)
    value, left = start.copy(), np.arange(len(speed))
    for _ in range(ROUNDS):
        found = floquet_exponents(span.assembly, sides, span.table(speed[left]), start[left], shape[left])
        value[left] = np.where(np.isfinite(found), found, value[left])
        again = (value[left].imag - frequency[left]) / order[left]
        near = _near(again, speed[left])
        moved = np.abs(again - speed[left]) > 0.05 * np.abs(value[left].real / order[left])
        speed[left[near]] = again[near]
        left = left[near & moved]
        if not len(left):
            break
    return speed, value


def _near(again: Array, speed: Array) -> Flags:
    """What is still the same resonance, not one that the iteration fell into."""
    return np.asarray(np.abs(again - speed) <= 2 * BESIDE * speed)
