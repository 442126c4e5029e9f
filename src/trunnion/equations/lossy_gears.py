"""Gears that lose power, in the stations of a line."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Never

from trunnion.driveline.driveline import Driveline
from trunnion.driveline.gear_losses import MeshLoss
from trunnion.errors import InputError


@dataclass(frozen=True)
class Rub:
    """A mesh of the ``element`` at a place that loses power: friction acts on station ``at`` against another, or on it
    alone where that is −1, by the torque that passes to station ``driven``; see ``MeshLoss``."""

    name: str
    element: int
    at: int
    against: int
    driven: int
    loss: MeshLoss


def lossy_gears(
    line: Driveline, coordinates: Sequence[Sequence[int]]
) -> tuple[tuple[Rub, ...], tuple[tuple[int, int], ...]]:
    """Meshes that lose power, and station and element of those whose oil drags, by the stations of every element's
    ``coordinates``."""
    rubs, drags = [], []
    for i, (element, own) in enumerate(zip(line.elements, coordinates, strict=True)):
        for loss in element.losses:
            against = -1 if loss.against is None else own[loss.against]
            rubs.append(Rub(line.names[i], i, own[loss.at], against, own[loss.driven], loss))
        if getattr(element, "drag_torque", None):
            drags.append((own[0], i))
    return tuple(rubs), tuple(drags)


def refuse_in_loops(line: Driveline, rub: Rub, knot: int) -> Never:
    """Refuse a mesh that loses power in a line whose springs close a loop."""
    key = rub.loss.key
    raise InputError(
        f"loses by the torque that the mesh passes on, which springs share where {line.names[knot]} closes a loop",
        element=rub.name, key=key, value=getattr(line.elements[rub.element], key),
        remedy="write its loss at the torque it runs at as drag_torque",
    )  # fmt: skip
