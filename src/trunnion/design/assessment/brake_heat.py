"""Brakes: the power of their friction stays below what they bear continuously.

T(ω) ω ≤ P, ω the mean speed of the brake's shaft
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from trunnion.arrays import Array
from trunnion.design.assessment.assessment_input import AssessmentInput, LoadCaseResponse
from trunnion.design.assessment.check import Check, Rule, Status, judged, percent
from trunnion.driveline.brakes import Brake
from trunnion.driveline.quantities import POWER, against

RULE = Rule("T ω ≤ P over the mean speeds", "the maker's sheet", "yours", "brake-heat")
POINTS = 2001
"""Speeds at which friction that falls with the speed is looked at; its power has one top at most."""


def brake_heat(subject: AssessmentInput, case: LoadCaseResponse) -> Iterator[Check]:
    """Every brake of the line; nothing of lines without any."""
    topo = case.assembly.topology
    for (station, _), (name, brake) in zip(topo.disks, topo.rotors, strict=True):
        if not isinstance(brake, Brake):
            continue
        title = f"friction power of {name}"
        if brake.heat_rating is None:
            yield Check(title, Status.NOT_APPLICABLE, RULE, f"{name} states no heat_rating")
            continue
        speed = np.linspace(case.low, case.high, POINTS if case.high > case.low else 1)
        turning = speed * abs(float(topo.mean_speeds[station]))
        power = brake.load.value(turning) * turning
        at = int(power.argmax())
        value, limit = float(power[at]), float(brake.heat_rating)
        margin = 1 - value / limit
        where = f"at {subject.shown(float(speed[at]))}"
        error = _error(power, at) if len(power) > 1 else 0.0
        yield Check(
            title, judged(margin), RULE, f"{against(value, limit, POWER)} {where}, {percent(margin)}{case.suffix}",
            margin=margin, value=value, limit=limit, unit="W", speed=float(speed[at]), load_case=case.name,
            inputs="mean power of friction at the mean speed", error=error, element=name,
            covered=((case.low, case.high),),
        )  # fmt: skip


def _error(power: Array, at: int) -> float:
    """What the top between two points may rise above the higher one: nothing at an end of the range."""
    if not 0 < at < len(power) - 1:
        return 0.0
    return float(max(2 * power[at] - power[at - 1] - power[at + 1], 0.0))
