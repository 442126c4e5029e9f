"""A line over two of its parameters, every point about the line's own periodic motion: what rows, columns and tips of
regions are searched by where nothing is an analytic function of both parameters."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.equations.coefficients import Assembly
from trunnion.floquet.charts.axes import ChartAxis
from trunnion.floquet.charts.chart_families import LineFamily
from trunnion.floquet.charts.chart_pixels import Pixels
from trunnion.floquet.charts.steady_state_chart import SteadyStateChart
from trunnion.floquet.propagation.about_steady_states import (
    SteadyStateMultipliers,
    beside_neutral_multipliers,
    multipliers_about,
    pixels_of_rows,
)
from trunnion.steady.free.folds_between import folds_between, slopes
from trunnion.steady.free.periodic_steady_states import SteadyStateCurve, slopes_along
from trunnion.waiting import keep_time

FOLLOWED = 33
"""Even points of a row between which its motion is followed in both directions."""
MOST_KEPT = 400
"""Rows whose motions are kept."""


@dataclass(frozen=True)
class SteadyStateFamily(LineFamily):
    """``charted`` holds the motions; rows (y = const) that were asked for keep theirs."""

    charted: SteadyStateChart | None = None
    kept: dict[float, SteadyStateCurve] = field(default_factory=dict, repr=False, compare=False)
    affordable: ClassVar[int] = 0

    @classmethod
    def about(cls, assembly: Assembly, x: ChartAxis, y: ChartAxis, speed: float, own: SteadyStateChart) -> LineFamily:
        """Of axes that ``assembly`` has been found to have."""
        return cls(assembly, x, y, speed, True, charted=own)

    @property
    def analytic(self) -> bool:
        """No: motions fold back."""
        return False

    @property
    def passive(self) -> bool:
        """No: about motions of its own a line varies."""
        return False

    @property
    def set_aside(self) -> int:
        """None: what comes back exactly is left out of every point already."""
        return 0

    def in_numpy(self, x: Array, y: Array) -> Pixels | None:
        """Points (x, y): those on rows that are followed about the motions of these, others about those that rigid
        shafts lead to."""
        keep_time()
        found = Pixels.failed(np.shape(x))
        rows, owner = np.unique(y, return_inverse=True)
        many = len(x) >= FOLLOWED and len(rows) * 4 <= len(x)
        alone = np.zeros(len(x), dtype=bool)
        for k, value in enumerate(rows.tolist()):
            own = np.flatnonzero(owner == k)
            if value in self.kept or many:
                found.put((own,), _pixels(self.row(value), x[own]))
            else:
                alone[own] = True
        if alone.any():
            places = np.flatnonzero(alone)
            found.put((places,), self._scattered(x[places], y[places]))
        return found

    def with_multipliers(self, x: Array, y: float) -> tuple[Pixels, Complex]:
        """Points (x,) of a row, and all multipliers of each (point, m)."""
        motions = slopes_along(self.row(y), x)
        found = multipliers_about(motions)
        return _upper(found), beside_neutral_multipliers(motions, found)

    @property
    def turned(self) -> SteadyStateFamily:
        """The same with its axes exchanged."""
        assert self.charted is not None
        charted = replace(self.charted, x=self.charted.y, y=self.charted.x)
        return replace(self, x=self.y, y=self.x, charted=charted, kept={})

    def settled(self, x: Array, y: Array) -> Pixels | None:
        """Nothing better is known."""
        return None

    def row(self, y: float) -> SteadyStateCurve:
        """The motions of a row, followed between even points."""
        if y not in self.kept:
            assert self.charted is not None
            if len(self.kept) >= MOST_KEPT:
                self.kept.clear()
            curve = self.charted.curve(y)
            even = np.linspace(self.x.values[0], self.x.values[-1], FOLLOWED)
            curve.broken = folds_between(curve, even, slopes(curve, even))
            self.kept[y] = curve
        return self.kept[y]

    def swing(self, y: float) -> float:
        """Largest amplitude [rad] of any motion known on a row."""
        return max((one.swing for one in self.row(y).known.values() if one.settled), default=0.0)

    def _scattered(self, x: Array, y: Array) -> Pixels:
        """Points that lie anywhere."""
        assert self.charted is not None
        balance, table = self.charted.unexcited.balance, self.charted.table(x, y)
        found = pixels_of_rows(balance, table)
        return Pixels(found.radius, found.error, found.critical, found.verdict)


def _pixels(curve: SteadyStateCurve, values: Array) -> Pixels:
    return _upper(multipliers_about(slopes_along(curve, values)))


def _upper(found: SteadyStateMultipliers) -> Pixels:
    critical = np.where(found.critical.imag < 0, found.critical.conj(), found.critical)
    return Pixels(found.radius, found.error, critical, found.verdict)
