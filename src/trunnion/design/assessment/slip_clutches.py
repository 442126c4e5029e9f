"""Slip clutches: the largest torque stays below the capacity, so that the clutch sticks as all responses take it.

largest |mean + vibratory| torque ≤ T_s
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from trunnion.design.assessment.assessment_input import AssessmentInput, LoadCaseResponse, cause
from trunnion.design.assessment.check import Check, Rule, Status
from trunnion.design.assessment.compared import at_largest, unanswered
from trunnion.design.assessment.measures import of_slip_clutch
from trunnion.design.assessment.response_curve import WHOLE, course
from trunnion.driveline.quantities import TORQUE, shown
from trunnion.driveline.slip_clutches import SlipClutch

RULE = Rule("T_peak ≤ T_s, so that it sticks", "dry friction", "known", "slip-clutch")


def slip_clutches(subject: AssessmentInput, case: LoadCaseResponse) -> Iterator[Check]:
    """Every slip clutch of the line; nothing of lines without any."""
    for name, element in subject.line.parts:
        if not isinstance(element, SlipClutch):
            continue
        title = f"capacity of {name}"
        if isinstance(case.answer, str):
            yield unanswered(subject, case, title, RULE)
            continue
        measure = of_slip_clutch(case.assembly, name)
        if measure is None:
            because = "joints or excitations act on both of its sides, so that neither tells its torque"
            remedy = "put a Shaft beside it"
            yield Check(title, Status.NOT_JUDGED, RULE, f"{because}: {remedy}{case.suffix}", load_case=case.name)
            continue
        found, by_order = case.largest(measure), np.abs(measure.parts(case.answer))
        yield at_largest(
            subject, case, title, RULE, found, TORQUE, required=measure.margin, element=name,
            cause=cause(case, found.at, by_order[found.at]),
            more="; beyond it slips, which no response here has" if not found.value <= found.limit else "",
            course=course(
                case.answer, f"torque of {name}", TORQUE, WHOLE, found.values,
                {f"capacity {shown(found.limit, TORQUE, digits=4)}": found.limit}, by_order,
            ),
        )  # fmt: skip
