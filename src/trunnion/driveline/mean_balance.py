"""The mean speeds at which a free–free line turns by itself: where the torques of its disks and machines balance.

A load M on a shaft that turns R times as fast as the input asks for |R| M there; what gears lose of its power on the
way is a load of theirs. Where a
disk or a motor has a ``drive_share`` its controller keeps any speed, and no balance tells one.
"""

from __future__ import annotations

import warnings

from trunnion.driveline.chain import ElementChain
from trunnion.driveline.converter_balance import converter_balances, open_converter
from trunnion.driveline.elements import ConstantSpeed
from trunnion.driveline.loss_curves import with_losses
from trunnion.driveline.quantities import DAMPING, SPEED, shown
from trunnion.driveline.speed_ratios import speed_ratios
from trunnion.errors import InputError, InputRemark
from trunnion.laws.balance import TorqueBalance, balances
from trunnion.laws.torque_curve import TorqueCurve

LOWEST, HIGHEST = 0.01, 1e5
"""Input speeds [rad/s] between which balances are looked for."""
AS_PRINTED, SAME = 1e-4, 1e-9
"""Relative differences of a speed from a balance: up to which it is that balance, rounded in print, and up to which
that is not worth a remark."""


def is_left_free(line: ElementChain) -> bool:
    """Whether nothing prescribes or controls the speed of a line."""
    rigid = any(isinstance(element, ConstantSpeed) for element in line.elements)
    return not rigid and not any(getattr(element, "drive_share", 0.0) for element in line.elements)


def geared_curves(line: ElementChain) -> list[tuple[float, TorqueCurve]]:
    """What resists, disks, machines and what gears lose, with the speed ratio of its shaft."""
    ratios = speed_ratios(line)
    every = with_losses(line, range(len(line.elements)))
    return [(abs(float(ratios[i])), curve) for i, curve in every if ratios[i]]


def mean_speeds(line: ElementChain) -> tuple[TorqueBalance, ...]:
    """All input speeds at which the torques of a free–free line balance, rising, each stable or not.

    Torques are those of disks and machines alone, without what a ``drive_share`` adds.

    Parameters
    ----------
    line : the driveline.

    Returns
    -------
    For every balance its ``speed`` [rad/s], its ``slope`` [N m s/rad], by which what resists at the input rises there,
    and whether it is ``stable``.

    Examples
    --------
    >>> import trunnion as tn
    >>> motor = tn.Motor(inertia=0.4, breakdown_torque=500.0, breakdown_slip=0.2, synchronous_speed="1500 rpm")
    >>> mill = tn.Disk(inertia=3.0, load_torque="300 N*m")
    >>> for one in tn.mean_speeds(tn.Driveline([motor, tn.Shaft(stiffness=2e4), mill])):
    ...     print(f"{one.speed * 30 / 3.14159265:.1f} rpm", "stable" if one.stable else "unstable")
    600.0 rpm unstable
    1400.0 rpm stable
    """
    place = open_converter(line)
    if place is not None:
        return converter_balances(line, place, LOWEST, HIGHEST)
    return balances(geared_curves(line), LOWEST, HIGHEST)


def at_balance(line: ElementChain, speed: float) -> float:
    """The balance [rad/s] that an input speed means: one that agrees with it to the figures printed, else the speed.

    Says so by an ``InputRemark``.
    """
    meant = min((one.speed for one in mean_speeds(line)), key=lambda one: abs(one - speed), default=speed)
    away = abs(meant - speed)
    if away > AS_PRINTED * speed:
        return speed
    if away > SAME * speed:
        remark = InputError(
            f"agrees to the figures printed with {shown(meant, SPEED, 'rpm', 10)}, where the torques of the line "
            "balance, and the line is taken to run there",
            element="operation", key="speed", value=shown(speed, SPEED, "rpm", 10),
            remedy="leave it out and the line runs there by itself",
        )  # fmt: skip
        warnings.warn(InputRemark(str(remark)), stacklevel=3)
    return meant


def own_speed(line: ElementChain) -> float:
    """The input speed [rad/s] at which a line that is left free settles.

    Raises
    ------
    InputError : no balance, none that is stable, or several.
    """
    found = mean_speeds(line)
    stable = [one.speed for one in found if one.stable]
    if len(stable) == 1:
        return stable[0]
    if len(stable) > 1:
        names = ", ".join(map(_rpm, stable))
        raise InputError(
            f"balances the torques of the line at {names}, each stable", element="operation", key="speed",
            remedy=f'choose one: pass speed={stable[-1]!r} (rad/s), say',
        )  # fmt: skip
    if not found:
        raise InputError(
            "is not given, and the torques of the line balance at no speed", element="operation", key="speed",
            remedy="give what drives drive_share = 1, or check the signs: a load resists where positive",
        )  # fmt: skip
    one = found[-1]
    raise InputError(
        f"is not given, and the line lasts at no speed: at {_rpm(one.speed)} its torques balance, but their slope, "
        f"{shown(one.slope, DAMPING, digits=4)} at the input, drives it away", element="operation", key="speed",
        remedy="take a drive whose torque falls with the speed more steeply than the load's, or drive_share = 1",
    )  # fmt: skip


def balances_in_words(line: ElementChain) -> str:
    """ "1432.1 rpm (stable) and 310 rpm (unstable)"; empty where there are none."""
    found = [f"{_rpm(one.speed)} ({'stable' if one.stable else 'unstable'})" for one in reversed(mean_speeds(line))]
    return " and ".join(found)


def _rpm(speed: float) -> str:
    return shown(speed, SPEED, "rpm", 7)
