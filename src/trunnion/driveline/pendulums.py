"""Centrifugal pendulum absorbers: masses on paths, which the rotation itself pulls outwards."""

from __future__ import annotations

from math import pi, sqrt
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from trunnion.driveline.elements import not_negative, one_way, positive
from trunnion.driveline.parts import Heavy, Numbers, Part, Sprung
from trunnion.driveline.quantities import Damping, Dimensionless, Length, Mass, Maybe, optional
from trunnion.driveline.record import one_of
from trunnion.driveline.shafts import Elastic
from trunnion.errors import InputError

PATHS = ("circle", "epicycloid")


class CentrifugalPendulum(Elastic):
    """Pendulums on a rotating host: a branch by itself; what follows hangs on the shaft in front.

    All masses m together run on paths whose vertex is c = R + r from the axis, r their radius of curvature there: the
    length of a pendulum whose pivot is R from the axis. At the mean speed Ω of the host small motions are those of a
    ring of J = m(R + r)² on a spring of J n²Ω², so that it takes the order n = √(R/r) of the host's rotation, at any
    speed. On a circle the order falls with the swing; an epicycloid keeps it at a constant speed.

    Linear analyses at stated speeds take that ring; those without a speed refuse it, as its spring goes with the square
    of the speed. ``simulate`` follows its path. The masses' own rotation is left out (pendulums on two rollers).

    Parameters
    ----------
    mass : m of all pendulums together [kg].
    radius : R, from the axis to the centre of curvature of the path at its vertex, the pivot [m].
    length : r, radius of curvature at the vertex, the pendulum's length [m]; or else
    order : n, of the host's rotation; r = R/n².
    path : "circle" or "epicycloid" (tautochrone).
    damping : between ring and host [N m s/rad].
    largest_travel : along the path to either side, up to its stop [m]; what exceeds it is said.

    >>> print(round(CentrifugalPendulum(mass="1.2 kg", radius="80 mm", length="20 mm").tuned_order, 6))
    2.0
    """

    example: ClassVar[str] = 'mass = "1.2 kg", radius = "80 mm" and order = 2'
    onward: ClassVar[int] = 0
    ratings: ClassVar[tuple[str, ...]] = ("largest_travel",)
    idle: ClassVar[tuple[str, ...]] = ratings

    mass: Mass = Field(description="of all pendulums together")
    radius: Length = Field(description="from the axis to the pivot, the centre of curvature at the path's vertex")
    length: Maybe[Length] = optional(default=None, description="of a pendulum, the radius of curvature at the vertex")
    order: Maybe[Dimensionless] = optional(default=None, description="of the host's rotation, instead of the length")
    path: Annotated[
        Literal["circle", "epicycloid"],
        BeforeValidator(one_of(PATHS, "is not a path", 'write "circle" or "epicycloid"')),
    ] = Field(default="circle", description='of the masses: "circle" or "epicycloid", which keeps its order')
    damping: Damping = optional(default=0.0, description="between the ring that it acts as and its host")
    largest_travel: Maybe[Length] = optional(default=None, description="along the path to either side, to its stop")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        one_way(self, "order", ("length",), ("length",))
        positive(self, "mass", "radius", "length", "order", "largest_travel")
        not_negative(self, "damping")
        if self.length is not None and self.length > self.radius:
            raise InputError(
                f"is longer than the radius of {self.radius:g} m that it hangs on, for an order of "
                f"{self.tuned_order:.3g}", key="length", value=self.length,
                remedy="length is r of the pendulum, radius is R from the axis to its pivot: check which is which",
            )  # fmt: skip
        if self.largest_travel is not None and self.largest_travel > self.furthest:
            raise InputError(
                f"is more than the {self.furthest:.4g} m that its path has", key="largest_travel",
                value=self.largest_travel, remedy="check the unit",
            )  # fmt: skip
        return self

    @property
    def curvature(self) -> float:
        """r [m], as stated or of the order."""
        return self.length if self.length is not None else self.radius / (self.order or 1.0) ** 2

    @property
    def tuned_order(self) -> float:
        """n = √(R/r)."""
        return self.order if self.order is not None else sqrt(self.radius / self.curvature)

    @property
    def arm(self) -> float:
        """c = R + r [m], of the vertex: travel along the path over the twist of the ring."""
        return self.radius + self.curvature

    @property
    def furthest(self) -> float:
        """Half of the path's length [m]: half of a circle, or up to the cusp of the epicycloid."""
        if self.path == "circle":
            return pi * self.curvature
        n = self.tuned_order
        return self.arm / (n * sqrt(1 + n**2))

    def parts(self) -> tuple[Part, ...]:
        """The ring that it acts as, on a spring."""
        return (Sprung(), Heavy(1, of="pendulum of"))

    def _squares(self, number: Numbers) -> tuple[Any, Any]:
        """n² and c² for the values of its numbers."""
        square = number("order") ** 2 if self.order is not None else number("radius") / number("length")
        return square, (number("radius") * (1 + 1 / square)) ** 2

    def inertias(self, number: Numbers) -> tuple[Any, ...]:
        """m(R + r)²."""
        return (number("mass") * self._squares(number)[1],)

    def stiffness_of(self, number: Numbers) -> Any:
        """J n² of the ring: its stiffness [N m/rad] over the square of its host's speed."""
        square, arm = self._squares(number)
        return number("mass") * arm * square


class Swinging(CentrifugalPendulum):
    """The same where it swings along its path, by equations of its own. For equations; no file has it."""

    @property
    def kind(self) -> str:
        """That of the pendulum as described."""
        return CentrifugalPendulum.__name__

    def stiffness_of(self, number: Numbers) -> Any:
        """None: its path carries it."""
        return 0.0

    def damping_of(self, number: Numbers) -> Any:
        """None: its equations have it."""
        return 0.0
