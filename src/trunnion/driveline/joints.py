"""Joints, and what all kinds share: a bend angle, and a law of how they pass rotation on."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Self

from pydantic import BeforeValidator, Field, field_validator, model_validator

from trunnion.driveline.elements import Doubt, Element, positive
from trunnion.driveline.parts import Jointed, Part
from trunnion.driveline.quantities import DEGREE, Angle, Dimensionless, Length, Maybe, optional
from trunnion.driveline.record import one_of
from trunnion.errors import InputError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from trunnion.laws.joint import JointLaw

    Numbers = Callable[[str], NDArray[np.float64]]
    """The values of an element's number by its key, one or many, as they broadcast against the angle of a law."""
else:  # the description is read without numpy
    Numbers = Callable[[str], Any]

LARGE_ANGLE = 45 * DEGREE
"""Bend angle [rad] above which a file gets a remark; most joints are not built for more."""


class Joint(Element):
    """What all kinds of joint share: a bend angle below 90°, and a law of how they pass rotation on.

    A kind of joint that does not pass rotation unchanged has ``orders`` and a ``law``; all equations follow from them.
    """

    @property
    def orders(self) -> tuple[int, ...]:
        """Orders of its unevenness in cycles per turn of its own shaft, multiples left out; empty where there is none
        at any angle."""
        return ()

    def parts(self) -> tuple[Part, ...]:
        """A joint."""
        return (Jointed(self.orders),)

    def law(self, number: Numbers) -> JointLaw:
        """How it passes rotation on, ``number(key)`` being the values of its numbers; without orders unchanged."""
        from trunnion.laws.fourier import FourierLaw

        return FourierLaw((), (), ())

    @field_validator("angle", check_fields=False)
    @classmethod
    def _bendable(cls, angle: float) -> float:
        if abs(angle) < 90 * DEGREE:
            return angle
        remedy = 'numbers are radians: write tn.deg(12) or "12 deg" for twelve degrees'
        raise InputError("must be less than 90 deg", value=angle, remedy=remedy)

    def file_doubts(self) -> Iterator[Doubt]:
        angle: float = getattr(self, "angle", 0.0)
        if abs(angle) > LARGE_ANGLE:
            yield (
                "angle",
                f"is {angle / DEGREE:g} deg, more than most joints allow (45 deg)",
                "check the angle",
            )
        yield from super().file_doubts()


class HookeJoint(Joint):
    """A Hooke's (Cardan, universal) joint: a cross between two forks.

    Parameters
    ----------
    angle : bend angle between its two shafts [rad], less than 90°.
    plane : angle of its plane relative to the previous joint's [rad], positive in the sense of rotation.

    >>> HookeJoint(angle="12 deg").orders
    (2,)
    """

    example: ClassVar[str] = 'angle = "12 deg"'

    angle: Angle = Field(description="bend angle between the two shafts")
    plane: Angle = optional(default=0.0, description="joint plane relative to the previous joint's")

    @property
    def orders(self) -> tuple[int, ...]:
        """Twice a turn."""
        return (2,)

    def law(self, number: Numbers) -> JointLaw:
        """That of one cross."""
        from trunnion.laws import hooke

        return hooke.law(number("angle"))


class IdealJoint(Joint):
    """A constant-velocity joint: passes rotation unchanged.

    Parameters
    ----------
    angle : bend angle [rad]; for drawings, secondary couples and support forces.
    plane : angle of its plane relative to the previous joint's [rad], positive in the sense of rotation.

    >>> IdealJoint(angle="12 deg").orders
    ()
    """

    angle: Angle = optional(default=0.0, description="bend angle, for drawings and secondary couples")
    plane: Angle = optional(default=0.0, description="joint plane relative to the previous joint's")


class TripodJoint(Joint):
    """A tripod joint: three trunnions of one shaft in three axial tracks of the other.

    Parameters
    ----------
    angle : bend angle between its two shafts [rad], less than 90°.
    radius : distance of the trunnions' rollers from the spider's centre [m].
    length : of the shaft that carries the spider, from the spider to the joint at its far end [m].
    plane : angle of its plane relative to the previous joint's [rad], positive in the sense of rotation.
    spider : the side the spider is on, "output" (the housing drives) or "input".

    >>> TripodJoint(angle="6 deg", radius="20 mm", length="0.4 m").orders
    (3,)
    """

    example: ClassVar[str] = 'angle = "8 deg", radius = "30 mm" and length = "0.5 m"'

    angle: Angle = Field(description="bend angle between the two shafts")
    radius: Length = Field(description="of the rollers about the spider's centre")
    length: Length = Field(description="of the shaft that carries the spider, up to the joint at its far end")
    plane: Angle = optional(default=0.0, description="joint plane relative to the previous joint's")
    spider: Annotated[
        Literal["input", "output"],
        BeforeValidator(one_of(("input", "output"), "is not a side of the joint", 'write "input" or "output"')),
    ] = Field(default="output", description='side the spider is on: "input" or "output"')

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        positive(self, "radius", "length")
        return self

    @property
    def orders(self) -> tuple[int, ...]:
        """Three times a turn."""
        return (3,)

    def law(self, number: Numbers) -> JointLaw:
        """ψ = χ ± A sin 3χ, minus where the spider drives."""
        from trunnion.laws import tripod

        found = tripod.law(number("angle"), number("radius") / number("length"))
        return found if self.spider == "output" else replace(found, amplitude=tuple(-a for a in found.amplitude))


class DoubleCardanJoint(Joint):
    """Two crosses on a common centre yoke.

    Parameters
    ----------
    angle : bend angle between its two shafts [rad], less than 90°.
    plane : angle of its plane relative to the previous joint's [rad], positive in the sense of rotation.
    distance_ratio : for a joint without centring device, distance of the first cross from the point where the
        two axes meet over that of the second; by default the joint is centred and both crosses bend equally.
    yoke_length : between the two crosses [m], for support forces.

    >>> DoubleCardanJoint(angle="20 deg", distance_ratio=1.1).orders
    (2,)
    """

    example: ClassVar[str] = 'angle = "20 deg"'

    angle: Angle = Field(description="bend angle between the two shafts")
    plane: Angle = optional(default=0.0, description="joint plane relative to the previous joint's")
    distance_ratio: Maybe[Dimensionless] = optional(
        default=None,
        description="without centring: distance of the first cross to where the axes meet over the second's",
    )
    yoke_length: Maybe[Length] = optional(default=None, description="between the two crosses, for support forces")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        positive(self, "distance_ratio", "yoke_length")
        return self

    @property
    def orders(self) -> tuple[int, ...]:
        """Twice a turn without centring; a centred one passes rotation unchanged."""
        return (2,) if self.distance_ratio is not None else ()

    def law(self, number: Numbers) -> JointLaw:
        """That of two unequally bent crosses without inertia between them."""
        from trunnion.laws import double_cardan

        return double_cardan.law(number("angle"), number("distance_ratio"))
