"""Torque converters: the heat of their oil stays below what they bear continuously.

T_p ω_p − T_t ω_t ≤ P at the balance of the turbine with its loads
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from trunnion.arrays import Array
from trunnion.design.assessment.assessment_input import AssessmentInput, LoadCaseResponse
from trunnion.design.assessment.check import Check, Rule, Status, judged, percent
from trunnion.driveline.quantities import POWER, against
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
        speed = np.linspace(case.low, case.high, POINTS if case.high > case.low else 1)
        heat = np.array([_heat(case.assembly, place, float(one)) for one in speed])
        at = int(heat.argmax())
        value, limit = float(heat[at]), float(element.heat_rating)
        margin = 1 - value / limit
        where = f"at {subject.shown(float(speed[at]))}"
        yield Check(
            title, judged(margin), RULE, f"{against(value, limit, POWER)} {where}, {percent(margin)}{case.suffix}",
            margin=margin, value=value, limit=limit, unit="W", speed=float(speed[at]), load_case=case.name,
            inputs="mean torques and speeds of pump and turbine", error=_error(heat, at), element=name,
            covered=((case.low, case.high),),
        )  # fmt: skip


def _heat(assembly: Assembly, place: int, speed: float) -> float:
    element = assembly.at(speed).line.elements[place]
    assert isinstance(element, TorqueConverter)
    assert element.run is not None
    return element.run.heat


def _error(heat: Array, at: int) -> float:
    """What the top between two points may rise above the higher one: nothing at an end of the range."""
    if not 0 < at < len(heat) - 1:
        return 0.0
    return float(max(2 * heat[at] - heat[at - 1] - heat[at + 1], 0.0))
