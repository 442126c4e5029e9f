"""Charts about the periodic motions that lines really make: row by row, each motion followed from point to point.

A free–free line with joint angles makes no other motion; of one that is driven at a prescribed speed the motion of
rigid shafts, which other charts are about, is the limit of small twist. Along every row of a chart motions are solved
by the balance of their harmonics, and followed in both directions wherever neighbours differ by more than a small step:
where one direction ends in another motion than the other, the curve of motions folds back, several motions belong to
one point, and which of them runs depends on how one came there. Such points are not judged.

Motions are not analytic functions of the parameters across a fold, so that no patches are made: every point has its own
equations, linearised about its own motion. Some are compared with ``stability``'s way, which finds the motion by
shooting, and a chart that differs from it by more than the errors of both is refused.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Complex, Flags
from trunnion.driveline.driveline import Driveline
from trunnion.equations.coefficients import Assembly
from trunnion.equations.steady_base import refuse_dragged, require_steady_base, require_tree
from trunnion.errors import ComputationError, InputError
from trunnion.floquet.charts.axes import AxisRequest, ChartAxis, axis, check_corners
from trunnion.floquet.charts.chart_pixels import Pixels
from trunnion.floquet.propagation.about_steady_states import multipliers_about
from trunnion.numerics.patches.patches import Box, PatchedFunction
from trunnion.results.chart import ChartPoint, SpotCheck
from trunnion.results.verdict import Verdict
from trunnion.steady.free.periodic_steady_states import (
    SEVERAL,
    Break,
    SteadyStateCurve,
    SteadyStatesBySpeed,
    breaks,
    slopes_along,
)
from trunnion.steady.shooting.periodic_orbit import PeriodicOrbit
from trunnion.waiting import keep_time

SPOTS = 4
"""Points compared with motions found by shooting."""
ROUGHLY = 1e-6
"""By how much multipliers about motions that are found in different ways may differ at least."""


@dataclass(frozen=True)
class SteadyStateChart:
    """A line over two of its parameters; ``unexcited`` knows its equations, ``x`` and ``y`` are read by its numbers."""

    line: Driveline
    unexcited: SteadyStatesBySpeed
    x: ChartAxis
    y: ChartAxis
    speed: float

    @classmethod
    def of(cls, assembly: Assembly, x: AxisRequest, y: AxisRequest, speed: float) -> SteadyStateChart:
        """Of axes that ``assembly`` has been found to have; ``speed`` [rad/s] where neither is it, else NaN.

        Raises
        ------
        InputError : springs with stages or play; torques that do not balance; an axis that moves excitations alone.
        """
        solved = SteadyStatesBySpeed(assembly.line)
        require_tree(assembly, "charts do")
        refuse_dragged(assembly)
        if solved.obstacle:
            raise InputError(
                f"is judged about its own periodic motion, and {solved.obstacle}, so that no chart follows it",
                element="driveline",
                remedy="ask stability at single speeds" if assembly.topology.free else "leave about_steady_state out",
            )
        own = solved.unexcited
        axes = []
        for request in (x, y):
            try:
                axes.append(axis(own, request, "x")[0])
            except InputError:
                raise InputError(
                    "moves excitations alone, which do not change how disturbances grow", key=str(request[0]),
                    remedy="give a parameter of the line itself",
                ) from None  # fmt: skip
        found = cls(assembly.line, solved, axes[0], axes[1], speed)
        check_corners(own, *axes)
        corners = found.table(axes[0].values[[0, 0, -1, -1]], axes[1].values[[0, -1, 0, -1]])
        require_steady_base(own, corners)
        return found

    @property
    def period(self) -> float:
        """Period [rad of input angle]."""
        return self.unexcited.balance.period

    def table(self, x: Array, y: Array) -> Array:
        """Packed numbers (point, column) of the line without excitations."""
        table = self.unexcited.unexcited.table(len(x), self.speed)
        self.x.columns.put(table, x)
        self.y.columns.put(table, y)
        return table

    def curve(self, y: float) -> SteadyStateCurve:
        """The motions of one row, of which nothing is known yet."""
        balance = self.unexcited.balance.along(lambda value: self.table(value, np.full(len(value), y)))
        return SteadyStateCurve(balance, (float(self.x.values[0]), float(self.x.values[-1])))

    def row(self, x: Array, y: float) -> SteadyStateRow:
        """The motions and multipliers at ``x`` (points,), rising, of one row."""
        keep_time()
        curve, size = self.curve(y), 2 * len(self.unexcited.balance.turn)
        curve.broken = breaks(curve, x, between=False)
        motions = slopes_along(curve, x)
        found = multipliers_about(motions)
        critical = np.where(found.critical.imag < 0, found.critical.conj(), found.critical)
        every = np.full((len(x), size), np.nan, dtype=complex)
        known = np.flatnonzero(np.isfinite(found.radius))
        if len(known):
            left = motions.beside_neutral(known, found.matrix[known])
            values = np.linalg.eigvals(left).astype(complex)
            aside = np.ones((len(known), every.shape[1] - values.shape[1]))
            every[known] = np.concatenate([aside, values], axis=1)
        pixels = Pixels(found.radius, found.error, critical, found.verdict)
        return SteadyStateRow(pixels, every, curve.broken, curve.at_all(x).states[:, 0])

    def pixels(self, x: Array, y: Array, tell: Callable[[float], None] = lambda share: None) -> SteadyStatePixels:
        """All points (y, x)."""
        every = Pixels.failed((len(y), len(x)))
        several, none = np.zeros(every.radius.shape, dtype=bool), np.zeros(every.radius.shape, dtype=bool)
        folds: list[tuple[float, Break]] = []
        start = np.full((*every.radius.shape, 2 * len(self.unexcited.balance.turn)), np.nan)
        for r, value in enumerate(y.tolist()):
            row = self.row(x, value)
            every.put((r,), row.pixels)
            start[r] = row.start
            for one in row.broken:
                inside = (x > one.low) & (x < one.high)
                several[r] |= inside & (one.why == SEVERAL)
                none[r] |= inside & (one.why != SEVERAL)
                folds.append((value, one))
            tell((r + 1) / len(y))
        return SteadyStatePixels(every, several, none, tuple(folds), start)

    def check(self, found: SteadyStatePixels, x: Array, y: Array) -> SpotCheck:
        """Some points compared with multipliers about the motions that shooting from the same start closes.

        Raises
        ------
        ComputationError : they differ by more than the errors of both.
        """
        pixels = found.every
        known = np.argwhere(np.isfinite(pixels.radius))
        rng = np.random.default_rng(pixels.radius.size)
        ratio = difference = 0.0
        looked = 0
        for r, c in known[rng.choice(len(known), min(SPOTS, len(known)), replace=False)] if len(known) else known:
            keep_time()
            shot = self._shot(self.table(x[[c]], y[[r]])[0], found.start[r, c])
            if not shot.outcome.ok:
                continue
            looked += 1
            turn = self.period / float(self.table(x[[c]], y[[r]])[0, 0])
            radius, error = shot.spectral_radius, shot.error_estimate
            own, share = float(pixels.radius[r, c]), turn / shot.period
            off = abs(radius**share - own)
            difference = max(difference, off)
            allowed = float(pixels.error[r, c]) + share * error * max(own, radius) + ROUGHLY
            ratio = max(ratio, off / allowed)
        if ratio > 1:
            raise ComputationError(
                f"motions closed by shooting move the spectral radius of the chart by {difference:.1e}, {ratio:.2g} "
                "times the error estimated; ask stability() for single points"
            )
        return SpotCheck(looked, ratio, difference)

    def _shot(self, row: Array, start: Array) -> PeriodicOrbit:
        """The motion at one row of packed numbers, integrated from ``start``."""
        from trunnion.equations.coefficients import assemble
        from trunnion.equations.line_system import line_system
        from trunnion.steady.shooting.free_orbit import kept_speed_orbit
        from trunnion.steady.shooting.periodic_orbit import periodic_orbit

        line = self.unexcited.unexcited.packed.line_at(row)
        prepared = line_system(assemble(line), float(row[0]), linearised=True)
        if self.unexcited.balance.free:
            return kept_speed_orbit(prepared, start, settle=False)
        return periodic_orbit(prepared.system, start=start, settle=False)

    def point(self, x: float, y: float) -> ChartPoint:
        """Anywhere in the box: the row followed from the chart's own points."""
        along = np.unique(np.append(self.x.values, x))
        row, c = self.row(along, y), int(np.searchsorted(along, x))
        values = row.every[c]
        return ChartPoint(
            x=x, y=y, spectral_radius=float(row.pixels.radius[c]), error_estimate=float(row.pixels.error[c]),
            verdict=Verdict(int(row.pixels.verdict[c])), multipliers=values[np.argsort(-np.abs(values))],
            interpolated=False,
        )  # fmt: skip

    @property
    def function(self) -> PatchedFunction:
        """No patches."""
        return PatchedFunction((), (Box.around(self.x.values, self.y.values),))

    def resampled(self, x: Array, y: Array) -> Pixels:
        """On other points inside the box."""
        return self.pixels(x, y).every


