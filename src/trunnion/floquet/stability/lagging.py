"""Stability of straight lines with machines whose torque lags behind their speed.

Their equations have constant coefficients and one state more for each such torque, Ṫ = ν_c (b ω − T) with the slope b:

    x′ = A x,   x = (rotations, speeds, torques),   multipliers e^{λt} over the period t, λ the eigenvalues of A.

A quasi-static slope damps whatever the frequency; one that lags leaves of b only b/(1 + ν²/ν_c²) at the frequency ν,
which may be less than what another machine drives the motion with.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Complex, Flags
from trunnion.equations.aligned import UnitMasses
from trunnion.equations.coefficients import Assembly
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.linear import line_matrices, rigid_motions
from trunnion.equations.steady_base import has_joint_angles
from trunnion.modes.damped_modes import Lagging, with_lags
from trunnion.results.verdict import Verdict, verdicts


def lags_count(assembly: Assembly, coefficients: LineCoefficients, table: Array | None = None) -> bool:
    """Whether torques lag and nothing else varies, so that what lags has equations here: as described, or at all rows
    of ``table``."""
    return bool(coefficients.lags) and not coefficients.waves and not has_joint_angles(assembly, table)


def lagging_matrices(assembly: Assembly, coefficients: LineCoefficients) -> list[tuple[UnitMasses, Array]]:
    """Of every case the coordinates of unit masses and A [1/s] in them."""
    topo, lags = assembly.topology, coefficients.lags
    found, turning = [], topo.turning[[one.station for one in lags]]
    matrices = line_matrices(topo, coefficients, np.zeros(1))
    for i in range(len(coefficients.speed)):
        unit = UnitMasses(matrices.mass[i, 0])
        slope, corner = (np.array([getattr(one, name)[i] for one in lags]) for name in ("slope", "corner"))
        damping, stiffness = (unit.of_matrix(part[i, 0]) for part in (matrices.damping, matrices.stiffness))
        found.append((unit, with_lags(damping, stiffness, Lagging(unit.of_turning(turning), slope, corner)).real))
    return found


def lagging_growth(assembly: Assembly, coefficients: LineCoefficients) -> Array:
    """Growth [1/s] of the fastest disturbance of every case (case,), negative where all decay."""
    kept = rigid_motions(assembly.topology, coefficients).shape[1]
    found = []
    for _, matrix in lagging_matrices(assembly, coefficients):
        values = np.linalg.eigvals(matrix).astype(complex)
        found.append(values.real[~_aside(values, kept)].max(initial=-np.inf))
    return np.array(found)


@dataclass(frozen=True)
class LaggingMultipliers:
    """Multipliers by falling modulus, their errors, states (x, dx/dτ) that each carries on (2n, multiplier), and of
    those that are judged the largest modulus and its error."""

    value: Complex
    error: Array
    states: Complex
    radius: float
    radius_error: float

    @property
    def verdict(self) -> Verdict:
        """Of a damped line."""
        return Verdict(int(verdicts(np.array(self.radius), np.array(self.radius_error), np.array(False))))


def lagging_multipliers(
    assembly: Assembly, coefficients: LineCoefficients, period: float, aside: int
) -> LaggingMultipliers:
    """Of one case, over a ``period`` [rad of input angle]; the ``aside`` smallest exponents are 0 and not judged."""
    ((unit, matrix),) = lagging_matrices(assembly, coefficients)
    n, speed = assembly.topology.size, float(coefficients.speed[0])
    values, states, off = _eigenvalues(matrix)
    kept = _aside(values, aside)
    values[kept] = 0.0
    multipliers = np.exp(values * period / speed)
    error = off * period / speed * np.abs(multipliers)
    most = int(np.where(kept, -1.0, np.abs(multipliers)).argmax())
    rotations = unit.rotations(states[:n])
    modes = np.concatenate([rotations, rotations * values / speed])
    falling = np.argsort(-np.abs(multipliers), kind="stable")
    return LaggingMultipliers(
        multipliers[falling], error[falling], (modes / np.abs(modes).max(axis=0))[:, falling],
        float(np.abs(multipliers[most])), float(error[most]),
    )  # fmt: skip


@dataclass(frozen=True)
class LaggingMode:
    """multiplier: those that are judged; critical: the largest of them; right, left: its vectors in the coordinates of
    ``lagging_matrices``, left·right = 1; relative: what rounding changes of a derivative through them, over it."""

    multiplier: Complex
    critical: complex
    right: Complex
    left: Complex
    relative: float


def lagging_mode(assembly: Assembly, coefficients: LineCoefficients, period: float) -> LaggingMode:
    """The disturbance of one case that grows fastest over a ``period`` [rad of input angle]."""
    from scipy.linalg import eig

    ((_, matrix),) = lagging_matrices(assembly, coefficients)
    speed = float(coefficients.speed[0])
    values, left, right = eig(matrix / speed, left=True, right=True)
    judged = np.flatnonzero(~_aside(values, rigid_motions(assembly.topology, coefficients).shape[1]))
    multipliers = np.exp(values * period)
    most = int(judged[np.abs(multipliers[judged]).argmax()])
    adjoint = left[:, most].conj() / (left[:, most].conj() @ right[:, most])
    rounding = np.finfo(float).eps * len(matrix) * float(np.linalg.norm(matrix / speed, 2) * np.linalg.norm(adjoint))
    apart = float(np.sort(np.abs(values - values[most]))[1])
    return LaggingMode(
        multipliers[judged], complex(multipliers[most]), right[:, most], adjoint, 2 * rounding / max(apart, 1e-300)
    )


def _aside(values: Complex, count: int) -> Flags:
    """The ``count`` smallest, which a line keeps for ever."""
    found = np.zeros(len(values), dtype=bool)
    found[np.argsort(np.abs(values))[:count]] = True
    return found


def _eigenvalues(matrix: Array) -> tuple[Complex, Complex, Array]:
    """Eigenvalues, their vectors, and what rounding moves each by at most."""
    from scipy.linalg import eig

    values, left, right = eig(matrix, left=True, right=True)
    share = np.abs(np.einsum("ij,ij->j", left.conj(), right))
    size = np.linalg.norm(matrix, 2) * np.finfo(float).eps * len(matrix)
    return values.astype(complex), right.astype(complex), size / np.maximum(share, np.finfo(float).eps)
