"""Which lanes go together in a block, and where their results go."""

# mypy: ignore-errors
# Types are inferred by the compiler of this code, from its arguments.
from __future__ import annotations

from trunnion.numerics.chain.chain_tables import LANES
from trunnion.numerics.jit import njit


@njit(nogil=True, inner=True)
def pick(order, at, last, picked):
    """The lanes order[at …] before ``last`` into ``picked`` (LANES,), the last of them again where there are too few;
    returns how many there are."""
    for l in range(LANES):
        picked[l] = order[min(at + l, last - 1)]
    return min(LANES, last - at)


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
