"""Equations of motion in twist coordinates, as two papers print them and as they should read.

S1: Soltan Rezaee and Ghazavi, Modares Mechanical Engineering 14 (12), 2014, equation 15 with its E and P.
S3: the three-shaft sequel in the same journal, equation 9 with its E and F. Both write
θ″ + E θ′ + P θ = forcing, ′ = d/dτ, η = cos β/(1 − sin²β sin²τ), groups α, μ, γ over shaft 1 and disk 1.
Each function takes τ (m,) and returns E and P of shape (m, n, n).

"derived" re-derives the same model; the other versions of S1 change only the entries the misprints touch:

    version   E₂₁              P₂₁
    printed   η′ − 2ζη/Ω       η/Ω²
    sign      η′ − 2ζη/Ω       −η/Ω²
    single    η′ − 2ζη/Ω       η″ − η/Ω²
    derived   2η′ − 2ζη/Ω      η″ − η/Ω²
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from trunnion.systems.periodic_linear import PeriodicLinearSystem, from_matrices

Array = NDArray[np.float64]
VERSIONS = ("printed", "sign", "single", "derived")


def joint(phi: Array, beta: float) -> tuple[Array, Array, Array]:
    """η, dη/dφ, d²η/dφ² with the fork square to the joint plane at φ = 0."""
    s2 = np.sin(beta) ** 2
    d = 1 - s2 * np.sin(phi) ** 2
    eta = np.cos(beta) / d
    slope = np.cos(beta) * s2 * np.sin(2 * phi) / d**2
    curve = np.cos(beta) * s2 * (2 * np.cos(2 * phi) / d**2 + 2 * s2 * np.sin(2 * phi) ** 2 / d**3)
    return eta, slope, curve


def two_shafts(
    tau: Array,
    speed: float,
    beta: float,
    zeta: float,
    gamma: float,
    *,
    alpha: float = 1.0,
    mu: float = 1.0,
    version: str = "derived",
) -> tuple[Array, Array]:
    """E and P of S1."""
    eta, eta1, eta2 = joint(tau, beta)
    e, p = np.zeros((2, len(tau), 2, 2))
    loss, square = 2 * zeta / speed, speed**2
    e[:, 0, 0], e[:, 0, 1] = loss, -alpha * loss * eta
    e[:, 1, 0] = (2 if version == "derived" else 1) * eta1 - loss * eta
    e[:, 1, 1] = alpha * loss * (eta**2 + 1 / gamma)
    p[:, 0, 0], p[:, 0, 1] = 1 / square, -mu * eta / square
    p[:, 1, 0] = {
        "printed": eta / square,
        "sign": -eta / square,
        "single": eta2 - eta / square,
        "derived": eta2 - eta / square,
    }[version]
    p[:, 1, 1] = mu / square * (eta**2 + 1 / gamma)
    return e, p


def three_shafts(
    tau: Array,
    speed: float,
    betas: tuple[float, float],
    zeta: float,
    gammas: tuple[float, float],
    *,
    alphas: tuple[float, float] = (1.0, 1.0),
    mus: tuple[float, float] = (1.0, 1.0),
    version: str = "derived",
) -> tuple[Array, Array]:
    """E and P of S3; the derived version has the second joint at ψ₁(τ), the printed one at τ."""
    eta, eta1, eta2 = joint(tau, betas[0])
    (a1, a2), (m1, m2), (g1, g2) = alphas, mus, gammas
    e, p = np.zeros((2, len(tau), 3, 3))
    loss, square = 2 * zeta / speed, speed**2
    e[:, :2, :2], p[:, :2, :2] = two_shafts(tau, speed, betas[0], zeta, g1, alpha=a1, mu=m1, version=version)
    if version == "derived":
        turned = tau - np.arctan(_t(betas[0]) * np.sin(2 * tau) / (1 + _t(betas[0]) * np.cos(2 * tau)))
        ratio, slope, curve = joint(turned, betas[1])
        second, second1, second2 = ratio, slope * eta, curve * eta**2 + slope * eta1
        e[:, 2, 0] = 2 * eta * second1
        e[:, 2, 1] = 2 * second1 - loss * a1 * second / g1
        p[:, 2, 0] = 2 * eta1 * second1 + eta * second2
        p[:, 2, 1] = second2 - m1 * second / (g1 * square)
    else:
        second, second1, second2 = joint(tau, betas[1])
        e[:, 2, 0] = eta1 * second1
        e[:, 2, 1] = second1 - loss * a1 * second / g1
        p[:, 2, 0] = eta1 * second2
        p[:, 2, 1] = m1 * second2 / (g1 * square)
    e[:, 1, 2] = -loss * a2 * second / g1
    p[:, 1, 2] = -m2 * second / (g1 * square)
    e[:, 2, 2] = loss * a2 * (second**2 / g1 + 1 / g2)
    p[:, 2, 2] = m2 / square * (second**2 / g1 + 1 / g2)
    return e, p


def system(function: object, *numbers: object, **options: object) -> PeriodicLinearSystem:
    """``two_shafts`` or ``three_shafts`` with these arguments as a system of period π."""

    def part(which: int) -> object:
        return lambda tau: function(np.asarray(tau), *numbers, **options)[which]  # type: ignore[operator]

    size = 2 if function is two_shafts else 3
    return from_matrices(np.eye(size), part(0), part(1), period=np.pi)  # type: ignore[arg-type]


def _t(beta: float) -> float:
    return float(np.tan(beta / 2) ** 2)
