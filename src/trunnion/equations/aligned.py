"""The aligned line: all joint angles zero, so that every joint passes motion unchanged.

Its natural frequencies name the resonances of the jointed line. Ratios keep their constant speed ratio.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from trunnion.arrays import Array
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.loads import load_slope
from trunnion.equations.topology import Topology


@dataclass(frozen=True)
class AlignedMatrices:
    """M, C and K (case, n, n) [kg m², N m s/rad, N m/rad] in absolute rotations; M is diagonal but where a differential
    couples its legs.

    ``loss`` H (case, n, n) [N m/rad] damps at all frequencies alike: K + i sgn(ν) H at the frequency ν.
    """

    inertia: Array
    damping: Array
    stiffness: Array
    loss: Array

    @property
    def mass(self) -> Array:
        """The diagonal of M (case, n)."""
        return np.einsum("cii->ci", self.inertia)


class UnitMasses:
    """Coordinates y = Lᵀx in which an inertia matrix (n, n), LLᵀ, is 1: by the roots of a diagonal one."""

    def __init__(self, inertia: Array) -> None:
        root = np.sqrt(np.diag(inertia))
        alone = not np.any(inertia - np.diag(np.diag(inertia)))
        self.root = root if alone else None
        self.factor = np.diag(root) if alone else np.linalg.cholesky(inertia)

    def of_matrix(self, matrix: Any) -> Any:
        """L⁻¹ A L⁻ᵀ."""
        if self.root is not None:
            return matrix / np.outer(self.root, self.root)
        return np.linalg.solve(self.factor, np.linalg.solve(self.factor, matrix.T).T)

    def of_rotations(self, x: Array) -> Array:
        """y of rotations x (n,) or (n, k)."""
        return np.asarray((x.T * self.root).T if self.root is not None else self.factor.T @ x)

    def of_turning(self, turning: Array) -> Array:
        """Rows u L⁻ᵀ (k, n), which make of y the rotations that rows u (k, n) make of x."""
        return np.asarray(turning / self.root if self.root is not None else np.linalg.solve(self.factor, turning.T).T)

    def rotations(self, y: Any) -> Any:
        """x of y (n, k)."""
        return y / self.root[:, None] if self.root is not None else np.linalg.solve(self.factor.T, y)


def aligned_matrices(topo: Topology, coefficients: LineCoefficients) -> AlignedMatrices:
    """Mass, damping and stiffness of the aligned line, one per case."""
    cases, n = len(coefficients.inertia), topo.size
    elongations = topo.elongations
    damping, stiffness, loss = (
        (elongations.T * part[:, None, :]) @ elongations if part.any() else np.zeros((cases, n, n))
        for part in (coefficients.damping, coefficients.stiffness, coefficients.loss)
    )
    for one in coefficients.across:
        turns = np.outer(topo.turning[one.on], topo.turning[one.by])
        damping = damping + one.slope[:, None, None] * turns
    return AlignedMatrices(on_rotations(topo, coefficients.inertia), damping, stiffness, loss)


def on_rotations(topo: Topology, parts: Array) -> Array:
    """What resists the acceleration or the speed of stations (case, station) as the unknowns feel it (case, n, n)."""
    if topo.graph:
        return np.asarray((topo.turning.T * parts[:, None, :]) @ topo.turning)
    found = np.zeros((len(parts), topo.size, topo.size))
    found[:, np.arange(topo.size), np.arange(topo.size)] = topo.on_unknowns(parts)
    return found


def loaded_matrices(topo: Topology, coefficients: LineCoefficients, speeds: Array) -> AlignedMatrices:
    """The same with the slopes of loads by speed, each at its station's own speed; input ``speeds`` (case,) [rad/s].

    At the speed 0 viscous loads brake and quadratic ones do not.
    """
    straight = aligned_matrices(topo, coefficients)
    slope = load_slope(topo, coefficients.viscous, coefficients.quadratic, np.asarray(speeds))
    return replace(straight, damping=straight.damping + on_rotations(topo, slope))


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
    if np.count_nonzero(matrices.inertia) > np.count_nonzero(matrices.mass):
        pairs = zip(matrices.inertia, matrices.stiffness, strict=True)
        scaled = np.stack([UnitMasses(inertia).of_matrix(stiffness) for inertia, stiffness in pairs])
    else:
        root = np.sqrt(matrices.mass)
        scaled = matrices.stiffness / (root[:, :, None] * root[:, None, :])
    squares = np.linalg.eigvalsh(scaled)
    squares[:, :still] = 0.0
    return np.sqrt(np.maximum(squares, 0.0))
