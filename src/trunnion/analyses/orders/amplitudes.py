"""Amplitudes by order: as they are summed up, and as a whole over many speeds."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from trunnion.analyses.orders.channels import Channels
from trunnion.arrays import Array, Complex

Key = tuple[Fraction, float]


class OrderSum:
    """Amplitudes by (order, frequency), summed up as they come."""

    def __init__(self, cases: int, channels: Channels) -> None:
        self.amplitude: dict[Key, Complex] = {}
        self.base: dict[Key, Complex] = {}
        self.mean = np.zeros((cases, channels.count))
        self.zero = np.zeros((cases, channels.count), dtype=complex)
        self.flat = np.zeros((cases, channels.points), dtype=complex)

    def add(self, order: Fraction, frequency: float, amplitude: Complex) -> None:
        """Take in one part; order 0 is the mean, negative orders are folded onto positive ones."""
        if frequency == 0 and order == 0:
            self.mean = self.mean + amplitude.real
        elif frequency == 0 and order < 0:
            self.add(-order, 0.0, amplitude.conj())
        else:
            key = (order, frequency)
            self.amplitude[key] = self.amplitude.get(key, self.zero) + amplitude


@dataclass(frozen=True)
class OrderSpectrum:
    """Amplitudes by order at many speeds.

    order (order,) exact, in cycles per turn of the input, and frequency (order,) [rad/s] to add to it; amplitude
    (speed, order, channel) of the deviation from the base motion, base (speed, order, point) [rad] of the base
    motion itself; mean (speed, channel), static part included; cut_off (speed,): the outermost harmonics kept;
    damping and loss (1 or speed, spring) [N m s/rad, N m/rad].
    """

    speed: Array
    order: tuple[Fraction, ...]
    frequency: Array
    amplitude: Complex
    base: Complex
    mean: Array
    cut_off: Array
    channels: Channels
    damping: Array
    loss: Array

    def at(self, i: int) -> OrderSpectrum:
        """At speed number ``i`` alone."""
        one = slice(i, i + 1)
        damping, loss = (part[one] if len(part) > 1 else part for part in (self.damping, self.loss))
        return replace(
            self, speed=self.speed[one], amplitude=self.amplitude[one], base=self.base[one], mean=self.mean[one],
            cut_off=self.cut_off[one], damping=damping, loss=loss,
        )  # fmt: skip

    @property
    def order_numbers(self) -> Array:
        """``order`` as plain numbers."""
        return np.array([float(order) for order in self.order])

    @property
    def angular_frequency(self) -> Array:
        """ν = KΩ + ω (speed, order) [rad/s]; negative where a sideband of a fixed frequency is."""
        return self.speed[:, None] * self.order_numbers + self.frequency
