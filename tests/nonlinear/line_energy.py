"""Kinetic and elastic energy of lines at a constant input speed, for tests of conservation and of virtual work."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from trunnion.equations.line_regimes import line_kernel as kernel
from trunnion.equations.line_system import LineSystem
from trunnion.equations.stage_laws import has_stages, stage_law
from trunnion.systems.system import System


def energy(line: LineSystem, system: System, time: ArrayLike, state: ArrayLike) -> tuple[Any, Any]:
    """Both (time,) [J] along a motion of ``system``, the line's or one with other parameters."""
    times, states = np.atleast_1d(time).astype(float), np.atleast_2d(state).astype(float)
    assembly, topo, n = line.assembly, line.assembly.topology, line.assembly.topology.size
    table = np.array([[system.parameters[label] for label in assembly.packed.labels]])
    coefficients = line.untwisted(table)
    speed, count = table[0, 0], len(topo.stations)
    speeds = [_speeds(t, x, speed, system.numbers, count) for t, x in zip(times, states, strict=True)]
    kinetic = np.square(speeds) @ coefficients.inertia[0] / 2
    potential = np.zeros(len(times))
    for e, twist in enumerate(line.observe(system, times, states).twist.T):
        place = topo.compliances[e].shafts[0]
        if has_stages(assembly.line.elements[place]):
            potential += stage_law(assembly.line, place, assembly.packed.column, table).first.energy(twist)
        else:
            potential += coefficients.stiffness[0, e] * twist**2 / 2
    for stretch, slider in zip(states[:, 2 * n :].T, line.sliders, strict=True):
        potential += slider.stiffness * stretch**2 / 2
    return kinetic, potential


def _speeds(time: float, state: Any, speed: float, numbers: Any, stations: int) -> Any:
    """Speed of every station [rad/s]."""
    d, v, r, r1, r2 = np.empty((5, stations))
    kernel().walk(speed * time, speed, state, numbers, stations, kernel().HEAD, d, v, r, r1, r2)
    return v
