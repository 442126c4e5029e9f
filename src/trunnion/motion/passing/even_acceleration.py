"""The torque of a drive that would accelerate the rigid line evenly, at whatever speed the line has.

It is what balances the loads at the drive's own speed, and what accelerates the whole inertia. A line that a resonance
holds is given no more for that: unlike a governor the drive does not know by how much it is behind.
"""

from __future__ import annotations

import numpy as np

from trunnion.driveline.applied_torque import AppliedTorque
from trunnion.equations.applied_torques import PlacedTorque, disk_station, placed_frictions, placed_torques
from trunnion.equations.line_system import LineSystem
from trunnion.motion.transients.prepare import Actions

POINTS = 33
"""Speeds at which curves of the other disks are taken, besides their own points; between, it is a monotone cubic."""
BEYOND = 0.2
"""Of the range, by which the torque follows the loads on both sides of it."""


def accelerating(
    line: LineSystem, asked: Actions, drive: str, acceleration: float, first: float, last: float
) -> AppliedTorque:
    """Torque on the disk ``drive`` with which the rigid line with straight joints would gain ``acceleration`` [rad/s²]
    of its input between two speeds [rad/s], whatever else is ``asked`` to act over speed. What acts over time or angle
    is not balanced.
    """
    assembly, topo = line.assembly, line.assembly.topology
    co = line.untwisted(assembly.table(1, line.speed))
    ratio = np.abs(topo.mean_speeds)
    own = float(ratio[disk_station(assembly, drive, "drive")])
    inertia = float(co.inertia[0] @ ratio**2)
    constant, viscous, quadratic = (float(c[0] @ ratio**p) for c, p in
                                    ((co.load, 1), (co.viscous, 2), (co.quadratic, 3)))  # fmt: skip
    constant += sum(float(ratio[one.station]) * one.stated.torque for one in placed_frictions(assembly, asked[1]))
    others = [one for one in placed_torques(assembly, asked[0]) if _by_speed(one)]
    at_rest = (constant + inertia * acceleration) / own
    if not others:
        terms = f"({at_rest!r}) + ({viscous / own**2!r})*speed + ({quadratic / own**3!r})*speed^2"
        return AppliedTorque(on=drive, formula=terms)
    reach = BEYOND * (last - first)
    low, high = max(first - reach, 0.0), last + reach
    knots = [axis.knots / ratio[one.station] for one in others for axis in one.axes]
    speeds = np.unique(np.concatenate([np.linspace(low, high, POINTS), *(k[(k > low) & (k < high)] for k in knots)]))
    speeds = speeds[np.append(True, np.diff(speeds) > 1e-9 * high)]
    torque = at_rest + (viscous * speeds + quadratic * speeds**2) / own
    for one in others:
        size = float(ratio[one.station])
        torque -= size / own * np.array([one.value(0.0, size * float(w), 0.0) for w in speeds])
    return AppliedTorque(on=drive, speed=(own * speeds).tolist(), torque=torque.tolist(), between="cubic", hold=True)


def _by_speed(one: PlacedTorque) -> bool:
    """Whether it goes with the speed alone."""
    if one.stated.by_program:
        return set(one.stated.depends) <= {"speed"} and not one.axes
    return {axis.variable for axis in one.axes} | {one.first, one.second} <= {"speed", ""}
