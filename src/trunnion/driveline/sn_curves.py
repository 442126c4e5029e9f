"""S–N curves: how many cycles of an amplitude an element bears, for ``fatigue`` and ``assess``.

::

    [[sn_curve]]
    of = "front tube"                   # an element, or "Shaft *" for all of a kind
    stress_amplitude = "90 MPa"         # shear stress at the outside of the tube, fully reversed …
    cycles = 2e6                        # … is borne so many times
    slope = 5                           # N = cycles (stress_amplitude/S)^slope
    ultimate_stress = "480 MPa"         # mean stresses count by Goodman's line

A curve of torque (``torque_amplitude``, ``ultimate_torque``) does for springs without a section, couplings and meshes.
A curve changes no motion. That of a named element stands instead of its kind's, as a whole.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from trunnion.driveline.addressed import Addressed, Elements, Where, in_turn
from trunnion.driveline.elements import Element
from trunnion.driveline.gears import GearPair
from trunnion.driveline.limits import SPRING_KINDS
from trunnion.driveline.quantities import RATIO, Dimensionless, Maybe, Pressure, Torque, optional, shown
from trunnion.driveline.record import listed, one_of
from trunnion.driveline.shafts import Shaft
from trunnion.errors import InputError

BELOW = {
    "elementary": "the slope goes on",
    "modified": "the slope is 2 slope − 1 from there on (Haibach)",
    "original": "nothing is damaged",
}
"""Forms of Miner's rule: what holds for amplitudes below the one stated."""
_FORMS = one_of(BELOW, "is not a form of Miner's rule", 'write "elementary", "modified" or "original"', near=True)


