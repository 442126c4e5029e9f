"""The aligned line: all joint angles zero, so that every joint passes motion unchanged.

Its natural frequencies name the resonances of the jointed line. Ratios keep their constant speed ratio.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.equations.coefficients import Assembly, LineCoefficients
from trunnion.equations.topology import Topology
from trunnion.errors import InputError


@dataclass(frozen=True)
class AlignedMatrices:
    """M (case, n) diagonal [kg m²], C and K (case, n, n) [N m s/rad, N m/rad] in absolute rotations.

    ``loss`` H (case, n, n) [N m/rad] damps at all frequencies alike: K + i sgn(ν) H at the frequency ν.
    """

    mass: Array
    damping: Array
    stiffness: Array
    loss: Array


def aligned_matrices(topo: Topology, coefficients: LineCoefficients) -> AlignedMatrices:
    """Mass, damping and stiffness of the aligned line, one per case."""
    cases, n = len(coefficients.inertia), topo.size
    mass = np.zeros((n, cases))
    moves = topo.unknown_of >= 0
    turned = coefficients.inertia * topo.relative_ratios**2
    np.add.at(mass, topo.unknown_of[moves], turned.T[moves])
    elongations = topo.elongations
    damping, stiffness, loss = (
        (elongations.T * part[:, None, :]) @ elongations if part.any() else np.zeros((cases, n, n))
        for part in (coefficients.damping, coefficients.stiffness, coefficients.loss)
    )
    return AlignedMatrices(np.ascontiguousarray(mass.T), damping, stiffness, loss)


def elongation(topo: Topology, compliance: int) -> Array:
    """Twist of one compliance per rotation of every unknown (n,)."""
    return np.asarray(topo.elongations[compliance])


def relative_ratio(topo: Topology, station: int) -> float:
    """Mean speed of a station over that of its group's first station."""
    return float(topo.relative_ratios[station])


def rigid_rotation(topo: Topology) -> Array:
    """The unknowns (n,) of an aligned line that turns as a whole, by one at its input."""
    return np.asarray(topo.mean_speeds[topo.firsts])


def frequencies(matrices: AlignedMatrices, *, free: bool) -> Array:
    """Undamped natural frequencies [rad/s], ascending, shape (case, n); a free line's rigid mode is exactly 0."""
    root = np.sqrt(matrices.mass)
    scaled = matrices.stiffness / (root[:, :, None] * root[:, None, :])
    squares = np.linalg.eigvalsh(scaled)
    if free:
        squares[:, 0] = 0.0
    return np.sqrt(np.maximum(squares, 0.0))


def lowest_elastic_frequency(assembly: Assembly) -> float:
    """Lowest non-zero natural frequency [rad/s] of the line as described, damping left out.

    Raises
    ------
    InputError : springs so unlike that it is lost in rounding.
    """
    topo = assembly.topology
    matrices = aligned_matrices(topo, assembly.coefficients(assembly.table(1), damped=False))
    found = frequencies(matrices, free=topo.free)[0]
    lowest = float(found[1 if topo.free else 0])
    # Eigenvalues, the squares, are right to their rounding beside the largest.
    if not lowest**2 > len(found) * np.finfo(float).eps * float(found[-1]) ** 2:
        raise InputError(
            f"holds at the lowest elastic mode, which is lost in rounding beside {found[-1]:.3g} rad/s",
            element="driveline", key="damping_ratio",
            remedy='write damping_ratio_frequency = "50 Hz", say, or check the stiffnesses',
        )  # fmt: skip
    return lowest
