"""S4 computed anew: frequencies, motions, exponents by the standard definition, maps, and its claims of chaos.

Bugaru and Vasile, Applied Sciences 12 (2022) 6182, "A new robust method to investigate dynamic instability of FTV
for the double tripod industrial driveshafts in the principal parametric resonance region".
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from trunnion.motion.simulation.simulation import SystemSimulation
from trunnion.papers.double_tripod import figures as drawn
from trunnion.papers.double_tripod.computed import (
    BELOW,
    RANGES,
    ElementCase,
    cases,
    exponents_at_resonance,
    floquet_exponents,
    opening_depth,
    sweep_of,
)
from trunnion.papers.double_tripod.conclusions import PARTS, START, conclusions, dampings, refuted
from trunnion.papers.double_tripod.contraction import argument, contraction
from trunnion.papers.double_tripod.errata import errata
from trunnion.papers.double_tripod.published import WORST_ANGLE, DoubleTripod
from trunnion.papers.shared.result import ComparisonTable, PaperFigure, Reproduction, TableRow

NAME = "double-tripod"
MOTIONS = (
    ("11", "input", 0.0016), ("12", "input", 0.0073), ("13", "input", 0.0129),
    ("14", "output", 0.0016), ("15", "output", 0.0064), ("16", "output", 0.0112),
)  # fmt: skip
SWEEPS = (
    ("17", "input", 0.0016), ("18", "input", 0.0073), ("19", "input", 0.011), ("20", "input", 0.0114),
    ("21", "output", 0.0016), ("22", "output", 0.0064), ("23", "output", 0.0104), ("24", "output", 0.0112),
)  # fmt: skip
MAPS = (
    ("25", "input", 0.0016, (50_000, 10_000)), ("26", "input", 0.0073, (15_000, 1000)),
    ("27", "input", 0.011, (10_000, 1000)), ("28", "output", 0.0016, (50_000, 10_000)),
    ("29", "output", 0.0064, (50_000, 5000)), ("30", "output", 0.0104, (50_000, 5000)),
)  # fmt: skip
TURNING = {"input": (2950.0, 3066.5, 3200.0), "output": (2650.0, 2750.0, 2791.9, 2850.0, 2950.0)}
"""Frequencies η/2π [Hz] at which beats are counted with a rotation that turns: over the paper's range, and 2Ω."""
ASSUMED = "9°, printed χ_n, consistent Ī, Ω_AEM = 600π rad/s."


