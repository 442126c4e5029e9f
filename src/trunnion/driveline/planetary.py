"""A planetary gear set: a sun and a ring with planets between them, which a carrier bears."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from math import cos, pi
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from trunnion.driveline.elements import Doubt, Teeth, can_lose, not_negative, positive
from trunnion.driveline.gear_losses import DRAG, RATING, MeshLoss
from trunnion.driveline.parts import Geared, Heavy, Loose, Numbers, Part, Sprung, Tied
from trunnion.driveline.quantities import (
    Angle,
    Dimensionless,
    Inertia,
    Length,
    Mass,
    Maybe,
    MeshDamping,
    MeshStiffness,
    Power,
    Torque,
    optional,
)
from trunnion.driveline.record import one_of, whole_from
from trunnion.driveline.shafts import Elastic
from trunnion.errors import InputError

SHAFTS = ("sun", "carrier", "ring")
MESHES = ("sun_mesh_stiffness", "ring_mesh_stiffness")
EFFICIENCIES = ("sun_mesh_efficiency", "ring_mesh_efficiency")
SHIFTED = 2
"""Teeth by which profile shift may make planets larger or smaller than their room."""
STILL = 1e-9
"""Share of the input's speed below which an output does not turn."""
PRESSURE_ANGLE = pi / 9
WRITE = 'write one of "sun", "carrier", "ring"'
_Shaft = Literal["sun", "carrier", "ring"]


def _one_shaft(value: object) -> object:
    if value is None:
        return None
    if isinstance(value, list | tuple) and len(value) > 1:
        remedy = f'write held = "{value[0]}": one shaft is held, one drives, one is driven'
        raise InputError("holds two shafts, so that nothing can turn", value=list(value), remedy=remedy)
    return one_of(SHAFTS, "is not a shaft of a planetary set", WRITE)(value)


