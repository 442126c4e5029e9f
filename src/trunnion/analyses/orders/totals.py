"""Sums of a steady response over its cycle: extremes, common period, wave form."""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

import numpy as np

from trunnion.analyses.orders.amplitudes import OrderSpectrum
from trunnion.arrays import Array, Complex
from trunnion.equations.topology import LONGEST_PERIOD, common_rate
from trunnion.numerics.cycle_extremes import cycle_extremes


def common_base(orders: tuple[Fraction, ...]) -> Fraction | None:
    """Largest order that all ``orders`` are multiples of; None without orders or with too long a common period."""
    base = common_rate(orders)
    return base if base and 1 / base <= LONGEST_PERIOD else None


def common_turns(spectrum: OrderSpectrum) -> Fraction | None:
    """Turns of the input after which everything repeats; None where it does not."""
    if np.any(spectrum.frequency != 0):
        return None
    base = common_base(spectrum.order)
    return 1 / base if base else None


def adds_exactly(spectrum: OrderSpectrum) -> bool:
    """Whether extremes of the sum are those of the motion, not the sum of amplitudes as a bound."""
    in_time = np.count_nonzero(spectrum.frequency)
    if in_time:
        return in_time == len(spectrum.order) == 1
    return not spectrum.order or common_turns(spectrum) is not None


class Range(NamedTuple):
    """Lowest and highest values over the cycle."""

    low: Array
    high: Array

    @property
    def swing(self) -> Array:
        """Half of the peak-to-peak values."""
        return np.asarray((self.high - self.low) / 2)

    @property
    def largest(self) -> Array:
        """Largest absolute values."""
        return np.maximum(np.abs(self.low), np.abs(self.high))


def extremes(spectrum: OrderSpectrum, amplitude: Complex, mean: Array) -> Range:
    """Extremes (speed, channel) of mean (speed, channel) + amplitudes (speed, order, channel).

    With phases over the common period of the orders; what has no common period is added by its amplitudes, a bound.
    """
    shape = mean.shape
    turning = spectrum.frequency == 0
    orders = tuple(o for o, t in zip(spectrum.order, turning, strict=True) if t)
    base = common_base(orders)
    loose = ~turning if base else np.ones(len(turning), dtype=bool)
    beside = np.abs(amplitude[:, loose]).sum(axis=1)
    low = high = np.zeros(shape)
    if base and orders:
        index = np.array([int(order / base) for order in orders], dtype=np.int64)
        rows = np.moveaxis(amplitude[:, turning], 1, 2).reshape(-1, len(orders))
        low, high = (part.reshape(shape) for part in cycle_extremes(index, rows))
    return Range(mean + low - beside, mean + high + beside)


def extremes_at(spectrum: OrderSpectrum, channels: slice) -> Range:
    """Extremes (speed, channel) of some channels of a spectrum, mean included."""
    return extremes(spectrum, spectrum.amplitude[..., channels], spectrum.mean[:, channels])


def wave(spectrum: OrderSpectrum, at: int, amplitude: Complex, mean: Array, time: Array) -> Array:
    """Values (time, channel) at ``time`` [s] of the amplitudes (order, channel) and mean (channel,) of speed ``at``.

    Time counts from zero rotation of the input.
    """
    turning = np.exp(1j * np.multiply.outer(time, spectrum.angular_frequency[at]))
    return np.asarray(mean + (turning @ amplitude).real)
