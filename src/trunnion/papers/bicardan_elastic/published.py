"""S2: a bicardan transmission with an elastic intermediate shaft (Săulescu, Bercan, Hudan 2007).

The printed stiffness c₁₂ = 9526895997 N m/rad is in N mm/rad: the paper's own tube formula with G = 81000
N/mm² and lengths in mm gives that unit. 150 N m then twist the shaft by 1.574e-5 rad, a thousand times the
printed value's 1.574e-8. The printed phases ν₁₂ = 180° and β₁₂ = 266.4° are 86.4° away from homokinetic: by
the paper's own relations (2) to (5) the output runs from 0.7801 to 1.2819 of the input speed, nearly the
worst assembly there is. ``homokinetic=True`` sets β₁₂ = ν₁₂ instead.
"""

from __future__ import annotations

from math import pi

from trunnion.driveline.cardan_angles import cardan_line
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.quantities import DEGREE

PRINTED_STIFFNESS = 9526895997.0
"""c₁₂ as printed, in N m/rad."""
NEWTON_MILLIMETRE = 1e-3


def bicardan_elastic(
    *,
    angle_1: float = 27.99 * DEGREE,
    angle_2: float = 27.99 * DEGREE,
    fork_angle: float = pi,
    plane_angle: float = 266.4 * DEGREE,
    homokinetic: bool = False,
    printed_stiffness: bool = False,
    load_torque: float = 150.0,
) -> Driveline:
    """The paper's transmission.

    Parameters
    ----------
    angle_1, angle_2 : bend angles α₁, α₂ [rad].
    fork_angle, plane_angle : ν₁₂ and β₁₂ [rad], in the paper's sense.
    homokinetic : take β₁₂ = ν₁₂, the phases that make equal angles cancel.
    printed_stiffness : c₁₂ in the unit as printed (N m/rad) instead of N mm/rad.
    load_torque : M₂ at the output [N m].
    """
    stiffness = PRINTED_STIFFNESS * (1.0 if printed_stiffness else NEWTON_MILLIMETRE)
    return cardan_line(
        [angle_1, angle_2],
        [fork_angle],
        [fork_angle if homokinetic else plane_angle],
        stiffness=stiffness,
        load_torque=load_torque,
        name="bicardan transmission with an elastic intermediate shaft",
    )
