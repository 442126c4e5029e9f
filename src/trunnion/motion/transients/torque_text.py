"""Torques over the speed as formulas, for what goes by them."""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.applied_torque import AppliedTorque, TorqueFunction
from trunnion.driveline.excitation import Excitation
from trunnion.laws.monotone_cubic import monotone_cubic


def torque_text(one: AppliedTorque) -> str | None:
    """A torque as a formula; None of one that has none: a table over time, angle or two variables, a function, a
    formula that acts for a time."""
    if isinstance(one, TorqueFunction) or one.table or one.since is not None or one.until is not None:
        return None
    if one.formula is not None:
        return one.formula
    if one.is_motor:
        return None if one.factor else _kloss(one)
    if one.power is not None:
        low, high = one.speed
        return f"({one.power!r})/min(max(speed, {low!r}), {high!r})"
    if one.variables != ("speed",):
        return None
    speeds, torques = np.array(one.speed), np.array(one.torque)
    if one.between == "cubic":
        return _cubic(speeds, torques)
    inside = f"min(max(speed, {float(speeds[0])!r}), {float(speeds[-1])!r})" if one.hold else "speed"
    return lines(speeds, torques, inside)


def _kloss(one: AppliedTorque) -> str:
    assert one.breakdown_torque is not None and one.breakdown_slip is not None and one.synchronous_speed is not None
    slip = f"(1 - speed/{float(one.synchronous_speed)!r})"
    top = 2 * float(one.breakdown_torque) * float(one.breakdown_slip)
    return f"{top!r}*{slip}/({slip}^2 + {float(one.breakdown_slip) ** 2!r})"


def lines(points: Array, values: Array, variable: str = "speed") -> str:
    """Straight lines of a variable through points."""
    slopes = np.diff(values) / np.diff(points)
    terms = [repr(float(values[0])), f"({float(slopes[0])!r})*({variable} - ({float(points[0])!r}))"]
    for point, change in zip(points[1:-1], np.diff(slopes), strict=True):
        if change:
            terms.append(f"({float(change)!r})*max({variable} - ({float(point)!r}), 0)")
    return " + ".join(terms)


def _cubic(points: Array, values: Array) -> str:
    """The monotone cubic through points, from its first one on; below, its first value."""
    pieces = monotone_cubic(points, values).c[::-1]
    u = f"max(speed - ({float(points[0])!r}), 0)"
    a, b, c, d = (float(one) for one in pieces[:, 0])
    said = [f"({a!r}) + {u}*(({b!r}) + {u}*(({c!r}) + ({d!r})*{u}))"]
    for k in range(1, len(points) - 1):
        # What a piece adds to the one before it goes with the square of the way behind their common point.
        v, before, behind = f"(speed - ({float(points[k])!r}))", pieces[:, k - 1], pieces[:, k]
        square = float(behind[2] - before[2] - 3 * before[3] * (points[k] - points[k - 1]))
        cube = float(behind[3] - before[3])
        said.append(f"max({v}, 0)^2*(({square!r}) + ({cube!r})*{v})")
    return " + ".join(said)


def phase_text(law: Excitation, phase: float) -> str:
    """The angle of a harmonic at each instant."""
    return f"({float(law.order or 0)!r})*angle + ({float(law.frequency or 0)!r})*time + ({phase!r})"
