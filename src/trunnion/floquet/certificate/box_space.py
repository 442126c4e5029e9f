"""Boxes of speeds and tolerances, as shares of what a proof is asked for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.equations.coefficients import Assembly
from trunnion.floquet.certificate.box_coefficients import NumberRange
from trunnion.floquet.tolerance.parameter_intervals import table_at
from trunnion.floquet.tolerance.spread import Spread

WIDER = 1e-14
"""By what share ends of boxes are moved outward."""
FINEST = 2.0**-40
"""Share of a side below which a box is not halved further: it stays open."""


@dataclass(frozen=True)
class BoxSpace:
    """Boxes (2, 1 + parameters) of shares from 0 to 1: the first of ln(speed), the others of tolerances."""

    assembly: Assembly
    spreads: tuple[Spread, ...]
    speeds: tuple[float, float]

    @property
    def size(self) -> int:
        """Variables."""
        return 1 + len(self.spreads)

    def values(self, shares: Array) -> Array:
        """Speed and parameters (boxes, 1 + parameters) at shares."""
        low, high = np.log(self.speeds)
        columns = [np.exp(low + shares[:, 0] * (high - low))]
        columns += [s.low + shares[:, k] * (s.high - s.low) for k, s in enumerate(self.spreads, start=1)]
        found = np.stack(columns, axis=1)
        # The ends themselves, to the last figure.
        found[:, 0] = np.where(
            shares[:, 0] <= 0, self.speeds[0], np.where(shares[:, 0] >= 1, self.speeds[1], found[:, 0])
        )
        return found

    def span(self, box: Array) -> tuple[float, float]:
        """Lowest and highest speed of a box, moved outward."""
        low, high = self.values(box)[:, 0].tolist()
        return low * (1 - WIDER), high * (1 + WIDER)

    def ranges(self, box: Array) -> list[NumberRange]:
        """Its tolerances, moved outward."""
        low, high = self.values(box)
        wider = WIDER * np.maximum(np.abs(low), np.abs(high))
        ends = zip(self.spreads, (low - wider)[1:].tolist(), (high + wider)[1:].tolist(), strict=True)
        return [NumberRange(one.label, one.columns, least, most) for one, least, most in ends]

    def line_at(self, shares: Array) -> tuple[Driveline, float, dict[str, float]]:
        """The line at ``shares`` (variables,), the speed [rad/s] there, and both by name."""
        values = self.values(shares[None])[0]
        line = self.assembly.line
        if self.spreads:
            line = self.assembly.packed.line_at(table_at(self.assembly, self.spreads, values[None, 1:])[0])
        names = ("speed", *(s.label for s in self.spreads))
        return line, float(values[0]), dict(zip(names, values.tolist(), strict=True))


def volume(boxes: Array) -> float:
    """Of boxes (boxes, 2, variables) that do not overlap."""
    return float(np.prod(boxes[:, 1] - boxes[:, 0], axis=1).sum()) if len(boxes) else 0.0


def halved(box: Array, blame: Array) -> tuple[Array, ...]:
    """Both halves (2, variables), across the side that brings most; a side that brings nothing is left,
    one that is very short too. Empty where all are."""
    sides = box[1] - box[0]
    worth = np.where(sides > FINEST, blame, -1.0)
    if not worth.max() > 0:
        worth = np.where(sides > FINEST, sides, -1.0)
    if not worth.max() > 0:
        return ()
    along = int(worth.argmax()) if np.ptp(worth[worth > 0]) > 0 else int(np.where(worth > 0, sides, -1.0).argmax())
    middle = (box[0, along] + box[1, along]) / 2
    lower, upper = box.copy(), box.copy()
    lower[1, along] = upper[0, along] = middle
    return lower, upper
