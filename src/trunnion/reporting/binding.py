"""The picture of the check that binds: what is limited over speed, with its limit."""

from __future__ import annotations

import numpy as np

from trunnion.design.assessment.assessment_input import LoadCaseResponse
from trunnion.design.assessment.check import Check
from trunnion.design.assessment.parametric import NAME as PARAMETRIC
from trunnion.reporting.overview import Overview
from trunnion.reporting.overview_assessment import capital
from trunnion.reporting.pictures import ReportPicture, picture
from trunnion.response.orders.result import OrderResponse
from trunnion.response.peaks.peak_limits import springs_of

OF_TORQUE = {
    "vibratory torque of": "vibratory_torque",
    "transient vibratory torque of": "transient_vibratory_torque",
    "max torque of": "max_torque",
}
"""How checks are called whose value is a torque, and the limit that they compare with."""


def binding_picture(seen: Overview) -> ReportPicture | None:
    """What binds over speed, or None where no response and no stability along the range exist."""
    from trunnion.pictures.draw_matplotlib import draw
    from trunnion.pictures.orders import course, growth_over_speed, order_response

    check, along = seen.assessment.binding, seen.along
    case = _case(seen, check)
    loaded = f", load case {check.load_case}" if check is not None and check.load_case else ""
    parametric = check is not None and check.name == PARAMETRIC and along is not None
    if check is not None and check.course is not None and not (parametric or _of_torque(check)):
        what = check.course.quantity
        orders = " by order, and of all orders together" if check.course.by_order.size else ""
        drawn = draw(course(check.course, unit=seen.unit, operating=seen.operation))
        said = f"{capital(what)} over speed{orders}, with its limit{loaded}."
        return picture(drawn, f"{what} over speed, with its limit", said)
    response = case.response
    turning = response is not None and np.nanmax(np.abs(response.torque), initial=0.0) > 0
    if response is not None and turning and not parametric:
        spring, limits = _spring(seen, case, check, response)
        which = "whose limit binds" if check is not None and _of_torque(check) else "that is loaded most"
        drawn = draw(order_response(response, spring=spring, unit=seen.unit, operating=seen.operation, limits=limits))
        said = f"Torque over speed by order, and all orders together, of the spring {which}{loaded}."
        return picture(drawn, "Torque over speed by order, with its limits", said)
    if along is None:
        return None
    drawn = draw(growth_over_speed(along, unit=seen.unit, operating=seen.operation))
    said = (
        "Growth rate of the slowest disturbance at the line's own joint angles: below zero it dies out. At every "
        "speed judged, the named resonance speeds among them."
    )
    return picture(drawn, "Decay of the slowest disturbance over speed", said)


def _case(seen: Overview, check: Check | None) -> LoadCaseResponse:
    cases = seen.subject.cases
    return next((case for case in cases if check is not None and case.name == check.load_case), cases[0])


def _of_torque(check: Check) -> bool:
    return check.name.startswith(tuple(OF_TORQUE))


def _spring(
    seen: Overview, case: LoadCaseResponse, check: Check | None, response: OrderResponse
) -> tuple[str, dict[str, float]]:
    """The spring that the binding check is about, else the most loaded one, and its limits of torque [N m]."""
    stated = [one for one in seen.line.limits_by_element if one.key in OF_TORQUE.values()]
    if check is not None and _of_torque(check):
        own = springs_of(case.assembly, check.element)
        column = max(own, key=lambda c: float(np.nan_to_num(response.peak_torque[:, c]).max()))
    else:
        column = int(np.argmax(np.nan_to_num(response.vibratory_torque).max(axis=0)))
    mine = [one for one in stated if column in springs_of(case.assembly, one.element)]
    return response.springs[column], {one.key.replace("_", " "): one.value for one in mine}
