"""A turn of a transmission: curves over the input angle, polar curves, S2's four panels, uniformity, forks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.operating_speed import speed_unit
from trunnion.pictures.looks import STYLES, curve
from trunnion.pictures.picture import UNBROKEN, Axis, Item, Level, Line, Panel, Picture, Texts, single
from trunnion.response.kinetostatics.result import Kinetostatics
from trunnion.results.speeds import speed_factor
from trunnion.results.words import Words

SAME = 1e-9
"""Curves closer than this share of their size count as one; a curve that varies less is level."""
SPACING = 2.6
"""Distance of the joints whose forks are drawn; a fork's arm is 1 long."""
TOGETHER = 3
"""Names that stand side by side for one curve."""


def kinetostatics(result: Kinetostatics, *, unit: str | None = None) -> Picture:
    """Speeds and accelerations over the input angle; torques and secondary couples below, where there are any."""
    names, ratio, acceleration, torque = _shafts(result)
    percent = 100 * (ratio - 1)
    factor, torque_unit = _scale(torque, "N m")
    alike = _alike(names, np.stack([percent, acceleration, torque], axis=1))
    geared = bool(np.any(np.abs(result.shaft_ratio) != 1))
    panels = [
        _panel(result, _curves(result, alike, percent), "speed about its mean", "%"),
        _panel(result, _curves(result, alike, acceleration), "angular acceleration", "rad/s²"),
    ]
    panels[0] = replace(panels[0], key="left", key_title=_key_title("shafts", alike))
    if not (np.any(torque) or np.any(result.secondary_couple)):  # which the headline says: nothing to be drawn
        return Picture(panels, 8.6, 4.2, 2, _title(result, unit), shared=True)
    referring = "torque referred to the drive" if geared else "torque passed on"
    couple, couples = _couples(result)
    size = _panel(result, couples, couple.words, couple.unit)
    top = size.y.high if size.y.low is not None else None
    panels += [
        _panel(result, _curves(result, alike, torque / factor), referring, torque_unit),
        replace(size, y=replace(size.y, low=0.0, high=top), key="right", key_title=_key_title("forks", couples)),
    ]
    return Picture(panels, 8.6, 7.2, 2, _title(result, unit), shared=True)


def polar(result: Kinetostatics, *, unit: str | None = None) -> Picture:
    """Speeds, secondary couples and, where there are any, support forces around the turn."""
    names, ratio, _, _ = _shafts(result)
    parts = [(Axis("speed over its mean"), _curves(result, _alike(names, ratio[:, None]), ratio))]
    if np.any(result.secondary_couple):
        parts.append(_couples(result))
    if result.supports is not None:
        parts.append(_of_vectors(result, result.supports.names, result.supports.force, "force on bearing", "N"))
    panels = [_around(result, axis, curves) for axis, curves in parts]
    return Picture(panels, 3.9 * len(panels), 5.2, len(panels), _title(result, unit))


def paper(result: Kinetostatics) -> Picture:
    """S2's Figures 3 and 4: angular differences, speeds, accelerations and torques of two joints."""
    alike = _alike(result.shafts, np.stack([result.speed, result.acceleration, result.torque], axis=1))
    unit = speed_unit(result.line)
    total = np.degrees(result.output_angle - result.mean_ratio * result.input_angle)
    twist = 1e6 * result.twist[1]
    first = _panel(result, [_over_turn(result, total, curve(3), "output")], "output − input angle", "°")
    # The twist of the shaft between the joints, thousands of times smaller, on a scale of its own.
    ends = (None, None) if np.any(twist) else (-1.0, 1.0)
    panels = [
        replace(
            first, right=Axis("twist", "µrad", *ends),
            right_items=[_over_turn(result, twist, curve(1), "twist")],
        ),
        _panel(result, _curves(result, alike, result.speed * speed_factor(unit)), "angular speed", unit),
        _panel(result, _curves(result, alike, result.acceleration), "angular acceleration", "rad/s²"),
        _panel(result, _curves(result, alike, result.transmitted), "torque passed on", "N m"),
    ]  # fmt: skip
    panels[1] = replace(panels[1], key="centre", key_title="b, c, d")
    panels = [replace(panel, title=letter) for letter, panel in zip("abcd", panels, strict=True)]
    kind = "rigid" if result.rigid else "elastic"
    return Picture(panels, 8.6, 7.0, 2, f"{result.line.name or 'transmission'}, taken as {kind}", shared=True)


def irregularity(result: Kinetostatics) -> Picture:
    """Speed about its own mean [%] of each shaft; shafts that turn alike share a curve."""
    percent = 100 * (result.speed / (result.input_speed * result.shaft_ratio)[:, None] - 1)
    turn = np.degrees(result.input_angle)
    items: list[Item] = [
        Line(turn, percent[row], curve(i), _joined(names))
        for i, (names, row) in enumerate(groups(result.shafts, percent, 100 * SAME))
    ]
    across = _turn(result, 45 if result.turns == 1 else 90)
    up = Axis("speed about its mean", "%")
    return single(across, up, [*items, Level(0.0, "zero")], height=3.4, grid="")


