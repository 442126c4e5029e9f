"""Orders of a pulse train that stand out of its noise."""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array
from trunnion.measured.signals.measurement import PulseTrain
from trunnion.measured.tracking.rotation import repeated, rotation_windows

ABOVE_NOISE = 4.0
"""Factor above the noise from which an order stands out."""
LEAKS = 0.05
"""Share of an order that those half an order beside it may have from it."""


def standing_out(train: PulseTrain, pattern: Array, turns: int) -> list[tuple[float, float]]:
    """Whole and half orders of a pulse train's own shaft above its noise, with their amplitudes [rad].

    pattern : pitch errors (tooth,) [rad] that are taken off.
    """
    length = 2 * max(1, turns // 2)
    every, own = _spectrum(train, pattern, length)
    # What repeats with the teeth looks like orders below one, by what a window's cubic takes of it, and hides halves.
    changing = _spectrum(train, pattern + own, length)[0]
    # Each order against what stands around it at orders that are not halves.
    noise = float(np.median(every[1:])) * 1.2
    step, found = length // 2, []
    for at in range(step, len(every), step):
        size = changing if at % length else every
        # A strong order that changes within the window reaches into those beside it.
        beside = max(float(size[at - step]), float(size[min(at + step, len(size) - 1)]))
        if size[at] > max(ABOVE_NOISE * noise, LEAKS * beside):
            found.append((at / length, float(size[at])))
    return found


def _spectrum(train: PulseTrain, pattern: Array, length: int) -> tuple[Array, Array]:
    """Rms amplitude [rad] over windows of ``length`` turns (order,), by steps of 1/length; and what would take off
    that which repeats with the teeth (tooth,)."""
    windows, fits = rotation_windows(train, 1.0, length, np.zeros(0), pattern, 0)
    teeth = train.pulses_per_turn
    power = np.zeros(length * teeth // 2 + 1)
    for one, fit in zip(windows, fits, strict=True):
        row = np.zeros(length * teeth)
        place = (train.number[one.first : one.last] - train.number[one.first]) % (length * teeth)
        row[place] = fit.residual
        power += np.abs(2 * np.fft.rfft(row) / len(row)) ** 2
    teeth_of = [train.tooth[one.first : one.last] for one in windows]
    return np.sqrt(power / len(fits)), repeated([fit.residual for fit in fits], teeth_of, teeth)
