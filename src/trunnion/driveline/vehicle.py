"""A vehicle on its driven wheels, and the tyres between them and the road."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, ClassVar, Self

from pydantic import Field, model_validator

from trunnion.driveline.elements import Doubt, Element, Loaded, not_negative, positive
from trunnion.driveline.parts import Dragged, Heavy, Numbers, Part, Sprung
from trunnion.driveline.quantities import (
    Area,
    Damping,
    Density,
    Dimensionless,
    Force,
    Inertia,
    Length,
    Mass,
    Maybe,
    Stiffness,
    Velocity,
    optional,
)
from trunnion.driveline.record import Name
from trunnion.driveline.shafts import Elastic
from trunnion.errors import InputError

GRAVITY = 9.80665
"""Standard acceleration of free fall [m/s²] (CGPM 1901)."""
ROLLING = 0.1
"""Rolling resistance of a tyre in soft ground; what is more is rather a percentage."""


class Tyre(Elastic):
    """A tyre between a wheel and the road: the torsional spring of its sidewalls, and in series the slip of its tread.

    What follows is the ``Vehicle``, or ``to`` names it where another tyre leads there already. The tread slips by
    s = (ω r − v)/v and pulls with C_s s, so that it is a damper c = C_s r²/v between its belt and the road; v is
    stated, as c falls with the speed. No spring holds the slip: its multiplier at 1 is set aside. Mean speeds
    are those without slip.

    Parameters
    ----------
    stiffness : of the sidewalls, rim against belt [N m/rad].
    damping : of the sidewalls [N m s/rad].
    slip_stiffness : C_s [N], longitudinal force over slip at no slip; without it the tread does not slip.
    radius : rolling radius r [m].
    travel_speed : v [m/s] at which the slip is taken.
    inertia : of belt and tread [kg m²].
    to : the vehicle, where it stands earlier in the line.

    The last four, but ``to``, belong to a slip and are needed with it.

    >>> Tyre(
    ...     stiffness="15 kN*m/rad", slip_stiffness="60 kN", radius="0.3 m", travel_speed="72 km/h", inertia=0.6
    ... ).slip_damping
    270.0
    """

    example: ClassVar[str] = 'stiffness = "15 kN*m/rad"'
    springs: ClassVar[tuple[str, ...]] = ("", "slip of")

    stiffness: Stiffness = Field(description="of the sidewalls, rim against belt")
    damping: Damping = optional(default=0.0, description="of the sidewalls")
    slip_stiffness: Maybe[Force] = optional(
        default=None, description="longitudinal force over slip; without it the tread does not slip"
    )
    radius: Maybe[Length] = optional(default=None, description="rolling radius")
    travel_speed: Maybe[Velocity] = optional(default=None, description="speed of travel at which the slip is taken")
    inertia: Maybe[Inertia] = optional(default=None, description="of belt and tread")
    to: Name | None = Field(default=None, description="the vehicle, where another tyre leads there already")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        positive(self, "stiffness", "slip_stiffness", "radius", "travel_speed", "inertia")
        not_negative(self, "damping")
        slip = ("slip_stiffness", "radius", "travel_speed", "inertia")
        stated = [key for key in slip if getattr(self, key) is not None]
        missing = [key for key in slip if getattr(self, key) is None]
        if stated and missing:
            raise InputError(
                f"is needed with {stated[0]}", key=missing[0],
                remedy=f"a tread that slips needs {', '.join(slip)}; one that does not needs none of them",
            )  # fmt: skip
        return self

    @property
    def slips(self) -> bool:
        """Whether its tread slips."""
        return self.slip_stiffness is not None

    @property
    def slip_damping(self) -> float:
        """C_s r²/v [N m s/rad] of the tread; none where it does not slip."""
        return float(self.links(lambda key: getattr(self, key))[1][1]) if self.slips else 0.0

    def parts(self) -> tuple[Part, ...]:
        """The sidewalls; behind them the belt, and its tread on the road."""
        if not self.slips:
            return (Sprung(closes=self.to),)
        return (Sprung(), Heavy(1, of="belt of"), Dragged(1, self.to))

    def inertias(self, number: Numbers) -> tuple[Any, ...]:
        """Of the belt."""
        return (number("inertia"),) if self.slips else ()

    def stiffness_of(self, number: Numbers) -> Any:
        """Of the sidewalls."""
        return number("stiffness")

    def links(self, number: Numbers) -> tuple[tuple[Any, Any], ...]:
        """Sidewalls, and the tread where it slips."""
        walls = (number("stiffness"), number("damping"))
        if not self.slips:
            return (walls,)
        return (walls, (0.0, number("slip_stiffness") * number("radius") ** 2 / number("travel_speed")))


class VehicleMass(Element):
    """What a vehicle weighs and what resists it: its fields stand before those of what else acts on it."""

    mass: Mass = Field(description="with its load")
    wheel_radius: Length = Field(description="rolling radius of the driven wheels")
    wheel_inertia: Inertia = optional(default=0.0, description="of the wheels that roll along undriven")
    rolling_resistance: Dimensionless = optional(default=0.0, description="force over weight")
    grade: Dimensionless = optional(default=0.0, description="tangent of the road's slope, uphill")
    drag_area: Area = optional(default=0.0, description="drag coefficient times frontal area")
    air_density: Density = optional(default=1.2, description="of the air it drives through")


class Vehicle(Loaded, VehicleMass):
    """The mass that driven wheels move, as the inertia that they feel: J = m r² and the wheels that are not driven.

    Its resistance is (f m g cos α + m g sin α) r, and ½ ρ c_w A r³ by the square of the wheels' speed (Mitschke,
    Wallentowitz: Dynamik der Kraftfahrzeuge). Each driven wheel joins it by a ``Tyre``, the first in front of it, the
    others by ``to``.

    Parameters
    ----------
    mass : m [kg], with its load.
    wheel_radius : rolling radius r of the driven wheels [m].
    wheel_inertia : of the wheels that roll along undriven, at that radius [kg m²].
    rolling_resistance : f, force over weight; 0.01 to 0.015 of car tyres on asphalt.
    grade : tan α of the road, "5 %".
    drag_area : c_w A [m²], drag coefficient times frontal area.
    air_density : ρ [kg/m³].
    load_torque, viscous_load, quadratic_load : what resists beside, at the wheels, as of a ``Disk``: a trailer.
    drive_share, excitation : as of a ``Disk``.

    >>> car = Vehicle(mass="1600 kg", wheel_radius="0.31 m", rolling_resistance=0.012, drag_area="0.65 m^2")
    >>> print(f"{car.moment_of_inertia:.1f} kg m², {car.load.constant:.1f} N m at rest")
    153.8 kg m², 58.4 N m at rest
    """

    example: ClassVar[str] = 'mass = "1600 kg" and wheel_radius = "0.31 m"'

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        positive(self, "mass", "wheel_radius", "air_density")
        not_negative(self, "wheel_inertia", "rolling_resistance", "drag_area", "drive_share")
        not_negative(self, "grade", remedy="write what pushes downhill as a negative load_torque")
        return self

    def doubts(self) -> Iterator[Doubt]:
        if self.rolling_resistance > ROLLING:
            yield ("rolling_resistance", "is that of deep mud", 'write "1.2 %", say, or 0.012')

    def inertias(self, number: Numbers) -> tuple[Any, ...]:
        """Mass and undriven wheels, as the driven wheels feel them."""
        return (number("mass") * number("wheel_radius") ** 2 + number("wheel_inertia"),)

    def resistance(self, number: Numbers) -> tuple[Any, Any]:
        """Of rolling and climbing [N m], and of the air [N m s²/rad²]."""
        grade = number("grade")
        weight = number("mass") * GRAVITY * number("wheel_radius")
        air = number("air_density") * number("drag_area") * number("wheel_radius") ** 3 / 2
        # cos α and sin α of the slope whose tangent is stated.
        return weight * (number("rolling_resistance") + grade) / (1 + grade**2) ** 0.5, air
