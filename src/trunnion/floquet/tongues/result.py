"""Tongues: instability regions of a box as curves, and what is known of each."""

from __future__ import annotations

import csv
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.quantities import signs
from trunnion.errors import InputError
from trunnion.modes.resonance_speeds import Resonance
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, computed, internal, labelled, members, variable
from trunnion.results.quantity_axes import QuantityAxis
from trunnion.results.result import Result
from trunnion.results.variables import Attribute, Coordinate, Variable
from trunnion.writing import written_whole

if TYPE_CHECKING:
    from trunnion.driveline.driveline import Driveline

Intervals = Callable[[float], Array]
"""y → unstable intervals (intervals, 2) in x of that row, found anew."""
FADES = 'ends, "below" and "above", beyond which it goes on, but without damping grows too little to be told'


@labelled
class Tongue:
    """One instability region: the interval ``low`` to ``high`` in x at each of ``y``, SI units."""

    number: int = internal("by falling growth rate")
    kind: str = variable(words="how the multipliers leave the unit circle where it begins")
    resonance: Resonance | None = internal("that its growing mode names; None where the mode is mixed, or of a family")
    y: Array = internal("rows, rising", axes="rows")
    low: Array = internal("end in x", axes="rows")
    high: Array = internal("end in x", axes="rows")
    tip: tuple[float, float] | None = internal("(x, y) at which it closes below, or else above")
    top: tuple[float, float] | None = internal("(x, y) where it closes above as well")
    growth_rate: float = variable("", "{self.rate_unit}", "the largest found inside, per s or per unit of a family's τ")
    growth_at: tuple[float, float] = internal("(x, y) where it grows fastest")
    joins: int | None = internal("number of the tongue that it runs into above")
    parts: int | None = internal("number of the tongue that it comes out of below")
    cut: tuple[str, ...] = internal("sides of the box that cut it off")
    fades: tuple[str, ...] = internal(FADES, default=())
    find: Intervals | None = internal("its row found anew", default=None, repr=False, compare=False)

    @property
    @computed(variable())
    def name(self) -> str:
        """Its resonance, or how its multipliers leave the circle."""
        return str(self.resonance) if self.resonance is not None else f"unnamed ({self.kind})"

    @property
    def boundary(self) -> Array:
        """Points (points, 2) along its edge: down the low side to the tip and up the high side."""
        return np.concatenate([
            np.stack([self.low, self.y], axis=1)[::-1],
            np.stack([self.high, self.y], axis=1),
        ])  # fmt: skip

    def interval_at(self, y: float) -> tuple[float, float]:
        """Where it is unstable at ``y``: (low, high) in x, solved anew.

        Raises
        ------
        InputError : the tongue does not reach ``y``.
        """
        if not self.y[0] <= y <= self.y[-1]:
            raise InputError(
                f"is beyond this tongue, which reaches from {self.y[0]:.6g} to {self.y[-1]:.6g}",
                element=f"tongue {self.number}", key="y", value=y, remedy="ask inside it",
            )  # fmt: skip
        guess = np.interp(y, self.y, self.low), np.interp(y, self.y, self.high)
        if self.find is None:
            return float(guess[0]), float(guess[1])
        found = self.find(float(y))
        if not len(found):
            return float(guess[0]), float(guess[0])
        meets = np.minimum(found[:, 1], guess[1]) - np.maximum(found[:, 0], guess[0])
        low, high = found[int(meets.argmax())]
        return float(low), float(high)

    def width_at(self, y: float) -> float:
        """Width in x at ``y``."""
        low, high = self.interval_at(y)
        return high - low

    @property
    @computed(variable("", "{self.x_unit}"))
    def widest(self) -> float:
        """The largest width in x on the rows known."""
        return float((self.high - self.low).max())


@dataclass(frozen=True)
class Unknown:
    """A stretch ``x`` (low, high) of the row at ``y`` where it could not be told whether the motion grows.

    between: the next rows below and above, up to which nothing is known of these x.
    """

    y: float
    x: tuple[float, float]
    between: tuple[float, float]


