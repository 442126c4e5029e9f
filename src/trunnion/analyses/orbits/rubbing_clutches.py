"""What the clutches of a line do in a periodic motion that is integrated, and where one slips on and none is found."""

from __future__ import annotations

import numpy as np

from trunnion.analyses.orbits.periodic_orbit import PeriodicOrbit
from trunnion.analyses.orbits.stuck_clutches import StuckClutch, slips_on, stuck_clutches
from trunnion.arrays import Array
from trunnion.equations.line_system import LineSystem
from trunnion.equations.steady_base import bent
from trunnion.numerics.curves import extremes, fourier
from trunnion.results.outcome import Outcome
from trunnion.systems.maps import SETTLED, IntegratedMap

WAITED = 100
"""Periods after which a clutch shows whether it slips on."""


def continuum_of(line: LineSystem, orbit: PeriodicOrbit) -> tuple[StuckClutch, ...]:
    """The clutches with sliders that never slip in a motion of the line."""
    if not orbit.stuck:
        return ()
    run, count = orbit.trajectory, len(line.sliders)
    cuts, stuck = run.time_of_state, [orbit.system.sliders.index(name) for name in orbit.stuck]

    def twist(times: Array) -> Array:
        return line.observe(orbit.system, times, run.at(times)).twist

    seen = extremes(lambda times: run.at(times)[:, -count:], cuts)
    unknown = "its joints are bent" if bent(line.assembly) else ""
    if any(one.law.order is not None for one in line.harmonics):
        unknown = unknown or "torques by order act where the twist has turned them"
    mean = fourier(twist, cuts, 0)[0].real
    return stuck_clutches(line.assembly, line.sliders, stuck, seen.low, seen.high, mean, unknown)


def slipping_on(line: LineSystem, periods: int) -> Outcome | None:
    """What to say of a line where no motion was found because a clutch slips on with every period; None elsewhere."""
    place, states = IntegratedMap.of(line.system, periods=periods, tolerance=SETTLED), [line.rest()]
    for wait in (WAITED, 1, 1):
        settled = place.settle(states[-1], wait)
        if settled is None:
            return None
        states.append(settled)
    twists = line.observe(line.system, np.zeros(3), np.array(states[1:])).twist
    return slips_on(line.assembly, line.speed, line.sliders, twists)
