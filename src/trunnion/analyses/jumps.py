"""Jumps of a swept response: changes between neighbours that those beside them do not announce."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

JUMP, ABRUPT = 0.25, 2.0
"""A change between neighbours is a jump if it is this share of the larger swing and that many times those beside."""


def abrupt_changes(swing: NDArray[np.float64]) -> list[int]:
    """Places i where a response (points,) changes abruptly from i to i + 1."""
    change = np.abs(np.diff(swing))
    around = np.pad(change, 1)
    usual = np.maximum(around[:-2], around[2:])
    abrupt = (change > JUMP * np.maximum(swing[:-1], swing[1:])) & (change > ABRUPT * usual)
    return [int(i) for i in np.flatnonzero(abrupt)]
