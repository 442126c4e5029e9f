"""Jumps of a swept response: changes between neighbours that those beside them do not announce."""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array

JUMP, ABRUPT = 0.25, 2.0
"""A change between neighbours is a jump if it is this share of the larger swing and that many times those beside."""
STEEPENING = 4.0
"""How many times steeper the flank of a resonance may get from step to step of a coarse grid."""


def abrupt_changes(swing: Array) -> list[int]:
    """Places i where a response (points,) changes abruptly from i to i + 1."""
    change = np.abs(np.diff(swing))
    if len(change) < 3:
        return []
    # At an end both neighbours stand on one side, so that a flank which goes on beyond it looks like a jump.
    left = np.concatenate([change[2:3], change[:-2], STEEPENING * change[-2:-1]])
    right = np.concatenate([STEEPENING * change[1:2], change[2:], change[-3:-2]])
    usual = np.maximum(left, right)
    abrupt = (change > JUMP * np.maximum(swing[:-1], swing[1:])) & (change > ABRUPT * usual)
    return [int(i) for i in np.flatnonzero(abrupt)]


def jumps(values: Array, *swings: Array) -> tuple[tuple[float, float], ...]:
    """Pairs of neighbouring values (points,) between which any swing (points,) changes abruptly, in the order swept."""
    found = {i for swing in swings for i in abrupt_changes(swing)}
    return tuple((float(values[i]), float(values[i + 1])) for i in sorted(found))
