"""Transients: torques and speeds over time, torque over speed, orders over time by the line's true rotation."""

from __future__ import annotations

import numpy as np

from trunnion.motion.passing.capture_map import CaptureMap
from trunnion.motion.passing.passing_result import Passing
from trunnion.motion.simulation.order_map import order_map
from trunnion.motion.transients.result import Transient
from trunnion.pictures.looks import curve
from trunnion.pictures.motion import TORQUES, map_of_orders
from trunnion.pictures.picture import (
    Axis,
    Cells,
    ColouredGrid,
    Colours,
    Item,
    Level,
    Line,
    Panel,
    Picture,
    points_at,
    single,
)
from trunnion.pictures.shared import place_of
from trunnion.results.words import Words


def history(result: Transient, *, shafts: tuple[str, ...] = (), unit: str = "") -> Picture:
    """Torque of the springs above, speed of the disks below; where a level was crossed."""
    words = Words(unit or result.unit)
    remedy = f"it has: {', '.join(result.shafts)}"
    chosen = [place_of(s, result.shafts, 0, "shaft", "not a spring of this line", remedy) for s in shafts]
    across = Axis("time", "s", float(result.time[0]), float(result.time[-1]))
    times = [at for at, _ in result.crossings]
    crossed: list[Item] = [Level(at, "hangs", "" if k else "crossed", "x") for k, at in enumerate(times)]
    above: list[Item] = [
        Line(result.time, result.torque[:, i], curve(k), result.shafts[i])
        for k, i in enumerate(chosen or range(len(result.shafts)))
    ]
    below: list[Item] = [
        Line(result.time, result.speed[:, i] * words.factor, curve(i), name) for i, name in enumerate(result.disks)
    ]
    torque = Panel(Axis("", "", across.low, across.high), TORQUES, [*above, *crossed], key="beside")
    speed = Panel(across, Axis("speed", words.of_speeds), [*below, *crossed], key="beside")
    return Picture([torque, speed], 7.6, 5.2, title=f"{result.name}: {result.outcome.kind}" if result.name else "")


def plane(result: Transient, *, disk: str = "", unit: str = "") -> Picture:
    """What is applied to a disk over its speed, and the torque of the spring that is loaded most; by default the first
    disk that a torque acts on."""
    words = Words(unit or result.unit)
    acted = next((one.on for one in result.asked[0]), result.disks[0])
    remedy = f"it has: {', '.join(result.disks)}"
    i = place_of(disk or None, result.disks, result.disks.index(acted), "disk", "not a Disk of this line", remedy)
    j = int(np.argmax(result.peak_torque))
    speed, spring = result.speed[:, i] * words.factor, result.torque[:, j]
    items: list[Item] = [
        Line(speed, spring, curve(0), f"torque of {result.shafts[j]}"),
        Line(speed, result.applied[:, i], curve(1), f"applied to {result.disks[i]}"),
        points_at([speed[0], spring[0]], "start", "begin"),
    ]
    return single(Axis(f"speed of {result.disks[i]}", words.of_speeds), TORQUES, items, height=4.4)


def orders(result: Transient, *, shaft: str = "", window: int = 8, highest: float = 12.0, unit: str = "") -> Picture:
    """Torque amplitude of one spring over order and speed, by the rotation that the line made."""
    return map_of_orders(order_map(result, window=window, highest=highest), shaft=shaft, unit=unit)


def passing(result: Passing, *, shaft: str = "", unit: str = "") -> Picture:
    """Torque of one spring (the most loaded, or ``shaft``) over the mean speed of the line; where it hung or vibrated
    most, and the speed asked for."""
    words, run = Words(unit or result.unit), result.run
    remedy = f"it has: {', '.join(result.shafts)}"
    most = int(np.argmax(result.peak_torque))
    i = place_of(shaft or None, result.shafts, most, "shaft", "not a spring of this line", remedy)
    speed = run.whole.speed(run.time) * words.factor
    hung = result.ending.kind == "captured"
    items: list[Item] = [
        Line(speed, run.torque[:, i], curve(0), f"torque of {result.shafts[i]}"),
        Level(result.ending.speed * words.factor, "hangs", "where it hangs" if hung else "where it shakes most", "x"),
        Level(result.ending.last * words.factor, "accelerates", "speed asked for", "x"),
    ]
    across = Axis("mean speed of the line", words.of_speeds)
    return single(across, TORQUES, items, height=4.4, title=f"{result.ending.kind}")


def capture_map(result: CaptureMap) -> Picture:
    """Share captured in colour, lighter the more; its boundary at one half; where the torque is short without that."""
    along, up = result.axes
    x, y = result.x * along.factor, result.y * up.factor
    colours = Colours("share of starting phases captured", "amplitude", 0.0, 1.0)
    items: list[Item] = [ColouredGrid(x, y, result.share, colours)]
    if result.short.any():
        items.append(Cells(x, y, result.short, "no basin", "short of torque"))
    if not result.computed.all():
        items.append(Cells(x, y, ~result.computed, "not found", "not computed"))
    pieces = result.boundary * (along.factor, up.factor)
    if len(pieces):
        parted = np.concatenate([pieces, np.full((len(pieces), 1, 2), np.nan)], axis=1).reshape(-1, 2)
        items.append(Line(parted[:, 0], parted[:, 1], "captured half", "half of the starting phases captured"))
    return single(Axis(along.quantity, along.unit), Axis(up.quantity, up.unit), items, 7.0, 4.8, grid="")
