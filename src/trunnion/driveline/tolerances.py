"""How far the numbers of a line scatter from one specimen to the next: tolerances of an element, or of a kind.

::

    [[tolerance]]
    of = "Shaft *"                          # each shaft by itself; or the name of one element
    stiffness = "5 %"                       # within ±5 % of what the element states, all values alike
    damping = ["1 N*m*s/rad", "4 N*m*s/rad"]    # between two values, all alike
    inertia = { deviation = "2 %" }         # normally distributed, cut at three standard deviations
    fork_offset = "0.5 deg"                 # within ±0.5 deg

A tolerance changes no motion; ``tolerance_study`` and ``certify_stability`` go by it. What an element states of its own
goes before its kind's.
"""

from __future__ import annotations

import difflib
import math
import warnings
from collections.abc import Iterable, Iterator, Sequence
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, ValidationError, WithJsonSchema

from trunnion.driveline.elements import Element
from trunnion.driveline.kinds import KINDS
from trunnion.driveline.packed_numbers import UNITS
from trunnion.driveline.quantities import KINDS as QUANTITIES
from trunnion.driveline.quantities import RATIO, Kind, parse, written
from trunnion.driveline.refusals import nearest, numbered, refuse
from trunnion.errors import InputError, InputRemark

FARTHEST = 3.0
"""Standard deviations that stand for the ends of a normal distribution, which has none."""
LINES_OWN = ("speed", "damping_ratio", "damping_ratio_frequency")
SCATTERING: dict[str, Kind] = {
    key: next(kind for kind in QUANTITIES if kind.unit == unit) for key, unit in UNITS.items() if key not in LINES_OWN
}
"""Numbers of elements that can scatter, and their physical kinds."""
_HOW = 'write "5 %", "0.5 deg", ["1 kN*m/rad", "2 kN*m/rad"] or { deviation = "2 %" }'


class Scatter(BaseModel):
    """How one number scatters.

    form: "share" (± ``numbers[0]`` of the nominal value), "within" (± in SI), "range" (from, to, in SI), and the normal
    distributions "normal" and "deviation", whose standard deviation is a share, or in SI.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

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
        reach = self.numbers[0] * (abs(nominal) if self.form in ("share", "normal") else 1.0)
        reach *= FARTHEST if self.form in ("normal", "deviation") else 1.0
        return nominal - reach, nominal + reach

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


class Tolerance(BaseModel):
    """Tolerances of one element or of all elements of a kind, each of which scatters by itself.

    Parameters
    ----------
    of : name of the element, or "Shaft *" for all shafts (any kind of element).
    stiffness, inertia, angle, … : any number that the element states, as "5 %" or 0.05 (within ±5 % of it), "0.5 deg"
        (within ±0.5°), ["11 kN*m/rad", "13 kN*m/rad"] (between the two), {"deviation": "2 %"} (normal, cut at three
        standard deviations).

    Raises
    ------
    InputError : nothing scatters; what is no tolerance.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    of: str
    scatters: tuple[Scatter, ...]

    def __init__(self, of: object = None, **numbers: Any) -> None:
        label = f"tolerance of {of}" if isinstance(of, str) else "tolerance"
        wrong, made = [], []
        if not isinstance(of, str):
            what = "is missing" if of is None else "is no name"
            wrong.append(InputError(what, element=label, key="of", value=of, remedy='write of = "Shaft 1", say'))
        for key, value in numbers.items():
            try:
                made.append(_scatter(key, value))
            except InputError as error:
                wrong.append(InputError(error.problem, element=label, key=key, value=value, remedy=error.remedy))
        if not numbers and not wrong:
            remedy = 'write stiffness = "5 %", say'
            wrong.append(InputError("lets nothing scatter", element=label, key="of", value=of, remedy=remedy))
        if wrong:
            raise InputError.together(wrong)
        try:
            super().__init__(of=of, scatters=tuple(sorted(made, key=lambda one: list(SCATTERING).index(one.key))))
        except ValidationError as error:
            raise refuse(error, type(self), {"of": of}, element=label) from None

    @property
    def kind(self) -> str | None:
        """The kind of element it holds for; None where ``of`` names one element."""
        owner, star = self.of[:-2], self.of[-2:]
        return owner if star == " *" else None

    @property
    def written(self) -> dict[str, object]:
        """As a file states it."""
        return {"of": self.of, **{one.key: one.written for one in self.scatters}}


def _scatter(key: str, value: object) -> Scatter:
    if key not in SCATTERING:
        close = difflib.get_close_matches(key, list(SCATTERING), n=1, cutoff=0.7)
        example = 'give the number its own key: of = "Shaft 1" and stiffness = "5 %", say'
        raise InputError("is no number that can scatter", remedy=nearest(key, SCATTERING) if close else example)
    kind = SCATTERING[key]
    if isinstance(value, dict):
        if set(value) != {"deviation"}:
            raise InputError("is no distribution", remedy='write { deviation = "2 %" }')
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


