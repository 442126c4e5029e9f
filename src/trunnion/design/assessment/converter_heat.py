"""Torque converters: the heat of their oil stays below what they bear continuously.

T_p ω_p − T_t ω_t ≤ P at the balance of the turbine with its loads
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from trunnion.design.assessment.assessment_input import AssessmentInput, LoadCaseResponse
from trunnion.design.assessment.check import Check, Rule, Status
from trunnion.design.assessment.mean_heat import heat_check, speeds
from trunnion.driveline.torque_converters import TorqueConverter
from trunnion.equations.coefficients import Assembly

RULE = Rule("T_p ω_p − T_t ω_t ≤ P over the mean speeds", "the maker's sheet", "yours", "converter-heat")
POINTS = 65
"""Speeds at which it is looked at."""


def converter_heat(subject: AssessmentInput, case: LoadCaseResponse) -> Iterator[Check]:
    """Every converter that is not locked; nothing of lines without any."""
    for place, element in enumerate(case.assembly.line.elements):
        if not isinstance(element, TorqueConverter) or element.locked:
            continue
        name = case.assembly.line.names[place]
        title = f"heat of {name}"
        if element.heat_rating is None:
            yield Check(title, Status.NOT_APPLICABLE, RULE, f"{name} states no heat_rating")
            continue
        speed = speeds(case, POINTS)
        heat = np.array([_heat(case.assembly, place, float(one)) for one in speed])
        yield heat_check(
            subject, case, RULE, title=title, element=name, speed=speed, power=heat,
            rating=float(element.heat_rating), inputs="mean torques and speeds of pump and turbine",
        )  # fmt: skip


def _heat(assembly: Assembly, place: int, speed: float) -> float:
    element = assembly.at(speed).line.elements[place]
    assert isinstance(element, TorqueConverter)
    assert element.run is not None
    return element.run.heat