@labelled
class Tongues(Result):
    """Every instability region found in a box, by falling growth rate; a sequence of ``Tongue``.

    A region that lies wholly between two rows is not in the list. An empty list of tongues means stability only where
    nothing is ``unknown``.
    """

    tongues: tuple[Tongue, ...] = members(Tongue, "tongue", name="number")
    x_label: str = attribute("parameter along x", name="x")
    y_label: str = attribute("parameter along y", name="y")
    x_unit: str = internal("of the parameter along x")
    y_unit: str = internal("of the parameter along y")
    x_range: tuple[float, float] = attribute("of the box, SI units")
    y_range: tuple[float, float] = attribute("of the box, SI units")
    rate_unit: str = internal("of growth rates")
    rows: int = attribute("how many values of y were searched")
    row_step: float = attribute("largest distance between rows")
    complete: bool = attribute("whether each row was searched for every zero of the boundary functions, or sampled")
    search: str = attribute("the same in words")
    unknown: tuple[Unknown, ...] = internal("where rows could not be decided")
    line: Driveline | None = internal("that was searched; None of a family of one's own")
    remarks: tuple[str, ...] = internal("what was clipped", default=())
    find: Intervals | None = internal("a row searched anew", default=None, compare=False)
    unit: str | None = internal("of speeds in print; None of a family of one's own", default=None)

    def __iter__(self):  # type: ignore[no-untyped-def]
        return iter(self.tongues)

    def __len__(self) -> int:
        return len(self.tongues)

    def __getitem__(self, place: int) -> Tongue:
        return self.tongues[place]

    def intervals_at(self, y: float) -> Array:
        """All unstable intervals (intervals, 2) in x of the row at ``y``, searched anew."""
        if not self.y_range[0] <= y <= self.y_range[1]:
            raise InputError(
                f"lies outside the box, which reaches from {self.y_range[0]:.6g} to {self.y_range[1]:.6g}",
                key=self.y_label, value=y, remedy="ask inside it",
            )  # fmt: skip
        if self.find is None:
            raise InputError("was read without its family and cannot be searched anew", element="tongues")
        return self.find(float(y))

    def narrower_than(self, width: float) -> tuple[Tongue, ...]:
        """Tongues that are nowhere as wide in x: those that pixels so far apart may hide."""
        return tuple(t for t in self.tongues if t.widest < width)

    def declared(self) -> Iterator[Variable | Attribute]:
        """One entry a tongue; their edges one after another, with the number of the tongue at each point."""
        yield from super().declared()
        every = self.tongues
        none = (float("nan"), float("nan"))
        for k, (part, unit) in enumerate((("x", self.x_unit), ("y", self.y_unit))):
            yield Variable(f"tip_{part}", np.array([(t.tip or none)[k] for t in every]), "tongue", unit)
            yield Variable(f"top_{part}", np.array([(t.top or none)[k] for t in every]), "tongue", unit)
            yield Variable(f"growth_{part}", np.array([t.growth_at[k] for t in every]), "tongue", unit)
        yield Variable("fades", [" ".join(t.fades) for t in every], "tongue")
        lengths = [len(t.boundary) for t in every]
        yield Coordinate("point", np.arange(sum(lengths)), "point")
        yield Variable("of_tongue", np.repeat([t.number for t in every], lengths).astype(int), "point")
        points = np.concatenate([t.boundary for t in every] or [np.zeros((0, 2))])
        yield Variable("boundary_x", points[:, 0], "point", self.x_unit, self.x_label)
        yield Variable("boundary_y", points[:, 1], "point", self.y_unit, self.y_label)
        yield Coordinate("unknown", np.arange(len(self.unknown)), "unknown")
        yield Variable("unknown_y", np.array([u.y for u in self.unknown]), "unknown", self.y_unit, self.y_label)
        for k, end in enumerate(("from", "to")):
            ends = np.array([u.x[k] for u in self.unknown])
            yield Variable(f"unknown_x_{end}", ends, "unknown", self.x_unit, self.x_label)

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """One line per point of a boundary: number and name of the tongue, x, y."""
        with written_whole(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as stream:
            writer = csv.writer(stream, lineterminator="\n")
            writer.writerow(["tongue", "name", f"{self.x_label} [{self.x_unit}]", f"{self.y_label} [{self.y_unit}]"])
            for tongue in self.tongues:
                writer.writerows([tongue.number, tongue.name, x, y] for x, y in tongue.boundary.tolist())

    def plot(
        self,
        axes: Axes | None = None,
        *,
        unit: str | None = None,
        pixel: float | None = None,
        labelled: int = 12,
        wide: bool = False,
    ) -> Axes:
        """The boundaries as curves, over a chart if ``axes`` shows one; see ``pictures.tongues.tongues``."""
        return drawing(self, "plot")(self, axes, unit=unit, pixel=pixel, labelled=labelled, wide=wide)

    def table(self) -> list[dict[str, object]]:
        """One row a tongue, SI units."""
        return [
            {
                "tongue": t.number,
                "resonance": t.name,
                "tip": _place(t.tip),
                f"growth rate [{signs(self.rate_unit)}]": t.growth_rate,
                f"widest [{signs(self.x_unit)}]": t.widest,
            }
            for t in self.tongues
        ]

    def _lines(self) -> Iterator[str]:
        across, up = (self.words.parameter(*of) for of in ((self.x_label, self.x_unit), (self.y_label, self.y_unit)))
        what, many = f"over {across.quantity} × {up.quantity}", "region" if len(self) == 1 else "regions"
        yield f"{len(self)} instability {many} {what}" if self.tongues else f"no instability found {what}"
        for t in self.tongues:
            rate = f"{t.growth_rate:.4g} {self.rate_unit}"
            yield f"  {t.number}  {t.name}: {_tip_words(t, across, up)}; grows by up to {rate}"
        yield f"  {self.search}"
        yield from (f"  note: {r}" for r in self.remarks)


def _tip_words(tongue: Tongue, across: QuantityAxis, up: QuantityAxis) -> str:
    if tongue.tip is None:
        first = up.value(float(tongue.y[0]))
        if "below" in tongue.fades:
            return f"known from {first} on, below it grows too little to be told"
        return f"goes on outside the box from {first}" if tongue.parts is None else f"parts from region {tongue.parts}"
    closes = "above" if tongue.top is None and tongue.tip[1] >= tongue.y[-1] else "below"
    return f"closes {closes} at {across.value(tongue.tip[0])}, {up.value(tongue.tip[1])}"


def _place(point: tuple[float, float] | None) -> str:
    return "" if point is None else f"({point[0]:.6g}, {point[1]:.6g})"
