"""Taylor integration of plain chains over a stretch of input angle, sixteen lanes at a time.

A step's length follows from its own coefficients, so none is ever taken back.
"""

# mypy: ignore-errors
# Types are inferred by the compiler of this code, from its arguments.
from __future__ import annotations

import numpy as np

from trunnion.numerics.batch import BATCH
from trunnion.numerics.chain.batch_blocks import ROUNDING, begin_block, end_block, give_back, pick
from trunnion.numerics.chain.chain_tables import NEAR_SCALE, PER_UNKNOWN, gather
from trunnion.numerics.chain.joint_series import ORDER, ROWS, couplings, empty_series
from trunnion.numerics.chain.series_step import (
    LAST,
    PER_SPARE,
    add_damping_trace,
    begin_step,
    evaluate,
    pair_series,
)
from trunnion.numerics.jit import njit
from trunnion.numerics.rows import spread

LONGEST, STEEPEST = 4.0, 0.7


@njit(nogil=True)
def integrate_series(program, batch, order, first, last, begin, length, tolerance, most_steps, matrix, error, trace):
    """Propagators of the lanes order[first … last − 1] over ``length`` from ``begin`` on, errors and traces; returns
    the number of steps."""
    n = len(program.parent)
    wide = 2 * n
    w = np.empty(wide * wide * ROWS)
    block_error, block_trace, picked = np.empty(BATCH), np.empty(BATCH), np.empty(BATCH, np.int64)
    steps = 0
    for at in range(first, last, BATCH):
        used = pick(order, at, last, picked)
        block = gather(program, batch, picked)
        steps += _propagate(program, block, begin, length, tolerance, most_steps, w, block_error, block_trace)
        give_back(w, ROWS, picked, used, block_error, block_trace, matrix, error, trace)
    return steps


@njit(nogil=True, inner=True)
def _propagate(program, block, begin, length, tolerance, most_steps, w, error, trace):
    """Carry the identity in order 0 of the series ``w`` (column, state) over the stretch."""
    parent, n = program.parent, len(program.parent)
    wide = 2 * n
    joints, start = empty_series(program)
    near, scratch, squares = np.zeros(n * ROWS), np.zeros(n * PER_SPARE), np.zeros((LAST + 1) * BATCH)
    last, grown, largest, bent = np.empty(BATCH), np.empty(BATCH), np.ones(BATCH), np.zeros(n, np.bool_)
    fastest = begin_block(block.unknown, w, wide, ROWS, error, trace)
    for i in range(n):
        bent[i] = parent[i] >= 0 and program.near_source[i] >= 0
        for l in range(BATCH):
            near[i * ROWS + l] = block.unknown[i * PER_UNKNOWN + NEAR_SCALE * BATCH + l]
    done, count = 0.0, 0
    h = min(length, 1.0 / fastest)
    while done < length and count < most_steps:
        count += 1
        if block.alike:
            couplings(program, block, 1, bent, begin + done, h, joints, start, near, 0.0)
        else:
            couplings(program, block, BATCH, bent, begin + done, h, joints, start, near, spread(0.0))
        begin_step(parent, bent, near, squares)
        for c in range(0, wide, 2):
            column = c * wide * ROWS
            pair_series(parent, bent, block.unknown, near, w, column, column + wide * ROWS, scratch, squares, h)
        # No step is asked for less than its own rounding; otherwise steps would shrink for ever.
        asked = max(tolerance * h / length, ROUNDING)
        s, fall = length_of_step(squares, n, asked, last, grown)
        if not s == s:
            h *= 0.1
            if h < 1e-7 * length:
                break
            continue
        left = (length - done) / h
        if s >= left * (1 - 1e-12):
            s = left
        elif 2 * s > left:
            s = left / 2
        rest = 1.0 - min(fall * s, STEEPEST) ** 2
        power = 1.5 * fall * fall * s ** (ORDER + 1) / rest
        for l in range(BATCH):
            error[l] += power * last[l] / grown[l]
            largest[l] = max(largest[l], grown[l])
        add_damping_trace(parent, bent, block.unknown, near, h, s, trace)
        evaluate(w, s)
        done = length if s == left else done + s * h
        h *= s
    end_block(w, wide, ROWS, done >= length, count, largest, error, trace)
    return count


@njit(nogil=True, inner=True)
def length_of_step(squares, n, asked, last, grown):
    """The step, in units, after which the neglected terms reach ``asked`` per unit; their sizes and that of Φ are kept.

    They fall at least as fast as the last four computed ones do, two by two because even and odd orders do not
    fall in step, so that a geometric series in (fall · s)² bounds them.
    """
    fall, worst = 0.0, 0.0
    for l in range(BATCH):
        last[l] = np.sqrt(squares[2 * BATCH + l] + squares[3 * BATCH + l])
        before = np.sqrt(squares[l] + squares[BATCH + l])
        grown[l] = max(1.0, np.sqrt(squares[4 * BATCH + l] / (2 * n)))
        fall = max(fall, np.sqrt(last[l] / (before + 1e-300)))
        worst = max(worst, last[l] / grown[l]) if last[l] == last[l] else np.inf
    if not worst < np.inf:
        return np.nan, fall
    if worst * LONGEST**ORDER < asked and fall * LONGEST < STEEPEST:
        return LONGEST, fall
    s = 1.0
    for _ in range(3):
        rest = 1.0 - min(fall * s, STEEPEST) ** 2
        s = (asked * rest / (1.5 * worst * fall * fall)) ** (1.0 / ORDER)
    return min(s, STEEPEST / fall, LONGEST), fall
