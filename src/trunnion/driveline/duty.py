"""What a line does in its life: shares of its time at constant speeds, passages from one speed to another, hours.

::

    [operation]
    life = "20000 h"

    [[operation.duty]]
    share = "60 %"                      # of the time; all shares add up to 1
    speed = "1500 rpm"
    load_case = "full load"             # as stated without one

    [[operation.duty]]
    share = "40 %"
    speed = "900 rpm"

    [[operation.passage]]               # a start, a stop, a barred range that is passed
    name = "start"
    first = "300 rpm"
    last = "1500 rpm"
    acceleration = "20 rad/s^2"
    per_hour = 0.5

It changes no motion; ``fatigue`` goes by it, and ``assess`` where an element has an S–N curve.
"""

from __future__ import annotations

from typing import ClassVar, Self

from pydantic import Field, model_validator

from trunnion.driveline.quantities import Acceleration, Dimensionless, Speed
from trunnion.driveline.record import Name, Named, Record
from trunnion.errors import InputError

ROUNDING = 1e-6
"""By how much shares may miss 1 in all: 33.3333 % three times is meant as the whole."""


class Duty(Record):
    """A share of the operating time at a constant speed.

    Parameters
    ----------
    share : of the operating time; the shares of all duties add up to 1.
    speed : input speed [rad/s].
    load_case : name of a load case of the description; None for the line as stated.

    Raises
    ------
    InputError : a share that is not above 0 and at most 1, a speed that is not positive.

    Examples
    --------
    >>> Duty(share="60 %", speed="1500 rpm").share
    0.6
    """

    what: ClassVar[str] = "duty"
    example: ClassVar[str] = 'share = "60 %" and speed = "1500 rpm"'

    share: Dimensionless = Field(description="share of the operating time")
    speed: Speed = Field(description="input speed")
    load_case: Name | None = Field(default=None, description="name of the load case; as stated without one")

    @model_validator(mode="after")
    def _sensible(self) -> Self:
        if not 0 < self.share <= 1:
            remedy = 'write "60 %", say: the shares of all duties add up to 1'
            raise InputError("must lie above 0 and not above 1", key="share", value=self.share, remedy=remedy)
        if not self.speed > 0:
            raise InputError("must be positive", key="speed", value=self.speed, remedy='write "1500 rpm", say')
        return self


class SpeedPassage(Named):
    """A run from one speed to another that comes again and again: a start, a stop, a barred range that is passed.

    Parameters
    ----------
    name : what it is called.
    first, last : input speeds [rad/s]; a lower ``last`` runs down.
    acceleration : its magnitude [rad/s²].
    per_hour : how many of them an operating hour has.
    load_case : name of a load case of the description; None for the line as stated.

    Raises
    ------
    InputError : numbers that are not positive, two equal speeds.

    Examples
    --------
    >>> start = SpeedPassage(name="start", first="300 rpm", last="1500 rpm", acceleration="20 rad/s^2", per_hour=0.5)
    >>> round(start.last, 1)
    157.1
    """

    what: ClassVar[str] = "passage"
    example: ClassVar[str] = (
        'name = "start", first = "300 rpm", last = "1500 rpm", acceleration = "20 rad/s^2" and per_hour = 0.5'
    )

    name: Name = Field(description="what the passage is called")
    first: Speed = Field(description="input speed that it begins with")
    last: Speed = Field(description="input speed that it ends with")
    acceleration: Acceleration = Field(description="magnitude of the acceleration")
    per_hour: Dimensionless = Field(description="how many of them an operating hour has")
    load_case: Name | None = Field(default=None, description="name of the load case; as stated without one")

    @model_validator(mode="after")
    def _sensible(self) -> Self:
        wrong = [
            InputError("must be positive", key=key, value=value, remedy=f"write {self.example}, say")
            for key in ("first", "last", "acceleration", "per_hour")
            if not (value := getattr(self, key)) > 0
        ]
        if self.first == self.last:
            wrong.append(InputError("is the speed that it begins with", key="last", value=self.last, remedy="raise it"))
        if wrong:
            raise InputError.together(wrong)
        return self
