"""Brakes: the power of their friction stays below what they bear continuously.

T(ω) ω ≤ P, ω the mean speed of the brake's shaft
"""

from __future__ import annotations

from collections.abc import Iterator

from trunnion.design.assessment.assessment_input import AssessmentInput, LoadCaseResponse
from trunnion.design.assessment.check import Check, Rule, Status
from trunnion.design.assessment.mean_heat import heat_check, speeds
from trunnion.driveline.brakes import Brake

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
        speed = speeds(case, POINTS)
        turning = speed * abs(float(topo.mean_speeds[station]))
        yield heat_check(
            subject, case, RULE, title=title, element=name, speed=speed, power=brake.load.value(turning) * turning,
            rating=float(brake.heat_rating), inputs="mean power of friction at the mean speed",
        )  # fmt: skip
