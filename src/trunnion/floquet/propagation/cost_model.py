"""What the ways to the multipliers of a long line cost, in seconds of one core: which of them ``tree_modes`` takes, and
which lines are refused.

Measured on one machine (``benchmarks/long_lines.py`` shows both); a choice of the dearer way costs time, never
accuracy.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from trunnion.equations.aligned import UnitMasses
from trunnion.equations.coefficients import Assembly
from trunnion.numerics.memory import require_estimate
from trunnion.steady.orders.cost_model import places_left

SHORT = 150
"""Unknowns up to which no line is refused."""
FEW_HARMONICS = 17
EIGENVALUES = 1e-9
"""Seconds of inverting what ``size`` modes make up, over size³."""


def by_modes(size: int, harmonics: int, left: int) -> float:
    """All modes of ``size`` unknowns by Hill's blocks of so many harmonics, ``left`` places eliminated as matrices."""
    return 0.005 + 5e-7 * size**2 * harmonics + 1.6e-8 * size * left * harmonics**3


def by_modes_of(assembly: Assembly, size: int, phase: float) -> float:
    """All modes of a line about its rigid shafts, in as many harmonics as joints of some 15° take."""
    return 2 * by_modes(size, FEW_HARMONICS, places_left(assembly.topology)) + EIGENVALUES * size**3


def in_time(size: int, steps: int) -> float:
    """All states carried over a period in ``steps``, and the eigenvalues of what becomes of them."""
    return 0.02 + steps * (1.4e-3 + 5.5e-7 * size**2) + 1.4e-8 * size**3


def by_shooting(size: int, phase: float) -> float:
    """The periodic motion of a free–free line by shooting, and its multipliers."""
    return 3.5e-6 * size**2 * phase


def require_time(assembly: Assembly, speed: float, cost: Callable[[int, float], float], what: str) -> None:
    """Refuse what would not end, or fill the memory, at an input ``speed`` [rad/s].

    ``cost`` : of the unknowns and of the radians by which the fastest mode turns in a turn of the input, in seconds.

    Raises
    ------
    InputError : says how long it would take, and how much memory.
    """
    size, memory = assembly.topology.size, 20 * 8.0 * (2 * assembly.topology.size) ** 2
    if size <= SHORT:
        return
    stiffness = UnitMasses(assembly.aligned.inertia[0]).of_matrix(assembly.aligned.stiffness[0])
    # No mode is faster than the largest sum of a row.
    seconds = cost(size, 2 * np.pi * float(np.sqrt(np.abs(stiffness).sum(axis=1).max())) / speed)
    require_estimate(size, what, seconds, memory, remedy="join neighbouring parts")
