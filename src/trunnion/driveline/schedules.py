"""Joint angles over suspension travel, torques over speed: how numbers of a line go together in service.

::

    [[operation.schedule]]
    name = "axle travel"
    travel = ["-60 mm", "0 mm", "90 mm"]                    # rising
    angles = { "joint 2" = ["1 deg", "3 deg", "7 deg"] }    # one value for each travel

    [[operation.schedule]]
    name = "full throttle"
    speed = ["800 rpm", "1400 rpm", "2400 rpm"]
    loads = { "vehicle" = ["5 kN*m", "6.2 kN*m", "4 kN*m"] }
    factors = { "pump" = [0.2, 0.6, 1] }                    # times the torque of a machine

Between the points stated, numbers follow straight lines; beyond them a schedule says nothing. A schedule changes no
motion by itself; ``envelope`` goes by it, and ``Driveline.at_schedule`` gives the line at one of its points.
"""

from __future__ import annotations

from functools import partial
from math import inf
from typing import Annotated, Any, ClassVar

from pydantic import BeforeValidator, Field, WithJsonSchema, model_validator

from trunnion.driveline.quantities import ANGLE, LENGTH, RATIO, SPEED, TORQUE, QuantityKind, json_schema_of, parse
from trunnion.driveline.record import Name, Named, by_name
from trunnion.errors import InputError

OVER = {"travel": LENGTH, "speed": SPEED}
FOLLOWING = {"angles": ANGLE, "loads": TORQUE}
KEYS = {"angles": "angle", "loads": "load_torque"}
"""Which number of an element follows."""
FACTORS = "factors"
"""What follows beside these: factors on the torque of machines."""


def _list_of(kind: QuantityKind, value: object) -> tuple[float, ...]:
    remedy = f'write two values or more, as ["{kind.example}", …]'
    if not isinstance(value, list | tuple) or len(value) < 2:
        raise InputError("is not a list of values", value=value, remedy=remedy)
    return tuple(parse(one, kind) for one in value)


def _rising(kind: QuantityKind) -> tuple[BeforeValidator, WithJsonSchema]:
    def read(value: Any) -> tuple[float, ...] | None:
        if value is None:
            return None
        found = _list_of(kind, value)
        if not all(a < b for a, b in zip(found, found[1:], strict=False)):
            raise InputError("does not rise from value to value", value=value, remedy="put the lowest first")
        return found

    return BeforeValidator(read), WithJsonSchema({"type": "array", "items": json_schema_of(kind), "minItems": 2})


def _columns(kind: QuantityKind, key: str, owner: str) -> tuple[BeforeValidator, WithJsonSchema]:
    example = f'write {key} = {{ "{owner}" = ["{kind.example}", …] }}'

    items = {"type": "array", "items": json_schema_of(kind), "minItems": 2}
    read = by_name(key, partial(_list_of, kind), "is not a table of lists", example)
    return BeforeValidator(read), WithJsonSchema({"type": "object", "additionalProperties": items})


_READ_TRAVEL, _TRAVEL = _rising(LENGTH)
_READ_SPEED, _SPEED = _rising(SPEED)
_READ_ANGLES, _ANGLES = _columns(ANGLE, "angles", "HookeJoint 1")
_READ_LOADS, _LOADS = _columns(TORQUE, "loads", "Disk 2")
_READ_FACTORS, _FACTORS = _columns(RATIO, FACTORS, "propeller")


