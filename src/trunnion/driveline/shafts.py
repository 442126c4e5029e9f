"""Torsional springs with one stiffness: shafts, which may be tubes with inertia, and what elastic couplings share."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, ClassVar, Self

from pydantic import Field, model_validator

from trunnion.driveline.elements import Doubt, Element, bore, not_negative, one_way, positive, with_defaults
from trunnion.driveline.geometry import tube_inertia, tube_stiffness
from trunnion.driveline.materials import MATERIALS, of_material, without_material
from trunnion.driveline.parts import Heavy, Part, Sprung
from trunnion.driveline.parts import Numbers as Numbers
from trunnion.driveline.quantities import (
    Angle,
    Damping,
    Density,
    Dimensionless,
    Frequency,
    Length,
    Maybe,
    Pressure,
    Stiffness,
    optional,
)
from trunnion.driveline.record import Name
from trunnion.errors import InputError


class Elastic(Element):
    """What joins two shafts by one stiffness and a damper beside it, whatever states them."""

    @property
    def loss(self) -> float | None:
        """Loss factor η; None where damping is a coefficient."""
        return None

    def stiffness_of(self, number: Numbers) -> Any:
        """Torsional stiffness [N m/rad] for the values of its numbers, ``number(key)``, one or many."""
        raise NotImplementedError

    def damping_of(self, number: Numbers) -> Any:
        """Damping [N m s/rad], likewise."""
        return number("damping")

    def links(self, number: Numbers) -> tuple[tuple[Any, Any], ...]:
        """Stiffness and damping of every spring and damper among its parts, in order."""
        return ((self.stiffness_of(number), self.damping_of(number)),)

    @property
    def torsional_stiffness(self) -> float:
        """k [N m/rad], as stated or as it follows."""
        return float(self.stiffness_of(lambda key: getattr(self, key)))

    @property
    def damping_coefficient(self) -> float:
        """c [N m s/rad], as stated or as it follows."""
        return float(self.damping_of(lambda key: getattr(self, key)))


class SpringElement(Elastic):
    """What a shaft and a coupling share: one stiffness, and damping as a coefficient or as a loss factor."""

    loss_keys: ClassVar[tuple[str, ...]] = ("loss_factor",)
    """Keys that each state its loss factor."""

    stiffness: Maybe[Stiffness] = optional(default=None, description="torsional stiffness")
    damping: Damping = optional(default=0.0, description="viscous damping")
    loss_factor: Maybe[Dimensionless] = optional(default=None, description="damping as a loss factor instead")
    loss_factor_frequency: Maybe[Frequency] = optional(
        default=None, description="at which the loss factor holds; by default at all"
    )
    fork_offset: Angle = optional(default=0.0, description="angle between the forks at the two ends; 0 is in line")
    to: Name | None = Field(default=None, description="earlier element to which the far end closes a loop")

    @model_validator(mode="after")
    def _damped_one_way(self) -> Self:
        positive(self, "stiffness", "loss_factor_frequency")
        not_negative(self, "loss_factor")
        beside = next((key for key in self.loss_keys if getattr(self, key) is not None), None)
        if beside is None and self.loss_factor_frequency is not None:
            raise InputError("is needed with loss_factor_frequency", key="loss_factor", remedy="write 0.02, say")
        if beside is not None and self.damping != 0.0:
            remedy = "leave one of the two out"
            raise InputError(f"conflicts with {beside}", key="damping", value=self.damping, remedy=remedy)
        return self

    @property
    def loss(self) -> float | None:
        """Loss factor η, however stated; None where damping is a coefficient."""
        return self.loss_factor

    def parts(self) -> tuple[Part, ...]:
        """A spring, and what of its inertia counts to each end."""
        return (Sprung(closes=self.to), *(Heavy(at, of="end of") for at in (0, 1) if self.moment_of_inertia))

    def stiffness_of(self, number: Numbers) -> Any:
        """Torsional stiffness [N m/rad] for the values of its numbers, ``number(key)``, one or many."""
        return number("stiffness")

    @property
    def damping_coefficient(self) -> float:
        """c [N m s/rad], as stated or from the loss factor at its frequency; 0 where that holds at any frequency."""
        if self.loss is None or self.loss_factor_frequency is None:
            return float(self.damping_of(lambda key: getattr(self, key)))
        return self.loss * self.torsional_stiffness / self.loss_factor_frequency

    @property
    def moment_of_inertia(self) -> float:
        """Polar moment of inertia [kg m²] that it adds, half to each end."""
        return 0.0

    def doubts(self) -> Iterator[Doubt]:
        if self.damping < 0:
            yield (
                "damping",
                "is negative and feeds energy into the line",
                "write it positive unless that is meant",
            )


class Shaft(SpringElement):
    """A torsional spring and damper, optionally a tube with its own inertia (lumped half to each end).

    Parameters
    ----------
    stiffness : torsional stiffness [N m/rad]; or else the tube's geometry.
    damping : viscous damping [N m s/rad]; negative is allowed with a remark.
    loss_factor, loss_factor_frequency : instead of `damping`, η at a frequency ω [rad/s]: c = ηk/ω. Without the
        frequency, η holds at all of them, as k(1 + iη): for ``order_response`` and natural frequencies; equations in
        time refuse it. A relative damping ψ (loss per cycle over elastic energy) is η = ψ/2π.
    fork_offset : angle between the forks at the shaft's two ends [rad]; 0 is in line. Before the first joint,
        the angle of the fork from the joint plane.
    to : earlier element, behind which the far end closes a loop; what follows says where it hangs by ``after``.
    outer_diameter, inner_diameter, length : of the tube [m]; inner_diameter = 0 is a solid bar.
    material : of the tube, by name: gives each of the next four that is not stated.
    shear_modulus : G [Pa].
    density : ρ [kg/m³]; 0 leaves the tube without inertia.
    young_modulus : E [Pa], for bending.
    tensile_strength : σ_B [Pa], for checks.

    >>> tube = Shaft(outer_diameter="90 mm", inner_diameter="84 mm", length="1.5 m", material="steel")
    >>> round(tube.torsional_stiffness), round(tube.moment_of_inertia, 5)
    (82123, 0.01829)
    """

    example: ClassVar[str] = 'stiffness = "12 kN*m/rad"'
    idle: ClassVar[tuple[str, ...]] = ("tensile_strength",)

    outer_diameter: Maybe[Length] = optional(default=None, description="of the tube")
    inner_diameter: Maybe[Length] = optional(default=None, description="of the tube; 0 for a solid bar, as by default")
    length: Maybe[Length] = optional(default=None, description="of the tube")
    material: str | None = Field(
        default=None,
        json_schema_extra={"enum": list(MATERIALS)},
        description='of the tube, "steel" say, instead of the next four',
    )
    shear_modulus: Maybe[Pressure] = optional(default=None, description="of the tube's material; steel 79.3 GPa")
    density: Maybe[Density] = optional(default=None, description="of the tube's material; 0: no inertia, as by default")
    young_modulus: Maybe[Pressure] = optional(default=None, description="of the tube's material, for bending")
    tensile_strength: Maybe[Pressure] = optional(default=None, description="of the tube's material, for checks")

    @model_validator(mode="before")
    @classmethod
    def _tube_defaults(cls, data: Any) -> Any:
        data = of_material(data, ("shear_modulus", "density", "young_modulus", "tensile_strength"))
        return with_defaults(data, "outer_diameter", inner_diameter=0.0, density=0.0)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        tube = ("material", "outer_diameter", "inner_diameter", "length", "shear_modulus", "density", "young_modulus")
        one_way(self, "stiffness", tube, ("outer_diameter", "length", "shear_modulus"))
        positive(self, "outer_diameter", "length", "shear_modulus", "young_modulus", "tensile_strength")
        not_negative(self, "inner_diameter", "density")
        bore(self)
        return self

    @property
    def stated(self) -> dict[str, Any]:
        """The fields that differ from their defaults and do not follow from the material."""
        return without_material(super().stated)

    def stiffness_of(self, number: Numbers) -> Any:
        """As stated, or of the tube."""
        if self.stiffness is not None:
            return number("stiffness")
        return tube_stiffness(*map(number, ("outer_diameter", "inner_diameter", "length", "shear_modulus")))

    def inertias(self, number: Numbers) -> tuple[Any, ...]:
        """Half of the tube's at each end."""
        half = tube_inertia(*map(number, ("outer_diameter", "inner_diameter", "length", "density"))) / 2
        return half, half

    @property
    def moment_of_inertia(self) -> float:
        """Polar moment of the whole tube [kg m²]; 0 where no density is stated."""
        if not self.density:
            return 0.0
        assert self.outer_diameter and self.length and self.inner_diameter is not None
        return tube_inertia(self.outer_diameter, self.inner_diameter, self.length, self.density)
