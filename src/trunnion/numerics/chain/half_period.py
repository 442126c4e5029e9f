"""A whole period from half of it, where every joint's ratio is even about one phase.

Write a line as x″ + Sx′ + (K + N) x = 0 with S = BᵀdB, N = BᵀdB′ (q = Bx are the twists). If every entry of
B is even about a phase, S and K are even and N is odd about it, so the motion run backwards obeys the
adjoint equation, for which ψᵀWφ is constant with W = [[S, I], [−I, 0]]. Hence, with R = diag(I, −I) and φ
the propagator over the first half,

    Z = R [[0, I], [−I, S₀]] φᵀ [[S₁, −I], [I, 0]] R φ,

S₀, S₁ at the two ends of the half. Needs constant inertia and no static torque on a bent joint (its η′T̄ is
odd). Here rates are in units of ν, so S stands as S/ν.
"""

from __future__ import annotations

import numpy as np

from trunnion.numerics.chain.chain_tables import (
    DAMPING,
    FREQUENCY,
    LANES,
    NEAR,
    PER_ROW,
    PER_TABLE,
    PER_UNKNOWN,
    empty_table,
    fill,
    gather,
)
from trunnion.numerics.jit import njit

_ENDS = np.array([0.0, 1.0])


@njit(cache=True, nogil=True)
def whole_periods(program, lanes, first, last, begin, half, phi, error, matrix):  # type: ignore[no-untyped-def]
    """Z of lanes first…last from their propagators ``phi`` over ``half``, and their errors in place."""
    n = len(program.parent)
    wide = 2 * n
    half_phi, z = np.empty((wide, wide, LANES)), np.empty((wide, wide, LANES))
    spare, factor = np.empty((2, wide, wide, LANES)), np.empty(LANES)
    picked = np.empty(LANES, np.int64)
    for at in range(first, last, LANES):
        count = min(LANES, last - at)
        for lane in range(LANES):
            picked[lane] = at + min(lane, count - 1)
        block = gather(program, lanes, picked)
        table = empty_table(program, block)
        fill(program, block, begin, half, _ENDS, False, table)
        for lane in range(LANES):
            own = phi[picked[lane]]
            for i in range(2 * n):
                for j in range(2 * n):
                    half_phi[i, j, lane] = own[i, j]
        _whole_from_half(program.parent, block.unknown, table, half_phi, spare, z, factor)
        for lane in range(count):
            error[at + lane] *= factor[lane]
            own = matrix[at + lane]
            for i in range(2 * n):
                for j in range(2 * n):
                    own[i, j] = z[i, j, lane]


@njit(cache=True, nogil=True)
def _whole_from_half(parent, unknown, table, phi, spare, z, factor):  # type: ignore[no-untyped-def]
    """Fill ``z`` (2n, 2n, lanes) of a block and the factors (lanes,) by which an error of φ enters it.

    table: coefficients at the two ends of the half; spare (2, 2n, 2n, lanes) is scratch. The loops over lanes are
    innermost so that the compiler can do them side by side.
    """
    n = len(parent)
    b, c = spare[0], spare[1]
    b[:n], b[n:] = phi[n:], phi[:n]
    _add_damped(parent, unknown, table, 1, 1.0, phi, 0, b, 0)
    factor[:] = 0.0
    for i in range(2 * n):
        for j in range(2 * n):
            for lane in range(LANES):
                factor[lane] += phi[i, j, lane] ** 2
                c[i, j, lane] = 0.0
            for k in range(2 * n):
                for lane in range(LANES):
                    c[i, j, lane] += phi[k, i, lane] * b[k, j, lane]
    z[:n], z[n:] = c[n:], c[:n]
    _add_damped(parent, unknown, table, 0, -1.0, c, n, z, n)
    for lane in range(LANES):
        weight = 0.0
        for i in range(n):
            o = i * PER_TABLE + NEAR * LANES + lane
            steepest = max(table[o] ** 2, table[o + PER_ROW] ** 2)
            weight += abs(unknown[i * PER_UNKNOWN + DAMPING * LANES + lane]) * (1 + steepest)
        weight /= unknown[FREQUENCY * LANES + lane]
        factor[lane] = 2 * max(1.0, np.sqrt(factor[lane] / (2 * n))) * (1 + weight) ** 2


@njit(cache=True, nogil=True)
def _add_damped(parent, unknown, table, end, sign, x, row, out, to):  # type: ignore[no-untyped-def]
    """Add ± S x/ν at one ``end`` of the half to n rows of ``out`` from ``to`` on; x are n rows from ``row`` on."""
    for i in range(len(parent)):
        p, near, own = parent[i], i * PER_TABLE + end * PER_ROW + NEAR * LANES, i * PER_UNKNOWN + DAMPING * LANES
        for j in range(x.shape[1]):
            for lane in range(LANES):
                d = sign * unknown[own + lane] / unknown[FREQUENCY * LANES + lane]
                if p >= 0:
                    twist = x[row + i, j, lane] - table[near + lane] * x[row + p, j, lane]
                    out[to + i, j, lane] += d * twist
                    out[to + p, j, lane] -= table[near + lane] * d * twist
                else:
                    out[to + i, j, lane] += d * x[row + i, j, lane]
