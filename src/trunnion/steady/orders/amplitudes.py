"""Amplitudes by order: as they are summed up, and as a whole over many speeds with its extremes over the cycle."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, lru_cache
from itertools import accumulate
from typing import NamedTuple

import numpy as np

from trunnion.arrays import Array, Complex, Places
from trunnion.equations.line_coefficients import OilLink, oil_in_turn
from trunnion.laws.harmonic import families, forward, turning
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

    def with_rows(self, others: Range) -> Range:
        """Their rows behind its own."""
        return Range(np.concatenate([self.low, others.low]), np.concatenate([self.high, others.high]))

    def rows(self, which: Places) -> Range:
        """Some of its rows."""
        return Range(self.low[which], self.high[which])


def _by_frequency(key: Key) -> tuple[float, Fraction]:
    return key[1], key[0]


class OrderSum:
    """Amplitudes by (order, frequency), summed up as they come."""

    def __init__(self, cases: int, channels: Channels) -> None:
        self.channels = channels
        self.amplitude: dict[Key, Complex] = {}
        self.base: dict[Key, Complex] = {}
        self.mean = np.zeros((cases, channels.count))

    def spectrum(self, speed: Array, cut_off: Array, damping: Array, loss: Array) -> OrderSpectrum:
        """All of it, at ``speed`` (case,)."""
        keys = sorted({*self.amplitude, *self.base}, key=_by_frequency)
        amplitude = np.zeros((len(speed), len(keys), self.channels.count), dtype=complex)
        base = np.zeros((len(speed), len(keys), self.channels.points), dtype=complex)
        for j, key in enumerate(keys):
            amplitude[:, j], base[:, j] = self.amplitude.get(key, 0.0), self.base.get(key, 0.0)
        return OrderSpectrum(
            speed=speed, order=tuple(order for order, _ in keys),
            frequency=np.array([frequency for _, frequency in keys]), amplitude=amplitude, base=base, mean=self.mean,
            cut_off=cut_off, channels=self.channels, damping=damping, loss=loss,
        )  # fmt: skip

    def add(self, order: Fraction, frequency: float, amplitude: Complex) -> None:
        """Take in one part; without order and frequency it is the mean, and opposite harmonics are one."""
        if forward(order, frequency) < 0:
            order, frequency, amplitude = -order, -frequency, amplitude.conj()
        if order or frequency:
            self.amplitude[order, frequency] = self.amplitude.get((order, frequency), 0.0) + amplitude
        else:
            self.mean = self.mean + amplitude.real


@dataclass(frozen=True)
class OrderSpectrum:
    """Amplitudes by order at many speeds.

    order (order,) exact, in cycles per turn of the input, and frequency (order,) [rad/s] to add to it; amplitude
    (speed, order, channel) of the deviation from the base motion, base (speed, order, point) [rad] of the base
    motion itself; mean (speed, channel), static part included; cut_off (speed,): the outermost harmonics kept;
    damping and loss (1 or speed, spring) [N m s/rad, N m/rad]; ``oils`` have theirs at the frequency of each order;
    ``side_orders`` kept on either side of an excitation, the most at any speed, 0 where it makes none.
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
    oils: tuple[OilLink, ...] = ()
    side_orders: int = 0

    def take(self, rows: Places | slice) -> OrderSpectrum:
        """At some of its speeds."""
        damping, loss = (part[rows] if len(part) > 1 else part for part in (self.damping, self.loss))
        return replace(
            self, speed=self.speed[rows], amplitude=self.amplitude[rows], base=self.base[rows], mean=self.mean[rows],
            cut_off=self.cut_off[rows], damping=damping, loss=loss, oils=tuple(one.take(rows) for one in self.oils),
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
        """KΩ + ν (speed, order) [rad/s], of either sign."""
        return turning(self.order_numbers, self.frequency, self.speed[:, None])

    @cached_property
    def families(self) -> list[tuple[list[int], list[int]]]:
        """Columns that are whole multiples of one harmonic at every speed, and which."""
        return [(list(columns), list(multiples)) for columns, multiples in _families(tuple(self.keys))]

    @property
    def common_turns(self) -> Fraction | None:
        """Turns of the input after which everything repeats; None where it does not."""
        if not (self.order and self.adds_exactly) or self.frequency.any():
            return None
        columns, multiples = self.families[0]
        return multiples[0] / self.order[columns[0]]

    def period(self, at: int) -> float | None:
        """Time [s] after which everything repeats at speed number ``at``; None where it does not, or stands still."""
        if not (self.order and self.adds_exactly):
            return None
        columns, multiples = self.families[0]
        swings = np.abs(self.angular_frequency[at, columns[0]])
        return 2 * np.pi * multiples[0] / float(swings) if swings else None

    @property
    def adds_exactly(self) -> bool:
        """Whether extremes of the sum are those of the motion, not the sum of amplitudes as a bound."""
        return len(self.families) <= 1

    def extremes_at(self, channels: slice) -> Range:
        """Extremes (speed, channel) of some channels, mean included."""
        return self.extremes(self.amplitude[..., channels], self.mean[:, channels])

    @property
    def joint_rotations(self) -> Array:
        """Largest deviation at every joint's input (speed, joint) [rad]."""
        return self.extremes_at(self.channels.joint_input).largest

    def extremes(self, amplitude: Complex, mean: Array) -> Range:
        """Extremes (speed, channel) of mean (speed, channel) + amplitudes (speed, order, channel).

        With phases over the period that orders have in common; those that have none are added up, a bound. What stands
        still at a speed is a constant there.
        """
        low, high, turns = mean, mean, self.angular_frequency
        for columns, multiples in self.families:
            part = amplitude[:, columns]
            if len(columns) == 1 and self.frequency[columns[0]]:
                swing = np.abs(part[:, 0])
                down, up = -swing, swing
            else:
                rows = np.moveaxis(part, 1, 2).reshape(-1, len(columns))
                index = np.array(multiples, dtype=np.int64)
                down, up = (found.reshape(mean.shape) for found in cycle_extremes(index, rows))
            still = turns[:, columns[0]] == 0
            down[still] = up[still] = part[still].sum(axis=1).real
            low, high = low + down, high + up
        return Range(low, high)

    def wave(self, at: int, amplitude: Complex, mean: Array, time: Array) -> Array:
        """Values (time, channel) at ``time`` [s] of amplitudes (order, channel) and a mean (channel,) at speed ``at``.

        Time counts from zero rotation of the input.
        """
        turned = np.exp(1j * np.multiply.outer(time, self.angular_frequency[at]))
        return np.asarray(mean + (turned @ amplitude).real)


@lru_cache(maxsize=16)
def _families(keys: tuple[Key, ...]) -> list[tuple[list[int], list[int]]]:
    """Of spectra with the same orders, once."""
    return families(keys)


def stacked(parts: list[OrderSpectrum]) -> OrderSpectrum:
    """Spectra of one line as one, the speeds of one after those of the other; the list is left empty, so that no more
    is held than the whole and one part."""
    return _whole(parts, np.arange(sum(len(part.speed) for part in parts)))


def joined(parts: list[OrderSpectrum]) -> tuple[OrderSpectrum, Places]:
    """The same by rising speed, and where its speeds stood before."""
    order = np.argsort(np.concatenate([part.speed for part in parts]), kind="stable")
    return _whole(parts, order), order


def _whole(parts: list[OrderSpectrum], order: Places) -> OrderSpectrum:
    """All ``parts``, which are taken out of the list, their speeds in ``order``."""
    first, speeds = parts[0], [len(part.speed) for part in parts]
    if len(parts) == 1 and np.array_equal(order, np.arange(len(order))):
        return parts.pop()
    keys = sorted({key for part in parts for key in part.keys}, key=_by_frequency)
    column = {key: j for j, key in enumerate(keys)}

    def springs(every: list[Array]) -> Array:
        """One row for all speeds, or a row each."""
        if all(np.array_equal(one, every[0][:1]) for one in every):
            return every[0][:1]
        return np.concatenate([np.broadcast_to(one, (n, one.shape[1])) for one, n in zip(every, speeds, strict=True)])

    damping, loss = (springs([getattr(part, key) for part in parts]) for key in ("damping", "loss"))
    counted = range(min(len(part.oils) for part in parts))
    whole = OrderSpectrum(
        speed=np.concatenate([part.speed for part in parts])[order],
        order=tuple(key[0] for key in keys),
        frequency=np.array([frequency for _, frequency in keys]),
        amplitude=np.zeros((sum(speeds), len(keys), first.channels.count), dtype=complex),
        base=np.zeros((sum(speeds), len(keys), first.channels.points), dtype=complex),
        mean=np.concatenate([part.mean for part in parts])[order],
        cut_off=np.concatenate([part.cut_off for part in parts])[order],
        channels=first.channels,
        damping=damping[order] if len(damping) > 1 else damping,
        loss=loss[order] if len(loss) > 1 else loss,
        oils=tuple(oil_in_turn([part.oils[k] for part in parts], speeds).take(order) for k in counted),
        side_orders=max(part.side_orders for part in parts),
    )
    place = np.argsort(order)
    del first
    for end in reversed(list(accumulate(speeds))):
        part = parts.pop()
        rows, columns = place[end - len(part.speed) : end, None], [column[key] for key in part.keys]
        whole.amplitude[rows, columns], whole.base[rows, columns] = part.amplitude, part.base
    return whole
