"""Stability of many lines with joint angles that differ in their numbers, each about its own periodic motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from trunnion.arrays import Array, Places
from trunnion.equations.coefficients import Assembly
from trunnion.equations.steady_base import (
    has_periodic_base,
    refuse_dragged,
    require_own_motion,
    require_steady_base,
    require_tree,
)
from trunnion.equations.topology import require_period
from trunnion.errors import InputError
from trunnion.floquet.charts.chart_pixels import Pixels
from trunnion.floquet.tolerance.many_lines import ManyLines
from trunnion.waiting import keep_time

TOGETHER = 512
"""Lines whose motions are solved together."""


@dataclass(frozen=True)
class SteadyStateLines(ManyLines):
    """``pixels``: rows of the packed numbers of the line without its excitations → what is known of them; ``columns``
    those of them that the line itself has too, and ``own`` its places of these."""

    pixels: Callable[[Array, float], Pixels] = field(repr=False, default=lambda table, tolerance: Pixels.failed((0,)))
    columns: Places = field(default_factory=lambda: np.zeros(0, dtype=np.intp))
    own: Places = field(default_factory=lambda: np.zeros(0, dtype=np.intp))
    unexcited: Assembly | None = None

    def judged(self, table: Array, tolerance: float) -> Pixels:
        """Radius, error, critical multiplier and verdict of rows of ``table``, each (rows,)."""
        assert self.unexcited is not None
        parts = []
        for first in range(0, len(table), TOGETHER):
            keep_time()
            some = table[first : first + TOGETHER]
            rows = self.unexcited.table(len(some), 1.0)
            rows[:, self.columns] = some[:, self.own]
            parts.append(self.pixels(rows, tolerance))
        return Pixels._make(map(np.concatenate, zip(*parts, strict=True)))


def lines_like(
    assembly: Assembly, table: Array, twisted: bool, threads: int, *, about_steady_state: bool = False
) -> ManyLines:
    """``ManyLines`` of one line; each about its own motion if that is asked for, and of a free–free one that has joint
    angles at any row of ``table``, the first of which is typical.

    Raises
    ------
    InputError : as ``ManyLines.of``; springs with stages or play in a line that is judged about its own motion;
        straight joints, where that is asked for.
    """
    if about_steady_state:
        require_period(assembly.line, assembly.topology)
        require_own_motion(assembly, table)
    elif not has_periodic_base(assembly, table):
        return ManyLines.of(assembly, table[:1], twisted, threads)
    from trunnion.floquet.propagation.about_steady_states import pixels_of_rows
    from trunnion.steady.free.periodic_steady_states import SteadyStatesBySpeed

    require_tree(assembly, "studies of many lines do")
    refuse_dragged(assembly)
    require_steady_base(assembly, table[:1])
    solved = SteadyStatesBySpeed(assembly.line)
    if solved.obstacle:
        raise InputError(
            f"is judged about its own periodic motion, and {solved.obstacle}, so that many lines are not judged "
            "together",
            element="driveline",
            remedy="put a ConstantSpeed in front, or ask stability of single lines" if assembly.topology.free
            else "leave about_steady_state out, or ask stability of single lines",
        )  # fmt: skip
    place = {label: k for k, label in enumerate(assembly.packed.labels)}
    shared = [(k, place[label]) for k, label in enumerate(solved.unexcited.packed.labels) if label in place]
    columns, own = (np.array([pair[i] for pair in shared], dtype=np.intp) for i in (0, 1))

    def pixels(rows: Array, tolerance: float) -> Pixels:
        found = pixels_of_rows(solved.balance, rows, tolerance=tolerance)
        return Pixels(found.radius, found.error, found.critical, found.verdict)

    return SteadyStateLines(assembly, twisted, threads, pixels, columns, own, solved.unexcited)
