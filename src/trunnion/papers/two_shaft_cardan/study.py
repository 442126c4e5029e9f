"""S1 computed anew: Tables 1–2, Figures 2–7, errata, conclusions.

Soltan Rezaee and Ghazavi, Modares Mechanical Engineering 14 (12), 2014, 163–170.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from trunnion.floquet.charts.stability_chart import stability_chart
from trunnion.modes.natural_frequencies import natural_frequencies
from trunnion.papers.shared.drawing import charts_figure, panel
from trunnion.papers.shared.resonance_tables import Printed, frequency_rows, resonance_table
from trunnion.papers.shared.result import ComparisonTable, Reproduction, TableRow
from trunnion.papers.shared.shares import percents, share
from trunnion.papers.two_shaft_cardan.conclusions import PRACTICAL, WIDE, Charts, conclusions
from trunnion.papers.two_shaft_cardan.errata import errata, versions_figure
from trunnion.papers.two_shaft_cardan.published import (
    DAMPING_OF_SHAFT_2,
    STIFFNESS_OF_SHAFT_2,
    group_parameters,
)
from trunnion.papers.two_shaft_cardan.published import (
    two_shaft_cardan as base_case,
)
from trunnion.papers.two_shaft_cardan.twists import agreement, chart_in_twists
from trunnion.results.chart import StabilityChart

NAME = "two-shaft-cardan"
ANGLE = "HookeJoint 1.angle"
TOP = 1.5
"""Largest joint angle of the paper's figures [rad]."""
BETA = 0.5
"""Joint angle of Figures 5 and 7 [rad]; the text does not state it."""
MOST = 20.0
"""Largest ratio of Figures 5 and 7; the text does not state it, Figures 4 and 6 use it."""
BETAS = (0.3, 0.5, 0.7)
"""Joint angles [rad] at which Figures 5 and 7 are compared."""
PRINTED_ALPHA = (0.001, 0.02)
"""α of the base state as printed, and 20 times that; ζ has no number."""

TABLE_1: tuple[Printed, ...] = (
    ("subharmonic", (1,), 1, 0.072), ("subharmonic", (1,), 2, 0.024),
    ("subharmonic", (2,), 1, 1.422), ("subharmonic", (2,), 2, 0.474),
    ("harmonic", (1,), 1, 0.035), ("harmonic", (1,), 2, 0.018),
    ("harmonic", (2,), 1, 0.712), ("harmonic", (2,), 2, 0.356),
)  # fmt: skip
TABLE_2: tuple[Printed, ...] = (
    ("sum", (1, 2), 1, 0.747), ("sum", (1, 2), 2, 0.373),
    ("difference", (1, 2), 1, 0.675), ("difference", (1, 2), 2, 0.338),
)  # fmt: skip


