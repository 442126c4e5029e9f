"""Run-ups and run-downs of a recording, found by the speed of its turns."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from trunnion.arrays import Array
from trunnion.measured.signals.measurement import TURN, PulseTrain

LEAST = 1.2
"""Ratio of the speeds at the ends of what is called a run-up."""
FEWEST = 12
"""Turns of one."""
SLOPES = 5
"""Turns over which the acceleration is looked at, to either side."""
RAMPING = 0.15
"""Share of the usual acceleration of the recording's ramps from which a turn belongs to one."""


class MeasuredRamp(NamedTuple):
    """First and last time [s] and speed [rad/s] of a stretch in which the speed rises, or falls."""

    first_time: float
    last_time: float
    first_speed: float
    last_speed: float

    @property
    def ratio(self) -> float:
        """The higher of its speeds over the lower."""
        low, high = sorted((self.first_speed, self.last_speed))
        return high / low if low > 0 else 1.0


def run_ups(train: PulseTrain) -> tuple[MeasuredRamp, ...]:
    """Stretches over which the speed rises or falls by a fifth or more.

    Parameters
    ----------
    train : pulses of a wheel, whose own speed is looked at turn by turn.

    Examples
    --------
    >>> import numpy as np, trunnion as tn
    >>> rotation = 2 * np.pi * np.arange(30 * 100) / 30
    >>> (ramp,) = tn.run_ups(tn.PulseTrain(np.sqrt(rotation / 10 + 4), 30))  # 20 rad/s² from 40 rad/s on
    >>> 40 < ramp.first_speed < 50, round(ramp.ratio, 1) > 3
    (True, True)
    """
    time, speed = turn_speeds(train)
    if len(speed) < FEWEST:
        return ()
    reach = min(SLOPES, len(speed) // 4)
    padded = np.pad(speed, reach, mode="edge")
    times = np.pad(time, reach, mode="edge")
    rise = (padded[2 * reach :] - padded[: -2 * reach]) / np.maximum(times[2 * reach :] - times[: -2 * reach], 1e-300)
    usual = float(np.percentile(np.abs(rise), 90))
    if not usual > 0:
        return ()
    sense = np.where(np.abs(rise) > RAMPING * usual, np.sign(rise), 0.0)
    cuts = np.flatnonzero(np.diff(sense) != 0) + 1
    found = []
    for rows in np.split(np.arange(len(speed)), cuts):
        first, last = int(rows[0]), int(rows[-1])
        ramp = MeasuredRamp(float(time[first]), float(time[last]), float(speed[first]), float(speed[last]))
        if sense[first] and len(rows) >= FEWEST and ramp.ratio >= LEAST:
            found.append(ramp)
    return tuple(found)


def longest_ramp(ramps: Sequence[MeasuredRamp]) -> MeasuredRamp | None:
    """The one that covers the most speeds; None of none."""
    return max(ramps, key=lambda one: one.ratio, default=None)


def turn_speeds(train: PulseTrain) -> tuple[Array, Array]:
    """Middle [s] and mean speed [rad/s] of every turn, from one edge to that of the same tooth a turn later."""
    starts = np.arange(train.number[0], train.number[-1], train.pulses_per_turn)
    place = np.searchsorted(train.number, starts)
    there = train.number[np.minimum(place, len(train.number) - 1)] == starts
    marks, turns = train.times[place[there]], starts[there] / train.pulses_per_turn
    return (marks[1:] + marks[:-1]) / 2, TURN * np.diff(turns) / np.diff(marks)
