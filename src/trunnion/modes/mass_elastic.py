"""The line as a mass–elastic system, and its modes as Holzer tables: what a classification society asks to see.

Every rotation of the straight line is one mass, with the inertias of all that is tied rigidly to it; every spring joins
two of them. Shafts in series are one spring.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.equations.coefficients import Assembly
from trunnion.modes.natural_frequencies import NaturalFrequencies

ROUNDING = 1e-9
"""Share of the largest rotation below which a mass stands still."""


@dataclass(frozen=True)
class MassRow:
    """One rotation. inertia [kg m²] at its own speed; speed_ratio: that speed over the input's [-]."""

    name: str
    inertia: float
    speed_ratio: float

    @property
    def referred(self) -> float:
        """Inertia referred to the input's speed [kg m²]."""
        return self.inertia * self.speed_ratio**2


@dataclass(frozen=True)
class SpringRow:
    """One spring between two rotations, at the speed of the one behind it.

    between: names of the rotations; what drives the line in front where it is prescribed. stiffness [N m/rad];
    damping [N m s/rad]; loss: loss factor at all frequencies [-]; diameter [m]: smallest outer one stated, NaN without.
    """

    name: str
    between: tuple[str, str]
    stiffness: float
    damping: float
    loss: float
    speed_ratio: float
    diameter: float

    @property
    def referred(self) -> float:
        """Stiffness referred to the input's speed [N m/rad]."""
        return self.stiffness * self.speed_ratio**2


@dataclass(frozen=True)
class HolzerTable:
    """One mode of the undamped straight line.

    mode: its number; frequency [rad/s]; amplitude (mass,) [-]: rotation of each mass, the largest 1; inertia_torque
    (mass,) and torque (spring,) [N m/rad]: per radian of the largest rotation; nodes: springs in which rotation changes
    its sign, and where, as the share of the spring's twist in front of the node.
    """

    mode: int
    frequency: float
    amplitude: Array
    inertia_torque: Array
    torque: Array
    nodes: tuple[tuple[str, float], ...]


def masses(assembly: Assembly) -> tuple[MassRow, ...]:
    """Every rotation, from the drive on."""
    topo = assembly.topology
    ratios = topo.mean_speeds[topo.firsts]
    return tuple(
        MassRow(name, float(inertia), float(ratio))
        for name, inertia, ratio in zip(topo.names, assembly.aligned.mass[0], ratios, strict=True)
    )


def springs(assembly: Assembly) -> tuple[SpringRow, ...]:
    """Every spring, in the order of the line."""
    topo, names = assembly.topology, assembly.line.names
    numbers = assembly.coefficients(assembly.table(1), any_frequency=True)
    drive = names[0]
    rows = []
    for e, compliance in enumerate(topo.compliances):
        far = topo.reference[compliance.far_group] if compliance.far is None else compliance.far
        ends = (topo.unknown_of[compliance.near], topo.unknown_of[far])
        stiffness = float(numbers.stiffness[0, e])
        elements = [assembly.line.elements[i] for i in compliance.shafts]
        outer = [d for one in elements if (d := getattr(one, "outer_diameter", None))]
        rows.append(
            SpringRow(
                " and ".join(names[i] for i in compliance.shafts),
                (topo.names[ends[0]] if ends[0] >= 0 else drive, topo.names[ends[1]] if ends[1] >= 0 else drive),
                stiffness,
                float(numbers.damping[0, e]),
                float(numbers.loss[0, e]) / stiffness if stiffness else 0.0,
                float(topo.mean_speeds[far]),
                min(outer, default=np.nan),
            )
        )
    return tuple(rows)


def holzer(found: NaturalFrequencies, mode: int) -> HolzerTable:
    """The table of a ``mode`` (1 the first).

    The torque of a spring is its stiffness times its twist; every mass is in balance, J ω² θ is the difference of the
    torques beside it, which ``tests/modes`` holds.
    """
    assembly = found.assembly
    topo, numbers = assembly.topology, assembly.coefficients(assembly.table(1), any_frequency=True)
    frequency, amplitude = float(found.undamped_frequency[mode - 1]), found.shape[:, mode - 1]
    torque = numbers.stiffness[0] * (topo.elongations @ amplitude)
    return HolzerTable(
        mode=mode,
        frequency=frequency,
        amplitude=amplitude,
        inertia_torque=frequency**2 * (assembly.aligned.inertia[0] @ amplitude),
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
