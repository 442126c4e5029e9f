"""S3: three shafts joined by two Hooke's joints (Soltan Rezaee and co-authors).

Groups as in the two-shaft line, each over shaft 1 and disk 1. The paper's two joints run in phase, which is a
fork offset of 90° on shaft 2: the worst assembly. With ``fork_offset=0`` the forks of shaft 2 are in line,
as one would assemble them. The paper evaluates the second joint at τ; here it sees the angle behind the first.
"""

from __future__ import annotations

from math import pi, sqrt

from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import ConstantSpeed, Disk
from trunnion.driveline.joints import HookeJoint
from trunnion.driveline.shafts import Shaft


def three_shaft_cardan(
    *,
    angle_1: float = 0.2,
    angle_2: float = 0.2,
    damping_ratio: float = 0.001,
    damping_of_shaft_2: float = 1.0,
    damping_of_shaft_3: float = 1.0,
    stiffness_of_shaft_2: float = 1.0,
    stiffness_of_shaft_3: float = 1.0,
    inertia_of_disk_2: float = 1.0,
    inertia_of_disk_3: float = 10.0,
    fork_offset: float = pi / 2,
    stiffness: float = 1.0,
    inertia: float = 1.0,
) -> Driveline:
    """The paper's line; with ``stiffness`` = ``inertia`` = 1 its speeds are the paper's Ω.

    Parameters
    ----------
    angle_1, angle_2 : joint angles β₁, β₂ [rad].
    damping_ratio : ζ of shaft 1 against disk 1 alone [1].
    damping_of_shaft_2, … : each over shaft 1 or disk 1 (α, μ, γ of the paper).
    fork_offset : between the two forks of shaft 2 [rad]; 90° is the paper's in-phase pair of joints.
    stiffness, inertia : k₁ [N m/rad] and J₁ [kg m²].
    """
    damping = 2 * damping_ratio * sqrt(stiffness * inertia)
    return Driveline(
        [
            ConstantSpeed(),
            Shaft(stiffness=stiffness, damping=damping, fork_offset=pi / 2),
            Disk(inertia=inertia),
            HookeJoint(angle=angle_1),
            Shaft(
                stiffness=stiffness_of_shaft_2 * stiffness,
                damping=damping_of_shaft_2 * damping,
                fork_offset=fork_offset,
            ),
            Disk(inertia=inertia_of_disk_2 * inertia),
            HookeJoint(angle=angle_2),
            Shaft(stiffness=stiffness_of_shaft_3 * stiffness, damping=damping_of_shaft_3 * damping),
            Disk(inertia=inertia_of_disk_3 * inertia),
        ],
        name="three shafts and two Hooke's joints",
    )
