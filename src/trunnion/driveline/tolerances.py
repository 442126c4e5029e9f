"""How far the numbers of a line scatter from one specimen to the next: tolerances of an element, or of each of several.

::

    [[tolerance]]
    of = "Shaft *"                          # each shaft by itself; or the name of one element
    stiffness = "5 %"                       # within ±5 % of what the element states, all values alike
    damping = ["1 N*m*s/rad", "4 N*m*s/rad"]    # between two values, all alike
    inertia = { deviation = "2 %" }         # normally distributed, cut at three standard deviations
    fork_offset = "0.5 deg"                 # within ±0.5 deg

A tolerance changes no motion; ``tolerance_study`` and ``certify_stability`` go by it. A named element's
tolerance overrides its kind's.
"""

from __future__ import annotations

import difflib
import math
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, WithJsonSchema

from trunnion.driveline.addressed import Addressed, Elements, Where, in_turn
from trunnion.driveline.elements import Element
from trunnion.driveline.packed_numbers import UNITS
from trunnion.driveline.quantities import RATIO, QuantityKind, kind_of, parse, written
from trunnion.driveline.record import listed
from trunnion.driveline.refusals import nearest
from trunnion.errors import InputError, InputRemark

FARTHEST = 3.0
"""Standard deviations that stand for the ends of a normal distribution, which has none."""
LINES_OWN = ("speed", "damping_ratio", "damping_ratio_frequency")
SCATTERING: dict[str, QuantityKind] = {
    key: kind for key, unit in UNITS.items() if key not in LINES_OWN and (kind := kind_of(unit))
}
"""Numbers of elements that can scatter, and their physical kinds."""
_HOW = 'write "5 %", "0.5 deg", ["1 kN*m/rad", "2 kN*m/rad"] or { deviation = "2 %" }'


@dataclass(frozen=True)
class Scatter:
    """How one number scatters.

    form: "share" (± ``numbers[0]`` of the nominal value), "within" (± in SI), "range" (from, to, in SI), and the normal
    distributions "normal" and "deviation", whose standard deviation is a share, or in SI.
    """

    key: str
    form: Literal["share", "within", "range", "normal", "deviation"]
    numbers: tuple[float, ...]

    def given(self, nominal: float) -> tuple[object, ...]:
        """As ``tolerance_study`` takes it, for a number that is ``nominal``."""
        if self.form == "within":
            return "range", nominal - self.numbers[0], nominal + self.numbers[0]
        return (self.form, *self.numbers)

    def ends(self, nominal: float) -> tuple[float, float]:
        """Lowest and highest value."""
        if self.form == "range":
            return self.numbers[0], self.numbers[1]
        deviation = self.deviation(nominal)
        reach = self._size(nominal) if deviation is None else FARTHEST * deviation
        return nominal - reach, nominal + reach

    def deviation(self, nominal: float) -> float | None:
        """Standard deviation of a normal distribution; None where every value within its ends is alike."""
        return self._size(nominal) if self.form in ("normal", "deviation") else None

    def _size(self, nominal: float) -> float:
        return self.numbers[0] * (abs(nominal) if self.form in ("share", "normal") else 1.0)

    @property
    def written(self) -> object:
        """As a file states it."""
        kind = SCATTERING[self.key]
        if self.form == "range":
            return [written(number, kind) for number in self.numbers]
        if self.form in ("share", "normal"):
            size: object = self.numbers[0]
        else:
            size = written(self.numbers[0], kind)
            # A bare number would be a share.
            size = size if isinstance(size, str) else f"{self.numbers[0]!r} {kind.unit}"
        return size if self.form in ("share", "within") else {"deviation": size}


class Tolerance(Addressed):
    """Tolerances of one element or of all elements of a kind, each of which scatters by itself.

    Parameters
    ----------
    of : name of the element, or "Shaft *" for all shafts (any kind of element).
    stiffness, inertia, angle, … : any number that the element states, as "5 %" or 0.05 (within ±5 % of it), "0.5 deg"
        (within ±0.5°), ["11 kN*m/rad", "13 kN*m/rad"] (between the two), {"deviation": "2 %"} (normal, cut at three
        standard deviations).

    Raises
    ------
    InputError : nothing scatters; what is not a tolerance.

    >>> Tolerance(of="Shaft *", stiffness="5 %", fork_offset="0.5 deg").shown
    {'stiffness': 0.05, 'fork_offset': '0.5 deg'}
    """

    what: ClassVar[str] = "tolerance"

    of: str
    scatters: tuple[Scatter, ...]

    def __init__(self, of: object = None, **numbers: Any) -> None:
        label = self.called({"of": of})
        wrong: list[InputError] = []
        made: list[Scatter] = []
        if not isinstance(of, str):
            what = "is missing" if of is None else "is not a name"
            wrong.append(InputError(what, element=label, key="of", value=of, remedy='write of = "Shaft 1", say'))
        for key, value in numbers.items():
            try:
                made.append(_scatter(key, value))
            except InputError as error:
                wrong.append(error.but(element=label, key=key, value=value))
        if not numbers and not wrong:
            remedy = 'write stiffness = "5 %", say'
            wrong.append(InputError("lets nothing scatter", element=label, key="of", value=of, remedy=remedy))
        if wrong:
            raise InputError.together(wrong)
        stated: dict[str, Any] = {"of": of, "scatters": sorted(made, key=lambda one: list(SCATTERING).index(one.key))}
        super().__init__(**stated)

    @property
    def written(self) -> dict[str, object]:
        """As a file states it."""
        return {"of": self.of, **self.shown}

    @property
    def shown(self) -> dict[str, object]:
        """How each number scatters, as a file states it."""
        return {one.key: one.written for one in self.scatters}

    def wrong_for(self, key: str, concerned: Elements, where: Where) -> Iterator[InputError]:
        """That none of the elements ``concerned`` states a number, or what it reaches and cannot be."""
        scatter = next(one for one in self.scatters if one.key == key)
        having = [(n, e, v) for n, e in concerned if (v := _nominal(e, key)) is not None]
        if not having:
            known = [one for one in SCATTERING if _nominal(concerned[0][1], one) is not None]
            problem = f"is not a number that {concerned[0][0]} states"
            yield InputError(problem, **where, remedy=nearest(key, known))
        for name, element, nominal in having:
            yield from _impossible(where, name, element, scatter, nominal)


