"""What the two ways to the multipliers of a long line cost, in seconds of one core: which of them ``tree_modes`` takes.

Measured on one machine (``benchmarks/long_lines.py`` shows both); a choice of the dearer way costs time, never
accuracy.
"""

from __future__ import annotations


def by_modes(size: int, harmonics: int, left: int) -> float:
    """All modes of ``size`` unknowns by Hill's blocks of so many harmonics, ``left`` places eliminated as matrices."""
    return 0.01 + 8e-7 * size**2 * harmonics + 5.5e-9 * size * left * harmonics**3


def in_time(size: int, steps: int) -> float:
    """All states carried over a period in ``steps``, and the eigenvalues of what becomes of them."""
    return 0.02 + steps * (1.4e-3 + 5.5e-7 * size**2) + 1.4e-8 * size**3
