"""The speed a line runs at, and the unit its description prints speeds in."""

from __future__ import annotations

import math

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.arguments import quantity
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.machines import Motor
from trunnion.driveline.mean_balance import at_balance, is_left_free, own_speed
from trunnion.driveline.quantities import SPEED, parse
from trunnion.errors import InputError


def speed_unit(line: Driveline) -> str:
    """The unit the description prints speeds in; rad/s where it has no operation (nondimensional lines)."""
    return line.operation.speed_unit if line.operation else "rad/s"


def runs_by_itself(line: Driveline) -> bool:
    """Whether a motor drives the line that nothing prescribes or controls, so that it finds its own speed."""
    return is_left_free(line) and any(isinstance(element, Motor) for element in line.elements)


def known_speed(line: Driveline) -> float | None:
    """The operating speed that the description states [rad/s], or that at which a motor and its loads settle; None of
    other lines. A stated speed that agrees to the figures printed with a balance of a motor and its loads is that one.

    Raises
    ------
    InputError : a motor and its loads settle nowhere, or at several speeds.
    """
    stated = line.operation.speed if line.operation else None
    if not runs_by_itself(line):
        return stated
    return own_speed(line) if stated is None else at_balance(line, stated)


def settled_speeds(line: Driveline, speeds: Array) -> Array:
    """Input speeds [rad/s], each that agrees to the figures printed with a balance of a motor and its loads moved
    there."""
    if not runs_by_itself(line):
        return speeds
    return np.array([at_balance(line, float(one)) for one in speeds])


def stated_range(line: Driveline) -> tuple[float, float] | None:
    """Lowest and highest speed that the description states [rad/s], its operating speed alone where it states no range;
    None where it states neither, and no motor finds its own."""
    if line.operation and line.operation.speed_range:
        return line.operation.speed_range
    speed = known_speed(line)
    return None if speed is None else (speed, speed)


def operating_speed(line: Driveline, speed: float | str | None) -> float:
    """``speed``, a number or a text with its unit, or the operating speed the description gives [rad/s]; without one
    that at which a motor and its loads settle. One that agrees to the figures printed with such a balance is that."""
    if isinstance(speed, str):
        speed = quantity(speed, SPEED, "speed")
    if speed is None:
        speed = known_speed(line)
    if speed is None:
        raise InputError(
            "is not given",
            element="operation",
            key="speed",
            remedy='write speed = "1500 rpm", or pass a speed',
        )
    if isinstance(speed, bool) or not isinstance(speed, int | float | np.number):
        raise InputError(
            "must be a number in rad/s", key="speed", value=speed, remedy='write tn.rpm(1500) or "1500 rpm"'
        )
    if not speed > 0 or math.isinf(read := _float(speed)):
        raise InputError("must be positive and finite", key="speed", value=speed, remedy="tn.rpm(1500), say")
    try:
        read = parse(read, SPEED)
    except InputError as error:
        raise error.but(key="speed", value=read) from None
    return at_balance(line, read) if runs_by_itself(line) else read


def _float(number: float) -> float:
    try:
        return float(number)
    except OverflowError:  # an integer of more than 308 digits
        return math.inf
