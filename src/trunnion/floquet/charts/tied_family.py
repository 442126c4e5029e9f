"""A line over two of its parameters whose shafts are tied to two others or close a loop.

No walk along such a line gives its equations shaft by shaft, as the kernels of charts take them. Their matrices are
stepped by exponentials (``numerics.chain.exponential_monodromy``) in plain NumPy, many points at once; everything else
is done as with other lines.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from trunnion.arrays import Array
from trunnion.equations.first_order import FEWEST_SAMPLES
from trunnion.floquet.charts.chart_families import MOST_IN_NUMPY, LineFamily, Sampler, point_by_point
from trunnion.floquet.charts.chart_pixels import Pixels
from trunnion.floquet.charts.cost_model import pixel_cost, step_cost
from trunnion.floquet.charts.leading_group import distinguished
from trunnion.floquet.charts.multiplier_interpolation import corners_of, leading_patches
from trunnion.floquet.charts.numpy_chart import NumpyPoints
from trunnion.floquet.propagation.tied_lines import MOST_NUMBERS, tied_matrices
from trunnion.numerics.patches.patches import Box, PatchedFunction

STEPS = 32
"""Of a period, which most such lines take."""


@dataclass(frozen=True)
class TiedLineFamily(LineFamily):
    """Of driven lines, and of straight ones."""

    affordable: ClassVar[int] = 2_000

    @cached_property
    def _units(self) -> tuple[Array, float]:
        """√m (n,) and νΩ [rad/s] of the line in the middle, kept everywhere so that entries of matrices stay analytic
        functions of both parameters."""
        middle = self.rates(*(np.array([np.median(axis.values)]) for axis in (self.x, self.y)))
        return middle.root[0], float(middle.unit[0] * middle.table[0, 0])

    def matrices(self, x: Array, y: Array, tolerance: float, threads: int) -> tuple[Array, Array, Array]:
        """Monodromy matrices in common units, their errors and ∫ tr(M⁻¹C) dτ."""
        return tied_matrices(self.assembly, self.table(x, y), self.statically_twisted, tolerance, self._units)

    def matrices_of(self, table: Array, tolerance: float, threads: int) -> Array:
        """See ``LineFamily``."""
        return tied_matrices(self.assembly, table, self.statically_twisted, tolerance, self._units)[0]

    def sampler(self, box: Box, pixels: int, tolerance: float, threads: int, *, slabs: bool = True) -> Sampler:
        """By plain evaluation."""
        return point_by_point(self, box, tolerance, threads)

    def leading(
        self, box: Box, pixels: int, tolerance: float, threads: int, report_progress: Callable[[float], None]
    ) -> PatchedFunction | None:
        """See ``ChartFamily``."""
        if self.set_aside:
            return None

        def points(u: Array, v: Array) -> NumpyPoints:
            return NumpyPoints(self.rates(*self._from_patch(u, v)))

        states = 2 * self.size
        elsewhere = pixels * (STEPS * step_cost(states) + pixel_cost(states))
        corners = points(*corners_of(box)).rates
        return leading_patches(points, corners, box, pixels, tolerance, threads, elsewhere, report_progress)

    def whole_matrices(
        self, box: Box, pixels: int, tolerance: float, threads: int, report_progress: Callable[[float], None]
    ) -> PatchedFunction | None:
        """None: the lines are short."""
        return None

    def differ(self, x: Array, y: Array) -> bool:
        """See ``ChartFamily``."""
        return distinguished(NumpyPoints(self.rates(x, y)))

    def settled(self, x: Array, y: Array) -> Pixels | None:
        """See ``ChartFamily``."""
        return None if self.set_aside else self.step_halving(self.rates(x, y))

    def in_numpy(self, x: Array, y: Array) -> Pixels | None:
        """Points of damped lines from steps that are halved until their multipliers stay; None for many points."""
        most = min(MOST_IN_NUMPY, MOST_NUMBERS // (FEWEST_SAMPLES * self.size**2))
        if self.set_aside or len(x) > most:
            return None
        return self.stepped(x, y)

    @property
    def uncompiled(self) -> bool:
        """Whether it may be stepped in NumPy: there is nothing to compile for it."""
        return not self.set_aside

    def over_whole_periods(self) -> LineFamily:
        """It never takes half of one."""
        return self
