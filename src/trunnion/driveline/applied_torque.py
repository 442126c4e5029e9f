"""Torques and dry friction that act on disks from outside, in a scenario or in Python."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field, model_validator

from trunnion.driveline.quantities import (
    Angle,
    Dimensionless,
    Frequency,
    Maybe,
    Power,
    Several,
    Speed,
    Time,
    Torque,
    optional,
)
from trunnion.driveline.record import Record, Switch, as_tuple, one_of
from trunnion.errors import InputError

Between = Literal["lines", "cubic", "steps"]
BETWEEN = ("lines", "cubic", "steps")
VARIABLES = ("time", "speed", "angle")
_KLOSS = ("breakdown_torque", "breakdown_slip", "synchronous_speed")
_TIMES = as_tuple("times", 'write time = ["0 s", "0.5 s"], say')
_SPEEDS = as_tuple("speeds", 'write speed = ["0 rpm", "1500 rpm"], say')
_ANGLES = as_tuple("angles", 'write angle = ["0 deg", "90 deg"], say')
_TORQUES = as_tuple("torques", 'write torque = ["0 N*m", "80 N*m"], say')
_SHARES = as_tuple("numbers", "write factor = [0, 1], say")


def _rows(value: object) -> object:
    rows = as_tuple("rows of torques", 'write table = [["0 N*m", "1 N*m"], ["2 N*m", "3 N*m"]], say')(value)
    return tuple(_TORQUES(row) for row in rows)  # type: ignore[attr-defined]


def _formula(value: object) -> object:
    if not isinstance(value, str):
        raise InputError("is not text", value=value, remedy='write formula = "300*exp(-t/0.2)*sin(314*t)", say')
    from trunnion.laws.formula import formula

    formula(value)
    return value


FormulaText = Annotated[str, BeforeValidator(_formula)]


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
    formula : instead, arithmetic of ``time`` (or t), ``speed`` and ``angle`` in SI units, with pi, sin, cos, tan, atan,
        exp, log (natural), sqrt, tanh, abs, min, max and step (0 below zero, 1 from there on).
    since, until : [s] between which a formula acts; by default always.
    corner_frequency : ν_c [rad/s]; the torque follows what is stated above with a first-order lag, Ṫ = ν_c (T₀ − T), as
        that of a converter's current loop. It begins with what it gives just before the start; one that goes with the
        speed is switched on at standstill, and begins with none.

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
    rubs: ClassVar[bool] = False
    """Whether it is a part of a friction, which its work belongs to."""
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
        Between, BeforeValidator(one_of(BETWEEN, "is not a way between points", 'write "lines"', near=True))
    ] = Field(default="lines", description="what the torque does between its points")
    hold: Switch = Field(default=False, description="whether the first and last value last beyond the points")
    breakdown_torque: Maybe[Torque] = optional(default=None, description="of an asynchronous motor")
    breakdown_slip: Maybe[Dimensionless] = optional(default=None, description="at which it gives that")
    synchronous_speed: Maybe[Speed] = optional(default=None, description="of the motor's shaft")
    factor: Annotated[Several[Dimensionless], BeforeValidator(_SHARES)] = optional(
        default=(), description="shares of the motor's torque at the points of time"
    )

    power: Maybe[Power] = optional(default=None, description="constant, between the two points of speed")
    formula: FormulaText | None = Field(default=None, description="of time, speed and angle in SI units")
    since: Maybe[Time] = optional(default=None, description="when a formula begins to act")
    until: Maybe[Time] = optional(default=None, description="when it ends")
    corner_frequency: Maybe[Frequency] = optional(
        default=None, description="above which it lags behind what is stated, first-order"
    )

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
        if self.corner_frequency is not None and not self.corner_frequency > 0:
            value = self.corner_frequency
            raise InputError("must be positive", key="corner_frequency", value=value, remedy='write "200 rad/s", say')
        given = [key for key in _KLOSS if getattr(self, key) is not None]
        if given:
            self._check_motor(given)
        elif self.power is not None:
            self._check_power()
        elif self.by_program:
            self._check_program()
        elif self.factor:
            raise InputError(
                "belongs to motors", key="factor", remedy="multiply the torques, or write breakdown_torque"
            )
        elif self.table:
            self._check_table()
        else:
            self._check_torques()
        if self.between == "steps" and self.variables != ("time",):
            raise InputError(
                "goes over time alone", key="between", value="steps", remedy='write between = "lines", or time'
            )
        if not self.by_program and (stray := next((k for k in ("since", "until") if getattr(self, k) is not None), "")):
            value = getattr(self, stray)
            raise InputError("belongs to a formula", key=stray, value=value, remedy="put it into the points of time")
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
            raise InputError(f"is needed with {given[0]}", key=missing[0], remedy=f"needed are {', '.join(_KLOSS)}")
        beside = [key for key in ("torque", "table", "speed", "angle", "power", "formula") if getattr(self, key)]
        if beside:
            raise InputError("conflicts with breakdown_torque", key=beside[0], remedy="leave one of the two out")
        slip, torque, speed = self.breakdown_slip, self.breakdown_torque, self.synchronous_speed
        assert slip is not None and torque is not None and speed is not None
        for key, value in (("breakdown_torque", torque), ("synchronous_speed", speed)):
            if not value > 0:
                remedy = "write its magnitude: it drives its disk in the sense in which that turns"
                raise InputError("must be positive", key=key, value=value, remedy=remedy)
        if not 0 < slip < 1:
            raise InputError("must lie between 0 and 1", key="breakdown_slip", value=slip, remedy="write 0.2, say")
        if len(self.factor) != len(self.time):
            problem = f"must have one value for each of {len(self.time)} points of time, and has {len(self.factor)}"
            raise InputError(problem, key="factor", remedy="give one share for each point")

    @property
    def by_program(self) -> bool:
        """Whether it is a formula, or a function in Python."""
        return self.formula is not None

    @property
    def depends(self) -> tuple[str, ...]:
        """What it depends on of "time", "speed" and "angle"."""
        if self.formula is not None:
            from trunnion.laws.formula import formula

            return formula(self.formula).depends
        if self.is_motor or self.power is not None:
            return ("time", "speed") if self.factor else ("speed",)
        return self.variables

    def _check_program(self) -> None:
        what = "formula" if self.formula is not None else "function"
        beside = next((k for k in (*VARIABLES, "torque", "table", "factor") if getattr(self, k)), "")
        if beside:
            raise InputError(f"conflicts with {what}", key=beside, remedy="leave one of the two out")
        if self.between != "lines":
            raise InputError(
                "belongs to tables", key="between", value=self.between, remedy=f"leave it out beside {what}"
            )
        if self.since is not None and self.until is not None and not self.since < self.until:
            raise InputError("must lie behind since", key="until", value=self.until, remedy="leave it out, or raise it")

    def _check_power(self) -> None:
        beside = [key for key in ("torque", "table", "time", "angle", "factor", "formula") if getattr(self, key)]
        if beside:
            raise InputError("conflicts with power", key=beside[0], remedy="leave one of the two out")
        if len(self.speed) != 2 or not self.speed[0] > 0:
            problem = "must be two positive speeds beside power"
            raise InputError(problem, key="speed", remedy='write speed = ["100 rpm", "3000 rpm"], say')
        if self.between != "lines":
            raise InputError("belongs to tables", key="between", value=self.between, remedy="leave it out beside power")

    def _check_table(self) -> None:
        if len(self.variables) != 2 or self.torque:
            raise InputError("goes over two variables", key="table", remedy="give two of time, speed and angle")
        if self.between == "cubic":
            raise InputError(
                "belongs to a table of one variable", key="between", value="cubic", remedy='write between = "lines"'
            )
        rows, columns = (len(getattr(self, key)) for key in self.variables)
        if len(self.table) != rows or any(len(row) != columns for row in self.table):
            problem = f"must have {rows} rows of {columns} torques"
            remedy = f"give one row for each {self.variables[0]}, one torque for each {self.variables[1]}"
            raise InputError(problem, key="table", remedy=remedy)

    def _check_torques(self) -> None:
        if len(self.variables) != 1:
            problem = (
                "has neither time, speed nor angle"
                if not self.variables
                else f"goes over {' and '.join(self.variables)}"
            )
            remedy = "give one of time, speed and angle, and torque; or two, and a table"
            raise InputError(problem, key="torque", remedy=remedy)
        points = getattr(self, self.variables[0])
        if len(self.torque) != len(points):
            problem = f"must have one value for each of {len(points)} points, and has {len(self.torque)}"
            raise InputError(problem, key="torque", remedy="give one torque for each point")


class TorqueFunction(AppliedTorque):
    """A torque on a disk by a function in Python, of time, speed and angle.

    Parameters
    ----------
    function : called as function(time, speed, angle) with floats in [s], [rad/s] and [rad] of the disk in its own
        sense; gives the torque [N m], positive where it drives. Where it bends or jumps the steps become short; a jump
        that is known beforehand is exact as ``since`` or ``until``.
    on : name of the disk.
    since, until : [s] between which it acts; by default always.
    torque, time, speed, angle, table, between, hold : of an ``AppliedTorque``; not beside a function.
    formula, power, factor, synchronous_speed, breakdown_torque, breakdown_slip : likewise.
    corner_frequency : [rad/s] of a first-order lag behind the function, as of an ``AppliedTorque``.

    Raises
    ------
    InputError : no function; until before since.

    Examples
    --------
    >>> import trunnion as tn
    >>> disks = tn.Disk(name="motor", inertia=0.5), tn.Disk(name="mill", inertia=2.0)
    >>> line = tn.Driveline([disks[0], tn.Shaft(stiffness=2e4, damping=40.0), disks[1]])
    >>> governor = tn.TorqueFunction(on="motor", function=lambda time, speed, angle: 20.0 * (50.0 - speed))
    >>> round(float(tn.transient(line, 2.0, torque=[governor], speed=0.0).speed[-1, 1]), 3)
    50.0
    """

    function: Callable[[float, float, float], float] = Field(description="of time, speed and angle")

    @property
    def by_program(self) -> bool:
        """Always."""
        return True

    @property
    def depends(self) -> tuple[str, ...]:
        """Anything, for all that is known."""
        return VARIABLES


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
                remedy = (
                    "write its magnitude: friction resists either way" if key == "torque" else "times count from t = 0"
                )
                raise InputError("must not be negative", key=key, value=getattr(self, key), remedy=remedy)
        if self.static is not None and self.static < self.torque:
            remedy = f"write {self.torque:g} N m or more, or leave it out"
            raise InputError("is less than in motion", key="static", value=self.static, remedy=remedy)
        return self


def scaled_torque(torque: AppliedTorque, factor: float) -> AppliedTorque:
    """A torque times a factor."""
    if (most := torque.breakdown_torque) is not None:
        return torque.but(breakdown_torque=factor * float(most))
    if torque.power is not None:
        return torque.but(power=factor * torque.power)
    if isinstance(torque, TorqueFunction):
        return torque.but(function=lambda *at: factor * torque.function(*at))
    if torque.formula is not None:
        return torque.but(formula=f"{factor!r}*({torque.formula})")
    if torque.table:
        return torque.but(table=[[factor * float(one) for one in row] for row in torque.table])  # type: ignore[arg-type]
    return torque.but(torque=[factor * float(one) for one in torque.torque])
