"""Cylinders that do not fire: which a line has, and what the line is called with one of them out of work."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from trunnion.driveline.elements import Disk, Element
from trunnion.driveline.engine import Engine

SILENT = {"misfiring": "misfiring", "cut_out": "cut out"}
"""Key that puts a cylinder out of work, and how names of cases say it."""


@dataclass(frozen=True)
class Cylinder:
    """Cylinder ``number`` of the element called ``owner``, an Engine or a Disk with firing angles; ``alone``: its only
    one."""

    owner: str
    number: int
    alone: bool = False

    def __str__(self) -> str:
        return self.owner if self.alone else f"{self.owner} cylinder {self.number}"

    def silent(self, key: str) -> str:
        """What a line is called in which it is "misfiring" or "cut_out"."""
        return f"{self} {SILENT[key]}"


def cylinders(parts: Sequence[tuple[str, Element]], key: str = "misfiring") -> Iterator[Cylinder]:
    """The cylinders of elements as they are stated that can be put out of work by ``key``; none that already is so in
    the other way."""
    for name, element in parts:
        if isinstance(element, Engine):
            other = element.cut_out if key == "misfiring" else element.misfiring
            numbers = [number for number in range(1, len(element.firing_order) + 1) if number != other]
        elif isinstance(element, Disk) and key == "misfiring":
            numbers = list(range(1, len(element.firing_angles) + 1))
        else:
            continue
        yield from (Cylinder(name, number, len(numbers) == 1 and isinstance(element, Disk)) for number in numbers)


def silent_cases(parts: Sequence[tuple[str, Element]]) -> dict[str, tuple[Cylinder, str]]:
    """What every line with one cylinder out of work is called: that cylinder, and how it is."""
    return {one.silent(key): (one, key) for key in SILENT for one in cylinders(parts, key)}
