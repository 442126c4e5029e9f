"""Which parts of a driveline turn together, and which shaft joins which.

A *station* is a point of the line that has one rotation. Joints and ratios tie the station behind them
rigidly (by a law of angle) to the station in front; a shaft lets its two ends twist against each other.
Stations tied rigidly form a *group*: one coordinate, the rotation of the group's first station. The
dynamics see groups that carry inertia, joined by compliances; massless shafts in series are one
compliance. The root group is prescribed if the line starts with a ConstantSpeed, otherwise it is free.

Most lines are trees. A differential ties one shaft rigidly to two others: its station turns by a sum of theirs, and is
a group that is not an unknown. ``Topology.turning`` says what every station turns by with every unknown of a
straight line.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from enum import IntEnum
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Flags, Places
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import Element, Rotor
from trunnion.driveline.gears import GearPair
from trunnion.driveline.parts import Dragged, Geared, Heavy, Jointed, Loose, Prescribed, Sprung, Tied
from trunnion.driveline.stages import PiecewiseShaft
from trunnion.driveline.torque_converters import TorqueConverter
from trunnion.equations.lossy_gears import Rub, lossy_gears, refuse_in_loops
from trunnion.errors import InputError
from trunnion.laws.harmonic import LONGEST_PERIOD, common_rate


class LinkKind(IntEnum):
    """How a station hangs on the one before it."""

    ROOT = 0
    SHAFT = 1
    JOINT = 2
    RATIO = 3
    LOOSE = 4
    SUM = 5


Plane = tuple[tuple[int, float], ...]
"""Constant-velocity joints behind the last bend, with the speeds of their shafts over that behind the last of them."""
RANK = 1e-12
"""Singular values below this share of the largest count as none."""
SELF_STRESS = 1e-9
"""Share of a torque that a loop holds in itself which counts as none."""
TIED = (LinkKind.JOINT, LinkKind.RATIO)
"""Links that tie a station rigidly to the one in front of it."""


@dataclass(frozen=True)
class Station:
    """One rotation: ``before`` is the station in front (−1 at the root), ``element`` the link's element.

    ``orders``: of the unevenness of a joint, in cycles per turn of its own shaft; ``planes``: constant-velocity joints
    between it and the bend before, which turn the plane that its own is measured from, and what their shafts' speeds
    are over its own; ``of``: stations whose rotations add up to its own, and their shares; ``spring``: which of the
    element's own it is behind.
    """

    before: int
    link: LinkKind
    element: int
    group: int
    orders: tuple[int, ...] = ()
    planes: Plane = ()
    of: tuple[tuple[int, Fraction], ...] = ()
    spring: int = 0


@dataclass(frozen=True)
class Compliance:
    """Shaft(s) in series from a station to the first of another group, or to ``far`` where they close a loop.

    ``drags`` : a damper without a spring; ``number`` : of one element, among its springs and dampers; ``converts`` :
    the torque on its near side is another one than that on its far side.
    """

    near: int
    far_group: int
    shafts: tuple[int, ...]
    far: int | None = None
    drags: bool = False
    number: int = 0
    converts: bool = False


@dataclass(frozen=True)
class Mesh:
    """A gear mesh whose stiffness or transmission error varies with its phase.

    ``compliance`` is its place, ``teeth`` how many come into mesh in a turn of the line's input; ``stiffness`` and
    ``error`` are the orders of the harmonics, in cycles per tooth.
    """

    compliance: int
    element: int
    teeth: Fraction
    stiffness: tuple[int, ...]
    error: tuple[int, ...]

    @property
    def stiffness_rates(self) -> list[Fraction]:
        """Cycles per turn of the input of the harmonics of the stiffness."""
        return [order * self.teeth for order in self.stiffness]


@dataclass(frozen=True)
class Topology:
    """Stations, groups and compliances of a line; independent of its numbers.

    ``reference[g]`` is the first station of group g; ``coordinate[g]`` its place among the unknowns, or −1
    where its rotation is prescribed. ``speed_ratio[s]`` is the mean speed of station s over the input's,
    an exact fraction. ``inertias`` are station, element and number among the element's own of every inertia, ``disks``
    station and element of those that outer torques act on, ``rotors`` these elements by name; ``meshes`` are those that
    vary with their phase. ``names`` are those of the unknowns; ``points`` are station and name of what is seen to move:
    each disk where it is, what else is heavy where none is. ``lost`` are stations and the torque [N m] by which what
    does not pass its power on resists there; ``rubs`` are gears that lose power, ``drags`` station and element of those
    whose oil resists. What follows from these is found once.
    """

    stations: tuple[Station, ...]
    compliances: tuple[Compliance, ...]
    reference: tuple[int, ...]
    coordinate: tuple[int, ...]
    prescribed: tuple[bool, ...]
    disks: tuple[tuple[int, int], ...]
    rotors: tuple[tuple[str, Rotor], ...]
    inertias: tuple[tuple[int, int, int], ...]
    speed_ratio: tuple[Fraction, ...]
    names: tuple[str, ...]
    meshes: tuple[Mesh, ...]
    points: tuple[tuple[int, str], ...]
    lost: tuple[tuple[int, float], ...] = ()
    rubs: tuple[Rub, ...] = ()
    drags: tuple[tuple[int, int], ...] = ()

    @cached_property
    def size(self) -> int:
        """Number of unknown rotations n."""
        return sum(c >= 0 for c in self.coordinate)

    @property
    def free(self) -> bool:
        """True when no rotation is prescribed, so that the line can turn as a rigid body."""
        return not any(self.prescribed)

    @cached_property
    def dragged(self) -> tuple[int, ...]:
        """Compliances that are dampers without a spring."""
        return tuple(e for e, compliance in enumerate(self.compliances) if compliance.drags)

    @cached_property
    def loose(self) -> Array:
        """Rotations (n, k), as columns, that no spring of the aligned line resists: the ``rigid`` ones, and those of
        what hangs on each of the ``dragged`` links."""
        dragged = np.zeros((self.size, len(self.dragged)))
        for k, e in enumerate(self.dragged):
            unknowns = np.unique([u for u in self.unknown_of[self.stations_behind[e]] if u >= 0])
            own = self.mean_speeds[self.reference[self.compliances[e].far_group]]
            dragged[unknowns, k] = self.mean_speeds[self.firsts][unknowns] / own
        if not self.graph:
            return _fixed(np.hstack([self.rigid, dragged]))
        # What hangs on a link may be held by springs elsewhere, and several of them may let go of more together.
        sprung = np.delete(self.elongations, self.dragged, axis=0)
        alone = np.array([self.compliances[e].far is None for e in self.dragged], dtype=bool)
        alone &= np.abs(sprung @ dragged).max(axis=0, initial=0.0) < RANK
        found = np.hstack([self.rigid, dragged[:, alone]])
        return _fixed(np.hstack([found, _null_space(np.vstack([sprung, found.T]))]))

    @property
    def still(self) -> int:
        """How many undamped modes of the aligned line do not vibrate: one for each ``loose`` rotation."""
        return int(self.loose.shape[1])

    def set_aside(self, by_speed: bool) -> int:
        """How many multipliers of a line with straight joints are exactly 1 whatever it does: for every loose rotation
        one, and for the speed of every rigid one another where no load goes ``by_speed``."""
        return self.still + (0 if by_speed else self.rigid_count)

    @cached_property
    def sums(self) -> tuple[int, ...]:
        """Stations that turn by the sum of others; a line without them is a tree."""
        return tuple(s for s, station in enumerate(self.stations) if station.link is LinkKind.SUM)

    @cached_property
    def knotted(self) -> bool:
        """Whether it is not a tree: a shaft is tied to two others, or springs close a loop."""
        return bool(self.sums) or any(c.far is not None for c in self.compliances)

    @cached_property
    def converting(self) -> tuple[int, ...]:
        """Compliances of torque converters."""
        return tuple(e for e, compliance in enumerate(self.compliances) if compliance.converts)

    @cached_property
    def graph(self) -> bool:
        """Whether equations are not those of a tree of springs: it is none, or torques act on two shafts unlike."""
        return self.knotted or bool(self.converting)

    @cached_property
    def knot(self) -> int:
        """The element that makes it a graph."""
        closing = (c.shafts[-1] for c in self.compliances if c.far is not None or c.converts)
        return self.stations[self.sums[0]].element if self.sums else next(closing)

    @cached_property
    def turning(self) -> Array:
        """Rotation of every station per rotation of every unknown (station, n), joints straight."""
        found = np.zeros((len(self.stations), self.size))
        for s, station in enumerate(self.stations):
            place = self.coordinate[station.group]
            if station.link is LinkKind.SUM:
                found[s] = sum(float(share) * found[one] for one, share in station.of)
            elif s != self.reference[station.group]:
                found[s] = found[station.before] * float(self.speed_ratio[s] / self.speed_ratio[station.before])
            elif place >= 0:
                found[s, place] = 1.0
        found.flags.writeable = False
        return found

    @cached_property
    def rigid(self) -> Array:
        """Rotations of the unknowns (n, k) that twist nothing, joints straight; first, where it can, that of the whole
        line by one at its input."""
        whole = self.mean_speeds[self.firsts][:, None] if self.free else np.zeros((self.size, 0))
        if not self.graph:
            return _fixed(whole)
        return _fixed(np.hstack([whole, _null_space(np.vstack([self.elongations, whole.T]))]))

    @property
    def rigid_count(self) -> int:
        """How many of these there are."""
        return int(self.rigid.shape[1])

    @cached_property
    def apart(self) -> Array:
        """By how much the far end of every compliance turns faster than the near one, over the speed of the input
        (compliance,): 0 but where the ratios of a loop do not come out."""
        ends = ((c.near if c.far is None else c.far, c.near) for c in self.compliances)
        return _fixed([float(self.speed_ratio[far] - self.speed_ratio[near]) for far, near in ends])

    @cached_property
    def creep(self) -> Array:
        """Mean speeds of the unknowns (n,) beyond those of their ratios, over the speed of the input, with which no
        spring of a loop winds up: what drags slips."""
        sprung = np.delete(np.arange(len(self.compliances)), self.dragged)
        return _fixed(np.linalg.lstsq(self.elongations[sprung], -self.apart[sprung], rcond=None)[0])

    @cached_property
    def in_loops(self) -> Flags:
        """Whether a compliance lies in a loop, so that its torque is not that of its loads alone (compliance,)."""
        own = _null_space(self.elongations.T)
        return np.asarray(np.abs(own).max(axis=1, initial=0.0) > SELF_STRESS)

    @cached_property
    def joints(self) -> tuple[int, ...]:
        """Stations behind a joint that does not pass rotation unchanged, in order."""
        return tuple(i for i, s in enumerate(self.stations) if s.link is LinkKind.JOINT)

    @cached_property
    def ends(self) -> tuple[tuple[int, int], ...]:
        """Places among the unknowns of the far and the near end of every compliance; −1 where prescribed."""
        return tuple((self.coordinate[c.far_group], int(self.unknown_of[c.near])) for c in self.compliances)

    @cached_property
    def firsts(self) -> list[int]:
        """The first station of each unknown's group (n,)."""
        return [self.reference[g] for g, c in enumerate(self.coordinate) if c >= 0]

    def group_of(self, station: int) -> int:
        """The group a station belongs to."""
        return self.stations[station].group

    def on_unknowns(self, parts: Array, relative: Array | None = None) -> Array:
        """What stands at stations (…, station) as the unknowns feel it: Σ part r² (…, n).

        ``relative`` (…, station) : r of every station from its group's first; by default that of straight joints.
        """
        felt = parts * (self.relative_ratios if relative is None else relative) ** 2
        found, moves = np.zeros((self.size, *felt.shape[:-1])), self.unknown_of >= 0
        np.add.at(found, self.unknown_of[moves], np.moveaxis(felt, -1, 0)[moves])
        return np.ascontiguousarray(np.moveaxis(found, 0, -1))

    @cached_property
    def mean_speeds(self) -> Array:
        """Mean speed of every station over the input's (station,)."""
        return _fixed([float(ratio) for ratio in self.speed_ratio])

    @cached_property
    def relative_ratios(self) -> Array:
        """Mean speed of every station over that of its group's first station (station,)."""
        first = [self.reference[station.group] for station in self.stations]
        return _fixed(
            [float(self.speed_ratio[s] / self.speed_ratio[f]) if s != f else 1.0 for s, f in enumerate(first)]
        )

    @cached_property
    def ratio_values(self) -> Array:
        """Input speed over output speed, on average, at each station that hangs on a Ratio or turns by itself
        (station,), infinite where it stands still; 1 elsewhere."""
        of = [s for s, station in enumerate(self.stations) if station.link in (LinkKind.RATIO, LinkKind.LOOSE)]
        found = np.ones(len(self.stations))
        for s in of:
            own, before = self.speed_ratio[s], self.speed_ratio[self.stations[s].before]
            found[s] = float(before / own) if own else np.inf
        return _fixed(found)

    @cached_property
    def unknown_of(self) -> Places:
        """Place among the unknowns of every station's group (station,); −1 where its rotation is prescribed."""
        return np.array([self.coordinate[station.group] for station in self.stations], dtype=np.intp)

    @cached_property
    def behind(self) -> dict[tuple[int, int], int]:
        """The station behind every shaft, by its element and its number there."""
        return {(one.element, one.spring): s for s, one in enumerate(self.stations) if one.link is LinkKind.SHAFT}

    @cached_property
    def stations_behind(self) -> tuple[Places, ...]:
        """Per compliance all stations that it drives: those of its far group and of every group behind that."""
        behind = [[s for s, one in enumerate(self.stations) if one.group == c.far_group] for c in self.compliances]
        into = {c.far_group: e for e, c in enumerate(self.compliances) if c.far is None}
        for e in range(len(self.compliances) - 1, -1, -1):
            before = into.get(self.group_of(self.compliances[e].near))
            if before is not None:
                behind[before] += behind[e]
        return tuple(np.array(one, dtype=np.intp) for one in behind)

    @cached_property
    def elongations(self) -> Array:
        """Twist of every compliance per rotation of every unknown (compliance, n), joints straight."""
        if self.graph:
            far_ends = [self.reference[c.far_group] if c.far is None else c.far for c in self.compliances]
            return _fixed(self.turning[far_ends] - self.turning[[c.near for c in self.compliances]])
        found = np.zeros((len(self.compliances), self.size))
        for e, (far, near) in enumerate(self.ends):
            if far >= 0:
                found[e, far] = 1.0
            if near >= 0:
                found[e, near] = -self.relative_ratios[self.compliances[e].near]
        found.flags.writeable = False
        return found

    @cached_property
    def rates(self) -> tuple[Fraction, ...]:
        """Cycles per turn of the input of everything that makes the linear coefficients vary.

        Joints excite with their orders times |speed_ratio|, and the stiffness of a mesh with its harmonics.
        """
        rates = [rate for j in self.joints for rate in self.joint_rates(j)]
        return tuple(rates + [rate for mesh in self.meshes for rate in mesh.stiffness_rates])

    def joint_rates(self, station: int) -> list[Fraction]:
        """Cycles per turn of the input of the unevenness of the joint in front of a station."""
        return [abs(order * self.speed_ratio[station]) for order in self.stations[station].orders]

    @property
    def fastest(self) -> float:
        """Cycles per turn of the input of the fastest harmonic of a mesh's stiffness; 0 without."""
        return float(max((rate for mesh in self.meshes for rate in mesh.stiffness_rates), default=0))

    def period_turns(self) -> Fraction:
        """Turns of the input after which every joint and mesh is back in phase: half a turn for joints at input speed.

        Its inverse is the greatest common divisor of the ``rates``.
        """
        return 1 / common_rate(self.rates) if self.rates else Fraction(1, 2)


