"""A shaft whose stiffness changes with its twist: multi-stage clutch dampers, couplings with play, stops."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import pi
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from trunnion.driveline.elements import Doubt, Element, not_negative
from trunnion.driveline.parts import Part, Sprung
from trunnion.driveline.quantities import ANGLE, Angle, Damping, Several, Stiffness, optional, parse
from trunnion.driveline.record import as_tuple, one_of
from trunnion.errors import InputError

LAWS = ("always", "in contact")


quantities = as_tuple(
    "quantities",
    'write breakpoints = ["-4 deg", "4 deg"], stiffnesses = ["2 kN*m/rad", 0, "2 kN*m/rad"], say',
    none=True,
)


class PiecewiseShaft(Element):
    """A shaft with a torque that rises by stages: slope by slope between breakpoints of its twist, 0 at no twist.

    Parameters
    ----------
    breakpoints : twists at which the stiffness changes [rad], rising; the twist is positive when the output leads.
    stiffnesses : below, between and above them [N m/rad], one more than breakpoints; 0 between is free play.
    damping : viscous damping [N m s/rad].
    damping_law : "always", or "in contact": not in the softest stage.
    fork_offset : as of a ``Shaft``.

    Linear analyses take the stage that the static load puts the shaft in.

    >>> clutch = PiecewiseShaft.symmetric([(20.0, "4 deg"), (300.0, "12 deg"), (2000.0, None)])
    >>> clutch.stiffnesses
    (2000.0, 300.0, 20.0, 300.0, 2000.0)
    """

    example: ClassVar[str] = 'breakpoints = ["-4 deg", "4 deg"] and stiffnesses = ["2 kN*m/rad", 0, "2 kN*m/rad"]'

    fewest_breakpoints: ClassVar[int] = 1
    slack: ClassVar[bool] = False
    """Whether all its stiffnesses may be 0."""

    breakpoints: Annotated[Several[Angle], BeforeValidator(quantities)] = Field(
        description="twists at which the stiffness changes, rising"
    )
    stiffnesses: Annotated[Several[Stiffness], BeforeValidator(quantities)] = Field(
        description="below, between and above the breakpoints"
    )
    damping: Damping = optional(default=0.0, description="viscous damping")
    damping_law: Annotated[
        Literal["always", "in contact"],
        BeforeValidator(one_of(LAWS, "is unknown", 'write "always" or "in contact"')),
    ] = Field(default="always", description='when it damps: "always", or "in contact", not in the softest stage')
    fork_offset: Angle = optional(default=0.0, description="angle between the forks at the two ends; 0 is in line")

    def parts(self) -> tuple[Part, ...]:
        """A spring."""
        return (Sprung(),)

    @classmethod
    def symmetric(cls, stages: Iterable[tuple[Any, Any]], **more: Any) -> PiecewiseShaft:
        """The same in both directions, from its stages (stiffness, up to which twist), innermost first.

        The twist of the last stage is ignored.
        """
        found = list(stages)
        if len(found) < 2:
            raise InputError("must be two stages or more", key="stages", value=found, remedy="write a Shaft instead")
        ends = tuple(parse(end, ANGLE) for _, end in found[:-1])
        slopes = tuple(slope for slope, _ in found)
        both = (*(-e for e in reversed(ends)), *ends)
        return cls(breakpoints=both, stiffnesses=(*reversed(slopes[1:]), *slopes), **more)

    def doubts(self) -> Iterator[Doubt]:
        widest = max(self.breakpoints, key=abs, default=0.0)
        if abs(widest) > pi:
            remedy = 'write "4 deg", say: a number alone is in radians'
            yield ("breakpoints", f"reach {widest:g} rad, more than half a turn", remedy)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if len(self.breakpoints) < self.fewest_breakpoints:
            raise InputError("is empty", key="breakpoints", value=[], remedy="write a Shaft instead")
        if len(self.stiffnesses) != len(self.breakpoints) + 1:
            problem = f"must be {len(self.breakpoints) + 1} quantities, one more than breakpoints"
            remedy = f"write {self.example}, say"
            raise InputError(problem, key="stiffnesses", value=list(self.stiffnesses), remedy=remedy)
        if any(b <= a for a, b in zip(self.breakpoints, self.breakpoints[1:], strict=False)):
            raise InputError(
                "must rise", key="breakpoints", value=list(self.breakpoints), remedy="sort them; each once"
            )
        if min(self.stiffnesses) < 0:
            remedy = "write 0 where it carries nothing"
            raise InputError("must not be negative", key="stiffnesses", value=min(self.stiffnesses), remedy=remedy)
        if not (max(self.stiffnesses) > 0 or self.slack):
            raise InputError("are all zero", key="stiffnesses", remedy="leave the shaft out, or give a stage stiffness")
        not_negative(self, "damping", remedy="write 0 for none")
        return self
