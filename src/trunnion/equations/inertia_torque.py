"""The torque of every shaft that accelerates what is behind it, were the line rigid and its joints straight."""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array
from trunnion.equations.coefficients import Assembly
from trunnion.equations.loads import drive_torques, given_shares, static_torque


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
