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

from trunnion.driveline.elements import Element, Rotor
from trunnion.driveline.parts import Dragged, Sprung
from trunnion.driveline.quantities import (
    Angle,
    Dimensionless,
    Maybe,
    Power,
    Several,
    Speed,
    TableList,
    Time,
    Torque,
    optional,
)
from trunnion.driveline.record import Name, Named, Record, as_tuple, listed, one_of
from trunnion.driveline.refusals import nearest
from trunnion.driveline.slip_clutches import SlipClutch
from trunnion.errors import InputError

Between = Literal["lines", "cubic", "steps"]
BETWEEN = ("lines", "cubic", "steps")
VARIABLES = ("time", "speed", "angle")
_KLOSS = ("breakdown_torque", "breakdown_slip", "synchronous_speed")
_LEVELS = ("speed", "angle", "torque", "twist", "slip")
_TIMES = as_tuple("times", 'write time = ["0 s", "0.5 s"], say')
_SPEEDS = as_tuple("speeds", 'write speed = ["0 rpm", "1500 rpm"], say')
_ANGLES = as_tuple("angles", 'write angle = ["0 deg", "90 deg"], say')
_TORQUES = as_tuple("torques", 'write torque = ["0 N*m", "80 N*m"], say')
_SHARES = as_tuple("numbers", "write factor = [0, 1], say")


def _rows(value: object) -> object:
    rows = as_tuple("rows of torques", 'write table = [["0 N*m", "1 N*m"], ["2 N*m", "3 N*m"]], say')(value)
    return tuple(_TORQUES(row) for row in rows)  # type: ignore[attr-defined]