def topology(line: Driveline) -> Topology:
    """Sort the elements of ``line`` into stations, groups and compliances.

    Raises
    ------
    InputError : a joint or a point between two damped shafts has no inertia to carry it, or the line has
        no inertia at all.
    """
    draft = stations_of(line)
    found = _merge_massless(line, draft)
    _require_closed(line, found)
    rubs, drags = lossy_gears(line, draft.coordinates)
    if rubs and any(c.far is not None for c in found.compliances):
        refuse_in_loops(line, rubs[0], found.knot)
    found = replace(found, rubs=rubs, drags=drags) if rubs or drags else found
    return replace(found, lost=tuple(_lost(line, found))) if found.converting else found


def _lost(line: Driveline, topo: Topology) -> Iterator[tuple[int, float]]:
    for e in topo.converting:
        compliance = topo.compliances[e]
        element = line.elements[compliance.shafts[0]]
        if isinstance(element, TorqueConverter) and element.run is not None:
            yield topo.stations[compliance.near].before, element.run.lost_torque


def require_period(line: Driveline, topo: Topology) -> Fraction:
    """Period in turns of the input, or an InputError where ratios leave none of a usable length."""
    turns = topo.period_turns()
    if turns > LONGEST_PERIOD:
        varying = [bool(topo.joints), any(mesh.stiffness for mesh in topo.meshes)]
        what = " and ".join(name for name, some in zip(("joints", "meshes"), varying, strict=True) if some)
        for i, element in enumerate(line.elements):
            rounded = [ratio for ratio in _ratios(element) if ratio.limit_denominator(12) != ratio]
            if rounded and getattr(element, "ratio", None) is not None:
                raise InputError(
                    f"{what} in front of and behind this ratio are back in phase only after {float(turns):g} "
                    "turns of the input",
                    element=line.names[i],
                    key="ratio",
                    value=float(rounded[0]),
                    remedy="give the tooth numbers, teeth_in and teeth_out, instead of a rounded ratio",
                )
        raise InputError(
            f"{what} are back in phase only after {float(turns):g} turns of the input "
            f"(at most {LONGEST_PERIOD} are followed)",
            element=next(name for name, element in line.parts if _ratios(element)),
            key="teeth_in/teeth_out",
            remedy=f"study the {what} on each side of the ratio separately",
        )
    return turns


