"""A bent line that starts free, about its own periodic motion: the base of its stability.

About the motion of rigid shafts at constant input speed, which is no motion of a free line, its rigid-body pair
grows by 0.36 β²Ω (two equal inertias, one joint): an artefact. Excitations of disks are left out,
which ``stability`` says.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.analyses.linear.forced_response import LinearResponse
from trunnion.analyses.orbits.free_orbit import kept_speed_orbit
from trunnion.analyses.orbits.periodic_orbit import PeriodicOrbit
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import Disk
from trunnion.equations.coefficients import assemble
from trunnion.equations.line_system import line_system
from trunnion.equations.steady_base import require_balance
from trunnion.errors import ComputationError

SAMPLES = 256


@dataclass(frozen=True)
class OwnMotion:
    """The motion, its twists and torques over one period, and the torque [N m at the input] beyond the balance."""

    orbit: PeriodicOrbit
    response: LinearResponse
    extra_torque: float


def own_motion(line: Driveline, speed: float) -> OwnMotion:
    """The periodic motion of a free line at mean input ``speed`` [rad/s], its disks not excited.

    Raises
    ------
    InputError : torques that do not balance.
    ComputationError : no motion found.
    """
    prepared = line_system(assemble(_quiet(line)), speed)
    require_balance(prepared.assembly, prepared.assembly.table(1, speed))
    found = kept_speed_orbit(prepared)
    orbit = found.orbit
    if not orbit.outcome.ok:
        raise ComputationError(f"no periodic motion of the free line was found to judge: {orbit.outcome}")
    times = orbit.period * np.arange(SAMPLES + 1) / SAMPLES
    states = orbit.trajectory.at(times)
    motion = prepared.observe(orbit.system, times, states)
    topo = prepared.assembly.topology
    # Nothing is cut off here, so no rotation of a joint's input counts as a deviation from what is known.
    response = LinearResponse.sampled(
        times * speed,
        motion.twist,
        motion.torque,
        states[:, : topo.size],
        np.zeros(len(topo.joints)),
        prepared.shafts,
        tuple(prepared.assembly.line.names[topo.stations[j].element] for j in topo.joints),
        topo.names,
    )
    return OwnMotion(orbit, response, found.extra_torque)


def _quiet(line: Driveline) -> Driveline:
    for name, element in zip(line.names, line.elements, strict=True):
        if isinstance(element, Disk) and element.excitation:
            line = line.replace(name, excitation=None)
    return line
