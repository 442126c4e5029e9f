"""The picture of the check that binds: what is limited over speed, with its limit."""

from __future__ import annotations

import numpy as np

from trunnion.analyses.assessment.check import Check
from trunnion.analyses.assessment.own_limits import spring_of
from trunnion.analyses.assessment.parametric import NAME as PARAMETRIC
from trunnion.analyses.assessment.subject import Case
from trunnion.analyses.orders.result import OrderResponse
from trunnion.reporting.overview import Overview
from trunnion.reporting.pictures import Picture, picture

OF_TORQUE = {
    "vibratory torque of": "vibratory_torque",
    "transient vibratory torque of": "transient_vibratory_torque",
    "max torque of": "max_torque",
}
"""How checks are called whose value is a torque, and the limit that they compare with."""


def binding_picture(seen: Overview) -> dict[str, Picture]:
    """``{"binding": …}``, or nothing where no response and no stability along the range exist."""
    from trunnion.plots import course, growth_over_speed, order_response

    check, unit = seen.assessment.binding, seen.unit
    along = seen.answer.stability
    if check is not None and check.name == PARAMETRIC and along is not None:
        drawn = growth_over_speed.draw(along, unit=unit, operating=seen.operation)
        return {"binding": picture(drawn.figure.figure, "Decay of the slowest disturbance over speed")}
    if check is not None and check.course is not None and not _of_torque(check):
        drawn = course.draw(check.course, unit=unit, operating=seen.operation)
        return {"binding": picture(drawn.figure.figure, f"{check.course.quantity} over speed, with its limit")}
    response = _case(seen, check).response
    if response is not None and response.torque.size and np.nanmax(np.abs(response.torque), initial=0.0) > 0:
        spring, limits = _spring(seen, check, response)
        drawn = order_response.draw(response, spring=spring, unit=unit, operating=seen.operation, limits=limits)
        return {"binding": picture(drawn.figure.figure, "Torque over speed by order, with its limits")}
    if along is not None:
        drawn = growth_over_speed.draw(along, unit=unit, operating=seen.operation)
        return {"binding": picture(drawn.figure.figure, "Decay of the slowest disturbance over speed")}
    return {}


def binding_words(seen: Overview) -> str:
    """The caption of that picture."""
    check, along = seen.assessment.binding, seen.answer.stability
    response = _case(seen, check).response
    if (check is not None and check.name == PARAMETRIC and along is not None) or response is None:
        return (
            "Growth rate of the slowest disturbance at the line's own joint angles: below zero it dies out. At every "
            "speed judged, the named resonance speeds among them."
        )
    case = f", load case {check.load_case}" if check is not None and check.load_case else ""
    if check is not None and check.course is not None and not _of_torque(check):
        orders = " by order, and of all orders together" if check.course.by_order.size else ""
        words = check.course.quantity
        return f"{words[:1].upper()}{words[1:]} over speed{orders}, with its limit{case}."
    which = "whose limit binds" if check is not None and _of_torque(check) else "that is loaded most"
    return f"Torque over speed by order, and all orders together, of the spring {which}{case}."


def _case(seen: Overview, check: Check | None) -> Case:
    cases = seen.answer.subject.cases
    return next((case for case in cases if check is not None and case.name == check.load_case), cases[0])


def _of_torque(check: Check) -> bool:
    return check.name.startswith(tuple(OF_TORQUE))


def _spring(seen: Overview, check: Check | None, response: OrderResponse) -> tuple[str | None, dict[str, float]]:
    """The spring that the binding check is about, else the most loaded one, and its limits of torque [N m]."""
    case = _case(seen, check)
    stated = [one for one in seen.line.limits_by_element if one.key in OF_TORQUE.values()]
    places = {one.element: spring_of(case.assembly, one.element) for one in stated}
    if check is not None and _of_torque(check):
        column = spring_of(case.assembly, check.element)
    else:
        column = int(np.argmax(np.nan_to_num(response.vibratory_torque).max(axis=0)))
    mine = {one.key.replace("_", " "): one.value for one in stated if places[one.element] == column}
    return response.springs[column], mine
