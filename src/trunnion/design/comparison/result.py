"""What ``compare`` gives: what changed between two lines, and what it did."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite, isnan, nan

from trunnion.design.assessment.check import Check, Status, percent
from trunnion.design.assessment.result import Assessment
from trunnion.driveline.changes import Change
from trunnion.results.counts import any_of
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, computed, internal, labelled, members, variable
from trunnion.results.finding import Finding
from trunnion.results.result import Result
from trunnion.results.units import in_words, with_unit
from trunnion.results.variables import Attribute, Coordinate, Variable, attributes
from trunnion.results.words import HERTZ

QUANTITIES = "frequencies, damping ratios, the largest growth rate and torques of springs, margins of checks"
ALIKE, LITTLE = 1e-9, 1e-3
"""Relative differences below which two values count as the same, and are left out of print."""


@labelled
class Difference:
    """One quantity of both lines, in SI units; NaN where a line has none."""

    name: str = internal()
    kind: str = variable(words='"frequency", "damping ratio", "growth rate", "torque" or "margin"')
    before: float = variable(words="in the unit of the quantity")
    after: float = variable(words="in the unit of the quantity")
    unit: str = variable(name="quantity_unit")
    speed_before: float = variable("", "rad/s", "input speed where it stands", default=nan)
    speed_after: float = variable("", "rad/s", "input speed where it stands", default=nan)

    @property
    def change(self) -> float:
        """after − before."""
        return self.after - self.before

    @property
    def relative(self) -> float:
        """Change over the value before; NaN where that is zero."""
        return self.change / abs(self.before) if self.before else nan

    @property
    def differs(self) -> bool:
        """Whether the two are told apart by more than rounding."""
        if not (isfinite(self.before) and isfinite(self.after)):
            return self.before != self.after and isfinite(self.before) != isfinite(self.after)
        return abs(self.change) > ALIKE * max(abs(self.before), abs(self.after))

    @property
    def matters(self) -> bool:
        """Whether the two differ enough to be printed."""
        size = 1.0 if self.kind == "margin" else max(abs(self.before), abs(self.after))
        return not abs(self.change) <= LITTLE * size


@labelled
class Comparison(Result):
    """Two lines: what changed, in the order of the description, and what it did."""

    names: tuple[str, str] = attribute("of the lines")
    changes: tuple[Change, ...] = internal("in the order of the description")
    differences: tuple[Difference, ...] = members(
        Difference, "quantity", QUANTITIES, name="name", only="kind unit before speed_before after speed_after"
    )
    assessments: tuple[Assessment | None, Assessment | None] = internal(
        "None where a line has no speeds to be judged at"
    )
    unit: str = internal("of speeds in print")
    findings: tuple[Finding, ...] = attribute(default=())

    @property
    def verdicts(self) -> tuple[Status | None, Status | None]:
        """Verdict before and after; None where a line was not judged."""
        before, after = (None if one is None else one.verdict for one in self.assessments)
        return before, after

    @property
    def binding(self) -> tuple[Check | None, Check | None]:
        """The check that decides, before and after."""
        before, after = (None if one is None else one.binding for one in self.assessments)
        return before, after

    def difference(self, name: str) -> Difference:
        """The quantity called ``name``; KeyError where there is none."""
        for one in self.differences:
            if one.name == name:
                return one
        raise KeyError(name)

    def of_kind(self, kind: str) -> tuple[Difference, ...]:
        """Differences of one kind."""
        return tuple(one for one in self.differences if one.kind == kind)

    @property
    @computed(attribute())
    def sentence(self) -> str:
        """What changed and what it did to the verdict, in one sentence."""
        if not self.changes:
            return "the two descriptions are alike"
        many = "1 change" if len(self.changes) == 1 else f"{len(self.changes)} changes"
        if None in self.verdicts:
            return f"{many}; no speeds are stated at which both could be judged"
        before, after = (self._bound(one) for one in self.binding)
        first, second = self.verdicts
        return f"{many}: {first}{before} before, {second}{after} after"

    def declared(self) -> Iterator[Variable | Attribute]:
        """Changes along their own axis, quantities with both values along theirs."""
        yield Coordinate("change", [one.place for one in self.changes], "change")
        yield Variable("value_before", [one.before for one in self.changes], "change")
        yield Variable("value_after", [one.after for one in self.changes], "change")
        yield from super().declared()
        yield from attributes(
            verdicts=["" if one is None else str(one) for one in self.verdicts],
            binding=["" if one is None else one.name for one in self.binding],
        )

    def table(self) -> list[dict[str, object]]:
        """One row a quantity, in words."""
        first, second = self.names
        return [
            {"quantity": one.name, first: self._value(one, 0), second: self._value(one, 1), "change": change_words(one)}
            for one in self.differences
        ]

    def plot(self, axes: Axes | None = None, *, most: int = 12) -> Axes:
        """Margins of checks before and after, or else frequencies; see ``pictures.design.comparison``."""
        return drawing(self, "plot")(self, axes, most=most)

    def _lines(self) -> Iterator[str]:
        yield f"{self.names[0]} → {self.names[1]}: {self.sentence}"
        yield from (f"  {one}" for one in self.changes)
        differing = [one for one in self.differences if one.differs]
        shown = [one for one in differing if one.matters]
        for one in shown:
            yield f"  {one.name}: {self._value(one, 0)} → {self._value(one, 1)}{_in_brackets(one)}"
        if len(differing) > len(shown):
            yield f"  {len(differing) - len(shown)} more move by less than {100 * LITTLE:g} %"
        if self.changes and not differing:
            yield f"  {self._unmoved}"

    @property
    def _unmoved(self) -> str:
        """What none of the changes moves, and what could not be compared."""
        found = {one.kind for one in self.differences}
        kinds = ("frequency", "growth rate", "torque", "margin")
        same = any_of([f"a {kind}" for kind in kinds if kind in found])
        rest = ", ".join(kind for kind in kinds if kind not in found)
        without = " without speeds" if None in self.verdicts else ""
        said = (f"none of these moves {same}" if same else "", f"not compared{without}: {rest}" if rest else "")
        return "; ".join(one for one in said if one)

    def _bound(self, check: Check | None) -> str:
        return "" if check is None else f" ({check.name}, {percent(check.margin)})"

    def _value(self, one: Difference, side: int) -> str:
        value, speed = ((one.before, one.speed_before), (one.after, one.speed_after))[side]
        if not isfinite(value):
            still = one.kind in ("frequency", "damping ratio")
            return ("no oscillation" if still else "none") if isnan(value) else "without bound"
        at = f" at {self.words.speed(float(f'{speed:.6g}'))}" if isfinite(speed) else ""
        return f"{value_words(value, one)}{at}"


def value_words(value: float, one: Difference) -> str:
    """A value of a quantity in an engineer's unit."""
    if one.kind == "margin":
        return f"{float(f'{100 * value:.4g}'):g} %"
    if one.kind == "frequency":
        return HERTZ.speed(value)
    return in_words(value, one.unit)


def change_words(one: Difference) -> str:
    """ "+3.2 %", of margins "+1.4 points", of what may be zero "+0.2 1/s"; "" where there is no change."""
    if not one.differs or not isfinite(one.change):
        return ""
    if one.kind == "margin":
        return f"{100 * one.change:+.3g} points"
    if one.kind == "growth rate" or not isfinite(one.relative):
        return with_unit(f"{one.change:+.3g}", one.unit)
    return f"{100 * one.relative:+.3g} %"


def _in_brackets(one: Difference) -> str:
    words = change_words(one)
    return f" ({words})" if words else ""