def _ratios(element: Element) -> list[Fraction]:
    """The ratios of an element's gears."""
    return [part.ratio for part in element.parts() if isinstance(part, Geared)]


def behind_joint(stations: Sequence[Station], station: int) -> bool:
    """Whether a joint stands between a station and the first one of its group."""
    one = stations[station]
    return one.link in TIED and (one.link is LinkKind.JOINT or behind_joint(stations, one.before))


def _null_space(rows: Array) -> Array:
    """What all ``rows`` (k, n) leave free, as columns (n, m)."""
    _, size, basis = np.linalg.svd(rows)
    return np.asarray(basis[int(np.sum(size > RANK * size.max(initial=1.0))) :].T)


def _fixed(numbers: ArrayLike) -> Array:
    """As an array that nobody can change."""
    found = np.array(numbers)
    found.flags.writeable = False
    return found


@dataclass
class LineStations:
    """What the elements of a line come to, in order: its stations with their exact speeds over the input's, and the one
    ``behind`` each element; the springs between groups, the first station of each group and whether its rotation is
    prescribed; ``inertias`` as (station, element, number among its own), ``disks`` as (station, element), and what
    the rotation of an inertia is called; the stations of the ``coordinates`` of every element."""

    stations: list[Station] = field(default_factory=list)
    speed_ratio: list[Fraction] = field(default_factory=list)
    behind: list[int] = field(default_factory=list)
    compliances: list[Compliance] = field(default_factory=list)
    reference: list[int] = field(default_factory=list)
    prescribed: list[bool] = field(default_factory=list)
    disks: list[tuple[int, int]] = field(default_factory=list)
    inertias: list[tuple[int, int, int]] = field(default_factory=list)
    called: list[str] = field(default_factory=list)
    coordinates: list[tuple[int, ...]] = field(default_factory=list)

    def add(self, before: int, link: LinkKind, element: int, ratio: Fraction, **joint: Any) -> int:
        if link not in TIED:
            group = len(self.reference)
            self.reference.append(len(self.stations))
            self.prescribed.append(False)
        else:
            group = self.stations[before].group
        self.stations.append(Station(before, link, element, group, **joint))
        self.speed_ratio.append(ratio)
        return len(self.stations) - 1


