"""Where a driveline runs: speed, ranges and load cases. Analyses take it as their default question."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from functools import partial
from typing import Annotated, Any, ClassVar, Literal, Self, TypeVar

from pydantic import BeforeValidator, Field, WithJsonSchema, field_validator, model_validator

from trunnion.driveline.duty import ROUNDING, Duty, SpeedPassage
from trunnion.driveline.quantities import (
    ANGLE,
    DEGREE,
    RATIO,
    SPEED,
    TORQUE,
    Angle,
    Dimensionless,
    Maybe,
    MaybeRange,
    QuantityKind,
    Speed,
    TableList,
    Time,
    Torque,
    json_schema_of,
    optional,
    parse,
)
from trunnion.driveline.record import Name, Named, Record, by_name, listed, one_of
from trunnion.driveline.refusals import nearest
from trunnion.driveline.rules import APPLICATIONS, Application, SwitchedOffRules
from trunnion.driveline.schedules import Schedule
from trunnion.errors import InputError

SPEED_UNITS = ("rpm", "Hz", "rad/s")


def _range_of(kind: QuantityKind, example: str) -> tuple[BeforeValidator, WithJsonSchema]:
    def read(value: Any) -> tuple[float, float]:
        remedy = f"write two values, the lower first, such as {example}"
        if not isinstance(value, list | tuple) or len(value) != 2:
            raise InputError("must have a lower and an upper end", value=value, remedy=remedy)
        low, high = parse(value[0], kind), parse(value[1], kind)
        if low == high:
            raise InputError("is a range of zero size", value=value, remedy=remedy)
        if low > high:
            raise InputError("is reversed", value=value, remedy=remedy)
        return low, high

    end = json_schema_of(kind)
    return BeforeValidator(read), WithJsonSchema(
        {"type": "array", "items": end, "minItems": 2, "maxItems": 2, "unit": kind.unit}
    )


_READ_SPEEDS, _SPEEDS_SCHEMA = _range_of(SPEED, '["300 rpm", "2400 rpm"]')
_READ_ANGLES, _ANGLES_SCHEMA = _range_of(ANGLE, '["0 deg", "15 deg"]')
SpeedRange = Annotated[tuple[Speed, Speed], _READ_SPEEDS, _SPEEDS_SCHEMA]
AngleRange = Annotated[tuple[Angle, Angle], _READ_ANGLES, _ANGLES_SCHEMA]


_TORQUES = by_name(
    "loads", partial(parse, kind=TORQUE), "is not a table of torques", 'write loads = { "Disk 2" = "250 N*m" }'
)


def _factor(value: object) -> float:
    found = parse(value, RATIO)
    if not found >= 0:
        raise InputError("must not be negative", remedy="write 0 for a machine that takes no torque")
    return found


_FACTORS = by_name("factors", _factor, "is not a table of factors", "write factors = { fan = 1.2 }")


Duties = Annotated[TableList[Duty], BeforeValidator(listed(Duty, "duty"))]


class LoadCase(Named):
    """A named set of load torques.

    Parameters
    ----------
    name : what it is called.
    loads : load torque [N m] by the name of the Disk it acts on; positive resists rotation. Disks that are
        not named keep their own.
    factors : by the name of a Fan, Pump, Propeller or Generator, what its torque is multiplied by at every speed; 0 for
        one that idles.

    >>> LoadCase(name="uphill", loads={"wheel": "400 N*m"}).loads["wheel"]
    400.0
    >>> LoadCase(name="half load", factors={"generator": 0.5}).factors["generator"]
    0.5
    """

    what: ClassVar[str] = "load case"
    example: ClassVar[str] = 'name = "full load" and loads = { "Disk 2" = "250 N*m" }'

    name: Name = Field(description="what the load case is called")
    loads: Annotated[dict[str, Torque], BeforeValidator(_TORQUES)] = optional(
        default={}, description="load torque by the name of the Disk; positive resists rotation"
    )
    factors: Annotated[dict[str, Dimensionless], BeforeValidator(_FACTORS)] = optional(
        default={}, description="on the torque of a Fan, Pump, Propeller or Generator, by its name"
    )

    @model_validator(mode="after")
    def _loads_something(self) -> Self:
        if not {"loads", "factors"} & self.model_fields_set:
            raise InputError("is missing", key="loads", remedy=f"write {self.example}, or factors = {{ fan = 1.2 }}")
        return self


class Operation(Record):
    """Where a driveline runs.

    Parameters
    ----------
    speed : input speed [rad/s].
    speed_range : lowest and highest input speed [rad/s].
    angle_range : smallest and largest joint angle of interest [rad].
    speed_unit : unit that speeds are printed in: "rpm", "Hz" or "rad/s".
    application : what the line is, "road", "steering", "pto", "mill", "ship" or "industrial": says which guidelines
        of ``assess`` decide; without it they are shown only.
    switched_off : rules that are not to judge this line, each with its reason.
    misfiring, cut_out : whether ``assess`` also puts every cylinder out of work in turn, so that its gas is compressed
        and expands again or so that nothing is left of it, as stated and under each load case.
    load_cases : named sets of load torques.
    schedules : joint angles over suspension travel, load torques over speed, for ``envelope``.
    life : operating time [s] that the line is to last.
    duty : shares of that time at constant speeds, for ``fatigue``.
    passages : runs from one speed to another, so many an hour, for ``fatigue``.

    >>> running = Operation(speed="1500 rpm", speed_range=("600 rpm", "2400 rpm"), speed_unit="rpm")
    >>> round(running.speed, 2)
    157.08
    """

    what: ClassVar[str] = "operation"

    speed: Maybe[Speed] = optional(default=None, description="input speed")
    speed_range: MaybeRange[SpeedRange] = optional(default=None, description="lowest and highest input speed")
    angle_range: MaybeRange[AngleRange] = optional(
        default=None, description="smallest and largest joint angle of interest"
    )
    speed_unit: Annotated[
        Literal["rpm", "Hz", "rad/s"],
        BeforeValidator(one_of(SPEED_UNITS, "is not a speed unit", 'write "rpm"', near=True)),
    ] = Field(default="rpm", description="unit that speeds are printed in")
    application: Application | None = Field(
        default=None,
        json_schema_extra={"enum": list(APPLICATIONS)},
        description="what the line is, which says which guidelines decide; without it they are shown only",
    )
    switched_off: SwitchedOffRules = optional(
        default=(), description="rules that are not to judge this line, each with its reason"
    )
    misfiring: bool = Field(default=False, description="judge every cylinder misfiring in turn, too")
    cut_out: bool = Field(default=False, description="judge every cylinder cut out in turn, too")
    load_cases: tuple[LoadCase, ...] = optional(default=(), description="named sets of load torques")
    schedules: tuple[Schedule, ...] = optional(default=(), description="angles over travel and torques over speed")
    life: Maybe[Time] = optional(default=None, description="operating time that the line is to last")
    duty: Duties = optional(default=(), description="shares of the operating time at constant speeds")
    passages: tuple[SpeedPassage, ...] = optional(
        default=(), description="runs from one speed to another, so many an hour"
    )

    @field_validator("speed")
    @classmethod
    def _forward(cls, speed: float | None) -> float | None:
        if speed is not None and not speed > 0:
            raise InputError("must be positive", remedy="a line at rest has no parametric excitation")
        return speed

    @model_validator(mode="after")
    def _sensible(self) -> Self:
        wrong = []
        if self.speed_range and self.speed_range[0] < 0:
            wrong.append(InputError("must not go below zero", key="speed_range", remedy='start at "0 rpm" or above'))
        if self.angle_range and not all(abs(angle) < 90 * DEGREE for angle in self.angle_range):
            remedy = 'write ["0 deg", "15 deg"], say'
            wrong.append(InputError("must stay below 90 deg", key="angle_range", remedy=remedy))
        for key, problem, names, remedy in (
            ("load_case", "is the name of {} load cases", [one.name for one in self.load_cases], "rename one of them"),
            ("schedule", "is the name of {} schedules", [one.name for one in self.schedules], "rename one of them"),
            ("passage", "is the name of {} passages", [one.name for one in self.passages], "rename one of them"),
            ("switched_off", "is switched off {} times", [one.rule for one in self.switched_off], "keep one of them"),
        ):
            for name, count in Counter(names).items():
                if count > 1:
                    wrong.append(
                        InputError(problem.format(count), element=self.what, key=key, value=name, remedy=remedy)
                    )
        wrong += self._wrong_duty()
        if wrong:
            raise InputError.together(wrong)
        return self

    def _wrong_duty(self) -> Iterator[InputError]:
        if self.life is not None and not self.life > 0:
            yield InputError("must be positive", key="life", value=self.life, remedy='write "20000 h", say')
        whole = sum(one.share for one in self.duty)
        if self.duty and abs(whole - 1) > ROUNDING:
            remedy = "let the shares of all [[operation.duty]] add up to 1, those at rest left out"
            yield InputError(
                f"has shares that add up to {whole:.6g}, not to 1", element=self.what, key="duty", remedy=remedy
            )
        known = [one.name for one in self.load_cases]
        every: list[tuple[str, str | None]] = [(f"duty {i}", one.load_case) for i, one in enumerate(self.duty, start=1)]
        every += [(f"passage {one.name}", one.load_case) for one in self.passages]
        for what, name in every:
            if name is not None and name not in known:
                problem, remedy = "is not a load case of this description", nearest(name, known)
                yield InputError(problem, element=what, key="load_case", value=name, remedy=remedy)

    def load_case(self, name: str) -> LoadCase:
        """The load case called `name`; InputError with the nearest name where there is none."""
        return _one_called(name, LoadCase, self.load_cases)

    def schedule(self, name: str) -> Schedule:
        """The schedule called `name`; InputError with the nearest name where there is none."""
        return _one_called(name, Schedule, self.schedules)


One = TypeVar("One", LoadCase, Schedule)


def _one_called(name: str, kind: type[One], known: tuple[One, ...]) -> One:
    for one in known:
        if one.name == name:
            return one
    key, remedy = kind.what.replace(" ", "_"), nearest(name, [one.name for one in known])
    raise InputError(f"is not a {kind.what} of this driveline", key=key, value=name, remedy=remedy)
