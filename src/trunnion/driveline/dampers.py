"""Torsional vibration dampers: a ring on a housing, which oil drags along or springs and rubber hold."""

from __future__ import annotations

from typing import Any, ClassVar, Self

from pydantic import Field, model_validator

from trunnion.driveline.elements import not_negative, positive
from trunnion.driveline.parts import Dragged, Heavy, Numbers, Part, Sprung
from trunnion.driveline.quantities import Damping, Inertia, Maybe, Power, Stiffness, optional
from trunnion.driveline.shafts import Elastic


class Damper(Elastic):
    """A branch by itself: its housing on the shaft in front, its ring on the housing; what follows hangs on that shaft.

    Parameters
    ----------
    inertia : of the housing [kg m²]; without it the Disk that it is bolted to has it.
    ring_inertia : of the ring [kg m²].
    heat_rating : damping heat that it bears continuously [W], which checks compare with.
    """

    ratings: ClassVar[tuple[str, ...]] = ("heat_rating",)
    idle: ClassVar[tuple[str, ...]] = ratings
    onward: ClassVar[int] = 0

    inertia: Maybe[Inertia] = optional(default=None, description="of the housing, where no Disk has it already")
    ring_inertia: Inertia = Field(description="of the ring")
    heat_rating: Maybe[Power] = optional(default=None, description="rating, damping heat borne continuously")

    @model_validator(mode="after")
    def _heavy(self) -> Self:
        positive(self, "inertia", "ring_inertia", "heat_rating")
        return self

    @property
    def dragged(self) -> bool:
        """Whether no spring holds the ring."""
        return False

    def parts(self) -> tuple[Part, ...]:
        """A housing where it has an inertia of its own, the link, the ring."""
        link = Dragged() if self.dragged else Sprung()
        return (*((Heavy(of="housing of"),) if self.inertia is not None else ()), link, Heavy(1, of="ring of"))

    def inertias(self, number: Numbers) -> tuple[Any, ...]:
        """Of the housing and of the ring."""
        return (*((number("inertia"),) if self.inertia is not None else ()), number("ring_inertia"))


class ViscousDamper(Damper):
    """A ring in silicone oil in a closed housing (Houdaille's damper).

    The oil carries c (ω_housing − ω_ring) and no spring holds the ring: its position matters to nothing, so that one
    multiplier of the line is exactly 1 (one eigenvalue 0), which stability, modes and charts set aside. Silicone is a
    little elastic too: at one frequency ν its complex stiffness k′ + iνc′ is a ``stiffness`` k′ and a ``damping`` c′.

    Parameters
    ----------
    inertia, ring_inertia, heat_rating : as of a ``Damper``.
    damping : c of the oil [N m s/rad]; ``trunnion.damper_optimum`` finds the best for one mode.
    stiffness : k′ of the oil [N m/rad] at the frequency that matters; none by default.

    >>> ViscousDamper(ring_inertia=0.12, damping="45 N*m*s/rad").dragged
    True
    """

    example: ClassVar[str] = 'ring_inertia = "0.12 kg*m^2" and damping = "45 N*m*s/rad"'

    damping: Damping = Field(description="of the oil")
    stiffness: Maybe[Stiffness] = optional(
        default=None, description="of the oil at the frequency that matters; none by default"
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        positive(self, "damping", "stiffness")
        return self

    @property
    def dragged(self) -> bool:
        """Whether no spring holds the ring."""
        return self.stiffness is None

    def stiffness_of(self, number: Numbers) -> Any:
        """As stated, or none."""
        return 0.0 if self.stiffness is None else number("stiffness")


class TunedDamper(Damper):
    """A ring on a spring and a damper between it and its housing: rubber, steel springs in oil.

    Parameters
    ----------
    inertia, ring_inertia, heat_rating : as of a ``Damper``.
    stiffness : between housing and ring [N m/rad].
    damping : [N m s/rad]; ``trunnion.damper_optimum`` finds both for one mode.

    >>> TunedDamper(ring_inertia=0.02, stiffness="1.5 kN*m/rad", damping=2.0).torsional_stiffness
    1500.0
    """

    example: ClassVar[str] = 'ring_inertia = "0.02 kg*m^2", stiffness = "1.5 kN*m/rad" and damping = "2 N*m*s/rad"'

    stiffness: Stiffness = Field(description="between housing and ring")
    damping: Damping = optional(default=0.0, description="between housing and ring")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        positive(self, "stiffness")
        not_negative(self, "damping")
        return self

    def stiffness_of(self, number: Numbers) -> Any:
        """As stated."""
        return number("stiffness")
