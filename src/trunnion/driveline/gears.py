"""A pair of gears as it is: elastic, with backlash, with teeth that are not perfect."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from math import cos
from typing import Annotated, ClassVar, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from trunnion.driveline.elements import Doubt, Element, Teeth, can_lose, not_negative, one_mesh, positive
from trunnion.driveline.gear_losses import DRAG, EFFICIENCY, RATING, MeshLoss, friction_losses
from trunnion.driveline.parts import Geared, Part, Sprung
from trunnion.driveline.quantities import (
    DEGREE,
    Angle,
    Dimensionless,
    ImpactDamping,
    Length,
    Maybe,
    MeshDamping,
    MeshStiffness,
    Power,
    TableList,
    Torque,
    optional,
)
from trunnion.driveline.record import Record, listed, one_of
from trunnion.errors import InputError

LAWS = ("always", "in contact", "never pulling")
DampingLaw = Annotated[
    Literal["always", "in contact", "never pulling"],
    BeforeValidator(one_of(LAWS, "is unknown", 'write one of "always", "in contact", "never pulling"')),
]
COARSEST, WIDEST = 0.2, 0.1
"""Modules [m] and shares of the smaller base radius beyond which a unit was probably left out."""
STEEPEST = 45 * DEGREE
"""Pressure angles are less than this."""


class _MeshHarmonic(Record):
    """A harmonic of the mesh: amplitude · cos(order · mesh phase + phase); the phase grows by a turn per tooth."""

    order: Dimensionless = optional(default=1.0, description="cycles per tooth")
    phase: Angle = optional(default=0.0, description="at zero rotation")

    @model_validator(mode="after")
    def _whole(self) -> Self:
        if self.order < 1 or self.order != int(self.order):
            remedy = "1 is once per tooth"
            raise InputError("must be a whole number from 1", key="order", value=self.order, remedy=remedy)
        return self


class TransmissionError(_MeshHarmonic):
    """One harmonic of the transmission error e along the line of action.

    Parameters
    ----------
    amplitude : [m].
    order : cycles per tooth.
    phase : at zero rotation [rad].

    >>> TransmissionError(amplitude="10 um", order=2).amplitude
    1e-05
    """

    what: ClassVar[str] = "transmission_error"
    example: ClassVar[str] = 'amplitude = "10 um"'
    amplitude: Length = Field(description="along the line of action")


class StiffnessVariation(_MeshHarmonic):
    """One harmonic of the mesh stiffness over its mean.

    Parameters
    ----------
    share : amplitude over the mean stiffness.
    order : cycles per tooth.
    phase : at zero rotation [rad].

    >>> StiffnessVariation(share=0.1).order
    1.0
    """

    what: ClassVar[str] = "stiffness_variation"
    example: ClassVar[str] = "share = 0.1"
    share: Dimensionless = Field(description="amplitude over the mean stiffness")


class GearPair(Element):
    """Two gears in mesh: elastic along the line of action, with backlash and imperfect teeth.

    The gears' own inertia is a Disk on each side; the rotation of both sides is positive in its own sense, as with a
    ``Ratio`` of tooth numbers, which it becomes as the mesh stiffness grows. With u = r₁φ₁ − r₂φ₂ − e the mesh pushes
    with k f(u) + c u′ along the line of action, where f rises with slope 1 outside ± backlash/2 and with
    ``stiffness_ratio`` inside; with ``impact_damping`` d also with d (|u| − backlash/2) u′ outside.

    Parameters
    ----------
    teeth_in, teeth_out, module : tooth numbers and module [m], with
    pressure_angle : [rad], 20° by default; or else
    base_radius_in, base_radius_out : radii of the base circles [m].
    mesh_stiffness : k along the line of action [N/m].
    mesh_damping : c [N s/m].
    damping_law : "always"; "in contact", not inside the backlash; or "never pulling", in contact and so that the teeth
        neither pull nor push with more than twice the elastic force.
    impact_damping : d [N s/m²]: behind the backlash d times the depth of the teeth's contact is damping too, so that
        the force of a landing rises from nothing (Hunt and Crossley's law for a linear spring). In a free impact the
        teeth part slower than k/d, so that they do not pull.
    backlash : play along the line of action [m]; or else
    angular_backlash : play of the output gear with the input gear held [rad].
    stiffness_ratio : slope within the backlash over that outside, 0 (free play) to 1.
    transmission_error, stiffness_variation : harmonics in the mesh phase, see ``TransmissionError`` and
        ``StiffnessVariation``; they take tooth numbers. They follow the mean rotation of the gears.
    efficiency : power that leaves over power that enters, whichever way it flows; without it nothing is lost.
    friction_coefficient : mean one of the teeth instead, which for standard spur gears makes the loss
        (Ohlendorf's formula, see ``trunnion.driveline.gear_losses``).
    drag_torque : of oil and seals at the input shaft, whatever the load [N m].
    heat_rating : power lost borne continuously [W], which checks compare with.

    Linear analyses take the slope that the static load puts the mesh on, times its variation with the mesh phase; the
    transmission error is not part of them.

    >>> pair = GearPair(teeth_in=25, teeth_out=40, module="3 mm", mesh_stiffness="2e8 N/m", backlash="0.1 mm")
    >>> pair.speed_ratio, pair.total_backlash
    (1.6, 0.0001)
    """

    example: ClassVar[str] = 'teeth_in = 25, teeth_out = 40, module = "3 mm" and mesh_stiffness = "2e8 N/m"'

    teeth_in: Teeth | None = Field(default=None, description="teeth of the driving gear")
    teeth_out: Teeth | None = Field(default=None, description="teeth of the driven gear")
    module: Maybe[Length] = optional(default=None, description="pitch diameter over teeth")
    pressure_angle: Angle = optional(default=20 * DEGREE, description="of the teeth; 20 deg by default")
    base_radius_in: Maybe[Length] = optional(
        default=None, description="base circle of the driving gear, instead of teeth"
    )
    base_radius_out: Maybe[Length] = optional(
        default=None, description="base circle of the driven gear, instead of teeth"
    )
    mesh_stiffness: MeshStiffness = Field(description="along the line of action")
    mesh_damping: MeshDamping = optional(default=0.0, description="along the line of action")
    impact_damping: ImpactDamping = optional(
        default=0.0, description="along the line of action, over the depth of contact behind the backlash"
    )
    damping_law: DampingLaw = Field(
        default="always", description='when it damps: "always", "in contact" or "never pulling"'
    )
    backlash: Length = optional(default=0.0, description="play along the line of action")
    angular_backlash: Angle = optional(default=0.0, description="play of the driven gear instead, the driving one held")
    stiffness_ratio: Dimensionless = optional(
        default=0.0, description="slope inside the backlash over that outside; 0: free play, as by default"
    )
    transmission_error: Annotated[
        TableList[TransmissionError], BeforeValidator(listed(TransmissionError, "harmonic"))
    ] = optional(default=(), description="harmonics of the transmission error in the mesh phase")
    stiffness_variation: Annotated[
        TableList[StiffnessVariation], BeforeValidator(listed(StiffnessVariation, "harmonic"))
    ] = optional(default=(), description="harmonics of the mesh stiffness over its mean")
    efficiency: Maybe[Dimensionless] = optional(default=None, description=EFFICIENCY)
    friction_coefficient: Maybe[Dimensionless] = optional(
        default=None, description="mean one of the teeth instead of the efficiency, of standard spur gears"
    )
    drag_torque: Maybe[Torque] = optional(default=None, description=DRAG)
    heat_rating: Maybe[Power] = optional(default=None, description=RATING)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        self._check_size()
        self._check_law()
        self._check_losses()
        phased = "transmission_error" if self.transmission_error else "stiffness_variation"
        if (self.transmission_error or self.stiffness_variation) and self.teeth_in is None:
            remedy = "give teeth_in, teeth_out and module instead of base radii"
            raise InputError("has no mesh phase without tooth numbers", key=phased, remedy=remedy)
        depth = sum(abs(v.share) for v in self.stiffness_variation)
        if depth >= 1:
            remedy = "let the shares add up to less than 1"
            raise InputError("lets the stiffness vanish", key="stiffness_variation", value=depth, remedy=remedy)
        return self

    def _check_size(self) -> None:
        toothed = ("teeth_in", "teeth_out", "module")
        plain = ("base_radius_in", "base_radius_out")
        given = [key for key in (*toothed, *plain) if getattr(self, key) is not None]
        chosen = toothed if any(key in toothed for key in given) else plain
        other = next((key for key in given if key not in chosen), None)
        if other is not None:
            raise InputError(
                f"conflicts with {given[0]}", key=other, remedy=f"write {', '.join(toothed)}, or the radii"
            )
        missing = next((key for key in chosen if getattr(self, key) is None), None)
        if missing is not None:
            missing = missing if given else "teeth_in"
            raise InputError("is missing", key=missing, remedy=f"write {self.example}")
        positive(self, "module", *plain, "mesh_stiffness")
        if not 0 <= self.pressure_angle < STEEPEST:
            remedy = 'write "20 deg", say'
            raise InputError(
                "must lie between 0 and 45 deg", key="pressure_angle", value=self.pressure_angle, remedy=remedy
            )

    def _check_law(self) -> None:
        not_negative(self, "backlash", "angular_backlash", "mesh_damping", "impact_damping", remedy="write 0 for none")
        if self.impact_damping and not self.total_backlash:
            remedy = "give backlash or angular_backlash, or mesh_damping alone"
            raise InputError(
                "needs a backlash, behind which contact begins", key="impact_damping", value=self.impact_damping,
                remedy=remedy,
            )  # fmt: skip
        if self.impact_damping and self.damping_law == "never pulling":
            raise InputError(
                "does not go with damping_law = never pulling", key="impact_damping", value=self.impact_damping,
                remedy='write damping_law = "in contact"',
            )  # fmt: skip
        if self.backlash and self.angular_backlash:
            raise InputError(
                "conflicts with backlash", key="angular_backlash", value=self.angular_backlash, remedy="leave out one"
            )
        if not 0 <= self.stiffness_ratio <= 1:
            remedy = "0 is free play, 1 no backlash at all"
            raise InputError(
                "must lie between 0 and 1", key="stiffness_ratio", value=self.stiffness_ratio, remedy=remedy
            )
        if self.damping_law == "never pulling" and (self.stiffness_ratio or self.stiffness_variation):
            key = "stiffness_ratio" if self.stiffness_ratio else "stiffness_variation"
            remedy = 'write damping_law = "in contact" or "always"'
            raise InputError("does not go with damping_law = never pulling", key=key, remedy=remedy)
        if self.damping_law == "never pulling" and not self.total_backlash:
            raise InputError(
                "needs a backlash", key="damping_law", value=self.damping_law, remedy='give one, or write "always"'
            )

    def _check_losses(self) -> None:
        can_lose(self, "efficiency")
        if self.friction_coefficient is None:
            return
        if self.efficiency is not None:
            remedy = "leave out one"
            raise InputError("conflicts with efficiency", key="friction_coefficient", remedy=remedy)
        if self.teeth_in is None or self.teeth_out is None:
            remedy = "give teeth_in, teeth_out and module instead of base radii, or write efficiency = 0.98, say"
            raise InputError("needs tooth numbers", key="friction_coefficient", remedy=remedy)
        most = 1 / friction_losses(self.teeth_in, self.teeth_out, self.pressure_angle)
        if not 0 < self.friction_coefficient < most:
            raise InputError(
                f"must be above 0, and below {most:.3g}, at which all power is lost", key="friction_coefficient",
                value=self.friction_coefficient, remedy="write 0.06, say",
            )  # fmt: skip

    def doubts(self) -> Iterator[Doubt]:
        if self.stiffness_ratio and not self.total_backlash:
            yield ("stiffness_ratio", "has no backlash to act in", "give backlash or angular_backlash")
        if self.module is not None and self.module > COARSEST:
            yield ("module", f"is {self.module:g} m", 'write "4 mm", say: a number alone is in metres')
        elif self.total_backlash > WIDEST * min(self.radii):
            key = "backlash" if self.backlash else "angular_backlash"
            problem = f"is {self.total_backlash:.3g} m along the line of action, as wide as teeth"
            yield (key, problem, 'write "0.1 mm" or "0.1 deg", say: a number alone is in metres or radians')

    def parts(self) -> tuple[Part, ...]:
        """The output gear where a rigid mesh would hold it, and behind the mesh where it is."""
        return Geared(self.fraction), Sprung(to=1)

    @property
    def losses(self) -> tuple[MeshLoss, ...]:
        """Of the mesh."""
        if self.friction_coefficient is None or self.teeth_in is None or self.teeth_out is None:
            return one_mesh(self, self.fraction)
        over = friction_losses(self.teeth_in, self.teeth_out, self.pressure_angle)
        return (MeshLoss(0, None, 1, -1 / self.speed_ratio, "friction_coefficient", over),)

    @property
    def fraction(self) -> Fraction:
        """Input speed over output speed, exactly: from the tooth numbers, or the decimals of the radii."""
        if self.teeth_in is not None and self.teeth_out is not None:
            return Fraction(self.teeth_out, self.teeth_in)
        return Fraction(str(self.base_radius_out)) / Fraction(str(self.base_radius_in))

    @property
    def speed_ratio(self) -> float:
        """Input speed over output speed."""
        return float(self.fraction)

    @property
    def radii(self) -> tuple[float, float]:
        """Base radii r₁ and r₂ [m]."""
        if self.teeth_in is not None and self.teeth_out is not None and self.module is not None:
            over = self.module * cos(self.pressure_angle) / 2
            return self.teeth_in * over, self.teeth_out * over
        assert self.base_radius_in is not None and self.base_radius_out is not None
        return self.base_radius_in, self.base_radius_out

    @property
    def idle(self) -> tuple[str, ...]:
        """Numbers that do nothing here and are not parameters."""
        if not self.total_backlash:
            return "backlash", "angular_backlash", "stiffness_ratio", "impact_damping"
        return ("angular_backlash",) if self.backlash else ("backlash",)

    @property
    def total_backlash(self) -> float:
        """Play along the line of action [m], however stated."""
        return self.backlash or self.angular_backlash * self.radii[1]
