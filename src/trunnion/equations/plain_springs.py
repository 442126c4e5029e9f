"""Shafts that state one stiffness and one damping: read from the packed numbers for all at once.

Long lines consist of them, and one step for all of them costs as much as for one of them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Places
from trunnion.driveline.parameters import PackedLine
from trunnion.driveline.shafts import Shaft
from trunnion.equations.topology import Topology


@dataclass(frozen=True)
class PlainSprings:
    """Of each spring its ``compliance``, and the columns of its ``stiffness`` and ``damping``; of those with a fork
    behind them their place among these, ``forked``, the ``station`` there and the column of the ``fork`` offset, −1
    for none; the compliances that remain are the ``others``."""

    compliance: Places
    stiffness: Places
    damping: Places
    forked: Places
    station: Places
    fork: Places
    others: tuple[int, ...]

    def put_shift(self, shift: Array, table: Array, twist: Array) -> None:
        """Fork offsets and ``twist`` (case, compliance) into ``shift`` (case, station) of the stations behind."""
        offsets = np.where(self.fork >= 0, table[:, self.fork], 0.0)
        shift[:, self.station] = twist[:, self.compliance[self.forked]] + offsets


def plain_springs(packed: PackedLine, topo: Topology) -> PlainSprings:
    """Those of a line."""
    line, column = packed.line, packed.column
    rows: list[tuple[int, int, int]] = []
    forks: list[tuple[int, int, int]] = []
    others: list[int] = []
    for e, compliance in enumerate(topo.compliances):
        i = compliance.shafts[0]
        one = line.elements[i]
        stated = type(one) is Shaft and one.stiffness is not None and one.loss is None
        if len(compliance.shafts) > 1 or not stated or line.damping_ratio is not None:
            others.append(e)
            continue
        if (i, compliance.number) in topo.behind:
            forks.append((len(rows), topo.behind[i, compliance.number], column(i, "fork_offset")))
        rows.append((e, column(i, "stiffness"), column(i, "damping")))
    springs, stiffness, damping = np.array(rows, dtype=np.intp).reshape(-1, 3).T
    forked, station, fork = np.array(forks, dtype=np.intp).reshape(-1, 3).T
    return PlainSprings(springs, stiffness, damping, forked, station, fork, tuple(others))
