"""Torques that shake a disk: harmonic in time, or in the disk's own rotation (engine orders)."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, Any, Self

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator

from trunnion.driveline.quantities import ANGLE, FREQUENCY, TORQUE, Angle, Dimensionless, Frequency, Torque
from trunnion.driveline.refusals import numbered, refuse
from trunnion.errors import InputError


class Excitation(BaseModel):
    """One harmonic torque, positive in the sense of rotation: A cos(order · rotation + phase), or A cos(ωt + phase).

    Several orders together are an engine-order table.

    Parameters
    ----------
    amplitude : A [N m].
    order : cycles per turn of the disk, 0.5 for a four-stroke cylinder; or else
    frequency : ω [rad/s].
    phase : at zero rotation or time [rad].
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    amplitude: Torque = Field(description="of the torque; positive drives")
    order: Dimensionless | None = Field(default=None, description="cycles per turn of the disk")
    frequency: Frequency | None = Field(default=None, description="in time, instead of an order")
    phase: Angle = Field(default=0.0, description="at zero rotation or time")

    def __init__(self, **data: Any) -> None:
        try:
            super().__init__(**data)
        except ValidationError as error:
            example = 'order = 2 and amplitude = "40 N*m"'
            raise refuse(error, type(self), data, element="excitation", example=example) from None

    @model_validator(mode="after")
    def _one_clock(self) -> Self:
        if (self.order is None) == (self.frequency is None):
            given = "stands beside order" if self.order is not None else "is missing beside amplitude"
            remedy = 'give order = 2, say, or frequency = "50 Hz"'
            raise InputError(given, key="frequency" if self.order is not None else "order", remedy=remedy)
        for key in ("order", "frequency"):
            value = getattr(self, key)
            if value is not None and not value > 0:
                raise InputError("must be positive", key=key, value=value, remedy="a constant is a load_torque")
        return self

    @property
    def stated(self) -> dict[str, Any]:
        """The fields that differ from their defaults."""
        return {k: v for k, f in type(self).model_fields.items() if (v := getattr(self, k)) != f.default}


EXCITATION_KINDS = {"amplitude": TORQUE, "frequency": FREQUENCY, "phase": ANGLE}
"""Physical kinds of its quantities; an order is a plain number."""


def _tables(value: object) -> tuple[Excitation, ...]:
    remedy = 'write excitation = [{ order = 2, amplitude = "40 N*m" }]'
    if isinstance(value, str | dict | Excitation) or not isinstance(value, Iterable):
        raise InputError("is not a list of harmonic torques", value=value, remedy=remedy)
    made, wrong = [], []
    for place, item in enumerate(value, start=1):
        try:
            if not isinstance(item, Excitation | dict):
                raise InputError("is not a harmonic torque", value=item, remedy=remedy)
            made.append(item if isinstance(item, Excitation) else Excitation(**item))
        except InputError as error:
            wrong.append(numbered(error, "excitation", place))
    if wrong:
        raise InputError.together(wrong)
    return tuple(made)


Excitations = Annotated[tuple[Excitation, ...], BeforeValidator(_tables)]