def double_tripod(points: int, report_progress: Callable[[float], None]) -> Reproduction:
    """Reproduce S4; a sixteenth of ``points``, 8 or more, for each curve over frequency: these are runs, not pixels."""
    points = max(points // 16, 8)
    found = cases(points, lambda share: report_progress(0.5 * share))
    by_damping = {(c.element, c.damping_ratio): c for c in found}
    motions = {number: drawn.motion_of(element, ratio) for number, element, ratio in MOTIONS}
    report_progress(0.6)
    figures = [
        *(_frequencies(number, element) for number, element in (("9", "input"), ("10", "output"))),
        *(_motion(number, _case(element, ratio), motions[number]) for number, element, ratio in MOTIONS),
        *(_exponents_over(n, _case(element, ratio), by_damping[element, ratio]) for n, element, ratio in SWEEPS),
        *(_map(*numbers) for numbers in MAPS),
    ]
    report_progress(0.75)
    against = refuted()
    report_progress(0.85)
    evidence = _evidence(points)
    report_progress(0.97)
    opened = {e: opening_depth(e) for e in PARTS}
    beats = {number: (element, ratio, drawn.beats(motions[number])) for number, element, ratio in MOTIONS}
    return Reproduction(
        name=NAME, title="A double tripod industrial driveshaft (S4)",
        source="Bugaru and Vasile, Applied Sciences 12 (2022) 6182", figures=tuple(figures),
        tables=(_numbers(), _exponents(), dampings(found), against, _opening(opened)), errata=errata(),
        evidence=evidence,
        conclusions=conclusions(found, opened, beats, {e: drawn.turning_beats(e, TURNING[e]) for e in PARTS}),
        figures_note="Lyapunov exponents are of the standard definition: variational equations, natural logarithm.",
        argument=argument(), assumed=_assumed(),
    )  # fmt: skip


def _assumed() -> ComparisonTable:
    """What the text leaves open, and what another value changes."""
    shafts = {"printed": DoubleTripod(), "derived": DoubleTripod(nonuniformity="derived")}
    rates = {k: contraction(s.system("input"), own=False).rate for k, s in shafts.items()}
    straight = contraction(DoubleTripod(mean_inertia="straight").system("input"), own=False).rate
    mended = DoubleTripod(steiner="mended").element("input").natural_frequency(WORST_ANGLE)
    taken = DoubleTripod().element("input").natural_frequency(WORST_ANGLE)
    return ComparisonTable(
        "What is assumed",
        (
            TableRow("χ_n", "0.0026, 0.0027, and other values by Appendix B", "as printed in section 6",
                f"the bound of DIE1's motions is {rates['printed']:.3g} 1/s, by Appendix B {rates['derived']:.3g} 1/s"),
            TableRow("Ī", "of the straight shaft in c₁…c₄, at the angle in Ω", "at the angle in both",
                f"the bound of DIE1 is {rates['printed']:.3g} 1/s, with the straight shaft's {straight:.3g} 1/s"),
            TableRow("Steiner terms", "without sin²β", "as printed",
                f"Ω₁ = {taken:.0f} rad/s, with sin²β {mended:.0f} rad/s"),
            TableRow("Ω_AEM", "100nπ, n one of 6, 12, 24, 48, 96, and πn_AEM/30", "600π rad/s",
                "every one of the five stands in the table of other speeds"),
            TableRow("φ in the cosines of (25), (26)", "the twist, and by (27), (28) a turning angle", "both",
                "motions and exponents of (25), (26) and of (29), (30); beats in a third reading"),
            TableRow("start and length of Figures 11 to 16", "not stated", f"rest without twist, {drawn.HISTORY:g} s",
                f"exponents from {START:g} rad stand in the table of other starts"),
        ),
    )  # fmt: skip


def _case(element: str, ratio: float) -> str:
    return f"{PARTS[element]}, 9°, ζ = {ratio:g}"


def _frequencies(number: str, element: str) -> PaperFigure:
    caption = f"Natural frequency of {PARTS[element]} over the joint angle"
    return PaperFigure(number, caption, "Printed geometry.", partial(drawn.frequency_figure, element))


def _motion(number: str, title: str, motion: SystemSimulation) -> PaperFigure:
    assumed = (
        f"{ASSUMED} From rest without twist, {drawn.HISTORY:g} s of it, of which the paper states nothing; the "
        f"last panel is the same motion at {motion.end - drawn.SETTLED:.2g} s, once the start has died out."
    )
    draw = partial(drawn.motion_figure, motion, title)
    return PaperFigure(number, f"Time history and portrait, {title}", assumed, draw)


def _exponents_over(number: str, title: str, found: ElementCase) -> PaperFigure:
    draw = partial(drawn.exponents_figure, found.sweep, title)
    return PaperFigure(number, f"Lyapunov exponents and their sum, {title}", ASSUMED + " Natural logarithm.", draw)


def _map(number: str, element: str, ratio: float, counts: tuple[int, int]) -> PaperFigure:
    title = f"{_case(element, ratio)}, η = 2Ω"
    draw = partial(drawn.map_figure, drawn.map_of(element, ratio, max(counts)), counts, title)
    return PaperFigure(number, f"Poincaré map, {title}", ASSUMED + " One point per turn of the phase Θ, settled.", draw)


def _evidence(points: int) -> tuple[PaperFigure, ...]:
    below = sweep_of(DoubleTripod(damping_ratio=BELOW), "output", max(points // 2, 8), effort=6, loaded=False)
    title = f"DOE3, 9°, ζ = {BELOW:g}, below the threshold"
    frequencies = np.linspace(*RANGES["input"], 11)
    curves = drawn.estimator_curves("input", frequencies)
    return (
        PaperFigure(
            "beyond", f"Lyapunov exponents and their sum, {title}",
            "About φ = 0, without load, at a damping ratio the paper does not have: the largest exponent turns "
            "positive close to 2Ω, where the motion grows without bound. "
            "That is parametric resonance of a linear equation, not chaos.",
            partial(drawn.exponents_figure, below, title),
        ),
        PaperFigure(
            "estimator", "Warning: the paper's own estimator, equation (31), as a historical curve",
            "Not a Lyapunov exponent. As the text reads: log₁₀, perturbations of 1e-5 of the state that start anew in "
            "each of N intervals, over 0.02 s. It changes with N at one and the same motion, and is negative here: the "
            "paper's figures are not what its text describes.",
            partial(drawn.estimator_figure, frequencies, curves),
        ),
    )  # fmt: skip


def _numbers() -> ComparisonTable:
    shaft = DoubleTripod()
    rows = []
    for element, name, printed in (("input", "Ω₁", "9632 rad/s, 3066 Hz"), ("output", "Ω₃", "8767 rad/s, 2792 Hz")):
        omega = shaft.element(element).natural_frequency(WORST_ANGLE)
        rows.append(TableRow(f"{name}(9°)", printed, f"{omega:.1f} rad/s, {omega / np.pi:.1f} Hz", "2Ω/2π in Hz"))
    frequencies = shaft.midshaft_frequencies()
    table = ("1669.2", "3338.4", "5007.6", "6676.8", "8346")
    for order, (entry, value) in enumerate(zip(table, frequencies, strict=True), start=1):
        remark = "agrees" if order == 1 else "k times the rounded ν₁"
        rows.append(TableRow(f"Table 3, ν_{order} [Hz]", entry, f"{value:.2f}", remark))
    rows.append(
        TableRow("A of the input tripod", "", f"{shaft.element('input').joint_amplitude(WORST_ANGLE):.4g}", "(13)")
    )
    return ComparisonTable("Frequencies and Table 3", tuple(rows))


def _exponents() -> ComparisonTable:
    rows = []
    for element, name in PARTS.items():
        for inertia, words in (("straight", "Ī of the straight shaft"), ("bent", "Ī at 9°")):
            for chi in ("printed", "derived"):
                shaft = DoubleTripod(mean_inertia=inertia, nonuniformity=chi)
                values = exponents_at_resonance(shaft, element)
                hill = floquet_exponents(shaft.system(element))
                shown = ", ".join(f"{v:.3f}" for v in np.where(np.abs(values) < 5e-4, 0.0, values))
                rows.append(
                    TableRow(
                        f"{name}, {chi} χ_n, {words}",
                        "",
                        f"{{{shown}}}",
                        f"Floquet without load: {hill[0]:.3f}, {hill[1]:.3f}",
                    )
                )
    return ComparisonTable(
        "Lyapunov exponents [1/s] at η = 2Ω, ζ = 0.0016, equations (29) and (30)", tuple(rows),
        "The paper gives its values in figures only, of another definition.",
    )  # fmt: skip


def _opening(opened: dict[str, tuple[float, float]]) -> ComparisonTable:
    rows = []
    for element, (chi, depth) in opened.items():
        shaft = DoubleTripod()
        rows.append(
            TableRow(
                f"{PARTS[element]}, ζ = 0.0016", f"depth {shaft.depth(element):.3g} (χ_n = {shaft.chi(element):g})",
                f"depth {depth:.4g} (χ_n = {chi:.4g})",
                f"needs {depth / shaft.depth(element):.3g} times the printed depth; 4ζ = 0.0064",
            )
        )  # fmt: skip
    return ComparisonTable("Parametric depth that opens the principal parametric resonance", tuple(rows))
