"""An input speed that varies: straight pieces between given points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.equations.line_system import SpeedRamp
from trunnion.errors import InputError


@dataclass(frozen=True)
class SpeedProfile:
    """Input speed through points, straight in between and constant behind the last.

    Parameters
    ----------
    time : [s], rising, from 0.
    speed : [rad/s] at those times, positive.

    >>> profile = SpeedProfile([0.0, 5.0], [50.0, 250.0])
    >>> float(profile.at(2.5)), float(profile.angle(5.0))
    (150.0, 750.0)
    """

    time: tuple[float, ...]
    speed: tuple[float, ...]

    def __init__(self, time: ArrayLike, speed: ArrayLike) -> None:
        t, w = np.asarray(time, dtype=float), np.asarray(speed, dtype=float)
        remedy = "write tn.SpeedProfile([0, 5], [tn.rpm(500), tn.rpm(2500)])"
        if t.ndim != 1 or t.shape != w.shape or not len(t):
            raise InputError("needs as many speeds as times", element="SpeedProfile", key="speed", remedy=remedy)
        if not np.all(np.isfinite(t)) or t[0] != 0 or np.any(np.diff(t) <= 0):
            raise InputError("must rise from 0", element="SpeedProfile", key="time", value=t.tolist(), remedy=remedy)
        if not np.all(np.isfinite(w)) or np.any(w <= 0):
            raise InputError("must be positive", element="SpeedProfile", key="speed", value=w.tolist(), remedy=remedy)
        object.__setattr__(self, "time", tuple(map(float, t)))
        object.__setattr__(self, "speed", tuple(map(float, w)))

    def courses(self, duration: float) -> tuple[tuple[float, SpeedRamp], ...]:
        """The pieces up to ``duration`` as (end, course), each with the input's angle where it begins."""
        pieces, angle = [], 0.0
        ends = (*self.time[1:], np.inf)
        for i, (start, end) in enumerate(zip(self.time, ends, strict=True)):
            if start >= duration:
                break
            last = i + 1 == len(self.time)
            slope = 0.0 if last else (self.speed[i + 1] - self.speed[i]) / (end - start)
            pieces.append((min(end, duration), SpeedRamp(self.speed[i], slope, start, angle)))
            if not last:
                angle += (self.speed[i] + self.speed[i + 1]) / 2 * (end - start)
        return tuple(pieces)

    def at(self, time: ArrayLike) -> Array:
        """Speed [rad/s] at any time."""
        return np.asarray(np.interp(np.asarray(time, dtype=float), self.time, self.speed))

    def angle(self, time: ArrayLike) -> Array:
        """Angle of the input [rad] since t = 0."""
        t = np.asarray(time, dtype=float)
        out = np.zeros(t.shape)
        for end, course in self.courses(float(np.max(t, initial=0.0)) + 1.0):
            inside = (t >= course.since) & (t <= end)
            since = t[inside] - course.since
            out[inside] = course.angle + (course.speed + course.acceleration * since / 2) * since
        return out

    def times_at(self, angles: Array, end: float) -> Array:
        """Times [s] until ``end`` at which the input stands at ``angles`` [rad] (rising); NaN behind it."""
        out = np.full(len(angles), np.nan)
        for until, course in self.courses(end):
            turned = angles - course.angle
            length = until - course.since
            last = (course.speed + course.acceleration * length / 2) * length
            inside = (turned >= -1e-12) & (turned <= last * (1 + 1e-12))
            # The root of ½at² + wt = θ that stays finite as a → 0.
            root = np.sqrt(np.maximum(course.speed**2 + 2 * course.acceleration * turned[inside], 0.0))
            out[inside] = np.clip(course.since + 2 * turned[inside] / (course.speed + root), course.since, until)
        return out
