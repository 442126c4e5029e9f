"""What ``optimise`` gives: the best design within bounds, verified, and the front where two aims conflict."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.design.assessment.result import Assessment
from trunnion.driveline.driveline import Driveline
from trunnion.results.declared import Held, Result, axis, over, remark, remarks_of
from trunnion.results.drawing import Axes, drawing
from trunnion.results.finding import Finding
from trunnion.results.units import in_words


@dataclass(frozen=True, repr=False)
class Optimum(Result):
    """The best design found.

    line: it, as a driveline; free, units (free,): the numbers chosen, low, high, before and value (free,) of each in SI
    units; aims, aim_units (aim,), aim_before and aim (aim,): what was to be best, of the line before and of the design,
    computed anew on the full grid of speeds; largest (aim,): whether the largest was wanted; front_value (point, free)
    and front (point, aim): designs that no other one beats in all aims, by rising first aim (one point for one aim);
    broken: checks that the design violates, none where it holds all; assessment: of the design, None without speeds;
    designs: how many were computed; seed: of the search; ended: what ended the search before it was done, as a clause,
    "" where it was done.
    """

    line: Driveline
    free: tuple[str, ...]
    units: tuple[str, ...]
    low: Array
    high: Array
    before: Array
    value: Array
    aims: tuple[str, ...]
    aim_units: tuple[str, ...]
    largest: tuple[bool, ...]
    aim_before: Array
    aim: Array
    front_value: Array
    front: Array
    broken: tuple[str, ...]
    assessment: Assessment | None
    designs: int
    seed: int
    findings: tuple[Finding, ...] = ()
    ended: str = ""

    @property
    def values(self) -> dict[str, float]:
        """The numbers chosen, by path, SI units."""
        return dict(zip(self.free, self.value.tolist(), strict=True))

    @property
    def sentence(self) -> str:
        """What was reached, with which numbers, in one sentence."""
        reached = " and ".join(
            f"{name} {in_words(new, unit, 5)} instead of {in_words(old, unit, 5)}"
            for name, unit, old, new in zip(self.aims, self.aim_units, self.aim_before, self.aim, strict=True)
        )
        ended = f"; {self.ended} after {self.designs} designs, and a better one may be left" if self.ended else ""
        return f"{reached}, with {self._chosen(self.value)}{ended}"

    def declared(self) -> Iterator[Held]:
        """Free numbers, aims, and the front over its points."""
        yield axis("free", list(self.free))
        yield over("free", "free_unit", list(self.units))
        for name in ("low", "high", "before", "value"):
            yield over("free", name, getattr(self, name), about="in the unit of the free number")
        yield axis("aim", list(self.aims))
        yield over("aim", "aim_unit", list(self.aim_units))
        yield over("aim", "largest", np.array(self.largest, dtype=np.int8))
        yield over("aim", "aim_before", self.aim_before, about="in the unit of the aim")
        yield over("aim", "aim_value", self.aim, about="in the unit of the aim")
        yield axis("point", np.arange(len(self.front)))
        yield over("point free", "front_value", self.front_value, about="in the unit of the free number")
        yield over("point aim", "front", self.front, about="in the unit of the aim")
        yield remark("broken", list(self.broken))
        yield from remarks_of(self, "designs", "seed", "sentence", "ended")
        yield remark("findings", [str(f) for f in self.findings])

    def table(self) -> list[dict[str, object]]:
        """One row a point of the front: aims, then the numbers that reach them."""
        names, units = (*self.aims, *self.free), (*self.aim_units, *self.units)
        rows = np.concatenate([self.front, self.rounded(self.front_value)], axis=1).tolist()
        return [{n: in_words(v, u, 5) for n, u, v in zip(names, units, row, strict=True)} for row in rows]

    def plot(self, axes: Axes | None = None) -> Axes:
        """The front, or of one aim where the numbers lie between their bounds; see ``plots.optimum.draw``."""
        return drawing(self, "plot")(self, axes)

    def __str__(self) -> str:
        rows = [self.sentence]
        if len(self.aims) > 1:
            if len(self.front) > 1:
                rows.append(f"  the aims conflict; {len(self.front)} designs that no other beats in both:")
                rows += [f"    {', '.join(f'{k} {v}' for k, v in row.items())}" for row in self.table()]
            else:
                rows.append("  the aims do not conflict: one design is best in both")
        if self.broken:
            rows.append(f"  violates {', '.join(self.broken)}")
        elif self.assessment is not None:
            rows.append(f"  judged anew: {self.assessment.sentence}")
        rows.append(f"  {self.designs} designs computed, seed {self.seed}")
        return "\n".join([*rows, *(f"  {finding}" for finding in self.findings)])

    def _chosen(self, values: Array) -> str:
        return ", ".join(
            f"{path} = {in_words(new, unit, 5)} ({in_words(old, unit, 5)} before)"
            for path, unit, old, new in zip(self.free, self.units, self.before, self.rounded(values), strict=True)
        )

    def rounded(self, values: Array) -> Array:
        """Free numbers (…, free) as they are printed: what is nothing beside its bounds is 0."""
        return np.where(np.abs(values) < 1e-9 * (self.high - self.low), 0.0, values)
