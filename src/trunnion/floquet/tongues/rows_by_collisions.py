"""Rows of lines of more than three unknowns without patches: every meeting of two Floquet exponents looked at.

Regions open where two exponents meet, so such speeds also tell where to look between rows that were searched
completely. Patches of a long line's matrices cost far more than the few rows that a window takes. On each row
``unstable_ranges`` looks at an even grid of speeds and at every meeting that may open, and closes in on the ends of
what it finds. Tips are solved for as of any other rows.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from trunnion.arrays import Array, Complex, Flags
from trunnion.floquet.charts.chart_families import LineFamily
from trunnion.floquet.charts.chart_pixels import Pixels
from trunnion.floquet.charts.steady_state_family import SteadyStateFamily
from trunnion.floquet.ranges.collisions import exponent_collisions
from trunnion.floquet.ranges.span import Span
from trunnion.floquet.ranges.unstable import UnstableRanges, unstable_ranges
from trunnion.floquet.stability.stability_over_speed import StabilityOverSpeed, stability_along
from trunnion.floquet.tongues.boundary_traces import Search
from trunnion.floquet.tongues.multiplier_collisions import multiplier_collisions
from trunnion.floquet.tongues.region import Region
from trunnion.floquet.tongues.rows import BY_ROWS, OPEN_ERROR, TongueRow, kind_of, settled
from trunnion.results.verdict import Verdict

RISES = 0.02
"""Growth is largest on a level where it rises by this share of itself above that beside."""
SAMPLES = 49
"""Places of a row along a parameter that is not a speed, at least."""
MOVES, HALVINGS = 0.25, 4
"""Change of phase [rad] from one place to the next above which there is one between them, and so many times."""
WORDS = (
    "were searched at an even grid of speeds and at every meeting of two Floquet exponents that joints and meshes can "
    "open: a heuristic, so narrow regions may be missing"
)


SAMPLED_WORDS = (
    f"were sampled at {SAMPLES} places or more and looked at closely where growth is largest and wherever two "
    "multipliers meet: a heuristic, so narrow regions may be missing"
)


@dataclass(frozen=True)
class RowFamily:
    """A line over its speed and a parameter, row by row; ``family`` has the speed along x."""

    family: LineFamily

    def span(self, y: float) -> Span:
        """The speeds of the row at ``y``."""
        low, high = self.family.x.values[[0, -1]].tolist()
        twisted = self.family.statically_twisted
        return Span(
            self.family.assembly, low, high, lambda table: self.family.y.columns.put(table, y),
            statically_twisted=twisted,
        )  # fmt: skip

    def judged(self, span: Span, y: float, speed: Array) -> StabilityOverSpeed:
        """Stability at speeds (speed,) of the row at ``y``."""
        if isinstance(self.family, SteadyStateFamily):
            self.family.row(y)
            found = self.family.in_numpy(speed, np.full(len(speed), y))
            assert found is not None
            with np.errstate(divide="ignore"):
                growth = np.asarray(np.log(found.radius) * speed / self.family.period)
            return StabilityOverSpeed(
                speed, found.radius, found.error, found.critical, found.verdict, growth, self.family.period
            )
        twisted = self.family.statically_twisted
        return stability_along(self.family.assembly, speed, statically_twisted=twisted, table=span.table(speed))

    def unstable(self, y: float) -> UnstableRanges:
        """Unstable speeds of the row at ``y``."""
        span = self.span(y)
        return unstable_ranges(span, lambda speed: self.judged(span, y, speed), swing=self._swing(y))

    def met(self, y: float) -> tuple[Array, Array]:
        """Speeds (collisions,) of the row at ``y`` at which two exponents meet that may open, and growth rates
        there."""
        if self.family.passive:
            return np.zeros(0), np.zeros(0)
        span = self.span(y)
        speed = np.unique(exponent_collisions(span, span.start, span.high, self._swing(y)).speed)
        return speed, self.judged(span, y, speed).growth_rate if len(speed) else np.zeros(0)

    def _swing(self, y: float) -> float | None:
        return self.family.swing(y) if isinstance(self.family, SteadyStateFamily) else None


def rows_by_collisions(region: Region, family: LineFamily) -> Search:
    """The search of rows y = const of a line over its speed."""
    along = RowFamily(family)

    def search(v: Array) -> list[TongueRow]:
        v = np.atleast_1d(np.asarray(v, dtype=float))
        return [_row(family, float(own), along.unstable(float(y))) for own, y in zip(v, region.y(v), strict=True)]

    return search


def sampled_rows(region: Region) -> Search:
    """The search of rows along any parameter of a line about its own motion: at ``SAMPLES`` even places and at more
    where phases move by much from one to the next, closely where ρ is largest and wherever two multipliers meet."""

    def search(v: Array) -> list[TongueRow]:
        v = np.atleast_1d(np.asarray(v, dtype=float))
        seen = [_sampled(region, float(own)) for own in v]
        row = [np.full(len(one.marks), k) for k, one in enumerate(seen)]
        peaked = [np.full(len(one.peaks), k) for k, one in enumerate(seen)]
        looked = [np.full(len(one.close), k) for k, one in enumerate(seen)]
        rows = settled(
            region, v, (np.concatenate(row), np.concatenate([one.marks for one in seen])),
            (np.concatenate(peaked), np.concatenate([one.peaks for one in seen])),
            (np.concatenate(looked), np.concatenate([one.close for one in seen])),
        )  # fmt: skip
        return [_with_unknown(one, own.known, own.places) for one, own in zip(rows, seen, strict=True)]

    return search


@dataclass(frozen=True)
class _Samples:
    """What samples of a row show: ``places`` and where something is ``known`` of them, ``marks`` between stable and
    unstable ones, ``peaks`` among the unstable, and stretches to be looked at closely."""

    places: Array
    known: Flags
    marks: Array
    peaks: Array
    close: Array


def _sampled(region: Region, v: float) -> _Samples:
    family, y = region.family, float(region.y(np.array(v)))
    assert isinstance(family, SteadyStateFamily)
    places = np.linspace(region.box.u0, region.box.u1, SAMPLES)
    pixels, values = family.with_multipliers(region.x(places), y)
    for _ in range(HALVINGS):
        fast = np.flatnonzero(_moves(values) > MOVES)
        if not len(fast):
            break
        between = (places[fast] + places[fast + 1]) / 2
        more, own = family.with_multipliers(region.x(between), y)
        order = np.argsort(np.concatenate([places, between]))
        places, values = np.concatenate([places, between])[order], np.concatenate([values, own])[order]
        every = zip(pixels._asdict().values(), more._asdict().values(), strict=True)
        pixels = Pixels._make(np.concatenate(both)[order] for both in every)
    over = pixels.radius - 1 - pixels.error
    change = np.flatnonzero((over[:-1] > 0) != (over[1:] > 0))
    height = np.where(np.isfinite(over), over, -np.inf)
    inner = height[1:-1]
    top = np.flatnonzero((inner <= 0) & (inner >= height[:-2]) & (inner >= height[2:]))
    _, met = multiplier_collisions(
        lambda at, _: family.with_multipliers(region.x(at), y)[1], places, values[None]
    )  # fmt: skip
    reach = np.diff(places).max() / 4
    about = np.clip(met[:, None] + reach * np.array([-1.0, 1.0]), places[0], places[-1])
    return _Samples(
        places, np.isfinite(over), (places[change] + places[change + 1]) / 2, places[over > 0],
        np.concatenate([np.stack([places[top], places[top + 2]], axis=1), about]),
    )  # fmt: skip


def _moves(values: Complex) -> Array:
    """The largest change of phase [rad] from each sample to the next; NaN beside samples of which nothing is known."""
    phase = np.sort(np.abs(np.angle(values)), axis=1)
    return np.asarray(np.abs(np.diff(phase, axis=0)).max(axis=1))


def _with_unknown(row: TongueRow, known: Flags, places: Array) -> TongueRow:
    """With stretches beside places of which nothing is known."""
    lost = np.flatnonzero(~known)
    ends = np.stack([places[np.maximum(lost - 1, 0)], places[np.minimum(lost + 1, len(places) - 1)]], axis=1)
    return replace(row, unknown=np.concatenate([row.unknown.reshape(-1, 2), ends]))


def tops(v: Array, met: list[tuple[Array, Array]]) -> Array:
    """Heights v (tops,) between levels ``v`` at which growth where exponents meet is largest and has not begun on the
    levels beside: there a region may lie that no level shows; ``met``: speeds and growth rates on every level."""
    found = []
    for k in range(1, len(v) - 1):
        for speed, growth in zip(*met[k], strict=True):
            beside = [_nearest(met[j], speed) for j in (k - 1, k + 1)]
            if growth <= 0 and max(beside) <= growth and min(beside) < (1 + RISES) * growth:
                found.append(_vertex(v[k - 1 : k + 2], np.array([beside[0], growth, beside[1]])))
    return np.unique(found)


def _nearest(met: tuple[Array, Array], speed: float) -> float:
    """The growth rate at the meeting nearest to a speed; NaN where there is none."""
    return float(met[1][np.abs(met[0] - speed).argmin()]) if len(met[0]) else np.nan


def _vertex(x: Array, y: Array) -> float:
    """Of the parabola through three points (3,), the middle one highest, where it is highest."""
    left, right = np.diff(y) / np.diff(x)
    return float((x[0] + x[1]) / 2 + (x[2] - x[0]) / 2 * left / (left - right))


def _row(family: LineFamily, v: float, found: UnstableRanges) -> TongueRow:
    along, none = found.along, frozenset[int]()
    growth = np.where(np.isfinite(along.growth_rate), along.growth_rate, -np.inf)
    ranges = np.array(found.ranges).reshape(-1, 2)
    within = [np.flatnonzero((along.speed >= low) & (along.speed <= high)) for low, high in found.ranges]
    top = np.array([own[growth[own].argmax()] for own in within], dtype=np.intp)
    beyond = np.sort(family.to_patch(family.x.values[[0, -1]], True))
    ends = np.sort(family.to_patch(ranges, True), axis=1)
    order = np.argsort(ends[:, 0])
    ends, top = ends[order], top[order]
    inside = family.to_patch(along.speed[top], True)
    by = np.full(len(ends), BY_ROWS, dtype=np.int8)
    undecided = _unknown(family, found)
    return TongueRow(
        v=v, low=ends[:, 0], high=ends[:, 1], inside=inside, kind=kind_of(along.critical[top]), clipped=ends == beyond,
        unknown=undecided, by=by, of=(none,) * len(ends),
    )  # fmt: skip


def _unknown(family: LineFamily, found: UnstableRanges) -> Array:
    """Stretches (stretches, 2) in u about speeds that could not be computed, or not closely enough to tell."""
    along = found.along
    blind = ~np.isfinite(along.radius) | ((along.verdict == Verdict.UNDECIDED) & (along.error > OPEN_ERROR))
    place = np.flatnonzero(blind)
    last = len(along.speed) - 1
    stretch = np.stack([along.speed[np.maximum(place - 1, 0)], along.speed[np.minimum(place + 1, last)]], axis=1)
    return np.sort(family.to_patch(stretch, True), axis=1)
