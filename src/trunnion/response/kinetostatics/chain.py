"""A driveline as the kinetostatics see it: one step per element, shafts between joints as rigid members.

A *step* leads from the station in front of an element to the one behind it. A *member* is everything that
turns about one axis between two joints; its axis changes at every joint. A *train* is a run of members tied
by joints; a Ratio ends it, because where its gears put the next axis is not part of the description. A GearPair is
a Ratio here, rigid and in contact; a PiecewiseShaft keeps its law of stages.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum
from fractions import Fraction
from math import lcm
from typing import Any

import numpy as np

from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import ConstantSpeed, Disk, Ratio
from trunnion.driveline.gears import GearPair
from trunnion.driveline.joints import DoubleCardanJoint, HookeJoint, Joint
from trunnion.driveline.parameters import pack
from trunnion.driveline.refusals import nearest
from trunnion.driveline.shafts import Spring
from trunnion.driveline.stages import PiecewiseShaft
from trunnion.equations.stage_laws import StageLaw, stage_law
from trunnion.errors import InputError
from trunnion.laws import double_cardan, hooke
from trunnion.laws.fourier import FourierLaw
from trunnion.laws.joint import JointLaw

UNCHANGED = FourierLaw((), (), ())
"""The law of a joint that passes rotation unchanged."""


class Link(Enum):
    """What a step does to the rotation."""

    ROOT = "drive"
    RIGID = "rigid"
    SHAFT = "shaft"
    HOOKE = "Hooke's joint"
    JOINT = "other joint"
    RATIO = "ratio"


@dataclass(frozen=True)
class Step:
    """From station ``parent`` to the station behind this step; SI units.

    ``reach`` [m] is how far along its member the station behind lies. ``fork_offset`` is what a shaft adds to the
    angle of the fork at its far end; ``law`` and ``orders`` are those of a joint, which has no orders where it passes
    rotation unchanged;
    ``near_inertia`` and ``far_inertia`` [kg m²] sit at the two stations; ``ratio`` is input speed over output
    speed; ``load``, ``viscous_load`` and ``quadratic_load`` are a Disk's. A Shaft has a ``stiffness`` [N m/rad], one
    with stages its law of ``stages``.
    """

    link: Link
    parent: int
    name: str
    member: int
    angle: float = 0.0
    plane: float = 0.0
    law: JointLaw | None = None
    orders: tuple[int, ...] = ()
    reach: float = 0.0
    fork_offset: float = 0.0
    stiffness: float = np.inf
    stages: StageLaw | None = None
    ratio: float = 1.0
    near_inertia: float = 0.0
    far_inertia: float = 0.0
    load: float = 0.0
    viscous_load: float = 0.0
    quadratic_load: float = 0.0


@dataclass(frozen=True)
class Member:
    """A rigid shaft between joints: the joint step at its beginning (−1 at the start of a train), its shafts.

    ``length`` [m] from the joint at its beginning to the farthest point described, NaN where it is not known.
    """

    joint: int
    train: int
    shafts: tuple[str, ...] = ()
    length: float = 0.0


@dataclass(frozen=True)
class Chain:
    """Steps (``steps[0]`` is the drive), members and the line they come from.

    ``output`` is the step at the end that is asked about: the last, or that of a branch.
    """

    line: Driveline
    steps: tuple[Step, ...]
    members: tuple[Member, ...]
    output: int

    def of(self, *links: Link) -> tuple[int, ...]:
        """Steps of these kinds, in order."""
        return tuple(i for i, step in enumerate(self.steps) if step.link in links)

    @property
    def shafts(self) -> tuple[int, ...]:
        """Steps that are Shafts."""
        return self.of(Link.SHAFT)

    @property
    def joints(self) -> tuple[int, ...]:
        """Steps that bend the axis."""
        return self.of(Link.HOOKE, Link.JOINT)

    @property
    def uneven(self) -> tuple[int, ...]:
        """Steps that pass rotation on unevenly."""
        return tuple(i for i, step in enumerate(self.steps) if step.orders)

    @property
    def ends(self) -> tuple[int, ...]:
        """Steps that nothing hangs on: one for every branch, in order."""
        parents = {step.parent for step in self.steps}
        return tuple(i for i in range(len(self.steps)) if i not in parents)

    def end_behind(self, name: str, key: str = "branch") -> int:
        """The end of the branch that the element ``name`` lies on.

        Raises
        ------
        InputError : no such element, or several branches leave behind it.
        """
        ends = {self.steps[i].name: i for i in self.ends}
        if isinstance(name, str) and name in ends:
            return ends[name]
        if name not in self.line.names:
            raise InputError("is not an element of this driveline", key=key, value=name, remedy=nearest(name, ends))
        found = [end for end, i in ends.items() if name in {self.steps[k].name for k in self.path(i)}]
        if len(found) != 1:
            which = " or ".join(found) or " or ".join(ends)
            raise InputError("names no single branch", key=key, value=name, remedy=f"write {which}, where one ends")
        return ends[found[0]]

    def path(self, end: int) -> tuple[int, ...]:
        """Steps from the drive to step ``end``."""
        found = []
        while end > 0:
            found.append(end)
            end = self.steps[end].parent
        return tuple(reversed(found))

    def mean_ratio(self, station: int) -> float:
        """Mean speed at a station over the input speed (only Ratios change it)."""
        value = 1.0
        while station > 0:
            value /= self.steps[station].ratio
            station = self.steps[station].parent
        return value


def member_ratio(chain: Chain, member: int) -> float:
    """Mean speed of a member over the input speed."""
    return chain.mean_ratio(next(i for i, step in enumerate(chain.steps) if step.member == member))


def period_turns(chain: Chain) -> int:
    """Fewest whole turns of the input after which every joint is back in phase (half a turn of its shaft)."""
    fractions = {
        n: e.fraction
        for n, e in zip(chain.line.names, chain.line.elements, strict=True)
        if isinstance(e, Ratio | GearPair)
    }
    ratio, period = [Fraction(1)], 1
    for step in chain.steps[1:]:
        ratio.append(ratio[step.parent] / fractions.get(step.name, Fraction(1)))
        for order in step.orders:
            period = lcm(period, (order * abs(ratio[-1])).denominator)
    return period


def chain(line: Driveline, lengths: dict[str, float] | None = None, branch: str | None = None) -> Chain:
    """Sort ``line`` into steps and members.

    Parameters
    ----------
    lengths : joint-to-joint distance [m] by Shaft name, where the Shaft is not a tube of known length.
    branch : name of an element on the branch whose end is asked about; default the last.

    Raises
    ------
    InputError : the far end is prescribed as well as the near end.
    """
    draft = _Draft(line, lengths or {})
    for i in range(len(line.elements)):
        draft.add(i)
    members = tuple(member if member.length > 0 else replace(member, length=np.nan) for member in draft.members)
    found = Chain(line, tuple(draft.steps), members, len(draft.steps) - 1)
    return found if branch is None else replace(found, output=found.end_behind(branch))


class _Draft:
    def __init__(self, line: Driveline, lengths: dict[str, float]) -> None:
        self.line, self.lengths = line, lengths
        self.steps = [Step(Link.ROOT, -1, "drive", 0)]
        self.members = [Member(-1, 0)]
        self.behind: list[int] = []

    def add(self, i: int) -> None:
        element, name, parent = self.line.elements[i], self.line.names[i], self.line.parents[i]
        here = 0 if parent is None else self.behind[parent]
        member = self.steps[here].member
        if isinstance(element, Spring):
            half, length = element.moment_of_inertia / 2, getattr(element, "length", None) or 0.0
            here = self._shaft(
                here, name, length, fork_offset=element.fork_offset, stiffness=element.torsional_stiffness,
                near_inertia=half, far_inertia=half,
            )  # fmt: skip
        elif isinstance(element, PiecewiseShaft):
            packed = pack(self.line)
            stages = stage_law(self.line, i, packed.column, packed.table(1))
            here = self._shaft(here, name, 0.0, fork_offset=element.fork_offset, stages=stages)
        elif isinstance(element, Disk):
            here = self._step(
                Link.RIGID, here, name, member, far_inertia=element.moment_of_inertia, load=element.load_torque,
                viscous_load=element.viscous_load, quadratic_load=element.quadratic_load,
            )  # fmt: skip
        elif isinstance(element, DoubleCardanJoint):
            first, second = double_cardan.halves(element.angle, element.distance_ratio or 1.0)
            here = self._cross(here, f"{name}, first cross", angle=float(first), plane=element.plane)
            self._name(len(self.members) - 1, f"{name}, yoke")
            # the second cross hangs on the station behind the first, at the far end of the yoke
            self._extend(here, element.yoke_length or 0.0)
            # a quarter turn back, so that the joint counts as one that passes rotation unchanged
            here = self._cross(here, f"{name}, second cross", angle=float(second), turned=-hooke.QUARTER_TURN)
        elif isinstance(element, HookeJoint):
            here = self._cross(here, name, angle=element.angle, plane=element.plane)
        elif isinstance(element, Joint):
            bend = {key: float(getattr(element, key, 0.0)) for key in ("angle", "plane")}
            law: JointLaw = UNCHANGED
            if element.orders:
                packed = pack(self.line)
                law = element.law(lambda key: np.asarray(packed.values[packed.column(i, key)]))
            here = self._joint(Link.JOINT, here, name, law=law, orders=element.orders, **bend)
        elif isinstance(element, Ratio | GearPair):
            self.members.append(Member(-1, self.members[-1].train + 1))
            here = self._step(Link.RATIO, here, name, len(self.members) - 1, ratio=element.speed_ratio)
        elif isinstance(element, ConstantSpeed):
            if i > 0:
                raise InputError(
                    "prescribes the output as well as the input",
                    element=name,
                    remedy="replace it by a Disk with the load_torque it exerts",
                )
            here = self._step(Link.RIGID, here, name, member)
        else:
            raise InputError("is not an element the kinetostatics know", element=name)
        self.behind.append(here)

    def _shaft(self, parent: int, name: str, length: float, **numbers: Any) -> int:
        here = self._step(Link.SHAFT, parent, name, self.steps[parent].member, **numbers)
        self._name(self.steps[here].member, name)
        self._extend(here, self.lengths.get(name, length))
        return here

    def _name(self, member: int, shaft: str) -> None:
        """A shaft that is part of a member."""
        self.members[member] = replace(self.members[member], shafts=(*self.members[member].shafts, shaft))

    def _cross(
        self, parent: int, name: str, *, angle: float, plane: float = 0.0, turned: float = hooke.QUARTER_TURN
    ) -> int:
        law = hooke.law(angle, turned)
        return self._joint(Link.HOOKE, parent, name, law=law, orders=(2,), angle=angle, plane=plane)

    def _joint(self, link: Link, parent: int, name: str, **numbers: Any) -> int:
        train = self.members[self.steps[parent].member].train
        self.members.append(Member(len(self.steps), train))
        return self._step(link, parent, name, len(self.members) - 1, **numbers)

    def _extend(self, step: int, length: float) -> None:
        """Put the far end of a shaft ``length`` [m] behind its near end."""
        here = self.steps[step]
        reach = length + (self.steps[here.parent].reach if here.link is Link.SHAFT else 0.0)
        self.steps[step] = replace(here, reach=reach)
        member = self.members[here.member]
        self.members[here.member] = replace(member, length=max(member.length, reach))

    def _step(self, link: Link, parent: int, name: str, member: int, **more: Any) -> int:
        if link is Link.RIGID:
            more["reach"] = self.steps[parent].reach
        self.steps.append(Step(link, parent, name, member, **more))
        return len(self.steps) - 1
