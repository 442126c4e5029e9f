"""Harmonics by turns of a shaft, in time, or both, and what follows from their order k and frequency ν together.

A harmonic has the angle kφ + νt + phase: the torque of an asynchronous motor turns with its field in time and with its
rotor by angle. At a speed Ω its frequency is kΩ + ν, of either sign; where that vanishes the harmonic *stands still*
and is a constant. (k, ν, phase) and (−k, −ν, −phase) are the same cosine.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import lcm
from typing import Any

import numpy as np

from trunnion.arrays import Array, Complex

ROUNDING = 1e-12
"""Share of ν below which kΩ + ν is rounding."""
LONGEST_PERIOD = 60
"""Turns of the input beyond which a common period is not used."""


@dataclass(frozen=True)
class Harmonic:
    """amplitude · cos(order · φ + frequency · t + phase).

    order k [cycles per turn of φ], exact; frequency ν [rad/s]; amplitude in the unit of what swings; phase [rad].
    Amplitude and phase are numbers or (case,).
    """

    order: Fraction
    frequency: float
    amplitude: Any
    phase: Any

    def turning(self, speed: Any) -> Any:
        """Its frequency kΩ + ν [rad/s] at speeds Ω."""
        return turning(float(self.order), self.frequency, speed)

    def at(self, angle: Array) -> Array:
        """Its values (case, …) at angles (…) or (case, …) [rad], t = 0, where amplitude and phase are (case,)."""
        return np.asarray(self.amplitude[:, None] * np.cos(float(self.order) * angle + self.phase[:, None]))

    @property
    def complex_amplitude(self) -> Complex:
        """amplitude · e^{i phase}."""
        return np.asarray(self.amplitude * np.exp(1j * self.phase))

    @property
    def standstill(self) -> float:
        """Speed [rad/s] at which it stands still, −ν/k; infinite where no speed moves it."""
        return -self.frequency / float(self.order) if self.order else np.inf


def turning(order: Any, frequency: Any, speed: Any) -> Array:
    """kΩ + ν [rad/s], broadcast; 0 where only rounding is left."""
    found = np.asarray(order * speed + frequency)
    return np.where(np.abs(found) <= ROUNDING * np.abs(frequency), 0.0, found)


def forward(order: Any, frequency: float) -> int:
    """1, or −1 where a harmonic is written as its opposite (−k, −ν): so that ν > 0, or k > 0 where ν = 0."""
    return -1 if (frequency, order) < (0, 0) else 1


def common_rate(rates: Iterable[Fraction]) -> Fraction:
    """The greatest common divisor of some orders; 0 of none."""
    base = Fraction(0)
    for rate in rates:
        while rate:
            base, rate = rate, base % rate
    return base


def periods_in_common(frequencies: Sequence[float], most: int, close: float) -> int | None:
    """How many periods of the first frequency hold whole periods of all others.

    None where none does whose ratio to the first, to ``close`` as a share, has a denominator up to ``most``.
    """
    ratios = [Fraction(f / frequencies[0]).limit_denominator(most) for f in frequencies]
    count = lcm(*(r.denominator for r in ratios))
    wrong = (abs(float(r) * frequencies[0] / f - 1) > close for r, f in zip(ratios, frequencies, strict=True))
    return None if any(wrong) else count


def families(harmonics: Sequence[tuple[Fraction, float]]) -> list[tuple[list[int], list[int]]]:
    """Places of harmonics (k, ν) that are whole multiples of one, at every speed, and which; those of no other alone.

    Together they repeat after one period of what they are multiples of.
    """
    alike: dict[str, list[int]] = {}
    for place, (order, frequency) in enumerate(harmonics):
        alike.setdefault(f"{float(order) / frequency:.11e}" if frequency else "", []).append(place)
    found = []
    for places in alike.values():
        orders, frequencies = zip(*(harmonics[i] for i in places), strict=True)
        if not frequencies[0]:
            base = common_rate(orders)
            multiples = [int(order / base) for order in orders] if 1 / base <= LONGEST_PERIOD else []
        else:
            count = periods_in_common(frequencies, LONGEST_PERIOD, ROUNDING)
            multiples = [round(f / frequencies[0] * count) for f in frequencies] if count else []
        found += [(places, multiples)] if multiples else [([place], [1]) for place in places]
    return found