class Planetary(Elastic):
    """A planetary gear set: any of its three shafts drives, is driven, is held or turns freely; teeth rigid or elastic.

    z_s ω_s + z_r ω_r = (z_s + z_r) ω_c (Willis), rotations positive in one sense; torques follow, without loss where
    none is stated. The inertias of sun, carrier and ring are Disks on them; planets turn with them.

    Parameters
    ----------
    teeth_sun, teeth_ring : tooth numbers z_s and z_r.
    input : the shaft that hangs on the element in front: "sun", "carrier" or "ring".
    held : the shaft that the housing holds; what follows hangs on the third.
    output : or else the shaft that what follows hangs on. The third is then called by the set's name and its own:
        ``Disk(inertia=..., after="Planetary 1.ring")``; it needs an inertia.
    free_speed : mean speed of that third shaft over the input's; 1, all turn as one, by default.
    planets : how many.
    planet_inertia : of one planet about its own axis [kg m²].
    planet_mass, centre_distance : of one planet [kg], and from its axis to the sun's [m]: both, or none.
    teeth_planet : of a planet; by default as coaxial standard gears have it, (z_r − z_s)/2.
    sun_mesh_stiffness, ring_mesh_stiffness : of one planet's mesh along the line of action [N/m]: both, or none, where
        teeth are rigid. Then planet_inertia and module are needed, and an inertia right behind the output.
    mesh_damping : of one mesh along the line of action [N s/m].
    module, pressure_angle : of the teeth [m, rad], for the planets' base radius m z_p cos α/2.
    sun_mesh_efficiency, ring_mesh_efficiency : share of the power of rolling, that of the rotation relative to the
        carrier, which a mesh passes on, whichever way; without them nothing is lost. Teeth are rigid then.
    drag_torque : of oil and seals at the input shaft, whatever the load [N m].
    heat_rating : power lost borne continuously [W], which checks compare with.

    All planets move alike; their modes against each other, √((k_s + k_r) r_b²/J_p), move nothing else.

    >>> Planetary(teeth_sun=30, teeth_ring=72, input="sun", held="ring").speed_ratio
    3.4
    """

    springs: ClassVar[tuple[str, ...]] = ("sun mesh of", "ring mesh of")
    example: ClassVar[str] = 'teeth_sun = 30, teeth_ring = 72, input = "sun" and held = "ring"'

    teeth_sun: Teeth = Field(description="teeth of the sun")
    teeth_ring: Teeth = Field(description="teeth of the ring")
    input: Annotated[_Shaft, BeforeValidator(one_of(SHAFTS, "is not a shaft of a planetary set", WRITE))] = Field(
        description="shaft that hangs on the element in front: sun, carrier or ring"
    )
    held: Annotated[_Shaft | None, BeforeValidator(_one_shaft)] = Field(
        default=None, description="shaft that the housing holds"
    )
    output: Annotated[_Shaft | None, BeforeValidator(_one_shaft)] = Field(
        default=None, description="where none is held, the shaft that what follows hangs on"
    )
    free_speed: Dimensionless = optional(
        default=1.0, description="where none is held, mean speed of the third shaft over the input's"
    )
    planets: Annotated[int, BeforeValidator(whole_from(1, 100, example=3))] = Field(
        default=3, ge=1, le=100, description="how many planets"
    )
    planet_inertia: Maybe[Inertia] = optional(default=None, description="of one planet about its own axis")
    planet_mass: Maybe[Mass] = optional(default=None, description="of one planet")
    centre_distance: Maybe[Length] = optional(default=None, description="from the axis of a planet to the sun's")
    teeth_planet: Teeth | None = Field(default=None, description="teeth of a planet; by default (ring - sun)/2")
    sun_mesh_stiffness: Maybe[MeshStiffness] = optional(
        default=None, description="of one planet and the sun along the line of action; rigid by default"
    )
    ring_mesh_stiffness: Maybe[MeshStiffness] = optional(default=None, description="of one planet and the ring")
    mesh_damping: MeshDamping = optional(default=0.0, description="of one such mesh along the line of action")
    module: Maybe[Length] = optional(default=None, description="of elastic teeth")
    pressure_angle: Angle = optional(default=PRESSURE_ANGLE, description="of elastic teeth; 20 deg by default")
    sun_mesh_efficiency: Maybe[Dimensionless] = optional(
        default=None, description="share of the rolling power that planets and sun pass on; teeth rigid"
    )
    ring_mesh_efficiency: Maybe[Dimensionless] = optional(default=None, description="of planets and ring")
    drag_torque: Maybe[Torque] = optional(default=None, description=DRAG)
    heat_rating: Maybe[Power] = optional(default=None, description=RATING)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.teeth_ring <= self.teeth_sun + 1:
            remedy = "the ring has more teeth than the sun, with room for planets between"
            raise InputError("leaves no planets", key="teeth_ring", value=self.teeth_ring, remedy=remedy)
        others = " or ".join(one for one in SHAFTS if one != self.input)
        if self.input == self.held:
            problem = "is the input, so that nothing can turn"
            raise InputError(problem, key="held", value=self.held, remedy=f"hold {others}")
        if self.held is None and self.output is None:
            raise InputError("is missing", key="held", remedy=f'hold {others}, or write output = "carrier", say')
        if self.held is not None and self.output == self.held:
            raise InputError("is held", key="output", value=self.output, remedy="leave one of the two out")
        if self.input == self.output:
            raise InputError("is the input", key="output", value=self.output, remedy=f"write {others}")
        if abs(self.speeds[self.driven]) < STILL:
            remedy = f"hold the {self.driven}, or write another speed"
            raise InputError("lets the output stand still", key="free_speed", value=self.free_speed, remedy=remedy)
        if (self.planet_mass is None) != (self.centre_distance is None):
            missing = "planet_mass" if self.planet_mass is None else "centre_distance"
            raise InputError("is missing", key=missing, remedy="write planet_mass and centre_distance, or neither")
        if self.held is not None and self.free_speed != 1.0:
            remedy = "leave it out: all speeds follow from the input's"
            raise InputError("conflicts with held", key="free_speed", value=self.free_speed, remedy=remedy)
        positive(self, "planet_inertia", "planet_mass", "centre_distance", "module", *MESHES)
        not_negative(self, "mesh_damping")
        can_lose(self, *EFFICIENCIES)
        self._check_meshes()
        return self

    def _check_meshes(self) -> None:
        """Both meshes and what they need, or neither."""
        stated = [key for key in MESHES if getattr(self, key) is not None]
        if not stated:
            for key in ("module", "mesh_damping"):
                if getattr(self, key):
                    remedy = "write sun_mesh_stiffness and ring_mesh_stiffness, or leave it out"
                    raise InputError("belongs to elastic teeth", key=key, value=getattr(self, key), remedy=remedy)
            return
        for key in (*MESHES, "module", "planet_inertia"):
            if getattr(self, key) is None:
                remedy = "elastic teeth need sun_mesh_stiffness, ring_mesh_stiffness, module and planet_inertia"
                raise InputError(f"is needed with {stated[0]}", key=key, remedy=remedy)
        lossy = next((key for key in EFFICIENCIES if getattr(self, key) is not None), None)
        if lossy is not None:
            remedy = "leave out the mesh stiffnesses, or the efficiencies"
            raise InputError("belongs to rigid teeth", key=lossy, value=getattr(self, lossy), remedy=remedy)
        if not 0 < self.pressure_angle < pi / 4:
            remedy = 'write "20 deg", say'
            raise InputError(
                "must lie between 0 and 45 deg", key="pressure_angle", value=self.pressure_angle, remedy=remedy
            )

    def doubts(self) -> Iterator[Doubt]:
        if (self.teeth_sun + self.teeth_ring) % self.planets:
            problem = f"cannot be spaced evenly: {self.teeth_sun} + {self.teeth_ring} teeth are not a multiple of them"
            yield ("planets", problem, "check the tooth numbers")
        room = (self.teeth_ring - self.teeth_sun) / 2
        if self.teeth_planet and abs(self.teeth_planet - room) > SHIFTED:
            problem = f"hardly fit between {self.teeth_sun} and {self.teeth_ring} teeth, which leave {room:g}"
            yield ("teeth_planet", problem, "check the tooth numbers")

    @property
    def driven(self) -> str:
        """The shaft that what follows hangs on."""
        return self.output or next(one for one in SHAFTS if one not in (self.input, self.held))

    @property
    def third(self) -> str:
        """The shaft that is held or free."""
        return next(one for one in SHAFTS if one not in (self.input, self.driven))

    @property
    def shares(self) -> dict[str, tuple[Fraction, Fraction]]:
        """Shares of the input's rotation and of the third shaft's in those of sun, carrier, ring and planets."""
        sun, ring = Fraction(self.teeth_sun), Fraction(self.teeth_ring)
        weight = {"sun": sun, "ring": ring, "carrier": -sun - ring}
        found = {self.input: (Fraction(1), Fraction(0)), self.third: (Fraction(0), Fraction(1))}
        found[self.driven] = (-weight[self.input] / weight[self.driven], -weight[self.third] / weight[self.driven])
        over = sun / (Fraction(self.teeth_planet) if self.teeth_planet else (ring - sun) / 2)
        (c, d), (s, t) = found["carrier"], found["sun"]
        return found | {"planets": (c - over * (s - c), d - over * (t - d))}

    @property
    def speeds(self) -> dict[str, Fraction]:
        """Mean speed of sun, carrier, ring and planets over the input's, about fixed axes."""
        third = Fraction(0) if self.held else Fraction(str(self.free_speed))
        return {name: one + other * third for name, (one, other) in self.shares.items()}

    @property
    def speed_ratio(self) -> float:
        """Input speed over output speed, on average."""
        return float(1 / self.speeds[self.driven])

    @property
    def ports(self) -> dict[str, int]:
        """The third shaft, where it is not held."""
        return {} if self.held else {self.third: 1}

    @property
    def elastic(self) -> bool:
        """Whether its teeth yield."""
        return self.sun_mesh_stiffness is not None

    @property
    def losses(self) -> tuple[MeshLoss, ...]:
        """Of sun and ring with the planets, as friction between each and the carrier."""
        place: dict[str, int] = {self.input: 0, **self.ports}
        place[self.driven] = driven = 1 + len(self.ports) + (self.planet_inertia is not None)
        weight = {"sun": self.teeth_sun, "ring": self.teeth_ring, "carrier": -self.teeth_sun - self.teeth_ring}
        found = []
        for key, gear in zip(EFFICIENCIES, ("sun", "ring"), strict=True):
            if getattr(self, key) is None:
                continue
            over = weight[gear] / weight[self.driven]
            at, against = place.get(gear), place.get("carrier")
            held = at is None  # the gear is: then the carrier rubs
            found.append(
                MeshLoss(against or 0, None, driven, -over, key)
                if held
                else MeshLoss(at or 0, against, driven, over, key)
            )
        return tuple(found)

    @property
    def planet_radius(self) -> float:
        """Base radius of a planet [m], of elastic teeth."""
        teeth = self.teeth_planet or (self.teeth_ring - self.teeth_sun) / 2
        return (self.module or 0.0) * teeth * cos(self.pressure_angle) / 2

    def links(self, number: Numbers) -> tuple[tuple[Any, Any], ...]:
        """Meshes of all planets with the sun and with the ring, at the planets' axes."""
        if not self.elastic:
            return ()
        square = self.planets * self.planet_radius**2
        return tuple((number(key) * square, number("mesh_damping") * square) for key in MESHES)

    def _yielding(self) -> tuple[Part, ...]:
        """Shafts that turn by themselves, and planets between where the sun and where the ring would take them."""
        speeds, found = self.speeds, list[Part]()
        place: dict[str, int] = {self.input: 0}
        for name in (*self.ports, self.driven, "planets"):
            found.append(Loose(0, speeds[name]))
            place[name] = len(place)
        teeth = Fraction(self.teeth_planet) if self.teeth_planet else Fraction(self.teeth_ring - self.teeth_sun, 2)
        for gear, over in (("sun", -self.teeth_sun / teeth), ("ring", self.teeth_ring / teeth)):
            of = [(place[one], share) for one, share in ((gear, over), ("carrier", 1 - over)) if one in place and share]
            found.append(Tied(tuple(of)) if len(of) > 1 else Geared(1 / of[0][1], of[0][0]))
        led = len(place)
        found += [
            Sprung(led, at=place["planets"]),
            Sprung(led + 1, at=place["planets"]),
            Geared(Fraction(1), place[self.driven]),
        ]
        carried = (Heavy(place["carrier"], of="carrier of"),) if self._orbiting else ()
        return (*found, Heavy(place["planets"], of="planets of"), *carried)

    def parts(self) -> tuple[Part, ...]:
        """The third shaft, where it turns; planets, where they are heavy; and the output, tied to both others."""
        if self.elastic:
            return self._yielding()
        place = {self.input: 0} | self.ports
        found: list[Part] = [] if self.held else [Loose(0, Fraction(str(self.free_speed)))]
        for name in (*(["planets"] if self.planet_inertia is not None else []), self.driven):
            one, other = self.shares[name]
            found.append(Geared(1 / one) if self.held else Tied(((0, one), (1, other))))
            place[name] = len(place)
        heavy = {"planets": self.planet_inertia is not None, "carrier": self._orbiting}
        return (*found, *(Heavy(place[name], of=f"{name} of") for name, some in heavy.items() if some))

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