class AppliedTorque(Record):
    """A torque on a disk over time, over the disk's own speed or angle, or over two of them; or a motor's.

    Parameters
    ----------
    on : name of the disk.
    time, speed, angle : [s], [rad/s], [rad] of the disk, rising; one of them, or two for a ``table``. Times may repeat
        once, where the torque jumps. Angles count from 0 of the line's rotation: at t = 0 the disk stands at ``phase``
        times its speed over that of the input.
    torque : [N m] at those points; positive drives.
    table : of two variables, one row of torques [N m] for each point of the first.
    between : "lines"; "cubic", monotone as ``scipy``'s ``PchipInterpolator``; over time also "steps", each value
        lasting until the next point and the last for ever, nothing before the first.
    hold : whether the first and last value last beyond the points; else the torque says nothing there.
    breakdown_torque, breakdown_slip, synchronous_speed : [N m], 1, [rad/s]; instead, an asynchronous motor,
        T = 2 T_b s s_b/(s² + s_b²) with the slip s = 1 − ω/ω_s (Kloss).
    factor : of such a motor, shares of its torque at the points ``time``: a supply that comes and goes.
    power : [W]; instead, constant power between the two points of ``speed``, T = P/ω; negative where it takes power.

    Raises
    ------
    InputError : no table or two; points that do not rise; another number of torques than points.

    Examples
    --------
    >>> import trunnion as tn
    >>> blow = tn.AppliedTorque(on="mill", time=["0 s", "20 ms", "100 ms"], torque=[0, "-400 N*m", 0], between="steps")
    >>> blow.time, blow.torque
    ((0.0, 0.02, 0.1), (0.0, -400.0, 0.0))
    """

    what: ClassVar[str] = "torque"
    below: ClassVar[bool] = False
    """Whether the first value lasts below the points, as that of a machine's curve does from standstill on."""
    example: ClassVar[str] = 'on = "motor", time = ["0 s", "1 s"] and torque = ["0 N*m", "80 N*m"]'

    on: str = Field(description="name of the disk that it acts on")
    time: Annotated[Several[Time], BeforeValidator(_TIMES)] = optional(default=(), description="points of time")
    speed: Annotated[Several[Speed], BeforeValidator(_SPEEDS)] = optional(
        default=(), description="points of the disk's own speed"
    )
    angle: Annotated[Several[Angle], BeforeValidator(_ANGLES)] = optional(
        default=(), description="points of the disk's own angle"
    )
    torque: Annotated[Several[Torque], BeforeValidator(_TORQUES)] = optional(
        default=(), description="at the points; positive drives"
    )
    table: Annotated[tuple[tuple[Torque, ...], ...], BeforeValidator(_rows)] = optional(
        default=(), description="over two variables, one row for each point of the first"
    )
    between: Annotated[
        Between, BeforeValidator(one_of(BETWEEN, "is no way between points", 'write "lines"', near=True))
    ] = Field(default="lines", description="what the torque does between its points")
    hold: bool = Field(default=False, description="whether the first and last value last beyond the points")
    breakdown_torque: Maybe[Torque] = optional(default=None, description="of an asynchronous motor")
    breakdown_slip: Maybe[Dimensionless] = optional(default=None, description="at which it gives that")
    synchronous_speed: Maybe[Speed] = optional(default=None, description="of the motor's shaft")
    factor: Annotated[Several[Dimensionless], BeforeValidator(_SHARES)] = optional(
        default=(), description="shares of the motor's torque at the points of time"
    )

    power: Maybe[Power] = optional(default=None, description="constant, between the two points of speed")

    @classmethod
    def called(cls, data: dict[str, Any]) -> str:
        """What it is, and where it acts."""
        return f"torque on {data['on']}" if isinstance(data.get("on"), str) else cls.what

    @property
    def variables(self) -> tuple[str, ...]:
        """What it goes over by tables, in the order time, speed, angle."""
        return tuple(key for key in VARIABLES if getattr(self, key))

    @property
    def is_motor(self) -> bool:
        """Whether it follows Kloss's formula."""
        return self.breakdown_torque is not None

    @model_validator(mode="after")
    def _whole(self) -> AppliedTorque:
        for key in self.variables:
            self._check_points(key)
        given = [key for key in _KLOSS if getattr(self, key) is not None]
        if given:
            self._check_motor(given)
        elif self.power is not None:
            self._check_power()
        elif self.factor:
            raise InputError("is of motors", key="factor", remedy="multiply the torques, or write breakdown_torque")
        elif self.table:
            self._check_table()
        else:
            self._check_torques()
        if self.between == "steps" and self.variables != ("time",):
            raise InputError(
                "goes over time alone", key="between", value="steps", remedy='write between = "lines", or time'
            )
        return self

    def _check_points(self, key: str) -> None:
        points = getattr(self, key)
        if len(points) < 2 and self.between != "steps":
            raise InputError("has one point only", key=key, value=points[0], remedy="give two or more")
        twice = key == "time" and self.between == "lines" and not self.table
        for i, (a, b) in enumerate(zip(points, points[1:], strict=False)):
            if b < a or (b == a and (not twice or points[i + 2 : i + 3] == (b,))):
                remedy = "put the lowest first, each once"
                if twice:
                    remedy += ", or twice where the torque jumps"
                raise InputError(f"does not rise at point {i + 2}", key=key, value=b, remedy=remedy)

    def _check_motor(self, given: list[str]) -> None:
        missing = [key for key in _KLOSS if key not in given]
        if missing:
            raise InputError(f"is missing beside {given[0]}", key=missing[0], remedy=f"needed are {', '.join(_KLOSS)}")
        beside = [key for key in ("torque", "table", "speed", "angle") if getattr(self, key)]
        if beside:
            raise InputError("stands beside breakdown_torque", key=beside[0], remedy="leave one of the two out")
        slip, torque, speed = self.breakdown_slip, self.breakdown_torque, self.synchronous_speed
        assert slip is not None and torque is not None and speed is not None
        for key, value in (("breakdown_torque", torque), ("synchronous_speed", speed)):
            if not value > 0:
                raise InputError("must be positive", key=key, value=value)
        if not 0 < slip < 1:
            raise InputError("must lie between 0 and 1", key="breakdown_slip", value=slip, remedy="write 0.2, say")
        if len(self.factor) != len(self.time):
            problem = f"has {len(self.factor)} values for {len(self.time)} points of time"
            raise InputError(problem, key="factor", remedy="give one share for each point")

    def _check_power(self) -> None:
        beside = [key for key in ("torque", "table", "time", "angle", "factor") if getattr(self, key)]
        if beside:
            raise InputError("stands beside power", key=beside[0], remedy="leave one of the two out")
        if len(self.speed) != 2 or not self.speed[0] > 0:
            problem = "must be two positive speeds beside power"
            raise InputError(problem, key="speed", remedy='write speed = ["100 rpm", "3000 rpm"], say')
        if self.between != "lines":
            raise InputError("is of tables", key="between", value=self.between, remedy="leave it out beside power")

    def _check_table(self) -> None:
        if len(self.variables) != 2 or self.torque:
            raise InputError("goes over two variables", key="table", remedy="give two of time, speed and angle")
        if self.between == "cubic":
            raise InputError("is of one variable", key="between", value="cubic", remedy='write between = "lines"')
        rows, columns = (len(getattr(self, key)) for key in self.variables)
        if len(self.table) != rows or any(len(row) != columns for row in self.table):
            problem = f"has not {rows} rows of {columns} torques"
            remedy = f"give one row for each {self.variables[0]}, one torque for each {self.variables[1]}"
            raise InputError(problem, key="table", remedy=remedy)

    def _check_torques(self) -> None:
        if len(self.variables) != 1:
            problem = "goes over nothing" if not self.variables else f"goes over {' and '.join(self.variables)}"
            remedy = "give one of time, speed and angle, and torque; or two, and a table"
            raise InputError(problem, key="torque", remedy=remedy)
        points = getattr(self, self.variables[0])
        if len(self.torque) != len(points):
            problem = f"has {len(self.torque)} values for {len(points)} points"
            raise InputError(problem, key="torque", remedy="give one torque for each point")


