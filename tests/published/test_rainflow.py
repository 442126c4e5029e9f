"""Rainflow counting against the example that ASTM E1049-85 prints, section 5.4.4, figure 6."""

from __future__ import annotations

from collections import Counter

import numpy as np

from trunnion.design.fatigue.cycles import rainflow_cycles

HISTORY = [-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0]
PRINTED = {9.0: 0.5, 8.0: 1.0, 6.0: 0.5, 4.0: 1.5, 3.0: 0.5}
"""Cycle counts by range; the other ranges up to 10 have none."""


def test_the_example_of_the_standard() -> None:
    found = rainflow_cycles(np.array(HISTORY), repeats=False)
    counts: Counter[float] = Counter()
    for amplitude, count in zip(found.amplitude, found.count, strict=True):
        counts[2 * amplitude] += count
    assert counts == PRINTED
