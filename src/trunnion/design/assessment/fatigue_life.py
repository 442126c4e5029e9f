"""Fatigue: Miner's sum of every element with an S–N curve, over the life, duty and passages of the description.

    Σ n/N ≤ D      cycles by rainflow (ASTM E1049-85), N by the curve of the element

Damage is taken over what the description says that the line does, not over the running range of other checks.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from trunnion.design.assessment.assessment_input import AssessmentInput
from trunnion.design.assessment.check import Check, Rule, Status, below, judged, percent
from trunnion.design.fatigue.result import FatigueLife

NAME = "fatigue"
RULE = Rule("Σ n/N ≤ allowed sum", "cycles by ASTM E1049-85, Palmgren and Miner; the description", "yours", NAME)


def fatigue_name(element: str) -> str:
    """ "fatigue of Shaft 2"."""
    return f"fatigue of {element}"


def fatigue_life(subject: AssessmentInput) -> Iterator[Check]:
    """One check an element with an S–N curve; none without any."""
    curves = subject.line.sn_curves_by_element
    found = subject.fatigue if curves else None
    for place, element in enumerate(curves):
        if isinstance(found, FatigueLife):
            yield _one(subject, found, place)
        else:
            yield Check(fatigue_name(element), Status.NOT_JUDGED, RULE, found or "", element=element)


def _one(subject: AssessmentInput, found: FatigueLife, place: int) -> Check:
    element = found.elements[place]
    name, said = fatigue_name(element), found.sentence(place)
    if np.isnan(found.life[place]):
        return Check(name, Status.NOT_JUDGED, RULE, "; ".join([said, *found.uncounted]), element=element)
    if found.operating_life is None:
        because = f'{said}; no life is stated: write life = "20000 h", say, under [operation]'
        return Check(name, Status.NOT_JUDGED, RULE, because, element=element)
    value, limit, error = float(found.damage[place]), float(found.allowed[place]), float(found.damage_error[place])
    margin, required = below(value, limit), subject.required(element)
    status, because = judged(margin, required), f"{said}, {percent(margin)}"
    if status is Status.SATISFIED and judged(below(value + error, limit), required) is Status.EXCEEDED:
        status, because = Status.NOT_JUDGED, f"{because}; cycles are not counted closely enough to tell"
    return Check(
        name, status, RULE, because, margin=margin, required_margin=required, value=value, limit=limit, unit="1",
        inputs=f"over {', '.join(found.histories)}", element=element, error=error,
    )  # fmt: skip
