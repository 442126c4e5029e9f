"""Transients: torques and speeds over time, torque over speed, orders over time by the line's true rotation."""

from __future__ import annotations

import numpy as np

from trunnion.motion.simulation.order_map import order_map
from trunnion.motion.transients.result import Transient
from trunnion.pictures.looks import curve
from trunnion.pictures.motion import TORQUES, map_of_orders
from trunnion.pictures.picture import Axis, Item, Level, Line, Panel, Picture, points_at, single
from trunnion.pictures.shared import place_of
from trunnion.results.words import Words


def history(result: Transient, *, shafts: tuple[str, ...] = (), unit: str = "") -> Picture:
    """Torque of the springs above, speed of the disks below; where a level was crossed."""
    words = Words(unit or result.unit)
    remedy = f"it has: {', '.join(result.shafts)}"
    chosen = [place_of(s, result.shafts, 0, "shaft", "is not a spring of this line", remedy) for s in shafts]
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
    i = place_of(disk or None, result.disks, result.disks.index(acted), "disk", "is not a Disk of this line", remedy)
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
