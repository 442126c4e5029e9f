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

import numpy as np
from numpy.typing import NDArray

from trunnion.analyses.assessment.check import Check, Rule, Status, below, judged, percent
from trunnion.analyses.assessment.own_limits import spring_of
from trunnion.analyses.assessment.subject import Case, Subject, cause
from trunnion.driveline.shafts import Coupling

SOURCE = "DIN 740-2 in form; check your edition and the maker's catalogue"
FREE_FREQUENCY = 10.0
"""Frequency [Hz] up to which S_f is 1."""
_FORMULA = {
    "nominal_torque": "T_N S_t ≤ T_KN",
    "maximum_torque": "T_peak S_t S_z ≤ T_Kmax",
    "vibratory_torque": "T_W S_t S_f ≤ T_KW, S_f = √(f/10 Hz), at least 1",
    "heat_rating": "P_W S_t ≤ P_KV",
}


def frequency_factor(frequency: float) -> float:
    """S_f of a frequency in Hz."""
    return float(np.sqrt(max(frequency, FREE_FREQUENCY) / FREE_FREQUENCY))


def coupling_ratings(subject: Subject, case: Case) -> Iterator[Check]:
    """Every rating that a coupling states."""
    for name, element in zip(subject.line.names, subject.line.elements, strict=True):
        if not isinstance(element, Coupling):
            continue
        for key, formula in _FORMULA.items():
            rating = getattr(element, key)
            title, rule = f"{key.replace('_', ' ')} of {name}", Rule(formula, SOURCE, "known")
            if rating is None:
                yield Check(f"rating: {title}", Status.NOT_APPLICABLE, rule, f"{name} states no {key}")
            elif isinstance(case.answer, str):
                yield Check(f"rating: {title}", Status.NOT_JUDGED, rule, f"no linear response: {case.answer}")
            else:
                yield _rated(subject, case, name, key, rating, rule)


def _rated(subject: Subject, case: Case, name: str, key: str, rating: float, rule: Rule) -> Check:
    response = case.response
    assert response is not None
    c = spring_of(case, name)
    factor = {one.key: one.value for one in subject.line.limits_by_element if one.element == name}
    temperature, starting = factor.get("temperature_factor", 1.0), factor.get("starting_factor", 1.0)
    by_order = np.abs(response.torque[:, :, c])
    said, unit = f"S_t = {temperature:g}", "N*m"
    if key == "nominal_torque":
        values = np.abs(response.mean_torque[:, c]) * temperature
    elif key == "maximum_torque":
        values = response.peak_torque[:, c] * temperature * starting
        said += f", S_z = {starting:g}"
    elif key == "vibratory_torque":
        factors = _factors(response.order, response.frequency, response.speed, by_order)
        values = response.vibratory_torque[:, c] * temperature * factors
    else:
        values, unit = response.heat[:, c] * temperature, "W"
    at = int(np.argmax(np.where(np.isfinite(values), values, np.inf)))
    if key == "vibratory_torque":
        said += f", S_f = {factors[at]:.4g}"
    value = float(values[at]) if np.isfinite(values[at]) else np.inf
    margin, required = below(value, rating), subject.required(name)
    why = cause(case, at, by_order[at]) if key != "nominal_torque" else None
    because = f"{value:.4g} {unit} against {rating:.4g} {unit} at {subject.shown(case.speeds[at])}, {percent(margin)}"
    return Check(
        f"rating: {key.replace('_', ' ')} of {name}", judged(margin, required), rule,
        because + (f", {why}" if why else "") + case.suffix, margin, required, value, rating, unit,
        float(case.speeds[at]), said, case.name, element=name,
        cause=why,
    )  # fmt: skip


def _factors(
    order: NDArray[np.float64], extra: NDArray[np.float64], speed: NDArray[np.float64], size: NDArray[np.float64]
) -> NDArray[np.float64]:
    """S_f at every speed, of the order that leads there."""
    if not len(order):
        return np.ones(len(speed))
    leading = np.nan_to_num(size).argmax(axis=1)
    hertz = np.abs(order[leading] * speed + extra[leading]) / (2 * np.pi)
    return np.array([frequency_factor(float(f)) for f in hertz])
