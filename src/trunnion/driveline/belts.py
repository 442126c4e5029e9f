"""A belt or a chain over two pulleys."""

from __future__ import annotations

from fractions import Fraction
from typing import Any, ClassVar, Self

from pydantic import Field, model_validator

from trunnion.driveline.elements import can_lose, not_negative, one_mesh, positive
from trunnion.driveline.gear_losses import RATING, MeshLoss
from trunnion.driveline.parts import Geared, Heavy, Numbers, Part, Sprung
from trunnion.driveline.quantities import (
    Damping,
    Dimensionless,
    Inertia,
    Length,
    Maybe,
    MeshStiffness,
    Power,
    Torque,
    optional,
)
from trunnion.driveline.shafts import Elastic

SPANS = 2


class Belt(Elastic):
    """A belt over two pulleys that turn the same way: elastic spans, no slip.

    Both spans are taut, so that one relaxes as the other stretches: at the driving pulley they are a torsional spring
    of 2 k r₁², k = EA/L of one span. Behind it the driven pulley turns r₁/r₂ times as fast.

    Parameters
    ----------
    radius_in, radius_out : pitch radii r₁ and r₂ of the driving and the driven pulley [m].
    span_stiffness : k of one free span [N/m], its tensile stiffness EA [N] over its length.
    damping : at the driving pulley [N m s/rad].
    inertia_in, inertia_out : of the pulleys [kg m²], where no Disk has them already.
    efficiency : power that leaves over power that enters, whichever way it flows; without it nothing is lost.
    drag_torque : of bearings and bending at the driving pulley, whatever the load [N m].
    heat_rating : power lost borne continuously [W], which checks compare with.

    >>> Belt(radius_in="60 mm", radius_out="150 mm", span_stiffness=4e5).torsional_stiffness
    2880.0
    """

    example: ClassVar[str] = 'radius_in = "60 mm", radius_out = "150 mm" and span_stiffness = "4e5 N/m"'

    radius_in: Length = Field(description="pitch radius of the driving pulley")
    radius_out: Length = Field(description="pitch radius of the driven pulley")
    span_stiffness: MeshStiffness = Field(description="EA/L of one free span")
    damping: Damping = optional(default=0.0, description="at the driving pulley")
    inertia_in: Maybe[Inertia] = optional(default=None, description="of the driving pulley, where no Disk has it")
    inertia_out: Maybe[Inertia] = optional(default=None, description="of the driven pulley, where no Disk has it")
    efficiency: Maybe[Dimensionless] = optional(default=None, description="share of the power that it passes on")
    drag_torque: Maybe[Torque] = optional(default=None, description="of bearings and bending at the driving pulley")
    heat_rating: Maybe[Power] = optional(default=None, description=RATING)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        positive(self, "radius_in", "radius_out", "span_stiffness", "inertia_in", "inertia_out")
        not_negative(self, "damping")
        can_lose(self, "efficiency")
        return self

    @property
    def fraction(self) -> Fraction:
        """Input speed over output speed, of the radii as they are written."""
        return Fraction(str(self.radius_out)) / Fraction(str(self.radius_in))

    @property
    def speed_ratio(self) -> float:
        """Input speed over output speed."""
        return float(self.fraction)

    @property
    def losses(self) -> tuple[MeshLoss, ...]:
        """Of bending and creep, as friction of the shaft behind the spans."""
        return one_mesh(self, self.fraction, 1, 2)

    def parts(self) -> tuple[Part, ...]:
        """The driving pulley, the spans at its radius, and behind them the driven pulley."""
        driving = (Heavy(of="driving pulley of"),) if self.inertia_in is not None else ()
        driven = (Heavy(2, of="driven pulley of"),) if self.inertia_out is not None else ()
        return (*driving, Sprung(), Geared(self.fraction, 1), *driven)

    def inertias(self, number: Numbers) -> tuple[Any, ...]:
        """Of both pulleys."""
        return tuple(number(key) for key in ("inertia_in", "inertia_out") if getattr(self, key) is not None)

    def stiffness_of(self, number: Numbers) -> Any:
        """Of both spans at the driving pulley."""
        return SPANS * number("span_stiffness") * self.radius_in**2
