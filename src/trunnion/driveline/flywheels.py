"""A dual-mass flywheel: two inertias with arc springs between them."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Self

from pydantic import BeforeValidator, Field, model_validator

from trunnion.driveline.clutches import MOST_SLIDERS, READ_SLIDERS, Clutch, Slider
from trunnion.driveline.elements import positive
from trunnion.driveline.parts import Heavy, Numbers, Part, Sprung
from trunnion.driveline.quantities import Inertia, TableList, optional
from trunnion.errors import InputError


def _some_sliders(value: object) -> tuple[Slider, ...]:
    made = READ_SLIDERS(value)
    if len(made) > MOST_SLIDERS:
        remedy = "leave friction out for none"
        raise InputError(f"must be at most {MOST_SLIDERS} sliders", value=len(made), remedy=remedy)
    return made


class DualMassFlywheel(Clutch):
    """Primary and secondary flywheel, joined by arc springs with stages, and by their friction where it is stated.

    The springs follow the law of a ``Clutch``, stage by stage; arc springs rub against their channel, which is friction
    in parallel. How that grows with the speed is not followed: state it at the speed that matters.

    Parameters
    ----------
    primary_inertia, secondary_inertia : in front of and behind the springs [kg m²].
    stiffnesses, breakpoints, damping, damping_law, fork_offset : of the arc springs, as of a ``Clutch``.
    friction : sliders in parallel, each a torque and a stiffness; none by default.
    linear_amplitude, linear_frequency : as of a ``Clutch``, where it has friction.

    >>> flywheel = DualMassFlywheel(
    ...     primary_inertia="0.14 kg*m^2", secondary_inertia="0.06 kg*m^2", stiffnesses=["15 N*m/deg"]
    ... )
    >>> print(flywheel.inertia_values)
    (0.14, 0.06)
    """

    example: ClassVar[str] = (
        'primary_inertia = "0.14 kg*m^2", secondary_inertia = "0.06 kg*m^2" and stiffnesses = ["15 N*m/deg"]'
    )
    slack: ClassVar[bool] = False

    primary_inertia: Inertia = Field(description="in front of the springs")
    secondary_inertia: Inertia = Field(description="behind the springs")
    friction: Annotated[TableList[Slider], BeforeValidator(_some_sliders)] = optional(
        default=(), description="sliders in parallel with the springs; none by default"
    )

    @model_validator(mode="after")
    def _two_masses(self) -> Self:
        positive(self, "primary_inertia", "secondary_inertia")
        if not self.friction and self.linear_amplitude is not None:
            raise InputError(
                "is given without friction", key="linear_amplitude", value=self.linear_amplitude,
                remedy="leave it out: linear analyses take the stage that the static load puts the springs in",
            )  # fmt: skip
        return self

    def parts(self) -> tuple[Part, ...]:
        """A mass, the springs, a mass."""
        return (Heavy(of="primary of"), Sprung(), Heavy(1, of="secondary of"))

    def inertias(self, number: Numbers) -> tuple[Any, ...]:
        """Primary and secondary."""
        return number("primary_inertia"), number("secondary_inertia")

    def linear(  # type: ignore[override]
        self, amplitude: float | str | None = None, frequency: float | str | None = None, torque: float | str = 0.0
    ) -> DualMassFlywheel:
        """The same with springs of one stage, without friction, that are its mean at one motion, as of a ``Clutch``."""
        stiffness, damping, offset = self.mean(amplitude, frequency, torque)
        return DualMassFlywheel(
            primary_inertia=self.primary_inertia, secondary_inertia=self.secondary_inertia, stiffnesses=[stiffness],
            damping=damping, fork_offset=offset, name=self.name, after=self.after,
        )  # fmt: skip
