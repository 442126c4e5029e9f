"""Taylor integration of long plain chains over a stretch of input angle, sixteen lanes at a time.

As ``series_driver``, but one column after the other is carried over the step, whose length follows from the step
before; one that turns out too long is taken back. Each order of a column's series needs the order before alone, and is
added to the state at the step's end at once: only what the series of a joint's coupling multiplies is kept of all
orders. So what a column needs lies in a processor's first caches: of 50 unknowns whole series take 220 KB a column and
22 MB in all, and reading them takes many times as long as making them.
"""

# mypy: ignore-errors
# Types are inferred by the compiler of this code, from its arguments.
from __future__ import annotations

import numpy as np

from trunnion.numerics.batch import BATCH
from trunnion.numerics.chain.batch_blocks import ROUNDING, begin_block, end_block, give_back, pick
from trunnion.numerics.chain.chain_tables import DAMPING, FREQUENCY, NEAR_SCALE, PER_UNKNOWN, STIFFNESS, gather
from trunnion.numerics.chain.joint_series import ORDER, ROWS, couplings, empty_series
from trunnion.numerics.chain.series_driver import STEEPEST, length_of_step
from trunnion.numerics.chain.series_step import LAST, LAST_SQUARE, add_damping_trace, begin_step
from trunnion.numerics.jit import njit
from trunnion.numerics.rows import load, spread, store

LEAST_STEP, NEXT_STEP = 0.93, 0.98
"""A step is taken back where less than this share of it was right, and the next is a little shorter than it may be."""
# Places of one unknown's numbers of a step, of its scratch in a column, and of the series that are kept.
KAPPA, SLOW, NEAR, PER_NUMBERS = 0, BATCH, 2 * BATCH, 3 * BATCH
ANGLE, TWIST, FORCE, PER_SPARE = 0, BATCH, 2 * BATCH, 3 * BATCH
ANGLES, TORQUES, PER_KEPT = 0, ROWS, 2 * ROWS


@njit(nogil=True)
def integrate_long_series(
    program, batch, order, first, last, begin, length, tolerance, most_steps, matrix, error, trace
):
    """See ``series_driver.integrate_series``."""
    n = len(program.parent)
    wide = 2 * n
    now, after = np.empty(wide * wide * BATCH), np.empty(wide * wide * BATCH)
    block_error, block_trace, picked = np.empty(BATCH), np.empty(BATCH), np.empty(BATCH, np.int64)
    steps = 0
    for at in range(first, last, BATCH):
        used = pick(order, at, last, picked)
        block = gather(program, batch, picked)
        steps += _propagate(program, block, begin, length, tolerance, most_steps, now, after, block_error, block_trace)
        give_back(now, BATCH, picked, used, block_error, block_trace, matrix, error, trace)
    return steps


@njit(nogil=True, inner=True)
def _propagate(program, block, begin, length, tolerance, most_steps, now, after, error, trace):
    """Carry the identity over the stretch; ``now`` (column, state) is what it has become."""
    parent, n = program.parent, len(program.parent)
    wide = 2 * n
    joints, start = empty_series(program)
    near, squares = np.zeros(n * ROWS), np.zeros((LAST + 1) * BATCH)
    numbers, scratch, kept = np.zeros(n * PER_NUMBERS), np.zeros(n * PER_SPARE), np.zeros(n * PER_KEPT)
    last, grown, largest = np.empty(BATCH), np.empty(BATCH), np.ones(BATCH)
    bent, felt = np.zeros(n, np.bool_), np.zeros(n, np.bool_)
    fastest = begin_block(block.unknown, now, wide, BATCH, error, trace)
    for i in range(n):
        bent[i] = parent[i] >= 0 and program.near_source[i] >= 0
        if bent[i]:
            felt[parent[i]] = True
        for l in range(BATCH):
            near[i * ROWS + l] = block.unknown[i * PER_UNKNOWN + NEAR_SCALE * BATCH + l]
    done, count = 0.0, 0
    h = min(length, 1.0 / fastest)
    while done < length and count < most_steps:
        count += 1
        left = length - done
        if h >= left * (1 - 1e-12):
            h = left
        elif 2 * h > left:
            h = left / 2
        if block.alike:
            couplings(program, block, 1, bent, begin + done, h, joints, start, near, 0.0)
        else:
            couplings(program, block, BATCH, bent, begin + done, h, joints, start, near, spread(0.0))
        begin_step(parent, bent, near, squares)
        _numbers_of_step(block.unknown, near, h, numbers)
        nu = block.unknown[FREQUENCY * BATCH : (FREQUENCY + 1) * BATCH]
        for column in range(0, wide * wide * BATCH, wide * BATCH):
            _carry_column(parent, bent, felt, numbers, nu, near, now, after, column, scratch, kept, squares, h)
        # No step is asked for less than its own rounding; otherwise steps would shrink for ever.
        s, fall = length_of_step(squares, n, max(tolerance * h / length, ROUNDING), last, grown)
        if not s >= LEAST_STEP:
            h *= NEXT_STEP * s if s == s else 0.1
            if h < 1e-7 * length:
                break
            continue
        rest = 1.0 - min(fall, STEEPEST) ** 2
        power = 1.5 * fall * fall / rest
        for l in range(BATCH):
            error[l] += power * last[l] / grown[l]
            largest[l] = max(largest[l], grown[l])
        add_damping_trace(parent, bent, block.unknown, near, h, 1.0, trace)
        now[:] = after
        done = length if h == left else done + h
        h *= NEXT_STEP * s
    end_block(now, wide, BATCH, done >= length, count, largest, error, trace)
    return count


