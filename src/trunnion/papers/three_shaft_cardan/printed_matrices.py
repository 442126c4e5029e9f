"""S3's equations of motion as printed, and as they should read, in twists of its three shafts.

S3 (Soltan Rezaee and co-authors), equation 9: θ″ + E θ′ + F θ = …, ′ = d/dτ. "printed" follows the paper;
"second at input" is derived but, as the paper does, takes the ratio of the second joint at τ; "derived"
takes it at ψ₁(τ), the angle behind the first joint. Joints in phase; α = μ = γ₁ = 1. Kept as evidence for the
errata; analyses use ``equations``.
"""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array
from trunnion.papers.two_shaft_cardan.printed_matrices import joint_ratio, stacked
from trunnion.systems.periodic_linear import PeriodicLinearSystem, from_matrices

VERSIONS = ("printed", "second at input", "derived")


def printed_three_shaft_system(
    version: str,
    speed: float,
    angles: tuple[float, float],
    *,
    damping_ratio: float = 0.001,
    inertia_of_disk_3: float = 10.0,
) -> PeriodicLinearSystem:
    """One version of S3's equations (``VERSIONS``) at speed Ω [1] and joint angles β₁, β₂ [rad]."""
    if version not in VERSIONS:
        raise KeyError(version)
    printed = version == "printed"
    loss, square, gamma = 2 * damping_ratio / speed, speed**2, inertia_of_disk_3

    def second(tau: Array, eta: Array, eta1: Array) -> tuple[Array, Array, Array]:
        """η₂ and its derivatives by τ."""
        if version != "derived":
            return joint_ratio(tau, angles[1])
        t = np.tan(angles[0] / 2) ** 2
        turned = tau - np.arctan(t * np.sin(2 * tau) / (1 + t * np.cos(2 * tau)))
        ratio, slope, curve = joint_ratio(turned, angles[1])
        return ratio, slope * eta, curve * eta**2 + slope * eta1

    def e(tau: Array) -> Array:
        eta, eta1, _ = joint_ratio(tau, angles[0])
        two, two1, _ = second(tau, eta, eta1)
        slopes = 1 if printed else 2
        return stacked(
            [loss, -loss * eta, 0],
            [slopes * eta1 - loss * eta, loss * (eta**2 + 1), -loss * two],
            [eta1 * two1 if printed else 2 * eta * two1, slopes * two1 - loss * two, loss * (two**2 + 1 / gamma)],
        )

    def f(tau: Array) -> Array:
        eta, eta1, eta2 = joint_ratio(tau, angles[0])
        two, two1, two2 = second(tau, eta, eta1)
        if printed:
            below = [eta / square, eta1 * two2, two2 / square]
        else:
            below = [eta2 - eta / square, 2 * eta1 * two1 + eta * two2, two2 - two / square]
        return stacked(
            [1 / square, -eta / square, 0],
            [below[0], (eta**2 + 1) / square, -two / square],
            [below[1], below[2], (two**2 + 1 / gamma) / square],
        )

    names = tuple(f"twist of shaft {i}" for i in (1, 2, 3))
    return from_matrices(np.eye(3), e, f, period=np.pi, names=names)
