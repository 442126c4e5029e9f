"""Charts about the periodic motions that lines really make: row by row, each motion followed from point to point.

A free–free line with joint angles makes no other motion; of one that is driven at a prescribed speed the motion of
rigid shafts, which other charts are about, is the limit of small twist. Along every row of a chart motions are solved
by the balance of their harmonics. Wherever the tangents of neighbours on a row or a column say that the curve of
motions may turn back between them, it is followed in both directions: where one ends in another motion than the other,
it folds back, several motions belong to one point, and which of them runs depends on how one came there. Such points
are not judged.

Motions are not analytic functions of the parameters across a fold, so that no patches are made: every point has its own
equations, linearised about its own motion. Some are compared with ``stability``'s way, which finds the motion by
shooting, and a chart that differs from it by more than the errors of both is refused.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from trunnion.arrays import Array, Complex, Flags
from trunnion.driveline.driveline import Driveline
from trunnion.equations.coefficients import Assembly
from trunnion.equations.steady_base import refuse_dragged, require_steady_base, require_tree
from trunnion.errors import ComputationError, InputError
from trunnion.floquet.charts.axes import AxisRequest, ChartAxis, axis, check_corners
from trunnion.floquet.charts.chart_pixels import Pixels
from trunnion.floquet.propagation.about_steady_states import beside_neutral_multipliers, multipliers_about
from trunnion.numerics import harmonics as fourier
from trunnion.numerics.patches.patches import Box, PatchedFunction
from trunnion.results.chart import ChartPoint, SpotCheck
from trunnion.results.counts import counted
from trunnion.results.verdict import Verdict
from trunnion.steady.free.folds_between import Stretches, folds_between, folds_of, slopes, step_of
from trunnion.steady.free.free_balance import SteadyStates
from trunnion.steady.free.periodic_steady_states import (
    SEVERAL,
    Break,
    KnownSteadyState,
    SteadyStateCurve,
    SteadyStatesBySpeed,
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

    def column(self, x: float) -> SteadyStateCurve:
        """The motions of one column, of which nothing is known yet."""
        balance = self.unexcited.balance.along(lambda value: self.table(np.full(len(value), x), value))
        return SteadyStateCurve(balance, (float(self.y.values[0]), float(self.y.values[-1])))

    def row(self, x: Array, y: float) -> SteadyStateRow:
        """The motions and multipliers at ``x`` (points,), rising, of one row."""
        keep_time()
        curve, size = self._begun(x, y), 2 * len(self.unexcited.balance.turn)
        across, up = self._slopes(curve, x, y)
        curve.broken = folds_between(curve, x, across)
        motions = slopes_along(curve, x)
        found = multipliers_about(motions)
        critical = np.where(found.critical.imag < 0, found.critical.conj(), found.critical)
        values = beside_neutral_multipliers(motions, found)
        aside = np.where(np.isfinite(found.radius), 1.0, np.nan)[:, None]
        every = np.concatenate([np.repeat(aside, size - values.shape[1], axis=1), values], axis=1)
        pixels = Pixels(found.radius, found.error, critical, found.verdict)
        return SteadyStateRow(pixels, every, curve.broken, curve.at_all(x), up)

    def _begun(self, x: Array, y: float) -> SteadyStateCurve:
        """The motions of one row at ``x``; where none is found, as on rows beside or within a fold that they do not
        cross, from one that a column leads to."""
        curve = self.curve(y)
        for value in x[[len(x) // 2, 0, -1]].tolist():
            motions = curve.at_all(x)
            if (motions.found & motions.resolved).any():
                break
            column = self.column(value)
            column.at_all(np.unique(np.append(self.y.values, y)))
            if column.known[y].settled:
                curve.known = {value: column.known[y]}
        return curve

    def _slopes(self, curve: SteadyStateCurve, x: Array, y: float) -> tuple[Array, Array]:
        """d rows / dx and d rows / dy of the motions at ``x`` of one row."""
        motions, steps = curve.at_all(x), (step_of(self.x.values), step_of(self.y.values))
        # Towards the inside, so that no value leaves its range.
        by_x = np.where(x + steps[0] > self.x.values[-1], -steps[0], steps[0])
        by_y = -steps[1] if y + steps[1] > self.y.values[-1] else steps[1]
        tables = [self.table(x + by_x, np.full(len(x), y)), self.table(x, np.full(len(x), y + by_y))]
        across, up = curve.balance.changes(motions, tables)
        return across / by_x[:, None, None], up / by_y

    def pixels(self, x: Array, y: Array, tell: Callable[[float], None] = lambda share: None) -> SteadyStatePixels:
        """All points (y, x)."""
        rows = []
        for r, value in enumerate(y.tolist()):
            rows.append(self.row(x, value))
            tell(0.9 * (r + 1) / len(y))
        found = SteadyStatePixels.of(rows, x, y)
        return found.with_columns(tuple((float(at), one) for at, one in self._column_folds(rows, x, y)), y, x)

    def _column_folds(self, rows: list[SteadyStateRow], x: Array, y: Array) -> Iterator[tuple[float, Break]]:
        """Folds between neighbouring rows, by value of x."""
        h = max(row.motions.h for row in rows)
        motions = np.stack([fourier.resized(row.motions.rows, h) for row in rows], axis=1)
        slope = np.stack([fourier.resized(row.slope, h) for row in rows], axis=1)
        known = np.stack([row.motions.found & row.motions.resolved for row in rows], axis=1)
        for c, value in enumerate(x.tolist()):
            keep_time()
            # Beyond rows on which nothing was found, as within a fold, the next one that is known is the neighbour.
            usable = np.flatnonzero(known[c])
            pairs = Stretches.of(y[usable], motions[c, usable], slope[c, usable])
            if not pairs.bent.any():
                continue
            curve = self.column(value)
            curve.known = {float(y[r]): KnownSteadyState.of(rows[r].motions, c) for r in usable}
            yield from ((value, one) for one in folds_of(curve, pairs, float(y[0]), float(y[-1])))

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
        """Anywhere in the box: its row and its column followed from the chart's own points."""
        along = np.unique(np.append(self.x.values, x))
        row, c = self.row(along, y), int(np.searchsorted(along, x))
        pixel, values = row.pixels.at(c), row.every[c]
        if row.motions.found[c] and self._folds_along_column(x, y, KnownSteadyState.of(row.motions, c)):
            pixel, values = Pixels.failed(()), np.full_like(values, np.nan)
        return ChartPoint(
            x=x, y=y, spectral_radius=float(pixel.radius), error_estimate=float(pixel.error),
            verdict=Verdict(int(pixel.verdict)), multipliers=values[np.argsort(-np.abs(values))], interpolated=False,
        )  # fmt: skip

    def _folds_along_column(self, x: float, y: float, motion: KnownSteadyState) -> bool:
        """Whether a point whose row finds a ``motion`` lies where the motions of its column fold back."""
        curve, along = self.column(x), np.unique(np.append(self.y.values, y))
        curve.known[y] = motion
        folds = folds_between(curve, along, slopes(curve, along))
        return any(one.low < y < one.high and one.why == SEVERAL for one in folds)

    @property
    def function(self) -> PatchedFunction:
        """No patches."""
        return PatchedFunction((), (Box.around(self.x.values, self.y.values),))

    def resampled(self, x: Array, y: Array) -> Pixels:
        """On other points inside the box."""
        return self.pixels(x, y).every


