"""Steady response of a line whose equations do not vary: one complex system per order and speed, all at once.

    (−w² M + iw C + K + i sgn(w) H) Y = g,   w = KΩ + ν,

with H the part of the stiffness that damps whatever the frequency. What stands still, w = 0, is a constant torque: it
drives a line that starts free away, against the loads that go with its speed or else against its inertia, and twists
it. The matrix has the pattern of the line's tree, so elimination from the leaves solves all orders and speeds together;
where that loses figures, a dense solution follows.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from trunnion.arrays import Array, Complex, Integers, Places
from trunnion.equations.aligned import at_rest, rigid_rotation
from trunnion.equations.linear import LineMatrices
from trunnion.equations.topology import Topology
from trunnion.numerics.tree_solve import tree_solve

RESIDUAL = 1e-13
DRAGGED = 1e-9
"""Share of the largest damping from which dampers resist the line as a whole: less is rounding."""
ROUNDING = 1e-15
"""Share of what a solution takes to hold below which a change of it is rounding."""
SINGULAR = 1e-13
"""Share of |A| |Y| below which the forces that hold a motion against nothing count as none: undamped resonance."""


def straight_response(topo: Topology, matrices: LineMatrices, loss: Array, frequency: Array, right: Complex) -> Complex:
    """Y (order, case, n) [rad] of torques ``right`` (order, case, n) at ``frequency`` (order, case) [rad/s].

    ``matrices`` at one time, ``loss`` (case, n, n) is H. NaN where the line resonates without damping. Of a line that
    starts free and is driven away the deviations are those beside what it turns as a whole.
    """
    mass, damping, stiffness = matrices.mass[:, 0], matrices.damping[:, 0], matrices.stiffness[:, 0]
    parent = np.full(topo.size, -1, dtype=np.int64)
    for far, near in topo.ends:
        if far >= 0:
            parent[far] = near
    orders, cases, n = right.shape
    tied = np.where(parent >= 0, parent, 0)
    every = np.arange(n)

    def dynamic(rows: Places, columns: Places) -> Complex:
        m, c, k, h = (part[:, rows, columns].T[:, None] for part in (mass, damping, stiffness, loss))
        w = frequency[None]
        return np.asarray(k - w**2 * m + 1j * (w * c + np.sign(w) * h)).reshape(n, orders * cases)

    diagonal, coupling = dynamic(every, every), dynamic(every, tied)
    coupling[parent < 0] = 0.0
    b = np.moveaxis(right, 2, 0).reshape(n, orders * cases)
    x, residual = tree_solve(diagonal, coupling, parent, b)
    force = np.abs(b).max(axis=0)
    with np.errstate(invalid="ignore"):
        lost = np.flatnonzero(~(np.abs(residual).max(axis=0) <= RESIDUAL * force))
    for j in lost:
        x[:, j] = _dense(diagonal[:, j], coupling[:, j], parent, b[:, j])
    weight = np.maximum(np.abs(diagonal), np.abs(coupling)) * np.abs(x)
    x[:, force < SINGULAR * weight.max(axis=0)] = np.nan
    if topo.still:
        for j in np.flatnonzero(frequency.ravel() == 0):
            joined = at_rest(topo, stiffness[j % cases])
            if topo.free:
                x[:, j] = _driven_away(rigid_rotation(topo), mass[j % cases], damping[j % cases], joined, b[:, j])
            else:
                x[:, j] = np.linalg.solve(joined, b[:, j])
    x[:, force == 0] = 0.0
    return np.moveaxis(x.reshape(n, orders, cases), 0, 2)


def straight_about_first(
    topo: Topology, matrices: LineMatrices, loss: Array, frequency: Array, right: Complex
) -> Complex:
    """The same to first order about the first case: Y₀ + A₀⁻¹(g − A Y₀)."""
    cases = right.shape[1]
    held = replace(
        matrices,
        **{key: np.repeat(getattr(matrices, key)[:1], cases, axis=0) for key in ("mass", "damping", "stiffness")},
    )
    steady = np.repeat(loss[:1], cases, axis=0), np.repeat(frequency[:, :1], cases, axis=1)
    first = straight_response(topo, held, *steady, np.repeat(right[:, :1], cases, axis=1))
    w = frequency[..., None]
    mass, damping, stiffness, lossy = (
        (part[None] @ first[..., None])[..., 0]
        for part in (matrices.mass[:, 0], matrices.damping[:, 0], matrices.stiffness[:, 0], loss)
    )
    parts = (-(w**2) * mass, 1j * w * damping, stiffness + 1j * np.sign(w) * lossy)
    rest = right - sum(parts)
    size = np.max([np.abs(part).max(axis=2) for part in (right, *parts)], axis=0)
    rest[np.abs(rest).max(axis=2) <= ROUNDING * size] = 0.0
    return np.asarray(first + straight_response(topo, held, *steady, rest))


def _driven_away(turn: Array, mass: Array, damping: Array, stiffness: Array, torque: Complex) -> Complex:
    """Twists under a constant ``torque`` (n,) of a line that turns as ``turn`` (n,): what resists there balances it."""
    drag = damping @ turn
    resists = drag if np.abs(drag).max() > DRAGGED * np.abs(damping).max() else mass @ turn
    left = torque - resists * (turn @ torque) / (turn @ resists)
    whole = np.outer(turn, turn) * np.abs(stiffness).max() / (turn @ turn)
    return np.asarray(np.linalg.solve(stiffness + whole, left))


def _dense(diagonal: Complex, coupling: Complex, parent: Integers, right: Complex) -> Complex:
    matrix = np.diag(diagonal)
    for i, p in enumerate(parent):
        if p >= 0:
            matrix[i, p] = matrix[p, i] = coupling[i]
    try:
        return np.asarray(np.linalg.solve(matrix, right))
    except np.linalg.LinAlgError:
        return np.full_like(right, np.nan)
