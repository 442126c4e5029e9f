"""Ship shafting by IACS UR M68, in form: for shafts whose limit names a design feature (``ship_shaft = "flange"``).

    λ = n/n₀            n₀ the operating speed of the description
    ±τ_C = (σ_B + 160)/18 · C_K C_D (3 − 2λ²)   for λ < 0.9     [MPa]
    ±τ_C = (σ_B + 160)/18 · C_K C_D · 1.38      for 0.9 ≤ λ ≤ 1.05
    ±τ_T = 1.7 τ_C/√C_K         in a barred range that is passed quickly
    C_D = 0.35 + 0.93 d^(−0.2), d in mm
    barred about n_c: from 16 n_c/(18 − λ_c) to (18 − λ_c) n_c/16; none at λ ≥ 0.8

σ_B counts up to 600 MPa, 800 for alloyed steel of intermediate shafts. Out of scope: shafts inside gearboxes, of
motors and generators, crankshafts, ice.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from trunnion.arrays import Array
from trunnion.design.assessment.assessment_input import AssessmentInput, LargestShare, LoadCaseResponse, cause
from trunnion.design.assessment.check import Check, Rule, Status
from trunnion.design.assessment.compared import at_largest, unanswered
from trunnion.design.assessment.measures import HIGHEST, NO_BAR, of_ship_shaft, ship_name, ship_shaft
from trunnion.design.assessment.response_curve import SWING, course
from trunnion.design.assessment.stated_limits import bands
from trunnion.driveline.quantities import PRESSURE
from trunnion.results.words import Words

SOURCE = "IACS UR M68 in form; check your edition"
RULE = Rule("±τ ≤ (σ_B + 160)/18 · C_K C_D · (3 − 2λ² for λ < 0.9, 1.38 from there on)", SOURCE, "known", "m68")
PASSING = Rule("±τ ≤ 1.7 τ_C/√C_K in a barred range, none at λ ≥ 0.8", SOURCE, "known", "m68")
NONE_NAMED = (
    'no shaft is named for it: write ship_shaft = "flange", say, in the [[limit]] of intermediate and propeller shafts'
)


def barred_range(speed: float, ratio: float) -> tuple[float, float]:
    """The range about a critical speed n_c at λ_c that must be passed quickly, in the unit of ``speed``."""
    return 16 * speed / (18 - ratio), (18 - ratio) * speed / 16


def ship_shafts(subject: AssessmentInput, case: LoadCaseResponse) -> Iterator[Check]:
    """The continuous limit of every ship's shaft, and the transient one where a range has to be barred; of a ship that
    names none, that it has to."""
    named = [limit for limit in subject.line.limits_by_element if limit.key == "ship_shaft"]
    for limit in named:
        yield from _one(subject, case, limit.element, limit.value)
    operation = subject.line.operation
    if not named and operation and operation.application == "ship":
        yield Check("IACS UR M68", Status.NOT_JUDGED, RULE, NONE_NAMED)


def _one(subject: AssessmentInput, case: LoadCaseResponse, name: str, feature: str) -> Iterator[Check]:
    title = ship_name(name)
    if isinstance(case.answer, str):
        yield unanswered(subject, case, title, RULE)
        return
    numbers = ship_shaft(case.assembly, name, feature)
    if numbers is None:
        yield Check(title, Status.NOT_JUDGED, RULE, "no rated speed: write speed under [operation]")
        return
    inside = np.isfinite(numbers.continuous(case.speeds))
    if not np.any(inside):
        yield Check(title, Status.NOT_APPLICABLE, RULE, f"all speeds lie above {HIGHEST} of the rated one")
        return
    steady, passing = of_ship_shaft(case.assembly, name, feature)
    found, quickly = case.largest(steady), case.largest(passing)
    stress, speeds = np.where(np.isfinite(found.values), found.values, np.inf)[inside], case.speeds[inside]
    exceeded = bands(speeds, stress, found.limits[inside] * (1 - steady.margin))
    by_order = np.abs(steady.parts(case.answer))
    seen = course(
        case.answer, f"stress of {name}", PRESSURE, SWING, stress,
        {"continuous operation": found.limits[inside], "passing quickly": quickly.limits[inside]},
        by_order[inside], inside,
    )  # fmt: skip
    inputs = (
        f"σ_B = {numbers.strength:g} MPa, d = {numbers.diameter:g} mm, C_K = {numbers.factor:g} ({feature}), "
        f"n₀ = {subject.shown(numbers.rated)}"
    )
    barred = tuple(_range(speeds, stress / found.limits[inside], ends, numbers.rated) for ends in exceeded)
    ratio = case.speeds / numbers.rated
    yield at_largest(
        subject, case, title, RULE, found, PRESSURE, required=steady.margin, words=_words(found), inputs=inputs,
        where=f" (λ = {ratio[found.at]:.3g})", element=name, barred=barred,
        more=f"; bar {Words(subject.unit).barred(barred)}" if barred else "",
        cause=cause(case, found.at, by_order[found.at]), course=seen,
    )  # fmt: skip
    if barred:
        yield at_largest(
            subject, case, passing.name, PASSING, quickly, PRESSURE, required=steady.margin, words=_words(quickly),
            inputs=inputs, where="" if ratio[quickly.at] < NO_BAR else " (no barred range at λ ≥ 0.8)",
        )  # fmt: skip


def _words(found: LargestShare) -> str:
    if not np.isfinite(found.value):
        return ""
    return f"±{found.value / 1e6:.4g} MPa against ±{found.limit / 1e6:.4g} MPa"


def _range(speeds: Array, share: Array, ends: tuple[float, float], rated: float) -> tuple[float, float]:
    """The rule's range about the worst speed of a band, widened to the band where that is wider."""
    inside = (speeds >= ends[0]) & (speeds <= ends[1])
    worst = float(speeds[inside][np.argmax(share[inside])]) if np.any(inside) else sum(ends) / 2
    low, high = barred_range(worst, worst / rated)
    return min(low, ends[0]), max(high, ends[1])
