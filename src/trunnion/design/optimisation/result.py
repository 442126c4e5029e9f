"""What ``optimise`` gives: the best design within bounds, verified, and the front where two aims conflict."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from trunnion.arrays import Array, Integers
from trunnion.design.assessment.result import Assessment
from trunnion.driveline.driveline import Driveline
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, computed, coordinate, internal, labelled, variable
from trunnion.results.finding import Finding
from trunnion.results.result import Result

OF_FREE, OF_AIM = "in the unit of the free number", "in the unit of the aim"


@labelled
class Optimum(Result):
    """The best design found; aims are those of the design, computed anew on the full grid of speeds."""

    line: Driveline = internal("with the best design")
    free: tuple[str, ...] = coordinate("free", words="numbers chosen")
    units: tuple[str, ...] = variable("free", name="free_unit")
    low: Array = variable("free", words=OF_FREE)
    high: Array = variable("free", words=OF_FREE)
    before: Array = variable("free", words=OF_FREE)
    value: Array = variable("free", words=OF_FREE)
    aims: tuple[str, ...] = coordinate("aim", words="what was to be best")
    aim_units: tuple[str, ...] = variable("aim", name="aim_unit")
    largest: tuple[bool, ...] = variable("aim", words="whether the largest was wanted")
    aim_before: Array = variable("aim", words=OF_AIM)
    aim: Array = variable("aim", words=OF_AIM, name="aim_value")
    front_value: Array = variable("point free", words=OF_FREE)
    front: Array = variable("point aim", words=OF_AIM)
    broken: tuple[str, ...] = attribute("checks that the design violates")
    assessment: Assessment | None = internal("of the design, None without speeds")
    designs: int = attribute("how many were computed")
    seed: int = attribute("of the search")
    findings: tuple[Finding, ...] = attribute(default=())
    ended: str = attribute("what ended the search before it was done, as a clause", default="")

    @property
    @computed(coordinate("point"), after="aim")
    def points(self) -> Integers:
        """Numbers of the designs that no other one beats in all aims, by rising first aim; one point for one aim."""
        return np.arange(len(self.front))

    @property
    def values(self) -> dict[str, float]:
        """The numbers chosen, by path, SI units."""
        return dict(zip(self.free, self.value.tolist(), strict=True))

    @property
    @computed(attribute())
    def sentence(self) -> str:
        """What was reached, with which numbers, in one sentence."""
        reached = " and ".join(
            f"{name} {self.words.value(new, unit, 5)} instead of {self.words.value(old, unit, 5)}"
            for name, unit, old, new in zip(self.aims, self.aim_units, self.aim_before, self.aim, strict=True)
        )
        ended = f"; {self.ended} after {self.designs} designs, and a better one may be left" if self.ended else ""
        return f"{reached}, with {self._chosen(self.value)}{ended}"

    def table(self) -> list[dict[str, object]]:
        """One row a point of the front: aims, then the numbers that reach them."""
        names, units = (*self.aims, *self.free), (*self.aim_units, *self.units)
        rows = np.concatenate([self.front, self.rounded(self.front_value)], axis=1).tolist()
        return [{n: self.words.value(v, u, 5) for n, u, v in zip(names, units, row, strict=True)} for row in rows]

    def plot(self, axes: Axes | None = None) -> Axes:
        """The front, or of one aim where the numbers lie between their bounds; see ``pictures.design.optimum``."""
        return drawing(self, "plot")(self, axes)

    def _lines(self) -> Iterator[str]:
        yield self.sentence
        if len(self.aims) > 1 and len(self.front) > 1:
            yield f"  the aims conflict; {len(self.front)} designs that no other beats in both:"
            yield from (f"    {', '.join(f'{k} {v}' for k, v in row.items())}" for row in self.table())
        elif len(self.aims) > 1:
            yield "  the aims do not conflict: one design is best in both"
        if self.broken:
            yield f"  violates {', '.join(self.broken)}"
        elif self.assessment is not None:
            yield f"  judged anew: {self.assessment.sentence}"
        yield f"  {self.designs} designs computed, seed {self.seed}"

    def _chosen(self, values: Array) -> str:
        return ", ".join(
            f"{path} = {self.words.value(new, unit, 5)} ({self.words.value(old, unit, 5)} before)"
            for path, unit, old, new in zip(self.free, self.units, self.before, self.rounded(values), strict=True)
        )

    def rounded(self, values: Array) -> Array:
        """Free numbers (…, free) as they are printed: what is nothing beside its bounds is 0."""
        return np.where(np.abs(values) < 1e-9 * (self.high - self.low), 0.0, values)