class SNCurve(Addressed):
    """How many fully reversed cycles an element bears: N = cycles (amplitude/S)^slope.

    Parameters
    ----------
    of : name of the element, or "Shaft *" for all shafts (any kind of element).
    stress_amplitude : shear stress at the outside of a tube [Pa] that is borne for ``cycles``, τ = 16 T D/(π(D⁴ − d⁴)),
        as of ``max_stress``: notches belong into the curve.
    torque_amplitude : torque [N m] that is borne for ``cycles``, instead; of a mesh, at its driven gear.
    cycles : the number of cycles.
    slope : exponent of the curve.
    miner : what smaller amplitudes do: "elementary" (the slope goes on; the default, on the safe side), "modified"
        (slope 2 slope − 1, Haibach), "original" (no damage).
    ultimate_stress, ultimate_torque : stress [Pa] or torque [N m] that breaks it at once: mean values count by
        Goodman's line.
    mean_sensitivity : M, mean values count in the form of the FKM guideline, instead.
    damage_sum : Miner's sum that is allowed.

    Raises
    ------
    InputError : stress and torque at once or neither, numbers that are not positive, an ultimate value below the
        amplitude, two corrections for the mean.

    Examples
    --------
    >>> SNCurve(of="tube", stress_amplitude="90 MPa", cycles=2e6, slope=5, ultimate_stress="480 MPa").of_stress
    True
    """

    what: ClassVar[str] = "S-N curve"
    example: ClassVar[str] = 'of = "Shaft 1", stress_amplitude = "90 MPa", cycles = 2e6 and slope = 5'

    stress_amplitude: Maybe[Pressure] = optional(
        default=None, description="shear stress at the outside of a tube that is borne for the cycles, fully reversed"
    )
    torque_amplitude: Maybe[Torque] = optional(
        default=None, description="torque that is borne for the cycles, fully reversed, instead"
    )
    cycles: Dimensionless = Field(description="cycles for which the amplitude is borne")
    slope: Dimensionless = Field(description="k of N = cycles (amplitude/S)^k")
    miner: Annotated[Literal["elementary", "modified", "original"], BeforeValidator(_FORMS)] = Field(
        default="elementary", description="what smaller amplitudes do: slope goes on, slope 2k − 1, no damage"
    )
    ultimate_stress: Maybe[Pressure] = optional(
        default=None, description="shear stress that breaks it at once: mean stresses count by Goodman's line"
    )
    ultimate_torque: Maybe[Torque] = optional(
        default=None, description="torque that breaks it at once: mean torques count by Goodman's line"
    )
    mean_sensitivity: Maybe[Dimensionless] = optional(
        default=None, description="M: mean values count in the form of the FKM guideline, instead"
    )
    damage_sum: Dimensionless = optional(default=1.0, description="Miner's sum that is allowed")

    @model_validator(mode="after")
    def _sensible(self) -> Self:
        wrong = [*self._wrong_numbers(), *self._wrong_together()]
        if wrong:
            raise InputError.together(wrong)
        return self

    def _wrong_numbers(self) -> Iterator[InputError]:
        for key, value in self.stated.items():
            if key not in ("of", "miner") and not value > 0:
                yield InputError("must be positive", key=key, value=value, remedy=f"write {self.example}, say")
        if self.mean_sensitivity is not None and self.mean_sensitivity > 1:
            remedy = "write 0.2, say: M is the loss of amplitude over mean stress"
            yield InputError("must not exceed 1", key="mean_sensitivity", value=self.mean_sensitivity, remedy=remedy)

    def _wrong_together(self) -> Iterator[InputError]:
        if (self.stress_amplitude is None) == (self.torque_amplitude is None):
            problem = "is missing" if self.stress_amplitude is None else "conflicts with torque_amplitude"
            remedy = "write stress_amplitude of a tube, or torque_amplitude: one of the two"
            yield InputError(problem, key="stress_amplitude", value=self.stress_amplitude, remedy=remedy)
            return
        of_other, ultimate = ("torque", "stress") if self.stress_amplitude is not None else ("stress", "torque")
        if getattr(self, f"ultimate_{of_other}") is not None:
            key, remedy = f"ultimate_{of_other}", f"write ultimate_{ultimate}"
            yield InputError(f"conflicts with {ultimate}_amplitude", key=key, value=getattr(self, key), remedy=remedy)
        if self.ultimate is not None and self.mean_sensitivity is not None:
            remedy = "leave one of the two out: Goodman's line, or the form of the FKM guideline"
            value = self.mean_sensitivity
            yield InputError(f"conflicts with ultimate_{ultimate}", key="mean_sensitivity", value=value, remedy=remedy)
        if self.ultimate is not None and self.ultimate <= self.amplitude:
            problem = f"does not lie above {ultimate}_amplitude"
            remedy = "check both: what breaks a part at once is more than what it bears many times"
            yield InputError(problem, key=f"ultimate_{ultimate}", value=self.ultimate, remedy=remedy)

    @property
    def of_stress(self) -> bool:
        """Whether it is a curve of stress [Pa]; otherwise of torque [N m]."""
        return self.stress_amplitude is not None

    @property
    def amplitude(self) -> float:
        """What is borne for ``cycles`` [Pa or N m]."""
        found = self.stress_amplitude if self.of_stress else self.torque_amplitude
        assert found is not None
        return found

    @property
    def ultimate(self) -> float | None:
        """What breaks it at once [Pa or N m]; None where it is not stated."""
        return self.ultimate_stress if self.of_stress else self.ultimate_torque

    @property
    def shown(self) -> dict[str, object]:
        """What it states as an engineer writes it."""
        stated = {key: value for key, value in self.stated.items() if key != "of"}
        kinds = {key: self.quantity_of(key) for key in stated}
        return {
            key: shown(value, kind) if (kind := kinds[key]) is not None and kind is not RATIO else value
            for key, value in stated.items()
        }

    def wrong_for(self, key: str, concerned: Elements, where: Where) -> Iterator[InputError]:
        """That none of the elements ``concerned`` can have such a curve."""
        if key not in ("stress_amplitude", "torque_amplitude") or any(self.fits(one) for _, one in concerned):
            return
        element = concerned[0][1]
        if self.of_stress and isinstance(element, Shaft):
            remedy = "describe it by outer_diameter, length and material, or write torque_amplitude"
            yield InputError("needs the outer_diameter of the Shaft", **where, remedy=remedy)
        else:
            remedy = "write torque_amplitude" if isinstance(element, _TORQUE) else "name a shaft, a coupling or a mesh"
            yield InputError(f"does not belong to a {element.kind}", **where, remedy=remedy)

    def fits(self, element: Element) -> bool:
        """Whether an element can have such a curve: of stress, a shaft with a section; of torque, what has a torque."""
        if self.of_stress:
            return isinstance(element, Shaft) and element.outer_diameter is not None
        return isinstance(element, _TORQUE)


_TORQUE: tuple[type[Element], ...] = (*SPRING_KINDS, GearPair)
SNCurves = Annotated[
    tuple[SNCurve, ...],
    BeforeValidator(
        listed(
            SNCurve, "stress-life curve",
            'write sn_curves=[tn.SNCurve(of="Shaft 1", torque_amplitude="2 kN*m", cycles=2e6, slope=5)]', owner="of",
        )
    ),
]  # fmt: skip


def curves_of(curves: Sequence[SNCurve], parts: Elements) -> dict[str, SNCurve]:
    """The curve of every element that has one, by its name in the order of the line."""
    found: dict[str, Any] = {}
    for curve, name, element in in_turn(curves, parts):
        if curve.fits(element):
            found[name] = curve
    return {name: found[name] for name, _ in parts if name in found}