def stations_of(line: Driveline, *, even: bool = False) -> LineStations:
    """The one walk along the elements of ``line``, from the input through all branches.

    ``even``: joints that pass rotation unchanged have stations too, for what turns about their axes.

    Raises
    ------
    InputError : what is not an element of a driveline.
    """
    found, coordinates = LineStations(), list[list[tuple[int, Plane]]]()
    for i, element in enumerate(line.elements):
        parent = line.parents[i]
        # Of every coordinate of the element: its station, and the joints that turn the plane behind it.
        if parent is None:
            here, plane = found.add(-1, LinkKind.ROOT, i, Fraction(1)), Plane()
        else:
            here, plane = coordinates[parent][line.hangs_on[i]]
        own, turned, heavy, springs = [here], [plane], 0, 0
        for part in element.parts():
            match part:
                case Prescribed():
                    found.prescribed[found.stations[own[0]].group] = True
                    continue
                case Heavy(at, of, loaded):
                    found.inertias.append((own[at], i, heavy))
                    found.called.append(f"{of} {line.names[i]}".lstrip())
                    found.disks += [(own[at], i)] if loaded else []
                    heavy += 1
                    continue
                case Geared(ratio, to):
                    here = found.add(own[to], LinkKind.RATIO, i, found.speed_ratio[own[to]] / ratio)
                    plane = tuple((joint, by * float(ratio)) for joint, by in turned[to])
                case Jointed(orders, to):
                    here, plane = own[to], turned[to]
                    if orders or even:
                        here = found.add(here, LinkKind.JOINT, i, found.speed_ratio[here], orders=orders, planes=plane)
                    plane = Plane() if orders else (*plane, (i, 1.0))
                case Sprung(to, _, at) if at is not None:
                    here, plane = own[at], turned[at]
                    found.compliances.append(
                        Compliance(own[to], found.stations[here].group, (i,), here, number=springs)
                    )
                    springs += 1
                case Sprung(to, closes) | Dragged(to, closes) if closes is not None:
                    end = line.index(closes)
                    here, plane = coordinates[end][line.elements[end].onward]
                    if here == own[to]:
                        raise InputError(
                            "closes onto the shaft that it starts from, and would never twist", element=line.names[i],
                            key="to", value=closes, remedy="name an element behind another spring",
                        )  # fmt: skip
                    drags, group = isinstance(part, Dragged), found.stations[here].group
                    found.compliances.append(Compliance(own[to], group, (i,), here, drags, springs))
                    springs += 1
                case Sprung(to) | Dragged(to):
                    here = found.add(own[to], LinkKind.SHAFT, i, found.speed_ratio[own[to]], spring=springs)
                    plane, drags, group = turned[to], isinstance(part, Dragged), found.stations[here].group
                    converts = isinstance(part, Dragged) and part.converts
                    found.compliances.append(
                        Compliance(own[to], group, (i,), drags=drags, number=springs, converts=converts)
                    )
                    springs += 1
                case Loose(to, speed):
                    here, plane = found.add(own[to], LinkKind.LOOSE, i, found.speed_ratio[own[to]] * speed), Plane()
                case Tied(of):
                    parts = tuple((own[to], share) for to, share in of)
                    speed = sum((share * found.speed_ratio[s] for s, share in parts), Fraction(0))
                    here, plane = found.add(parts[0][0], LinkKind.SUM, i, speed, of=parts), Plane()
            own.append(here)
            turned.append(plane)
        found.behind.append(own[element.onward])
        found.coordinates.append(tuple(own))
        coordinates.append([*zip(own, turned, strict=True)])
    return found


