"""Couplings settle below the temperature that their rubber may have: heat and stiffness in balance.

T_ambient + R P(T) = T ≤ T_max, at every speed that is looked at
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from trunnion.arrays import Array
from trunnion.design.assessment.assessment_input import AssessmentInput, LoadCaseResponse
from trunnion.design.assessment.check import Check, Rule, Status, judged, percent
from trunnion.design.assessment.compared import unanswered
from trunnion.driveline.couplings import Coupling
from trunnion.driveline.quantities import TEMPERATURE, against, shown
from trunnion.errors import ComputationError, InputError
from trunnion.response.coupling_temperatures import CouplingTemperatures, coupling_temperatures
from trunnion.response.orders.result import OrderResponse

RULE = Rule("T ≤ T_max where T = T_ambient + R P(T)", "the maker's sheet", "yours", "coupling-temperature")
MOST_SPEEDS = 121
"""Speeds of the response at which temperatures are followed first."""
ROUNDS, CLOSER = 3, 9
"""Times that the neighbourhood of the hottest speed is looked at more closely, and speeds of each."""


def coupling_heat(subject: AssessmentInput, case: LoadCaseResponse) -> Iterator[Check]:
    """Every coupling that states how it gives its heat away; nothing of lines without any."""
    heated = [(n, e) for n, e in subject.line.parts if isinstance(e, Coupling) and e.thermal_resistance is not None]
    if not heated:
        return
    if isinstance(case.answer, str):
        for name, _ in heated:
            yield unanswered(subject, case, f"temperature of {name}", RULE)
        return
    followed = _followed(case, case.answer) if any(e.highest_temperature is not None for _, e in heated) else ""
    for name, element in heated:
        title = f"temperature of {name}"
        if element.highest_temperature is None:
            yield Check(title, Status.NOT_APPLICABLE, RULE, f"{name} states no highest_temperature")
        elif isinstance(followed, str):
            yield Check(title, Status.NOT_JUDGED, RULE, f"{followed}{case.suffix}", load_case=case.name)
        else:
            yield _settled(subject, case, name, element, followed)


def _followed(case: LoadCaseResponse, response: OrderResponse) -> list[CouplingTemperatures] | str:
    """At speeds of the response, those of most heat among them, then closer about the hottest; or why not."""
    try:
        found = [coupling_temperatures(case.assembly, _speeds(response))]
        for _ in range(ROUNDS if len(response.speed) > 1 else 0):
            speed, hottest = _rising(found)
            at = int(hottest.argmax())
            low, high = speed[max(at - 1, 0)], speed[min(at + 1, len(speed) - 1)]
            if not np.isfinite(hottest[at]):
                break
            found.append(coupling_temperatures(case.assembly, np.linspace(low, high, CLOSER)))
    except (InputError, ComputationError) as error:
        return f"temperatures could not be followed: {str(error).splitlines()[0]}"
    return found


def _speeds(response: OrderResponse) -> Array:
    """Speeds of the response, not more than so many, and every one about which a coupling has most heat."""
    speed = response.speed
    if len(speed) <= MOST_SPEEDS:
        return speed
    heat = np.nan_to_num(response.heat).sum(axis=1)
    tops = np.flatnonzero((heat[1:-1] >= heat[:-2]) & (heat[1:-1] >= heat[2:])) + 1
    tops = tops[np.argsort(-heat[tops])][: MOST_SPEEDS // 2]
    evenly = np.linspace(0, len(speed) - 1, MOST_SPEEDS - len(tops)).astype(int)
    return np.asarray(speed[np.unique([*evenly, *tops])])


def _rising(found: list[CouplingTemperatures]) -> tuple[Array, Array]:
    """All speeds, and the highest share at them of what any coupling may have above its surroundings."""
    speed = np.concatenate([one.speed for one in found])
    hottest = np.concatenate([np.nan_to_num(one.temperature, nan=np.inf).max(axis=1) for one in found])
    order = np.argsort(speed)
    return speed[order], hottest[order]


def _settled(
    subject: AssessmentInput, case: LoadCaseResponse, name: str, element: Coupling, found: list[CouplingTemperatures]
) -> Check:
    assert element.highest_temperature is not None and element.ambient_temperature is not None
    place = found[0].couplings.index(name)
    speed = np.concatenate([one.speed for one in found])
    temperature = np.concatenate([one.temperature[:, place] for one in found])
    at = int(np.nan_to_num(temperature, nan=np.inf).argmax())
    value, limit = float(temperature[at]), float(element.highest_temperature)
    count = f"{len(np.unique(speed))} speeds, closest about the hottest"
    inputs = f"settled temperatures at {count}" if len(speed) > 1 else ""
    taken = shown(float(element.temperature or np.nan), TEMPERATURE, digits=4)
    more = f"; all other checks take it at {taken}, as stated"
    where = f"at {subject.shown(float(speed[at]))}"
    if np.isnan(value):
        end = shown(float(found[0].ends[place]), TEMPERATURE)
        because = f"settles at no temperature up to {end} {where}{case.suffix}{more}"
        return Check(
            f"temperature of {name}", Status.EXCEEDED, RULE, because, margin=-np.inf, value=np.inf, limit=limit,
            unit="K", speed=float(speed[at]), inputs=inputs, load_case=case.name, element=name,
        )  # fmt: skip
    margin = (limit - value) / (limit - float(element.ambient_temperature))
    because = f"{against(value, limit, TEMPERATURE)} {where}, {percent(margin)} of the rise{case.suffix}{more}"
    before = np.nanmax(np.concatenate([one.temperature[:, place] for one in found[:-1]] or [temperature]))
    return Check(
        f"temperature of {name}", judged(margin, 0.0), RULE, because, margin=margin, value=value, limit=limit, unit="K",
        speed=float(speed[at]), inputs=inputs, load_case=case.name, element=name, error=abs(value - float(before)),
        covered=((case.low, case.high),),
    )  # fmt: skip
