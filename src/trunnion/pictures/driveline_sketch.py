"""A driveline as a sketch: every element in order, joints bent by their angle, numbers beside them.

Not to scale. Bends are drawn alternately down and up so that the line stays on the page; planes and fork
offsets are written. Branches get a row of their own.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse, Polygon

from trunnion.arrays import Array
from trunnion.driveline.belts import Belt
from trunnion.driveline.composite import StatedChain
from trunnion.driveline.dampers import Damper
from trunnion.driveline.differential import Differential
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import ConstantSpeed, Disk, Element, Ratio, Rotor
from trunnion.driveline.engine import Engine
from trunnion.driveline.gears import GearPair
from trunnion.driveline.planetary import Planetary
from trunnion.driveline.quantities import DEGREE
from trunnion.driveline.shafts import Shaft, SpringElement
from trunnion.driveline.stages import PiecewiseShaft
from trunnion.driveline.torque_converters import TorqueConverter
from trunnion.pictures.draw_matplotlib import SMALL, new_figure, through
from trunnion.pictures.looks import ACCENT, FAINT, INK

WIDTH, WIDEST = 7.4, 9.0
"""Of the figure [inches], and of the page that a short line does not fill, in units of the sketch."""
LARGER = 1.7
"""Letters where numbers stand alone, over those of names: such a sketch is shown small."""
SLANT = 38 * DEGREE
"""Slope of the names."""
STEEPEST = 30 * DEGREE
"""Larger bends are drawn as this."""
HEADROOM = 1.75
"""What stands above a branch: wheels, numbers, a load in two lines."""
LENGTH = {
    "Shaft": 1.25, "Coupling": 1.0, "Disk": 0.55, "ConstantSpeed": 0.6, "Ratio": 0.9, "GearPair": 0.9,
    "PiecewiseShaft": 1.25, "Planetary": 0.9, "ViscousDamper": 0.7, "DualMassFlywheel": 1.25, "Belt": 0.9,
    "TunedDamper": 0.7, "Differential": 0.9, "Clutch": 1.25, "Tyre": 0.8, "Vehicle": 1.5,
    "SlipClutch": 0.7, "CentrifugalPendulum": 0.7, "Motor": 0.95, "Generator": 0.95,
    "Fan": 0.8, "Pump": 0.8, "Propeller": 0.8, "Brake": 0.7,
    "TorqueConverter": 0.9,
}  # fmt: skip
JOINT_LENGTH = 0.9
THROW = 0.5
"""Length of an engine for each of its throws."""
SHAFTS = (SpringElement, PiecewiseShaft)
GEARS = (Ratio, GearPair, Planetary, Belt, Differential)
TUBE, SOLID = "#cfe3f2", "#e9e9e9"
APART = 1.1
"""Of the axles of a belt."""


@dataclass(frozen=True)
class _ElementPlace:
    """An element on the page: its two ends and its direction [rad]; ``row`` of the branch."""

    element: Element
    name: str
    start: Array
    end: Array
    direction: float
    behind: float
    row: int

    @property
    def middle(self) -> Array:
        """Half-way between its ends."""
        return (self.start + self.end) / 2

    @property
    def lowest(self) -> float:
        """Height of the lower end."""
        return float(min(self.start[1], self.end[1]))

    def part(self, begin: float, end: float) -> _ElementPlace:
        """What lies between two distances behind its middle."""
        along = _along(self.direction)
        return replace(self, start=self.middle + begin * along, end=self.middle + end * along)


@dataclass(frozen=True)
class _Layout:
    """Elements on their page: its lower left and upper right corner, size and width of letters, floors of the rows."""

    places: list[_ElementPlace]
    low: Array
    high: Array
    size: float
    floor: dict[int, float]


def _layout(line: Driveline, least: float, *, named: bool = True) -> _Layout:
    places = _places(line)
    x = np.array([p for q in places for p in (q.start[0], q.end[0])])
    scale = WIDTH / max(x.max() - x.min() + 1.6, least)
    size = float(np.clip(SMALL * scale / 0.62, 7.5, SMALL))
    letter = 0.62 * size / 72 / scale  # width of a letter in units of the page
    names = max(len(q.name) for q in places) + 3 if named else 0
    places = _places(line, letter) if named else places
    floor = _floors(places)
    ceiling = max(max(q.start[1], q.end[1]) for q in places)
    right = max(q.start[0] + letter * (len(q.name) + 3) * np.cos(SLANT) for q in places) if named else x.max()
    room = max(
        [1.5 if named else 2.0, *(_highest(q.element) + letter * 2.5 for q in places if isinstance(q.element, GEARS))]
    )
    high = np.array([max(x.max() + 0.3, right + 0.4), ceiling + room])
    low = np.array([x.min() - 0.3, min(floor.values()) - 0.3 - letter * names * np.sin(SLANT)])
    high[0] = max(high[0], low[0] + least)
    return _Layout(places, low, high, size if named else LARGER * size, floor)


def draw(line: Driveline, least: float = WIDEST, *, named: bool = True) -> Figure:
    """Sketch ``line``; elements carry the numbers of the table of elements, counted from 1.

    least : width of the page in units of the sketch; a shorter line leaves place beside it. named : names stand beside
    the numbers.
    """
    laid = _layout(line, least, named=named)
    places, low, high = laid.places, laid.low, laid.high
    scale = WIDTH / (high[0] - low[0])
    figure = new_figure(WIDTH, scale * (high[1] - low[1]), layout=None)
    axes: Any = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_aspect("equal")
    disks = [p.element.moment_of_inertia for p in places if isinstance(p.element, Disk)]
    for number, place in enumerate(places, start=1):
        _DRAW.get(place.element.kind, _joint)(axes, place, disks)
        _name(axes, place, number, laid.size, laid.floor[place.row], named=named)
        _numbers(axes, place, laid.size, _between_joints(line.as_stated, number - 1))
    for place, parent in zip(places, line.as_stated.parents, strict=True):
        if parent is not None and places[parent].row != place.row:
            _bar(axes, places[parent].end, place.start, color=FAINT, lw=1.2, ls=(0, (3, 2)))
        if (to := getattr(place.element, "to", None)) is not None:
            closed = places[line.as_stated.index(to)]
            _bar(axes, place.end, closed.end, color=FAINT, lw=1.2, ls=(0, (3, 2)))
    return figure


@dataclass(frozen=True)
class Spot:
    """Where an element is on its sketch, in shares of its width and height from the upper left corner.

    box : left, top, width and height of what is drawn of it; begins, ends (2,) : its two ends; parent : place of the
    element that it hangs on, −1 for none.
    """

    name: str
    kind: str
    box: tuple[float, float, float, float]
    begins: tuple[float, float]
    ends: tuple[float, float]
    parent: int


def spots(line: Driveline, least: float = WIDEST) -> tuple[Spot, ...]:
    """Where the elements of ``line`` are on what ``draw`` makes of it."""
    laid, found = _layout(line, least), []
    whole = laid.high - laid.low

    def share(point: Array) -> tuple[float, float]:
        x, y = (point - laid.low) / whole
        return float(x), float(1.0 - y)

    for place, parent in zip(laid.places, line.as_stated.parents, strict=True):
        half = 0.95 if isinstance(place.element, Rotor) else 0.5
        ends = np.array([place.start, place.end])
        left, top = share(np.array([ends[:, 0].min(), ends[:, 1].max() + half]))
        right, below = share(np.array([ends[:, 0].max(), ends[:, 1].min() - half]))
        box = left, top, right - left, below - top
        hangs = -1 if parent is None else parent
        found.append(Spot(place.name, place.element.kind, box, share(place.start), share(place.end), hangs))
    return tuple(found)


def _places(line: Driveline, letter: float = 0.0) -> list[_ElementPlace]:
    """Walk the line; a branch starts below its parent and the names, of that width of a letter, that reach over it."""
    places: list[_ElementPlace] = []
    down: dict[int, float] = {}
    rows = 0
    chain = line.as_stated
    for i, (element, name, parent) in enumerate(zip(chain.elements, chain.names, chain.parents, strict=True)):
        if parent is None:
            start, direction, row = np.zeros(2), 0.0, 0
        elif parent == i - 1:
            before = places[-1]
            start, direction, row = before.end, before.behind, before.row
        else:
            rows += 1
            deepest = min(p.lowest for p in places)
            left, floors = places[parent].end[0] + 0.5, _floors(places)
            lengths = [letter * (len(p.name) + 3) for p in places]
            names = [
                floors[p.row] - length * np.sin(SLANT)
                for p, length in zip(places, lengths, strict=True)
                if p.start[0] + length * np.cos(SLANT) > left - 1.0
            ]
            start, direction, row = np.array([left, min([deepest - 3.2, *(n - HEADROOM for n in names)])]), 0.0, rows
        angle = abs(float(getattr(element, "angle", 0.0)))
        behind = direction
        if angle:
            down[row] = -down.get(row, 1.0)
            side = -np.sign(direction) if direction else down[row]  # a sloping line back towards the horizontal
            behind = direction + side * min(angle, STEEPEST)
        half = _length(element) / 2
        end = start + half * _along(direction) + half * _along(behind)
        places.append(_ElementPlace(element, name, start, end, direction, behind, row))
    return places


def _length(element: Element) -> float:
    """Along the line, on the page."""
    if isinstance(element, Engine):
        return THROW * element.throws + 0.3
    return LENGTH.get(element.kind, JOINT_LENGTH)


def _along(direction: float) -> Array:
    return np.array([np.cos(direction), np.sin(direction)])


def _across(direction: float) -> Array:
    return np.array([-np.sin(direction), np.cos(direction)])


def _bar(axes: Axes, *points: Array, **look: Any) -> None:
    """A line through points, by default the axle of an element."""
    through(axes, *points, **{"color": INK, "lw": 2.0, "zorder": 2, **look})


def _box(axes: Axes, place: _ElementPlace, half: float, **look: Any) -> None:
    side = half * _across(place.direction)
    corners = [place.start - side, place.end - side, place.end + side, place.start + side]
    axes.add_patch(Polygon(corners, closed=True, **{"ec": INK, "lw": 1.1, "zorder": 3, **look}))


def _drive(axes: Axes, place: _ElementPlace, disks: list[float]) -> None:
    _box(axes, place, 0.5, fc="white", hatch="////")


def _shaft(axes: Axes, place: _ElementPlace, disks: list[float]) -> None:
    shaft = place.element
    assert isinstance(shaft, Shaft)
    tube = shaft.outer_diameter is not None
    _box(axes, place, 0.17 if tube else 0.08, fc=TUBE if tube else SOLID)


def _coupling(axes: Axes, place: _ElementPlace, disks: list[float]) -> None:
    """Two flanges with an elastic element between them."""
    _bar(axes, place.start, place.end)
    _box(axes, place.part(-0.14, 0.14), 0.3, fc="#d8c7a0", hatch="xxx")
    _box(axes, place.part(-0.24, -0.14), 0.36, fc=SOLID)
    _box(axes, place.part(0.14, 0.24), 0.36, fc=SOLID)


def _stages(axes: Axes, place: _ElementPlace, disks: list[float]) -> None:
    """A shaft with a spring in a window, as a clutch disc has them."""
    _bar(axes, place.start, place.end)
    _box(axes, place.part(-0.4, 0.4), 0.26, fc="white")
    turns = np.linspace(-0.36, 0.36, 10)[:, None] * _along(place.direction)
    turns = place.middle + turns + np.tile([0.14, -0.14], 5)[:, None] * _across(place.direction)
    _bar(axes, *turns, lw=1.1, zorder=4)


def _slip_clutch(axes: Axes, place: _ElementPlace, disks: list[float]) -> None:
    """Two linings that are pressed together."""
    _bar(axes, place.start, place.end)
    for begin, face in ((-0.17, SOLID), (-0.05, "#8a8a8a"), (0.05, SOLID)):
        _box(axes, place.part(begin, begin + (0.1 if face != SOLID else 0.12)), 0.42, fc=face)


def _dual_mass(axes: Axes, place: _ElementPlace, disks: list[float]) -> None:
    """Springs between two flywheels."""
    _stages(axes, place, disks)
    for begin in (-0.55, 0.41):
        _box(axes, place.part(begin, begin + 0.14), 0.7, fc="#9db7c9")


def _disk(axes: Axes, place: _ElementPlace, disks: list[float]) -> None:
    """Height by the logarithm of the inertia: drivelines span decades."""
    disk = place.element
    assert isinstance(disk, Disk)
    low, high = min(disks), max(disks)
    share = np.log(disk.moment_of_inertia / low) / np.log(high / low) if high > low * 1.001 else 0.5
    _bar(axes, place.start, place.end)
    _box(axes, place.part(-0.16, 0.16), 0.4 + 0.5 * float(share), fc="#9db7c9")


def _engine(axes: Axes, place: _ElementPlace, disks: list[float]) -> None:
    """A crank with its throws, and over each a piston in its cylinder, or two of a V engine."""
    engine = place.element
    assert isinstance(engine, Engine)
    along, across = _along(place.direction), _across(place.direction)
    banks = (0.0,) if engine.bank_angle is None else (-0.12, 0.12)
    crank = [place.start]
    for j, cylinders in enumerate(engine.on_throws):
        middle = place.start + (0.15 + THROW * (j + 0.5)) * along
        rise = 0.22 * float(np.cos(engine.firing_angles[cylinders[0] - 1]))  # where its pin stands as cylinder 1 fires
        pin = middle + rise * across
        ends = [middle + side * 0.13 * along for side in (-1, 1)]
        crank += [ends[0], ends[0] + rise * across, ends[1] + rise * across, ends[1]]
        for cylinder, lean in zip(cylinders, banks, strict=True):
            top = middle + lean * along + 0.62 * across
            _bar(axes, pin, top + rise * across, lw=1.2, zorder=4)
            piston = replace(place, start=top - 0.1 * along + rise * across, end=top + 0.1 * along + rise * across)
            liner = replace(place, start=top - 0.13 * along, end=top + 0.13 * along)
            _box(axes, liner, 0.42, fc="white", zorder=1, ec=FAINT)
            silent = cylinder in (engine.misfiring, engine.cut_out)
            _box(axes, piston, 0.1, fc="white" if silent else "#9db7c9", hatch="xxx" if silent else None)
    _bar(axes, *crank, place.end, zorder=5)


def _electric(axes: Axes, place: _ElementPlace, disks: list[float]) -> None:
    """The circle of an electric machine with its letter."""
    _bar(axes, place.start, place.end)
    axes.add_patch(Ellipse(tuple(place.middle), 0.86, 0.86, fc="#f6d9c9", ec=INK, lw=1.2, zorder=3))
    x, y = place.middle
    axes.text(x, y, place.element.kind[0], fontsize=SMALL + 1, color=INK, ha="center", va="center", zorder=4)


def _blades(axes: Axes, place: _ElementPlace, disks: list[float]) -> None:
    """Blades above and below a hub."""
    _bar(axes, place.start, place.end)
    tilt = np.rad2deg(place.direction)
    for side in (1, -1):
        tip = place.middle + side * 0.48 * _across(place.direction)
        look: dict[str, Any] = {"angle": tilt - side * 14, "fc": "#cfe8dc", "ec": INK, "lw": 1.1, "zorder": 3}
        axes.add_patch(Ellipse(tuple(tip), 0.3, 0.86, **look))
    _box(axes, place.part(-0.17, 0.17), 0.2, fc="#8fa9b8", zorder=4)


def _brake(axes: Axes, place: _ElementPlace, disks: list[float]) -> None:
    """A disk between two pads that hang from above."""
    _bar(axes, place.start, place.end)
    _box(axes, place.part(-0.05, 0.05), 0.62, fc="#9db7c9")
    tilt = np.rad2deg(place.direction)
    for side in (-1, 1):
        pad = place.middle + 0.14 * side * _along(place.direction) + 0.42 * _across(place.direction)
        axes.add_patch(Ellipse(tuple(pad), 0.16, 0.4, angle=tilt, fc="#e0a458", ec=INK, lw=1.1, zorder=4))


def _converter(axes: Axes, place: _ElementPlace, disks: list[float]) -> None:
    """Two half rings of blades that face each other, and the lock-up clutch between them where it is closed."""
    converter = place.element
    assert isinstance(converter, TorqueConverter)
    for side, faces in ((-1, "#c9d8e3"), (1, "#e0c9a0")):
        end = place.start if side < 0 else place.end
        _bar(axes, end, place.middle + 0.2 * side * _along(place.direction))
        for way in (1, -1):
            at = place.middle + 0.13 * side * _along(place.direction) + 0.4 * way * _across(place.direction)
            axes.add_patch(
                Ellipse(tuple(at), 0.2, 0.46, angle=np.rad2deg(place.direction), fc=faces, ec=INK, lw=1.1, zorder=4)
            )
        wall = replace(place, start=place.middle, end=place.middle)
        _box(axes, wall.part(side * 0.2 - 0.03, side * 0.2 + 0.03), 0.62, fc=SOLID)
    if converter.locked:
        _bar(axes, place.start, place.end, lw=2.4, zorder=5)


def _pump(axes: Axes, place: _ElementPlace, disks: list[float]) -> None:
    """The circle of a pump with its triangle."""
    _bar(axes, place.start, place.end)
    axes.add_patch(Ellipse(tuple(place.middle), 0.86, 0.86, fc="#cfe8dc", ec=INK, lw=1.2, zorder=3))
    along, across = _along(place.direction), _across(place.direction)
    corners = [place.middle + 0.4 * along, place.middle - 0.2 * along + 0.36 * across]
    _bar(axes, *corners, place.middle - 0.2 * along - 0.36 * across, corners[0], lw=1.2, zorder=4)


def _damper(axes: Axes, place: _ElementPlace, disks: list[float]) -> None:
    """A ring above and below in its housing, in oil or on a spring."""
    damper = place.element
    assert isinstance(damper, Damper)
    _bar(axes, place.start, place.end)
    for side in (1, -1):
        middle = replace(place, start=place.start + side * 0.62 * _across(place.direction),
                         end=place.end + side * 0.62 * _across(place.direction))  # fmt: skip
        _bar(axes, place.middle, middle.middle, lw=1.4)
        _box(axes, middle.part(-0.24, 0.24), 0.26, fc="#d5e8dd" if damper.dragged else "#d8c7a0")
        _box(axes, middle.part(-0.15, 0.15), 0.16, fc="#8fa9b8")


def _pendulum(axes: Axes, place: _ElementPlace, disks: list[float]) -> None:
    """A carrier with a mass that hangs outwards from it on either side."""
    _bar(axes, place.start, place.end)
    _box(axes, place.part(-0.09, 0.09), 0.45, fc=SOLID)
    for side in (1, -1):
        pivot, mass = (place.middle + side * at * _across(place.direction) for at in (0.38, 0.72))
        _bar(axes, pivot, mass, lw=1.4, zorder=4)
        axes.add_patch(
            Ellipse(tuple(mass), 0.3, 0.24, angle=np.rad2deg(place.direction), fc="#8fa9b8", ec=INK, zorder=5)
        )


def _wheels(element: Ratio | GearPair) -> tuple[float, float]:
    """Radii of the wheel on the axle and of the one above it."""
    share = float(np.clip(abs(element.speed_ratio), 0.25, 4.0))
    return 0.8 / (1 + share), 0.8 * share / (1 + share)


def _pulleys(belt: Belt) -> tuple[float, float]:
    """The same of a belt, whose axles stand ``APART``."""
    share = float(np.clip(belt.speed_ratio, 0.25, 4.0))
    return 0.45 / max(1.0, share), 0.45 * share / max(1.0, share)


def _highest(element: object) -> float:
    """How far what has a ratio reaches above its axle."""
    if isinstance(element, Ratio | GearPair):
        first, second = _wheels(element)
        return first + 2 * second
    return APART + _pulleys(element)[1] if isinstance(element, Belt) else 0.95


def _ratio(axes: Axes, place: _ElementPlace, disks: list[float]) -> None:
    """Two wheels in mesh, sizes by the ratio."""
    element = place.element
    assert isinstance(element, Ratio | GearPair)
    first, second = _wheels(element)
    _bar(axes, place.start, place.middle)
    _bar(axes, place.middle, place.end)
    for radius, offset, face in ((first, 0.0, "#f1d9a7"), (second, first + second, "#f7ead0")):
        centre = place.middle + offset * _across(place.direction)
        look: dict[str, Any] = {"fc": face, "ec": INK, "lw": 1.1, "zorder": 3}
        axes.add_patch(Ellipse(tuple(centre), 0.3, 2 * radius, angle=np.rad2deg(place.direction), **look))


def _belt(axes: Axes, place: _ElementPlace, disks: list[float]) -> None:
    """Two pulleys, sizes by the ratio, and a belt round them."""
    belt = place.element
    assert isinstance(belt, Belt)
    radii = _pulleys(belt)
    centres = place.middle, place.middle + APART * _across(place.direction)
    _bar(axes, place.start, place.end)
    for radius, centre in zip(radii, centres, strict=True):
        look: dict[str, Any] = {"fc": "#e9e9e9", "ec": INK, "lw": 1.1, "zorder": 3}
        axes.add_patch(Ellipse(tuple(centre), 0.3, 2 * radius, angle=np.rad2deg(place.direction), **look))
    for side in (-0.15, 0.15):
        ends = [centre + side * _along(place.direction) for centre in centres]
        _bar(axes, *ends, lw=1.4, zorder=4)


def _planetary(axes: Axes, place: _ElementPlace, disks: list[float]) -> None:
    """A ring above and below, planets on the sun; what is held is hatched."""
    element = place.element
    assert isinstance(element, Planetary)
    sun = 0.75 * element.teeth_sun / element.teeth_ring
    planet = (0.75 - sun) / 2
    _bar(axes, place.start, place.end)
    look: dict[str, Any] = {"ec": INK, "lw": 1.1, "zorder": 3, "angle": np.rad2deg(place.direction)}
    wheels = [(0.0, sun, "sun")]
    for side in (1, -1):
        wheels += [(side * (sun + planet), planet, "carrier"), (side * 0.82, 0.07, "ring")]
    for offset, radius, shaft in wheels:
        centre = place.middle + offset * _across(place.direction)
        face = "#f1d9a7" if shaft == "sun" else "#f7ead0"
        hatch = "////" if shaft == element.held else None
        axes.add_patch(Ellipse(tuple(centre), 0.3, 2 * radius, fc=face, hatch=hatch, **look))


def _differential(axes: Axes, place: _ElementPlace, disks: list[float]) -> None:
    """A case with a crown wheel, and two side gears in it."""
    _bar(axes, place.start, place.end)
    _box(axes, place.part(-0.22, 0.22), 0.5, fc="#f7ead0")
    _box(axes, place.part(-0.34, -0.22), 0.75, fc="#f1d9a7")
    for side in (1, -1):
        gear = place.middle + side * 0.25 * _across(place.direction)
        look: dict[str, Any] = {"fc": "#f1d9a7", "ec": INK, "lw": 1.1, "zorder": 4}
        axes.add_patch(Ellipse(tuple(gear), 0.22, 0.34, angle=np.rad2deg(place.direction), **look))


def _tyre(axes: Axes, place: _ElementPlace, disks: list[float]) -> None:
    """A tyre above and below its rim, with grooves."""
    _bar(axes, place.start, place.end)
    for side in (1, -1):
        off = side * 0.66 * _across(place.direction)
        tread = replace(place, start=place.start + off, end=place.end + off)
        _bar(axes, place.middle, tread.middle, lw=1.4)
        _box(axes, tread.part(-0.2, 0.2), 0.16, fc="#8a8a8a")
        for groove in (-0.07, 0.07):
            _bar(axes, *(tread.part(groove, groove).middle + k * _across(place.direction) for k in (-0.13, 0.13)),
                 color="white", lw=0.8, zorder=4)  # fmt: skip


def _vehicle(axes: Axes, place: _ElementPlace, disks: list[float]) -> None:
    """A body on two wheels."""
    body = [
        (-0.7, -0.15),
        (-0.7, 0.18),
        (-0.4, 0.24),
        (-0.2, 0.56),
        (0.28, 0.56),
        (0.45, 0.22),
        (0.7, 0.14),
        (0.7, -0.15),
    ]
    along, across = _along(place.direction), _across(place.direction)
    corners = [place.middle + x * along + y * across for x, y in body]
    axes.add_patch(Polygon(corners, closed=True, fc="#c9d8e3", ec=INK, lw=1.1, zorder=3))
    for x in (-0.42, 0.42):
        wheel = place.middle + x * along - 0.2 * across
        axes.add_patch(Ellipse(tuple(wheel), 0.3, 0.3, fc="#8a8a8a", ec=INK, lw=1.1, zorder=4))


def _joint(axes: Axes, place: _ElementPlace, disks: list[float]) -> None:
    """Two forks on a cross; a full circle where rotation passes unchanged; the bend as a dashed wedge."""
    centre = place.start + 0.5 * JOINT_LENGTH * _along(place.direction)
    for end, direction, sign in ((place.start, place.direction, 1), (place.end, place.behind, -1)):
        side = 0.26 * _across(direction)
        neck = end + sign * 0.14 * _along(direction)
        for arm in (side, -side):
            _bar(axes, end, neck, neck + arm, centre + arm * 0.9, lw=1.6, solid_joinstyle="round", zorder=3)
    hooke = place.element.kind == "HookeJoint"
    axes.plot(*centre, "P" if hooke else "o", ms=7, mfc="white", mec=INK, mew=1.4, zorder=4)
    if place.behind != place.direction:
        straight = centre + 1.5 * _along(place.direction)
        _bar(axes, centre, straight, color=FAINT, lw=0.8, ls=(0, (4, 3)), zorder=1)


_DRAW: dict[str, Callable[[Axes, _ElementPlace, list[float]], None]] = {
    "ConstantSpeed": _drive,
    "Shaft": _shaft,
    "Coupling": _coupling,
    "Disk": _disk,
    "Engine": _engine,
    "Ratio": _ratio,
    "GearPair": _ratio,
    "ViscousDamper": _damper,
    "TunedDamper": _damper,
    "Belt": _belt,
    "DualMassFlywheel": _dual_mass,
    "Tyre": _tyre,
    "Vehicle": _vehicle,
    "Planetary": _planetary,
    "Differential": _differential,
    "PiecewiseShaft": _stages,
    "Clutch": _stages,
    "SlipClutch": _slip_clutch,
    "CentrifugalPendulum": _pendulum,
    "Motor": _electric,
    "Generator": _electric,
    "Fan": _blades,
    "Propeller": _blades,
    "Pump": _pump,
    "Brake": _brake,
    "TorqueConverter": _converter,
}


def _floors(places: list[_ElementPlace]) -> dict[int, float]:
    """Height of the names of each row: below everything in it."""
    rows = {place.row for place in places}
    return {r: min(p.lowest for p in places if p.row == r) - 1.05 for r in rows}


def _name(axes: Axes, place: _ElementPlace, number: int, size: float, floor: float, *, named: bool) -> None:
    """Number and name, slanted below the row, or the number alone."""
    middle = place.middle
    slanted = {"rotation": -np.rad2deg(SLANT), "rotation_mode": "anchor", "ha": "left"} if named else {"ha": "center"}
    text = f"{number} {place.name}" if named else f"{number}"
    axes.text(middle[0], floor, text, fontsize=size, color=INK, va="center", **slanted)
    below = 0.95 if isinstance(place.element, Rotor) else 0.55 + 0.9 * abs(np.sin(place.direction))
    if middle[1] - below > floor + 0.1:
        axes.plot([middle[0]] * 2, [middle[1] - below, floor + 0.08], color="#c9c9c9", lw=0.6, zorder=0)


def _between_joints(line: StatedChain, place: int) -> bool:
    """Whether a shaft has a joint on both sides of it along its chain, so that its fork offset matters."""

    def bends(i: int | None) -> bool:
        return i is not None and hasattr(line.elements[i], "angle")

    def reaches_joint(step: Callable[[int], int | None]) -> bool:
        i = step(place)
        while i is not None and not bends(i) and not isinstance(line.elements[i], SHAFTS):
            i = step(i)
        return bends(i)

    first_behind = {parent: i for i, parent in reversed([*enumerate(line.parents)]) if parent is not None}
    return reaches_joint(line.parents.__getitem__) and reaches_joint(first_behind.get)


def _numbers(axes: Axes, place: _ElementPlace, size: float, between: bool) -> None:
    """What the geometry of the line needs: angles, planes, fork offsets, ratios; above the element."""
    element = place.element
    text = ""
    angle, plane = (float(getattr(element, key, 0.0)) for key in ("angle", "plane"))
    if hasattr(element, "angle"):
        text = f"β {angle / DEGREE:.4g}°" + (f"\nplane {plane / DEGREE:.4g}°" if plane else "")
    elif isinstance(element, SHAFTS) and (element.fork_offset or between):
        text = f"forks {element.fork_offset / DEGREE:.4g}°"
    elif isinstance(element, GEARS):
        text = f"i {element.speed_ratio:.4g}"
    elif load := getattr(element, "load_torque", 0.0):
        text = f"load\n{load:.4g} N m"
    elif isinstance(element, ConstantSpeed):
        text = "Ω"
    elif isinstance(element, Engine) and len(element.firing_order) > 1:
        text = "-".join(map(str, element.firing_order))
    if isinstance(element, GEARS):  # above the upper wheel, clear of a disk beside it
        at = place.middle + _highest(element) * _across(place.direction) + np.array([0.0, 0.06])
        axes.text(at[0], at[1], text, fontsize=size, color=INK, ha="center", va="bottom", zorder=6)
    elif text:
        tall = 1.0 if isinstance(element, Rotor) else 1.2 if isinstance(element, Engine) else None
        height = tall or 0.55 + 0.9 * abs(np.sin(place.direction))
        colour = ACCENT if hasattr(element, "angle") else INK
        axes.text(
            place.middle[0],
            place.middle[1] + height,
            text,
            fontsize=size,
            color=colour,
            ha="center",
            va="bottom",
            zorder=6,
        )
