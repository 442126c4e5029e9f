"""One Runge–Kutta step of a chain of unknowns, for sixteen lanes at a time.

With unknown i, parent p,

    T_i = w_i κ_i (x_i − e_i x_p) + d_i (v_i − e_i v_p − f_i x_p)
    v_i′ = (−T_i + Σ_children e T − g_i v_i − h_i x_i)/m_i,     x_i′ = ν v_i

(κ, f, h over ν; w is the stiffness over its mean), the coefficients of all stages from the table that ``chain_tables``
fills. Lines without w, g, h and m go by Taylor series instead, see ``series_step``.
"""

# mypy: ignore-errors
# Types are inferred by the compiler of this code, from its arguments.
from __future__ import annotations

import numpy as np

from trunnion.numerics.batch import BATCH
from trunnion.numerics.chain.chain_tables import (
    DAMPING,
    EXTRA_DAMPING,
    EXTRA_STIFFNESS,
    FREQUENCY,
    NEAR,
    NEAR_SLOPE,
    OVER_MASS,
    PER_ROW,
    PER_TABLE,
    PER_UNKNOWN,
    STIFFNESS,
    WAVE,
)
from trunnion.numerics.integration.runge_kutta import E3, E5, STAGES, A, B
from trunnion.numerics.jit import njit
from trunnion.numerics.rows import load, spread, store

# Rows of weights that are not 0: of the stages in front of stage m, of the result and of its two error estimates.
_ROWS = [*A[:STAGES, :STAGES], B, E5, E3]
_USED = [np.flatnonzero(row[:STAGES]) for row in _ROWS]
FIRST = np.concatenate([[0], np.cumsum([len(used) for used in _USED])])
STAGE = np.concatenate(_USED)
WEIGHT = np.concatenate([row[used] for row, used in zip(_ROWS, _USED, strict=True)])
RESULT, FIVE, THREE = STAGES, STAGES + 1, STAGES + 2


@njit(nogil=True, fastmath=True, inner=True)
def step_by_stages(parent, table, unknown, h, u, un, scratch, squares):
    """Carry the columns of ``u`` (column, state, lane) into ``un``; squares (3, lanes) of two errors and of the result.

    spare: room for the slopes of all stages of one column, and one state.
    """
    wide, zero = 2 * len(parent), spread(0.0)
    here = STAGES * wide * BATCH
    five, three, whole = zero, zero, zero
    for column in range(0, wide * wide * BATCH, wide * BATCH):
        for m in range(STAGES):
            for i in range(0, wide * BATCH, BATCH):
                store(
                    scratch, here + i, load(u, column + i, zero) + _sum_of_stages(scratch, i, wide * BATCH, FIRST[m:])
                )
            _slopes(parent, table, unknown, h, scratch, here, m)
        for i in range(0, wide * BATCH, BATCH):
            z = load(u, column + i, zero) + _sum_of_stages(scratch, i, wide * BATCH, FIRST[RESULT:])
            store(un, column + i, z)
            off5 = _sum_of_stages(scratch, i, wide * BATCH, FIRST[FIVE:])
            off3 = _sum_of_stages(scratch, i, wide * BATCH, FIRST[THREE:])
            whole, five, three = whole + z * z, five + off5 * off5, three + off3 * off3
    store(squares, 0, five)
    store(squares, BATCH, three)
    store(squares, 2 * BATCH, whole)


@njit(nogil=True, fastmath=True, inner=True)
def _sum_of_stages(slopes, i, line, first):
    """Weighted sum of the slopes of row i, by the weights from ``first[0]`` up to ``first[1]``.

    A constant in place of an array would be compiled for once more: numba takes each for a type of its own.
    """
    total = spread(0.0)
    for q in range(first[0], first[1]):
        total = total + WEIGHT[q] * load(slopes, STAGE[q] * line + i, total)
    return total


@njit(nogil=True, fastmath=True, inner=True)
def _slopes(parent, table, unknown, h, scratch, here, m):
    """Slopes of stage m, times the step, from the state at ``here``."""
    n, zero = len(parent), spread(0.0)
    nu = h * load(unknown, FREQUENCY * BATCH, zero)
    out, half = m * 2 * n * BATCH, n * BATCH
    for i in range(n):
        x, t = i * BATCH, i * PER_TABLE + m * PER_ROW
        angle, rate = load(scratch, here + x, zero), load(scratch, here + half + x, zero)
        store(scratch, out + x, nu * rate)
        g, s = load(table, t + EXTRA_DAMPING * BATCH, zero), load(table, t + EXTRA_STIFFNESS * BATCH, zero)
        store(scratch, out + half + x, zero - g * rate - s * angle)
    for i in range(n):
        p, x, t, own = parent[i], i * BATCH, i * PER_TABLE + m * PER_ROW, i * PER_UNKNOWN
        kappa = load(unknown, own + STIFFNESS * BATCH, zero) * load(table, t + WAVE * BATCH, zero)
        d = load(unknown, own + DAMPING * BATCH, zero)
        angle, rate = load(scratch, here + x, zero), load(scratch, here + half + x, zero)
        mine = load(scratch, out + half + x, zero)
        if p < 0:
            store(scratch, out + half + x, mine - kappa * angle - d * rate)
            continue
        y = p * BATCH
        e, f = load(table, t + NEAR * BATCH, zero), load(table, t + NEAR_SLOPE * BATCH, zero)
        angle_p, rate_p = load(scratch, here + y, zero), load(scratch, here + half + y, zero)
        torque = kappa * (angle - e * angle_p) + d * (rate - e * rate_p - f * angle_p)
        store(scratch, out + half + x, mine - torque)
        store(scratch, out + half + y, load(scratch, out + half + y, zero) + e * torque)
    for i in range(n):
        at, over = out + half + i * BATCH, i * PER_TABLE + m * PER_ROW + OVER_MASS * BATCH
        store(scratch, at, h * load(scratch, at, zero) * load(table, over, zero))
