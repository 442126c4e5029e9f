"""Speeds at which machines' curves of torque over speed show all that they do within a range.

Between two of its knots a curve is one formula, whose slope takes no value at as many as ``BETWEEN`` speeds unless it
is constant (a cubic's at two, Kloss's at four): what its slope does in a range, however narrow, shows there.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from trunnion.arrays import Array
from trunnion.equations.coefficients import Assembly

BETWEEN = 8
"""Speeds looked at between two knots of a curve."""


def curve_knots(assembly: Assembly, low: float, high: float) -> Array:
    """Rising speeds of the input [rad/s] at knots of curves that stay where they are, from ``low`` to ``high``. Curves
    of motors that are set to carry the line move along the speed."""
    topo, knots = assembly.topology, set[float]()
    for (station, _), (_, rotor) in zip(topo.disks, topo.rotors, strict=True):
        turning = abs(float(topo.mean_speeds[station]))
        if rotor.tangent and turning and not getattr(rotor, "set", False):
            knots |= {knot / turning for knot in rotor.load.knots}
    return np.array(sorted(one for one in knots if low <= one <= high))


def curve_speeds(assembly: Assembly, low: float, high: float) -> Array:
    """Rising speeds of the input [rad/s], among them ``low`` and ``high``: the knots and ``BETWEEN`` between them."""
    ends = np.unique([low, high, *curve_knots(assembly, low, high)])
    if len(ends) < 2:
        return ends
    return np.unique([np.linspace(a, b, BETWEEN + 2) for a, b in pairwise(ends.tolist())])
