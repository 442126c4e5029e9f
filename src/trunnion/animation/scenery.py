"""Where the parts of a line stand in space, and on which shaft each of them turns.

Axes and bends are true: every shaft has a frame (e, u, v) as kinetostatics have it, a joint turns it by its plane and
bends it by its angle. Along an axis nothing is to scale but tubes of stated length among each other. The radius of a
disk goes with the fifth root of its inertia, as of steel disks of one shape, that of a shaft with the fourth root of
its stiffness. Gears set the shaft behind them aside, a differential across; branches stand beside each other.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from trunnion.animation.movement import stiffness_of
from trunnion.arrays import Array
from trunnion.driveline.belts import Belt
from trunnion.driveline.differential import Differential
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import Element
from trunnion.driveline.engine import Engine
from trunnion.driveline.gears import GearPair
from trunnion.driveline.geometry import tube_stress
from trunnion.driveline.joints import HookeJoint
from trunnion.driveline.parts import Dragged, Geared, Heavy, Jointed, Loose, Prescribed, Sprung, Tied
from trunnion.driveline.planetary import Planetary
from trunnion.driveline.shafts import SpringElement
from trunnion.driveline.vehicle import Tyre
from trunnion.equations.topology import Topology, stations_of

START = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
"""Rows e, u, v of the first shaft: along x, its first joint bends it downwards."""
DISK, THIN, THICK = 0.62, 0.16, 1.5
"""Radius of a disk of the mean inertia, and the least and the largest of any."""
SHAFT, SLIM, STOUT = 0.1, 0.05, 0.2
"""The same of shafts, by stiffness."""
WIDTH, GAP, LENGTH = 0.24, 0.14, 1.25
"""Width of a disk, what is left beside it, length of a shaft."""
JOINT, CROSS, PLAIN = 0.42, 0.26, 0.2
"""From the end of a shaft to the centre of its joint; reach of a cross; radius of any other joint."""
GEAR, LARGEST = 0.85, 4.0
"""Sum of two gears' radii, and the largest ratio drawn."""
LANE = 1.9
"""From a line to a branch of it that starts from the same shaft."""


@dataclass(frozen=True)
class DrawnPart:
    """One body: what it is called, its ``shape``, where it is and what turns it.

    element : number in the line, from 0; name : as the line has it; at (3,) : its middle, or of what has a length, its
    beginning; frame : rows e, u, v, left-handed where the shaft is drawn against its sense; stations : that turn it, or
    its two ends; turned : what is taken off their angles [rad]; spring : whose torque colours it, −1 for none; stress :
    largest shear stress of its section over that torque [1/m³], 0 where no section is stated; far : of what joins two
    places; size : lengths by name, of the shape.
    """

    element: int
    name: str
    shape: str
    at: Array
    frame: Array
    stations: tuple[int, ...] = ()
    turned: tuple[float, ...] = ()
    spring: int = -1
    stress: float = 0.0
    far: Array | None = None
    back: Array | None = None
    size: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class _Axle:
    """Where a coordinate of an element has come to: its station, the end of what is drawn of it, the frame, and by how
    much that is turned from the one that the station's angle counts from [rad]."""

    station: int
    at: Array
    frame: Array
    turned: float = 0.0

    def on(self, length: float) -> _Axle:
        """So far along its axis."""
        return replace(self, at=self.at + length * self.frame[0])


def scenery(line: Driveline, topo: Topology) -> tuple[DrawnPart, ...]:
    """The bodies of ``line``, whose topology is ``topo``, from the drive on."""
    return tuple(_Draft(line, topo).parts())


