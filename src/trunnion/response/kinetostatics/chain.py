"""A driveline as the kinetostatics see it: the stations of its topology, shafts between joints as rigid members.

A *step* leads to a station from the one in front of it; a double Cardan joint takes two, one a cross. A *member* is
everything that turns about one axis between two joints; its axis changes at every joint. A *train* is a run of members
tied by joints; a Ratio ends it, because where its gears put the next axis is not part of the description. A GearPair is
a Ratio here, rigid and in contact; a PiecewiseShaft keeps its law of stages.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from math import ceil, lcm
from typing import Any

import numpy as np

from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import ConstantSpeed, Element, Rotor
from trunnion.driveline.gears import GearPair
from trunnion.driveline.joints import DoubleCardanJoint, HookeJoint, Joint
from trunnion.driveline.loss_curves import lost_shares
from trunnion.driveline.machines import Motor
from trunnion.driveline.parameters import PackedLine, pack
from trunnion.driveline.quantities import SPEED, shown
from trunnion.driveline.refusals import nearest
from trunnion.driveline.shafts import Elastic
from trunnion.driveline.slip_clutches import SlipClutch
from trunnion.driveline.stages import PiecewiseShaft
from trunnion.equations.stage_laws import StageLaw, stage_law
from trunnion.equations.topology import LineStations, LinkKind, Station, stations_of
from trunnion.errors import InputError
from trunnion.laws import double_cardan, hooke
from trunnion.laws.fourier import FourierLaw
from trunnion.laws.joint import JointLaw
from trunnion.laws.torque_curve import PowerCurve

UNCHANGED = FourierLaw((), (), ())
"""The law of a joint that passes rotation unchanged."""


@dataclass(frozen=True)
class ChainStep:
    """From station ``parent`` to the station behind this step, by an ``element`` of the line; SI units.

    ``speed`` over the input's, on average; ``reach`` [m] is how far along its member the station lies. ``fork_offset``
    is what a shaft adds to the angle of the fork at its far end; ``law`` and ``orders`` are those of a joint, which has
    no orders where it passes rotation unchanged, and ``cross`` says that it is a Hooke's joint. Gears lose a
    share of the power that flows to the station, and another of that which comes from it: ``lost``. A Shaft has a
    ``stiffness`` [N m/rad], one with stages its law of ``stages``. ``inertia`` [kg m²], ``load`` [N m],
    ``viscous_load`` and ``quadratic_load`` are all that sits at the station.
    """

    link: LinkKind
    parent: int
    name: str
    element: int
    member: int
    speed: Fraction
    angle: float = 0.0
    plane: float = 0.0
    law: JointLaw | None = None
    orders: tuple[int, ...] = ()
    cross: bool = False
    reach: float = 0.0
    fork_offset: float = 0.0
    stiffness: float = np.inf
    stages: StageLaw | None = None
    ratio: float = 1.0
    lost: tuple[float, float] = (0.0, 0.0)
    inertia: float = 0.0
    load: float = 0.0
    viscous_load: float = 0.0
    quadratic_load: float = 0.0


@dataclass(frozen=True)
class Member:
    """A rigid shaft between joints: the joint step at its beginning (−1 at the start of a train), its mean speed over
    the input's, its shafts.

    ``length`` [m] from the joint at its beginning to the farthest point described, NaN where it is not known.
    """

    joint: int
    train: int
    speed: Fraction
    shafts: tuple[str, ...] = ()
    length: float = 0.0


@dataclass(frozen=True)
class KinematicChain:
    """Steps (``steps[0]`` is the drive), members, the line they come from and the step ``behind`` each of its elements.

    ``output`` is the element at the end that is asked about: the last, or that of a branch.
    """

    line: Driveline
    steps: tuple[ChainStep, ...]
    members: tuple[Member, ...]
    behind: tuple[int, ...]
    output: int

    @cached_property
    def shafts(self) -> tuple[int, ...]:
        """Steps that are Shafts."""
        return tuple(i for i, step in enumerate(self.steps) if step.link is LinkKind.SHAFT)

    @cached_property
    def joints(self) -> tuple[int, ...]:
        """Steps that bend the axis."""
        return tuple(i for i, step in enumerate(self.steps) if step.link is LinkKind.JOINT)

    @property
    def ends(self) -> tuple[int, ...]:
        """Elements that nothing hangs on: one for every branch, in order."""
        return tuple(i for i in range(len(self.line.elements)) if i not in self.line.parents)

    @property
    def turns(self) -> int:
        """Fewest whole turns of the input after which every joint is back in phase (half a turn of its shaft)."""
        return lcm(*((order * abs(step.speed)).denominator for step in self.steps for order in step.orders))

    @property
    def fastest(self) -> int:
        """Turns of the fastest joint in one of the input, rounded up, 1 at least."""
        return ceil(max((abs(step.speed) for step in self.steps if step.orders), default=1))

    @property
    def turns_of_the_slowest(self) -> int:
        """Fewest whole turns of the input after which every joint has been in all its phases."""
        return ceil(max((1 / (order * abs(step.speed)) for step in self.steps for order in step.orders), default=1))

    def end_behind(self, name: str, key: str = "branch") -> int:
        """The end of the branch that the element ``name`` lies on.

        Raises
        ------
        InputError : no such element, or several branches leave behind it.
        """
        names = self.line.names
        ends = {names[i]: i for i in self.ends}
        if isinstance(name, str) and name in ends:
            return ends[name]
        if name not in names:
            raise InputError("is not an element of this driveline", key=key, value=name, remedy=nearest(name, ends))
        found = [end for end, i in ends.items() if names.index(name) in self._elements_before(i)]
        if len(found) != 1:
            which = " or ".join(found) or " or ".join(ends)
            raise InputError("names no single branch", key=key, value=name, remedy=f"write {which}, where one ends")
        return ends[found[0]]

    def _elements_before(self, element: int | None) -> Iterator[int]:
        """An element and those it hangs on."""
        while element is not None:
            yield element
            element = self.line.parents[element]

    def path(self, step: int) -> tuple[int, ...]:
        """Steps from the drive to ``step``."""
        found = []
        while step > 0:
            found.append(step)
            step = self.steps[step].parent
        return tuple(reversed(found))

    @property
    def way(self) -> tuple[int, ...]:
        """Steps from the drive to the output."""
        return self.path(self.behind[self.output])


def chain(
    line: Driveline, lengths: dict[str, float] | None = None, branch: str | None = None, speed: float | None = None
) -> KinematicChain:
    """Sort ``line`` into steps and members.

    Parameters
    ----------
    lengths : joint-to-joint distance [m] by Shaft name, where the Shaft is not a tube of known length.
    branch : name of an element on the branch whose end is asked about; default the last.
    speed : of the input [rad/s], at which machines have the tangents of their torques; without it they have none.

    Raises
    ------
    InputError : the far end is prescribed as well as the near end.
    """
    for name, element in line.parts[1:]:
        if isinstance(element, ConstantSpeed):
            raise InputError(
                "prescribes the output as well as the input",
                element=name,
                remedy="replace it by a Disk with the load_torque it exerts",
            )
    stations, draft = stations_of(line, even=True), _ChainDraft(line, lengths or {}, speed)
    if knots := ties(stations):
        raise InputError(
            "ties a shaft to two others, which kinetostatics do not follow", element=line.names[knots[0]],
            remedy="leave out one leg, or one way round, and write a Ratio in its place",
        )  # fmt: skip
    step_of: list[int] = []
    for station, ratio in zip(stations.stations, stations.speed_ratio, strict=True):
        step_of.append(draft.add(station, ratio, step_of[station.before] if station.before >= 0 else -1))
    for element, own in zip(line.elements, stations.coordinates, strict=True):
        draft.lose(element, [step_of[s] for s in own])
    for s, i, number in stations.inertias:
        draft.put(step_of[s], line.elements[i], number)
    members = tuple(member if member.length > 0 else replace(member, length=np.nan) for member in draft.members)
    behind = tuple(step_of[s] for s in stations.behind)
    found = KinematicChain(line, tuple(draft.steps), members, behind, len(line.elements) - 1)
    return found if branch is None else replace(found, output=found.end_behind(branch))


def ties(stations: LineStations) -> list[int]:
    """Elements that tie a shaft to two others, differentials and what closes a loop, in order."""
    found = {station.element for station in stations.stations if station.link is LinkKind.SUM}
    found |= {compliance.shafts[0] for compliance in stations.compliances if compliance.far is not None}
    return sorted(found)


class _ChainDraft:
    def __init__(self, line: Driveline, lengths: dict[str, float], speed: float | None) -> None:
        self.line, self.lengths, self.speed = line, lengths, speed
        self.element = 0
        self.steps: list[ChainStep] = []
        self.members: list[Member] = []

    @cached_property
    def packed(self) -> PackedLine:
        """The line's numbers, for laws that are read from them."""
        return pack(self.line)

    def add(self, station: Station, speed: Fraction, parent: int) -> int:
        """The step to a station behind the step ``parent``."""
        i = self.element = station.element
        element, name = self.line.elements[i], self.line.names[i]
        if station.link is LinkKind.ROOT:
            return self._step(LinkKind.ROOT, parent, "drive", speed, Member(-1, 0, speed))
        if isinstance(element, DoubleCardanJoint):
            first, second = double_cardan.halves(element.angle, element.distance_ratio or 1.0)
            yoke = self._cross(parent, f"{name}, first cross", speed, angle=float(first), plane=element.plane)
            # The second cross hangs on the station behind the first, at the far end of the yoke.
            self._extend(yoke, f"{name}, yoke", element.yoke_length or 0.0)
            # A quarter turn back, so that the joint counts as one that passes rotation unchanged.
            return self._cross(yoke, f"{name}, second cross", speed, angle=float(second), turned=-hooke.QUARTER_TURN)
        if isinstance(element, HookeJoint):
            return self._cross(parent, name, speed, angle=element.angle, plane=element.plane)
        if isinstance(element, Joint):
            bend = {key: float(getattr(element, key, 0.0)) for key in ("angle", "plane")}
            law: JointLaw = UNCHANGED
            if element.orders:
                law = element.law(lambda key: np.asarray(self.packed.values[self.packed.column(i, key)]))
            return self._joint(parent, name, speed, law=law, orders=element.orders, **bend)
        if isinstance(element, SlipClutch):
            return parent  # sticks
        if station.link is LinkKind.RATIO:
            axis, ratio = Member(-1, self.members[-1].train + 1, speed), self.steps[parent].speed / speed
            return self._step(LinkKind.RATIO, parent, name, speed, axis, ratio=float(ratio))
        if isinstance(element, GearPair):
            return parent  # rigid and in contact
        assert isinstance(element, Elastic | PiecewiseShaft)
        name = self.line.spring_name((i,), station.spring)
        more: dict[str, Any] = {"fork_offset": getattr(element, "fork_offset", 0.0)}
        if isinstance(element, Elastic):
            # What a damper alone drags along turns with its housing in a turn.
            links = element.links(lambda key: getattr(element, key))
            more["stiffness"] = float(links[station.spring][0]) or np.inf
        else:
            more["stages"] = stage_law(self.line, i, self.packed.column, self.packed.table(1))
        here = self._step(LinkKind.SHAFT, parent, name, speed, **more)
        if element.onward == 0:  # beside the axis
            return here
        self._extend(here, name, self.lengths.get(name, getattr(element, "length", None) or 0.0))
        return here

    def put(self, step: int, element: Element, number: int) -> None:
        """One of an element's inertias, with the loads of a disk, at the station behind a step."""
        here = self.steps[step]
        here = replace(here, inertia=here.inertia + element.inertia_values[number])
        if isinstance(element, Rotor):
            load = self._load(step, element)
            here = replace(
                here, load=here.load + load.constant, viscous_load=here.viscous_load + load.viscous,
                quadratic_load=here.quadratic_load + load.quadratic,
            )  # fmt: skip
        self.steps[step] = here

    def lose(self, element: Element, own: Sequence[int]) -> None:
        """What gears lose: their drag at the step in front of them, and at the one that they drive the shares of its
        power; ``own`` are the steps of the element's coordinates."""
        here = self.steps[own[0]]
        self.steps[own[0]] = replace(here, load=here.load + float(getattr(element, "drag_torque", None) or 0.0))
        if element.losses:
            turning = [float(self.steps[step].speed) for step in own]
            shares = lost_shares(element, element.name or element.kind, turning)
            driven = own[element.losses[0].driven]
            self.steps[driven] = replace(self.steps[driven], lost=shares)

    def _load(self, step: int, rotor: Rotor) -> PowerCurve:
        """What it resists with; of another curve the tangent at the speed of the turn, nothing where none is asked for.
        Where a motor drives the turn, whatever that takes, its own torque is none of the loads."""
        drives = isinstance(rotor, Motor) and (rotor.set or step == 0)
        if drives or (rotor.tangent and self.speed is None):
            return PowerCurve()
        load = rotor.load
        if isinstance(load, PowerCurve):
            return load
        at = (self.speed or 0.0) * abs(float(self.steps[step].speed))
        value, slope = float(load.value(at)), float(load.slope(at))
        if np.isnan(value):
            raise InputError(
                f"is a curve that does not cover {shown(at, SPEED, 'rpm', 5)} of its shaft", key="curve",
                element=rotor.name or rotor.kind, remedy="add points, or ask for another speed",
            )  # fmt: skip
        return PowerCurve(value - slope * at, slope)

    def _cross(
        self, parent: int, name: str, speed: Fraction, *, angle: float, plane: float = 0.0,
        turned: float = hooke.QUARTER_TURN,
    ) -> int:  # fmt: skip
        law = hooke.law(angle, turned)
        return self._joint(parent, name, speed, law=law, orders=(2,), angle=angle, plane=plane, cross=True)

    def _joint(self, parent: int, name: str, speed: Fraction, **numbers: Any) -> int:
        axis = Member(len(self.steps), self.members[self.steps[parent].member].train, speed)
        return self._step(LinkKind.JOINT, parent, name, speed, axis, **numbers)

    def _step(
        self, link: LinkKind, parent: int, name: str, speed: Fraction, axis: Member | None = None, **numbers: Any
    ) -> int:
        """A step, on the axis of the one before it or on one of its own."""
        if axis is not None:
            self.members.append(axis)
        member = self.steps[parent].member if axis is None else len(self.members) - 1
        self.steps.append(ChainStep(link, parent, name, self.element, member, speed, **numbers))
        return len(self.steps) - 1

    def _extend(self, step: int, shaft: str, length: float) -> None:
        """Put the far end of a shaft ``length`` [m] behind its near end, and count it to its member."""
        here = self.steps[step]
        reach = length + (self.steps[here.parent].reach if here.link is LinkKind.SHAFT else 0.0)
        self.steps[step] = replace(here, reach=reach)
        member = self.members[here.member]
        self.members[here.member] = replace(member, length=max(member.length, reach), shafts=(*member.shafts, shaft))