@njit(nogil=True, fastmath=True, error_model="numpy", inner=True)
def _numbers_of_step(unknown, near, h, numbers):
    """What all columns share of every unknown side by side: κ, d/hν and the coupling at the step's begin."""
    zero = spread(0.0)
    nu = h * load(unknown, FREQUENCY * BATCH, zero)
    for i in range(len(numbers) // PER_NUMBERS):
        own, to = i * PER_UNKNOWN, i * PER_NUMBERS
        store(numbers, to + KAPPA, load(unknown, own + STIFFNESS * BATCH, zero))
        store(numbers, to + SLOW, load(unknown, own + DAMPING * BATCH, zero) / nu)
        store(numbers, to + NEAR, load(near, i * ROWS, zero))


@njit(nogil=True, fastmath=True, error_model="numpy", inner=True)
def _carry_column(parent, bent, felt, numbers, nu, near, now, after, column, scratch, kept, squares, h):
    """The column of ``now`` that stands at ``column``, after a step of one unit, into ``after``; squares are added to.

    Every order walks along the unknowns once, from the root: the rate of an unknown follows from the force that the
    order before left on it, in whose place the next one is summed. ``felt``: unknowns whose angles a coupling takes.
    """
    n = len(parent)
    zero = spread(0.0)
    rates = column + n * BATCH
    unit = h * load(nu, 0 * n, zero)
    square = load(squares, LAST_SQUARE + 0 * n, zero)
    for i in range(n):
        own, x, v = i * PER_SPARE, load(now, column + i * BATCH, zero), load(now, rates + i * BATCH, zero)
        square = square + x * x + v * v
        store(scratch, own + ANGLE, x)
        store(scratch, own + FORCE, v)
        store(after, column + i * BATCH, zero)
        store(after, rates + i * BATCH, zero)
        if felt[i]:
            store(kept, i * PER_KEPT + ANGLES, x)
        if parent[i] >= 0:
            x = x - load(numbers, i * PER_NUMBERS + NEAR, zero) * load(scratch, parent[i] * PER_SPARE + ANGLE, zero)
        store(scratch, own + TWIST, x)
    store(squares, LAST_SQUARE + 0 * n, square)
    turned = 1.0
    for k in range(ORDER):
        here, growing, rate = k * BATCH, k + 1.0, unit * (1.0 / (k + 1))
        summed = 1.0 if k else 0.0
        for i in range(n):
            own, number, p, to = i * PER_SPARE, i * PER_NUMBERS, parent[i], column + i * BATCH
            v = turned * load(scratch, own + FORCE, zero)
            x = rate * v
            store(after, rates + i * BATCH, load(after, rates + i * BATCH, zero) + summed * v)
            store(after, to, load(after, to, zero) + x)
            store(scratch, own + ANGLE, x)
            if felt[i]:
                store(kept, i * PER_KEPT + ANGLES + here + BATCH, x)
            kappa, slow = load(numbers, number + KAPPA, zero), growing * load(numbers, number + SLOW, zero)
            before = load(scratch, own + TWIST, zero)
            if p < 0:
                store(scratch, own + TWIST, x)
                store(scratch, own + FORCE, zero - kappa * before - slow * x)
                continue
            e, above, up, torque = load(numbers, number + NEAR, zero), p * PER_SPARE, p * PER_KEPT, i * PER_KEPT
            q = x - e * load(scratch, above + ANGLE, zero)
            if bent[i]:
                for j in range(BATCH, here + 2 * BATCH, BATCH):
                    q = q - load(near, i * ROWS + j, zero) * load(kept, up + ANGLES + here + BATCH - j, zero)
            t = kappa * before + slow * q
            g = load(scratch, above + FORCE, zero) + e * t
            if bent[i]:
                store(kept, torque + TORQUES + here, t)
                for j in range(BATCH, here + BATCH, BATCH):
                    g = g + load(near, i * ROWS + j, zero) * load(kept, torque + TORQUES + here - j, zero)
            store(scratch, own + TWIST, q)
            store(scratch, own + FORCE, zero - t)
            store(scratch, above + FORCE, g)
        turned = h / growing
        if k + LAST >= ORDER:
            _add_squares(scratch, n, turned, squares, (k + LAST - ORDER) * BATCH)
    for i in range(n):
        a, b = column + i * BATCH, rates + i * BATCH
        v = load(after, b, zero) + turned * load(scratch, i * PER_SPARE + FORCE, zero)
        store(after, a, load(now, a, zero) + load(after, a, zero))
        store(after, b, load(now, b, zero) + v)


@njit(nogil=True, fastmath=True, error_model="numpy", inner=True)
def _add_squares(scratch, n, turned, squares, at):
    """Those of the order that a walk has come to."""
    total = load(squares, at, spread(0.0))
    for own in range(0, n * PER_SPARE, PER_SPARE):
        x, v = load(scratch, own + ANGLE, total), turned * load(scratch, own + FORCE, total)
        total = total + x * x + v * v
    store(squares, at, total)
