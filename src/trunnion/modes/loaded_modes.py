"""Modes of the loaded line over speed: damped eigenvalues of the aligned line, loads that go with speed included.

(λ²M + λC(Ω) + K + iH) v = 0 with all joints straight: C holds the slopes of loads by speed at each station's own
speed, H the damping that does not go with frequency. Modes keep their place by shape: a mode at one speed follows
the one at the speed before that it shares most with, by the modal assurance criterion.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.equations.aligned import AlignedMatrices, UnitMasses, loaded_matrices
from trunnion.equations.coefficients import Assembly
from trunnion.equations.steady_base import has_joint_angles
from trunnion.modes.damped_modes import RIGID, Lagging, damped_modes, matched


def loaded_modes(assembly: Assembly, speeds: Array, table: Array | None = None) -> tuple[Complex, Complex]:
    """Eigenvalues (speed, mode) [1/s] with positive imaginary part, and shapes (speed, rotation, mode).

    Modes are numbered by the undamped frequency of the line, the rigid rotation of a free line left out. NaN where a
    mode does not oscillate. ``table`` (speed, column): packed numbers at every speed, where they follow it.
    """
    topo = assembly.topology
    numbers = assembly.table(len(speeds), speeds) if table is None else table
    matrices, lags = _matrices(assembly, numbers)
    damping = matrices.damping
    n, unit = topo.size, UnitMasses(matrices.inertia[0])
    squares, reference = np.linalg.eigh(unit.of_matrix(matrices.stiffness[0]))
    least = RIGID * np.sqrt(max(squares.max(initial=0.0), 0.0))
    elastic = squares > least**2
    last = reference[:, elastic].astype(complex)
    found = np.full((len(speeds), last.shape[1]), complex(np.nan, np.nan))
    shapes = np.full((len(speeds), n, last.shape[1]), complex(np.nan, np.nan))
    fixed = (damping, matrices.stiffness, lags.slope, lags.corner)
    alike = all(np.array_equal(part, np.broadcast_to(part[:1], part.shape)) for part in fixed)
    for i in range(min(len(speeds), 1) if alike else len(speeds)):
        lossy = matrices.stiffness[i] + 1j * matrices.loss[i]
        values, vectors = damped_modes(unit.of_matrix(damping[i]), unit.of_matrix(lossy), least, lags.at(i, unit))
        here, there = matched(last, vectors)
        found[i, here] = values[there]
        turned = unit.rotations(vectors[:, there])
        largest = turned[np.abs(turned).argmax(axis=0), np.arange(len(there))]
        shapes[i][:, here] = turned / largest
        last[:, here] = vectors[:, there]
    if alike:
        found[1:], shapes[1:] = found[:1], shapes[:1]
    return found, shapes


@dataclass(frozen=True)
class _Lags:
    """What lags at every speed: turning (part, n), slope and corner (speed, part)."""

    turning: Array
    slope: Array
    corner: Array

    def at(self, i: int, unit: UnitMasses) -> Lagging | None:
        """At speed i, in coordinates of unit masses; None where nothing lags."""
        if not len(self.turning):
            return None
        return Lagging(unit.of_turning(self.turning), self.slope[i], self.corner[i])


def _matrices(assembly: Assembly, table: Array) -> tuple[AlignedMatrices, _Lags]:
    """Those of every row; of a line with a torque converter as it runs at the speed of each."""
    if every := assembly.each(table[:, 0]):
        parts = [_matrices(one, row[None]) for one, row in zip(every, table, strict=True)]
        names = [one.name for one in fields(AlignedMatrices)]
        matrices = {name: np.concatenate([getattr(one, name) for one, _ in parts]) for name in names}
        every_lag = [one for _, one in parts]
        slope, corner = (np.concatenate([getattr(one, name) for one in every_lag]) for name in ("slope", "corner"))
        return AlignedMatrices(**matrices), _Lags(every_lag[0].turning, slope, corner)
    topo, co = assembly.topology, assembly.coefficients(table, any_frequency=True)
    lags = () if has_joint_angles(assembly) or co.waves else co.lags
    turning = topo.turning[[one.station for one in lags]]
    slope, corner = (
        np.array([getattr(one, name) for one in lags]).reshape(len(lags), len(table)).T for name in ("slope", "corner")
    )
    return loaded_matrices(topo, co, table[:, 0]), _Lags(turning, slope, corner)