def _require_closed(line: Driveline, topo: Topology) -> None:
    """Refuse a loop round which the ratios do not come out where nothing slips: its springs would wind up with every
    turn."""
    if not topo.apart.any():
        return
    sprung = np.delete(np.arange(len(topo.compliances)), topo.dragged)
    left = topo.apart[sprung] + topo.elongations[sprung] @ topo.creep
    if np.abs(left).max(initial=0.0) < RANK * len(left):
        return
    compliance = next(one for one, apart in zip(topo.compliances, topo.apart, strict=True) if apart)
    turns = [float(topo.speed_ratio[s]) for s in (compliance.near, compliance.far or 0)]
    raise InputError(
        f"closes a loop whose ratios do not: its ends turn {turns[0]:.6g} and {turns[1]:.6g} times as fast as the "
        f"input, {100 * abs(turns[1] / turns[0] - 1):.3g} % apart, and wind it up by "
        f"{360 * abs(turns[1] - turns[0]):.3g} deg with every turn", element=line.names[compliance.shafts[0]], key="to",
        value=getattr(line.elements[compliance.shafts[0]], "to", None),
        remedy="check the ratios on both ways round, or give a Tyre its slip_stiffness",
    )  # fmt: skip


def _merge_massless(line: Driveline, draft: LineStations) -> Topology:
    """Join massless shafts in series and number the unknowns; refuse points that nothing can accelerate."""
    heavy = {draft.stations[s].group for s, _, _ in draft.inertias}
    heavy |= {g for g, fixed in enumerate(draft.prescribed) if fixed}
    if not any(not draft.prescribed[g] for g in heavy):
        raise InputError("has no inertia that can vibrate", element="driveline", remedy="add a Disk")
    compliances = list(draft.compliances)
    summed = {station.group for station in draft.stations if station.link is LinkKind.SUM}
    for g in summed - heavy:
        if all(draft.stations[c.near].group != g for c in compliances):
            raise _bare_leg(line, draft, g)
    for g in range(len(draft.reference)):
        if g in heavy | summed:
            continue
        into = [c for c in compliances if c.far_group == g]
        out = [c for c in compliances if draft.stations[c.near].group == g]
        plain = sum(s.group == g for s in draft.stations) == 1
        if not (plain and len(into) == 1 and len(out) == 1 and into[0].far is None):
            loose = draft.stations[draft.reference[g]].link is LinkKind.LOOSE
            raise _bare_leg(line, draft, g) if loose else _bare(line, draft, g)
        _refuse_bare_law(line, (*into[0].shafts, *out[0].shafts))
        compliances.remove(into[0])
        place = compliances.index(out[0])
        compliances[place] = Compliance(into[0].near, out[0].far_group, into[0].shafts + out[0].shafts, out[0].far)
    compliances.sort(key=lambda c: c.far_group)
    coordinate, count = [], 0
    for g in range(len(draft.reference)):
        unknown = g in heavy - summed and not draft.prescribed[g]
        coordinate.append(count if unknown else -1)
        count += unknown
    names = _names(draft, coordinate)
    return Topology(
        stations=tuple(draft.stations), compliances=tuple(compliances), reference=tuple(draft.reference),
        coordinate=tuple(coordinate), prescribed=tuple(draft.prescribed), disks=tuple(draft.disks),
        rotors=tuple(_rotors(line, draft)),
        inertias=tuple(draft.inertias), speed_ratio=tuple(draft.speed_ratio), names=tuple(names),
        meshes=tuple(_meshes(line, draft, compliances)), points=tuple(_points(line, draft, coordinate, names)),
    )  # fmt: skip