@dataclass(frozen=True)
class SteadyStateRow:
    """pixels (point,), every multiplier (point, 2n), those set aside as 1; broken: where the motions break off; start
    (point, 2n): the motion's state at no rotation of the input."""

    pixels: Pixels
    every: Complex
    broken: tuple[Break, ...]
    start: Array


@dataclass(frozen=True)
class SteadyStatePixels:
    """``every`` point (y, x); where several motions were found and where none; the folds by value of y; start (y, x,
    2n): states at no rotation of the input."""

    every: Pixels
    several: Flags
    none: Flags
    folds: tuple[tuple[float, Break], ...]
    start: Array

    def remarks(self, chart: SteadyStateChart, x: Array, y: Array) -> list[str]:
        """What a reader must know of points that are not judged."""
        said = ["each point is judged about the line's own periodic motion, without its excitations"]
        unknown = (self.every.verdict == Verdict.FAILED) & ~self.several & ~self.none
        for flags, why in (
            (self.several, "the periodic motion folds back: several belong to one point, which are not judged"),
            (self.none, "the periodic motion breaks off, and none was found"),
            (unknown, "the periodic motion was not found, or needs more harmonics than are taken"),
        ):
            if flags.any():
                r, c = np.argwhere(flags)[0]
                count = int(flags.sum())
                said.append(
                    f"at {count} point{'s' if count > 1 else ''} {why} (the first at {chart.x.label} = {x[c]:.6g}, "
                    f"{chart.y.label} = {y[r]:.6g})"
                )
        return said
