"""Gear hammer: a mesh separates where its vibratory torque is larger than its mean torque.

    half of peak-to-peak of the torque ≤ |mean torque|   (known)

A rigid Ratio has no mesh to separate. Backlash and what follows after separation belong to the nonlinear analyses.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from trunnion.design.assessment.assessment_input import AssessmentInput, LoadCaseResponse, cause
from trunnion.design.assessment.check import Check, Rule, Status
from trunnion.design.assessment.compared import at_largest, unanswered
from trunnion.design.assessment.measures import of_hammer
from trunnion.design.assessment.response_curve import SWING, course
from trunnion.design.assessment.stated_limits import bands
from trunnion.driveline.gears import GearPair
from trunnion.driveline.quantities import TORQUE

RULE = Rule("half of peak-to-peak ≤ |mean torque|", "loss of contact", "known", "gear-hammer")
NOTHING = 1e-3
"""Share of its vibratory torque below which a mesh carries no mean torque: what losses and rounding leave."""


def gear_hammer(subject: AssessmentInput, case: LoadCaseResponse) -> Iterator[Check]:
    """Every mesh of the line."""
    pairs = [n for n, e in subject.line.parts if isinstance(e, GearPair)]
    if not pairs:
        yield Check("gear hammer", Status.NOT_APPLICABLE, RULE, "the line has no GearPair")
    for name in pairs:
        title = f"gear hammer in {name}"
        if isinstance(case.answer, str):
            yield unanswered(subject, case, title, RULE)
            continue
        measure = of_hammer(case.assembly, name)
        found = case.largest(measure)
        swing = np.where(np.isfinite(found.values), found.values, np.inf)
        if np.all(found.limits <= NOTHING * swing):
            yield _idle(subject, case, title)
            continue
        words = f"±{swing[found.at]:.4g} N m about a mean of {found.limit:.4g} N m"
        by_order = np.abs(measure.parts(case.answer))
        barred = bands(case.speeds, swing, found.limits * (1 - measure.margin))
        yield at_largest(
            subject, case, title, RULE, found, TORQUE, required=measure.margin, words=words, element=name,
            barred=barred, cause=cause(case, found.at, by_order[found.at]),
            course=course(
                case.answer, f"torque of {name}", TORQUE, SWING, swing, {"mean torque": found.limits}, by_order
            ),
        )  # fmt: skip


def _idle(subject: AssessmentInput, case: LoadCaseResponse, title: str) -> Check:
    """Of a mesh that carries no mean torque; where the line has load cases, they judge it."""
    if not case.name and len(subject.cases) > 1:
        return Check(title, Status.NOT_APPLICABLE, RULE, "no mean torque without a load case: under load it is judged")
    because = "the mesh carries no mean torque, so that any vibration parts its teeth: state a load_torque"
    return Check(title, Status.NOT_JUDGED, RULE, because + case.suffix, load_case=case.name)
