"""Cycles of a history by rainflow counting, ASTM E1049-85, section 5.4.4; counted by the library ``rainflow``.

A history that repeats is counted from its largest value on and closed (section 5.4.5): then nothing is left over, and
each of its ranges is a whole cycle, the largest one two halves.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import rainflow

from trunnion.arrays import Array
from trunnion.numerics.turning_points import reversals


@dataclass(frozen=True)
class Cycles:
    """Amplitude (half of the range), mean and count (cycles,): 1 of a whole cycle, 0.5 of a half."""

    amplitude: Array
    mean: Array
    count: Array

    def scaled(self, factor: float) -> Cycles:
        """The same of a history that is ``factor`` times as large."""
        return Cycles(self.amplitude * abs(factor), self.mean * factor, self.count)


def rainflow_cycles(values: Array, *, repeats: bool) -> Cycles:
    """Cycles of a history (points,) in the order in which they close.

    repeats : the last value is followed by the first; otherwise ranges that do not close count by half.
    """
    turning = values[reversals(values)]
    if repeats:
        first = int(np.argmax(np.abs(turning)))
        turning = np.concatenate([turning[first:], turning[: first + 1]])
    # The library takes no range from two values alone; one that stays is none.
    counted = rainflow.extract_cycles(np.append(turning, turning[-1]).tolist())
    rows = np.array([row[:3] for row in counted if row[0] > 0]).reshape(-1, 3)
    return Cycles(rows[:, 0] / 2, rows[:, 1], rows[:, 2])
