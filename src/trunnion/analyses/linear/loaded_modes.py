"""Modes of the loaded line over speed: damped eigenvalues of the aligned line, loads that go with speed included.

(λ²M + λC(Ω) + K + iH) v = 0 with all joints straight: C holds the slopes of loads by speed at each station's own
speed, H the damping that does not go with frequency. Modes keep their place by shape: a mode at one speed follows
the one at the speed before that it shares most with, by the modal assurance criterion
MAC(u, v) = |u*Mv|²/((u*Mu)(v*Mv)), weighed with the inertias.
"""

from __future__ import annotations

import numpy as np

from trunnion.analyses.linear.natural_frequencies import damped_modes
from trunnion.arrays import Array, Complex, Places
from trunnion.equations.aligned import aligned_matrices
from trunnion.equations.coefficients import Assembly
from trunnion.equations.loads import load_slope

RIGID = 1e-6
"""Share of the highest frequency below which a mode counts as rigid rotation."""


def loaded_modes(assembly: Assembly, speeds: Array, table: Array | None = None) -> tuple[Complex, Complex]:
    """Eigenvalues (speed, mode) [1/s] with positive imaginary part, and shapes (speed, rotation, mode).

    Modes are numbered by the undamped frequency of the line, the rigid rotation of a free line left out. NaN where a
    mode does not oscillate. ``table`` (speed, column): packed numbers at every speed, where they follow it.
    """
    topo = assembly.topology
    numbers = assembly.table(len(speeds), speeds) if table is None else table
    coefficients = assembly.coefficients(numbers, any_frequency=True)
    matrices = aligned_matrices(topo, coefficients)
    slope = load_slope(topo, coefficients.viscous, coefficients.quadratic, np.asarray(speeds))
    damping = matrices.damping + topo.on_unknowns(slope)[:, :, None] * np.eye(topo.size)
    n, mass = topo.size, matrices.mass[0]
    root = np.sqrt(mass)
    scale = np.outer(root, root)
    squares, reference = np.linalg.eigh(matrices.stiffness[0] / scale)
    least = RIGID * np.sqrt(max(squares.max(initial=0.0), 0.0))
    elastic = squares > least**2
    last = reference[:, elastic].astype(complex)
    found = np.full((len(speeds), last.shape[1]), complex(np.nan, np.nan))
    shapes = np.full((len(speeds), n, last.shape[1]), complex(np.nan, np.nan))
    alike = all(np.array_equal(part, np.broadcast_to(part[:1], part.shape)) for part in (damping, matrices.stiffness))
    for i in range(min(len(speeds), 1) if alike else len(speeds)):
        lossy = matrices.stiffness[i] + 1j * matrices.loss[i]
        values, vectors = damped_modes(damping[i] / scale, lossy / scale, least)
        here, there = matched(last, vectors)
        found[i, here] = values[there]
        turned = vectors[:, there] / root[:, None]
        largest = turned[np.abs(turned).argmax(axis=0), np.arange(len(there))]
        shapes[i][:, here] = turned / largest
        last[:, here] = vectors[:, there]
    if alike:
        found[1:], shapes[1:] = found[:1], shapes[:1]
    return found, shapes


def matched(before: Complex, after: Complex) -> tuple[Places, Places]:
    """Which columns belong together, by the largest sum of MAC; vectors in coordinates scaled with √M."""
    share = np.abs(before.conj().T @ after) ** 2
    share /= np.maximum((np.abs(before) ** 2).sum(axis=0)[:, None] * (np.abs(after) ** 2).sum(axis=0), 1e-300)
    if not share.size:  # nothing oscillates
        return np.arange(0), np.arange(0)
    best = share.argmax(axis=1)
    if share.shape[0] <= share.shape[1] and len(set(best.tolist())) == len(best):
        return np.arange(len(best)), best  # each its own: no sum is larger
    from scipy.optimize import linear_sum_assignment

    return linear_sum_assignment(-share)  # type: ignore[no-any-return]
