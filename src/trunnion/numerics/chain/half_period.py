"""A whole period from half of it, where every joint's ratio is even about one phase.

Write a line as x″ + Sx′ + (K + N) x = 0 with S = BᵀdB, N = BᵀdB′ (q = Bx are the twists). If every entry of
B is even about a phase, S and K are even and N is odd about it, so the motion run backwards obeys the
adjoint equation, for which ψᵀWφ is constant with W = [[S, I], [−I, 0]]. Hence, with R = diag(I, −I) and φ
the propagator over the first half,

    Z = R [[0, I], [−I, S₀]] φᵀ [[S₁, −I], [I, 0]] R φ,

S₀, S₁ at the two ends of the half. Needs constant inertia and no static torque on an angled joint (its η′T̄ is
odd). Here rates are in units of ν, so S stands as S/ν.
"""

# mypy: ignore-errors
# Types are inferred by the compiler of this code, from its arguments.
from __future__ import annotations

import math

import numpy as np

from trunnion.numerics.batch import BATCH
from trunnion.numerics.chain.batch_blocks import pick
from trunnion.numerics.chain.chain_tables import DAMPING, FREQUENCY, NEAR_SCALE, PER_UNKNOWN, gather
from trunnion.numerics.chain.joint_series import ROWS, couplings, empty_series
from trunnion.numerics.jit import njit
from trunnion.numerics.rows import load, spread, store


@njit(nogil=True)
def whole_periods(program, batch, first, last, begin, half, phi, error, matrix):
    """Z of lanes first…last from their propagators ``phi`` over ``half``, and their errors in place."""
    n = len(program.parent)
    wide = 2 * n
    size = wide * wide * BATCH
    half_phi, b, c, z = np.empty(size), np.empty(size), np.empty(size), np.empty(size)
    ends, factor, picked = np.empty(2 * n * BATCH), np.empty(BATCH), np.empty(BATCH, np.int64)
    every = np.arange(last)
    for at in range(first, last, BATCH):
        count = pick(every, at, last, picked)
        block = gather(program, batch, picked)
        _at_both_ends(program, block, begin, half, ends)
        for lane in range(BATCH):
            own = phi[picked[lane]]
            for i in range(wide):
                for j in range(wide):
                    half_phi[(i * wide + j) * BATCH + lane] = own[i, j]
        _whole_from_half(program.parent, block.unknown, ends, half_phi, b, c, z, factor)
        for lane in range(count):
            error[at + lane] *= factor[lane]
            own = matrix[at + lane]
            for i in range(wide):
                for j in range(wide):
                    own[i, j] = z[(i * wide + j) * BATCH + lane]


@njit(nogil=True, inner=True)
def _at_both_ends(program, block, begin, half, ends):
    """The couplings e (2, n, LANES) at both ends of the half: order 0 of their series."""
    parent, n = program.parent, len(program.parent)
    series, start = empty_series(program)
    near, bent = np.zeros(n * ROWS), np.zeros(n, np.bool_)
    for i in range(n):
        bent[i] = parent[i] >= 0 and program.near_source[i] >= 0
        for lane in range(BATCH):
            near[i * ROWS + lane] = block.unknown[i * PER_UNKNOWN + NEAR_SCALE * BATCH + lane]
    for end in range(2):
        couplings(program, block, BATCH, bent, begin + end * half, 0.0, series, start, near, spread(0.0))
        for i in range(n):
            for lane in range(BATCH):
                ends[(end * n + i) * BATCH + lane] = near[i * ROWS + lane]


@njit(nogil=True, inner=True)
def _whole_from_half(parent, unknown, ends, phi, b, c, z, factor):
    """Fill ``z`` (2n, 2n, lanes) of a block and the factors (lanes,) by which an error of φ enters it.

    ends: couplings e at the two ends of the half (2, n, lanes); b, c are scratch of the shape of φ and z. All flat.
    """
    n = len(parent)
    wide, zero = 2 * n, spread(0.0)
    line = wide * BATCH
    _halves_swapped(phi, n * line, b)
    top = 0 * n  # not a constant: numba would compile for each of them anew
    _add_damped(parent, unknown, ends, n * BATCH, 1.0, phi, top, b, top, line)
    square = zero
    for i in range(0, line, BATCH):
        for j in range(0, line, BATCH):
            own, total = load(phi, i * wide + j, zero), zero
            square = square + own * own
            for k in range(0, wide * line, line):
                total = total + load(phi, k + i, zero) * load(b, k + j, zero)
            store(c, i * wide + j, total)
    store(factor, 0, square)
    _halves_swapped(c, n * line, z)
    _add_damped(parent, unknown, ends, top, -1.0, c, n * line, z, n * line, line)
    for lane in range(BATCH):
        weight = 0.0
        for i in range(n):
            first, last = ends[i * BATCH + lane], ends[(n + i) * BATCH + lane]
            steepest = max(first * first, last * last)
            weight += abs(unknown[i * PER_UNKNOWN + DAMPING * BATCH + lane]) * (1 + steepest)
        weight /= unknown[FREQUENCY * BATCH + lane]
        factor[lane] = 2 * max(1.0, math.sqrt(factor[lane] / (2 * n))) * (1 + weight) * (1 + weight)


@njit(nogil=True, inner=True)
def _halves_swapped(x, half, out):
    """The upper half of the rows of ``x`` below its lower half."""
    for at in range(half):
        out[at], out[half + at] = x[half + at], x[at]


@njit(nogil=True, inner=True)
def _add_damped(parent, unknown, ends, end, sign, x, row, out, to, line):
    """Add ± S x/ν at one ``end`` of the half to n rows of ``out`` from ``to`` on; x are n rows from ``row`` on."""
    zero = spread(0.0)
    for i in range(len(parent)):
        p, e = parent[i], load(ends, end + i * BATCH, zero)
        d = sign * load(unknown, i * PER_UNKNOWN + DAMPING * BATCH, zero) / load(unknown, FREQUENCY * BATCH, zero)
        for j in range(0, line, BATCH):
            own = i * line + j
            if p >= 0:
                above = p * line + j
                pull = d * (load(x, row + own, zero) - e * load(x, row + above, zero))
                store(out, to + own, load(out, to + own, zero) + pull)
                store(out, to + above, load(out, to + above, zero) - e * pull)
            else:
                store(out, to + own, load(out, to + own, zero) + d * load(x, row + own, zero))
