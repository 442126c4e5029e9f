"""The line as a mass–elastic system, and its modes as Holzer tables: what a classification society asks to see.

Every rotation of the straight line is one mass, with the inertias of all that is tied rigidly to it; every spring joins
two of them. Shafts in series are one spring. What a differential drives by two other shafts is a mass of its own, whose
rotation is their sum.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.elements import Element
from trunnion.equations.coefficients import Assembly
from trunnion.modes.natural_frequencies import NaturalFrequencies

ROUNDING = 1e-9
"""Share of the largest rotation below which a mass stands still."""


@dataclass(frozen=True)
class MassRow:
    """One rotation. inertia [kg m²] at its own speed; speed_ratio: that speed over the input's [-].

    sum_of: names of other rotations and their shares, where it turns by their sum.
    """

    name: str
    inertia: float
    speed_ratio: float
    sum_of: tuple[tuple[str, float], ...] = ()

    @property
    def referred(self) -> float:
        """Inertia referred to the input's speed [kg m²]."""
        return self.inertia * self.speed_ratio**2


@dataclass(frozen=True)
class SpringRow:
    """One spring between two rotations, at the speed of the one behind it.

    between: names of the rotations; what drives the line in front where it is prescribed. stiffness [N m/rad];
    damping [N m s/rad]; loss: loss factor at all frequencies [-]; diameter [m]: smallest outer one stated, NaN without;
    stated_loss [-], loss_frequency [rad/s]: the loss factor that the damping follows from, at its frequency, NaN where
    it does not.
    """

    name: str
    between: tuple[str, str]
    stiffness: float
    damping: float
    loss: float
    speed_ratio: float
    diameter: float
    stated_loss: float = np.nan
    loss_frequency: float = np.nan

    @property
    def referred(self) -> float:
        """Stiffness referred to the input's speed [N m/rad]."""
        return self.stiffness * self.speed_ratio**2


@dataclass(frozen=True)
class HolzerTable:
    """One mode of the undamped straight line.

    mode: its number; frequency [rad/s]; amplitude (mass,) [-]: rotation of each mass, the largest of those that turn
    by no sum 1; inertia_torque (mass,) and torque (spring,) [N m/rad]: per radian of that; nodes: springs in which
    rotation changes its sign, and where, as the share of the spring's twist in front of the node.
    """

    mode: int
    frequency: float
    amplitude: Array
    inertia_torque: Array
    torque: Array
    nodes: tuple[tuple[str, float], ...]


def masses(assembly: Assembly) -> tuple[MassRow, ...]:
    """Every rotation, from the drive on."""
    topo, heavy = assembly.topology, assembly.coefficients(assembly.table(1), any_frequency=True).inertia[0]
    by_group = topo.relative_ratios**2 * heavy
    rows = []
    for group, first in _rotations(assembly):
        inertia = sum(float(part) for s, part in enumerate(by_group) if topo.group_of(s) == group)
        rows.append(
            MassRow(_called(assembly, first), inertia, float(topo.mean_speeds[first]), _shares(assembly, first))
        )
    return tuple(rows)


def _rotations(assembly: Assembly) -> list[tuple[int, int]]:
    """Group and first station of every mass: of the unknowns, and of what turns by the sum of some and is heavy."""
    topo, heavy = assembly.topology, assembly.coefficients(assembly.table(1), any_frequency=True).inertia[0]
    found = []
    for group, first in enumerate(topo.reference):
        summed = topo.coordinate[group] < 0 and topo.turning[first].any()
        if topo.coordinate[group] >= 0 or (summed and any(heavy[s] for s in _members(assembly, group))):
            found.append((group, first))
    return sorted(found, key=lambda one: one[1])


def _members(assembly: Assembly, group: int) -> list[int]:
    return [s for s, station in enumerate(assembly.topology.stations) if station.group == group]


