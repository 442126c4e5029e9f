"""Jumps of a swept response: changes between neighbours that those beside them do not announce."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

JUMP, ABRUPT = 0.25, 2.0
"""A change between neighbours is a jump if it is this share of the larger swing and that many times those beside."""


def abrupt_changes(swing: NDArray[np.float64]) -> list[int]:
    """Places i where a response (points,) changes abruptly from i to i + 1."""
    change = np.abs(np.diff(swing))
    if len(change) < 3:
        return []
    # At an end both neighbours stand on one side: a single small one says little about what is usual.
    left, right = np.concatenate([change[2:3], change[:-1]]), np.concatenate([change[1:], change[-3:-2]])
    usual = np.maximum(left, right)
    abrupt = (change > JUMP * np.maximum(swing[:-1], swing[1:])) & (change > ABRUPT * usual)
    return [int(i) for i in np.flatnonzero(abrupt)]
