"""Monodromy matrices of jointed chains by steps of exponentials: Magnus's method of order 6 in compiled code.

The method is that of ``exponential_monodromy``; here the coefficients come from ``chain_tables``, sixteen lanes at a
time, and the matrices of each lane are dense, their rows padded to whole ``Row``s of numbers. Only the lower half of A
changes in time, so differences of A have no upper half, and products with them cost half.
"""

# mypy: ignore-errors
# Types are inferred by the compiler of this code, from its arguments.
from __future__ import annotations

import numpy as np

from trunnion.numerics.batch import BATCH
from trunnion.numerics.chain.batch_blocks import pick
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
    STAGES,
    STIFFNESS,
    WAVE,
    add_damping_trace,
    empty_table,
    fill,
    gather,
)
from trunnion.numerics.jit import njit
from trunnion.numerics.rows import load, spread, store

GAUSS = 0.5 + np.array([-1.0, 0.0, 1.0]) * np.sqrt(15) / 10
TOGETHER = STAGES // 3
"""Steps whose coefficients are found in one call."""
NODES = ((np.arange(TOGETHER)[:, None] + GAUSS) / TOGETHER).ravel()
WEIGHTS = np.tile([5.0, 8.0, 5.0], TOGETHER) / 18 / TOGETHER
DEGREE = 16
OVER_FACTORIALS = 1 / np.cumprod(np.concatenate([[1.0], np.arange(1.0, DEGREE + 1)]))
NORM = 0.75
"""Norm up to which the Taylor series of degree 16 is exact to rounding."""
LARGEST_NORM = 1e12
"""Steps beyond this are far too long."""
EXACT = {"contract", "nsz", "reassoc"}
"""Liberties of the compiler that leave NaN what it is."""


@njit(nogil=True)
def integrate_exponentials(program, batch, order, period, steps, matrix, trace):
    """Products of ``steps`` exponentials, a multiple of TOGETHER, over one period: matrices (lane, m, m) and traces of
    the lanes ``order``, in their places there. NaN where the steps are far too long."""
    n = len(program.parent)
    m = 2 * n
    wide = (m + BATCH - 1) // BATCH * BATCH
    size = m * wide
    products, room = np.zeros(2 * BATCH * size), np.zeros(8 * size)
    picked, block_trace = np.empty(BATCH, np.int64), np.empty(BATCH)
    length = period / steps
    for at in range(0, len(order), BATCH):
        used = pick(order, at, len(order), picked)
        block = gather(program, batch, picked)
        table = empty_table(program, block)
        products[:] = 0.0
        for l in range(used):
            block_trace[l] = 0.0
            for i in range(m):
                products[l * size + i * wide + i] = 1.0
        here, there = 0, BATCH * size
        for begin in range(0, steps, TOGETHER):
            fill(program, block, begin * length, TOGETHER * length, NODES, table)
            add_damping_trace(program.parent, block.unknown, table, WEIGHTS, TOGETHER * length, block_trace)
            for step in range(TOGETHER):
                for l in range(used):
                    _exponential_of_step(program.parent, block.unknown, table, 3 * step, l, length, m, wide, room)
                    multiply(room[:size], products[here + l * size :], products[there + l * size :], m, wide, 0, 0)
                here, there = there, here
        for l in range(used):
            own, start = matrix[at + l], here + l * size
            for i in range(m):
                for j in range(m):
                    own[i, j] = products[start + i * wide + j]
            trace[at + l] = block_trace[l]


@njit(nogil=True, fastmath=EXACT, inner=True)
def _exponential_of_step(parent, unknown, table, stage, lane, h, m, wide, room):
    """exp Ω of one step of one lane into room[:m · wide]."""
    size = m * wide
    a1, a2, a3 = room[size : 2 * size], room[2 * size : 3 * size], room[3 * size : 4 * size]
    c1, c2 = room[4 * size : 5 * size], room[5 * size : 6 * size]
    scratch, more = room[6 * size : 7 * size], room[7 * size :]
    half = m // 2
    _rates(parent, unknown, table, stage, lane, h, m, wide, a2)
    _rates(parent, unknown, table, stage + 1, lane, h, m, wide, a1)
    _rates(parent, unknown, table, stage + 2, lane, h, m, wide, a3)
    root, third = np.sqrt(15.0) / 3, 10.0 / 3
    zero, upper = spread(0.0), half * wide
    for at in range(upper, size, BATCH):
        before, middle, after = load(a2, at, zero), load(a1, at, zero), load(a3, at, zero)
        store(a2, at, root * (after - before))
        store(a3, at, third * (after + before - 2.0 * middle))
    for at in range(0, upper, BATCH):
        store(a2, at, zero)
        store(a3, at, zero)
    # C₁ = [a₁, a₂], and 2a₃ + C₁
    multiply(a1, a2, c1, m, wide, 0, half)
    multiply(a2, a1, scratch, m, wide, half, 0)
    for at in range(0, size, BATCH):
        found = load(c1, at, zero)
        if at >= upper:
            found = found - load(scratch, at, zero)
        store(c1, at, found)
        store(more, at, found + 2.0 * load(a3, at, zero))
    # a₂ + C₂ with C₂ = −[a₁, 2a₃ + C₁]/60, and C₁ − 20a₁ − a₃
    multiply(a1, more, c2, m, wide, 0, 0)
    multiply(more, a1, scratch, m, wide, 0, 0)
    for at in range(0, size, BATCH):
        store(c2, at, load(a2, at, zero) + (load(scratch, at, zero) - load(c2, at, zero)) / 60.0)
        store(more, at, load(c1, at, zero) - 20.0 * load(a1, at, zero) - load(a3, at, zero))
    multiply(more, c2, c1, m, wide, 0, 0)
    multiply(c2, more, scratch, m, wide, 0, 0)
    for at in range(0, size, BATCH):
        last = (load(c1, at, zero) - load(scratch, at, zero)) / 240.0
        store(a1, at, load(a1, at, zero) + load(a3, at, zero) / 12.0 + last)
    _exponential(m, wide, room)