class Schedule(Named):
    """Numbers of elements over suspension travel or over speed.

    Parameters
    ----------
    name : what it is called.
    travel, speed : the points, rising: travel [m] of a suspension, or input speed [rad/s]; one of the two.
    angles : joint angles [rad] at the points, by the name of the joint.
    loads : load torques [N m] at the points, by the name of the Disk; positive resists rotation.
    factors : on the torque of a Fan, Pump, Propeller or Generator at the points, by its name, as of a ``LoadCase``.

    Raises
    ------
    InputError : neither or both of travel and speed; nothing that follows; lists of another length.

    >>> bends = Schedule(name="suspension", travel=["0 mm", "80 mm"], angles={"HookeJoint 1": [0.03, 0.11]})
    >>> bends.changes_at(0.04)
    {'HookeJoint 1': {'angle': 0.07}}
    """

    what: ClassVar[str] = "schedule"
    example: ClassVar[str] = 'name = "axle travel", travel = ["-60 mm", "90 mm"] and angles'

    name: Name = Field(description="what the schedule is called")
    travel: Annotated[tuple[float, ...] | None, _READ_TRAVEL, _TRAVEL] = Field(
        default=None, description="points of suspension travel, rising"
    )
    speed: Annotated[tuple[float, ...] | None, _READ_SPEED, _SPEED] = Field(
        default=None, description="points of input speed, rising"
    )
    angles: Annotated[dict[str, tuple[float, ...]], _READ_ANGLES, _ANGLES] = Field(
        default={}, description="joint angles at the points, by the name of the joint"
    )
    loads: Annotated[dict[str, tuple[float, ...]], _READ_LOADS, _LOADS] = Field(
        default={}, description="load torques at the points, by the name of the Disk; positive resists rotation"
    )

    factors: Annotated[dict[str, tuple[float, ...]], _READ_FACTORS, _FACTORS] = Field(
        default={}, description="factors on the torque of machines at the points, by the name of the machine"
    )

    @model_validator(mode="after")
    def _whole(self) -> Schedule:
        if (self.travel is None) == (self.speed is None):
            problem = "has travel and speed at once" if self.travel is not None else "has neither travel nor speed"
            raise InputError(problem, key="travel", remedy='write travel = ["-60 mm", "90 mm"], or speed')
        if not self.angles and not self.loads and not self.factors:
            raise InputError("lets nothing follow", key="angles", remedy="write angles or loads by element, or factors")
        for name, numbers in self.factors.items():
            if not min(numbers) > 0:
                remedy = "write 0.01, say, for a machine that hardly takes any torque"
                raise InputError("must be positive", key=f"{FACTORS}.{name}", value=min(numbers), remedy=remedy)
        if self.speed is not None and self.speed[0] <= 0:
            raise InputError("must be positive", key="speed", remedy="begin above standstill")
        wrong = [
            InputError(
                f"must have one value for each of {len(self.points)} points, and has {len(numbers)}",
                key=f"{key}.{name}",
                remedy="give one value for each point",
            )
            for key in (*FOLLOWING, FACTORS)
            for name, numbers in getattr(self, key).items()
            if len(numbers) != len(self.points)
        ]  # fmt: skip
        if wrong:
            raise InputError.together(wrong)
        return self

    @property
    def over(self) -> str:
        """ "travel" or "speed"."""
        return "travel" if self.travel is not None else "speed"

    @property
    def points(self) -> tuple[float, ...]:
        """Points of travel [m] or speed [rad/s] that it states."""
        return self.travel if self.travel is not None else self.speed or ()

    @property
    def elements(self) -> tuple[tuple[str, str], ...]:
        """Names of the elements that follow, and their key there."""
        return tuple((name, KEYS[key]) for key in FOLLOWING for name in getattr(self, key))

    def changes_at(self, value: float) -> dict[str, dict[str, float]]:
        """Fields by element at a travel [m] or speed [rad/s], between the points along straight lines.

        Raises
        ------
        InputError : beyond the first or the last point.
        """
        found: dict[str, dict[str, float]] = {}
        for key in FOLLOWING:
            for name, number in self._at(value, getattr(self, key)).items():
                found.setdefault(name, {})[KEYS[key]] = number
        return found

    def factors_at(self, value: float) -> dict[str, float]:
        """Factors on the torques of machines there, by name; refused as by ``changes_at``."""
        return self._at(value, self.factors)

    def _at(self, value: float, columns: dict[str, tuple[float, ...]]) -> dict[str, float]:
        import numpy as np  # a description alone loads without it

        first, last = self.points[0], self.points[-1]
        if not first <= value <= last:
            unit = OVER[self.over].unit
            problem = f"lies beyond the schedule, which goes from {first:g} to {last:g} {unit}"
            remedy = f"stay between {first:g} and {last:g} {unit}"
            raise InputError(problem, element=f"schedule {self.name}", key=self.over, value=value, remedy=remedy)
        return {name: float(np.interp(value, self.points, numbers)) for name, numbers in columns.items()}

    def between(self, points: int, low: float = -inf, high: float = inf) -> tuple[float, ...]:
        """Of the part from ``low`` to ``high`` (travel [m] or speed [rad/s]): both ends, the points stated, and as many
        more evenly between as make ``points`` or more; none where the schedule does not reach there."""
        first, last = max(self.points[0], low), min(self.points[-1], high)
        if first >= last:
            return (first,) if first == last else ()
        stated = [first, *(x for x in self.points if first < x < last), last]
        even = [first + (last - first) * i / (points - 1) for i in range(1, points - 1)]
        new = [x for x in even if min(abs(x - p) for p in stated) > 1e-9 * (last - first)]
        return tuple(sorted([*stated, *new]))