def _rotors(line: Driveline, draft: LineStations) -> Iterator[tuple[str, Rotor]]:
    for _, i in draft.disks:
        element = line.elements[i]
        assert isinstance(element, Rotor)
        yield line.names[i], element


def _points(line: Driveline, draft: LineStations, coordinate: list[int], names: list[str]) -> list[tuple[int, str]]:
    """Disks that move unevenly, held ones behind a joint among them, and the first ends of tubes without a disk."""
    moved = {g for g, fixed in enumerate(draft.prescribed) if not fixed}
    found = [
        (s, line.names[i])
        for s, i in draft.disks
        if draft.stations[s].group in moved or behind_joint(draft.stations, s)
    ]
    with_disk = {draft.stations[s].group for s, _ in draft.disks}
    found += [(draft.reference[g], names[c]) for g, c in enumerate(coordinate) if c >= 0 and g not in with_disk]
    return sorted(found, key=lambda point: point[0])


def _meshes(line: Driveline, draft: LineStations, compliances: list[Compliance]) -> Iterable[Mesh]:
    for e, compliance in enumerate(compliances):
        i = compliance.shafts[0]
        element = line.elements[i]
        if isinstance(element, GearPair) and (element.stiffness_variation or element.transmission_error):
            # Harmonics in the mesh phase go with tooth numbers, see ``GearPair``.
            teeth = abs(draft.speed_ratio[compliance.near]) * (element.teeth_out or 0)
            orders = (element.stiffness_variation, element.transmission_error)
            yield Mesh(e, i, teeth, *(tuple(int(h.order) for h in harmonics) for harmonics in orders))


