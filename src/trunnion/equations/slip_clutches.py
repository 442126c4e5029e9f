"""Slip clutches in a line: rigid links where they stick, and shafts of their own in equations that let them slip."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.slip_clutches import SlipClutch, Slipping
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.errors import InputError

MOST_CLUTCHES = 4
NOT_FOLLOWED = "sticks and slips, which this analysis does not follow"
TAKE_AS_RIGID = "write a Ratio of 1 in its place, which is the clutch while it sticks; tn.simulate follows it"


@dataclass(frozen=True)
class PlacedClutch:
    """A clutch that may slip: its compliance, capacity at rest T_s and when sliding T_c [N m], v_s [rad/s], and the
    table (points, 2) of its share over time [s]."""

    name: str
    compliance: int
    holds: float
    slides: float
    over: float
    table: Array

    def numbers(self, stride: int, table: int) -> list[float]:
        """As ``slip_kernel`` reads them, its table standing at ``table`` of all clutches' numbers."""
        return [self.compliance, self.holds, self.slides, self.over, stride, len(self.table), table]


def has_slip_clutches(line: Driveline) -> bool:
    """Whether a line has any, sticking or not."""
    return any(isinstance(element, SlipClutch) for element in line.elements)


def refuse_slip_clutches(line: Driveline) -> None:
    """Refuse a line with a slip clutch, for analyses that follow neither its slip nor where it would begin.

    Raises
    ------
    InputError : names the clutch.
    """
    for name, element in line.parts:
        if isinstance(element, SlipClutch):
            raise InputError(NOT_FOLLOWED, element=name, key="torque", value=element.torque, remedy=TAKE_AS_RIGID)


def slipping(assembly: Assembly) -> Assembly:
    """The line with a rotation of its own behind every slip clutch.

    Raises
    ------
    InputError : more clutches than are followed; no inertia on a side of one.
    """
    if not has_slip_clutches(assembly.line):
        return assembly
    return assembly.derived(_slipping)  # type: ignore[no-any-return]


def _slipping(assembly: Assembly) -> Assembly:
    line = assembly.line
    names = [name for name, element in line.parts if isinstance(element, SlipClutch)]
    if len(names) > MOST_CLUTCHES:
        raise InputError(
            f"are {len(names)} slip clutches, more than the {MOST_CLUTCHES} that are followed",
            element=", ".join(names), remedy="write a Ratio of 1 for those that stick",
        )  # fmt: skip
    elements = tuple(
        Slipping(**element.stated) if isinstance(element, SlipClutch) else element for element in line.elements
    )
    found = assemble(line.model_copy(update={"elements": elements}))
    if line.damping_ratio is not None:  # it holds at the lowest mode of the line that sticks
        found.__dict__["damping_reference"] = assembly.damping_reference
    return found


def placed_clutches(assembly: Assembly, row: Array) -> tuple[PlacedClutch, ...]:
    """The clutches that may slip, at one row of packed numbers.

    Raises
    ------
    InputError : a torque or speed that is not positive, where parameters were varied.
    """
    found, column = [], assembly.packed.column
    for e, compliance in enumerate(assembly.topology.compliances):
        place = compliance.shafts[0]
        element, name = assembly.line.elements[place], assembly.line.names[place]
        if not isinstance(element, Slipping):
            continue
        stated = {
            key: float(row[column(place, key)])
            for key in ("torque", "sliding_torque", "stribeck_speed")
            if column(place, key) >= 0
        }
        for key, value in stated.items():
            if not value > 0:
                raise InputError("must be positive", element=name, key=key, value=value)
        holds = stated["torque"]
        table = np.array([element.clamping_times, element.clamping_shares]).T.reshape(-1, 2)
        slides, over = stated.get("sliding_torque", holds), stated.get("stribeck_speed", 1.0)
        found.append(PlacedClutch(name, e, holds, slides, over, table))
    return tuple(found)


def clutch_numbers(clutches: tuple[PlacedClutch, ...], strides: list[int]) -> Array:
    """All numbers of the clutches as ``slip_kernel`` reads them, none for none."""
    if not clutches:
        return np.zeros(0)
    at, head = sum(len(clutch.numbers(0, 0)) for clutch in clutches), list[float]()
    for clutch, stride in zip(clutches, strides, strict=True):
        head += clutch.numbers(stride, at)
        at += clutch.table.size
    tables = [clutch.table.ravel() for clutch in clutches]
    return np.concatenate([head, *tables, [len(clutches), at + 2]])
