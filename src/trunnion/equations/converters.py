"""Torque converters in the stations of a line: what linear equations and those of motion have of them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.torque_converters import TorqueConverter
from trunnion.equations.line_coefficients import CrossDamping
from trunnion.equations.topology import Topology
from trunnion.errors import InputError
from trunnion.laws.converter import ConverterRun

NEAR = 1e-3
"""Share of the last speed ratio within which a motion that ends there has come beyond it."""


@dataclass(frozen=True)
class PlacedConverter:
    """A converter in the stations of a line: pump, the shaft as fast as the turbine, turbine; its compliance."""

    name: str
    element: TorqueConverter
    pump: int
    turbine: int
    compliance: int
    sense: float

    @property
    def run(self) -> ConverterRun | None:
        """How it runs where equations are linear about it."""
        return self.element.run

    def across(self, cases: int) -> Iterator[CrossDamping]:
        """What its link does not have of the slopes of its torques."""
        if self.run is None:
            return
        stations = self.pump, self.turbine
        for i, on in enumerate(stations):
            for j, by in enumerate(stations):
                own = self.compliance if on == self.turbine else None
                yield CrossDamping(on, by, np.full(cases, self.run.left[i, j]), own)

    @property
    def numbers(self) -> Array:
        """As ``line_kernel`` reads them."""
        head = [self.pump, self.turbine, self.compliance, self.sense, len(self.element.curves)]
        return np.concatenate([head, self.element.law.pieces.ravel()])

    def torques(self, pump_speed: Array, turbine_speed: Array) -> tuple[Array, Array]:
        """T_p and T_t [N m] in the sense that the line turns, at speeds in it (time,)."""
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.maximum(np.where(pump_speed > 0, turbine_speed / pump_speed, 0.0), self.element.law.ratios[0])
        takes = self.element.law.pump(ratio) * pump_speed**2
        return takes, self.element.law.torque_ratio(ratio) * takes

    def left_curves(self, speed: Array) -> str:
        """What is said where a motion ends as it comes beyond the curves, at speeds of all stations (station,) there;
        empty where it does not."""
        pump, turbine = (float(self.sense * speed[one]) for one in (self.pump, self.turbine))
        last = self.element.law.ratios[-1]
        if pump > 0 and turbine / pump < last * (1 - NEAR):
            return ""
        there = f"a speed ratio of {turbine / pump:.6g}" if pump > 0 else "a pump that stands or turns backwards"
        return (
            f"{self.name} comes to {there}, beyond its curves, which end at {last:g}; add points, above 1 with a "
            "negative capacity, or end the run before that"
        )


def placed_converters(line: Driveline, topo: Topology) -> tuple[PlacedConverter, ...]:
    """The converters of a line that are not locked."""
    found = []
    for e in topo.converting:
        compliance = topo.compliances[e]
        (place,) = compliance.shafts
        element = line.elements[place]
        assert isinstance(element, TorqueConverter)
        pump, turbine = topo.stations[compliance.near].before, topo.reference[compliance.far_group]
        sense = float(np.sign(float(topo.speed_ratio[pump])))
        found.append(PlacedConverter(line.names[place], element, pump, turbine, e, sense))
    return tuple(found)


def require_even(line: Driveline, topo: Topology, angled: list[int]) -> None:
    """Refuse ``angled`` joints rigidly beside a converter, whose slopes would vary with them.

    Raises
    ------
    InputError : so.
    """
    for one in placed_converters(line, topo):
        for station in (one.pump, one.turbine):
            at = station
            while at != topo.reference[topo.group_of(at)] and at not in angled:
                at = topo.stations[at].before
            if at in angled:
                raise InputError(
                    f"turns unevenly with {line.names[topo.stations[at].element]} at its side, and its torques with it",
                    element=one.name, key="curves", remedy="put a Shaft between joint and converter",
                )  # fmt: skip