def _called(assembly: Assembly, station: int) -> str:
    """The name of the rotation of a station: of its unknown, of a disk that turns with it, of what drives it."""
    topo, names = assembly.topology, assembly.line.names
    place = topo.unknown_of[station]
    if place >= 0:
        return topo.names[place]
    if not topo.turning[station].any():
        return names[0]
    points = dict(topo.points)
    seen = [points[s] for s in _members(assembly, topo.group_of(station)) if s in points]
    return seen[0] if seen else names[topo.stations[station].element]


def _shares(assembly: Assembly, station: int) -> tuple[tuple[str, float], ...]:
    """By which unknowns a rotation turns that is none itself."""
    topo = assembly.topology
    if topo.unknown_of[station] >= 0:
        return ()
    return tuple((name, float(share)) for name, share in zip(topo.names, topo.turning[station], strict=True) if share)


def springs(assembly: Assembly) -> tuple[SpringRow, ...]:
    """Every spring, in the order of the line."""
    topo, names = assembly.topology, assembly.line.names
    numbers = assembly.coefficients(assembly.table(1), any_frequency=True)
    rows = []
    for e, compliance in enumerate(topo.compliances):
        far = topo.reference[compliance.far_group] if compliance.far is None else compliance.far
        stiffness = float(numbers.stiffness[0, e])
        elements = [assembly.line.elements[i] for i in compliance.shafts]
        outer = [d for one in elements if (d := getattr(one, "outer_diameter", None))]
        rows.append(
            SpringRow(
                " and ".join(names[i] for i in compliance.shafts),
                (_called(assembly, compliance.near), _called(assembly, far)),
                stiffness,
                float(numbers.damping[0, e]),
                float(numbers.loss[0, e]) / stiffness if stiffness else 0.0,
                float(topo.mean_speeds[far]),
                min(outer, default=np.nan),
                *_stated_loss(elements),
            )
        )
    return tuple(rows)


def _stated_loss(elements: Sequence[Element]) -> tuple[float, float]:
    """Loss factor and frequency that all ``elements`` of a spring state alike; NaN where they do not."""
    stated = {(getattr(one, "loss", None), getattr(one, "loss_factor_frequency", None)) for one in elements}
    loss, frequency = stated.pop()
    return (np.nan, np.nan) if stated or loss is None or frequency is None else (float(loss), float(frequency))


def holzer(found: NaturalFrequencies, mode: int) -> HolzerTable:
    """The table of a ``mode`` (1 the first).

    The torque of a spring is its stiffness times its twist; every mass is in balance, J ω² θ is the difference of the
    torques beside it. Where a differential ties three of them, their sums by its shares are.
    """
    assembly = found.assembly
    topo, numbers = assembly.topology, assembly.coefficients(assembly.table(1), any_frequency=True)
    frequency, amplitude = float(found.undamped_frequency[mode - 1]), found.shape[:, mode - 1]
    torque = numbers.stiffness[0] * (topo.elongations @ amplitude)
    rotation = np.array([topo.turning[first] @ amplitude for _, first in _rotations(assembly)])
    inertia = np.array([one.inertia for one in masses(assembly)])
    return HolzerTable(
        mode=mode,
        frequency=frequency,
        amplitude=rotation,
        inertia_torque=frequency**2 * inertia * rotation,
        torque=torque,
        nodes=tuple(_nodes(assembly, amplitude)),
    )


def _nodes(assembly: Assembly, amplitude: Array) -> list[tuple[str, float]]:
    """Springs whose two ends rotate against each other, both seen at the far end's speed."""
    topo, names = assembly.topology, assembly.line.names
    found = []
    for compliance, twist in zip(topo.compliances, topo.elongations @ amplitude, strict=True):
        far = topo.turning[topo.reference[compliance.far_group] if compliance.far is None else compliance.far]
        behind = float(far @ amplitude)
        ahead = behind - float(twist)
        still = ROUNDING * float(np.abs(amplitude).max())  # a ring that oil alone drags along stands still
        if behind * ahead < 0 and min(abs(behind), abs(ahead)) > still:
            found.append((" and ".join(names[i] for i in compliance.shafts), abs(ahead) / abs(twist)))
    return found
