"""What is computed of S4: exponents over its frequency ranges and dampings, verdicts, and where resonance opens."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from trunnion.arrays import Array
from trunnion.motion.chaos.certify_chaos import ChaosCertificate, certify_chaos
from trunnion.motion.chaos.lyapunov_map import LyapunovSweep, lyapunov_sweep
from trunnion.motion.chaos.lyapunov_spectrum import lyapunov_spectrum
from trunnion.numerics.integration.integration import integrate
from trunnion.papers.double_tripod.contraction import Contraction, contraction
from trunnion.papers.double_tripod.published import DoubleTripod
from trunnion.systems.system import System

RANGES = {"input": (2950.0, 3200.0), "output": (2650.0, 2950.0)}
"""Frequencies η/2π [Hz] over which S4 draws its exponents."""
DAMPINGS = {
    "input": ((0.0016, "chaos"), (0.0073, "chaos"), (0.011, "chaos"), (0.0114, "no chaos"), (0.0186, "no chaos")),
    "output": ((0.0016, "chaos"), (0.0064, "chaos"), (0.0104, "chaos"), (0.0112, "no chaos"), (0.016, "no chaos")),
}
"""Damping ratios of S4's figures 17–24 and conclusions, and what it finds there."""
BELOW = 1e-4
"""A damping ratio that S4 does not have, below the threshold of the resonance."""
NEAR = 2e-3
"""Half of the range about 2Ω, over 2Ω, that is looked at more closely."""
PERIODS = {"input": (250, 150), "output": (4000, 2000)}
"""Samples averaged over and left out: periods of the motor's torque, or turns of the phase."""


ORDERS_OF_MOTOR = (6, 12, 24, 48, 96)
"""n of Ω_AEM = 100nπ: all that S4 names."""
CERTIFIED = {"input": (0.0016, 0.0114), "output": (0.0016, 0.0112)}
"""Damping ratios at which the motion itself is judged: the smallest, and S4's first without chaos."""


@dataclass(frozen=True)
class ElementCase:
    """One element at one damping ratio: exponents over the range, the bound of every motion, and, at the damping ratios
    ``CERTIFIED``, verdicts at 2Ω of both sets of equations, "given" and "own"."""

    element: str
    damping_ratio: float
    claimed: str
    sweep: LyapunovSweep
    bound: Contraction
    verdicts: Mapping[str, ChaosCertificate]

    @property
    def largest(self) -> float:
        """Largest exponent over the range besides that of the phase, which is 0 [1/s]."""
        return float(np.max(self.sweep.exponents[:, 1]))

    @property
    def positive(self) -> int:
        """Frequencies of the range with a positive exponent."""
        return int(np.sum(self.sweep.positive & (self.sweep.exponents[:, 0] > 1e-3)))


