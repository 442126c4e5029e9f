"""A line over a range of speeds: its numbers at every speed, and the pieces within which it stays the same line.

A spring enters another stage, the mean torque turns round, a table of excitations has a point: there responses jump or
have a kink. Between two such speeds they are smooth but near resonances.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.composite import owners
from trunnion.equations.amplitudes import beyond
from trunnion.equations.coefficients import Assembly
from trunnion.equations.harmonics import DiskTorque, disk_torques
from trunnion.equations.mean_clutch import states_a_motion
from trunnion.equations.stage_laws import has_stages, stage_law

PROBES = 129
"""Speeds at which one looks whether the line is the same."""
EXACT = 1e-12
"""How closely a change is located, as a share of the range."""
NARROW = 1e-9
"""Share of the range below which a piece is a point."""
NOTHING = 1e-9
"""Share of the largest mean torque of any spring below which it is none."""
STANDSTILL = 1e-6
"""Share of the highest speed that stands for none."""


@dataclass(frozen=True)
class SmoothRange:
    """Speeds [rad/s] within which nothing of the line changes but smoothly."""

    low: float
    high: float

    def without(self, low: float, high: float) -> list[SmoothRange]:
        """What is left of it beside a range."""
        if high <= self.low or low >= self.high:
            return [self]
        return [SmoothRange(a, b) for a, b in ((self.low, low), (high, self.high)) if b > a]


@dataclass(frozen=True)
class Gap:
    """Speeds [rad/s] that cannot be looked at, and why, in words."""

    low: float
    high: float
    why: str


@dataclass(frozen=True)
class Span:
    """``assembly`` from ``low`` to ``high`` [rad/s]; ``put`` changes rows of packed numbers (case, column) in place
    that follow the speed in column 0, for a line whose numbers do."""

    assembly: Assembly
    low: float
    high: float
    put: Callable[[Array], None] | None = None
    points: tuple[float, ...] = field(default=())
    """Speeds at which what ``put`` does has a kink."""
    lost: tuple[Gap, ...] = field(default=())
    """Speeds at which the line has no motion to look at."""
    statically_twisted: bool = True
    """Whether mean torques shift the phases of joints, where stability is looked at."""

    def table(self, speed: Array) -> Array:
        """Packed numbers (case, column) at ``speed`` (case,) [rad/s]."""
        table = self.assembly.table(len(speed), speed)
        if self.put:
            self.put(table)
        return table

    @property
    def start(self) -> float:
        """The lowest speed looked at: standstill counts as next to none."""
        return max(self.low, STANDSTILL * self.high)

    @cached_property
    def pieces(self) -> tuple[SmoothRange, ...]:
        """The range in pieces, what cannot be looked at left out."""
        left = [piece for piece in self._same if not self._uncovered((piece.low + piece.high) / 2)]
        for gap in self.lost:
            left = [part for piece in left for part in piece.without(gap.low, gap.high)]
        return tuple(
            piece for piece in left if piece.high - piece.low > NARROW * self.high or self.low == self.high
        )  # fmt: skip

    @cached_property
    def gaps(self) -> tuple[Gap, ...]:
        """What cannot be looked at."""
        found: list[Gap] = []
        for piece in self._same:
            why = self._uncovered((piece.low + piece.high) / 2)
            if why and found and found[-1].why == why and np.isclose(found[-1].high, piece.low, rtol=1e-9):
                found[-1] = Gap(found[-1].low, piece.high, why)
            elif why:
                found.append(Gap(piece.low, piece.high, why))
        return tuple(sorted([*found, *self.lost], key=lambda gap: gap.low))

    @cached_property
    def _same(self) -> tuple[SmoothRange, ...]:
        if self.start >= self.high:
            return (SmoothRange(self.high, self.high),)
        inner = [p for p in self.points if self.start < p < self.high]
        probes = np.unique(np.concatenate([np.linspace(self.start, self.high, PROBES), self._turning, inner]))
        cuts = {*inner, *self._changes(probes)}
        ends = [self.start, *sorted(cuts), self.high]
        return tuple(SmoothRange(a, b) for a, b in pairwise(ends) if b > a)

    @property
    def _turning(self) -> Array:
        """Where a mean torque is largest or smallest: of second degree in the speed, it may turn round twice nearby."""
        if self.put:
            return np.zeros(0)
        nodes = np.linspace(self.start, self.high, 3)
        a, b, c = self._torque(nodes)
        bend, slope = a - 2 * b + c, (c - a) / 2
        with np.errstate(divide="ignore", invalid="ignore"):
            top = nodes[1] - slope / bend * (nodes[1] - nodes[0])
        return np.asarray(top[np.isfinite(top) & (top > self.start) & (top < self.high)])

    def _torque(self, speed: Array) -> Array:
        """Mean torques (case, spring)."""
        return self.assembly.static_torque(self.table(speed))

    def _changes(self, probes: Array) -> Iterator[float]:
        """Speeds at which the line changes, each as a pair just below and above."""
        largest = float(np.abs(self._torque(probes)).max(initial=0.0))
        signs = self._signs(probes, largest)
        ends, of = np.stack([probes[:-1], probes[1:]], axis=1), np.stack([signs[:-1], signs[1:]], axis=1)
        while True:
            differ = (of[:, 0] != of[:, 1]).any(axis=1)
            ends, of = ends[differ], of[differ]
            located = ends[:, 1] - ends[:, 0] <= EXACT * self.high
            yield from ends[located].ravel().tolist()
            ends, of = ends[~located], of[~located]
            if not len(ends):
                return
            middle = ends.mean(axis=1)
            at = self._signs(middle, largest)
            ends = np.concatenate([np.stack([ends[:, 0], middle], axis=1), np.stack([middle, ends[:, 1]], axis=1)])
            of = np.concatenate([np.stack([of[:, 0], at], axis=1), np.stack([at, of[:, 1]], axis=1)])

    def _signs(self, speed: Array, largest: float) -> Array:
        """Numbers (case, …) that stay the same within a piece; ``largest`` mean torque of any spring [N m]."""
        line, topo, column = self.assembly.line, self.assembly.topology, self.assembly.packed.column
        table, torque = self.table(speed), self._torque(speed)
        parts = [np.zeros((len(speed), 0))]
        for e, compliance in enumerate(topo.compliances):
            place, own = compliance.shafts[0], torque[:, e]
            if has_stages(line.elements[place]):  # a mesh without load knows no margin against hammer
                parts.append(np.where(np.abs(own) <= NOTHING * largest, 0.0, np.sign(own))[:, None])
            if has_stages(line.elements[place]) and not states_a_motion(line.elements[place]):
                law = stage_law(line, place, column, table)
                stage = np.where(own == 0, law.stage(np.zeros(len(speed))), law.stage_under(own))
                parts.append(stage[:, None].astype(float))
        tables = self._tables(table)
        parts += [np.searchsorted(points, place)[:, None].astype(float) for _, points, place in tables]
        return np.concatenate(parts, axis=1)

    def _tables(self, table: Array) -> Iterator[tuple[DiskTorque, tuple[float, ...], Array]]:
        """Every excitation that acts and has a table, the points and where the rows of ``table`` read it (case,); of
        those of a disk whose tables have the same points one."""
        read = {
            (one.element, one.law.axes): one
            for one in reversed(disk_torques(self.assembly))
            if one.law.axes and not one.prescribed
        }
        for one in reversed(read.values()):
            for points, place in one.places(self.assembly, table):
                yield one, points, place

    def _uncovered(self, speed: float) -> str:
        """Why nothing can be computed at a speed; empty where it can."""
        for one, points, place in self._tables(self.table(np.array([speed]))):
            if beyond(points, place)[0]:
                line = self.assembly.line
                (whose,) = owners(zip(line.names, line.elements, strict=True), [one.name])
                return f"the table of {whose} covers {one.law.covers}{self._at_its_own(one)}; extend it"
        return ""

    def _at_its_own(self, torque: DiskTorque) -> str:
        """Whose speed a table goes over, where that is not the input's."""
        over_speed = any(over == "speeds" for over, _ in torque.law.axes)
        turns_alike = np.isclose(abs(float(self.assembly.topology.speed_ratio[torque.station])), 1.0, rtol=1e-12)
        return " at its own speed" if over_speed and not turns_alike else ""
