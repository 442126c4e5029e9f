"""A user's own family over two of its parameters, and one read from a file without its function."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from trunnion.arrays import Array, Flags
from trunnion.errors import ComputationError, InputError
from trunnion.floquet.charts.chart_families import ChartFamily
from trunnion.numerics.chain.characteristic import LARGEST
from trunnion.numerics.chain.dense_monodromy import propagate
from trunnion.results.chart import StabilityChart
from trunnion.systems.family import PeriodicLinearFamily


@dataclass(frozen=True)
class UserFamily(ChartFamily):
    """A user's ``PeriodicLinearFamily`` over two of its parameters; ``middle`` is a typical point."""

    family: PeriodicLinearFamily
    x_name: str
    y_name: str
    middle: tuple[float, float]
    affordable: ClassVar[int] = 2_000

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return self.family.size

    @property
    def period(self) -> float:
        """Period in τ."""
        return self.family.period

    @cached_property
    def _unit(self) -> Array | None:
        """Units of the state at the typical point, kept everywhere so that entries of Z stay analytic.

        None where that point has no answer; then each takes its own units, and entries may jump.
        """
        try:
            return propagate(self._member(*self.middle), self.period, self.size, 1e-6).scale
        except ComputationError:
            return None

    def matrices(self, x: Array, y: Array, tolerance: float, threads: int) -> tuple[Array, Array, Array]:
        """Monodromy matrices in common units, their errors and ∫ tr(M⁻¹C) dτ, member by member; NaN where it fails."""
        n = self.size
        matrix, error, trace = np.full((len(x), 2 * n, 2 * n), np.nan), np.full(len(x), np.nan), np.full(len(x), np.nan)
        for p in range(len(x)):
            try:
                run = propagate(self._member(x[p], y[p]), self.period, n, tolerance)
            except ComputationError:
                continue
            unit = run.scale if self._unit is None else self._unit
            matrix[p], trace[p] = run.monodromy * unit[None, :] / unit[:, None], run.damping_trace
            change = run.scale / unit
            error[p] = run.error * change.max() / change.min()
        return matrix, error, trace

    def failures(self, x: Array, y: Array, failed: Flags, tolerance: float) -> list[str]:
        """What went wrong at the pixels (y, x) that ``failed``, as a sentence about the first."""
        if not failed.any():
            return []
        row, column = np.argwhere(failed)[0]
        place = f"{self.x_name} = {x[column]:g}, {self.y_name} = {y[row]:g}"
        try:
            propagate(self._member(x[column], y[row]), self.period, self.size, tolerance)
            why = "the motion grows beyond numbers"
        except ComputationError as error:
            why = str(error)
        count = int(failed.sum())
        return [f"{count} point{'s' if count > 1 else ''} failed; at {place}: {why}"]

    def _member(self, x: float, y: float) -> Callable[[Array], tuple[Array, Array, Array, Array]]:
        values = {self.x_name: np.array([x]), self.y_name: np.array([y])}

        def at(tau: Array) -> tuple[Array, Array, Array, Array]:
            m, c, k = (part[0] for part in self.family.matrices(tau, values))
            return m, c, k, np.zeros((len(tau), self.size))

        return at


@dataclass(frozen=True)
class StoredPatches(ChartFamily):
    """A family read from a file without its function: only its patches answer."""

    chart: StabilityChart
    affordable: ClassVar[int] = 0

    @property
    def size(self) -> int:
        """Number of unknowns, by the number of quantities."""
        count = len(self.chart.function.patches[0].error) - 1
        return (count if count <= LARGEST else round(np.sqrt(count))) // 2

    @property
    def period(self) -> float:
        """Period in τ."""
        return self.chart.period

    def matrices(self, x: Array, y: Array, tolerance: float, threads: int) -> tuple[Array, Array, Array]:
        """Nothing but the patches is known: NaN."""
        m = 2 * self.size
        return np.full((len(x), m, m), np.nan), np.full(len(x), np.nan), np.full(len(x), np.nan)

    def evaluate(self, x: Array, y: Array, tolerance: float, threads: int) -> tuple[Array, Array]:
        """Nothing but the patches is known."""
        raise InputError(
            f"has no patch at ({x[0]:g}, {y[0]:g}) and was read without its family",
            element="chart",
            remedy="load_chart(path, family=…)",
        )
