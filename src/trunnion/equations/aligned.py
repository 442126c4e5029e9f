"""The aligned line: all joint angles zero, so that every joint passes motion unchanged.

Its natural frequencies name the resonances of the jointed line. Ratios keep their constant speed ratio.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from trunnion.equations.coefficients import Assembly, LineCoefficients
from trunnion.equations.topology import Topology
from trunnion.errors import InputError

Array = NDArray[np.float64]


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
    mass = np.zeros((cases, n))
    for s in range(len(topo.stations)):
        c = topo.coordinate[topo.group_of(s)]
        if c >= 0:
            mass[:, c] += coefficients.inertia[:, s] * relative_ratio(topo, s) ** 2
    directions = np.array([elongation(topo, e) for e in range(len(topo.compliances))]).reshape(-1, n)
    outer = (directions[:, :, None] * directions[:, None, :]).reshape(-1, n * n)
    damping, stiffness, loss = (
        (part @ outer).reshape(cases, n, n) if part.any() else np.zeros((cases, n, n))
        for part in (coefficients.damping, coefficients.stiffness, coefficients.loss)
    )
    return AlignedMatrices(mass, damping, stiffness, loss)


def elongation(topo: Topology, compliance: int) -> Array:
    """Twist of one compliance per rotation of every unknown (n,)."""
    ends, direction = topo.compliances[compliance], np.zeros(topo.size)
    far, near = topo.coordinate[ends.far_group], topo.coordinate[topo.group_of(ends.near)]
    if far >= 0:
        direction[far] = 1.0
    if near >= 0:
        direction[near] = -relative_ratio(topo, ends.near)
    return direction


def relative_ratio(topo: Topology, station: int) -> float:
    """Mean speed of a station over that of its group's first station."""
    return float(topo.speed_ratio[station] / topo.speed_ratio[topo.reference[topo.group_of(station)]])


def rigid_rotation(topo: Topology) -> Array:
    """The unknowns (n,) of an aligned line that turns as a whole, by one at its input."""
    return np.array([float(topo.speed_ratio[s]) for s in topo.firsts])


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
