"""Stability of very many lines that differ in their numbers, on the compiled kernel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from trunnion.analyses.charts.chart_families import quantities
from trunnion.analyses.charts.chart_pixels import Pixels, judge
from trunnion.equations.coefficients import Assembly
from trunnion.equations.lanes import chain_lanes, chain_program, loaded_by_speed
from trunnion.equations.steady_base import refuse_own_motion, require_steady_base
from trunnion.equations.topology import require_period
from trunnion.numerics.chain.chain_monodromy import Window, chain_monodromy, symmetry_phase

Array = NDArray[np.float64]
AT_ONCE = 1 << 15
"""Lines in one call of the kernel."""


@dataclass(frozen=True)
class ManyLines:
    """One line's structure, ready to be judged for any rows of numbers; ``statically_twisted`` as in ``stability``."""

    assembly: Assembly
    statically_twisted: bool
    threads: int

    @classmethod
    def of(cls, assembly: Assembly, table: Array, twisted: bool, threads: int) -> ManyLines:
        """Refuses lines without period, without a steady base at any row of ``table``, and bent free ones."""
        require_period(assembly.line, assembly.topology)
        refuse_own_motion(assembly, "put a ConstantSpeed in front", bends=False)
        require_steady_base(assembly, table)
        return cls(assembly, twisted, threads)

    @property
    def period(self) -> float:
        """Period [rad of input angle]."""
        return 2 * np.pi * float(require_period(self.assembly.line, self.assembly.topology))

    def matrices(self, table: Array, tolerance: float) -> tuple[Array, Array, Array]:
        """Monodromy matrices of rows of ``table`` in the kernel's units, their errors and ∫ tr(M⁻¹C) dτ."""
        topo = self.assembly.topology
        coefficients = self.assembly.coefficients(table, statically_twisted=self.statically_twisted)
        by_speed = loaded_by_speed(topo, coefficients)
        program, lanes = chain_program(topo, coefficients, by_speed), chain_lanes(topo, coefficients, by_speed)
        begin = symmetry_phase(program, lanes, self.period)
        window = Window(0.0 if begin is None else begin, self.period, begin is not None)
        return chain_monodromy(program, lanes, window, tolerance, self.threads)

    def set_aside(self, table: Array) -> int:
        """Multipliers exactly 1 of a free line, as ``Stability.set_aside``."""
        if not self.assembly.topology.free:
            return 0
        coefficients = self.assembly.coefficients(table[:1], statically_twisted=self.statically_twisted)
        return 1 if loaded_by_speed(self.assembly.topology, coefficients) else 2

    def judged(self, table: Array, tolerance: float) -> Pixels:
        """Radius, error, critical multiplier and verdict of rows of ``table``, each (rows,)."""
        size, aside = self.assembly.topology.size, self.set_aside(table)
        parts = []
        for start in range(0, len(table), AT_ONCE):
            values, bounds = quantities(*self.matrices(table[start : start + AT_ONCE], tolerance))
            parts.append(judge(np.ascontiguousarray(values.T), np.ascontiguousarray(bounds.T), size, aside))
        return Pixels(
            *(np.concatenate([getattr(p, name) for p in parts]) for name in ("radius", "error", "critical", "verdict"))
        )

    def growth(self, table: Array, radius: Array) -> Array:
        """Growth rates [1/s] of spectral radii at the speeds of ``table``."""
        return np.asarray(np.log(np.maximum(radius, 1e-300)) / self.period * table[:, 0])
