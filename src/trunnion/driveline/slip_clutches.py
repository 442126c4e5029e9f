"""A slip clutch in series: it sticks up to its capacity, and slips with a torque of its own beyond."""

from __future__ import annotations

from fractions import Fraction
from math import exp
from typing import Annotated, Any, ClassVar, Self

from pydantic import BeforeValidator, Field, model_validator

from trunnion.driveline.elements import Element, positive
from trunnion.driveline.parts import Dragged, Geared, Part
from trunnion.driveline.quantities import Dimensionless, Maybe, Several, Speed, Time, Torque, optional
from trunnion.driveline.record import as_tuple
from trunnion.driveline.shafts import Elastic, Numbers
from trunnion.errors import InputError

_TABLE = as_tuple("quantities", 'write clamping_times = ["0 s", "0.3 s"] and clamping_shares = [0, 1], say')


class SlipClutch(Element):
    """A friction clutch between two shafts, an overload clutch say: rigid where it sticks, a torque where it slips.

    It has no spring: while it sticks its two sides turn as one, and it carries whatever torque that takes up to its
    capacity T_s. Slipping at v it carries T_c + (T_s − T_c) e^(−|v|/v_s) against the slip (Stribeck's curve); it sticks
    again where the slip ends and the torque that holds it lies below T_s. A ``Clutch`` is another thing: dry friction
    beside a spring, as in the disk of a vehicle's clutch.

    Linear analyses take it as sticking and refuse a load beyond its capacity; ``simulate`` follows it exactly.

    Parameters
    ----------
    torque : T_s, its capacity at rest [N m].
    sliding_torque : T_c that is left at high slip speed [N m]; T_s by default.
    stribeck_speed : v_s [rad/s], over which the torque goes from T_s to T_c.
    clamping_times, clamping_shares : share of the capacity over time, as it engages or opens: times [s] from the start
        of a simulation, rising; linear between them and constant beyond. Linear analyses take the last.

    >>> clutch = SlipClutch(torque="1200 N*m", sliding_torque="900 N*m", stribeck_speed="20 rpm")
    >>> round(clutch.torque_at(1.0), 1)
    1086.1
    """

    example: ClassVar[str] = 'torque = "1200 N*m"'

    torque: Torque = Field(description="capacity at rest, beyond which it slips")
    sliding_torque: Maybe[Torque] = optional(default=None, description="left at high slip speed; the same by default")
    stribeck_speed: Maybe[Speed] = optional(
        default=None, description="slip speed over which the torque falls or rises to sliding_torque"
    )
    clamping_times: Annotated[Several[Time], BeforeValidator(_TABLE)] = optional(
        default=(), description="at which clamping_shares stand, rising"
    )
    clamping_shares: Annotated[Several[Dimensionless], BeforeValidator(_TABLE)] = optional(
        default=(), description="share of the capacity at clamping_times"
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        positive(self, "torque", "sliding_torque", "stribeck_speed")
        for key, other, example in (
            ("sliding_torque", "stribeck_speed", "900 N*m"), ("stribeck_speed", "sliding_torque", "30 rpm")
        ):  # fmt: skip
            if getattr(self, key) is None and getattr(self, other) is not None:
                raise InputError(f"is needed with {other}", key=key, remedy=f'write {key} = "{example}", say')
        self._check_table()
        return self

    def _check_table(self) -> None:
        times, shares = self.clamping_times, self.clamping_shares
        if len(times) != len(shares):
            few, many = sorted(("clamping_times", "clamping_shares"), key=lambda key: len(getattr(self, key)))
            raise InputError(
                f"are {len(getattr(self, few))} for {len(getattr(self, many))} {many}", key=few,
                remedy='write clamping_times = ["0 s", "0.3 s"] and clamping_shares = [0, 1], say',
            )  # fmt: skip
        if any(b <= a for a, b in zip(times, times[1:], strict=False)):
            remedy = "write times from the start on, each later than the one before"
            raise InputError("must rise", key="clamping_times", value=list(times), remedy=remedy)
        if shares and min(shares) < 0:
            remedy = "write 0 for an open clutch"
            raise InputError("must not be negative", key="clamping_shares", value=min(shares), remedy=remedy)

    @property
    def last_share(self) -> float:
        """Share of the capacity that it is clamped with in the end."""
        return self.clamping_shares[-1] if self.clamping_shares else 1.0

    def torque_at(self, slip: float) -> float:
        """Torque [N m] that it carries against a slip speed [rad/s], clamped as much as it can be."""
        if self.sliding_torque is None or self.stribeck_speed is None:
            return self.torque
        return self.sliding_torque + (self.torque - self.sliding_torque) * exp(-abs(slip) / self.stribeck_speed)

    def parts(self) -> tuple[Part, ...]:
        """Both sides turn as one: it sticks."""
        return (Geared(Fraction(1)),)


class Slipping(SlipClutch, Elastic):
    """The same where it may slip: two shafts that nothing but its friction joins. For equations; no file has it."""

    @property
    def kind(self) -> str:
        """That of the clutch as described."""
        return SlipClutch.__name__

    def parts(self) -> tuple[Part, ...]:
        """Each side has a rotation of its own."""
        return (Dragged(),)

    def stiffness_of(self, number: Numbers) -> Any:
        """None."""
        return 0.0

    def damping_of(self, number: Numbers) -> Any:
        """None: its friction is not a damper."""
        return 0.0
