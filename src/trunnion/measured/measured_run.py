"""How the speed of a measured run changes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import polynomial

from trunnion.arrays import Array
from trunnion.measured.tracking.result import MeasuredOrders

STEADY = 1e-4
"""Share within which speeds are one."""
PARTS = 4
"""Parts of a run whose accelerations are compared, fewer where each had fewer than two windows."""


@dataclass(frozen=True)
class MeasuredRun:
    """The range of speeds of a run [rad/s], its acceleration [rad/s²], and the least and largest of a part of it."""

    low: float
    high: float
    acceleration: float
    least: float
    largest: float

    @property
    def one_way(self) -> bool:
        """Whether the speed rises all the time, or falls all the time."""
        return self.least * self.largest > 0

    @property
    def change(self) -> float:
        """By which share of it the acceleration changes."""
        return max(abs(self.largest - self.acceleration), abs(self.least - self.acceleration)) / abs(self.acceleration)


def measured_run(data: MeasuredOrders) -> MeasuredRun | None:
    """The run of tracked windows; None where the speed stays."""
    ends = np.array([[-1.0, 1.0]])
    windows = data.rotation.windows
    at = np.array([polynomial.polyval(ends, polynomial.polyder(one.smooth))[0] / one.half for one in windows])
    low, high = float(at.min()), float(at.max())
    if high - low <= STEADY * high:
        return None
    rank = np.argsort(data.time)
    time, speed = data.time[rank], data.speed[rank]
    if len(time) < 2:
        return MeasuredRun(low, high, data.acceleration, data.acceleration, data.acceleration)
    slopes = [_slope(time, speed)]
    if (parts := min(PARTS, len(time) // 2)) > 1:
        slopes += [_slope(*part) for part in zip(*(np.array_split(one, parts) for one in (time, speed)), strict=True)]
    if not slopes[0]:
        return None
    return MeasuredRun(low, high, slopes[0], min(slopes), max(slopes))


def _slope(time: Array, speed: Array) -> float:
    return float(np.polyfit(time - time.mean(), speed, 1)[0])
