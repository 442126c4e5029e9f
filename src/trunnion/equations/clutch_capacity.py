"""What a clutch can carry on average: the torque of its friction, and what its spring adds beside it.

A motion of one period has a mean twist, so the mean torque in a clutch is that of the loads behind it. Where its spring
has no stage that goes on rising, nothing holds more than its friction and the spring's largest torque together.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from trunnion.driveline.clutches import Clutch
from trunnion.driveline.elements import Rotor
from trunnion.equations.coefficients import Assembly
from trunnion.equations.sliders import sliders
from trunnion.equations.stage_laws import stage_law
from trunnion.equations.steady_base import has_joint_angles
from trunnion.errors import InputError

ROUNDING = 1e-9
"""Share of its capacity by which a load may exceed it by rounding."""


class CapacityLimitedClutch(NamedTuple):
    """A clutch whose torque is bounded: place of its compliance, name, torque of its friction [N m], the load that it
    carries on average (its size), and what its spring takes of that at most."""

    compliance: int
    name: str
    friction: float
    load: float
    spring: float

    @property
    def holds(self) -> float:
        """Largest mean torque [N m] in the direction of the load."""
        return self.friction + self.spring


def bounded_clutches(assembly: Assembly, speed: float) -> tuple[CapacityLimitedClutch, ...]:
    """The clutches that no spring holds in the direction of their load at an input ``speed`` [rad/s]; those without a
    load, that none holds in either direction."""
    topo, packed, table = assembly.topology, assembly.packed, assembly.table(1, speed)
    static = assembly.static_torque(table)[0]
    sliders_ = sliders(packed, topo, table[0])
    found = []
    for e, compliance in enumerate(topo.compliances):
        place = compliance.shafts[0]
        clutch = packed.line.elements[place]
        if not (isinstance(clutch, Clutch) and clutch.friction):
            continue
        law = stage_law(packed.line, place, packed.column, table).first
        rising, forces = law.slopes[[0, -1]] > 0, law.at_knots[[0, -1]] if law.knots.size else np.zeros(2)
        side = int(static[e] > 0)
        if rising[side] if static[e] else rising.any():
            continue
        holds = sum(slider.torque for slider in sliders_ if slider.compliance == e)
        found.append(
            CapacityLimitedClutch(e, assembly.line.names[place], holds, abs(float(static[e])), abs(float(forces[side])))
        )
    return tuple(found)


def refuse_overload(assembly: Assembly, speed: float) -> None:
    """Refuse a line in which a clutch carries more than it can hold, at an input ``speed`` [rad/s].

    Raises
    ------
    InputError : names the clutch, its load, and what it holds.
    """
    for clutch in bounded_clutches(assembly, speed):
        if clutch.load > (1 + ROUNDING) * clutch.holds:
            held = "its friction and its spring hold" if clutch.spring else "its friction holds"
            raise InputError(
                f"carries a load of {clutch.load:.6g} N m, more than the {clutch.holds:.6g} N m that {held}, and no "
                "spring takes the rest: it slips away and has no periodic motion",
                element=clutch.name, key="friction",
                remedy=f"raise its friction torque above {clutch.load - clutch.spring:.6g} N m, lower the load, or "
                "give it a stiffness that holds the rest; tn.simulate follows it as it slips",
            )  # fmt: skip


def carries_static_torque(assembly: Assembly) -> bool:
    """Whether the mean torques of a periodic motion are those of the loads at the mean speed, whatever the vibration.

    Bent joints, loads by the square of the speed, torques by order and drives that keep a speed add to them.
    """
    disks = [element for element in assembly.line.elements if isinstance(element, Rotor)]
    return not (
        assembly.topology.free
        or has_joint_angles(assembly)
        or any(disk.tangent or disk.loaded_by_square or any(one.order for one in disk.excitation) for disk in disks)
    )
