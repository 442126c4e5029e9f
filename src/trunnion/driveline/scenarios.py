"""What happens to a line, when and for how long: torques from outside, friction, and crossings that are watched.

::

    [[scenario]]
    name = "start"
    speed = "0 rpm"                                  # of the input when it begins
    duration = "4 s"

    [[scenario.torque]]                              # an asynchronous motor by Kloss's formula
    on = "motor"
    breakdown_torque = "300 N*m"
    breakdown_slip = 0.2
    synchronous_speed = "1500 rpm"

    [[scenario.torque]]                              # a blow of 80 ms
    on = "mill"
    time = ["0 s", "2 s", "2.08 s"]
    torque = ["0 N*m", "-400 N*m", "0 N*m"]
    between = "steps"

    [[scenario.friction]]
    on = "mill"
    torque = "20 N*m"
    static = "30 N*m"

    [[scenario.crossing]]                            # the run ends when the mill has its speed
    of = "mill"
    speed = "1450 rpm"

``tn.transient`` computes it. A torque is positive where it drives: it turns its disk in the sense in which that turns
on average. A scenario changes no other analysis.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field, model_validator

from trunnion.driveline.applied_torque import AppliedTorque, FrictionTorque
from trunnion.driveline.disturbances import Disturbance
from trunnion.driveline.elements import Element, Rotor
from trunnion.driveline.parts import Dragged, Sprung
from trunnion.driveline.quantities import Angle, Dimensionless, Maybe, Speed, TableList, Time, Torque, optional, signs
from trunnion.driveline.record import Name, Named, Record, Switch, listed, one_of
from trunnion.driveline.refusals import nearest
from trunnion.driveline.slip_clutches import SlipClutch
from trunnion.errors import InputError

_LEVELS = ("speed", "angle", "torque", "twist", "slip")


class LevelCrossing(Record):
    """A level that a disk's speed or angle, or a spring's torque, twist or rate of twist, comes to.

    Parameters
    ----------
    of : name of the disk or of the spring.
    speed, angle : level [rad/s] or [rad] of a disk, in the sense in which it turns on average.
    torque, twist, slip : level [N m], [rad] or [rad/s] of a spring; slip is the rate of its twist.
    direction : "rising", "falling" or "either".
    ends : whether the run ends there.

    Raises
    ------
    InputError : no level or several.

    Examples
    --------
    >>> import trunnion as tn
    >>> print(tn.LevelCrossing(of="mill", speed=100.0, direction="rising").label)
    speed of mill rises to 100 rad/s
    """

    what: ClassVar[str] = "crossing"
    example: ClassVar[str] = 'of = "mill" and speed = "1450 rpm"'

    of: str = Field(description="name of the disk or of the spring")
    speed: Maybe[Speed] = optional(default=None, description="level of a disk's speed")
    angle: Maybe[Angle] = optional(default=None, description="level of a disk's angle")
    torque: Maybe[Torque] = optional(default=None, description="level of a spring's torque")
    twist: Maybe[Angle] = optional(default=None, description="level of a spring's twist")
    slip: Maybe[Speed] = optional(default=None, description="level of the rate of a spring's twist")
    direction: Annotated[
        Literal["rising", "falling", "either"],
        BeforeValidator(one_of(("rising", "falling", "either"), "is not a direction", 'write "rising"', near=True)),
    ] = Field(default="either", description="in which the level is crossed")
    ends: Switch = Field(default=True, description="whether the run ends there")

    @classmethod
    def called(cls, data: dict[str, Any]) -> str:
        """What it is, and of what."""
        return f"crossing of {data['of']}" if isinstance(data.get("of"), str) else cls.what

    @property
    def key(self) -> str:
        """What of the element is watched."""
        return next(key for key in _LEVELS if getattr(self, key) is not None)

    @property
    def level(self) -> float:
        """Its value [SI]."""
        return float(getattr(self, self.key))

    @property
    def label(self) -> str:
        """What results call it."""
        kind = type(self).quantity_of(self.key)
        assert kind is not None
        way = {"rising": "rises to", "falling": "falls to", "either": "comes to"}[self.direction]
        return f"{self.key} of {self.of} {way} {self.level:.6g} {signs(kind.unit)}"

    @model_validator(mode="after")
    def _whole(self) -> LevelCrossing:
        given = [key for key in _LEVELS if getattr(self, key) is not None]
        if len(given) != 1:
            problem = "watches nothing" if not given else f"watches {' and '.join(given)}"
            raise InputError(problem, key=given[-1] if given else "speed", remedy=f"give one of {', '.join(_LEVELS)}")
        return self


_READ = {
    "disturbance": listed(Disturbance, "disturbance", owner="on"),
    "torque": listed(AppliedTorque, "torque", owner="on"),
    "friction": listed(FrictionTorque, "friction torque", owner="on"),
    "crossing": listed(LevelCrossing, "crossing", owner="of"),
}


class Scenario(Named):
    """What happens to a line when: a start, a blow, a brake.

    Parameters
    ----------
    name : what it is called.
    duration : [s].
    speed : of the input when it begins [rad/s]; 0 is standstill, negative turns backwards. By default that of the
        line's operation.
    per_hour : how many of them an operating hour has, for ``fatigue``; by default none counts.
    torque, friction, disturbance, crossing : what acts on the line, and what is watched.

    Raises
    ------
    InputError : no positive duration or number per hour.

    Examples
    --------
    >>> import trunnion as tn
    >>> start = tn.Scenario(name="start", duration="4 s", speed="0 rpm", friction=[{"on": "mill", "torque": "20 N*m"}])
    >>> start.duration, start.friction[0].torque
    (4.0, 20.0)
    """

    what: ClassVar[str] = "scenario"
    example: ClassVar[str] = 'name = "start" and duration = "4 s"'

    name: Name = Field(description="what the scenario is called")
    duration: Time = Field(description="how long it is followed")
    speed: Maybe[Speed] = optional(default=None, description="of the input when it begins; 0 is standstill")
    per_hour: Maybe[Dimensionless] = optional(default=None, description="how many of them an operating hour has")
    torque: Annotated[TableList[AppliedTorque], BeforeValidator(_READ["torque"])] = optional(
        default=(), description="torques on disks"
    )
    friction: Annotated[TableList[FrictionTorque], BeforeValidator(_READ["friction"])] = optional(
        default=(), description="dry friction on disks"
    )
    disturbance: Annotated[TableList[Disturbance], BeforeValidator(_READ["disturbance"])] = optional(
        default=(), description="what happens to disks, by name"
    )
    crossing: Annotated[TableList[LevelCrossing], BeforeValidator(_READ["crossing"])] = optional(
        default=(), description="levels that are watched"
    )

    @property
    def torques(self) -> tuple[AppliedTorque, ...]:
        """All torques on disks, those of disturbances too."""
        return (*self.torque, *(one for d in self.disturbance for one in d.torques))

    @property
    def frictions(self) -> tuple[FrictionTorque, ...]:
        """All friction on disks, that of brakes too."""
        return (*self.friction, *(one for d in self.disturbance for one in d.frictions))

    @model_validator(mode="after")
    def _sensible(self) -> Scenario:
        if self.per_hour is not None and not self.per_hour > 0:
            raise InputError("must be positive", key="per_hour", value=self.per_hour, remedy="write 0.5, say")
        if not self.duration > 0:
            raise InputError("must be positive", key="duration", value=self.duration, remedy='write "4 s", say')
        return self


Scenarios = Annotated[tuple[Scenario, ...], BeforeValidator(listed(Scenario, "scenario", owner="name"))]


def wrong_scenarios(scenarios: Sequence[Scenario], parts: Sequence[tuple[str, Element]]) -> Iterator[InputError]:
    """Names twice; what acts on no disk, or watches what is not there."""
    seen: set[str] = set()
    for one in scenarios:
        where = f"scenario {one.name}"
        if one.name in seen:
            yield InputError(
                "is the name of two scenarios", key="scenario", value=one.name, remedy="rename one of them"
            )
        seen.add(one.name)
        yield from wrong_places_of(one.torque, one.friction, one.crossing, parts, where, one.disturbance)


def wrong_places_of(
    torque: Sequence[AppliedTorque],
    friction: Sequence[FrictionTorque],
    crossing: Sequence[LevelCrossing],
    parts: Sequence[tuple[str, Element]],
    where: str = "",
    disturbance: Sequence[Disturbance] = (),
) -> Iterator[InputError]:
    """What acts on no disk, or watches what is not there; ``where`` it stands."""
    disks = [name for name, element in parts if isinstance(element, Rotor)]
    engines = {element.part_of[0]: None for _, element in parts if element.part_of is not None}
    driven = [*disks, *engines]
    springs = [
        name
        for name, element in parts
        if isinstance(element, SlipClutch) or any(isinstance(part, Sprung | Dragged) for part in element.parts())
    ]
    for kind, named, known, what in (
        *(("torque on", one.on, driven, "is not a Disk of this driveline") for one in torque),
        *(("disturbance on", one.on, driven, "is not a Disk of this driveline") for one in disturbance),
        *(("friction on", one.on, driven, "is not a Disk of this driveline") for one in friction),
        *(
            ("crossing of", one.of, disks, "is not a Disk of this driveline")
            if one.key in ("speed", "angle")
            else ("crossing of", one.of, springs, "is not a spring of this driveline")
            for one in crossing
        ),
    ):
        if named not in known:
            element = f"{where}, {kind.split()[0]}" if where else kind.split()[0]
            yield InputError(what, element=element, key=kind.split()[1], value=named, remedy=nearest(named, known))
