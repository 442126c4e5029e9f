"""Brakes: dry friction between a shaft and what stands still."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Self

from pydantic import Field, model_validator

from trunnion.driveline.elements import Rotor, not_negative, positive
from trunnion.driveline.excitation import Excitations
from trunnion.driveline.quantities import Inertia, Maybe, Power, Speed, Torque, optional
from trunnion.errors import InputError

if TYPE_CHECKING:
    from trunnion.driveline.parts import Numbers
    from trunnion.laws.torque_curve import TorqueCurve


class Brake(Rotor):
    """A brake that drags: a disk, drum or band on a shaft, and the friction torque that it is applied with.

    While its shaft turns it resists by T_c, or where its friction falls with the speed by
    T_c + (T_s − T_c) e^(−ω/ω_s) (Stribeck), whose falling slope feeds what swings about the mean: judder. Linear
    analyses take that slope at the mean speed. In ``transient`` it keeps its shaft at rest up to T_s.

    Parameters
    ----------
    inertia : of what turns with the shaft [kg m²].
    torque : T_c that it is applied with, while it turns [N m]; 0 is released.
    static_torque : T_s, at rest [N m]; by default T_c.
    stribeck_speed : ω_s over which friction falls from T_s to T_c [rad/s]; without it it falls at once.
    heat_rating : friction power borne continuously [W], which checks compare with.
    excitation : harmonic torques besides, as of an uneven disk, see ``Excitation``.

    >>> brake = Brake(inertia=0.3, torque="200 N*m", static_torque="260 N*m", stribeck_speed="2 rad/s")
    >>> round(float(brake.load.value(2.0)), 3), round(float(brake.load.slope(2.0)), 3)
    (222.073, -11.036)
    """

    example: ClassVar[str] = 'torque = "200 N*m"'

    inertia: Inertia = Field(description="of what turns with the shaft")
    torque: Torque = Field(description="friction torque that it is applied with, while it turns; 0 is released")
    static_torque: Maybe[Torque] = optional(default=None, description="at rest; by default the same")
    stribeck_speed: Maybe[Speed] = optional(default=None, description="over which friction falls from rest on")
    heat_rating: Maybe[Power] = optional(default=None, description="rating, friction power borne continuously")
    excitation: Excitations = optional(default=(), description="harmonic torques, in time or in its rotation")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        positive(self, "inertia", "static_torque", "stribeck_speed", "heat_rating")
        not_negative(self, "torque", remedy="write how much it resists; it does so in either direction")
        if self.static_torque is not None and self.static_torque < self.torque:
            remedy = "write torque or more, or leave it out"
            raise InputError("is less than torque", key="static_torque", value=self.static_torque, remedy=remedy)
        if self.stribeck_speed is not None and self.static_torque is None:
            remedy = "write how much it holds at rest"
            raise InputError("is needed with stribeck_speed", key="static_torque", remedy=remedy)
        return self

    def inertias(self, number: Numbers) -> tuple[Any, ...]:
        """As stated."""
        return (number("inertia"),)

    def load_of(self, number: Numbers) -> TorqueCurve:
        """What it resists with."""
        from trunnion.laws.torque_curve import PowerCurve, StribeckCurve

        if self.stribeck_speed is None:
            return PowerCurve(number("torque"))
        return StribeckCurve(number("torque"), number("static_torque"), number("stribeck_speed"))
