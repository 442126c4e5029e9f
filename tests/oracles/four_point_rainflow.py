"""Rainflow counting by four points, written out: an inner range that both its neighbours hold is a cycle.

Other than ASTM's three points it asks nothing of the first point; what is left over counts by half.
"""

from __future__ import annotations

from collections import Counter


def turning(values: list[float]) -> list[float]:
    """Values at which a history turns, its ends among them."""
    values = [values[0], *(b for a, b in zip(values, values[1:], strict=False) if a != b)]
    found = [values[0]]
    for before, here, after in zip(values, values[1:], values[2:], strict=False):
        if (here - before) * (after - here) < 0:
            found.append(here)
    return [*found, values[-1]]


def four_point(values: list[float]) -> Counter[tuple[float, float]]:
    """Counts by (range, mean), both rounded to 1e-9."""
    counts: Counter[tuple[float, float]] = Counter()
    stack: list[float] = []

    def count(a: float, b: float, by: float) -> None:
        counts[round(abs(a - b), 9), round((a + b) / 2, 9)] += by

    for value in turning(values):
        stack.append(value)
        while len(stack) >= 4:
            a, b, c, d = stack[-4:]
            if not (min(a, d) <= min(b, c) and max(b, c) <= max(a, d)):
                break
            count(b, c, 1.0)
            del stack[-3:-1]
    for a, b in zip(stack, stack[1:], strict=False):
        count(a, b, 0.5)
    return counts
