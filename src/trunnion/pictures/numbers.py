"""Numbers at a logarithmic axis in plain characters: 0.02, 5000, 10⁻⁶ and 2×10⁷."""

from __future__ import annotations

from math import floor, log10

RAISED = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
LEAST, MOST = 1e-3, 1e6
"""Between these a number is written out."""


def written(value: float) -> str:
    """A positive number of few digits as a reader writes it."""
    if value <= 0 or LEAST * 0.999 <= value < MOST * 0.999:
        return f"{value:.10g}"
    power = floor(log10(value) + 1e-9)
    raised = f"10{str(power).translate(RAISED)}"
    digits = f"{value / 10.0**power:.3g}"
    return raised if digits == "1" else f"{digits}×{raised}"
