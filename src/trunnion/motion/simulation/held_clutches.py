"""Slip clutches that stick along a whole motion: what torque that takes of them.

Equations of motion have a clutch that sticks as a rigid link. Its torque is what moves the stations beyond it in their
group, by the power that passes it,

    T v = Σ (J v′ + load − push) v_s − Σ T_e v_near,

v the speed of the link, T_e the torques of the springs that go on from there; rigid joints between take no power. The
accelerations v′ are differences along the motion.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from trunnion.driveline.quantities import TORQUE, shown
from trunnion.driveline.slip_clutches import SlipClutch
from trunnion.equations.aligned import aligned_matrices, frequencies
from trunnion.equations.line_regimes import line_kernel
from trunnion.equations.slip_capacity import sticking_clutches
from trunnion.errors import InputError
from trunnion.numerics.curves import extremes

if TYPE_CHECKING:
    from trunnion.arrays import Array, Places
    from trunnion.equations.line_system import LineSystem
    from trunnion.systems.system import System

STEP = 1e-3
"""Of the differences, of 1 over the highest frequency of the line."""
ROUNDING = 1e-9
"""Share of its capacity by which a torque may exceed it by rounding."""


def held_torques(line: LineSystem, system: System, times: Array, states: Array) -> Array:
    """Torque [N m] that every slip clutch holds (time, clutch) at states x (time, state) of a motion, positive where it
    drives what lies beyond it."""
    topo, core, numbers = line.assembly.topology, line_kernel(), system.numbers
    step = STEP / max(_fastest(line), abs(line.speed), 1.0)
    regimes = [system.regime_at(float(t), x) for t, x in zip(times, states, strict=True)]
    known = zip(times, states, regimes, strict=True)
    rates = np.array([system.rate_at(float(t), x, regime) for t, x, regime in known])
    (motion, speed), (_, before), (_, after) = (
        line.moving(times + way * step, states + way * step * rates, numbers, np.array(regimes)) for way in (0, -1, 1)
    )
    torque, moved = motion.torque, motion.rotation
    acceleration = (after - before) / (2 * step)
    stations = numbers[core.HEAD : core.HEAD + len(topo.stations) * core.PER_STATION].reshape(-1, core.PER_STATION)
    load = stations[:, core.LOAD] + (stations[:, core.VISCOUS] + stations[:, core.QUADRATIC] * np.abs(speed)) * speed
    since = times - numbers[core.SINCE]
    omega = numbers[core.OMEGA] + numbers[core.ALPHA] * since
    load += stations[:, core.BY_SPEED] * omega[:, None] + stations[:, core.BY_SQUARE] * omega[:, None] ** 2
    theta = numbers[core.THETA] + (numbers[core.OMEGA] + numbers[core.ALPHA] * since / 2) * since
    angle = topo.mean_speeds * theta[:, None] + moved
    acts = stations[:, core.INERTIA] * acceleration + load - _pushes(line, numbers, times, angle)
    found = []
    for link, _ in sticking_clutches(line.assembly.packed, topo):
        own = _beyond(line, link)
        power = (acts[:, own] * speed[:, own]).sum(axis=1)
        onward = [e for e, one in enumerate(topo.compliances) if one.near in own]
        power -= (torque[:, onward] * speed[:, [topo.compliances[e].near for e in onward]]).sum(axis=1)
        found.append(power / speed[:, link])
    return np.array(found).reshape(-1, len(times)).T


def _fastest(line: LineSystem) -> float:
    """The highest natural frequency [rad/s], its springs at their stiffest."""
    aligned = aligned_matrices(line.assembly.topology, line.untwisted(line.assembly.table(1, line.speed)))
    return float(frequencies(aligned, still=line.assembly.topology.still)[0, -1])


def _beyond(line: LineSystem, link: int) -> Places:
    """The stations that a rigid link drives rigidly."""
    topo, own = line.assembly.topology, [link]
    for s in range(link + 1, len(topo.stations)):
        if topo.stations[s].before in own and topo.group_of(s) == topo.group_of(link):
            own.append(s)
    return np.array(own, dtype=np.intp)


def _pushes(line: LineSystem, numbers: Array, times: Array, angle: Array) -> Array:
    """Harmonic torques on every station (time, station) [N m]."""
    core = line_kernel()
    first, found = int(core.places(numbers)[1]), np.zeros_like(angle)
    for h in range(int(numbers[core.HARMONICS])):
        row = numbers[first + h * core.PER_HARMONIC : first + (h + 1) * core.PER_HARMONIC]
        station = int(row[core.AT])
        argument = row[core.ANGLE] + row[core.FREQUENCY] * times + row[core.ORDER] * angle[:, station]
        found[:, station] += row[core.AMPLITUDE] * np.cos(argument)
    return found


def require_held(line: LineSystem, torques: Callable[[Array], Array], cuts: Array, of: str) -> None:
    """Refuse a motion along which a slip clutch would have to hold more than its capacity, between the first and the
    last of ``cuts`` [s]; ``torques`` are as of ``held_torques`` at times (time,), ``of`` names the motion.

    Raises
    ------
    InputError : names the clutch, its torque and its capacity.
    """
    places = [place for _, place in sticking_clutches(line.assembly.packed, line.assembly.topology)]
    if not places:
        return
    for place, most in zip(places, extremes(torques, cuts).largest, strict=True):
        name, clutch = line.assembly.line.names[place], line.assembly.line.elements[place]
        assert isinstance(clutch, SlipClutch)
        holds = clutch.torque * clutch.last_share
        if not most <= holds * (1 + ROUNDING):
            raise InputError(
                f"would have to hold {shown(float(most), TORQUE, digits=5)} in {of}, beyond its capacity of "
                f"{shown(holds, TORQUE, digits=5)}: it slips there, which is not followed", element=name, key="torque",
                remedy="raise its torque, or lower what shakes it; tn.simulate follows it as it slips",
            )  # fmt: skip
