"""Tongues: instability regions of a box as curves, and what is known of each."""

from __future__ import annotations

import csv
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.operating_speed import speed_unit
from trunnion.errors import InputError
from trunnion.modes.resonance_speeds import Resonance
from trunnion.results.declared import Held, Result, axis, over, remarks
from trunnion.results.drawing import Axes, drawing
from trunnion.results.quantity_axes import QuantityAxis, parameter_axis
from trunnion.writing import written_whole

if TYPE_CHECKING:
    from trunnion.driveline.driveline import Driveline

Intervals = Callable[[float], Array]
"""y → unstable intervals (intervals, 2) in x of that row, found anew."""


@dataclass(frozen=True)
class Tongue:
    """One instability region: the interval ``low`` to ``high`` in x at each of ``y``, rising; all (rows,), SI units.

    kind: how the multipliers leave the unit circle where it begins; resonance: the one its growing mode names (None
    where the mode is mixed, or for a family of one's own). tip: (x, y) at which it closes below, or else above; top:
    where it closes above as well. fades: ends, "below" and "above", beyond which it goes on, but without damping grows
    too little to be told. growth_rate [1/s, or per unit of a family's τ]: the largest found inside, at
    ``growth_at``. joins, parts: numbers of the tongues it runs into above or comes out of below. cut: sides of the
    box that cut it off.
    """

    number: int
    kind: str
    resonance: Resonance | None
    y: Array
    low: Array
    high: Array
    tip: tuple[float, float] | None
    top: tuple[float, float] | None
    growth_rate: float
    growth_at: tuple[float, float]
    joins: int | None
    parts: int | None
    cut: tuple[str, ...]
    fades: tuple[str, ...] = ()
    find: Intervals | None = field(default=None, repr=False, compare=False)

    @property
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


@dataclass(frozen=True, repr=False)
class Tongues(Result):
    """Every instability region found in a box, by falling growth rate; a sequence of ``Tongue``.

    x_range, y_range: the box, SI units; rows: how many values of y were searched; complete: whether each of these was
    searched for every zero of the boundary functions, or sampled; ``search`` says it in words; ``row_step`` is the
    largest distance between rows: a region that lies wholly between two of them is not in the list. ``unknown``: where
    rows could not be told; an empty list of tongues means stability only where nothing is.
    """

    tongues: tuple[Tongue, ...]
    x_label: str
    y_label: str
    x_unit: str
    y_unit: str
    x_range: tuple[float, float]
    y_range: tuple[float, float]
    rate_unit: str
    rows: int
    row_step: float
    complete: bool
    search: str
    unknown: tuple[Unknown, ...]
    line: Driveline | None
    remarks: tuple[str, ...] = ()
    find: Intervals | None = field(default=None, repr=False, compare=False)

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

    def declared(self) -> Iterator[Held]:
        """One entry a tongue; their edges one after another, with the number of the tongue at each point."""
        every = self.tongues
        none = (float("nan"), float("nan"))
        yield axis("tongue", np.array([t.number for t in every], dtype=int))
        yield over("tongue", "name", [t.name for t in every])
        yield over("tongue", "kind", [t.kind for t in every])
        for k, (part, unit) in enumerate((("x", self.x_unit), ("y", self.y_unit))):
            yield over("tongue", f"tip_{part}", np.array([(t.tip or none)[k] for t in every]), unit)
            yield over("tongue", f"top_{part}", np.array([(t.top or none)[k] for t in every]), unit)
            yield over("tongue", f"growth_{part}", np.array([t.growth_at[k] for t in every]), unit)
        yield over("tongue", "fades", [" ".join(t.fades) for t in every])
        yield over("tongue", "growth_rate", np.array([t.growth_rate for t in every]), self.rate_unit)
        yield over("tongue", "widest", np.array([t.widest for t in every]), self.x_unit)
        yield axis("point", np.arange(sum(len(t.boundary) for t in every)))
        owners = np.repeat([t.number for t in every], [len(t.boundary) for t in every]).astype(int)
        yield over("point", "of_tongue", owners)
        points = np.concatenate([t.boundary for t in every] or [np.zeros((0, 2))])
        yield over("point", "boundary_x", points[:, 0], self.x_unit, self.x_label)
        yield over("point", "boundary_y", points[:, 1], self.y_unit, self.y_label)
        yield axis("unknown", np.arange(len(self.unknown)))
        yield over("unknown", "unknown_y", np.array([u.y for u in self.unknown]), self.y_unit, self.y_label)
        for k, end in enumerate(("from", "to")):
            yield over(
                "unknown", f"unknown_x_{end}", np.array([u.x[k] for u in self.unknown]), self.x_unit, self.x_label
            )
        yield from remarks(
            x=self.x_label,
            y=self.y_label,
            x_range=list(self.x_range),
            y_range=list(self.y_range),
            rows=self.rows,
            row_step=self.row_step,
            complete=int(self.complete),
            search=self.search,
        )

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
        """The boundaries as curves, over a chart if ``axes`` shows one; see ``plots.tongues.draw``."""
        return drawing(self, "plot")(self, axes, unit=unit, pixel=pixel, labelled=labelled, wide=wide)

    def table(self) -> list[dict[str, object]]:
        """One row a tongue, SI units."""
        return [
            {
                "tongue": t.number,
                "resonance": t.name,
                "tip": _place(t.tip),
                f"growth rate [{self.rate_unit}]": t.growth_rate,
                f"widest [{self.x_unit}]": t.widest,
            }
            for t in self.tongues
        ]

    def __str__(self) -> str:
        return self.said_in(speed_unit(self.line) if self.line else None)

    def said_in(self, unit: str | None) -> str:
        """Every region in a line; speeds in ``unit``, numbers of a family of one's own as they are."""
        across, up = parameter_axis(self.x_label, self.x_unit, unit), parameter_axis(self.y_label, self.y_unit, unit)
        what = f"over {across.quantity} × {up.quantity}"
        many = "region" if len(self) == 1 else "regions"
        head = f"{len(self)} instability {many} {what}" if self.tongues else f"no instability found {what}"
        rows = [
            f"  {t.number}  {t.name}: {_tip_words(t, across, up)}; grows by up to {t.growth_rate:.4g} {self.rate_unit}"
            for t in self.tongues
        ]
        return "\n".join([head, *rows, f"  {self.search}", *(f"  note: {r}" for r in self.remarks)])


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
