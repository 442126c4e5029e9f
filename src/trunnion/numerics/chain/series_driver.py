"""Taylor integration of plain chains over a stretch of input angle, sixteen lanes at a time.

A step's length follows from its own coefficients, so none is ever taken back.
"""

# mypy: ignore-errors
# Types are inferred by the compiler of this code, from its arguments.
from __future__ import annotations

import numpy as np

from trunnion.numerics.chain.chain_tables import FREQUENCY, LANES, NEAR_SCALE, PER_UNKNOWN, gather
from trunnion.numerics.chain.joint_series import ORDER, ROWS, couplings, empty_series
from trunnion.numerics.chain.lane_blocks import give_back, pick
from trunnion.numerics.chain.rows import spread
from trunnion.numerics.chain.series_step import (
    LAST,
    PER_SPARE,
    add_damping_trace,
    begin_step,
    evaluate,
    pair_series,
)
from trunnion.numerics.jit import njit

ROUNDING = 2e-15
LONGEST, STEEPEST = 4.0, 0.7


@njit(nogil=True)
def integrate_series(program, lanes, order, first, last, begin, length, tolerance, most_steps, matrix, error, trace):
    """Propagators of the lanes order[first … last − 1] over ``length`` from ``begin`` on, errors and traces; returns
    the number of steps."""
    n = len(program.parent)
    wide = 2 * n
    w = np.empty(wide * wide * ROWS)
    block_error, block_trace, picked = np.empty(LANES), np.empty(LANES), np.empty(LANES, np.int64)
    steps = 0
    for at in range(first, last, LANES):
        used = pick(order, at, last, picked)
        block = gather(program, lanes, picked)
        steps += _propagate(program, block, begin, length, tolerance, most_steps, w, block_error, block_trace)
        give_back(w, ROWS, picked, used, block_error, block_trace, matrix, error, trace)
    return steps


@njit(nogil=True, inner=True)
def _propagate(program, block, begin, length, tolerance, most_steps, w, error, trace):
    """Carry the identity in order 0 of the series ``w`` (column, state) over the stretch."""
    parent, n = program.parent, len(program.parent)
    wide = 2 * n
    joints, start = empty_series(program)
    near, spare, squares = np.zeros(n * ROWS), np.zeros(n * PER_SPARE), np.zeros((LAST + 1) * LANES)
    sizes, bent = np.ones(3 * LANES), np.zeros(n, np.bool_)
    fastest = 0.0
    for l in range(LANES):
        error[l] = trace[l] = 0.0
        fastest = max(fastest, block.unknown[FREQUENCY * LANES + l])
        for i in range(n):
            bent[i] = parent[i] >= 0 and program.near_source[i] >= 0
            near[i * ROWS + l] = block.unknown[i * PER_UNKNOWN + NEAR_SCALE * LANES + l]
        for c in range(wide):
            for i in range(wide):
                w[(c * wide + i) * ROWS + l] = 1.0 if i == c else 0.0
    done, count = 0.0, 0
    h = min(length, 1.0 / fastest)
    while done < length and count < most_steps:
        count += 1
        if block.alike:
            couplings(program, block, 1, bent, begin + done, h, joints, start, near, 0.0)
        else:
            couplings(program, block, LANES, bent, begin + done, h, joints, start, near, spread(0.0))
        begin_step(parent, bent, near, squares)
        for c in range(0, wide, 2):
            column = c * wide * ROWS
            pair_series(parent, bent, block.unknown, near, w, column, column + wide * ROWS, spare, squares, h)
        # No step is asked for less than its own rounding; otherwise steps would shrink for ever.
        asked = max(tolerance * h / length, ROUNDING)
        s, fall = _length_of_step(squares, n, asked, sizes)
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
        for l in range(LANES):
            last, grown = sizes[l], sizes[LANES + l]
            error[l] += power * last / grown
            sizes[2 * LANES + l] = max(sizes[2 * LANES + l], grown)
        add_damping_trace(parent, bent, block.unknown, near, h, s, trace)
        evaluate(w, s)
        done = length if s == left else done + s * h
        h *= s
    reached = done >= length
    for l in range(LANES):
        square = 0.0
        for at in range(l, len(w), ROWS):
            if not reached:
                w[at] = np.nan
            square += w[at] * w[at]
        norm, largest = np.sqrt(square / wide), sizes[2 * LANES + l]
        # An early error grows with Φ; one made where Φ is largest can grow by as much again.
        error[l] = (error[l] + ROUNDING * count) * max(largest, norm) * max(1.0, norm)
        trace[l] = trace[l] if reached else np.nan
    return count


@njit(nogil=True, inner=True)
def _length_of_step(squares, n, asked, sizes):
    """The step, in units, after which the neglected terms reach ``asked`` per unit; their sizes and that of Φ are kept.

    They fall at least as fast as the last four computed ones do, two by two because even and odd orders do not
    fall in step, so that a geometric series in (fall · s)² bounds them.
    """
    fall, worst = 0.0, 0.0
    for l in range(LANES):
        last = np.sqrt(squares[2 * LANES + l] + squares[3 * LANES + l])
        before = np.sqrt(squares[l] + squares[LANES + l])
        grown = max(1.0, np.sqrt(squares[4 * LANES + l] / (2 * n)))
        sizes[l], sizes[LANES + l] = last, grown
        fall = max(fall, np.sqrt(last / (before + 1e-300)))
        worst = max(worst, last / grown) if last == last else np.inf
    if not worst < np.inf:
        return np.nan, fall
    if worst * LONGEST**ORDER < asked and fall * LONGEST < STEEPEST:
        return LONGEST, fall
    s = 1.0
    for _ in range(3):
        rest = 1.0 - min(fall * s, STEEPEST) ** 2
        s = (asked * rest / (1.5 * worst * fall * fall)) ** (1.0 / ORDER)
    return min(s, STEEPEST / fall, LONGEST), fall
