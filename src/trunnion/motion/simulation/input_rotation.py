"""How the input of a line turned in a run: as prescribed, or by itself where the line is free–free.

Orders count cycles per turn of the input. A free–free line turns as its torques let it, whatever speed it was
begun at or asked for, so that turns, speeds and orders are read from the rotation that it makes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.equations.speed_profile import SpeedProfile

PARTS = 4
"""Of a step of the integration, at which a rotation of its own is looked at: less than a swing, so that between two of
them it turns one way or hardly at all."""
NEWTON = 8
"""Steps to the time of an angle, each kept within its bracket; three are enough for rounding."""
TURN = 2 * np.pi


@dataclass(frozen=True)
class InputRotation:
    """Rotation of a line's input from t = 0 to ``end`` [s].

    profile: the speed prescribed, or asked of a free–free line; cuts (steps + 1,) [s] between which the motion
    is smooth; deviation: times (m,) → deviation (m,) [rad] from the profile's angle and its rate (m,) [rad/s], None
    where the speed is prescribed.
    """

    profile: SpeedProfile
    end: float
    cuts: Array
    deviation: Callable[[Array], tuple[Array, Array]] | None = None

    def angle(self, time: ArrayLike) -> Array:
        """Angle [rad] turned since t = 0 at times (m,)."""
        times = np.atleast_1d(np.asarray(time, dtype=float))
        if self.deviation is None:
            return self.profile.angle(times)
        begun = self.deviation(np.zeros(1))[0]
        return np.asarray(self.profile.angle(times) + self.deviation(times)[0] - begun)

    def speed(self, time: ArrayLike) -> Array:
        """Speed [rad/s] at times (m,)."""
        times = np.atleast_1d(np.asarray(time, dtype=float))
        asked = self.profile.at(times)
        return asked if self.deviation is None else np.asarray(asked + self.deviation(times)[1])

    def times_at(self, angles: Array) -> Array:
        """Times [s] at which the input first stands at ``angles`` [rad] (rising, from 0); NaN where it never does."""
        if self.deviation is None:
            return self.profile.times_at(angles, self.end)
        grid, furthest = self._seen
        after = np.searchsorted(furthest, angles)
        found = np.full(len(angles), np.nan)
        known = after < len(grid)
        place = np.maximum(after[known], 1)
        low, high, goal = grid[place - 1], grid[place], angles[known]
        times = (low + high) / 2
        for _ in range(NEWTON):
            over, speed = self.angle(times) - goal, self.speed(times)
            low, high = np.where(over < 0, times, low), np.where(over < 0, high, times)
            step = times - over / np.where(speed == 0, np.inf, speed)
            times = np.where((step >= low) & (step <= high), step, (low + high) / 2)
        found[known] = times
        return found

    @cached_property
    def _seen(self) -> tuple[Array, Array]:
        """Times all over the run, and the furthest angle reached until each."""
        parts = self.cuts[:-1, None] + np.diff(self.cuts)[:, None] * np.arange(PARTS) / PARTS
        grid = np.append(parts.ravel(), self.end)
        return grid, np.maximum.accumulate(self.angle(grid))

    @property
    def furthest(self) -> float:
        """The largest angle [rad] that was reached."""
        return float(self.profile.angle(self.end)) if self.deviation is None else float(self._seen[1][-1])

    @property
    def turned_back(self) -> float | None:
        """The first time [s] at which the input turns against its sense; None where it never does."""
        if self.deviation is None:
            return None
        grid = self._seen[0]
        back = np.flatnonzero(self.speed(grid) < 0)
        return float(grid[back[0]]) if len(back) else None

    @cached_property
    def turns(self) -> tuple[Array, Array]:
        """Ends of every whole turn (turns + 1,) [s], and the mean speed (turns,) [rad/s] in each."""
        count = int(self.furthest / TURN * (1 + 1e-12))
        ends = np.minimum(self.times_at(TURN * np.arange(count + 1.0)), self.end)
        return ends, TURN / np.diff(ends)

    def last_turn(self) -> tuple[float, float]:
        """When the last turn began [s], and the mean speed since [rad/s]; since t = 0 where it made no turn."""
        end = float(self.angle(self.end)[0])
        since = float(self.times_at(np.array([max(end - TURN, 0.0)]))[0]) if end > 0 else 0.0
        return since, (end - float(self.angle(since)[0])) / (self.end - since)
