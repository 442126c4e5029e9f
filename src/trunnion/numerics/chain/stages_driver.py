"""Runge–Kutta integration of chains with every kind of coefficient over a stretch of input angle, with error control.

The embedded estimate is of order 5; the order-8 solution that is kept was never further off than a twentieth of it on
random chains (see tests/laws), so a tenth of it is reported and controlled.
"""

# mypy: ignore-errors
# Types are inferred by the compiler of this code, from its arguments.
from __future__ import annotations

import numpy as np

from trunnion.numerics.batch import BATCH
from trunnion.numerics.chain.batch_blocks import ROUNDING, begin_block, end_block, give_back, pick
from trunnion.numerics.chain.chain_tables import add_damping_trace, empty_table, fill, gather
from trunnion.numerics.chain.stages_step import step_by_stages
from trunnion.numerics.integration.runge_kutta import STAGES, B, C
from trunnion.numerics.jit import njit

LOCAL_TO_TRUE = 0.1


@njit(nogil=True)
def integrate_stages(program, batch, order, first, last, begin, length, tolerance, most_steps, matrix, error, trace):
    """Propagators of the lanes order[first … last − 1] over ``length`` from ``begin`` on, errors and traces; returns
    the number of steps."""
    n = len(program.parent)
    wide = 2 * n
    size = wide * wide * BATCH
    u, un, scratch = np.empty(size), np.empty(size), np.empty((STAGES + 1) * wide * BATCH)
    block_error, block_trace, picked = np.empty(BATCH), np.empty(BATCH), np.empty(BATCH, np.int64)
    steps = 0
    for at in range(first, last, BATCH):
        used = pick(order, at, last, picked)
        block = gather(program, batch, picked)
        swapped, count = _propagate(
            program, block, begin, length, tolerance, most_steps, u, un, scratch, block_error, block_trace
        )
        steps += count
        result = un if swapped else u
        give_back(result, BATCH, picked, used, block_error, block_trace, matrix, error, trace)
    return steps


@njit(nogil=True, inner=True)
def _propagate(program, block, begin, length, tolerance, most_steps, u, un, scratch, error, trace):
    """Carry the identity (column, state, lane) over the stretch: whether the result stands in ``un``, and steps."""
    table, wide = empty_table(program, block), 2 * len(program.parent)
    squares, local, largest = np.empty(3 * BATCH), np.empty(BATCH), np.ones(BATCH)
    fastest, swapped = begin_block(block.unknown, u, wide, BATCH, error, trace), False
    # A step that leaps over cycles of a stiffness or a joint could find its two orders agree by accident.
    longest = length
    for cycles in program.wave_cycles:
        longest = min(longest, 1.0 / cycles)
    for cycles in program.ripple_cycles:
        longest = min(longest, 1.0 / cycles)
    done, count, h = 0.0, 0, min(length / 4, 0.8 / fastest, longest)
    while done < length and count < most_steps:
        count += 1
        if done + h > length * (1 - 1e-12):
            h = length - done
        elif done + 1.8 * h > length:
            h = (length - done) / 2
        fill(program, block, begin + done, h, C, table)
        step_by_stages(program.parent, table, block.unknown, h, u, un, scratch, squares)
        worst = 0.0
        for l in range(BATCH):
            # Relative to Φ where that has grown: an absolute error would ask for digits that are not there.
            grown = max(1.0, np.sqrt(squares[2 * BATCH + l] / wide))
            local[l] = squares[l] / np.sqrt(squares[l] + 0.01 * squares[BATCH + l] + 1e-300) / grown
            worst = max(worst, local[l]) if local[l] == local[l] else np.inf
        # No step is asked for less than its own rounding; otherwise steps would shrink for ever.
        worst = LOCAL_TO_TRUE * worst / max(tolerance * h / length, ROUNDING)
        if worst <= 1.0:
            u, un, swapped = un, u, not swapped
            for l in range(BATCH):
                error[l] += LOCAL_TO_TRUE * local[l]
                largest[l] = max(largest[l], np.sqrt(squares[2 * BATCH + l] / wide))
            add_damping_trace(program.parent, block.unknown, table, B, h, trace)
            done = length if done + h > length * (1 - 1e-12) else done + h
        elif not worst < np.inf and h < 1e-7 * length:
            break
        h = min(h * min(3.0, max(0.1, 0.9 * (worst + 1e-30) ** (-1 / 7.0))), longest)
    end_block(u, wide, BATCH, done >= length, count, largest, error, trace)
    return swapped, count
