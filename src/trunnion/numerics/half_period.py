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
from numba import njit

from trunnion.numerics.chain_tables import (
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

_ENDS = np.array([0.0, 1.0])


@njit(cache=True, nogil=True)
def whole_periods(program, lanes, first, last, begin, half, phi, error, matrix):  # type: ignore[no-untyped-def]
    """Z of lanes first…last from their propagators ``phi`` over ``half``, and their errors in place."""
    n = len(program.parent)
    start, end, damping = np.empty(n), np.empty(n), np.empty(n)
    spare = np.empty((2, 2 * n, 2 * n))
    for at in range(first, last, LANES):
        block = gather(program, lanes, at)
        table = empty_table(program, block)
        fill(program, block, begin, half, _ENDS, False, table)
        for lane in range(min(LANES, last - at)):
            for i in range(n):
                start[i] = table[i * PER_TABLE + NEAR * LANES + lane]
                end[i] = table[i * PER_TABLE + PER_ROW + NEAR * LANES + lane]
                damping[i] = block.unknown[i * PER_UNKNOWN + DAMPING * LANES + lane]
            nu = block.unknown[FREQUENCY * LANES + lane]
            error[at + lane] *= whole_from_half(
                program.parent, start, end, damping, nu, phi[at + lane], spare, matrix[at + lane]
            )


@njit(cache=True, nogil=True)
def whole_from_half(parent, near_start, near_end, damping, frequency, phi, spare, z):  # type: ignore[no-untyped-def]
    """Fill ``z`` (2n, 2n) of one lane; returns the factor by which an error of φ enters it.

    near_start, near_end (n,): e_i at the ends of the half; damping (n,), frequency: that lane's d and ν;
    spare (2, 2n, 2n) is scratch. Loops are written out because temporaries cost more than the work.
    """
    n = len(parent)
    b, c = spare[0], spare[1]
    for i in range(n):
        for j in range(2 * n):
            b[i, j] = phi[n + i, j]
            b[n + i, j] = phi[i, j]
    _add_damped(parent, near_end, damping, 1.0 / frequency, phi, 0, b)
    square = 0.0
    for i in range(2 * n):
        for j in range(2 * n):
            total = 0.0
            for k in range(2 * n):
                total += phi[k, i] * b[k, j]
            c[i, j] = total
            square += phi[i, j] ** 2
    for i in range(n):
        for j in range(2 * n):
            z[i, j] = c[n + i, j]
            z[n + i, j] = c[i, j]
    for i in range(n):
        for j in range(2 * n):
            b[i, j] = 0.0
    _add_damped(parent, near_start, damping, 1.0 / frequency, c, n, b)
    weight = 0.0
    for i in range(n):
        for j in range(2 * n):
            z[n + i, j] -= b[i, j]
        weight += abs(damping[i]) * (1 + max(near_start[i] ** 2, near_end[i] ** 2)) / frequency
    return 2 * max(1.0, np.sqrt(square / (2 * n))) * (1 + weight) ** 2


@njit(cache=True, nogil=True)
def _add_damped(parent, near, damping, factor, x, row, out):  # type: ignore[no-untyped-def]
    """Add S x · factor to the first n rows of ``out``; x are the n rows of its array from ``row`` on."""
    for i in range(len(parent)):
        p, d = parent[i], damping[i] * factor
        for j in range(x.shape[1]):
            twist = x[row + i, j]
            if p >= 0:
                twist -= near[i] * x[row + p, j]
            out[i, j] += d * twist
            if p >= 0:
                out[p, j] -= near[i] * d * twist
