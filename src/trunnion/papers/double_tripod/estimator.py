"""S4's own estimator, equations (31)–(36), kept as a historical curve: it is not a Lyapunov exponent.

At every T_i the perturbed motion starts anew at x(1 + 1e-5), so its distance from the other measures the state, not
the divergence of neighbours. With N intervals up to T_f and Δ the separation at the end of each, the text reads

    L_k = (1/T_f) Σ_{i=1}^{N} log₁₀ ( |Δ_k(T_i)| / ‖Δ(T_f)‖ ).

It mixes states of different units in the norm, uses the decimal logarithm, and depends on N: the sum grows with the
number of terms. Its sign is that of the mean of log₁₀|Δ_k(T_i)| against log₁₀‖Δ(T_f)‖, not of a growth: of the plain
decaying oscillator x″ + 2ζx′ + x = 0 it is positive, of (29) with its phase of growing size negative. The paper's
figures show other values, so this reading is not what its authors computed.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.numerics.integration.integration import integrate
from trunnion.systems.system import System

PERTURBATION = 1e-5


def printed_estimator(system: System, start: ArrayLike, interval: float, count: int, tolerance: float = 1e-10) -> Array:
    """L_k (n,) of (31)–(33) after ``count`` intervals [s] from ``start``; decimal logarithm, as printed."""
    x = np.asarray(start, dtype=float)
    apart = np.empty((count, system.size))
    time = 0.0
    for i in range(count):
        ends = [
            integrate(system.equations, time, time + interval, y, tolerance=tolerance, dense=False).final[0]
            for y in (x, x * (1 + PERTURBATION))
        ]
        time += interval
        apart[i], x = ends[1] - ends[0], ends[0]
    terms = np.log10(np.abs(apart) / np.linalg.norm(apart[-1]))
    return np.asarray(terms.sum(axis=0) / time)