def two_shaft_cardan(points: int, report_progress: Callable[[float], None]) -> Reproduction:
    """Reproduce S1 on ``points`` × ``points`` pixels a chart."""
    heavy = {"inertia_of_disk_2": 100.0}

    def over_angle(low: float, high: float, tolerance: float = 1e-9, **changes: Any) -> StabilityChart:
        line = base_case(**changes)
        return stability_chart(line, ("speed", low, high, points), (ANGLE, 0.0, TOP, points), tolerance=tolerance)

    slow = over_angle(0.015, 0.4, 1e-10, **heavy)
    fast = over_angle(0.25, 2.0, **heavy)
    report_progress(0.2)
    faint = tuple(over_angle(*ends, 1e-10, damping_ratio=1e-5, **heavy) for ends in ((0.015, 0.4), (0.25, 2.0)))
    report_progress(0.4)
    base, damped, stiff = (
        over_angle(0.04, 2.0),
        over_angle(0.04, 2.0, damping_of_shaft_2=20.0),
        over_angle(0.06, 2.0, stiffness_of_shaft_2=20.0),
    )
    report_progress(0.6)
    damping, stiffness = _over_group(DAMPING_OF_SHAFT_2, points), _over_group(STIFFNESS_OF_SHAFT_2, points)
    report_progress(0.65)
    low_alpha, twenty = (over_angle(0.04, 2.0, damping_of_shaft_2=alpha) for alpha in PRINTED_ALPHA)
    twists = tuple(chart_in_twists(chart, 100.0) for chart in (slow, fast))
    wide = _wide(1.0, points), _wide(20.0, points)
    report_progress(0.75)
    beta = "joint angle β [rad]"
    whole = (0.0, 2.0)
    from_zero = "Hatched: not computed, a turn there spans very many vibrations."
    figures = (
        charts_figure("2a", "β–Ω for γ = 100, α = μ = 1, ζ = 0.001: the model checked against another",
                "The paper prints the chart of its reference [17] (Bulut and Parlar 2011). In its place stand the "
                f"paper's equations in twists, mended: {agreement(twists, (slow, fast))} " + from_zero,
                panel(twists[0], "equations in twists, low speeds", beta, (0.0, 0.4)),
                panel(twists[1], "equations in twists", beta, (0.25, 2.0))),
        charts_figure("2b", "β–Ω for γ = 100, α = μ = 1, ζ = 0.001, at low and at high speed", from_zero,
                panel(slow, "γ = 100, low speeds", beta, (0.0, 0.4)), panel(fast, "γ = 100", beta, (0.25, 2.0))),
        charts_figure("3", "β–Ω, base case α = μ = γ = 1, ζ = 0.001", from_zero, panel(base, "base case", beta, whole)),
        charts_figure("4", "β–Ω with 20 times the damping of shaft 2, beside the base case", from_zero,
                panel(damped, "α = 20", beta, whole), panel(base, "α = 1 (Figure 3)", beta, whole)),
        charts_figure("5", "damping ratio α–Ω, μ = γ = 1",
                f"β = {BETA} rad (29°) and α up to {MOST:g}: the text states neither.",
                panel(damping, f"β = {BETA} rad", "damping of shaft 2 over shaft 1, α [1]", whole)),
        charts_figure("6", "β–Ω with 20 times the stiffness of shaft 2, beside the base case",
                "The text says damping here; caption, section and figure are about stiffness. " + from_zero,
                panel(stiff, "μ = 20", beta, whole), panel(base, "μ = 1 (Figure 3)", beta, whole)),
        charts_figure("7", "stiffness ratio μ–Ω, α = γ = 1",
                f"β = {BETA} rad (29°) and μ up to {MOST:g}: the text states neither.",
                panel(stiffness, f"β = {BETA} rad", "stiffness of shaft 2 over shaft 1, μ [1]", whole, name=False)),
    )  # fmt: skip
    modes = natural_frequencies(base_case(**heavy)).undamped_frequency
    note = "γ = 100, α = μ = 1. Tongues are followed at a hundredth of the damping down to β = 0."
    tables = (
        ComparisonTable(
            "Natural frequencies",
            frequency_rows("eq 26", (0.072, 1.422), modes, "equation 25 gives the computed value, its bracket mended"),
        ),
        resonance_table("Table 1, harmonic and subharmonic resonance", TABLE_1, (slow, fast), faint, note),
        resonance_table("Table 2, combination resonance", TABLE_2, (slow, fast), faint, note),
    )
    report_progress(0.8)
    evidence = (
        versions_figure(),
        charts_figure("stiffness", "β–Ω with 1 and 20 times the stiffness of shaft 2, up to 30° and Ω = 12",
                "α = γ = 1. The conclusion on stiffness is drawn over this box: the first-order tongues of μ = 20 lie "
                "between Ω = 3 and 7, outside Figure 6.",
                panel(wide[0], "μ = 1", beta, (0.0, WIDE[1])), panel(wide[1], "μ = 20", beta, (0.0, WIDE[1]))),
    )  # fmt: skip
    return Reproduction(
        NAME,
        "Two shafts and a Hooke's joint (S1)",
        "Soltan Rezaee and Ghazavi, Modares Mechanical Engineering 14 (12), 2014, 163–170",
        figures,
        tables,
        errata(),
        evidence,
        conclusions(Charts(base, damped, stiff, fast, damping, stiffness, wide, (low_alpha, twenty))),
        assumed=_assumed(base, low_alpha),
    )


def _assumed(base: StabilityChart, printed: StabilityChart) -> ComparisonTable:
    """What the text leaves open or says otherwise, and what another value changes."""
    shares = share(base), share(printed)
    differ = 100 * float(np.mean(base.verdict != printed.verdict))
    angles = [
        [share(_over_group(label, 120, beta)) for beta in BETAS] for label in (DAMPING_OF_SHAFT_2, STIFFNESS_OF_SHAFT_2)
    ]
    computed = [f"{', '.join(f'{b:g}' for b in BETAS)} rad give {percents(found)} unstable" for found in angles]
    return ComparisonTable(
        "What is assumed",
        (
            TableRow("Figures 3 to 7, ζ", "not stated", "0.001", "the value of the three-shaft study (S3)"),
            TableRow("Figures 3, 6, α", f"{PRINTED_ALPHA[0]:g}", "1",
                f"taken as ζ = 0.001, α = 1, the names exchanged; with α = {PRINTED_ALPHA[0]:g} the unstable share of "
                f"Figure 3 is {shares[1]} % for {shares[0]} %, and {differ:.2g} % of its points change"),
            TableRow("Figure 4, α", f"20 times {PRINTED_ALPHA[0]:g}", "20",
                "a reading of its own among the conclusions"),
            TableRow("Figure 5, β and largest α", "not stated", f"{BETA:g} rad, {MOST:g}", computed[0]),
            TableRow("Figure 7, β and largest μ", "not stated", f"{BETA:g} rad, {MOST:g}", computed[1]),
        ),
    )  # fmt: skip


def _over_group(label: str, points: int, angle: float = BETA) -> StabilityChart:
    line = base_case(angle=angle)
    parameter = group_parameters(line)[label]
    low = 0.0 if label == DAMPING_OF_SHAFT_2 else 0.05
    across, up = ("speed", 0.06, 2.0, points), (parameter, low, MOST, points)
    return stability_chart(line, across, up, tolerance=1e-9)


def _wide(stiffness: float, points: int) -> StabilityChart:
    """One stiffness ratio over the speeds and angles its conclusion is about."""
    line = base_case(stiffness_of_shaft_2=stiffness)
    return stability_chart(line, ("speed", *WIDE, 3 * points), (ANGLE, 0.0, PRACTICAL, points // 2), tolerance=1e-9)