def _size(value: object, kind: Kind) -> tuple[Literal["share", "within"], float]:
    """How far to either side: a share, or in SI."""
    text = value.strip().removeprefix("±").strip() if isinstance(value, str) else ""
    absolute = bool(text) and not text.endswith("%") and kind is not RATIO
    size = parse(text, kind) if absolute else parse(text or value, RATIO)
    if not size > 0 or (not absolute and size >= 1):
        bound = "must be positive" if absolute else "must lie between 0 and 1 (100 %)"
        raise InputError(bound, remedy=_HOW)
    return "within" if absolute else "share", size


def _tables(value: object) -> tuple[Tolerance, ...]:
    remedy = 'write tolerances=[tn.Tolerance("Shaft 1", stiffness="5 %")]'
    if isinstance(value, str | dict | Tolerance) or not isinstance(value, Iterable):
        raise InputError("is not a list of tolerances", value=value, remedy=remedy)
    made, wrong = [], []
    for place, item in enumerate(value, start=1):
        try:
            if not isinstance(item, Tolerance | dict):
                raise InputError("is not a tolerance", value=item, remedy=remedy)
            made.append(item if isinstance(item, Tolerance) else Tolerance(**item))
        except InputError as error:
            wrong.append(error if isinstance(item, dict) and "of" in item else numbered(error, "tolerance", place))
    if wrong:
        raise InputError.together(wrong)
    return tuple(made)


Tolerances = Annotated[tuple[Tolerance, ...], BeforeValidator(_tables), WithJsonSchema({"type": "array"})]


def tolerances_of(
    tolerances: Sequence[Tolerance], names: Sequence[str], elements: Sequence[Element]
) -> dict[str, tuple[object, ...]]:
    """What every number that scatters does so by, by path ("Shaft 1.stiffness"), as ``tolerance_study`` takes it."""
    found: dict[str, tuple[object, ...]] = {}
    for one in sorted(tolerances, key=lambda t: t.kind is None):  # the element's own last, so that it stays
        for name, element in zip(names, elements, strict=True):
            if name != one.of and element.kind != one.kind:
                continue
            for scatter in one.scatters:
                nominal = _nominal(element, scatter.key)
                if nominal is not None:
                    found[f"{name}.{scatter.key}"] = scatter.given(nominal)
    return found


def wrong_tolerances(
    tolerances: Sequence[Tolerance], names: Sequence[str], elements: Sequence[Element]
) -> Iterator[InputError]:
    """Tolerances of no element, of numbers it does not state, stated twice, or beyond what it can have."""
    seen: set[tuple[str, str]] = set()
    for one in tolerances:
        label = f"tolerance of {one.of}"
        concerned = [
            (n, e) for n, e in zip(names, elements, strict=True) if one.of == n or one.kind == e.kind
        ]  # fmt: skip
        if not concerned:
            known = [*names, *(f"{kind} *" for kind in dict.fromkeys(e.kind for e in elements))]
            problem = "has no element in this driveline" if one.kind in KINDS else "is not an element"
            yield InputError(problem, element="tolerance", key="of", value=one.of, remedy=nearest(one.of, known))
            continue
        for scatter in one.scatters:
            if (one.of, scatter.key) in seen:
                yield InputError(
                    "is stated twice", element=label, key=scatter.key, value=scatter.written,
                    remedy="leave one of the two out",
                )  # fmt: skip
            seen.add((one.of, scatter.key))
            having = [(n, e, v) for n, e in concerned if (v := _nominal(e, scatter.key)) is not None]
            if not having:
                known = [key for key in SCATTERING if _nominal(concerned[0][1], key) is not None]
                yield InputError(
                    f"is no number that {concerned[0][0]} states", element=label, key=scatter.key,
                    value=scatter.written, remedy=nearest(scatter.key, known),
                )  # fmt: skip
            for name, element, nominal in having:
                yield from _impossible(label, name, element, scatter, nominal)


def _impossible(label: str, name: str, element: Element, scatter: Scatter, nominal: float) -> Iterator[InputError]:
    where: dict[str, Any] = {"element": label, "key": scatter.key, "value": scatter.written}
    if nominal == 0 and scatter.form in ("share", "normal"):
        example = f'a value with its unit, as "{SCATTERING[scatter.key].example}"'
        yield InputError(f"is a share of nothing: {name} states zero", **where, remedy=f"write {example}")
        return
    for end in scatter.ends(nominal):
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", InputRemark)
                type(element)(**{**element.stated, scatter.key: end})
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
