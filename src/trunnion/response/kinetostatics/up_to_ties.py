"""The part of a line whose turn follows from its input alone: up to differentials, and without what closes a loop.

Behind a differential or a planetary set with three free shafts each shaft turns as the other two let it. What closes a
loop takes up, as wind-up, by how much its two ends would turn apart: each way round is judged as if it were not there.
"""

from __future__ import annotations

from dataclasses import dataclass

from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import Element
from trunnion.equations.topology import stations_of
from trunnion.response.kinetostatics.chain import ties


@dataclass(frozen=True)
class UpToTies:
    """``line`` without the elements called ``ties`` and without what hangs behind them, the elements ``behind``."""

    line: Driveline
    ties: tuple[str, ...] = ()
    behind: tuple[str, ...] = ()


def up_to_ties(line: Driveline) -> UpToTies:
    """What of ``line`` turns by its input alone; the whole of a line without loops and differentials."""
    tied = ties(stations_of(line))
    if not tied:
        return UpToTies(line)
    behind: list[int] = []
    elements: list[Element] = []
    for i, (name, element) in enumerate(line.parts):
        if line.parents[i] in (*tied, *behind):
            behind.append(i)
        elif i not in tied:
            elements.append(element.model_copy(update={"name": name}))
    names = line.names
    return UpToTies(Driveline(elements, name=line.name), tuple(names[i] for i in tied), tuple(names[i] for i in behind))
