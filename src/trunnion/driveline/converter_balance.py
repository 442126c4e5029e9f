"""At which ratio of speeds the torque converter of a line runs: where its turbine carries what it drives."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.chain import ElementChain
from trunnion.driveline.elements import ConstantSpeed
from trunnion.driveline.loss_curves import behind, with_losses
from trunnion.driveline.quantities import SPEED, TORQUE, shown
from trunnion.driveline.speed_ratios import speed_ratios
from trunnion.driveline.torque_converters import TorqueConverter
from trunnion.errors import InputError
from trunnion.laws.balance import TorqueBalance
from trunnion.laws.converter import STANDING, ConverterRun, balances, pump_slope
from trunnion.laws.torque_curve import TorqueCurve

if TYPE_CHECKING:
    from trunnion.driveline.driveline import Driveline

STANDS = 1e-3
"""Share of the highest speed ratio below which a turbine counts as standing."""
LOCK = "write locked = true, which is the converter with its lock-up clutch closed"
AT_EVERY_SPEED = "turns its turbine by a ratio that follows from the loads at each speed, which {} not follow"


def open_converter(line: ElementChain) -> int | None:
    """Place of the torque converter of a line that is not locked; None without one.

    Raises
    ------
    InputError : several of them.
    """
    places = [i for i, one in enumerate(line.elements) if isinstance(one, TorqueConverter) and not one.locked]
    if len(places) > 1:
        raise InputError(
            "are several torque converters, and one is followed", element=", ".join(line.names[i] for i in places),
            remedy="write locked = true for those that their lock-up clutch closes",
        )  # fmt: skip
    return places[0] if places else None


def refuse_converters(line: ElementChain, what: str, remedy: str = LOCK) -> None:
    """Refuse a line with a torque converter that is not locked, for analyses ("branches do") that follow none.

    Raises
    ------
    InputError : names it.
    """
    place = open_converter(line)
    if place is not None:
        raise InputError(AT_EVERY_SPEED.format(what), element=line.names[place], key="locked", remedy=remedy)


def behind_converter(line: ElementChain, place: int) -> list[tuple[float, TorqueCurve]]:
    """What the turbine drives, disks, machines and what gears lose: the speed of each shaft over the turbine's, and the
    torque that resists.

    Raises
    ------
    InputError : a prescribed speed or a drive_share behind the turbine; gears in front of it that lose a share of the
        power that it takes.
    """
    ratios, driven = speed_ratios(line), sorted(behind(line, place))
    for i, element in enumerate(line.elements):
        if element.losses and place in behind(line, i):
            key = element.losses[0].key
            raise InputError(
                f"loses a share of what {line.names[place]} behind it takes, which is not followed",
                element=line.names[i], key=key, value=getattr(element, key),
                remedy=f"write its loss as drag_torque, or {LOCK.removeprefix('write ')}",
            )  # fmt: skip
    for i in driven:
        element, name = line.elements[i], line.names[i]
        if isinstance(element, ConstantSpeed) or getattr(element, "drive_share", False):
            key = "" if isinstance(element, ConstantSpeed) else "drive_share"
            raise InputError(
                f"holds a speed behind {line.names[place]}, whose turbine turns as fast as its loads let it",
                element=name, key=key, remedy=f"give it a torque, or {LOCK.removeprefix('write ')}",
            )  # fmt: skip
    return [(abs(float(ratios[i] / ratios[place])), curve) for i, curve in with_losses(line, driven)]


_KNOWN: deque[tuple[ElementChain, list[tuple[float, TorqueCurve]]]] = deque(maxlen=32)
"""Lines asked of last, with what their turbines drive: at each of many speeds it is the same."""


def _loads(line: ElementChain, place: int) -> list[tuple[float, TorqueCurve]]:
    """``behind_converter`` of a line, made once: its curves keep where they turn round."""
    for known, loads in tuple(_KNOWN):
        if known is line:
            return loads
    loads = behind_converter(line, place)
    _KNOWN.append((line, loads))
    return loads


def run_of(line: ElementChain, place: int, speed: float) -> ConverterRun:
    """How the converter at a place runs at an input speed [rad/s].

    Raises
    ------
    InputError : no balance of the turbine with its loads, or several that last; a turbine that stands.
    """
    converter, name = line.elements[place], line.names[place]
    assert isinstance(converter, TorqueConverter)
    loads = _loads(line, place)
    pump = speed * abs(float(speed_ratios(line)[place]))
    at = shown(speed, SPEED, "rpm", 5)
    if not pump > 0:
        raise InputError("needs a speed of its pump", element=name, key="curves", remedy="ask at a positive speed")
    found = [ratio for ratio, lasts in balances(converter.law, loads, pump) if lasts]
    if not found:
        raise _unbalanced(converter, name, loads, pump, at)
    if len(found) > 1:
        listed = " and ".join(f"{one:.5g}" for one in found)
        raise InputError(
            f"balances its turbine's loads at several speed ratios, {listed} at {at} of the input, each stable",
            element=name, key="curves", remedy="check what loads it; tn.transient shows which it comes to",
        )  # fmt: skip
    return converter.law.at(found[0], pump)


def _unbalanced(
    converter: TorqueConverter, name: str, loads: list[tuple[float, TorqueCurve]], pump: float, at: str
) -> InputError:
    """What refuses a speed at which the turbine comes to none."""
    first, last = converter.curves[0].speed_ratio, converter.curves[-1].speed_ratio
    stall = converter.law.at(first, pump).turbine_torque
    resists = sum(ratio * float(load.value(ratio * first * pump)) for ratio, load in loads)
    if resists >= stall:
        return InputError(
            f"stalls at {at} of the input: its turbine would have to carry {shown(resists, TORQUE, digits=5)}, and "
            f"gives {shown(stall, TORQUE, digits=5)} where it stands", element=name, key="curves",
            remedy="lower the load, or ask at a higher speed; tn.transient follows a start",
        )  # fmt: skip
    return InputError(
        f"ends at a speed ratio of {last:g}, where its turbine still gives more than its loads take at {at} of the "
        "input", element=name, key="curves", remedy="add points up to a speed ratio of 1, where its capacity is 0",
    )  # fmt: skip


def input_speed(line: ElementChain, place: int) -> float:
    """The input speed [rad/s] at which the converter at a place runs as it does."""
    converter = line.elements[place]
    assert isinstance(converter, TorqueConverter)
    pump = 0.0 if converter.run is None else converter.run.pump_speed
    return pump / abs(float(speed_ratios(line)[place]))


def running_line(line: Driveline, speed: float) -> Driveline:
    """The line with its converter as it runs at an input speed [rad/s]; at 0 as it stands. Itself without one, or where
    it has it so.

    Raises
    ------
    InputError : as of ``run_of``.
    """
    place = open_converter(line)
    converter = None if place is None else line.elements[place]
    if place is None or not isinstance(converter, TorqueConverter) or converter.run is not None:
        return line
    run = STANDING if not speed else run_of(line, place, speed)
    if speed and run.ratio < STANDS * converter.curves[-1].speed_ratio:
        raise InputError(
            f"has its turbine all but stand, at a speed ratio of {run.ratio:.3g}, so that nothing turns behind it",
            element=line.names[place], key="curves", remedy="lower the load, or ask at a higher speed",
        )  # fmt: skip
    elements = (*line.elements[:place], converter.running(run), *line.elements[place + 1 :])
    return line.model_copy(update={"elements": elements})


SCANNED = 400
"""Input speeds of a free–free line with a converter, by equal ratios, between which balances are looked for, beside the
knots of its curves."""


def converter_balances(line: ElementChain, place: int, low: float, high: float) -> tuple[TorqueBalance, ...]:
    """Input speeds between two [rad/s] at which the torques of a free–free line balance on both sides of its converter,
    rising.

    Raises
    ------
    InputError : as of ``behind_converter``.
    """
    converter, ratios = line.elements[place], speed_ratios(line)
    assert isinstance(converter, TorqueConverter)
    law, own = converter.law, abs(float(ratios[place]))
    loads = _loads(line, place)
    before = set(range(len(line.elements))) - behind(line, place)
    others = [(abs(float(ratios[i])), curve) for i, curve in with_losses(line, sorted(before))]

    @cache
    def run_at(speed: float) -> ConverterRun | None:
        lasting = [ratio for ratio, lasts in balances(law, loads, own * speed) if lasts]
        return law.at(lasting[-1], own * speed) if lasting else None

    def left(speed: float) -> float:
        """What resists at the input [N m]; NaN where the turbine comes to no steady speed."""
        run = run_at(speed)
        if run is None:
            return float("nan")
        return own * run.pump_torque + sum(ratio * float(load.value(ratio * speed)) for ratio, load in others)

    def slope(speed: float) -> float:
        """By the speed of the input [N m s/rad]; NaN likewise."""
        run = run_at(speed)
        if run is None:
            return float("nan")
        own_part = own**2 * pump_slope(law, loads, run)
        return own_part + sum(ratio**2 * float(load.slope(ratio * speed)) for ratio, load in others)

    highest = min([high, *(load.range[1] / ratio for ratio, load in others if ratio)])
    knots = [knot / ratio for ratio, load in others if ratio for knot in load.knots]
    at = np.union1d(np.geomspace(low, highest, SCANNED), [one for one in knots if low < one < highest])
    return tuple(TorqueBalance(speed, slope(speed)) for speed in _crossings(at, left, slope))


def _crossings(at: Array, left: Callable[[float], float], slope: Callable[[float], float]) -> Iterator[float]:
    """Zeros of a function between some places (place,): where it changes its sign from one to the next, and where it
    turns round between them, beyond zero and back."""
    value, rise = (np.array([one(float(place)) for place in at]) for one in (left, slope))
    for i in range(len(at) - 1):
        ends = [float(at[i]), float(at[i + 1])]
        if value[i] * value[i + 1] > 0 and value[i] * rise[i] < 0 < value[i + 1] * rise[i + 1]:
            top = _zero(slope, *ends)
            if left(top) * value[i] < 0:
                yield from (_zero(left, ends[0], top), _zero(left, top, ends[1]))
        elif value[i] * value[i + 1] < 0 or value[i + 1] == 0:
            yield _zero(left, *ends)


def _zero(of: Callable[[float], float], low: float, high: float) -> float:
    """Between two places where a function has unlike signs."""
    from scipy.optimize import brentq  # which takes longer to import than most lines to judge

    return float(brentq(of, low, high, xtol=1e-13 * low, rtol=4 * np.finfo(float).eps))
