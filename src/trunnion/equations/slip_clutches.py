"""Slip clutches in a line: rigid links where they stick, and shafts of their own in equations that let them slip."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.slip_clutches import SlipClutch, Slipping
from trunnion.equations.coefficients import Assembly
from trunnion.errors import InputError

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
        """As ``released_kernel`` reads them, its table standing at ``table`` of all clutches' numbers."""
        return [self.compliance, self.holds, self.slides, self.over, stride, len(self.table), table, 0.0]


def refuse_slip_clutches(line: Driveline) -> None:
    """Refuse a line with a slip clutch, for analyses that follow neither its slip nor where it would begin.

    Raises
    ------
    InputError : names the clutch.
    """
    for name, element in line.parts:
        if isinstance(element, SlipClutch):
            raise InputError(NOT_FOLLOWED, element=name, key="torque", value=element.torque, remedy=TAKE_AS_RIGID)


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
