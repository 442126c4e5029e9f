"""Ratings of elastic couplings, in the form of DIN 740-2, of the heat of dampers and of the travel of pendulums.

    T_KN ≥ T_N S_t          mean torque, S_t the temperature factor
    T_Kmax ≥ T_peak S_t S_z     largest torque over the cycle, S_z the starting factor
    T_KW/S_t ≥ Σ S_f T_f        rated torque: amplitudes of all orders, S_f = 1 up to 10 Hz and √(f/10 Hz) above
    P_KV ≥ P_W S_t          heat of the damping

Each order counts with the S_f of its own frequency, and phases are left out: the sum of amplitudes is an upper bound.
The factors are inputs: check them in your edition and in the maker's catalogue.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from trunnion.design.assessment.assessment_input import AssessmentInput, LoadCaseResponse, cause
from trunnion.design.assessment.check import Check, Rule, Status
from trunnion.design.assessment.compared import at_largest, unanswered
from trunnion.design.assessment.measures import (
    allowed_by,
    of_rating,
    rating_name,
    rating_words,
    spring_of,
)
from trunnion.design.assessment.response_curve import WHOLE, course
from trunnion.driveline.dampers import Damper
from trunnion.driveline.elements import Element
from trunnion.driveline.pendulums import CentrifugalPendulum
from trunnion.driveline.quantities import LENGTH, POWER, TORQUE, shown
from trunnion.driveline.torque_converters import TorqueConverter
from trunnion.response.peaks.peak_limits import service_factors

SOURCE = "DIN 740-2 in form; check your edition and the maker's catalogue"
OF_DAMPERS = Rule(
    "P_W ≤ P_KV, the heat of the ring's slip over all orders", "the maker's sheet", "yours", "damper-heat"
)
OF_PENDULUMS = Rule("largest travel along the path ≤ its stop", "linear theory", "yours", "pendulum-travel")
FORMULAS = {
    "nominal_torque": "T_N S_t ≤ T_KN",
    "maximum_torque": "T_peak S_t S_z ≤ T_Kmax",
    "vibratory_torque": "Σ S_f(f) T_f ≤ T_KW/S_t over all orders, S_f = √(f/10 Hz), at least 1",
    "heat_rating": "P_W S_t ≤ P_KV",
    "largest_travel": OF_PENDULUMS.formula,
}
TAKEN = {
    "nominal_torque": "mean",
    "maximum_torque": WHOLE,
    "vibratory_torque": "sum of amplitudes, each times its frequency factor: an upper bound",
    "heat_rating": "mean over the cycle",
    "largest_travel": WHOLE,
}
"""What of the response a rating is compared with, but for the service factors that are stated."""


KINDS = {"heat_rating": POWER, "largest_travel": LENGTH}
LIMITED = {"vibratory_torque": "allowed"}
"""How a picture calls the limit, where it is not a rating by itself."""


def coupling_ratings(subject: AssessmentInput, case: LoadCaseResponse) -> Iterator[Check]:
    """Every rating that a coupling, a damper or a pendulum states."""
    for name, element in subject.line.parts:
        if isinstance(element, TorqueConverter):
            continue
        stated = [key for key in element.ratings if getattr(element, key) is not None]
        if len(element.ratings) > 1 and not stated:
            why = f"{name} states no {', '.join(element.ratings[:-1])} or {element.ratings[-1]}"
            yield Check(f"ratings of {name}", Status.NOT_APPLICABLE, _rule(element, element.ratings[0]), why)
            continue
        for key in element.ratings:
            rating, title, rule = getattr(element, key), rating_name(name, key), _rule(element, key)
            if rating is None:
                yield Check(title, Status.NOT_APPLICABLE, rule, f"{name} states no {key}")
            elif isinstance(case.answer, str):
                yield unanswered(subject, case, title, rule)
            else:
                yield _rated(subject, case, name, key, rating, rule)


def _rule(element: Element, key: str) -> Rule:
    if isinstance(element, Damper):
        return OF_DAMPERS
    return OF_PENDULUMS if isinstance(element, CentrifugalPendulum) else Rule(FORMULAS[key], SOURCE, "known", "din-740")


def _rated(subject: AssessmentInput, case: LoadCaseResponse, name: str, key: str, rating: float, rule: Rule) -> Check:
    measure, response = of_rating(case.assembly, name, key, rating), case.answered
    found, kind, words = case.largest(measure), KINDS.get(key, TORQUE), rating_words(key)
    allowed = allowed_by(rating, key, service_factors(case.assembly, name)[0])
    by_order = np.abs(measure.parts(response)) ** (2 if measure.squared else 1)
    leads = key != "nominal_torque"
    seen = course(
        response, f"{words.removesuffix(' rating')} of {name}", kind, _taken(case, name, key), found.values,
        {f"{LIMITED.get(key, words)} {shown(allowed, kind, digits=4)}": allowed}, by_order if leads else None,
    )  # fmt: skip
    inputs = _factors(case, name, key, found.at)
    return at_largest(
        subject, case, measure.name, rule, found, kind, required=measure.margin, inputs=inputs,
        more="; a sum of amplitudes, an upper bound" if key == "vibratory_torque" else "", element=name,
        cause=cause(case, found.at, by_order[found.at]) if leads else None, course=seen,
    )  # fmt: skip


def _taken(case: LoadCaseResponse, name: str, key: str) -> str:
    """``TAKEN``, with the service factors that are not one."""
    temperature, starting = service_factors(case.assembly, name)
    factors = ["temperature"] if temperature != 1 and key not in ("vibratory_torque", "largest_travel") else []
    if starting != 1 and key == "maximum_torque":
        factors.append("starting")
    return TAKEN[key] + (f", times the {' and '.join(factors)} factor" if factors else "")


def _factors(case: LoadCaseResponse, name: str, key: str, at: int) -> str:
    """Service factors that went in, S_f of the order that leads."""
    if key == "largest_travel":
        return ""
    temperature, starting = service_factors(case.assembly, name)
    said = f"S_t = {temperature:g}"
    if key == "maximum_torque":
        return f"{said}, S_z = {starting:g}"
    size = np.abs(case.answered.torque[at, :, spring_of(case.assembly, name)])
    if key == "vibratory_torque" and len(size):
        return f"{said}, S_f = {case.answered.frequency_factor[at, np.argmax(size)]:.4g}"
    return said
