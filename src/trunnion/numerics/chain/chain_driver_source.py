"""Source text of the chain kernels around one step: error control, blocks of lanes, the whole period.

The texts of this file and of ``lane_step_source`` or ``wide_step_source`` together make one module, because
the compiler caches only what stands in one file.
"""

from __future__ import annotations

from trunnion.numerics.chain.joint_series_source import joint_series_source
from trunnion.numerics.chain.lane_step_source import step_source
from trunnion.numerics.chain.series_driver_source import SERIES_DRIVER, SERIES_IMPORTS
from trunnion.numerics.chain.series_step_source import series_step_source
from trunnion.numerics.chain.wide_step_source import wide_step_source
from trunnion.numerics.integration.runge_kutta import B, C

_IMPORTS = """\
import numpy as np
from numba import njit

from trunnion.numerics.chain.chain_tables import (
    DAMPING,
    EXTRA_DAMPING,
    EXTRA_STIFFNESS,
    FREQUENCY,
    LANES,
    NEAR,
    NEAR_SLOPE,
    OVER_MASS,
    PER_ROW,
    PER_TABLE,
    PER_UNKNOWN,
    STIFFNESS,
    WAVE,
    add_damping_trace,
    empty_table,
    fill,
    gather,
)
"""

_LANES_STATE = """\
@njit(cache=True, nogil=True)
def identity_state(n):
    wide = 2 * n
    u = np.zeros(wide * wide * LANES)
    for i in range(wide):
        for l in range(LANES):
            u[(i * wide + i) * LANES + l] = 1.0
    return u


@njit(cache=True, nogil=True)
def scratch(n):
    return np.zeros(1)


@njit(cache=True, nogil=True)
def take_step(parent, table, unknown, h, u, un, spare, squares):
    step_with_error(table, unknown, h, u, un, squares)


@njit(cache=True, nogil=True)
def matrices(u, n, out):
    wide = 2 * n
    for l in range(LANES):
        for i in range(wide):
            for c in range(wide):
                out[l, i, c] = u[(c * wide + i) * LANES + l]
"""

_WIDE_STATE = """\
@njit(cache=True, nogil=True)
def identity_state(n):
    wide = 2 * n
    u = np.zeros((LANES, wide, wide))
    for l in range(LANES):
        for i in range(wide):
            u[l, i, i] = 1.0
    return u


@njit(cache=True, nogil=True)
def scratch(n):
    return np.zeros((13, 2 * n, 2 * n))


@njit(cache=True, nogil=True)
def take_step(parent, table, unknown, h, u, un, spare, squares):
    for l in range(LANES):
        squares[l], squares[LANES + l], squares[2 * LANES + l] = wide_step(
            parent, table, unknown, l, h, u[l], un[l], spare[12], spare[:12]
        )


@njit(cache=True, nogil=True)
def matrices(u, n, out):
    out[:] = u
"""

