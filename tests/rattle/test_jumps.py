"""Jumps of a sweep: told from steep slopes, in the middle and at both ends."""

from __future__ import annotations

import numpy as np
import pytest

from trunnion.motion.orbits.sweep import abrupt_changes

CASES = [
    ([1.0, 1.1, 1.2, 0.3, 0.28, 0.27], [2]),
    ([1.0, 0.3, 0.29, 0.28, 0.27], [0]),
    ([0.27, 0.28, 0.29, 0.3, 1.0], [3]),
    # Steep on a coarse grid, at one end with a small change right beside it.
    ([0.1, 0.2, 0.22, 0.45, 0.8], []),
    ([0.8, 0.45, 0.22, 0.2, 0.1], []),
    ([0.30, 0.55, 0.50, 0.36, 0.25], []),
    # The flank of a resonance beyond the end, from a sweep.
    ([2.513, 1.582, 1.297, 1.153, 1.111, 1.203], []),
    ([1.203, 1.111, 1.153, 1.297, 1.582, 2.513], []),
    ([1.0, 0.2], []),
    ([0.5], []),
]


@pytest.mark.parametrize(("swing", "places"), CASES)
def test_jumps(swing: list[float], places: list[int]) -> None:
    assert abrupt_changes(np.array(swing)) == places
