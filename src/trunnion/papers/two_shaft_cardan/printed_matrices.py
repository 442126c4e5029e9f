"""S1's equations of motion as printed, step by step mended, and as they should read.

S1 (Soltan Rezaee and Ghazavi 2014), equation 15: θ″ + E θ′ + P θ = …, ′ = d/dτ, twists θ of the two shafts,
η = cos β/(1 − sin²β sin²τ), groups α, μ, γ over shaft 1 and disk 1, ζ = c₁/(2√(k₁J₁)). The versions differ
in two entries only:

    version    E₂₁              P₂₁
    printed    η′ − 2ζη/Ω       η/Ω²
    sign       η′ − 2ζη/Ω       −η/Ω²         sign mended
    single     η′ − 2ζη/Ω       η″ − η/Ω²     η″ added, η′ still single
    derived    2η′ − 2ζη/Ω      η″ − η/Ω²

They are kept as evidence for the errata; analyses use ``equations``.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from trunnion.arrays import Array
from trunnion.systems.periodic_linear import PeriodicLinearSystem, from_matrices

VERSIONS = {
    "printed": "as printed",
    "sign": "sign of P₂₁ mended",
    "single": "η″ added, η′ still single",
    "derived": "derived: 2η′, η″ − η/Ω²",
}


def printed_system(
    version: str,
    speed: float,
    angle: float,
    *,
    damping_ratio: float = 0.001,
    damping_of_shaft_2: float = 1.0,
    stiffness_of_shaft_2: float = 1.0,
    inertia_of_disk_2: float = 1.0,
) -> PeriodicLinearSystem:
    """One version of S1's equations (keys of ``VERSIONS``) at speed Ω [1] and joint angle β [rad]."""
    if version not in VERSIONS:
        raise KeyError(version)
    groups = (damping_ratio, damping_of_shaft_2, stiffness_of_shaft_2, inertia_of_disk_2)

    def e(tau: Array) -> Array:
        return matrices(version, tau, speed, angle, *groups)[0]

    def p(tau: Array) -> Array:
        return matrices(version, tau, speed, angle, *groups)[1]

    return from_matrices(np.eye(2), e, p, period=np.pi, names=("twist of shaft 1", "twist of shaft 2"))


def matrices(
    version: str, tau: Array, speed: float | Array, angle: float | Array, zeta: float, alpha: float, mu: float,
    gamma: float,
) -> tuple[Array, Array]:  # fmt: skip
    """E and P over τ (or arrays that broadcast), their two matrix axes last."""
    loss, square = 2 * zeta / speed, np.asarray(speed) ** 2
    eta, eta1, eta2 = joint_ratio(tau, angle)
    slopes = 2 if version == "derived" else 1
    coupling = {"printed": eta / square, "sign": -eta / square}.get(version, eta2 - eta / square)
    e = stacked(
        [loss, -alpha * loss * eta],
        [slopes * eta1 - loss * eta, alpha * loss * (eta**2 + 1 / gamma)],
    )
    p = stacked(
        [1 / square, -mu * eta / square],
        [coupling, mu / square * (eta**2 + 1 / gamma)],
    )
    return e, p


def joint_ratio(tau: Array, beta: float | Array) -> tuple[Array, Array, Array]:
    """η, η′, η″ with the fork square to the joint plane at τ = 0."""
    s2 = np.sin(beta) ** 2
    d = 1 - s2 * np.sin(tau) ** 2
    slope = np.cos(beta) * s2 * np.sin(2 * tau) / d**2
    curve = np.cos(beta) * s2 * (2 * np.cos(2 * tau) / d**2 + 2 * s2 * np.sin(2 * tau) ** 2 / d**3)
    return np.cos(beta) / d, slope, curve


def stacked(*rows: Sequence[float | Array]) -> Array:
    """Matrices (…, n, n) from the entries of their rows, which broadcast."""
    shape = np.broadcast_shapes(*(np.shape(entry) for row in rows for entry in row))
    return np.stack([np.stack([np.broadcast_to(entry, shape) for entry in row], -1) for row in rows], -2)