def forks(result: Kinetostatics, *, turn: float = 0.0) -> Picture:
    """The forks of every Hooke's joint seen along the line, the joint plane upright, at an input angle [°]."""
    at = int(np.abs(np.degrees(result.input_angle) - turn).argmin())
    items: list[Item] = []
    around = np.linspace(0, 2 * np.pi, 73)
    for k, name in enumerate(result.joints):
        items.append(Line(SPACING * k + np.cos(around), np.sin(around), "ring"))
        for quarter, role in ((0.0, "input arm"), (np.pi / 2, "output arm")):
            angle = result.joint_angle[k, at] + quarter  # an arm in the joint plane (angle 0) stands upright
            ends = np.array([-1.0, 1.0])
            known = role.removesuffix(" arm")
            items.append(Line(SPACING * k + ends * np.sin(angle), ends * np.cos(angle), role, "" if k else known, name))
        items.append(Texts([SPACING * k], [-1.15], [name], beside="below"))
    across = Axis(low=-1.5, high=SPACING * max(len(result.joints) - 1, 0) + 1.5)
    title = f"forks at input angle {turn:g}°, joint planes upright"
    return single(across, Axis(low=-1.9, high=1.3), items, 7.2, 3.0, title, frame=False, even=True)


def _title(result: Kinetostatics, unit: str | None) -> str:
    unit = unit or speed_unit(result.line)
    name = f"{result.line.name}: " if result.line.name else ""
    kind = "rigid shafts" if result.rigid else "elastic shafts"
    inertia = ", with inertia torques" if result.inertia else ""
    speed = f"input {Words(unit).speed(result.input_speed)}".replace(" ", UNBROKEN)
    return f"{name}{kind}{inertia}, {speed}"


def _shafts(result: Kinetostatics) -> tuple[tuple[str, ...], Array, Array, Array]:
    """Names, speed over mean, acceleration, torque referred to the drive; the output where no Shaft is.

    Referred to the drive, torques behind a ratio share the scale of those in front of it.
    """
    if not result.shafts:
        speed = result.output_speed[None] / (result.input_speed * result.mean_ratio)
        return ("output",), speed, result.output_acceleration[None], result.drive_torque[None]
    ratio = result.shaft_ratio[:, None]
    speed = result.speed / (result.input_speed * ratio)
    return result.shafts, speed, result.acceleration, result.transmitted * ratio


def _couples(result: Kinetostatics) -> tuple[Axis, list[Line]]:
    return _of_vectors(result, result.forks, result.secondary_couple, "secondary couple on fork", "N m")


def _of_vectors(
    result: Kinetostatics, names: Sequence[str], vectors: Array, words: str, unit: str
) -> tuple[Axis, list[Line]]:
    """Sizes of vectors (name, 2, point): their axis, and their curves."""
    size = np.hypot(vectors[:, 0], vectors[:, 1])
    factor, shown = _scale(size, unit)
    return Axis(words, shown), _curves(result, _alike(names, size[:, None]), size / factor)


def _alike(names: Sequence[str], values: Array) -> list[tuple[str, int]]:
    """Names and rows of the curves (name, quantity, point) that differ; alike in every quantity is one."""
    size = np.max(np.abs(values), axis=(0, 2), initial=0.0)[:, None]
    return [(_joined(together), row) for together, row in groups(names, values, SAME * size)]


def groups(names: Sequence[str], values: Array, within: float | Array) -> list[tuple[list[str], int]]:
    """Names that share a curve, and the row of its values (name, …): none of them further apart than ``within``."""
    found: list[tuple[list[str], int]] = []
    for row, name in enumerate(names):
        for together, first in found:
            if np.all(np.abs(values[row] - values[first]) <= within):
                together.append(name)
                break
        else:
            found.append(([name], row))
    return found


def _joined(names: list[str]) -> str:
    return ", ".join(names) if len(names) <= TOGETHER else f"{names[0]}, {names[1]} and {len(names) - 2} more"


def _curves(result: Kinetostatics, alike: Sequence[tuple[str, int]], values: Array) -> list[Line]:
    return [_over_turn(result, values[row], curve(k), name) for k, (name, row) in enumerate(alike)]


def _over_turn(result: Kinetostatics, y: Array, role: str, name: str) -> Line:
    """A curve over degrees, with the end of the last turn put back, where it closes."""
    degrees = np.degrees(result.input_angle)
    if result.turns % result.repeats_after:
        return Line(degrees, y, role, name)
    return Line(np.append(degrees, 360.0 * result.turns), np.append(y, y[0]), role, name)


def _turn(result: Kinetostatics, step: float) -> Axis:
    end = 360.0 * result.turns
    return Axis("input angle", "°", 0.0, end, ticks=np.arange(0, end + 1, step * result.turns).tolist())


def _panel(result: Kinetostatics, curves: Sequence[Line], words: str, unit: str) -> Panel:
    values = np.array([c.y for c in curves]) if curves else np.zeros(1)
    size, swing = float(np.max(np.abs(values))), float(np.ptp(values))
    up = Axis(words, unit)
    if swing < SAME * max(size, 1e-3):  # rounding of a level curve must not fill the panel
        middle = float(np.mean(values))
        margin = 0.05 * abs(middle) or 1.0
        up = replace(up, low=middle - margin, high=middle + margin)
    return Panel(_turn(result, 90), up, curves, key="")


def _around(result: Kinetostatics, axis: Axis, curves: Sequence[Line]) -> Panel:
    values = np.array([c.y for c in curves])
    low, high = float(values.min()), float(values.max())
    swing = max(high - low, 1e-3 * abs(high), 1e-12)
    # A small swing about a large mean is shown about an inner circle that is not zero.
    up = replace(axis, low=low - swing if low > 2 * swing else 0.0, high=high + 0.05 * swing)
    return Panel(_turn(result, 90), up, curves, polar=True)


def _key_title(words: str, curves: Sequence[object]) -> str:
    return words + (f" (styles repeat after {STYLES})" if len(curves) > STYLES else "")


def _scale(values: Array, unit: str) -> tuple[float, str]:
    """Factor and unit in which the largest value reads well."""
    return (1e3, f"k{unit}") if np.size(values) and np.max(np.abs(values)) >= 1e4 else (1.0, unit)
