"""Characteristic values of Mathieu's y″ + (a − 2q cos 2x) y = 0: there the monodromy matrix has the trace ±2."""

from __future__ import annotations

from published.printed_numbers import Batch, Source
from scipy.optimize import bisect

import trunnion as tn
from trunnion.systems.reference import mathieu

SOURCES = {
    "DLMF 28": Source(
        "NIST Digital Library of Mathematical Functions, chapter 28", "values of a₀, b₁, a₁, b₂ to six decimals"
    ),
    "Zhang and Jin 1996": Source(
        "Zhang and Jin, Computation of Special Functions (1996)", "the table of its program MCVA2, nine decimals"
    ),
}
WEAK = (
    ("a₀, q = 1", "-0.455139", 1.0, 2.0), ("b₁, q = 1", "-0.110249", 1.0, -2.0), ("a₁, q = 1", "1.859108", 1.0, -2.0),
    ("b₂, q = 1", "3.917025", 1.0, 2.0), ("a₀, q = 5", "-5.800046", 5.0, 2.0), ("b₁, q = 5", "-5.790081", 5.0, -2.0),
    ("a₁, q = 5", "1.858188", 5.0, -2.0), ("b₂, q = 5", "2.099460", 5.0, 2.0),
)  # fmt: skip
STRONG = (
    ("a₃, q = 25", "12.964079444", -2.0), ("b₄, q = 25", "12.986489953", 2.0), ("a₄, q = 25", "27.805240581", 2.0),
    ("b₅, q = 25", "28.062765899", -2.0), ("a₅, q = 25", "40.050190986", -2.0), ("a₇, q = 25", "57.534689001", -2.0),
    ("b₇, q = 25", "55.002957151", -2.0), ("b₈, q = 25", "69.057988351", 2.0), ("a₁₁, q = 25", "123.643012376", -2.0),
)  # fmt: skip
"""Lower values are left out: there motions grow too far over a period for so many digits, which ``stability`` says."""


def boundary(near: float, q: float, trace: float, width: float, xtol: float, tolerance: float = 1e-10) -> float:
    """The value of a near ``near`` at which the trace is that."""

    def beyond(a: float) -> float:
        return float(tn.stability(mathieu(a, q), tolerance=tolerance).multipliers.sum().real - trace)

    return float(bisect(beyond, near - width, near + width, xtol=xtol))


BATCHES = (
    Batch(
        "DLMF 28", "characteristic values", "", {what: text for what, text, *_ in WEAK},
        lambda: [boundary(float(text), q, trace, 1e-3, 1e-9) for _, text, q, trace in WEAK],
    ),
    Batch(
        "Zhang and Jin 1996", "characteristic values", "", {what: text for what, text, _ in STRONG},
        lambda: [boundary(float(text), 25.0, trace, 1e-4, 1e-11, 1e-12) for _, text, trace in STRONG],  # 3e-4 apart
        absolute=2e-9, precision="multipliers of 1e7 lose seven of sixteen digits",
    ),
)  # fmt: skip
