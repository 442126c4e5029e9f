"""Source text of the Taylor integration of a small chain: step by step over a stretch of input angle.

Together with ``series_step_source`` it makes one module, because the compiler caches only what stands in one
file. A step's length follows from its own coefficients, so none is ever taken back.
"""

from __future__ import annotations

SERIES_IMPORTS = """\
import math

import numpy as np
from numba import njit

from trunnion.numerics.chain.chain_tables import (
    COSINE,
    DAMPING,
    FREQUENCY,
    LANES,
    NEAR_SCALE,
    PER_JOINT,
    PER_UNKNOWN,
    PHASE,
    STIFFNESS,
    TURN_COS,
    TURN_SIN,
    gather,
)
"""

SERIES_DRIVER = """\
LONGEST, STEEPEST = 4.0, 0.7


@njit(cache=True, nogil=True, fastmath=True, error_model="numpy")
def all_columns(w, n, h, u):
    wide = 2 * n
    begin_step(w[:WORK], h)
    for c in range(wide):
        column = w[c * WORK : (c + 1) * WORK]
        if c > 0:
            for l in range(SHARED):
                column[l] = w[(c - 1) * WORK + l]
        for i in range(wide):
            at, o = STATE_ROW + i * ROWS, (c * wide + i) * LANES
            for l in range(LANES):
                column[at + l] = u[o + l]
        column_series(column, h)


@njit(cache=True, nogil=True)
def length_of_step(squares, n, asked, last, grown):
    # The step, in units, after which the neglected terms reach ``asked`` per unit; their sizes go to the rows.
    # They fall at least as fast as the last four computed ones do, two by two because even and odd orders do not
    # fall in step, so that a geometric series in (fall · s)² bounds them.
    fall, worst = 0.0, 0.0
    for l in range(LANES):
        last[l] = np.sqrt(squares[2 * LANES + l] + squares[3 * LANES + l])
        before = np.sqrt(squares[l] + squares[LANES + l])
        grown[l] = max(1.0, np.sqrt(squares[4 * LANES + l] / (2 * n)))
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


@njit(cache=True, nogil=True)
def propagate_block(program, block, begin, length, tolerance, most_steps, out, error, trace):
    n = len(program.parent)
    wide = 2 * n
    w, u = np.zeros(wide * WORK), np.zeros(wide * wide * LANES)
    joints, start = empty_series(program)
    last_column = (wide - 1) * WORK
    squares = w[last_column + SQUARE_ROW : last_column + SQUARE_ROW + SQUARES]
    last, grown, largest = np.empty(LANES), np.empty(LANES), np.ones(LANES)
    for i in range(wide):
        u[(i * wide + i) * LANES : (i * wide + i + 1) * LANES] = 1.0
    for c in range(wide):
        for l in range(LANES):
            at = c * WORK + l
            w[at + FREQUENCY_ROW] = block.unknown[FREQUENCY * LANES + l]
            for i in range(n):
                w[at + STIFFNESS_ROW + i * LANES] = block.unknown[i * PER_UNKNOWN + STIFFNESS * LANES + l]
                w[at + DAMPING_ROW + i * LANES] = block.unknown[i * PER_UNKNOWN + DAMPING * LANES + l]
    error[:] = 0.0
    trace[:] = 0.0
    done, count = 0.0, 0
    h = min(length, 1.0 / w[FREQUENCY_ROW : FREQUENCY_ROW + LANES].max())
    while done < length and count < most_steps:
        count += 1
        joint_series(program, block, begin + done, h, joints, start)
        for i in range(n):
            if NEAR_ROWS[i] >= 0:
                near_rows(program, block, joints, i, w[NEAR_ROWS[i] : NEAR_ROWS[i] + ROWS])
        all_columns(w, n, h, u)
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
        power = 1.5 * fall * fall * s ** (ORDER + 1) / (1.0 - min(fall * s, STEEPEST) ** 2)
        for l in range(LANES):
            error[l] += power * last[l] / grown[l]
            largest[l] = max(largest[l], grown[l])
        for i in range(n):
            add_damping_trace(w, i, h, s, trace)
        evaluate(w, wide, s, u)
        done = length if s == left else done + s * h
        h *= s
    if done < length:
        error[:] = np.nan
        trace[:] = np.nan
        out[:] = np.nan
        return count
    for l in range(LANES):
        square = 0.0
        for i in range(wide):
            for c in range(wide):
                z = u[(c * wide + i) * LANES + l]
                out[l, i, c] = z
                square += z * z
        norm = np.sqrt(square / wide)
        # An early error grows with Φ; one made where Φ is largest can grow by as much again.
        error[l] = (error[l] + ROUNDING * count) * max(largest[l], norm) * max(1.0, norm)
    return count
"""
