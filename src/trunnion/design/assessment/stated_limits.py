"""The limits that the description states: torque, vibratory torque, stress, twist, speed fluctuation, acceleration.

    largest |mean + vibratory| ≤ limit          of torque, stress τ = 16 T D/(π(D⁴ − d⁴)), twist
    half of peak-to-peak over the cycle ≤ limit     of vibratory torque, speed fluctuation, acceleration

by the linear response to every order, wherever in the running range it is largest (``response.ranges.largest``).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from trunnion.arrays import Array
from trunnion.design.assessment.assessment_input import AssessmentInput, LoadCaseResponse, cause
from trunnion.design.assessment.check import Check, Rule, Status
from trunnion.design.assessment.compared import at_largest, unanswered
from trunnion.design.assessment.measures import name_of, of_limit
from trunnion.design.assessment.response_curve import SWING, WHOLE, course
from trunnion.driveline.limits import LIMIT_KINDS, WITHOUT_LIMIT, OneLimit
from trunnion.driveline.quantities import shown
from trunnion.equations.coefficients import Assembly

OF_ALL = Rule("largest |mean + vibratory| over the cycle ≤ limit", "the description", "yours", "own-limits")
OF_SWING = Rule("half of peak-to-peak over the cycle ≤ limit", "the description", "yours", "own-limits")
HELD = "a ConstantSpeed holds its rotation"
JUDGED = {
    "max_torque": OF_ALL,
    "vibratory_torque": OF_SWING,
    "transient_vibratory_torque": OF_SWING,
    "max_stress": OF_ALL,
    "max_twist": OF_ALL,
    "max_speed_fluctuation": OF_SWING,
    "max_acceleration": OF_SWING,
}


def stated_limits(subject: AssessmentInput, case: LoadCaseResponse) -> Iterator[Check]:
    """Every limit of the description, and a line for springs without any limit of torque."""
    for limit in subject.line.limits_by_element:
        if limit.key in JUDGED:
            yield _one(subject, case, limit)
    without = unlimited(case.assembly)
    if without:
        yield Check(
            WITHOUT_LIMIT,
            Status.NOT_JUDGED,
            Rule("", "the description", "yours", "own-limits"),
            f"{', '.join(without)}: no limit of torque or stress is stated; write [[limit]] with of and max_torque",
        )


def unlimited(assembly: Assembly) -> list[str]:
    """Springs whose torque nothing judges: no limit of torque, vibratory torque or stress, no rating."""
    keys = ("max_torque", "vibratory_torque", "max_stress", "ship_shaft")
    limited = {one.element for one in assembly.line.limits_by_element if one.key in keys}
    rating = ("maximum_torque", "largest_travel")
    rated = {name for name, e in assembly.line.parts if any(getattr(e, key, None) is not None for key in rating)}
    springs = [assembly.line.names[i] for c in assembly.topology.compliances for i in c.shafts]
    return [name for name in dict.fromkeys(springs) if name not in limited | rated]


def _one(subject: AssessmentInput, case: LoadCaseResponse, limit: OneLimit) -> Check:
    name, rule, kind = name_of(limit), JUDGED[limit.key], LIMIT_KINDS[limit.key]
    measure = of_limit(case.assembly, limit)
    if measure is None:
        return Check(name, Status.NOT_APPLICABLE, rule, HELD)
    if isinstance(case.answer, str):
        return unanswered(subject, case, name, rule)
    found = case.largest(measure)
    barred = bands(case.speeds, found.values, found.limits * (1 - limit.margin)) if measure.bars else ()
    more = f"; {100 * limit.margin:.3g} % must stay free" if limit.margin else ""
    if barred:
        more += f"; beyond it {subject.ranges(barred)}"
    by_order = np.abs(measure.parts(case.answer))
    seen = course(
        case.answer, name.removeprefix("max "), kind, WHOLE if rule is OF_ALL else SWING, found.values,
        {f"{limit.key.replace('_', ' ')} {shown(limit.value, kind, digits=4)}": limit.value}, by_order,
    )  # fmt: skip
    return at_largest(
        subject, case, name, rule, found, kind, required=limit.margin, more=more, element=limit.element,
        barred=barred, cause=cause(case, found.at, by_order[found.at]), course=seen,
    )  # fmt: skip


def bands(speeds: Array, values: Array, limit: Array) -> tuple[tuple[float, float], ...]:
    """Ranges of speed where ``values`` lie above ``limit``, their ends interpolated."""
    over = np.where(np.isfinite(values), values - limit, np.inf)
    found, start = [], None
    for i, excess in enumerate(over):
        if excess > 0 and start is None:
            start = speeds[0] if i == 0 else _crossing(speeds[i - 1 : i + 1], over[i - 1 : i + 1])
        if start is not None and (excess <= 0 or i == len(over) - 1):
            end = speeds[i] if excess > 0 else _crossing(speeds[i - 1 : i + 1], over[i - 1 : i + 1])
            found.append((float(start), float(end)))
            start = None
    return tuple(found)


def _crossing(speeds: Array, over: Array) -> float:
    if not np.all(np.isfinite(over)):
        return float(speeds[0] if over[0] > 0 else speeds[1])
    return float(speeds[0] + (speeds[1] - speeds[0]) * over[0] / (over[0] - over[1]))
