"""The speed that a run-up asks for over time.

The acceleration sets in smoothly, as ½A(1 − cos πt/T) over a ramp of T seconds: set in at once it would twist the line
by twice its inertia torque and leave the slowest mode ringing. Over three of its periods that ringing is at most 1/35
of the inertia torque, cos(ωT/2)/((ωT/π)² − 1) without damping.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.driveline.arguments import one_number
from trunnion.equations.coefficients import Assembly
from trunnion.equations.speed_profile import SpeedProfile
from trunnion.errors import InputError
from trunnion.modes.natural_frequencies import natural_frequencies

RAMP_PERIODS = 3.0
"""Of the slowest mode, over which the acceleration sets in."""
RAMP_PIECES = 48
"""Straight pieces of the speed over the ramp; each changes the acceleration by 1/15 of its end value at most."""
MOST_TURNS = 20_000
"""Turns of one run, about a minute of computing."""


@dataclass(frozen=True)
class SpeedSchedule:
    """From ``first`` to ``last`` [rad/s] at an ``acceleration`` (magnitude, [rad/s²]) that sets in over ``ramp``
    [s]."""

    first: float
    last: float
    acceleration: float
    ramp: float

    @property
    def sense(self) -> float:
        """+1 upwards, −1 downwards."""
        return 1.0 if self.last > self.first else -1.0

    @property
    def range(self) -> float:
        """Distance of the two speeds [rad/s]."""
        return abs(self.last - self.first)

    @property
    def duration(self) -> float:
        """Until the last speed is asked for [s]."""
        return self.range / self.acceleration + self.ramp / 2

    @cached_property
    def profile(self) -> SpeedProfile:
        """The speed over time in straight pieces."""
        t = self.ramp * np.arange(RAMP_PIECES + 1) / RAMP_PIECES if self.ramp > 0 else np.zeros(1)
        gained = np.zeros(1)
        if self.ramp > 0:
            gained = self.acceleration * (t / 2 - self.ramp / (2 * np.pi) * np.sin(np.pi * t / self.ramp))
        return SpeedProfile([*t, self.duration], [*(self.first + self.sense * gained), self.last])

    def continued(self, time: ArrayLike) -> Array:
        """The speed [rad/s] that would be asked for if the acceleration went on behind the last one."""
        t = np.asarray(time, dtype=float)
        return np.asarray(self.profile.at(t) + self.sense * self.acceleration * np.maximum(t - self.duration, 0.0))

    def rate(self, time: ArrayLike) -> Array:
        """The acceleration [rad/s²] asked for, signed, without the corners of the pieces; 0 behind the last speed."""
        t = np.asarray(time, dtype=float)
        rise = np.where(t < self.ramp, (1 - np.cos(np.pi * t / self.ramp)) / 2, 1.0) if self.ramp > 0 else 1.0
        return np.asarray(np.where(t <= self.duration, self.sense * self.acceleration * rise, 0.0))


def schedule(assembly: Assembly, first: float, last: float, acceleration: float, ramp: float | None) -> SpeedSchedule:
    """The schedule asked for; without a ``ramp`` over three periods of the slowest mode, but at most until half of the
    range is passed.

    Raises
    ------
    InputError : speeds or acceleration not positive; a negative ramp, or one too long for the speeds; too many turns.
    """
    check(first, last, acceleration)
    longest = abs(last - first) / acceleration
    if ramp is None:
        slow = [w for w in natural_frequencies(assembly).undamped_frequency if w > 0]
        ramp = min(RAMP_PERIODS * 2 * np.pi / float(min(slow)), longest) if slow else 0.0
    elif not 0 <= one_number(ramp, "ramp", "2.0 seconds, say") < 2 * longest:
        raise InputError(
            "does not fit in the run", element="run_up", key="ramp", value=float(ramp),
            remedy=f"give 0 to {2 * longest:.4g} s, or leave it out",
        )  # fmt: skip
    return SpeedSchedule(float(first), float(last), float(acceleration), float(ramp))


def check(first: float, last: float, acceleration: float) -> None:
    """Refuse speeds and an acceleration that make no run.

    Raises
    ------
    InputError : so.
    """
    for key, value in (("first", first), ("last", last), ("acceleration", acceleration)):
        if not 0 < one_number(value, key, "tn.rpm(500), say") < np.inf:
            raise InputError(
                "must be positive", element="run_up", key=key, value=float(value), remedy="tn.rpm(500), say"
            )
    if first == last:
        raise InputError("is also the last speed", element="run_up", key="first", value=float(first))
    duration = abs(last - first) / acceleration
    if (first + last) / 2 * duration > 2 * np.pi * MOST_TURNS:
        raise InputError(
            f"makes a run of more than {MOST_TURNS} turns",
            element="run_up", key="acceleration", value=float(acceleration),
            remedy="accelerate faster, or ask periodic_response for the steady motion",
        )  # fmt: skip
