"""Speeds and angles that the pictures of a line cover where nobody says which."""

from __future__ import annotations

from contextlib import suppress

import numpy as np

from trunnion.driveline.driveline import Driveline, hooke_joints
from trunnion.driveline.operating_speed import operating_speed, runs_by_itself
from trunnion.driveline.operation import Operation
from trunnion.errors import InputError
from trunnion.modes.natural_frequencies import natural_frequencies

MODES_IN_RANGE = 4
"""Modes that a speed range guessed from the line itself reaches up to."""


def speed_range(line: Driveline) -> tuple[float, float]:
    """The range of the description [rad/s]; else the one speed at which a motor and its loads settle; else about the
    operating speed; else about the lowest modes."""
    operation = line.operation or Operation()
    if operation.speed_range:
        return operation.speed_range
    with suppress(InputError):  # one that settles nowhere is refused by what asks for its motion
        if runs_by_itself(line):
            own = operating_speed(line, None)
            return own, own
    if operation.speed:
        return 0.25 * operation.speed, 2.0 * operation.speed
    elastic = natural_frequencies(line).elastic
    if not len(elastic):
        return 1.0, 100.0
    low, high = 0.3 * float(elastic[0]), 1.25 * float(elastic[:MODES_IN_RANGE].max())
    return float(f"{low:.2g}"), float(f"{high:.2g}")


def diagram_range(low: float, high: float) -> tuple[float, float]:
    """Between which speeds [rad/s] modes over speed are drawn of a line that runs from ``low`` to ``high``: of one that
    runs at one speed from half of it to a fifth beyond."""
    return (low, high) if high > low else (0.5 * high, 1.2 * high)


def angle_range(line: Driveline) -> tuple[float, float]:
    """The range of the description [rad]; else from straight to 30° or half again the largest joint angle."""
    if line.operation and line.operation.angle_range:
        return line.operation.angle_range
    largest = max((abs(angle) for _, angle in hooke_joints(line)), default=0.0)
    return 0.0, float(np.deg2rad(min(85.0, max(30.0, 1.5 * np.rad2deg(largest)))))
