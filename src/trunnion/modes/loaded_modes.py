"""Modes of the loaded line over speed: damped eigenvalues of the aligned line, loads that go with speed included.

(λ²M + λC(Ω) + K + iH) v = 0 with all joints straight: C holds the slopes of loads by speed at each station's own
speed, H the damping that does not go with frequency. Modes keep their place by shape: a mode at one speed follows
the one at the speed before that it shares most with, by the modal assurance criterion.
"""

from __future__ import annotations

from dataclasses import fields

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.equations.aligned import AlignedMatrices, UnitMasses, loaded_matrices
from trunnion.equations.coefficients import Assembly
from trunnion.modes.damped_modes import RIGID, damped_modes, matched


def loaded_modes(assembly: Assembly, speeds: Array, table: Array | None = None) -> tuple[Complex, Complex]:
    """Eigenvalues (speed, mode) [1/s] with positive imaginary part, and shapes (speed, rotation, mode).

    Modes are numbered by the undamped frequency of the line, the rigid rotation of a free line left out. NaN where a
    mode does not oscillate. ``table`` (speed, column): packed numbers at every speed, where they follow it.
    """
    topo = assembly.topology
    numbers = assembly.table(len(speeds), speeds) if table is None else table
    matrices = _matrices(assembly, numbers)
    damping = matrices.damping
    n, unit = topo.size, UnitMasses(matrices.inertia[0])
    squares, reference = np.linalg.eigh(unit.of_matrix(matrices.stiffness[0]))
    least = RIGID * np.sqrt(max(squares.max(initial=0.0), 0.0))
    elastic = squares > least**2
    last = reference[:, elastic].astype(complex)
    found = np.full((len(speeds), last.shape[1]), complex(np.nan, np.nan))
    shapes = np.full((len(speeds), n, last.shape[1]), complex(np.nan, np.nan))
    alike = all(np.array_equal(part, np.broadcast_to(part[:1], part.shape)) for part in (damping, matrices.stiffness))
    for i in range(min(len(speeds), 1) if alike else len(speeds)):
        lossy = matrices.stiffness[i] + 1j * matrices.loss[i]
        values, vectors = damped_modes(unit.of_matrix(damping[i]), unit.of_matrix(lossy), least)
        here, there = matched(last, vectors)
        found[i, here] = values[there]
        turned = unit.rotations(vectors[:, there])
        largest = turned[np.abs(turned).argmax(axis=0), np.arange(len(there))]
        shapes[i][:, here] = turned / largest
        last[:, here] = vectors[:, there]
    if alike:
        found[1:], shapes[1:] = found[:1], shapes[:1]
    return found, shapes


def _matrices(assembly: Assembly, table: Array) -> AlignedMatrices:
    """Those of every row; of a line with a torque converter as it runs at the speed of each."""
    if every := assembly.each(table[:, 0]):
        parts = [_matrices(one, row[None]) for one, row in zip(every, table, strict=True)]
        names = [one.name for one in fields(AlignedMatrices)]
        return AlignedMatrices(**{name: np.concatenate([getattr(one, name) for one in parts]) for name in names})
    return loaded_matrices(assembly.topology, assembly.coefficients(table, any_frequency=True), table[:, 0])
