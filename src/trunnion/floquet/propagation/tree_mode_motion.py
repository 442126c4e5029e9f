"""How one Floquet mode of a long line and its adjoint move over the period, from Hill's blocks along the tree.

With s_h = λ + ihbΩ and A(λ) the blocks of ``hill_line``, the mode is the right null vector, x = Σ X_h e^{s_h t}, and
its adjoint the left one, z = Σ Z_h e^{−s_h t}. As rows that go with the states (x, dx/dt) of M x″ + C x′ + K x = 0, M
constant, the adjoint is

    l = (Cᵀz − M z′, M z),   l·r = constant,

which checks both: each comes from a solution of its own.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from trunnion.arrays import Complex
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.topology import Topology
from trunnion.equations.tree_matrices import TreeMatrices, tree_matrices
from trunnion.floquet.propagation.hill_line import HillLine, PeriodicMotionGiven
from trunnion.modes.mode_content import ModeMotion
from trunnion.numerics.tree_blocks import TreeMatrix

BESIDE, STEPS = 1e-7, 4
"""Distance from the exponent, over the rate of the coefficients, at which inverse iteration is done, and its steps."""
CONSTANT = 1e-6
"""Share by which l·r may vary over the period."""


def mode_motion(
    topo: Topology, co: LineCoefficients, turns: Fraction, exponent: complex, about: PeriodicMotionGiven | None = None
) -> ModeMotion | None:
    """The mode of ``exponent`` [1/s] of the one case of ``co``; None where it is double, or not found. ``about`` as of
    ``HillLine``."""
    line = HillLine(topo, co, turns, about)
    h, speed = line.wide, line.speed
    s = np.array([exponent + BESIDE * line.rate]) + 1j * h[None] * line.rate
    matrix, slope = line.blocks.at(s, h), line.blocks.at(s, h, slope=True)
    right, left = (_null_vector(matrix, slope, transposed) for transposed in (False, True))
    if not (np.isfinite(right).all() and np.isfinite(left).all()):
        return None
    count = 1 << int(np.ceil(np.log2(4 * int(np.ptp(h)) + 4)))
    tau = 2 * np.pi * float(turns) * np.arange(count) / count
    matrices = tree_matrices(topo, co, tau, about.given if about else None)
    mu = (exponent + 1j * h * line.rate) / speed
    wave = np.exp(np.outer(tau, mu))  # (time, h)
    x, rate = wave @ right.T, wave @ (mu * right).T
    z, z_rate = (1 / wave) @ left.T, -(1 / wave) @ (mu * left).T
    felt = _transposed_times(matrices, 1, z) / speed - _transposed_times(matrices, 2, z_rate)
    adjoint = np.concatenate([felt, _transposed_times(matrices, 2, z)], axis=1)
    states = np.concatenate([x, rate], axis=1)
    product = (adjoint * states).sum(axis=1)
    size = np.abs(adjoint * states).sum(axis=1)
    if not (np.abs(product[0]) > 1e-12 * size[0] and np.ptp(np.abs(product)) <= CONSTANT * np.abs(product[0])):
        return None
    return ModeMotion(
        states,
        adjoint / product[0],
        complex(exponent) / speed,
        2 * np.pi * float(turns),
        line.mean_mass,
        line.mean_stiffness / speed**2,
    )


def _null_vector(matrix: TreeMatrix, slope: TreeMatrix, transposed: bool) -> Complex:
    """(n, h), by inverse iteration from what has a part of every mode."""
    shape = matrix.own.shape[0], 1, matrix.own.shape[2]
    x = np.exp(1j * np.arange(np.prod(shape))).reshape(shape)
    for _ in range(STEPS):
        x = matrix.eliminated(slope.times(x, transposed=transposed), transposed=transposed)
        x = x / np.linalg.norm(x)
    return np.asarray(x[:, 0])


def _transposed_times(matrices: TreeMatrices, kind: int, z: Complex) -> Complex:
    """Cᵀz or Mᵀz, by the ``kind`` 1 or 2, of the one case, both (time, n)."""
    entries = matrices.three[kind]
    out: Complex = entries.own[:, 0].T * z
    for i in np.flatnonzero(entries.parent >= 0).tolist():
        p = int(entries.parent[i])
        out[:, p] += entries.down[i, 0] * z[:, i]
        out[:, i] += entries.up[i, 0] * z[:, p]
    for one in matrices.beside:
        out[:, one.column] += one.parts[kind][0] * z[:, one.row]
    return out
