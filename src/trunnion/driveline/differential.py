"""A differential: one shaft drives two others, which share its torque and may turn against each other."""

from __future__ import annotations

from fractions import Fraction
from typing import Any, ClassVar, Self

from pydantic import Field, model_validator

from trunnion.driveline.elements import Element, Teeth, can_lose, one_mesh, one_way, positive
from trunnion.driveline.gear_losses import DRAG, RATING, MeshLoss
from trunnion.driveline.parts import Geared, Heavy, Loose, Numbers, Part, Tied
from trunnion.driveline.quantities import Dimensionless, Inertia, Maybe, Power, Torque, optional
from trunnion.errors import InputError


class Differential(Element):
    """An open differential: its case turns with the mean of its two legs, (ω_l + ω_r)/2, and shares its torque equally.

    What follows hangs on the left leg; the right one is called by its name and ``.right``:
    ``Shaft(stiffness=..., after="Differential 1.right")``. On average both legs turn with the case. Each leg needs an
    inertia right behind: a Disk for side gear and flange.

    Parameters
    ----------
    ratio : final drive in front of the case, input speed over that of the case; 1 by default, negative reverses.
    teeth_in, teeth_out : tooth numbers of the final drive instead.
    inertia : of the case with the crown wheel [kg m²].
    efficiency : of the final drive, power that leaves over power that enters, whichever way it flows; without it
        nothing is lost. Legs that turn as one rub nowhere.
    drag_torque : of oil and seals at the pinion, whatever the load [N m].
    heat_rating : power lost borne continuously [W], which checks compare with.

    >>> Differential(teeth_in=10, teeth_out=41).speed_ratio
    4.1
    """

    example: ClassVar[str] = "teeth_in = 10 and teeth_out = 41, or ratio = 4.1"

    ratio: Maybe[Dimensionless] = optional(default=None, description="final drive, input speed over that of the case")
    teeth_in: Teeth | None = Field(default=None, description="teeth of the pinion")
    teeth_out: Teeth | None = Field(default=None, description="teeth of the crown wheel")
    inertia: Maybe[Inertia] = optional(default=None, description="of the case with the crown wheel")
    efficiency: Maybe[Dimensionless] = optional(default=None, description="of the final drive: power passed on")
    drag_torque: Maybe[Torque] = optional(default=None, description=DRAG)
    heat_rating: Maybe[Power] = optional(default=None, description=RATING)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.teeth_in is not None or self.teeth_out is not None:
            one_way(self, "ratio", ("teeth_in", "teeth_out"), ("teeth_in", "teeth_out"))
        if self.ratio == 0:
            remedy = "write input speed over that of the case"
            raise InputError("must not be zero", key="ratio", value=0.0, remedy=remedy)
        positive(self, "inertia")
        can_lose(self, "efficiency")
        return self

    @property
    def fraction(self) -> Fraction:
        """The final drive exactly: from the tooth numbers, or the decimal as it was written."""
        if self.teeth_in is not None and self.teeth_out is not None:
            return Fraction(self.teeth_out, self.teeth_in)
        return Fraction(str(self.ratio)) if self.ratio is not None else Fraction(1)

    @property
    def speed_ratio(self) -> float:
        """Input speed over that of the case."""
        return float(self.fraction)

    @property
    def ports(self) -> dict[str, int]:
        """The legs."""
        return {"left": 3, "right": 2}

    @property
    def losses(self) -> tuple[MeshLoss, ...]:
        """Of the final drive."""
        return one_mesh(self, self.fraction)

    def parts(self) -> tuple[Part, ...]:
        """The case, the right leg with a rotation of its own, and the left leg, which follows from both."""
        case = (Geared(self.fraction), *((Heavy(1, of="case of"),) if self.inertia is not None else ()))
        return (*case, Loose(1), Tied(((1, Fraction(2)), (2, Fraction(-1)))))

    def inertias(self, number: Numbers) -> tuple[Any, ...]:
        """That of the case."""
        return (number("inertia"),) if self.inertia is not None else ()
