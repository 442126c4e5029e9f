"""Why S4's equations cannot be chaotic: every two motions approach each other, at a rate bounded in closed form.

With w = (φ̇ + ζΩφ)/Ω the equations (25), (26), (29), (30), φ̈ + 2ζΩ√g φ̇ + Ω²gφ = F, read

    φ̇ = −ζΩ φ + Ω w,    ẇ = Ω[ζ²(2√g − 1) − g] φ − ζΩ(2√g − 1) w + F/Ω.

Two neighbouring motions part by δ = (δφ, δw), and d|δ|²/dt = 2 δᵀSδ with the symmetric part S of the Jacobian, so

    |δ(t)| ≤ |δ(0)| e^{−λt},   −λ = −ζΩ(1 − 2ρ) + ½Ω[γ + ζ²(1 + 2ρ) + κ],

where γ = sup|g − 1|, ρ = sup|√g − 1| and κ bounds whatever else depends on φ, over Ω²: the torque, and in (25), (26) g
itself. A bound of one instant needs no period, no start and no length of run: it holds for any phase Θ(t), any motor
speed and any additional torque that depends on time alone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.papers.double_tripod.published import DoubleTripod
from trunnion.papers.shared.result import Argument
from trunnion.systems.system import System

NAMES = {"input": ("DIE1", "(29)", "(25)"), "output": ("DOE3", "(30)", "(26)")}


@dataclass(frozen=True)
class Contraction:
    """Bounds for one element and one set of equations.

    gamma, rho : sup|g − 1| and sup|√g − 1| [1].
    torque : sup of the torque's slope by φ over Ω² [1].
    coefficients : the same of g, within ``ball``; 0 where the phase is given.
    rate : λ [1/s]; positive where every two motions approach each other.
    ball : size [rad] of (φ, w) below which every motion ends.
    """

    gamma: float
    rho: float
    torque: float
    coefficients: float
    rate: float
    ball: float


def contraction(system: System, *, own: bool) -> Contraction:
    """The bounds for a system of ``DoubleTripod.system``; ``own`` for the phase "own"."""
    p = system.parameters
    zeta, omega = p["damping_ratio"], p["natural_frequency"]
    c1, c2, chi = (p[f"{which}_nonuniformity"] for which in ("stiffness", "series", "inertia"))
    ends = [(1 + c1 * c) / ((1 + c2 * c) * (1 + chi * c)) for c in (-1.0, 1.0)]
    slope = max(ends) * (c1 / (1 - c1) - c2 / (1 + c2) - chi / (1 + chi))  # of g by the cosine, from above
    falls = c1 / (1 + c1) - c2 / (1 - c2) - chi / (1 - chi)  # from below: positive, so the ends are the extremes
    spread = slope if falls <= 0 else 0.0
    gamma = max(abs(g - 1) for g in ends) + spread
    rho = max(abs(np.sqrt(g) - 1) for g in ends) + spread
    force, by_phi = _torque(system)

    def rate(kappa: float) -> float:
        return float(zeta * omega * (1 - 2 * rho) - omega / 2 * (gamma + zeta**2 * (1 + 2 * rho) + kappa))

    ball = force / (omega * rate(0.0)) if rate(0.0) > 0 else np.inf
    extra = 2 * slope * ball * (1 + zeta * (1 + zeta) / np.sqrt(min(ends))) if own else 0.0
    return Contraction(gamma, rho, by_phi, float(extra), rate(by_phi + extra), float(ball))


def _torque(system: System) -> tuple[float, float]:
    """Sup of |F| [rad/s²], and of |∂F/∂φ| over Ω² [1]."""
    p = system.parameters
    m, swing, a, chi = (
        abs(p["torque_over_inertia"]), p["torque_nonuniformity"], p["joint_amplitude"], p["inertia_nonuniformity"],
    )  # fmt: skip
    terms = 1 - 2.0 ** -(7 if p["mill"] else 6)  # Σ 2⁻ʲ over the harmonics
    size, slope = 1 + swing * terms, (7 / 2) * swing if p["mill"] else 0.0  # each mill term has the slope ½
    joint, below = 1 + 3 * a, 1 - chi
    force = m * size * joint / below
    by_phi = m * (slope * joint / below + size * (9 * a / below + 2 * chi * joint / below**2))
    return force, by_phi / p["natural_frequency"] ** 2


def smallest_damping(element: str) -> float:
    """The damping ratio from which on the bound is positive, equations with the phase given."""
    from scipy.optimize import brentq

    def rate(ratio: float) -> float:
        return contraction(DoubleTripod(damping_ratio=ratio).system(element), own=False).rate

    return float(brentq(rate, 1e-5, 1.6e-3))


def argument() -> Argument:
    """The proof in words and numbers, at the paper's smallest damping."""
    shaft = DoubleTripod()
    given, own = (
        [contraction(shaft.system(e, phase=phase), own=phase == "own") for e in NAMES] for phase in ("given", "own")
    )

    def both(words: list[str]) -> str:
        return " and ".join(words)

    rates = "; ".join(
        f"{name} {a.rate:.2f} 1/s for {by_phase}, {b.rate:.2f} 1/s for {by_rotation}"
        for (name, by_phase, by_rotation), a, b in zip(NAMES.values(), given, own, strict=True)
    )
    return Argument(
        "Why there can be no chaos: a bound for every motion",
        (
            "Write w = (φ̇ + ζΩφ)/Ω. Two neighbouring motions part by δ = (δφ, δw), and d|δ|²/dt = 2 δᵀSδ, where S is "
            "the symmetric part of the Jacobian. Its diagonal is −ζΩ and −ζΩ(2√g − 1), its other entry "
            "½Ω[1 − g + ζ²(2√g − 1) + κ(φ, t)], κ being the slope of the torque by φ over Ω².",
            "So |δ(t)| ≤ |δ(0)| e^{−λt} with λ = ζΩ(1 − 2 sup|√g − 1|) − ½Ω[sup|g − 1| + ζ²(1 + 2 sup|√g − 1|) + "
            "sup|κ|].",
            "g is monotone in its cosine, so its extremes are at ±1: sup|g − 1| = "
            f"{both([f'{b.gamma:.3g}' for b in given])} (DIE1 and DOE3) with the printed χ_n. The torque's slope, from "
            "the joint's 3A sin 3φ, from χ_n and of the mill from its own harmonics, gives sup|κ| = "
            f"{both([f'{b.torque:.1e}' for b in given])}: the equations are linear but for that.",
            "In (25) and (26) g turns with φ itself. Every motion, whatever its start, ends with √(φ² + w²) below "
            f"sup|F|/(Ωλ) = {both([f'{b.ball:.3f} rad' for b in own])}; there the slope of g adds "
            f"{both([f'{b.coefficients:.1e}' for b in own])} to κ.",
            f"At ζ = {shaft.damping_ratio:g}, the smallest of the paper, λ = {rates}. Every two motions approach each "
            "other at least so fast: there is one motion that attracts all others, and no exponent but that of the "
            "phase is above −λ. More damping makes λ larger.",
            "Nothing was asked of the phase Θ(t), of the motor's speed or order, or of the start: the bound holds for "
            "all of them; for (29) and (30) also with further torques in time, such as the midshaft's, up to "
            f"{both([f'{torque_that_breaks_it(e):.2g}' for e in NAMES])} times the mean torque. It is positive down to "
            f"ζ = {both([f'{smallest_damping(e):.2g}' for e in NAMES])}.",
        ),
    )


def torque_that_breaks_it(element: str) -> float:
    """How many times the mean torque a torque in time would have to be before the bound fails, ζ = 0.0016.

    Such a torque enters κ only through 1/(1 + χ_n cos 2φ), whose slope is below 2χ_n/(1 − χ_n)².
    """
    shaft = DoubleTripod()
    system = shaft.system(element)
    bound = contraction(system, own=False)
    p = system.parameters
    omega = p["natural_frequency"]
    room = 2 * bound.rate / omega  # κ may grow by so much
    per_unit = 2 * p["inertia_nonuniformity"] / (1 - p["inertia_nonuniformity"]) ** 2
    return room / per_unit * omega**2 / abs(p["torque_over_inertia"])
