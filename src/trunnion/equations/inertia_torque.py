"""The torque of every shaft that accelerates what is behind it, were the line rigid and its joints straight."""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.elements import Rotor
from trunnion.equations.coefficients import Assembly
from trunnion.equations.loads import drive_torques, given_shares, static_torque

BY_LOAD = ("share", "torques")
"""How an excitation is stated that follows the mean torque on its disk."""


def inertia_torque(assembly: Assembly) -> Array:
    """Torque of every compliance (shaft,) [N m] per acceleration of the input [rad/s²], in the sense of its twist."""
    topo = assembly.topology
    coefficients = assembly.coefficients(assembly.table(1), statically_twisted=False, free_play=True)
    ratios = np.abs(topo.mean_speeds)
    needed = coefficients.inertia * ratios
    if topo.free:
        share = given_shares(topo, assembly.packed.column, assembly.table(1))
        needed = needed + drive_torques(topo, share, needed @ ratios)
    return np.asarray(static_torque(topo, needed)[0])


def accelerating(assembly: Assembly, table: Array, acceleration: float) -> Array:
    """Packed numbers (case, column) of lines whose disks, at a steady speed, resist by what accelerates them too.

    In a run this torque twists the shafts, passes angled joints unevenly and shakes what is in front of them, as a load
    does (d'Alembert). ``table`` as it is where that cannot be said by loads: of a free line without a drive, behind a
    torque converter, and where an excitation follows the mean torque of its disk.

    acceleration : of the input [rad/s²], negative in a run-down.
    """
    topo, column = assembly.topology, assembly.packed.column
    if not acceleration or not_accelerated(assembly, table):
        return table
    _, first, of_row = np.unique(table[:, 1:], axis=0, return_index=True, return_inverse=True)
    inertia = assembly.coefficients(table[first], statically_twisted=False, free_play=True).inertia
    torque = (inertia * np.abs(topo.mean_speeds) * acceleration)[of_row.ravel()]
    found, done = table.copy(), set[int]()
    for station, place in topo.disks:
        at = column(place, "load_torque")
        if at >= 0 and station not in done:
            done.add(station)
            found[:, at] += torque[:, station]
    return found


def not_accelerated(assembly: Assembly, table: Array) -> str:
    """Why ``accelerating`` leaves a line as it is, as a clause; empty where it does not."""
    topo = assembly.topology
    if assembly.stated is not None:
        return "a torque converter would run at another slip"
    if any(_by_load(rotor) for _, rotor in topo.rotors):
        return "an excitation follows the load of its disk"
    if topo.free and not given_shares(topo, assembly.packed.column, table).any():
        return "no disk of the line has a drive_share"
    return ""


def _by_load(rotor: Rotor) -> bool:
    return any(getattr(one, key) not in (None, ()) for one in getattr(rotor, "excitation", ()) for key in BY_LOAD)