class _Draft:
    def __init__(self, line: Driveline, topo: Topology) -> None:
        self.line, self.topo = line, topo
        self.stations = stations_of(line).coordinates
        self.axles: list[list[_Axle]] = []
        self.springs = self._springs()
        heavy = [one for element in line.elements if _is_heavy(element) for one in element.inertia_values if one > 0]
        self.mean_inertia = float(np.exp(np.mean(np.log(heavy)))) if heavy else 1.0
        stiff = [k for element in line.elements if (k := stiffness_of(element)) > 0]
        self.mean_stiffness = float(np.exp(np.mean(np.log(stiff)))) if stiff else 1.0
        long = [_tube(element) for element in line.elements if _tube(element) > 0]
        self.mean_length = float(np.median(long)) if long else 1.0

    def _springs(self) -> dict[tuple[int, int], int]:
        """The number of every spring among the line's, by element and number there."""
        found = {}
        for e, compliance in enumerate(self.topo.compliances):
            for i in compliance.shafts:
                found[i, compliance.number if len(compliance.shafts) == 1 else 0] = e
        return found

    def parts(self) -> Iterator[DrawnPart]:
        """All bodies, then what closes loops."""
        closing: list[tuple[int, int, _Axle, str]] = []
        beside: dict[tuple[int, int], int] = {}
        for i, element in enumerate(self.line.elements):
            parent = self.line.parents[i]
            if parent is None:
                start = _Axle(self.stations[i][0], np.zeros(3), START)
            else:
                port = self.line.hangs_on[i] % len(self.axles[parent])
                start = self.axles[parent][port]
                lane = beside[parent, port] = beside.get((parent, port), -1) + 1
                if lane:
                    side = (1 if lane % 2 else -1) * LANE * ((lane + 1) // 2)
                    away = replace(start, at=start.at + side * start.frame[2] + 0.3 * start.frame[0])
                    yield self._part(i, "tie", start, far=away.at)
                    start = away
            yield from self._element(i, element, start, closing)
        for i, spring, axle, to in closing:
            end = self.axles[self.line.index(to)]
            far = end[self.line.elements[self.line.index(to)].onward % len(end)].at
            yield self._part(i, "link", axle, spring=spring, far=far)

    def _part(self, element: int, shape: str, axle: _Axle, **more: Any) -> DrawnPart:
        given: dict[str, Any] = {"stations": (axle.station,), "turned": (axle.turned,)} | more
        return DrawnPart(element, self.line.names[element], shape, axle.at, axle.frame, **given)

    def _element(
        self, i: int, element: Element, start: _Axle, closing: list[tuple[int, int, _Axle, str]]
    ) -> Iterator[DrawnPart]:
        own, springs, heavy = [start], 0, 0
        self.axles.append(own)
        for part in element.parts():
            number = len(own)  # of a coordinate that this part makes
            match part:
                case Prescribed():
                    yield self._part(i, "drive", own[0], size={"length": 0.5, "radius": 0.4})
                    own[0] = own[0].on(0.62)
                    continue
                case Heavy(at):
                    if not _is_heavy(element):  # a tube, whose own inertia is not drawn
                        continue
                    yield from self._heavy(i, element, heavy, own, at)
                    heavy += 1
                    continue
                case Sprung(to, closes, at) if closes is not None or at is not None:
                    spring = self.springs.get((i, springs), -1)
                    springs += 1
                    if closes is None:
                        continue
                    closing.append((i, spring, own[to], closes))
                    continue
                case Dragged(to, closes) if closes is not None:
                    closing.append((i, self.springs.get((i, springs), -1), own[to], closes))
                    springs += 1
                    continue
                case Sprung(to) | Dragged(to):
                    spring = self.springs.get((i, springs), -1)
                    drawn, behind = self._spring(i, element, own[to], self.stations[i][number], spring, number)
                    yield from drawn
                    springs += 1
                case Jointed(orders, to):
                    drawn, behind = self._joint(i, element, own[to], self.stations[i][number], bool(orders))
                    yield from drawn
                case Geared(ratio, to):
                    drawn, behind = self._gears(i, element, own[to], self.stations[i][number], float(ratio))
                    yield from drawn
                case Loose(to) | Tied(((to, _), *_)):
                    behind = self._leg(element, own[to], self.stations[i][number], number)
            own.append(behind)

    def _heavy(self, i: int, element: Element, number: int, own: list[_Axle], at: int) -> Iterator[DrawnPart]:
        """A disk; what hangs beside the line is a ring around it."""
        share = element.inertia_values[number] / self.mean_inertia
        radius = float(np.clip(DISK * max(share, 1e-9) ** 0.2, THIN, THICK))
        if at and element.onward == 0:
            size = {"radius": max(radius, 0.5), "inner": 0.62 * max(radius, 0.5), "length": WIDTH}
            yield self._part(i, "ring", own[at].on(-GAP - WIDTH), size=size)
            return
        pin = _throw(element)
        shape = "disk" if pin is None else "throw"
        size = {"radius": radius, "length": WIDTH, "before": GAP / 2, "after": GAP / 2} | (pin or {})
        if isinstance(element, Tyre):
            shape = "ring"
            size["inner"] = 0.5 * radius
        placed = own[at].on(GAP / 2)
        yield self._part(i, shape, placed, size=size)
        moved = own[at].on(WIDTH + GAP)
        for k, axle in enumerate(own):  # coordinates that stand at the same place go on behind it together
            if np.array_equal(axle.at, own[at].at) and k != at:
                own[k] = replace(axle, at=moved.at)
        own[at] = moved

    def _spring(
        self, i: int, element: Element, axle: _Axle, station: int, spring: int, number: int
    ) -> tuple[list[DrawnPart], _Axle]:
        """A shaft that twists between its ends; where a mesh yields, the gears themselves."""
        if isinstance(element, GearPair):
            return [], replace(axle, station=station)
        if element.onward == 0:  # beside the line
            return [], replace(axle, station=station)
        stiffness = stiffness_of(element)
        radius = SHAFT * (max(stiffness, 1e-12) / self.mean_stiffness) ** 0.25 if stiffness else SHAFT
        length = 0.5 if isinstance(element, Belt | Tyre) else LENGTH
        if tube := _tube(element):
            length = LENGTH * float(np.clip(tube / self.mean_length, 0.5, 2.5))
        fork = float(getattr(element, "fork_offset", 0.0) or 0.0)
        size = {"radius": float(np.clip(radius, SLIM, STOUT)), "length": length}
        shape = "shaft" if element.kind == "Shaft" else "coupling"
        drawn = self._part(
            i, shape, axle, stations=(axle.station, station), turned=(axle.turned, axle.turned + fork), spring=spring,
            size=size, stress=_section(element),
        )  # fmt: skip
        return [drawn], replace(axle.on(length), station=station)

    def _joint(
        self, i: int, element: Element, axle: _Axle, station: int, nonuniform: bool
    ) -> tuple[list[DrawnPart], _Axle]:
        """Bent by its angle, in its plane; a cross has two forks, others a housing."""
        plane, angle = (float(getattr(element, key, 0.0) or 0.0) for key in ("plane", "angle"))
        front, behind = bent(axle.frame, plane, angle)
        centre = axle.at + JOINT * axle.frame[0]
        counted = axle.turned + plane
        cross = isinstance(element, HookeJoint)
        drawn = DrawnPart(
            i, self.line.names[i], "cross" if cross else "joint", centre, front, (axle.station, station),
            (counted, 0.0 if nonuniform else counted), back=behind,
            size={"reach": JOINT, "radius": CROSS if cross else PLAIN},
        )  # fmt: skip
        return [drawn], _Axle(station, centre + JOINT * behind[0], behind, 0.0 if nonuniform else counted)

    def _gears(
        self, i: int, element: Element, axle: _Axle, station: int, ratio: float
    ) -> tuple[list[DrawnPart], _Axle]:
        """Two gears in mesh, outside each other where they turn in opposite senses, else one within the other's rim."""
        turned = axle.turned * ratio
        spring = self.springs.get((i, 0), -1) if isinstance(element, GearPair | Belt) else -1
        if ratio == 1.0:
            drawn = self._part(
                i, "plates", axle.on(0.1), stations=(axle.station, station), turned=(axle.turned, turned),
                size={"radius": 0.42, "length": 0.3},
            )  # fmt: skip
            return [drawn], replace(axle.on(0.5), station=station, turned=turned)
        share = float(np.clip(abs(ratio), 1 / LARGEST, LARGEST))
        if isinstance(element, Differential):
            return self._crown(i, axle, station, share, turned)
        first, second = GEAR / (1 + share), GEAR * share / (1 + share)
        teeth = (getattr(element, "teeth_in", None), getattr(element, "teeth_out", None))
        around = ratio > 0 and not isinstance(element, Belt)
        apart = abs(second - first) if around else first + second
        if isinstance(element, Belt):
            apart *= 1.7
        aside = replace(axle, at=axle.at + apart * axle.frame[1], station=station, turned=turned)
        if isinstance(element, Planetary):
            aside = replace(aside, at=axle.at)
        inner = first if second > first else second
        shapes = [("gear", axle, first, teeth[0]), ("gear", aside, second, teeth[1])]
        drawn_parts = []
        for k, (shape, at, radius, count) in enumerate(shapes):
            size = {"radius": radius, "length": 0.2, "teeth": float(count or round(24 * radius / inner))}
            if around and radius > inner:
                size |= {"inner": radius, "radius": radius * 1.18}
                shape = "rim"
            drawn_parts.append(self._part(i, shape, at.on(0.15 + 0.02 * k), spring=spring, size=size))
        if isinstance(element, Belt):
            size = {"radius": first, "radius_far": second, "length": 0.2}
            belt = self._part(i, "belt", axle.on(0.16), spring=spring, far=aside.on(0.16).at, size=size)
            drawn_parts.append(belt)
        return drawn_parts, aside.on(0.5)

    def _crown(self, i: int, axle: _Axle, station: int, share: float, turned: float) -> tuple[list[DrawnPart], _Axle]:
        """A pinion at the rim of a crown wheel, whose axis lies across."""
        crown = 0.55
        pinion = crown / share
        e, u, v = axle.frame
        across = _Axle(station, axle.at + (0.25 + crown) * e, np.stack([v, u, np.cross(v, u)]), turned)
        gears = [
            self._part(i, "gear", axle.on(0.1), size={"radius": pinion, "length": 0.16, "teeth": 12.0}),
            self._part(i, "gear", across.on(pinion), size={"radius": crown, "length": 0.12, "teeth": 12 * share}),
        ]
        return gears, across

    def _leg(self, element: Element, axle: _Axle, station: int, number: int) -> _Axle:
        """A shaft of a differential, to the side; of a planetary set, the same axis."""
        if not isinstance(element, Differential):
            return replace(axle.on(0.1), station=station)
        e, u, v = axle.frame
        right = element.ports["right"] == number
        if right:
            return replace(axle.on(0.7), station=station)
        against = np.stack([-e, u, v])  # left-handed: it turns as the axis does that it is drawn against
        return _Axle(station, axle.at - 0.4 * e, against, axle.turned)


def bent(frame: Array, plane: float, angle: float) -> tuple[Array, Array]:
    """The frame (rows e, u, v) turned about e by ``plane`` [rad], and that behind a bend of ``angle`` [rad]."""
    e, u, v = frame
    c, s = np.cos(plane), np.sin(plane)
    front = np.stack([e, c * u + s * v, -s * u + c * v])
    e, u, v = front
    c, s = np.cos(angle), np.sin(angle)
    return front, np.stack([c * e + s * u, -s * e + c * u, v])


def _is_heavy(element: Element) -> bool:
    """Whether it has inertias that are drawn as disks: those of a tube are the tube."""
    return not isinstance(element, SpringElement) and any(isinstance(part, Heavy) for part in element.parts())


def _tube(element: Element) -> float:
    """Length of a tube [m], 0 where none is stated."""
    return float(getattr(element, "length", None) or 0.0) if element.kind == "Shaft" else 0.0


def _section(element: Element) -> float:
    """Shear stress at the outside over the torque [1/m³], 0 where no diameter is stated."""
    outer = float(getattr(element, "outer_diameter", None) or 0.0)
    return float(tube_stress(outer, float(getattr(element, "inner_diameter", None) or 0.0))) if outer else 0.0


def _throw(element: Element) -> dict[str, float] | None:
    """Of a throw of an engine, where its pin stands when the first cylinder fires [rad]; None of other disks."""
    owner = element.part_of
    if owner is None or not isinstance(owner[1], Engine) or owner[1].rigid:
        return None
    number = str(element.name or "").rsplit(" ", 1)[-1]
    if not number.isdigit() or not 1 <= int(number) <= owner[1].throws:
        return None
    cylinder = owner[1].on_throws[int(number) - 1][0]
    return {"pin": -float(owner[1].firing_angles[cylinder - 1]), "crank": 0.3}