class FrictionTorque(Record):
    """Dry friction that resists a disk, whichever way it turns, and keeps it at rest: a bearing, a brake.

    Parameters
    ----------
    on : name of the disk.
    torque : [N m] while it turns.
    static : [N m] up to which it keeps the disk at rest; by default the same.
    since : [s] when it sets in.
    rise : [s] over which it grows from nothing.

    Raises
    ------
    InputError : negative torque; less at rest than in motion.

    Examples
    --------
    >>> import trunnion as tn
    >>> tn.FrictionTorque(on="mill", torque="20 N*m", static="30 N*m").at_rest
    30.0
    """

    what: ClassVar[str] = "friction"
    example: ClassVar[str] = 'on = "mill" and torque = "20 N*m"'

    on: str = Field(description="name of the disk that it acts on")
    torque: Torque = Field(description="while the disk turns")
    static: Maybe[Torque] = optional(default=None, description="up to which it keeps the disk at rest")
    since: Time = optional(default=0.0, description="when it sets in")
    rise: Time = optional(default=0.0, description="over which it grows from nothing")

    @classmethod
    def called(cls, data: dict[str, Any]) -> str:
        """What it is, and where it acts."""
        return f"friction on {data['on']}" if isinstance(data.get("on"), str) else cls.what

    @property
    def at_rest(self) -> float:
        """[N m] up to which it keeps the disk at rest."""
        return self.torque if self.static is None else self.static

    @model_validator(mode="after")
    def _whole(self) -> FrictionTorque:
        for key in ("torque", "since", "rise"):
            if getattr(self, key) < 0:
                raise InputError("must not be negative", key=key, value=getattr(self, key))
        if self.static is not None and self.static < self.torque:
            remedy = f"write {self.torque:g} N*m or more, or leave it out"
            raise InputError("is less than in motion", key="static", value=self.static, remedy=remedy)
        return self


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
    ends: bool = Field(default=True, description="whether the run ends there")

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
        return f"{self.key} of {self.of} {way} {self.level:.6g} {kind.unit}"

    @model_validator(mode="after")
    def _whole(self) -> LevelCrossing:
        given = [key for key in _LEVELS if getattr(self, key) is not None]
        if len(given) != 1:
            problem = "watches nothing" if not given else f"watches {' and '.join(given)}"
            raise InputError(problem, key=given[-1] if given else "speed", remedy=f"give one of {', '.join(_LEVELS)}")
        return self


_READ = {
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
    torque, friction, crossing : what acts on the line, and what is watched.

    Raises
    ------
    InputError : no positive duration.

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
    torque: Annotated[TableList[AppliedTorque], BeforeValidator(_READ["torque"])] = optional(
        default=(), description="torques on disks"
    )
    friction: Annotated[TableList[FrictionTorque], BeforeValidator(_READ["friction"])] = optional(
        default=(), description="dry friction on disks"
    )
    crossing: Annotated[TableList[LevelCrossing], BeforeValidator(_READ["crossing"])] = optional(
        default=(), description="levels that are watched"
    )

    @model_validator(mode="after")
    def _sensible(self) -> Scenario:
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
            yield InputError("names two scenarios", key="scenario", value=one.name, remedy="rename one of them")
        seen.add(one.name)
        yield from wrong_places_of(one.torque, one.friction, one.crossing, parts, where)


def wrong_places_of(
    torque: Sequence[AppliedTorque],
    friction: Sequence[FrictionTorque],
    crossing: Sequence[LevelCrossing],
    parts: Sequence[tuple[str, Element]],
    where: str = "",
) -> Iterator[InputError]:
    """What acts on no disk, or watches what is not there; ``where`` it stands."""
    disks = [name for name, element in parts if isinstance(element, Rotor)]
    springs = [
        name
        for name, element in parts
        if isinstance(element, SlipClutch) or any(isinstance(part, Sprung | Dragged) for part in element.parts())
    ]
    for kind, named, known, what in (
        *(("torque on", one.on, disks, "is not a Disk of this driveline") for one in torque),
        *(("friction on", one.on, disks, "is not a Disk of this driveline") for one in friction),
        *(
            ("crossing of", one.of, disks, "is not a Disk of this driveline")
            if one.key in ("speed", "angle")
            else ("crossing of", one.of, springs, "is no spring of this driveline")
            for one in crossing
        ),
    ):
        if named not in known:
            element = f"{where}, {kind.split()[0]}" if where else kind.split()[0]
            yield InputError(what, element=element, key=kind.split()[1], value=named, remedy=nearest(named, known))
