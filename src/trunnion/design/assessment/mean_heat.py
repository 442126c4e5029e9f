"""Power that an element turns into heat at the mean torques and speeds, against what it bears continuously."""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array
from trunnion.design.assessment.assessment_input import AssessmentInput, LoadCaseResponse
from trunnion.design.assessment.check import Check, Rule, judged, percent
from trunnion.driveline.quantities import POWER, against


def speeds(case: LoadCaseResponse, points: int) -> Array:
    """So many input speeds [rad/s] of a load case, evenly; one of a range that is one speed."""
    return np.linspace(case.low, case.high, points if case.high > case.low else 1)


def heat_check(
    subject: AssessmentInput,
    case: LoadCaseResponse,
    rule: Rule,
    *,
    title: str,
    element: str,
    speed: Array,
    power: Array,
    rating: float,
    inputs: str,
) -> Check:
    """The largest ``power`` (speed,) [W] against the ``rating`` of an element [W]."""
    at = int(power.argmax())
    value, margin = float(power[at]), 1 - float(power[at]) / rating
    because = f"{against(value, rating, POWER)} at {subject.shown(float(speed[at]))}, {percent(margin)}{case.suffix}"
    return Check(
        title, judged(margin), rule, because, margin=margin, value=value, limit=rating, unit="W",
        speed=float(speed[at]), load_case=case.name, inputs=inputs, error=_error(power, at), element=element,
        covered=((case.low, case.high),),
    )  # fmt: skip


def _error(power: Array, at: int) -> float:
    """What the top between two points may rise above the higher one: nothing at an end of the range."""
    if not 0 < at < len(power) - 1:
        return 0.0
    return float(max(2 * power[at] - power[at - 1] - power[at + 1], 0.0))
