"""Steady response of a line whose equations do not vary: one complex system per order and speed, all at once.

    (−w² M + iw C + K + i sgn(w) H) Y = g,   w = KΩ + ν,

with H the part of the stiffness that damps whatever the frequency. Of a machine whose torque lags behind its speed C
has k/(1 + iw/w_c) in place of its slope k. What stands still, w = 0, is a constant torque: it drives a free–free line
away, against the loads that go with its speed or else against its inertia, and twists it. The matrix has the pattern of
the line's tree, so elimination from the leaves solves all orders and speeds together; where that loses figures, bands
with exchange of pivots do.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from trunnion.arrays import Array, Complex, Flags
from trunnion.equations.aligned import at_rest, rigid_rotation
from trunnion.equations.line_coefficients import OilLink, TorqueLag
from trunnion.equations.linear import LineMatrices
from trunnion.equations.topology import Topology
from trunnion.equations.tree_matrices import TreeMatrices
from trunnion.numerics.condensation import Plan
from trunnion.numerics.tree_blocks import TreeMatrix

DRAGGED = 1e-9
"""Share of the largest damping from which dampers resist the line as a whole: less is rounding."""
ROUNDING = 1e-15
"""Share of what a solution takes to hold below which a change of it is rounding."""
SINGULAR = 1e-13
"""Share of |A| |Y| below which the forces that hold a motion against nothing count as none: undamped resonance."""


def straight_response(
    topo: Topology,
    matrices: TreeMatrices,
    loss: Array,
    frequency: Array,
    right: Complex,
    *,
    lags: Sequence[TorqueLag] = (),
    oils: Sequence[OilLink] = (),
    linearised: bool = False,
) -> Complex:
    """Y (order, case, n) [rad] of torques ``right`` (order, case, n) at ``frequency`` (order, case) [rad/s].

    ``matrices`` at one time, ``loss`` (case, compliance) [N m/rad], ``lags`` of what they have as damping, ``oils`` of
    dampers. NaN where the line resonates without damping. Where a free–free line is driven away, the deviations are
    those beside what it turns as a whole.
    With ``linearised`` to first order about the first case: Y₀ + A₀⁻¹(g − A Y₀).
    """
    orders, cases, n = right.shape
    sign = np.sign(frequency)

    def dynamic(k: Array, c: Array, m: Array) -> Complex:
        k, c, m = (part[:, None] for part in (k, c, m))
        return np.asarray(k - frequency**2 * m + 1j * frequency * c)

    three = matrices.stiffness, matrices.damping, matrices.mass
    own = dynamic(*(part.own[..., 0] for part in three))
    coupling = dynamic(*(part.down[..., 0] for part in three))
    for lag in lags:
        place = int(topo.unknown_of[lag.station])
        if place >= 0:
            own[place] += topo.relative_ratios[lag.station] ** 2 * lag.added(frequency)
    for e, (far, near) in enumerate(topo.ends):
        oil = [one.added(frequency) for one in oils if one.compliance == e]
        if not loss[:, e].any() and not oil:
            continue
        lossy, ratio = 1j * loss[:, e] * sign + sum(oil), matrices.ratio[:, 0, e]
        if far >= 0:
            own[far] += lossy
        if near >= 0:
            own[near] += ratio**2 * lossy
        if far >= 0 and near >= 0:
            coupling[far] -= ratio * lossy
    _join(topo, matrices, own, coupling, frequency == 0)
    plan, g = Plan.of(matrices.parent, np.zeros(n, dtype=bool)), np.moveaxis(right, 2, 0)
    turn = rigid_rotation(topo) if topo.free else np.zeros(n)
    if linearised:
        # Orders are solved together at the first speed, and stand for themselves at the others.
        each = [(part[:, k, :, None] for part in (own, coupling, g)) for k in range(orders)]
        every = [about_first(TreeMatrix(plan, matrices.parent, a, b, []), force, turn) for a, b, force in each]
        y = np.stack([part[..., 0].T for part in every])
    else:
        flat = (n, orders * cases, 1)
        matrix, b = TreeMatrix(plan, matrices.parent, own.reshape(flat), coupling.reshape(flat), []), g.reshape(flat)
        y = np.moveaxis(bounded(matrix, b, matrix.solved(b), turn).reshape(n, orders, cases), 0, 2)
    for k in np.flatnonzero((frequency == 0).any(axis=1)) if topo.free else ():
        still = frequency[k] == 0
        y[k, still] = _driven_away(topo, plan, matrices, right[k], linearised)[still]
    return y


def coupled_response(
    topo: Topology,
    matrices: LineMatrices,
    loss: Array,
    frequency: Array,
    right: Complex,
    *,
    lags: Sequence[TorqueLag] = (),
    oils: Sequence[OilLink] = (),
    linearised: bool = False,
) -> Complex:
    """The same as ``straight_response`` where masses couple unknowns: dense, order by order and speed by speed."""
    mass, damping, stiffness = (part[:, 0] for part in (matrices.mass, matrices.damping, matrices.stiffness))
    lossy = np.einsum("ei,se,ej->sij", topo.elongations, loss, topo.elongations)
    w = frequency[..., None, None]
    stiffness = np.where(w == 0, at_rest(topo, stiffness), stiffness) if topo.dragged else stiffness
    matrix = stiffness - w**2 * mass + 1j * (w * damping + np.sign(w) * lossy)
    for lag in lags:
        turning = topo.turning[lag.station]
        matrix = matrix + lag.added(frequency)[..., None, None] * np.outer(turning, turning)
    for oil in oils:
        twist = topo.elongations[oil.compliance]
        matrix = matrix + oil.added(frequency)[..., None, None] * np.outer(twist, twist)
    turn = rigid_rotation(topo) if topo.free else np.zeros(right.shape[2])
    if not linearised:
        return _one_by_one(matrix, right, turn)
    # To first order about the first case, whose matrix stands for all.
    first_matrix = np.broadcast_to(matrix[:, :1], matrix.shape)
    first = _one_by_one(first_matrix, np.broadcast_to(right[:, :1], right.shape), turn)
    taken = (matrix @ first[..., None])[..., 0]
    rest = right - taken
    rest[np.abs(rest).max(axis=2) <= ROUNDING * (np.abs(matrix) @ np.abs(first)[..., None])[..., 0].max(axis=2)] = 0.0
    return first + _one_by_one(first_matrix, rest, turn)


def _one_by_one(matrix: Complex, right: Complex, turn: Array) -> Complex:
    """Solutions (order, case, n); NaN where a motion needs no force, 0 where nothing acts; ``turn`` of ``bounded``."""
    found = np.zeros(right.shape, dtype=complex)
    for at in np.argwhere(right.any(axis=2)):
        one = tuple(at)
        try:
            found[one] = np.linalg.solve(matrix[one], right[one])
        except np.linalg.LinAlgError:
            found[one] = np.nan
        holds = np.abs(matrix[one]) @ np.abs(_twisted(found[one], turn))
        if np.abs(right[one]).max() < SINGULAR * holds.max():
            found[one] = np.nan
    return found


def about_first(matrix: TreeMatrix, right: Complex, turn: Array) -> Complex:
    """Solutions to first order about the first case: X₀ + A₀⁻¹(G − AX₀); ``turn`` as ``bounded`` takes it."""
    alone = matrix.of(slice(0, 1))
    first = bounded(alone, right[:, :1], alone.solved(right[:, :1]), turn)
    product = matrix.times(np.broadcast_to(first, right.shape))
    rest = right - product
    size = np.abs(right) + np.abs(matrix.own * first)
    rest[:, np.all(np.abs(rest) <= ROUNDING * size.max(axis=(0, 2), keepdims=True), axis=(0, 2))] = 0.0
    return np.asarray(first + alone.solved(rest))


def bounded(matrix: TreeMatrix, right: Complex, x: Complex, turn: Array) -> Complex:
    """NaN where a motion needs no force, resonance without damping; 0 where nothing acts.

    Of a line that is free to ``turn`` (n,) as a whole, zero otherwise, that motion holds nothing: the slower an order,
    the farther it swings the whole line, without resonance.
    """
    force = np.abs(right).max(axis=(0, 2))
    with np.errstate(invalid="ignore"):
        x[:, force < SINGULAR * np.abs(matrix.own * _twisted(x, turn)).max(axis=(0, 2))] = np.nan
    x[:, force == 0] = 0.0
    return x


def _twisted(x: Complex, turn: Array) -> Complex:
    """What is left of motions (n, …) without that of the line as a whole."""
    size = turn @ turn
    return x - np.multiply.outer(turn, np.tensordot(turn, x, 1) / size) if size else x


def _join(topo: Topology, matrices: TreeMatrices, own: Complex, coupling: Complex, still: Flags) -> None:
    """Add to stiffness on the diagonal (n, …, case) and beside it what joins rings that oil alone drags along to what
    they are on, where the line stands ``still`` (…, case): see ``aligned.at_rest``."""
    weight = np.abs(matrices.stiffness.own[..., 0]).max(axis=0) * still
    for far, near, ratio in ((*topo.ends[e], matrices.ratio[:, 0, e]) for e in topo.dragged):
        own[far] += weight
        if near >= 0:
            own[near] += ratio**2 * weight
            coupling[far] -= ratio * weight


def _driven_away(topo: Topology, plan: Plan, matrices: TreeMatrices, torque: Complex, linearised: bool) -> Complex:
    """Twists (case, n) under constant ``torque`` (case, n) of a line that turns as a whole: what resists there balances
    it. With ``linearised`` to first order about the first case."""
    turn, some = rigid_rotation(topo), slice(0, 1) if linearised else slice(None)
    stiffness, damping, mass = (
        TreeMatrix(plan, matrices.parent, part.own.astype(complex), part.down.astype(complex), [])
        for part in (matrices.stiffness, matrices.damping, matrices.mass)
    )
    _join(topo, matrices, stiffness.own[..., 0], stiffness.coupling[..., 0], np.ones(len(torque), dtype=bool))
    whole = np.broadcast_to(turn[:, None, None], stiffness.own.shape).astype(complex)
    drag, inertia = damping.times(whole), mass.times(whole)
    drags = np.abs(drag).max(axis=0) > DRAGGED * np.abs(damping.own).max(axis=0)
    resists = np.where(drags, drag, inertia)[:, some]
    # Of a line without a torque on the whole it does not matter what is held.
    fixed = stiffness.of(some)
    fixed.own = fixed.own.copy()
    fixed.own[0] += np.abs(fixed.own).max(axis=0)

    def twists(acting: Complex) -> Complex:
        left = acting - resists * np.tensordot(turn, acting, 1) / np.tensordot(turn, resists, 1)
        x = fixed.solved(left)
        return np.asarray(x - whole[:, :1] * np.tensordot(turn, x, 1) / (turn @ turn))

    right = torque.T[..., None].astype(complex)
    if not linearised:
        return twists(right)[..., 0].T
    first = twists(right[:, :1])
    rest = right - stiffness.times(np.broadcast_to(first, right.shape))
    return np.asarray(first + twists(rest))[..., 0].T