_DRIVER = """\
@njit(cache=True, nogil=True)
def propagate_block(program, block, table, begin, length, tolerance, extra, most_steps, out, error, trace):
    n = len(program.parent)
    u = identity_state(n)
    un, spare = np.empty_like(u), scratch(n)
    squares, local, largest = np.empty(3 * LANES), np.empty(LANES), np.ones(LANES)
    error[:] = 0.0
    trace[:] = 0.0
    done, count = 0.0, 0
    fastest = block.unknown[FREQUENCY * LANES : (FREQUENCY + 1) * LANES].max()
    # A step that leaps over cycles of a stiffness or a joint could find its two orders agree by accident.
    longest = length
    for cycles in program.wave_cycles:
        longest = min(longest, 1.0 / cycles)
    for cycles in program.ripple_cycles:
        longest = min(longest, 1.0 / cycles)
    h = min(length / 4, 0.8 / fastest, longest)
    while done < length and count < most_steps:
        count += 1
        if done + h > length * (1 - 1e-12):
            h = length - done
        elif done + 1.8 * h > length:
            h = (length - done) / 2
        fill(program, block, begin + done, h, C, extra, table)
        take_step(program.parent, table, block.unknown, h, u, un, spare, squares)
        worst = 0.0
        for l in range(LANES):
            # Relative to Φ where that has grown: an absolute error would ask for digits that are not there.
            grown = max(1.0, np.sqrt(squares[2 * LANES + l] / (2 * n)))
            local[l] = squares[l] / np.sqrt(squares[l] + 0.01 * squares[LANES + l] + 1e-300) / grown
            worst = max(worst, local[l]) if local[l] == local[l] else np.inf
        # No step is asked for less than its own rounding; otherwise steps would shrink for ever.
        worst = LOCAL_TO_TRUE * worst / max(tolerance * h / length, ROUNDING)
        if worst <= 1.0:
            u, un = un, u
            error += local
            for l in range(LANES):
                largest[l] = max(largest[l], np.sqrt(squares[2 * LANES + l] / (2 * n)))
            add_damping_trace(program.parent, block.unknown, table, B, h, trace)
            done = length if done + h > length * (1 - 1e-12) else done + h
        elif not worst < np.inf and h < 1e-7 * length:
            break
        h = min(h * min(3.0, max(0.1, 0.9 * (worst + 1e-30) ** (-1 / 7.0))), longest)
    if done < length:
        error[:] = np.nan
        trace[:] = np.nan
        out[:] = np.nan
    else:
        matrices(u, n, out)
        for l in range(LANES):
            norm = np.sqrt(np.sum(out[l] ** 2) / (2 * n))
            # An early error grows with Φ; one made where Φ is largest can grow by as much again.
            error[l] = (LOCAL_TO_TRUE * error[l] + ROUNDING * count) * largest[l] * max(1.0, norm)
    return count
"""

_INTEGRATE = """\
@njit(cache=True, nogil=True)
def integrate(program, lanes, order, first, last, begin, length, tolerance, extra, most_steps, matrix, error, trace):
    n = len(program.parent)
    out = np.empty((LANES, 2 * n, 2 * n))
    block_error, block_trace = np.empty(LANES), np.empty(LANES)
    picked = np.empty(LANES, np.int64)
    steps = 0
    for at in range(first, last, LANES):
        for l in range(LANES):
            picked[l] = order[min(at + l, last - 1)]
        block = gather(program, lanes, picked)
{propagate}        for l in range(min(LANES, last - at)):
            matrix[picked[l]] = out[l]
            error[picked[l]] = block_error[l]
            trace[picked[l]] = block_trace[l]
    return steps
"""


_BY_RUNGE_KUTTA = """\
        table = empty_table(program, block)
        steps += propagate_block(
            program, block, table, begin, length, tolerance, extra, most_steps, out, block_error, block_trace
        )
"""

_BY_SERIES = """\
        steps += propagate_block(program, block, begin, length, tolerance, most_steps, out, block_error, block_trace)
"""


def lane_module_source(parent: tuple[int, ...], extra: bool) -> str:
    """Whole module for a small tree of unknowns; ``extra``: as ``has_extra`` finds.

    Plain chains go by Taylor series, whose recurrences would be three times as long with the extra terms.
    """
    if extra:
        parts = [_IMPORTS, _nodes(), step_source(parent), _LANES_STATE, _DRIVER, _integrate(_BY_RUNGE_KUTTA)]
    else:
        parts = [SERIES_IMPORTS, _limits(), joint_series_source(), series_step_source(parent)]
        parts += [SERIES_DRIVER, _integrate(_BY_SERIES)]
    return "\n\n".join(parts)


def wide_module_source() -> str:
    """Whole module for trees of any number of unknowns."""
    parts = [_IMPORTS, _nodes(), wide_step_source(), _WIDE_STATE, _DRIVER, _integrate(_BY_RUNGE_KUTTA)]
    return "\n\n".join(parts)


def _integrate(propagation: str) -> str:
    return _INTEGRATE.replace("{propagate}", propagation)


def _nodes() -> str:
    # The embedded estimate is of order 5; the order-8 solution that is kept was never further off than a
    # twentieth of it on random chains (see tests/laws), so a tenth of it is reported and controlled.
    nodes, weights = [float(c) for c in C], [float(b) for b in B]
    return f"LOCAL_TO_TRUE = 0.1\n{_limits()}C = np.array({nodes!r})\nB = np.array({weights!r})\n"


def _limits() -> str:
    return "ROUNDING = 2e-15\n"
