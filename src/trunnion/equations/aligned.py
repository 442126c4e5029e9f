"""The aligned line: all joint angles zero, so that every joint passes motion unchanged.

Its natural frequencies name the resonances of the jointed line. Ratios keep their constant speed ratio.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from trunnion.arrays import Array
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.loads import load_slope
from trunnion.equations.topology import Topology


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
    elongations = topo.elongations
    damping, stiffness, loss = (
        (elongations.T * part[:, None, :]) @ elongations if part.any() else np.zeros((cases, n, n))
        for part in (coefficients.damping, coefficients.stiffness, coefficients.loss)
    )
    return AlignedMatrices(topo.on_unknowns(coefficients.inertia), damping, stiffness, loss)


def loaded_matrices(topo: Topology, coefficients: LineCoefficients, speeds: Array) -> AlignedMatrices:
    """The same with the slopes of loads by speed, each at its station's own speed; input ``speeds`` (case,) [rad/s].

    At the speed 0 viscous loads brake and quadratic ones do not.
    """
    straight = aligned_matrices(topo, coefficients)
    slope = load_slope(topo, coefficients.viscous, coefficients.quadratic, np.asarray(speeds))
    return replace(straight, damping=straight.damping + topo.on_unknowns(slope)[:, :, None] * np.eye(topo.size))


def rigid_rotation(topo: Topology) -> Array:
    """The unknowns (n,) of an aligned line that turns as a whole, by one at its input."""
    return np.asarray(topo.mean_speeds[topo.firsts])


def at_rest(topo: Topology, stiffness: Array) -> Array:
    """The stiffness (…, n, n) of a line that stands still: what oil alone drags along neither moves nor is moved by it,
    and counts as joined to it."""
    joined = topo.elongations[list(topo.dragged)]
    return np.asarray(stiffness + np.abs(stiffness).max(axis=(-2, -1), keepdims=True) * (joined.T @ joined))


def frequencies(matrices: AlignedMatrices, *, still: int) -> Array:
    """Undamped natural frequencies [rad/s], ascending, shape (case, n), of which the first ``still`` are exactly 0: as
    many as the line has ``loose`` rotations."""
    root = np.sqrt(matrices.mass)
    scaled = matrices.stiffness / (root[:, :, None] * root[:, None, :])
    squares = np.linalg.eigvalsh(scaled)
    squares[:, :still] = 0.0
    return np.sqrt(np.maximum(squares, 0.0))