def sweep_of(shaft: DoubleTripod, element: str, points: int, effort: int = 1, *, loaded: bool = True) -> LyapunovSweep:
    """Exponents of (29) or (30) over S4's range of frequencies, η the parameter ``excitation`` [rad/s].

    Half of the points are even over the range, the others close to 2Ω, where exponents split within 0.1 %.
    ``effort`` lengthens the runs, which weak damping needs; without load φ = 0 is the motion, however it is excited.
    """
    low, high = (2 * np.pi * f for f in RANGES[element])
    periods, transient = (effort * count for count in PERIODS[element])
    system = shaft.system(element)
    system = system if loaded else system.but(torque_over_inertia=0.0)
    near = system.parameters["excitation"] * (1 + NEAR * np.linspace(-1, 1, points // 2 | 1) ** 3)
    values = np.unique(np.concatenate([np.linspace(low, high, max(points // 2, 2)), near]))
    turn = None if element == "input" else float(4 * np.pi / (low + high))
    return lyapunov_sweep(
        system, "excitation", values, periods=periods, transient=transient, interval=turn, tolerance=1e-9
    )


def cases(points: int, report_progress: Callable[[float], None]) -> list[ElementCase]:
    """Every damping ratio of S4 for both elements, printed χ_n and consistent Ī."""
    found: list[ElementCase] = []
    wanted = [(e, z, c) for e, rows in DAMPINGS.items() for z, c in rows]
    for element, ratio, claimed in wanted:
        shaft = DoubleTripod(damping_ratio=ratio)
        bound = contraction(shaft.system(element), own=False)
        verdicts = {
            phase: certified(shaft, element, phase) for phase in ("given", "own") if ratio in CERTIFIED[element]
        }
        found.append(ElementCase(element, ratio, claimed, sweep_of(shaft, element, points), bound, verdicts))
        report_progress(len(found) / len(wanted))
    return found


def certified(shaft: DoubleTripod, element: str, phase: str) -> ChaosCertificate:
    """The verdict on one motion at η = 2Ω."""
    periods, transient = PERIODS[element]
    length: dict[str, Any] = {"periods": 2 * periods} if element == "input" else {"duration": 1.5}
    system = shaft.system(element, phase=phase)
    return certify_chaos(system, **length, starts=1, transient=transient, sweep=False, tolerance=1e-10)


def exponent_from(element: str, phase: str, order: int, start: float) -> float:
    """Largest exponent besides the phase's [1/s] at ζ = 0.0016, η = 2Ω, motor order n, from a rotation [rad].

    Over 1.5 s after 0.1 s, without waiting for the start to die out: from 1 rad it is 10⁴ times the settled rotation.
    """
    system = DoubleTripod(motor_order=order).system(element, phase=phase)
    x = np.zeros(system.size)
    x[0] = start
    period = system.forcing_period or 2 * np.pi / DoubleTripod().system(element).parameters["excitation"]
    options: dict[str, Any] = {"starts": 1, "start": x, "duration": 1.5, "transient": round(0.1 / period)}
    exponents = lyapunov_spectrum(system, **options).exponents
    return float(exponents[1 if phase == "given" else 0])


def exponents_at_resonance(shaft: DoubleTripod, element: str) -> Array:
    """Exponents [1/s] of (29) or (30) at η = 2Ω, the largest first."""
    samples = 2000 if element == "input" else 20_000  # 7 s before and after: exponents 0.7 1/s apart have sorted
    system = shaft.system(element)
    length = samples * (system.forcing_period or 2 * np.pi / system.parameters["excitation"])
    return lyapunov_spectrum(system, duration=length, starts=1, transient=samples).exponents


def floquet_exponents(system: System) -> Array:
    """Exponents [1/s] of the rotation without load from the multipliers over one turn of the phase.

    Without load φ = 0 is a motion of (29), (30), and the linear part about it is Hill's equation; an independent
    check of the exponents, which the load changes by less than 1e-4 of their size.
    """
    bare = system.but(torque_over_inertia=0.0)
    turn = 2 * np.pi / bare.parameters["excitation"]
    block = np.vstack([np.zeros(3), np.eye(3)])
    image = integrate(bare.equations, 0.0, turn, block, tolerance=1e-12, dense=False).final[1:].T
    multipliers = np.linalg.eigvals(image[np.ix_([0, 2], [0, 2])])
    return np.sort(np.log(np.abs(multipliers)) / turn)[::-1]


def opening_depth(element: str, damping_ratio: float = 0.0016) -> tuple[float, float]:
    """The smallest χ_n, and the depth ε that belongs to it, at which the principal resonance is unstable at ζ.

    To first order ε = 4ζ; here from the multipliers, at the worst frequency near 2Ω.
    """
    from scipy.optimize import brentq

    def growth(chi: float) -> float:
        system = DoubleTripod(damping_ratio=damping_ratio, nonuniformity=chi).system(element)
        at = system.parameters["excitation"] * np.linspace(0.999, 1.001, 21)
        return max(float(floquet_exponents(system.but(excitation=float(eta)))[0]) for eta in at)

    chi = float(brentq(growth, 1e-3, 0.2, xtol=1e-7))
    return chi, DoubleTripod(nonuniformity=chi).depth(element)
