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
from numpy.typing import NDArray

from trunnion.analyses.assessment.check import Check, Rule, Status, below, judged, percent
from trunnion.analyses.assessment.course import SWING, course
from trunnion.analyses.assessment.own_limits import bands, spring_of, stress_factor
from trunnion.analyses.assessment.subject import NO_RESPONSE, Case, Subject, cause
from trunnion.driveline.limits import SHIP_SHAFTS
from trunnion.driveline.quantities import PRESSURE
from trunnion.driveline.shafts import Shaft

Array = NDArray[np.float64]
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
        yield Check(title, Status.NOT_JUDGED, RULE, f"{NO_RESPONSE}{case.answer}")
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
    stress = case.answer.vibratory_torque[inside, c] * stress_factor(shaft) / 1e6
    stress = np.where(np.isfinite(stress), stress, np.inf)
    allowed = np.array([permissible_stress(strength, diameter, factor, float(r)) for r in ratio])
    required = subject.required(name)
    exceeded = bands(speeds, stress, allowed * (1 - required))
    at = int(np.argmax(stress / allowed))
    margin = below(float(stress[at]), float(allowed[at]))
    by_order = np.abs(case.answer.torque[inside, :, c])
    said = cause(case, at, by_order[at])
    seen = course(
        case.answer, f"stress of {name}", PRESSURE, SWING, 1e6 * stress,
        {"continuous, τ_C": 1e6 * allowed, "passing quickly, τ_T": 1e6 * _transient(allowed, ratio, factor)},
        by_order * stress_factor(shaft), inside,
    )  # fmt: skip
    inputs = (
        f"σ_B = {strength:g} N/mm², d = {diameter:g} mm, C_K = {factor:g} ({feature}), "
        f"n₀ = {subject.shown(subject.speed)}"
    )
    barred = tuple(_range(speeds, stress / allowed, ends, subject.speed) for ends in exceeded)
    numbers = f"±{stress[at]:.4g} N/mm² against ±{allowed[at]:.4g} N/mm² at {subject.shown(speeds[at])}"
    because = f"{numbers} (λ = {ratio[at]:.3g}), {percent(margin)}" + (f", {said}" if said else "") + case.suffix
    if barred:
        because += "; bar " + " and ".join(f"{subject.shown(a)} to {subject.shown(b)}" for a, b in barred)
    yield Check(
        title, judged(margin, required), RULE, because, margin, required, float(stress[at]) * 1e6,
        float(allowed[at]) * 1e6, "Pa", float(speeds[at]), inputs, case.name, barred, element=name, cause=said,
        course=seen,
    )  # fmt: skip
    if barred:
        yield _passing(subject, case, title, (speeds, ratio, stress), allowed, factor, required, inputs)


def _range(speeds: Array, share: Array, ends: tuple[float, float], rated: float) -> tuple[float, float]:
    """The rule's range about the worst speed of a band, widened to the band where that is wider."""
    inside = (speeds >= ends[0]) & (speeds <= ends[1])
    worst = float(speeds[inside][np.argmax(share[inside])]) if np.any(inside) else sum(ends) / 2
    low, high = barred_range(worst, worst / rated)
    return min(low, ends[0]), max(high, ends[1])


def _transient(allowed: Array, ratio: Array, factor: float) -> Array:
    """±τ_T of ±τ_C, λ and C_K."""
    return np.where(ratio < NO_BAR, 1.7 * allowed / np.sqrt(factor), allowed)


def _passing(
    subject: Subject, case: Case, title: str, seen: tuple[Array, Array, Array], allowed: Array, factor: float,
    required: float, inputs: str,
) -> Check:  # fmt: skip
    speeds, ratio, stress = seen
    transient = _transient(allowed, ratio, factor)
    at = int(np.argmax(stress / transient))
    margin = below(float(stress[at]), float(transient[at]))
    where = "" if ratio[at] < NO_BAR else " (no barred range at λ ≥ 0.8)"
    because = (
        f"±{stress[at]:.4g} N/mm² against ±{transient[at]:.4g} N/mm² at {subject.shown(speeds[at])}{where}, "
        f"{percent(margin)}{case.suffix}"
    )
    return Check(
        f"{title}, passing", judged(margin, required), PASSING, because, margin, required, float(stress[at]) * 1e6,
        float(transient[at]) * 1e6, "Pa", float(speeds[at]), inputs, case.name,
    )  # fmt: skip
