"""Taylor integration of long plain chains over a stretch of input angle, sixteen lanes at a time.

As ``series_driver``, but that the coefficients of one column alone are kept, which a processor's cache holds: of 50
unknowns those of all columns take 22 MB, and reading them takes longer than making them. So every column is carried on
at once, over a step whose length follows from the one before; one that turns out too long is taken back.
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
# Places of one unknown's numbers in the scratch of a column: twist, force, and the series of torques.
TWIST, FORCE, TORQUE = 0, BATCH, 2 * BATCH
PER_SPARE = 2 * BATCH + ROWS


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
    near, scratch, squares = np.zeros(n * ROWS), np.zeros(n * PER_SPARE), np.zeros((LAST + 1) * BATCH)
    series = np.empty(wide * ROWS)
    last, grown, largest, bent = np.empty(BATCH), np.empty(BATCH), np.ones(BATCH), np.zeros(n, np.bool_)
    fastest = begin_block(block.unknown, now, wide, BATCH, error, trace)
    for i in range(n):
        bent[i] = parent[i] >= 0 and program.near_source[i] >= 0
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
        for column in range(0, wide * wide * BATCH, wide * BATCH):
            _begin_column(now, column, wide, series)
            column_series(parent, bent, block.unknown, near, series, scratch, squares, h)
            _end_column(after, column, wide, series)
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


@njit(nogil=True, inner=True)
def _begin_column(states, column, wide, series):
    zero = spread(0.0)
    for i in range(wide):
        store(series, i * ROWS, load(states, column + i * BATCH, zero))


@njit(nogil=True, fastmath=True, error_model="numpy", inner=True)
def _end_column(states, column, wide, series):
    """Every state of a column after a step of one unit."""
    for i in range(wide):
        at = i * ROWS
        total = load(series, at + ORDER * BATCH, spread(0.0))
        for k in range(at + (ORDER - 1) * BATCH, at - 1, -BATCH):
            total = total + load(series, k, total)
        store(states, column + i * BATCH, total)


@njit(nogil=True, fastmath=True, error_model="numpy", inner=True)
def column_series(parent, bent, unknown, near, w, scratch, squares, h):
    """Coefficients of the column ``w`` (state, order), whose order 0 stands there; squares are added to."""
    n = len(parent)
    zero = spread(0.0)
    nu = h * load(unknown, FREQUENCY * BATCH, zero)
    now = 0 * n  # not a constant: numba would compile for each of them anew
    _add_squares(w, now, 2 * n, squares, LAST_SQUARE + now)
    for i in range(n):
        if parent[i] >= 0:
            e, o, p = load(near, i * ROWS, zero), i * ROWS, parent[i] * ROWS
            store(scratch, i * PER_SPARE + TWIST, load(w, o, zero) - e * load(w, p, zero))
    for k in range(ORDER):
        here, over = k * BATCH, 1.0 / (k + 1)
        for i in range(n):
            x, v, rate = i * ROWS + here + BATCH, (n + i) * ROWS + here, over * nu
            store(w, x, rate * load(w, v, zero))
            store(scratch, i * PER_SPARE + FORCE, zero)
        for i in range(n):
            p, x, own = parent[i], i * ROWS + here, i * PER_SPARE
            kappa = load(unknown, i * PER_UNKNOWN + STIFFNESS * BATCH, zero)
            d = load(unknown, i * PER_UNKNOWN + DAMPING * BATCH, zero)
            force = load(scratch, own + FORCE, zero)
            if p < 0:
                v = (n + i) * ROWS + here
                store(scratch, own + FORCE, force - kappa * load(w, x, zero) - d * load(w, v, zero))
                continue
            e = load(near, i * ROWS, zero)
            up, torque, above = p * ROWS + here + BATCH, own + TORQUE + here, p * PER_SPARE + FORCE
            q = load(w, x + BATCH, zero) - e * load(w, up, zero)
            g = load(scratch, above, zero)
            if bent[i]:
                for j in range(BATCH, here + BATCH, BATCH):
                    c = load(near, i * ROWS + j, zero)
                    q = q - c * load(w, up - j, zero)
                    g = g + c * load(scratch, torque - j, zero)
                q = q - load(near, i * ROWS + here + BATCH, zero) * load(w, up - here - BATCH, zero)
            t = kappa * load(scratch, own + TWIST, zero) + ((k + 1.0) * d / nu) * q
            store(scratch, own + TWIST, q)
            store(scratch, torque, t)
            store(scratch, own + FORCE, force - t)
            store(scratch, above, g + e * t)
        for i in range(n):
            v = (n + i) * ROWS + here + BATCH
            store(w, v, (h * over) * load(scratch, i * PER_SPARE + FORCE, zero))
        if k + LAST >= ORDER:
            _add_squares(w, here + BATCH, 2 * n, squares, (k + LAST - ORDER) * BATCH)


@njit(nogil=True, fastmath=True, error_model="numpy", inner=True)
def _add_squares(w, order, states, squares, at):
    total = load(squares, at, spread(0.0))
    for i in range(order, order + states * ROWS, ROWS):
        x = load(w, i, total)
        total = total + x * x
    store(squares, at, total)
