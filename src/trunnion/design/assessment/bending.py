"""Bending critical speed of tubes, a caution only: the model is torsional.

highest speed ≤ 0.75 ω_crit,   ω_crit = (π/L)² √(EI/(ρA))      (practice of propeller shafts)
"""

from __future__ import annotations

from collections.abc import Iterator

from trunnion.design.assessment.assessment_input import AssessmentInput
from trunnion.design.assessment.check import Check, Rule, Status
from trunnion.design.assessment.compared import guideline
from trunnion.equations.coefficients import Assembly
from trunnion.modes.bending import SAFE_SHARE, bending_speeds

RULE = Rule(
    "Ω ≤ 0.75 (π/L)² √(EI/(ρA))", "practice of propeller shafts; supports taken as joints", "typical", "bending"
)


def bending(subject: AssessmentInput, assembly: Assembly) -> Iterator[Check]:
    """Every shaft described as a tube with a density."""
    found = bending_speeds(assembly)
    if not found:
        because = "no shaft is described as a tube with a density"
        yield Check("bending critical speed", Status.NOT_APPLICABLE, RULE, because)
    for row in found:
        limit = SAFE_SHARE * row.input_speed
        numbers = f"{subject.shown(subject.high)} against 75 % of {subject.shown(row.input_speed)} at the input"
        yield guideline(
            f"bending critical speed of {row.shaft}", RULE, (subject.high, limit, "rad/s"), numbers,
            speed=subject.high, inputs=f"E = {row.young_modulus / 1e9:.4g} GPa", element=row.shaft,
        )  # fmt: skip
