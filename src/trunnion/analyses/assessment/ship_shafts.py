"""Ship shafting by IACS UR M68, in form: for shafts whose limit names a design feature (``ship_shaft = "flange"``).

    λ = n/n₀            n₀ the operating speed of the description
    ±τ_C = (σ_B + 160)/18 · C_K C_D (3 − 2λ²)   for λ < 0.9     [N/mm²]
    ±τ_C = (σ_B + 160)/18 · C_K C_D · 1.38      for 0.9 ≤ λ ≤ 1.05
    ±τ_T = 1.7 τ_C/√C_K         in a barred range that is passed quickly
    C_D = 0.35 + 0.93 d^(−0.2), d in mm
    barred about n_c: from 16 n_c/(18 − λ_c) to (18 − λ_c) n_c/16; none at λ ≥ 0.8

σ_B counts up to 600 N/mm², 800 for alloyed steel of intermediate shafts. Out of scope: shafts inside gearboxes, of
motors and generators, crankshafts, ice.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from trunnion.analyses.assessment.check import Check, Rule, Status
from trunnion.analyses.assessment.compared import at_worst, unanswered
from trunnion.analyses.assessment.course import SWING, course
from trunnion.analyses.assessment.own_limits import bands, spring_of
from trunnion.analyses.assessment.subject import Case, Subject, cause
from trunnion.arrays import Array
from trunnion.driveline.geometry import tube_stress
from trunnion.driveline.limits import SHIP_SHAFTS
from trunnion.driveline.quantities import PRESSURE
from trunnion.driveline.shafts import Shaft

SOURCE = "IACS UR M68 in form; check your edition"
RULE = Rule("±τ ≤ (σ_B + 160)/18 · C_K C_D (3 − 2λ²); · 1.38 for λ ≥ 0.9", SOURCE, "known")
PASSING = Rule("±τ ≤ 1.7 τ_C/√C_K in a barred range, none at λ ≥ 0.8", SOURCE, "known")
HIGHEST, NO_BAR, STEADY = 1.05, 0.8, 0.9
"""λ up to which the rule goes, from which no barred range is allowed, from which the limit is constant."""
ALLOYED = ("42CrMo4", "34CrNiMo6")


def permissible_stress(strength: float, diameter: float, feature: float, ratio: float) -> float:
    """±τ_C [N/mm²] of σ_B [N/mm²] (as it counts), diameter [mm], C_K and λ."""
    size = 0.35 + 0.93 * diameter**-0.2
    return (strength + 160) / 18 * feature * size * (3 - 2 * ratio**2 if ratio < STEADY else 1.38)


def barred_range(speed: float, ratio: float) -> tuple[float, float]:
    """The range about a critical speed n_c at λ_c that must be passed quickly, in the unit of ``speed``."""
    return 16 * speed / (18 - ratio), (18 - ratio) * speed / 16


def ship_shafts(subject: Subject, case: Case) -> Iterator[Check]:
    """The continuous limit of every ship's shaft, and the transient one where a range has to be barred."""
    for limit in subject.line.limits_by_element:
        if limit.key == "ship_shaft":
            yield from _one(subject, case, limit.element, limit.value)


def _one(subject: Subject, case: Case, name: str, feature: str) -> Iterator[Check]:
    title = f"IACS UR M68 of {name}"
    if isinstance(case.answer, str):
        yield unanswered(case, title, RULE)
        return
    if subject.speed is None:
        yield Check(title, Status.NOT_JUDGED, RULE, "no rated speed: write speed under [operation]")
        return
    shaft = subject.line.elements[subject.line.index(name)]
    assert isinstance(shaft, Shaft) and shaft.outer_diameter and shaft.tensile_strength
    alloyed = shaft.material in ALLOYED and not feature.startswith("propeller")
    strength, diameter = min(shaft.tensile_strength / 1e6, 800 if alloyed else 600), shaft.outer_diameter * 1e3
    factor, c = SHIP_SHAFTS[feature], spring_of(case.assembly, name)
    ratio = case.speeds / subject.speed
    inside = ratio <= HIGHEST + 1e-9
    if not np.any(inside):
        yield Check(title, Status.NOT_APPLICABLE, RULE, f"all speeds lie above {HIGHEST} of the rated one")
        return
    speeds, ratio = case.speeds[inside], ratio[inside]
    per_torque = tube_stress(shaft.outer_diameter, shaft.inner_diameter or 0.0)
    stress = case.answer.vibratory_torque[inside, c] * per_torque / 1e6
    stress = np.where(np.isfinite(stress), stress, np.inf)
    allowed = np.array([permissible_stress(strength, diameter, factor, float(r)) for r in ratio])
    required = subject.required(name)
    exceeded = bands(speeds, stress, allowed * (1 - required))
    at = int(np.argmax(stress / allowed))
    by_order = np.abs(case.answer.torque[inside, :, c])
    transient = np.where(ratio < NO_BAR, 1.7 * allowed / np.sqrt(factor), allowed)
    seen = course(
        case.answer, f"stress of {name}", PRESSURE, SWING, 1e6 * stress,
        {"continuous, τ_C": 1e6 * allowed, "passing quickly, τ_T": 1e6 * transient},
        by_order * per_torque, inside,
    )  # fmt: skip
    inputs = (
        f"σ_B = {strength:g} N/mm², d = {diameter:g} mm, C_K = {factor:g} ({feature}), "
        f"n₀ = {subject.shown(subject.speed)}"
    )
    barred = tuple(_range(speeds, stress / allowed, ends, subject.speed) for ends in exceeded)
    bar = " and ".join(f"{subject.shown(a)} to {subject.shown(b)}" for a, b in barred)

    def against(limit: Array, at: int) -> tuple[tuple[float, float, str], str]:
        words = f"±{stress[at]:.4g} N/mm² against ±{limit[at]:.4g} N/mm²"
        return (float(stress[at]) * 1e6, float(limit[at]) * 1e6, "Pa"), words

    yield at_worst(
        subject, case, title, RULE, at, *against(allowed, at), required=required, inputs=inputs,
        where=f" (λ = {ratio[at]:.3g})", more=f"; bar {bar}" if bar else "", element=name, barred=barred,
        cause=cause(case, at, by_order[at]), course=seen,
    )  # fmt: skip
    if barred:
        at = int(np.argmax(stress / transient))
        yield at_worst(
            subject, case, f"{title}, passing", PASSING, at, *against(transient, at), required=required, inputs=inputs,
            where="" if ratio[at] < NO_BAR else " (no barred range at λ ≥ 0.8)",
        )  # fmt: skip


def _range(speeds: Array, share: Array, ends: tuple[float, float], rated: float) -> tuple[float, float]:
    """The rule's range about the worst speed of a band, widened to the band where that is wider."""
    inside = (speeds >= ends[0]) & (speeds <= ends[1])
    worst = float(speeds[inside][np.argmax(share[inside])]) if np.any(inside) else sum(ends) / 2
    low, high = barred_range(worst, worst / rated)
    return min(low, ends[0]), max(high, ends[1])