def _scatter(key: str, value: object) -> Scatter:
    if key not in SCATTERING:
        close = difflib.get_close_matches(key, list(SCATTERING), n=1, cutoff=0.7)
        example = 'give the number its own key: of = "Shaft 1" and stiffness = "5 %", say'
        raise InputError("is not a number that can scatter", remedy=nearest(key, SCATTERING) if close else example)
    kind = SCATTERING[key]
    if isinstance(value, dict):
        if set(value) != {"deviation"}:
            raise InputError("is not a distribution", remedy='write { deviation = "2 %" }')
        form, size = _size(value["deviation"], kind)
        if form == "share" and size * FARTHEST >= 1:
            raise InputError("reaches zero at three standard deviations", remedy='write { deviation = "2 %" }')
        return Scatter(key=key, form="normal" if form == "share" else "deviation", numbers=(size,))
    if isinstance(value, list | tuple):
        if len(value) != 2:
            raise InputError("must have a lower and an upper end", remedy=_HOW)
        low, high = (parse(end, kind) for end in value)
        if not low < high:
            raise InputError("must rise from its lower to its upper end", remedy=_HOW)
        return Scatter(key=key, form="range", numbers=(low, high))
    form, size = _size(value, kind)
    return Scatter(key=key, form=form, numbers=(size,))


def _size(value: object, kind: QuantityKind) -> tuple[Literal["share", "within"], float]:
    """How far to either side: a share, or in SI."""
    text = value.strip().removeprefix("±").strip() if isinstance(value, str) else ""
    absolute = bool(text) and not text.endswith("%") and kind is not RATIO
    size = parse(text, kind) if absolute else parse(text or value, RATIO)
    if not size > 0 or (not absolute and size >= 1):
        bound = "must be positive" if absolute else "must lie between 0 and 1 (100 %)"
        raise InputError(bound, remedy=_HOW)
    return "within" if absolute else "share", size


Tolerances = Annotated[
    tuple[Tolerance, ...],
    BeforeValidator(
        listed(Tolerance, "tolerance", 'write tolerances=[tn.Tolerance("Shaft 1", stiffness="5 %")]', owner="of")
    ),
    WithJsonSchema({"type": "array"}),
]


def tolerances_of(tolerances: Sequence[Tolerance], parts: Elements) -> dict[str, tuple[object, ...]]:
    """What every number that scatters does so by, by path ("Shaft 1.stiffness"), as ``tolerance_study`` takes it."""
    found: dict[str, tuple[object, ...]] = {}
    for one, name, element in in_turn(tolerances, parts):
        for scatter in one.scatters:
            nominal = _nominal(element, scatter.key)
            if nominal is not None:
                found[f"{name}.{scatter.key}"] = scatter.given(nominal)
    return found


def _impossible(where: Where, name: str, element: Element, scatter: Scatter, nominal: float) -> Iterator[InputError]:
    if nominal == 0 and scatter.form in ("share", "normal"):
        example = f'a value with its unit, as "{SCATTERING[scatter.key].example}"'
        yield InputError(f"is a share of nothing: {name} states zero", **where, remedy=f"write {example}")
        return
    for end in scatter.ends(nominal):
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", InputRemark)
                element.but(**{scatter.key: end})
        except InputError as error:
            said = error.problems[0].problem
            yield InputError(
                f"lets {name} reach {end:.6g} {SCATTERING[scatter.key].unit}, which {said}", **where,
                remedy="narrow the tolerance",
            )  # fmt: skip
            return


def _nominal(element: Element, key: str) -> float | None:
    """The number that an element states or has by default; None where it has none of that name."""
    value = getattr(element, key, None) if key in type(element).model_fields else None
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        return None
    return float(value)
