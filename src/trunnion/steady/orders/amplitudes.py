"""Amplitudes by order: as they are summed up, and as a whole over many speeds with its extremes over the cycle."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from trunnion.arrays import Array, Complex, Places
from trunnion.equations.topology import LONGEST_PERIOD, common_rate
from trunnion.numerics.cycle_extremes import cycle_extremes
from trunnion.steady.orders.channels import Channels

Key = tuple[Fraction, float]


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
    def keys(self) -> list[Key]:
        """Order and frequency of every column."""
        return list(zip(self.order, self.frequency.tolist(), strict=True))

    @property
    def order_numbers(self) -> Array:
        """``order`` as plain numbers."""
        return np.array([float(order) for order in self.order])

    @property
    def angular_frequency(self) -> Array:
        """ν = KΩ + ω (speed, order) [rad/s]; negative where a sideband of a fixed frequency is."""
        return self.speed[:, None] * self.order_numbers + self.frequency

    @property
    def common_turns(self) -> Fraction | None:
        """Turns of the input after which everything repeats; None where it does not."""
        base = None if np.any(self.frequency != 0) else _common_base(self.order)
        return 1 / base if base else None

    @property
    def adds_exactly(self) -> bool:
        """Whether extremes of the sum are those of the motion, not the sum of amplitudes as a bound."""
        in_time = np.count_nonzero(self.frequency)
        if in_time:
            return in_time == len(self.order) == 1
        return not self.order or self.common_turns is not None

    def extremes_at(self, channels: slice) -> Range:
        """Extremes (speed, channel) of some channels, mean included."""
        return self.extremes(self.amplitude[..., channels], self.mean[:, channels])

    @property
    def joint_rotations(self) -> Array:
        """Largest deviation at every joint's input (speed, joint) [rad]."""
        return self.extremes_at(self.channels.joint_input).largest

    def extremes(self, amplitude: Complex, mean: Array) -> Range:
        """Extremes (speed, channel) of mean (speed, channel) + amplitudes (speed, order, channel).

        With phases over the common period of the orders; what has no common period is added by its amplitudes, a bound.
        """
        turning = self.frequency == 0
        orders = tuple(o for o, t in zip(self.order, turning, strict=True) if t)
        base = _common_base(orders)
        loose = ~turning if base else np.ones(len(turning), dtype=bool)
        beside = np.abs(amplitude[:, loose]).sum(axis=1)
        low = high = np.zeros(mean.shape)
        if base and orders:
            index = np.array([int(order / base) for order in orders], dtype=np.int64)
            rows = np.moveaxis(amplitude[:, turning], 1, 2).reshape(-1, len(orders))
            low, high = (part.reshape(mean.shape) for part in cycle_extremes(index, rows))
        return Range(mean + low - beside, mean + high + beside)

    def wave(self, at: int, amplitude: Complex, mean: Array, time: Array) -> Array:
        """Values (time, channel) at ``time`` [s] of amplitudes (order, channel) and a mean (channel,) at speed ``at``.

        Time counts from zero rotation of the input.
        """
        turning = np.exp(1j * np.multiply.outer(time, self.angular_frequency[at]))
        return np.asarray(mean + (turning @ amplitude).real)


def joined(parts: Sequence[OrderSpectrum]) -> tuple[OrderSpectrum, Places]:
    """Spectra of one line as one, by rising speed, and where its speeds stood, one spectrum after the other."""
    first = parts[0]
    keys = sorted({key for part in parts for key in part.keys}, key=lambda key: (key[1], key[0]))
    place = {key: j for j, key in enumerate(keys)}
    speed = np.concatenate([part.speed for part in parts])
    amplitude = np.zeros((len(speed), len(keys), first.channels.count), dtype=complex)
    base = np.zeros((len(speed), len(keys), first.channels.points), dtype=complex)
    begin = 0
    for part in parts:
        rows, columns = slice(begin, begin + len(part.speed)), [place[key] for key in part.keys]
        amplitude[rows, columns], base[rows, columns] = part.amplitude, part.base
        begin += len(part.speed)

    def together(name: str) -> Array:
        """Numbers of springs: one row for all speeds, or a row each."""
        every = [getattr(part, name) for part in parts]
        if all(np.array_equal(one, every[0][:1]) for one in every):
            return np.asarray(every[0][:1])
        rows = [np.broadcast_to(one, (len(part.speed), one.shape[1])) for one, part in zip(every, parts, strict=True)]
        return np.concatenate(rows)[order]

    order = np.argsort(speed, kind="stable")
    found = OrderSpectrum(
        speed=speed[order],
        order=tuple(key[0] for key in keys),
        frequency=np.array([key[1] for key in keys]),
        amplitude=amplitude[order],
        base=base[order],
        mean=np.concatenate([part.mean for part in parts])[order],
        cut_off=np.concatenate([part.cut_off for part in parts])[order],
        channels=first.channels,
        damping=together("damping"),
        loss=together("loss"),
    )
    return found, order


def _common_base(orders: tuple[Fraction, ...]) -> Fraction | None:
    """Largest order that all ``orders`` are multiples of; None without orders or with too long a common period."""
    base = common_rate(orders)
    return base if base and 1 / base <= LONGEST_PERIOD else None
