"""What S2 misprints, with the computed consequence."""

from __future__ import annotations

import numpy as np

from trunnion.papers.bicardan_elastic.published import PRINTED_STIFFNESS
from trunnion.papers.shared.result import ComparisonTable, TableRow, rounded
from trunnion.response.kinetostatics.measures import extremes
from trunnion.response.kinetostatics.result import Kinetostatics


def errata(elastic: Kinetostatics, rigid: Kinetostatics, worst: Kinetostatics, even: Kinetostatics) -> ComparisonTable:
    """From the printed phases with the mended stiffness, rigid, 90° off, and rigid with the phases that cancel."""
    assert elastic.constant_twist is not None
    slow, fast = rigid.speed_ratio
    twisted = extremes(np.abs(elastic.twist[1]))
    twist = 150.0 / (PRINTED_STIFFNESS * 1e-3)
    return ComparisonTable(
        "Errata",
        (
            TableRow("c₁₂", f"{PRINTED_STIFFNESS:.0f} N m/rad", "N mm/rad, inferred",
                "its tube formula with G in N/mm² and lengths in mm gives that unit: twist at 150 N m "
                f"{twist:.4g} rad; as printed {1e-3 * twist:.4g} rad"),
            TableRow("ν₁₂, β₁₂", "180°, 266.4°", "β₁₂ = ν₁₂ (mod 180°) cancels",
                f"86.4° from homokinetic, nearly the worst: ω_out/ω_in {slow:.4f} … {fast:.4f}, "
                f"irregularity {rigid.irregularity:.4f} "
                f"(90° off: {worst.irregularity:.4f}; β₁₂ = ν₁₂: {rounded(even.irregularity)})"),
            TableRow("(4)", "sin α_i1", "sin α_i", "tilts θ by the mended relation stand in the first table"),
            TableRow("(5), (6)", "ω_j1 ≈ ω_i2", "with the rate of ξ",
                f"leaving it out costs {elastic.constant_twist.speed:.1e} of the speed"),
            TableRow("(7)", "T = ξ c, ξ ≈ constant", "solved at every angle",
                f"ξ runs from {1e6 * float(twisted[0]):.1f} to {1e6 * float(twisted[1]):.1f} µrad"),
        ),
        "Relations (2) to (6) else are right and reproduced to rounding.",
    )  # fmt: skip
