"""S3 computed anew: Tables 1–2, Figures 2–6 with the forks in line beside them, errata, conclusions.

Soltan Rezaee and co-authors, the three-shaft study in Modares Mechanical Engineering 12 (6), March 2013.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from trunnion.floquet.charts.stability_chart import stability_chart
from trunnion.modes.natural_frequencies import natural_frequencies
from trunnion.papers.shared.drawing import charts_figure, panel
from trunnion.papers.shared.resonance_tables import Printed, frequency_rows, resonance_table
from trunnion.papers.shared.result import ComparisonTable, Reproduction, TableRow
from trunnion.papers.shared.shares import share
from trunnion.papers.three_shaft_cardan.conclusions import PRACTICAL, conclusions
from trunnion.papers.three_shaft_cardan.errata import errata
from trunnion.papers.three_shaft_cardan.published import three_shaft_cardan as base_case
from trunnion.papers.two_shaft_cardan.published import two_shaft_cardan
from trunnion.results.chart import StabilityChart

NAME = "three-shaft-cardan"
ANGLE = "HookeJoint 2.angle"
TOP = 1.5
"""Largest joint angle drawn [rad]; the text does not state it."""
LOW, HIGH = 0.04, 2.0

CAPTIONS = {
    "4": "Angle of the second joint and speed",
    "5": "Inertia ratio: as Figure 4 with ten times the third disk",
    "6": "Angle of the first joint: as Figure 4 with twice β₁",
}

TABLE_1: tuple[Printed, ...] = (
    ("subharmonic", (1,), 1, 0.178), ("subharmonic", (1,), 2, 0.059),
    ("subharmonic", (2,), 1, 1.025), ("subharmonic", (2,), 2, 0.342),
    ("subharmonic", (3,), 1, 1.737), ("subharmonic", (3,), 2, 0.579),
    ("harmonic", (1,), 1, 0.089), ("harmonic", (1,), 2, 0.045),
    ("harmonic", (2,), 1, 0.513), ("harmonic", (2,), 2, 0.256),
    ("harmonic", (3,), 1, 0.869), ("harmonic", (3,), 2, 0.434),
)  # fmt: skip
TABLE_2: tuple[Printed, ...] = (
    ("sum", (1, 2), 1, 0.602), ("sum", (1, 2), 2, 0.301),
    ("sum", (2, 3), 1, 1.381), ("sum", (2, 3), 2, 0.691),
    ("sum", (1, 3), 1, 0.958), ("sum", (1, 3), 2, 0.479),
    ("difference", (1, 2), 1, 0.424), ("difference", (1, 2), 2, 0.212),
    ("difference", (2, 3), 1, 0.356), ("difference", (2, 3), 2, 0.178),
    ("difference", (1, 3), 1, 0.780), ("difference", (1, 3), 2, 0.390),
)  # fmt: skip


def three_shaft_cardan(points: int, report_progress: Callable[[float], None]) -> Reproduction:
    """Reproduce S3 on ``points`` × ``points`` pixels a chart."""

    def chart(tolerance: float = 1e-9, ends: tuple[float, float] = (LOW, HIGH), **changes: Any) -> StabilityChart:
        line = base_case(**changes)
        return stability_chart(line, ("speed", *ends, points), (ANGLE, 0.0, TOP, points), tolerance=tolerance)

    plane_line = two_shaft_cardan(inertia_of_disk_2=10.0)
    plane = stability_chart(
        plane_line, ("speed", LOW, HIGH, points), ("HookeJoint 1.angle", 0.0, TOP, points), tolerance=1e-9
    )
    alone = chart(angle_1=0.0)
    parts = (((LOW, 0.2), 1e-9), ((0.15, HIGH), 1e-10))
    faint = tuple(chart(tolerance, ends, angle_1=0.0, damping_ratio=1e-5) for ends, tolerance in parts)
    report_progress(0.4)
    cases = {"4": (0.2, 10.0), "5": (0.2, 100.0), "6": (0.4, 10.0)}
    worst = {n: chart(angle_1=b, inertia_of_disk_3=g) for n, (b, g) in cases.items()}
    report_progress(0.65)
    inline = {n: chart(angle_1=b, inertia_of_disk_3=g, fork_offset=0.0) for n, (b, g) in cases.items()}
    report_progress(0.85)
    two, limits = "joint angle β₂ [rad]", (0.0, HIGH)
    beside = (
        "Left as the paper has it, both joints in phase (forks of shaft 2 at 90°); right, which the paper does not "
        "show, the forks in line as one would assemble them. Ranges assumed: 0–2 and 0–1.5 rad."
    )
    figures = [
        charts_figure("2", "Validation: one joint (β₂ = 0, third shaft left out), γ₁ = 10",
                "The two-shaft line; ranges assumed.",
                panel(plane, "two shafts, γ₁ = 10", "joint angle β₁ [rad]", limits)),
        charts_figure("3", "Check of the three-shaft model against its resonance speeds, γ₂ = 10",
                "β₁ = 0 assumed, as for the natural frequencies that the paper compares it with.",
                panel(alone, "β₁ = 0, γ₂ = 10", two, limits)),
    ]  # fmt: skip
    for n, (beta, gamma) in cases.items():
        panels = (
            panel(worst[n], f"β₁ = {beta} rad, γ₂ = {gamma:g}, joints in phase", two, limits),
            panel(inline[n], f"β₁ = {beta} rad, γ₂ = {gamma:g}, forks in line", two, limits),
        )
        figures.append(charts_figure(n, f"{CAPTIONS[n]}, γ₂ = {gamma:g} and β₁ = {beta} rad", beside, *panels))
    modes = natural_frequencies(base_case()).undamped_frequency
    note = "γ₂ = 10, α = μ = γ₁ = 1, β₁ = 0. Tongues are followed at a hundredth of the damping down to β₂ = 0."
    tables = (
        ComparisonTable("Natural frequencies", frequency_rows("eq 20", (0.178, 1.025, 1.737), modes, "rounded")),
        resonance_table("Table 1, harmonic and subharmonic resonance", TABLE_1, (alone,), faint, note),
        resonance_table("Table 2, combination resonance", TABLE_2, (alone,), faint, note),
    )
    return Reproduction(
        NAME,
        "Three shafts and two Hooke's joints (S3)",
        "Soltan Rezaee and co-authors, Modares Mechanical Engineering 12 (6), March 2013 (in Persian)",
        tuple(figures),
        tables,
        errata(),
        (),
        conclusions(worst["4"], worst["5"], worst["6"], inline),
        assumed=_assumed(alone, worst["4"], inline["4"]),
    )


def _assumed(alone: StabilityChart, four: StabilityChart, inline: StabilityChart) -> ComparisonTable:
    """What the text leaves open, and what another value changes."""
    practical = (0.0, PRACTICAL)
    shares = [share(c, y=practical) for c in (alone, four, inline)]
    drawn = share(four)
    return ComparisonTable(
        "What is assumed",
        (
            TableRow("Figures 2 to 6, range of speeds", "pictures without numbers", f"{LOW:g} to {HIGH:g}",
                "conclusions are judged below and above Ω = 1 and together"),
            TableRow("Figures 2 to 6, range of angles", "pictures without numbers", f"0 to {TOP:g} rad",
                f"Figure 4 up to 45°: {shares[1]} % unstable, as drawn {drawn} %"),
            TableRow("Figure 3, β₁", "not stated", "0, as for equation 20",
                f"up to 45°: {shares[0]} % unstable, with β₁ = 0.2 rad (Figure 4) {shares[1]} %"),
            TableRow("Figure 2, ζ, α₁, μ₁, γ₁", "0.001, 1, 1, 10", "as stated", "the line of S1 with its γ = 10"),
            TableRow("forks of shaft 2", "by (7), η₂ in phase with η₁", "90° from one another",
                f"forks in line: {shares[2]} % of Figure 4 up to 45° for {shares[1]} %"),
        ),
    )  # fmt: skip