@njit(nogil=True, fastmath=EXACT, inner=True)
def _rates(parent, unknown, table, stage, lane, h, m, wide, a):
    """h A at one stage of one lane; the upper half is h ν 1."""
    n, row = m // 2, stage * PER_ROW + lane
    for at in range(0, m * wide, BATCH):
        store(a, at, spread(0.0))
    for i in range(n):
        below = (n + i) * wide
        a[i * wide + n + i] = h * unknown[i * PER_UNKNOWN + FREQUENCY * BATCH + lane]
        a[below + i] -= table[i * PER_TABLE + row + EXTRA_STIFFNESS * BATCH]
        a[below + n + i] -= table[i * PER_TABLE + row + EXTRA_DAMPING * BATCH]
    for i in range(n):
        p, t, own, below = parent[i], i * PER_TABLE + row, i * PER_UNKNOWN + lane, (n + i) * wide
        kappa = unknown[own + STIFFNESS * BATCH] * table[t + WAVE * BATCH]
        d = unknown[own + DAMPING * BATCH]
        a[below + i] -= kappa
        a[below + n + i] -= d
        if p >= 0:
            e, f, above = table[t + NEAR * BATCH], table[t + NEAR_SLOPE * BATCH], (n + p) * wide
            pulled = kappa * e + d * f
            a[below + p] += pulled
            a[below + n + p] += d * e
            a[above + i] += e * kappa
            a[above + n + i] += e * d
            a[above + p] -= e * pulled
            a[above + n + p] -= e * d * e
    for i in range(n):
        over = h * table[i * PER_TABLE + row + OVER_MASS * BATCH]
        for at in range((n + i) * wide, (n + i) * wide + m):
            a[at] *= over


@njit(nogil=True, fastmath=EXACT, inner=True)
def _exponential(m, wide, room):
    """room[0] = exp room[1]: Taylor's series of the matrix over 2ˢ, squared s times."""
    size = m * wide
    x, x2, x3 = room[size : 2 * size], room[2 * size : 3 * size], room[3 * size : 4 * size]
    x4, one, other = room[4 * size : 5 * size], room[5 * size : 6 * size], room[6 * size : 7 * size]
    norm = 0.0
    for i in range(m):
        total = 0.0
        for at in range(i * wide, i * wide + m):
            total += abs(x[at])
        norm = max(norm, total) if total == total else np.inf
    if not norm < LARGEST_NORM:
        room[:size] = np.nan
        return
    squarings, share = 0, 1.0
    while norm * share > NORM:
        squarings, share = squarings + 1, share / 2
    zero = spread(0.0)
    for at in range(0, size, BATCH):
        store(x, at, share * load(x, at, zero))
    multiply(x, x, x2, m, wide, 0, 0)
    multiply(x2, x, x3, m, wide, 0, 0)
    multiply(x2, x2, x4, m, wide, 0, 0)
    for at in range(0, size, BATCH):
        store(one, at, OVER_FACTORIALS[DEGREE] * load(x4, at, zero))
    _add_block(x, x2, x3, m, wide, DEGREE - 4, one)
    for k in range(DEGREE - 8, -1, -4):
        multiply(x4, one, other, m, wide, 0, 0)
        _add_block(x, x2, x3, m, wide, k, other)
        one, other = other, one
    for _ in range(squarings):
        multiply(one, one, other, m, wide, 0, 0)
        one, other = other, one
    for at in range(0, size, BATCH):
        store(room, at, load(one, at, zero))


@njit(nogil=True, fastmath=EXACT, inner=True)
def _add_block(x, x2, x3, m, wide, k, out):
    """out += Σ x^j / (k + j)! for j from 0 to 3."""
    b, c, d, zero = OVER_FACTORIALS[k + 1], OVER_FACTORIALS[k + 2], OVER_FACTORIALS[k + 3], spread(0.0)
    for at in range(0, m * wide, BATCH):
        low = load(out, at, zero) + b * load(x, at, zero)
        store(out, at, low + c * load(x2, at, zero) + d * load(x3, at, zero))
    for i in range(m):
        out[i * wide + i] += OVER_FACTORIALS[k]


@njit(nogil=True, fastmath=EXACT, inner=True)
def multiply(a, b, out, m, wide, first, low):
    """out = a b of flat matrices (m, wide): rows from ``first`` on, where b has none in front of ``low``.

    Two rows at a time, as many as stay in registers.
    """
    zero, number = spread(0.0), 0.0
    for column in range(0, wide, BATCH):
        for i in range(first, m - 1, 2):
            upper, lower = zero, zero
            for k in range(low, m):
                right = load(b, k * wide + column, zero)
                upper = upper + load(a, i * wide + k, number) * right
                lower = lower + load(a, (i + 1) * wide + k, number) * right
            store(out, i * wide + column, upper)
            store(out, (i + 1) * wide + column, lower)
        if (m - first) % 2:
            last = zero
            for k in range(low, m):
                last = last + load(a, (m - 1) * wide + k, number) * load(b, k * wide + column, zero)
            store(out, (m - 1) * wide + column, last)