def _refuse_bare_law(line: Driveline, shafts: tuple[int, ...]) -> None:
    """Springs in series become one only where they are linear."""
    for i in shafts:
        dragged = any(isinstance(part, Dragged) for part in line.elements[i].parts())
        if dragged or isinstance(line.elements[i], PiecewiseShaft | GearPair):
            where = "in front of it" if i != shafts[0] else "behind it"
            raise InputError(
                f"has no inertia {where}", element=line.names[i],
                remedy=f"put a Disk {where.removesuffix(' it')} {line.names[i]}",
            )  # fmt: skip


def _bare(line: Driveline, draft: LineStations, group: int) -> InputError:
    """What refuses a group that nothing can accelerate."""
    tied = [s.element for s in draft.stations if s.group == group and s.link in TIED]
    element = line.names[tied[0] if tied else draft.stations[draft.reference[group]].element]
    behind = next(s for s in draft.stations if s.group == group)
    if tied and behind.link is LinkKind.SHAFT and behind.element == tied[0]:
        problem, remedy = "has no inertia behind it", f"put a Disk behind {element}"
    elif tied:
        problem = "has no inertia rigidly in front of it"
        remedy = f"put a Disk in front of {element} (half its own inertia is a good start)"
    else:
        problem = "ends where there is no inertia"
        remedy = f"put a Disk behind {element}, or give the tube a density"
    return InputError(problem, element=element, remedy=remedy)


def _bare_leg(line: Driveline, draft: LineStations, group: int) -> InputError:
    """What refuses a shaft of a differential or a planetary set that nothing resists."""
    station = draft.reference[group]
    element = draft.stations[station].element
    number = 1 + sum(one.element == element and one.link is not LinkKind.ROOT for one in draft.stations[:station])
    name, legs = line.names[element], {number: leg for leg, number in line.elements[element].ports.items()}
    leg = legs.get(number, "output")
    return InputError(
        f"has no inertia on its {leg} shaft, which takes no torque then, nor do the others", element=name,
        remedy="put a Disk there" + (f', after = "{name}.{legs[number]}"' if number in legs else ""),
    )  # fmt: skip


def _names(draft: LineStations, coordinate: list[int]) -> list[str]:
    """A name per unknown: the first disk of its group, or what else carries it."""
    last_first = [*zip(draft.inertias, draft.called, strict=True)][::-1]
    disks, named = set(draft.disks), dict[int, str]()
    for (s, _, _), name in sorted(last_first, key=lambda one: one[0][:2] in disks):
        named[draft.stations[s].group] = name
    return [named[g] for g, c in enumerate(coordinate) if c >= 0]
