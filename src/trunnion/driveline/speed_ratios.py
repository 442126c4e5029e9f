"""Mean speeds of the shafts of a line over that of its input, by its gears alone."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from trunnion.driveline.chain import ElementChain
from trunnion.driveline.parts import Dragged, Geared, Jointed, Loose, Part, Prescribed, Sprung, Tied


def speed_ratios(line: ElementChain) -> list[Fraction]:
    """Mean speed over the input's of the shaft in front of every element."""
    return [own[0] for own in coordinate_speeds(line)]


def coordinate_speeds(line: ElementChain) -> list[list[Fraction]]:
    """Mean speeds over the input's of the coordinates of every element, that of the shaft in front of it first."""
    found: list[list[Fraction]] = []
    for i, element in enumerate(line.elements):
        parent = line.parents[i]
        own = [Fraction(1) if parent is None else found[parent][line.hangs_on[i]]]
        for part in element.parts():
            if (turned := _turned(part, own)) is not None:
                own.append(turned)
        found.append(own)
    return found


def _turned(part: Part, own: Sequence[Fraction]) -> Fraction | None:
    """Speed of the new shaft that a part makes; None where it makes none."""
    match part:
        case Geared(ratio, to):
            return own[to] / ratio
        case Loose(to, speed):
            return own[to] * speed
        case Tied(of):
            return sum((share * own[to] for to, share in of), Fraction(0))
        case Sprung(to) | Dragged(to) | Jointed(_, to):
            return own[to]
        case Prescribed():
            return None
    return None
