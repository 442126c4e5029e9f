"""Ratings of elastic couplings, in the form of DIN 740-2.

    T_KN ≥ T_N S_t          mean torque, S_t the temperature factor
    T_Kmax ≥ T_peak S_t S_z     largest torque over the cycle, S_z the starting factor
    T_KW ≥ T_W S_t S_f          vibratory torque, S_f = 1 up to 10 Hz and √(f/10 Hz) above
    P_KV ≥ P_W S_t          heat of the damping

S_f is taken at the frequency of the order that leads. The factors are inputs: check them in your edition and in the
maker's catalogue.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from trunnion.analyses.assessment.check import Check, Rule, Status
from trunnion.analyses.assessment.compared import at_worst, unanswered, worst_of
from trunnion.analyses.assessment.course import SWING, WHOLE, course
from trunnion.analyses.assessment.own_limits import spring_of
from trunnion.analyses.assessment.subject import Case, Subject, cause
from trunnion.analyses.orders.result import OrderResponse
from trunnion.arrays import Array
from trunnion.driveline.quantities import POWER, TORQUE, against, shown
from trunnion.driveline.shafts import Coupling
from trunnion.equations.coefficients import Assembly

SOURCE = "DIN 740-2 in form; check your edition and the maker's catalogue"
FREE_FREQUENCY = 10.0
"""Frequency [Hz] up to which S_f is 1."""
RATINGS = {
    "nominal_torque": "T_N S_t ≤ T_KN",
    "maximum_torque": "T_peak S_t S_z ≤ T_Kmax",
    "vibratory_torque": "T_W S_t S_f ≤ T_KW, S_f = √(f/10 Hz), at least 1",
    "heat_rating": "P_W S_t ≤ P_KV",
}
TAKEN = {
    "nominal_torque": "mean, by S_t",
    "maximum_torque": f"{WHOLE}, by S_t S_z",
    "vibratory_torque": f"{SWING}, by S_t S_f",
    "heat_rating": "mean over the cycle, by S_t",
}


def frequency_factor(frequency: float) -> float:
    """S_f of a frequency in Hz."""
    return float(np.sqrt(max(frequency, FREE_FREQUENCY) / FREE_FREQUENCY))


def coupling_ratings(subject: Subject, case: Case) -> Iterator[Check]:
    """Every rating that a coupling states."""
    for name, element in subject.line.parts:
        if not isinstance(element, Coupling):
            continue
        for key, formula in RATINGS.items():
            rating = getattr(element, key)
            title, rule = f"{key.replace('_', ' ')} of {name}", Rule(formula, SOURCE, "known")
            if rating is None:
                yield Check(f"rating: {title}", Status.NOT_APPLICABLE, rule, f"{name} states no {key}")
            elif isinstance(case.answer, str):
                yield unanswered(case, f"rating: {title}", rule)
            else:
                yield _rated(subject, case, name, key, rating, rule)


def _rated(subject: Subject, case: Case, name: str, key: str, rating: float, rule: Rule) -> Check:
    response = case.answered
    found = rated_values(case.assembly, response, name, key)
    values, by_order, unit = found.values, found.by_order, found.unit
    at, value = worst_of(values)
    said = found.said + (f", S_f = {found.frequency_factor[at]:.4g}" if key == "vibratory_torque" else "")
    kind, words = TORQUE if unit == "N*m" else POWER, key.replace("_", " ")
    numbers = (
        against(value, rating, kind)
        if np.isfinite(value)
        else f"no steady state (undamped resonance) against {rating:.4g} {unit}"
    )
    seen = course(
        response, f"{words.removesuffix(' rating')} of {name}", kind, TAKEN[key], values,
        {f"{words} {shown(rating, kind, digits=4)}": rating},
        by_order if key in ("maximum_torque", "vibratory_torque") else None,
    )  # fmt: skip
    return at_worst(
        subject, case, f"rating: {words} of {name}", rule, at, (value, rating, unit), numbers,
        required=subject.required(name), inputs=said, element=name,
        cause=cause(case, at, by_order[at]) if key != "nominal_torque" else None, course=seen,
    )  # fmt: skip


@dataclass(frozen=True)
class Rated:
    """What a rating is compared with, (speed,) in ``unit``; amplitudes by order (speed, order); S_f (speed,)."""

    values: Array
    by_order: Array
    unit: str
    said: str
    frequency_factor: Array


def rated_values(assembly: Assembly, response: OrderResponse, name: str, key: str) -> Rated:
    """What the rating ``key`` of coupling ``name`` is compared with, service factors included."""
    c = spring_of(assembly, name)
    factor = {one.key: one.value for one in assembly.line.limits_by_element if one.element == name}
    temperature, starting = factor.get("temperature_factor", 1.0), factor.get("starting_factor", 1.0)
    by_order, said = np.abs(response.torque[:, :, c]), f"S_t = {temperature:g}"
    none = np.ones(len(response.speed))
    if key == "nominal_torque":
        return Rated(np.abs(response.mean_torque[:, c]) * temperature, by_order, "N*m", said, none)
    if key == "maximum_torque":
        values = response.peak_torque[:, c] * temperature * starting
        return Rated(values, by_order, "N*m", f"{said}, S_z = {starting:g}", none)
    if key == "vibratory_torque":
        factors = _factors(response.order, response.frequency, response.speed, by_order)
        return Rated(response.vibratory_torque[:, c] * temperature * factors, by_order, "N*m", said, factors)
    return Rated(response.heat[:, c] * temperature, by_order, "W", said, none)


def _factors(order: Array, extra: Array, speed: Array, size: Array) -> Array:
    """S_f at every speed, of the order that leads there."""
    if not len(order):
        return np.ones(len(speed))
    leading = np.nan_to_num(size).argmax(axis=1)
    hertz = np.abs(order[leading] * speed + extra[leading]) / (2 * np.pi)
    return np.array([frequency_factor(float(f)) for f in hertz])
