"""The limits that the description states: torque, vibratory torque, stress, twist, speed fluctuation, acceleration.

    largest |mean + vibratory| ≤ limit          of torque, stress τ = 16 T D/(π(D⁴ − d⁴)), twist
    half of peak-to-peak over the cycle ≤ limit     of vibratory torque, speed fluctuation, acceleration

by the linear response to every order, at every speed of the running range.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from trunnion.analyses.assessment.check import Check, Rule, Status
from trunnion.analyses.assessment.compared import at_worst, unanswered, worst_of
from trunnion.analyses.assessment.course import SWING, WHOLE, course
from trunnion.analyses.assessment.subject import Case, Subject, cause
from trunnion.analyses.orders.result import OrderResponse
from trunnion.arrays import Array
from trunnion.driveline.geometry import tube_stress
from trunnion.driveline.limits import LIMIT_KINDS, OneLimit
from trunnion.driveline.quantities import against, shown
from trunnion.equations.coefficients import Assembly, shaft_stiffness
from trunnion.results.counts import counted

OF_ALL = Rule("largest |mean + vibratory| over the cycle ≤ limit", "the description", "yours")
OF_SWING = Rule("half of peak-to-peak over the cycle ≤ limit", "the description", "yours")
WITHOUT_LIMIT = "torque without limit"
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


def own_limits(subject: Subject, case: Case) -> Iterator[Check]:
    """Every limit of the description, and a line for springs without any limit of torque."""
    for limit in subject.line.limits_by_element:
        if limit.key in JUDGED:
            yield _one(subject, case, limit)
    without = unlimited(case.assembly)
    if without:
        yield Check(
            WITHOUT_LIMIT,
            Status.NOT_JUDGED,
            Rule("", "the description", "yours"),
            f"{', '.join(without)}: no limit of torque or stress is stated; write [[limit]] with of and max_torque",
        )


def unlimited(assembly: Assembly) -> list[str]:
    """Springs whose torque nothing judges: no limit of torque, vibratory torque or stress, no rating."""
    keys = ("max_torque", "vibratory_torque", "max_stress", "ship_shaft")
    limited = {one.element for one in assembly.line.limits_by_element if one.key in keys}
    rated = {name for name, e in assembly.line.parts if getattr(e, "maximum_torque", None) is not None}
    springs = [assembly.line.names[i] for c in assembly.topology.compliances for i in c.shafts]
    return [name for name in springs if name not in limited | rated]


def spring_of(assembly: Assembly, element: str) -> int:
    """The spring that an element is part of."""
    place = assembly.line.index(element)
    return next(c for c, ends in enumerate(assembly.topology.compliances) if place in ends.shafts)


def name_of(limit: OneLimit) -> str:
    """ "max torque of Shaft 2"."""
    return f"{limit.key.replace('_', ' ')} of {limit.element}"


def _one(subject: Subject, case: Case, limit: OneLimit) -> Check:
    name = name_of(limit)
    rule = JUDGED[limit.key]
    if isinstance(case.answer, str):
        return unanswered(case, name, rule)
    found = limited_values(case.assembly, case.answer, limit, case.assembly.table(1))
    if isinstance(found, str):
        return Check(name, Status.NOT_APPLICABLE, rule, found)
    values, by_order = found
    kind = LIMIT_KINDS[limit.key]
    at, value = worst_of(values)
    how = (
        against(value, limit.value, kind)
        if np.isfinite(value)
        else f"no steady state (undamped resonance) against {shown(limit.value, kind, digits=4)}"
    )
    allowed = limit.value * (1 - limit.margin)
    barred = bands(case.speeds, values, np.full(len(values), allowed)) if limit.key == "vibratory_torque" else ()
    more = f"; {100 * limit.margin:.3g} % must stay free" if limit.margin else ""
    if barred:
        more += f"; beyond it {_listed(subject, barred)}"
    seen = course(
        case.answer, name.removeprefix("max "), kind, WHOLE if rule is OF_ALL else SWING, values,
        {f"{limit.key.replace('_', ' ')} {shown(limit.value, kind, digits=4)}": limit.value}, by_order,
    )  # fmt: skip
    return at_worst(
        subject, case, name, rule, at, (value, limit.value, kind.unit), how, required=limit.margin,
        inputs=judged_at(subject, case.speeds), more=more, element=limit.element, barred=barred,
        cause=cause(case, at, by_order[at]), course=seen,
    )  # fmt: skip


def judged_at(subject: Subject, speeds: Array) -> str:
    """ "201 speeds, 300 rpm to 2400 rpm"."""
    return f"{counted(len(speeds), 'speed')}, {subject.shown(speeds[0])} to {subject.shown(speeds[-1])}"


def _listed(subject: Subject, ranges: tuple[tuple[float, float], ...]) -> str:
    return " and ".join(f"{subject.shown(a)} to {subject.shown(b)}" if a < b else subject.shown(a) for a, b in ranges)


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


def limited_values(
    assembly: Assembly, response: OrderResponse, limit: OneLimit, table: Array
) -> tuple[Array, Array] | str:
    """What is limited, (speed,), and amplitudes by order (speed, order); or why there is none.

    ``table`` (1 or speed, column): the packed numbers that ``response`` was computed with.
    """
    if limit.key in ("max_speed_fluctuation", "max_acceleration"):
        return _of_disk(response, limit)
    c = spring_of(assembly, limit.element)
    torque = np.abs(response.torque[:, :, c])
    if limit.key in ("vibratory_torque", "transient_vibratory_torque"):
        return response.vibratory_torque[:, c], torque
    if limit.key == "max_torque":
        return response.peak_torque[:, c], torque
    if limit.key == "max_stress":
        factor = _stress_factors(assembly, table, limit.element)
        return response.peak_torque[:, c] * factor, torque * factor[:, None]
    twist = response.twist_range.largest[:, c] * _share(assembly, table, limit.element, c)
    return twist, np.abs(response.twist[:, :, c])


def _stress_factors(assembly: Assembly, table: Array, element: str) -> Array:
    """τ/T [1/m³] at the outside of a tube, (row,), at the rows of ``table``."""
    place = assembly.line.index(element)
    outer = table[:, assembly.packed.column(place, "outer_diameter")]
    bore = assembly.packed.column(place, "inner_diameter")
    inner = table[:, bore] if bore >= 0 else np.zeros(len(table))
    return tube_stress(outer, inner)


def _share(assembly: Assembly, table: Array, element: str, compliance: int) -> Array:
    """Share (row,) of the twist of shafts in series that falls on one of them: the softest twists most."""
    names = assembly.line.names
    shafts = assembly.topology.compliances[compliance].shafts
    soft = {names[i]: 1 / shaft_stiffness(assembly, table, i) for i in shafts}
    return np.asarray(soft[element] / sum(soft.values()))


def _of_disk(response: OrderResponse, limit: OneLimit) -> tuple[Array, Array] | str:
    if limit.element not in response.inertias:
        return HELD
    i = response.inertias.index(limit.element)
    rates = 1 if limit.key == "max_speed_fluctuation" else 2
    values = response.speed_fluctuation if rates == 1 else response.acceleration
    turning = np.abs(response.order * response.speed[:, None] + response.frequency) ** rates
    return values[:, i], np.abs(response.rotation[:, :, i]) * turning
