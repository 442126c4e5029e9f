"""Whether a disturbance of a free–free line is one of its speed: the whole line turns further, ever faster or slower.

Such a one neither oscillates nor belongs to a natural frequency, so that no resonance names it.
"""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Complex
from trunnion.equations.aligned import on_rotations, rigid_rotation
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.topology import Topology
from trunnion.numerics.spectrum import real_positive

MOST = 0.5
"""Share of a disturbance's rotation, by inertia, above which the line turns as a whole."""
RUNS_AWAY = (
    "the critical multiplier is that of the line's own speed, not of a mode: loads and drives do not hold it, and "
    "disturbed the whole line runs ever faster or slower"
)


def is_of_speed(topo: Topology, coefficients: LineCoefficients, multiplier: complex, rotation: Complex) -> bool:
    """Whether the ``multiplier`` of a disturbance with this ``rotation`` (n,) is that of the line's speed."""
    if not topo.free or not real_positive(np.array([multiplier]))[0]:
        return False
    turn, mass = rigid_rotation(topo), on_rotations(topo, coefficients.inertia)[0]
    along = abs(turn @ mass @ rotation) ** 2
    whole = (turn @ mass @ turn) * (rotation.conj() @ mass @ rotation).real
    return bool(along > MOST * whole)
