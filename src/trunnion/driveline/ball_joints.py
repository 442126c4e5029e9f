"""Ball joints of constant velocity as they are made: with a small ripple."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, ClassVar, Self

from pydantic import BeforeValidator, Field, model_validator

from trunnion.driveline.joints import Joint
from trunnion.driveline.quantities import DEGREE, Angle, Dimensionless, Maybe, TableList, optional
from trunnion.driveline.record import Record, listed
from trunnion.errors import InputError

if TYPE_CHECKING:
    from trunnion.driveline.joints import Numbers
    from trunnion.laws.fourier import FourierLaw

HIGHEST_ORDER = 100
STEEPEST_GROWTH = 6


class Ripple(Record):
    """One harmonic by which the output of a joint runs ahead of its input: A sin(order · χ + phase).

    χ is the angle of the input's first ball from the joint plane.

    Parameters
    ----------
    order : cycles per turn of the joint's shaft, a whole number.
    amplitude : A [rad] at the joint's ``reference_angle``, or at any angle where it has none.
    phase : [rad].
    growth : power of tan β with which A grows from none at β = 0; with a reference_angle only.

    >>> Ripple(order=6, amplitude="0.01 deg").order
    6.0
    """

    what: ClassVar[str] = "ripple"
    example: ClassVar[str] = 'order = 6 and amplitude = "0.01 deg"'

    order: Dimensionless = Field(description="cycles per turn of the joint's shaft")
    amplitude: Angle = Field(description="by which the output runs ahead")
    phase: Angle = optional(default=0.0, description="where the joint's first ball stands in the joint plane")
    growth: Dimensionless = optional(default=1.0, description="power of tan(angle) with which the amplitude grows")

    @model_validator(mode="after")
    def _whole(self) -> Self:
        for key, least, most in (("order", 1, HIGHEST_ORDER), ("growth", 1, STEEPEST_GROWTH)):
            value = getattr(self, key)
            if value != int(value) or not least <= value <= most:
                problem = f"must be a whole number from {least} to {most}"
                raise InputError(problem, key=key, value=value, remedy=f"write {key} = {least}, say")
        return self


class RzeppaJoint(Joint):
    """A ball joint of constant velocity whose output ripples a little over a turn, as measured or computed.

    ψ = χ + Σ A_m sin(mχ + φ_m). Without ripple it passes rotation unchanged, as an ``IdealJoint``.

    Parameters
    ----------
    angle : bend angle between its two shafts [rad], less than 90°.
    plane : angle of its plane relative to the previous joint's [rad], positive in the sense of rotation.
    ripple : its harmonics, see ``Ripple``.
    reference_angle : bend angle [rad] at which their amplitudes hold; at another angle they are larger or smaller by
        (tan β/tan β_ref)^growth. Without it they are the same at any angle.

    >>> RzeppaJoint(angle="8 deg", ripple=[{"order": 6, "amplitude": "0.01 deg"}]).orders
    (6,)
    """

    example: ClassVar[str] = 'angle = "8 deg" and ripple = [{ order = 6, amplitude = "0.01 deg" }]'

    angle: Angle = optional(default=0.0, description="bend angle between the two shafts")
    plane: Angle = optional(default=0.0, description="joint plane relative to the previous joint's")
    ripple: Annotated[TableList[Ripple], BeforeValidator(listed(Ripple, "harmonic"))] = optional(
        default=(), description="harmonics of the output over a turn"
    )
    reference_angle: Maybe[Angle] = optional(default=None, description="bend angle at which the amplitudes hold")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.reference_angle is not None and not 0 < self.reference_angle < 90 * DEGREE:
            remedy = "leave it out where the amplitudes do not depend on the angle"
            raise InputError(
                "must lie between 0 and 90 deg", key="reference_angle", value=self.reference_angle, remedy=remedy
            )
        for h in self.ripple:
            if self.reference_angle is None and h.growth != 1:
                remedy = "write reference_angle, at which the amplitudes hold"
                raise InputError("grows from no angle", key="ripple", value=h.growth, remedy=remedy)
        if sum(abs(h.order * h.amplitude) for h in self.ripple) >= 1:
            remedy = "check the units: a number alone is in radians"
            raise InputError("lets the output stand still", key="ripple", remedy=remedy)
        return self

    @property
    def orders(self) -> tuple[int, ...]:
        """Those of its ripple."""
        return tuple(int(h.order) for h in self.ripple)

    def law(self, number: Numbers) -> FourierLaw:
        """The ripple, of amplitudes as they are at the joint's angle."""
        import numpy as np

        from trunnion.laws.fourier import FourierLaw

        amplitudes, phases = [], []
        for i, h in enumerate(self.ripple, start=1):
            amplitude = number(f"ripple {i} amplitude")
            if self.reference_angle is not None:
                amplitude = amplitude * (np.tan(number("angle")) / np.tan(number("reference_angle"))) ** int(h.growth)
            amplitudes.append(amplitude)
            phases.append(number(f"ripple {i} phase"))
        return FourierLaw(self.orders, tuple(amplitudes), tuple(phases))
