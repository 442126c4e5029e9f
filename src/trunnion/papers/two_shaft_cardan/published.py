"""S1: two shafts joined by a Hooke's joint (Soltan Rezaee and Ghazavi 2014).

The paper's groups are ζ = c₁/(2√(k₁J₁)) (printed without the 2, but its equations need it), α = c₂/c₁,
μ = k₂/k₁, γ = J₂/J₁ and Ω = Ω₀/√(k₁/J₁). Its joint starts with the fork square to the joint plane.
"""

from __future__ import annotations

from math import pi, sqrt

from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import ConstantSpeed, Disk
from trunnion.driveline.joints import HookeJoint
from trunnion.driveline.parameters import Parameter, Term
from trunnion.driveline.shafts import Shaft


def two_shaft_cardan(
    *,
    angle: float = 0.3,
    damping_ratio: float = 0.001,
    damping_of_shaft_2: float = 1.0,
    stiffness_of_shaft_2: float = 1.0,
    inertia_of_disk_2: float = 1.0,
    fork_offset: float = pi / 2,
    stiffness: float = 1.0,
    inertia: float = 1.0,
) -> Driveline:
    """The paper's line; with ``stiffness`` = ``inertia`` = 1 its speeds are the paper's Ω.

    Parameters
    ----------
    angle : joint angle β [rad].
    damping_ratio : ζ of shaft 1 against disk 1 alone [1].
    damping_of_shaft_2, stiffness_of_shaft_2, inertia_of_disk_2 : over those of shaft 1 and disk 1 (α, μ, γ).
    fork_offset : 90° as in the paper [rad]; it only turns the time origin of a single joint.
    stiffness, inertia : k₁ [N m/rad] and J₁ [kg m²]; any other pair is the same line in other units, with
        speeds multiplied by √(k₁/J₁).
    """
    damping = 2 * damping_ratio * sqrt(stiffness * inertia)
    return Driveline(
        [
            ConstantSpeed(),
            Shaft(stiffness=stiffness, damping=damping, fork_offset=fork_offset),
            Disk(inertia=inertia),
            HookeJoint(angle=angle),
            Shaft(stiffness=stiffness_of_shaft_2 * stiffness, damping=damping_of_shaft_2 * damping),
            Disk(inertia=inertia_of_disk_2 * inertia),
        ],
        name="two shafts and a Hooke's joint",
    )


DAMPING_OF_SHAFT_2 = "damping of shaft 2 over shaft 1"
STIFFNESS_OF_SHAFT_2 = "stiffness of shaft 2 over shaft 1"
INERTIA_OF_DISK_2 = "inertia of disk 2 over disk 1"
DAMPING_RATIO = "damping ratio"


def group_parameters(line: Driveline) -> dict[str, Parameter]:
    """The paper's groups as parameters to vary: their labels, and what a value of each puts into ``line``."""
    one, two = (e for e in line.elements if isinstance(e, Shaft))
    disk = next(e for e in line.elements if isinstance(e, Disk))
    k, c, j = float(one.stiffness or 0), one.damping, float(disk.inertia or 0)
    ratio = two.damping / c if c else 1.0
    critical = 2 * sqrt(k * j)
    ratios = {
        DAMPING_OF_SHAFT_2: (Term("Shaft 2.damping", c),),
        STIFFNESS_OF_SHAFT_2: (Term("Shaft 2.stiffness", k),),
        INERTIA_OF_DISK_2: (Term("Disk 2.inertia", j),),
        DAMPING_RATIO: (Term("Shaft 1.damping", critical), Term("Shaft 2.damping", ratio * critical)),
    }
    return {label: Parameter(label, "1", terms) for label, terms in ratios.items()}
