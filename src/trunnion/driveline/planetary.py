"""A planetary gear set: a sun and a ring with planets between them, which a carrier bears."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from trunnion.driveline.elements import Doubt, Element, Teeth, positive
from trunnion.driveline.parts import Geared, Heavy, Numbers, Part
from trunnion.driveline.quantities import Inertia, Length, Mass, Maybe, optional
from trunnion.driveline.record import one_of
from trunnion.errors import InputError

SHAFTS = ("sun", "carrier", "ring")
WRITE = 'write one of "sun", "carrier", "ring"'
_Shaft = Literal["sun", "carrier", "ring"]


def _one_shaft(value: object) -> object:
    if isinstance(value, list | tuple) and len(value) > 1:
        remedy = f'write held = "{value[0]}": one shaft is held, one drives, one is driven'
        raise InputError("holds two shafts, so that nothing can turn", value=list(value), remedy=remedy)
    return one_of(SHAFTS, "is no shaft of a planetary set", WRITE)(value)


class Planetary(Element):
    """A planetary gear set with rigid teeth, one of whose three shafts is held.

    z_s ω_s + z_r ω_r = (z_s + z_r) ω_c (Willis), rotations positive in one sense; torques follow without loss. The
    inertias of sun, carrier and ring are Disks in front and behind; planets turn with them.

    Parameters
    ----------
    teeth_sun, teeth_ring : tooth numbers z_s and z_r.
    input : the shaft that hangs on the element in front: "sun", "carrier" or "ring".
    held : the shaft that the housing holds; what follows hangs on the third.
    planets : how many.
    planet_inertia : of one planet about its own axis [kg m²].
    planet_mass, centre_distance : of one planet [kg], and from its axis to the sun's [m]: both, or none.
    teeth_planet : of a planet; by default as coaxial standard gears have it, (z_r − z_s)/2.

    >>> Planetary(teeth_sun=30, teeth_ring=72, input="sun", held="ring").speed_ratio
    3.4
    """

    example: ClassVar[str] = 'teeth_sun = 30, teeth_ring = 72, input = "sun" and held = "ring"'

    teeth_sun: Teeth = Field(description="teeth of the sun")
    teeth_ring: Teeth = Field(description="teeth of the ring")
    input: Annotated[_Shaft, BeforeValidator(one_of(SHAFTS, "is no shaft of a planetary set", WRITE))] = Field(
        description="shaft that hangs on the element in front: sun, carrier or ring"
    )
    held: Annotated[_Shaft, BeforeValidator(_one_shaft)] = Field(description="shaft that the housing holds")
    planets: int = Field(default=3, ge=1, le=100, description="how many planets")
    planet_inertia: Maybe[Inertia] = optional(default=None, description="of one planet about its own axis")
    planet_mass: Maybe[Mass] = optional(default=None, description="of one planet")
    centre_distance: Maybe[Length] = optional(default=None, description="from the axis of a planet to the sun's")
    teeth_planet: Teeth | None = Field(default=None, description="teeth of a planet; by default (ring - sun)/2")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.teeth_ring <= self.teeth_sun + 1:
            remedy = "the ring has more teeth than the sun, with room for planets between"
            raise InputError("leaves no planets", key="teeth_ring", value=self.teeth_ring, remedy=remedy)
        if self.input == self.held:
            remedy = f"hold {' or '.join(one for one in SHAFTS if one != self.input)}"
            raise InputError("is the input, so that nothing can turn", key="held", value=self.held, remedy=remedy)
        if (self.planet_mass is None) != (self.centre_distance is None):
            missing = "planet_mass" if self.planet_mass is None else "centre_distance"
            raise InputError("is missing", key=missing, remedy="write planet_mass and centre_distance, or neither")
        positive(self, "planet_inertia", "planet_mass", "centre_distance")
        return self

    def doubts(self) -> Iterator[Doubt]:
        if (self.teeth_sun + self.teeth_ring) % self.planets:
            problem = f"cannot be spaced evenly: {self.teeth_sun} + {self.teeth_ring} teeth are no multiple of them"
            yield ("planets", problem, "check the tooth numbers")

    @property
    def output(self) -> str:
        """The shaft that what follows hangs on."""
        return next(one for one in SHAFTS if one not in (self.input, self.held))

    @property
    def speeds(self) -> dict[str, Fraction]:
        """Speed of sun, carrier, ring and planets, all over the input's, about fixed axes."""
        sun, ring = self.teeth_sun, self.teeth_ring
        weight = {"sun": sun, "ring": ring, "carrier": -sun - ring}
        found: dict[str, Fraction] = {self.input: Fraction(1), self.held: Fraction(0)}
        found[self.output] = Fraction(-weight[self.input], weight[self.output])
        planet = Fraction(self.teeth_planet) if self.teeth_planet else Fraction(ring - sun, 2)
        found["planets"] = found["carrier"] - sun / planet * (found["sun"] - found["carrier"])
        return found

    @property
    def speed_ratio(self) -> float:
        """Input speed over output speed."""
        return float(1 / self.speeds[self.output])

    def parts(self) -> tuple[Part, ...]:
        """Planets, where they are heavy, and the output: both geared to the input."""
        speeds, found = self.speeds, list[Part]()
        if self.planet_inertia is not None:
            found += [Geared(1 / speeds["planets"]), Heavy(1, of="planets of")]
        found.append(Geared(1 / speeds[self.output]))
        if self._orbiting:
            coordinates = sum(isinstance(part, Geared) for part in found)
            found.append(Heavy(0 if self.input == "carrier" else coordinates, of="carrier of"))
        return tuple(found)

    @property
    def _orbiting(self) -> bool:
        """Whether the mass of the planets is carried round."""
        return self.planet_mass is not None and self.held != "carrier"

    def inertias(self, number: Numbers) -> tuple[Any, ...]:
        """Of the planets about their own axes, and of their mass on the carrier."""
        spin = [self.planets * number("planet_inertia")] if self.planet_inertia is not None else []
        orbit = [self.planets * number("planet_mass") * number("centre_distance") ** 2] if self._orbiting else []
        return (*spin, *orbit)

    @property
    def idle(self) -> tuple[str, ...]:
        """The mass of planets whose carrier is held moves nothing."""
        return () if self._orbiting else ("planet_mass", "centre_distance")