@dataclass(frozen=True)
class SteadyStateRow:
    """pixels (point,), every multiplier (point, 2n), those set aside as 1; broken: where the motions break off; motions
    (point,), and how their harmonics change with y (point, n, 2h + 1)."""

    pixels: Pixels
    every: Complex
    broken: tuple[Break, ...]
    motions: SteadyStates
    slope: Array

    @property
    def start(self) -> Array:
        """States (point, 2n) at no rotation of the input."""
        return self.motions.states[:, 0]


Folds = tuple[tuple[float, Break], ...]
"""Breaks by the value of the other parameter."""


@dataclass(frozen=True)
class SteadyStatePixels:
    """``every`` point (y, x); where several motions were found and where none; the folds by value of y, and those
    between rows by value of x; start (y, x, 2n): states at no rotation of the input."""

    every: Pixels
    several: Flags
    none: Flags
    folds: Folds
    column_folds: Folds
    start: Array

    @classmethod
    def of(cls, rows: Sequence[SteadyStateRow], x: Array, y: Array) -> SteadyStatePixels:
        """Of all rows."""
        every = Pixels.failed((len(y), len(x)))
        for r, row in enumerate(rows):
            every.put((r,), row.pixels)
        folds = tuple((value, one) for value, row in zip(y.tolist(), rows, strict=True) for one in row.broken)
        flags = _inside(folds, y, x)
        return cls(every, *flags, folds, (), np.stack([row.start for row in rows]))

    def with_columns(self, folds: Folds, y: Array, x: Array) -> SteadyStatePixels:
        """With folds between rows; what lies between two of them is not judged either."""
        several, none = (flags.T for flags in _inside(folds, x, y))
        every = Pixels.failed(several.shape)
        good = ~(several | none)
        every.put((good,), self.every.at((good,)))
        several |= self.several
        # A row that lies within the fold of a column finds nothing, where that column finds several.
        none = (none | self.none) & ~several
        return replace(self, every=every, several=several, none=none, column_folds=folds)

    def remarks(self, chart: SteadyStateChart, x: Array, y: Array) -> list[str]:
        """What a reader must know of points that are not judged."""
        said = [
            "each point is judged about the line's own periodic motion, without its excitations; where that folds back "
            "is searched along rows and columns"
        ]
        narrow = [
            f"{other.label} = {at:.6g}, {own.label} = {one.low:.8g} to {one.high:.8g}"
            for folds, own, other, values in (
                (self.folds, chart.x, chart.y, x),
                (self.column_folds, chart.y, chart.x, y),
            )
            for at, one in folds
            if one.why == SEVERAL and not ((values > one.low) & (values < one.high)).any()
        ]
        if narrow:
            where = f"at {len(narrow)} places" if len(narrow) > 1 else "at one place"
            first = f"the first: {narrow[0]}" if len(narrow) > 1 else narrow[0]
            said.append(f"{where} the periodic motion folds back between two neighbouring points ({first})")
        unknown = (self.every.verdict == Verdict.FAILED) & ~self.several & ~self.none
        for flags, why in (
            (self.several, "the periodic motion folds back: several belong to one point, which are not judged"),
            (self.none, "the periodic motion breaks off, and none was found"),
            (unknown, "the periodic motion was not found, or needs more harmonics than are taken"),
        ):
            if flags.any():
                r, c = np.argwhere(flags)[0]
                count = int(flags.sum())
                place = f"at {chart.x.label} = {x[c]:.6g}, {chart.y.label} = {y[r]:.6g}"
                first = f"the first {place}" if count > 1 else place
                said.append(f"at {counted(count, 'point')} {why} ({first})")
        return said


def _inside(folds: Folds, rows: Array, along: Array) -> tuple[Flags, Flags]:
    """Points (row, along) between folds: where several motions were found, and where none."""
    several, none = np.zeros((2, len(rows), len(along)), dtype=bool)
    for value, one in folds:
        inside = (rows[:, None] == value) & (along > one.low) & (along < one.high)
        several |= inside & (one.why == SEVERAL)
        none |= inside & (one.why != SEVERAL)
    return several, none
