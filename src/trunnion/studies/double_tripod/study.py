"""S4 computed anew: frequencies, motions, exponents by the standard definition, maps, and its claims of chaos.

Bugaru and Vasile, Applied Sciences 12 (2022) 6182, "A new robust method to investigate dynamic instability of FTV
for the double tripod industrial driveshafts in the principal parametric resonance region".
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from trunnion.studies.double_tripod import figures as drawn
from trunnion.studies.double_tripod.computed import (
    BELOW,
    RANGES,
    Case,
    cases,
    exponents_at_resonance,
    floquet_exponents,
    opening_depth,
    sweep_of,
)
from trunnion.studies.double_tripod.errata import errata
from trunnion.studies.double_tripod.published import WORST_ANGLE, DoubleTripod
from trunnion.studies.result import Comparison, Conclusion, PaperFigure, Reproduction, Row

if TYPE_CHECKING:
    from matplotlib.figure import Figure

NAME = "double-tripod"
PARTS = {"input": "DIE1", "output": "DOE3"}
MOTIONS = (("11", "input", 0.0016), ("13", "input", 0.0129), ("14", "output", 0.0016), ("16", "output", 0.0112))
SWEEPS = (("17", "input", 0.0016), ("20", "input", 0.0114), ("21", "output", 0.0016), ("24", "output", 0.0112))
ASSUMED = "9°, printed χ_n, consistent Ī, Ω_AEM = 600π rad/s."


def double_tripod(points: int = 400, progress: Callable[[float], None] | None = None) -> Reproduction:
    """Reproduce S4; an eighth of ``points``, 8 or more, for each curve over frequency: these are runs, not pixels."""
    tell = progress or (lambda share: None)
    points = max(points // 8, 8)
    found = cases(points, lambda share: tell(0.6 * share))
    by_damping = {(c.element, c.damping_ratio): c for c in found}
    figures = [*_frequencies(), *_motions()]
    tell(0.7)
    for number, element, ratio in SWEEPS:
        sweep = by_damping[element, ratio].sweep
        title = f"{PARTS[element]}, 9°, ζ = {ratio:g}"
        figures.append(
            _paper_figure(
                number, f"Lyapunov exponents and their sum, {title}", ASSUMED + " Natural logarithm.",
                lambda sweep=sweep, title=title: drawn.exponents_figure(sweep, title),  # type: ignore[misc]
            )
        )  # fmt: skip
    for number, element in (("25", "input"), ("28", "output")):
        mapped = drawn.map_of(element)
        title = f"{PARTS[element]}, 9°, ζ = 0.0016, η = 2Ω"
        figures.append(
            _paper_figure(
                number, f"Poincaré map, {title}", ASSUMED + " One point per turn of the phase Θ, settled.",
                lambda mapped=mapped, title=title: drawn.map_figure(mapped, title),  # type: ignore[misc]
            )
        )  # fmt: skip
    tell(0.85)
    evidence = _evidence(points)
    tell(0.97)
    opened = {e: opening_depth(e) for e in PARTS}
    result = Reproduction(
        NAME,
        "A double tripod industrial driveshaft (S4)",
        "Bugaru and Vasile, Applied Sciences 12 (2022) 6182",
        tuple(figures),
        (_numbers(), _exponents(), _dampings(found), _opening(opened)),
        errata(),
        evidence,
        _conclusions(found, opened),
        "Lyapunov exponents are of the standard definition: variational equations, natural logarithm.",
    )
    tell(1.0)
    return result


def _paper_figure(number: str, caption: str, assumed: str, draw: Callable[[], Figure]) -> PaperFigure:
    return PaperFigure(number, caption, assumed, (), draw)


def _frequencies() -> list[PaperFigure]:
    return [
        _paper_figure(
            number, f"Natural frequency of {PARTS[element]} over the joint angle", "Printed geometry.",
            lambda element=element: drawn.frequency_figure(element),  # type: ignore[misc]
        )
        for number, element in (("9", "input"), ("10", "output"))
    ]  # fmt: skip


def _motions() -> list[PaperFigure]:
    made = []
    for number, element, ratio in MOTIONS:
        motion = drawn.motion_of(element, ratio)
        title = f"{PARTS[element]}, 9°, ζ = {ratio:g}"
        assumed = ASSUMED + " From rest without twist; orange: what is left once the start has died out."
        made.append(
            _paper_figure(
                number, f"Time history and portrait, {title}", assumed,
                lambda motion=motion, title=title: drawn.motion_figure(motion, title),  # type: ignore[misc]
            )
        )  # fmt: skip
    return made


def _evidence(points: int) -> tuple[PaperFigure, ...]:
    below = sweep_of(DoubleTripod(damping_ratio=BELOW), "output", points // 2, effort=6, loaded=False)
    title = f"DOE3, 9°, ζ = {BELOW:g}, below the threshold"
    frequencies = np.linspace(*RANGES["input"], 21)
    curves = drawn.estimator_curves("input", frequencies)
    return (
        _paper_figure(
            "beyond", f"Lyapunov exponents and their sum, {title}",
            "About φ = 0, without load, at a damping ratio the paper does not have: the largest exponent turns "
            "positive close to 2Ω, where the motion grows without bound. "
            "That is parametric resonance of a linear equation, not chaos.",
            lambda: drawn.exponents_figure(below, title),
        ),
        _paper_figure(
            "estimator", "Warning: the paper's own estimator, equation (31), as a historical curve",
            "Not a Lyapunov exponent. As the text reads: log₁₀, perturbations of 1e-5 of the state that start anew in "
            "each of N intervals, over 0.02 s. It changes with N at one and the same motion.",
            lambda: drawn.estimator_figure(frequencies, curves),
        ),
    )  # fmt: skip


def _numbers() -> Comparison:
    shaft = DoubleTripod()
    rows = []
    for element, name, printed in (("input", "Ω₁", "9632 rad/s, 3066 Hz"), ("output", "Ω₃", "8767 rad/s, 2792 Hz")):
        omega = shaft.element(element).natural_frequency(WORST_ANGLE)
        rows.append(Row(f"{name}(9°)", printed, f"{omega:.1f} rad/s, {omega / np.pi:.1f} Hz", "2Ω/2π in Hz"))
    frequencies = shaft.midshaft_frequencies()
    table = ("1669.2", "3338.4", "5007.6", "6676.8", "8346")
    for order, (entry, value) in enumerate(zip(table, frequencies, strict=True), start=1):
        remark = "agrees" if order == 1 else "k times the rounded ν₁"
        rows.append(Row(f"Table 3, ν_{order} [Hz]", entry, f"{value:.2f}", remark))
    rows.append(Row("A of the input tripod", "", f"{shaft.element('input').joint_amplitude(WORST_ANGLE):.4g}", "(13)"))
    return Comparison("Frequencies and Table 3", tuple(rows))


def _exponents() -> Comparison:
    rows = []
    for element, name in PARTS.items():
        for inertia, words in (("straight", "Ī of the straight shaft"), ("bent", "Ī at 9°")):
            for chi in ("printed", "derived"):
                shaft = DoubleTripod(mean_inertia=inertia, nonuniformity=chi)
                values = exponents_at_resonance(shaft, element)
                hill = floquet_exponents(shaft.system(element))
                shown = ", ".join(f"{v:.3f}" for v in np.where(np.abs(values) < 5e-4, 0.0, values))
                rows.append(
                    Row(
                        f"{name}, {chi} χ_n, {words}",
                        "",
                        f"{{{shown}}}",
                        f"Floquet without load: {hill[0]:.3f}, {hill[1]:.3f}",
                    )
                )
    return Comparison(
        "Lyapunov exponents [1/s] at η = 2Ω, ζ = 0.0016, equations (29) and (30)", tuple(rows),
        "The paper gives its values in figures only, of another definition.",
    )  # fmt: skip


def _dampings(found: list[Case]) -> Comparison:
    rows = []
    for case in found:
        low, high = RANGES[case.element]
        own, given = (f"{c.verdict}, {c.kind}" if c.kind else str(c.verdict) for c in (case.own, case.given))
        rows.append(
            Row(
                f"{PARTS[case.element]}, {low:g}–{high:g} Hz, ζ = {case.damping_ratio:g}",
                case.claimed,
                "no chaos" if case.positive == 0 else f"positive at {case.positive} frequencies",
                f"largest exponent besides the phase's 0: {case.largest:.4g} 1/s; at 2Ω: {given}; by its own phase "
                f"({'25' if case.element == 'input' else '26'}): {own}",
            )
        )
    return Comparison(
        "Ranges of damping for which the paper concludes chaos", tuple(rows),
        "Every frequency of the range, half of them within 0.2 % of 2Ω, by the standard definition.",
    )  # fmt: skip


def _opening(opened: dict[str, tuple[float, float]]) -> Comparison:
    rows = []
    for element, (chi, depth) in opened.items():
        shaft = DoubleTripod()
        rows.append(
            Row(
                f"{PARTS[element]}, ζ = 0.0016", f"depth {shaft.depth(element):.3g} (χ_n = {shaft.chi(element):g})",
                f"depth {depth:.4g} (χ_n = {chi:.4g})",
                f"needs {depth / shaft.depth(element):.3g} times the printed depth; 4ζ = 0.0064",
            )
        )  # fmt: skip
    return Comparison("Parametric depth that opens the principal parametric resonance", tuple(rows))


def _conclusions(found: list[Case], opened: dict[str, tuple[float, float]]) -> tuple[Conclusion, ...]:
    chaos = [c for c in found if c.claimed == "chaos"]
    quiet = all(c.positive == 0 for c in found)
    regular = all(c.given.verdict == "regular" and c.own.verdict == "regular" for c in found)
    largest = max(c.largest for c in found)
    shown = "; ".join(f"{PARTS[c.element]} ζ = {c.damping_ratio:g}: {c.largest:.3g} 1/s" for c in chaos)
    depths = {e: DoubleTripod().depth(e) for e in PARTS}
    return (
        Conclusion(
            "The motion is chaotic for ζ = 0.0016–0.011 (DIE1, 2950–3200 Hz) and 0.0016–0.0104 (DOE3, 2650–2950 Hz).",
            "corrected" if quiet else "confirmed",
            "By the standard definition no exponent is positive anywhere in these ranges, for either set of equations. "
            f"Largest besides the 0 of the phase: {shown}.",
        ),
        Conclusion(
            "For larger damping the motion is “ergodic”, in transition to chaos.",
            "corrected" if regular else "confirmed",
            "Over ζ = 0.0016–0.0186 every motion is regular: (29) quasi-periodic by its two frequencies, (30) and (25) "
            f"periodic, (26) at rest; no exponent but that of the phase is above {largest:.3g} 1/s.",
        ),
        Conclusion(
            "Criteria (37)–(39) and the map certify chaos.",
            "corrected",
            "(38) and (39) hold for every motion of these equations. Only (37) discriminates, and it fails.",
        ),
        Conclusion(
            "The principal parametric resonance decides the motion near η = 2Ω.",
            "corrected",
            f"With the printed χ_n the depth is {depths['input']:.3g} and {depths['output']:.3g}: the resonance opens "
            f"below ζ = {depths['input'] / 4:.2g}, under the paper's smallest. At ζ = 0.0016 it would take a depth of "
            f"{opened['input'][1]:.3g}.",
        ),
        Conclusion(
            "Beating at first, and decaying faster with more damping (Figures 11–16).",
            "confirmed",
            "Beats between the natural frequency and the harmonics of the motor's torque, while the start dies out.",
        ),
    )
