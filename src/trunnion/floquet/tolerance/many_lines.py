"""Stability of very many lines that differ in their numbers, on the compiled kernels.

The ordinary kernel follows every mode. Of a stiff line at a slow speed the fastest ones make the error of the matrix
far larger than what the radius is wanted to: there steps of exponentials are halved until the largest multipliers stay.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from trunnion.arrays import Array, Flags
from trunnion.driveline.converter_balance import refuse_converters
from trunnion.equations.chain_batch import chain_batch, chain_program, loaded_by_speed
from trunnion.equations.coefficients import Assembly
from trunnion.equations.first_order import LineRates, fastest_cycles, steps_that_see
from trunnion.equations.released import NOT_ALIKE, refuse_pendulums
from trunnion.equations.steady_base import refuse_periodic_base, require_short_ties, require_steady_base
from trunnion.equations.topology import require_period
from trunnion.floquet.charts.chart_families import quantities
from trunnion.floquet.charts.chart_pixels import Pixels, judge
from trunnion.floquet.propagation.tied_lines import tied_matrices
from trunnion.floquet.stability.lagging import lags_count
from trunnion.floquet.tolerance.lagging_lines import lagging_pixels
from trunnion.numerics.chain.chain_exponentials import ChainExponentials
from trunnion.numerics.chain.chain_monodromy import Window, chain_monodromy, symmetry_phase
from trunnion.numerics.chain.exponential_monodromy import March, marched, step_halving
from trunnion.numerics.threads import on_threads
from trunnion.numerics.workers import Workers

AT_ONCE = 1 << 15
"""Lines in one call of the kernel."""
STEPPED_AT_ONCE = 256
"""Lines whose steps are halved together."""
FIRST = 16
"""Lines that tell which way suits the others."""
COARSE, SHARE = 1e-6, 1e-2
"""Errors of ρ above this, and above this share of 1 − ρ, are too large."""
UNKNOWN = 0.1
"""Error of ρ from which nothing is known of it."""


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
        refuse_periodic_base(assembly, "put a ConstantSpeed in front", bends=False)
        require_steady_base(assembly, table)
        refuse_converters(assembly.line, "studies of many lines do")
        require_short_ties(assembly)
        refuse_pendulums(assembly.line, NOT_ALIKE)
        return cls(assembly, twisted, threads)

    @property
    def period(self) -> float:
        """Period [rad of input angle]."""
        return 2 * np.pi * float(require_period(self.assembly.line, self.assembly.topology))

    def matrices(self, table: Array, tolerance: float) -> tuple[Array, Array, Array]:
        """Monodromy matrices of rows of ``table`` in the kernel's units, their errors and ∫ tr(M⁻¹C) dτ."""
        topo = self.assembly.topology
        if topo.graph:
            return tied_matrices(self.assembly, table, self.statically_twisted, tolerance)
        coefficients = self.assembly.coefficients(table, statically_twisted=self.statically_twisted)
        by_speed = loaded_by_speed(topo, coefficients)
        program, batch = chain_program(topo, coefficients, by_speed), chain_batch(topo, coefficients, by_speed)
        begin = symmetry_phase(program, batch, self.period)
        window = Window(0.0 if begin is None else begin, self.period, begin is not None)
        return chain_monodromy(program, batch, window, tolerance, self.threads)

    def set_aside(self, table: Array) -> int:
        """Multipliers exactly 1, as ``Stability.set_aside``."""
        topo = self.assembly.topology
        coefficients = self.assembly.coefficients(table[:1], statically_twisted=self.statically_twisted)
        return topo.set_aside(bool(loaded_by_speed(topo, coefficients)))

    def judged(self, table: Array, tolerance: float) -> Pixels:
        """Radius, error, critical multiplier and verdict of rows of ``table``, each (rows,)."""
        stiff = self._stiff(table, tolerance)
        parts = [(table[start : start + AT_ONCE], tolerance, stiff) for start in range(0, len(table), AT_ONCE)]
        return self._mended([self._by(part) for part in parts], table, tolerance, stiff)

    def judged_by(self, workers: Workers, table: Callable[[int], Array], tables: int, tolerance: float) -> list[Pixels]:
        """The same of several tables, by their number, shared with workers, to the bit; fewer of the first ones where
        the time is up."""
        known, sizes, stiff = replace(self, threads=1), list[int](), list[bool]()

        def parts() -> Iterator[tuple[Array, float, bool]]:
            for number in range(tables):
                rows = table(number)
                sizes.append(-(-len(rows) // AT_ONCE))
                stiff.append(self._stiff(rows, tolerance))
                for start in range(0, len(rows), AT_ONCE):
                    yield rows[start : start + AT_ONCE], tolerance, stiff[-1]

        found, judged = workers.all(known._by, parts()), list[Pixels]()
        for number, size in enumerate(sizes):
            own, found = found[:size], found[size:]
            if len(own) < size:
                break
            judged.append(self._mended(own, table(number), tolerance, stiff[number]))
        return judged

    def _lagging(self, table: Array) -> Pixels | None:
        """Straight lines some of whose torques lag, by their eigenvalues; None of others."""
        co = self.assembly.coefficients(table[:1], statically_twisted=self.statically_twisted)
        if not lags_count(self.assembly, co, table):
            return None
        parts = np.array_split(table, max(1, -(-len(table) // STEPPED_AT_ONCE)))
        return _joined(on_threads(self._by_eigenvalues, parts, self.threads))

    def _by_eigenvalues(self, rows: Array) -> Pixels:
        co = self.assembly.coefficients(rows, statically_twisted=self.statically_twisted)
        return lagging_pixels(self.assembly, co, self.period)

    def _stiff(self, table: Array, tolerance: float) -> bool:
        if self._lagging(table[:FIRST]) is not None:
            return False
        return bool(np.mean(_too_coarse(self.integrated(table[:FIRST], tolerance))) > 0.5)

    def _by(self, part: tuple[Array, float, bool]) -> Pixels:
        """Rows in the way that suits most of them."""
        rows, tolerance, stiff = part
        if (found := self._lagging(rows)) is not None:
            return found
        return self.stepped(rows) if stiff else self.integrated(rows, tolerance)

    def _mended(self, parts: list[Pixels], table: Array, tolerance: float, stiff: bool) -> Pixels:
        """All rows, those that one way leaves too coarse in the other."""
        found = _joined(parts)
        coarse = np.flatnonzero(_too_coarse(found))
        if len(coarse):
            found.put_better(self._by((table[coarse], tolerance, not stiff)), coarse)
        return found

    def integrated(self, table: Array, tolerance: float) -> Pixels:
        values, bounds = quantities(*self.matrices(table, tolerance))
        size, aside = self.assembly.topology.size, self.set_aside(table)
        return judge(np.ascontiguousarray(values.T), np.ascontiguousarray(bounds.T), size, aside)

    def stepped(self, table: Array) -> Pixels:
        """The same by steps of exponentials; an infinite error where the shortest ones do not tell."""
        topo = self.assembly.topology
        steps = steps_that_see(fastest_cycles(self.assembly, self.period))

        def run(rows: Array) -> Pixels:
            rates = LineRates.of(self.assembly, rows, self.statically_twisted) if topo.still or topo.graph else None
            rest = rates.rest() if rates and topo.still else None
            beside = None if rest is None else lambda which, z: rest[which].transpose(0, 2, 1) @ z @ rest[which]
            march, trace = self._marched(rows, rates, steps)
            found = step_halving(
                march, len(rows), 2 * topo.size, tolerance=COARSE, least_steps=steps, aside=beside
            )  # fmt: skip
            error = np.where(np.isfinite(found.radius), found.error, np.inf)
            return Pixels.of(found.radius, error, found.critical, trace, topo.size)

        parts = np.array_split(table, max(1, -(-len(table) // STEPPED_AT_ONCE)))
        return _joined(on_threads(run, parts, self.threads))

    def _marched(self, rows: Array, rates: LineRates | None, steps: int) -> tuple[March, Array]:
        """Matrices of ``rows`` in so many steps, and ∫ tr(M⁻¹C) dτ: of trees by the kernel, of others by ``rates``."""
        topo = self.assembly.topology
        if topo.graph:
            assert rates is not None
            return lambda which, count: marched(rates, which, 2 * topo.size, rates.period, count), rates.trace
        co = self.assembly.coefficients(rows, statically_twisted=self.statically_twisted)
        by_speed = loaded_by_speed(topo, co)
        program, batch = chain_program(topo, co, by_speed), chain_batch(topo, co, by_speed)
        points = ChainExponentials(program, batch, self.period, steps)
        trace = points.monodromies(np.arange(len(rows)), steps)[1]
        return lambda which, count: points.monodromies(which, count)[0], trace

    def growth(self, table: Array, found: Pixels) -> Array:
        """Growth rates [1/s] at the speeds of ``table``; of a radius smaller than its error that of the error, NaN
        where nothing is known."""
        known = np.where(found.error <= UNKNOWN, np.maximum(found.radius, found.error), np.nan)
        return np.asarray(np.log(np.maximum(known, 1e-300)) / self.period * table[:, 0])


def _too_coarse(found: Pixels) -> Flags:
    return ~(found.error <= np.maximum(COARSE, SHARE * np.abs(1 - found.radius)))


def _joined(parts: list[Pixels]) -> Pixels:
    return Pixels._make(map(np.concatenate, zip(*parts, strict=True)))
