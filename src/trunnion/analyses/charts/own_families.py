"""A user's own family over two of its parameters, and one read from a file without its function."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from trunnion.analyses.charts.chart_families import ChartFamily, Sampler, grid_by_grid, quantities
from trunnion.analyses.charts.chart_pixels import Pixels
from trunnion.errors import ComputationError, InputError
from trunnion.numerics.chain.characteristic import LARGEST
from trunnion.numerics.chain.dense_monodromy import propagate
from trunnion.numerics.patches.patches import Box, PatchedFunction
from trunnion.systems.family import PeriodicLinearFamily

Array = NDArray[np.float64]


class PointByPoint:
    """What families share whose equations are not known in lanes."""

    def sampler(
        self: ChartFamily, box: Box, pixels: int, tolerance: float, threads: int, *, slabs: bool = True
    ) -> Sampler:
        """See ``ChartFamily``."""
        return grid_by_grid(self, box, tolerance, threads)

    def leading(
        self, box: Box, pixels: int, tolerance: float, threads: int, tell: Callable[[float], None]
    ) -> PatchedFunction | None:
        """Its equations are not known in lanes."""
        return None

    def differ(self, x: Array, y: Array) -> bool:
        """Nothing is cheaper than its matrices."""
        return False

    def settled(self, x: Array, y: Array) -> Pixels | None:
        """There is no other way than ``matrices``."""
        return None

    def in_numpy(self, x: Array, y: Array) -> Pixels | None:
        """There is no other way than ``matrices``."""
        return None

    def over_whole_periods(self) -> Self:
        """Own families are always integrated over whole periods."""
        return self

    def to_patch(self, value: Array, of_x: bool) -> Array:
        """Parameters are taken as they are."""
        return np.asarray(value, dtype=float)

    def from_patch(self, value: Array, of_x: bool) -> Array:
        """The inverse of ``to_patch``."""
        return np.asarray(value, dtype=float)


@dataclass(frozen=True)
class OwnFamily(PointByPoint):
    """A user's ``PeriodicLinearFamily`` over two of its parameters; ``middle`` is a typical point."""

    family: PeriodicLinearFamily
    x_name: str
    y_name: str
    middle: tuple[float, float]
    set_aside: int = 0
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

    def failures(self, x: Array, y: Array, failed: NDArray[np.bool_], tolerance: float) -> list[str]:
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

    def evaluate(self, x: Array, y: Array, tolerance: float, threads: int) -> tuple[Array, Array]:
        """See ``ChartFamily``."""
        return quantities(*self.matrices(x, y, tolerance, threads))

    def _member(self, x: float, y: float) -> Callable[[Array], tuple[Array, Array, Array, Array]]:
        values = {self.x_name: np.array([x]), self.y_name: np.array([y])}

        def at(tau: Array) -> tuple[Array, Array, Array, Array]:
            m, c, k = (part[0] for part in self.family.matrices(tau, values))
            return m, c, k, np.zeros((len(tau), self.size))

        return at


@dataclass(frozen=True)
class PatchesAlone(PointByPoint):
    """A family read from a file without its function: only its patches answer."""

    size: int
    period: float
    set_aside: int = 0
    affordable: ClassVar[int] = 0

    @classmethod
    def of(cls, function: PatchedFunction, period: float) -> PatchesAlone | None:
        """The family behind some patches; None where there are none."""
        if not function.patches:
            return None
        count = len(function.patches[0].error) - 1
        return cls((count if count <= LARGEST else round(np.sqrt(count))) // 2, period)

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
