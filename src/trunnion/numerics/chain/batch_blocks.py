"""Which lanes go together in a block, how their propagators begin and end, and where they go."""

# mypy: ignore-errors
# Types are inferred by the compiler of this code, from its arguments.
from __future__ import annotations

import numpy as np

from trunnion.numerics.batch import BATCH
from trunnion.numerics.chain.chain_tables import FREQUENCY
from trunnion.numerics.jit import njit

ROUNDING = 2e-15
"""Of each step."""


@njit(nogil=True, inner=True)
def pick(order, at, last, picked):
    """The lanes order[at …] before ``last`` into ``picked`` (LANES,), the last of them again where there are too few;
    returns how many there are."""
    for l in range(BATCH):
        picked[l] = order[min(at + l, last - 1)]
    return min(BATCH, last - at)


@njit(nogil=True, inner=True)
def begin_block(unknown, propagators, wide, apart, error, trace):
    """Identities (column, state, …, lane), ``apart`` numbers from state to state, without error and trace; returns the
    largest ν."""
    fastest = 0.0
    for l in range(BATCH):
        error[l] = trace[l] = 0.0
        fastest = max(fastest, unknown[FREQUENCY * BATCH + l])
        for c in range(wide):
            for i in range(wide):
                propagators[(c * wide + i) * apart + l] = 1.0 if i == c else 0.0
    return fastest


@njit(nogil=True, inner=True)
def end_block(propagators, wide, apart, reached, steps, largest, error, trace):
    """Errors of whole propagators from the sums of those of their steps and the largest norm (lane,) on the way; NaN
    unless the end was ``reached``."""
    for l in range(BATCH):
        square = 0.0
        for at in range(l, len(propagators), apart):
            if not reached:
                propagators[at] = np.nan
            square += propagators[at] * propagators[at]
        # An early error grows with Φ; one made where Φ is largest can grow by as much again.
        norm = np.sqrt(square / wide)
        error[l] = (error[l] + ROUNDING * steps) * max(largest[l], norm) * max(1.0, norm)
        trace[l] = trace[l] if reached else np.nan


@njit(nogil=True, inner=True)
def give_back(propagators, apart, picked, used, block_error, block_trace, matrix, error, trace):
    """Propagators (column, state, …, lane) of a block, ``apart`` numbers from state to state, its errors and traces to
    the ``used`` lanes that were picked."""
    wide = matrix.shape[1]
    for l in range(used):
        own = matrix[picked[l]]
        for i in range(wide):
            for c in range(wide):
                own[i, c] = propagators[(c * wide + i) * apart + l]
        error[picked[l]] = block_error[l]
        trace[picked[l]] = block_trace[l]
