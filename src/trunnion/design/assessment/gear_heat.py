"""Gears: the power that they lose stays below what they bear continuously.

Σ L |ω| + M_d ω ≤ P, of all meshes of an element and of its drag, at the mean torques and speeds
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from trunnion.arrays import Array
from trunnion.design.assessment.assessment_input import AssessmentInput, LoadCaseResponse
from trunnion.design.assessment.check import Check, Rule, Status
from trunnion.design.assessment.converter_heat import POINTS as CONVERTER_POINTS
from trunnion.design.assessment.mean_heat import heat_check, speeds
from trunnion.driveline.loss_curves import loses
from trunnion.driveline.quantities import POWER, shown
from trunnion.equations.coefficients import Assembly
from trunnion.equations.gear_losses import lost_power
from trunnion.equations.loads import gear_losses

RULE = Rule("P lost ≤ P over the mean speeds", "the maker's sheet", "yours", "gear-heat")
POINTS = 257
"""Speeds at which it is looked at; where a torque converter runs otherwise at each, those of its heat."""


def gear_heat(subject: AssessmentInput, case: LoadCaseResponse) -> Iterator[Check]:
    """All gears of the line that lose power; nothing of lines without any."""
    names = case.assembly.line.names
    lossy = [i for i, element in enumerate(case.assembly.line.elements) if loses(element)]
    if not lossy:
        return
    speed = speeds(case, POINTS if case.assembly.stated is None else CONVERTER_POINTS)
    power = _power(case.assembly, speed)
    for i in lossy:
        lost, rating = power[i], getattr(case.assembly.line.elements[i], "heat_rating", None)
        title = f"heat of {names[i]}"
        if rating is None:
            at = int(lost.argmax())
            most = f"{shown(float(lost[at]), POWER, digits=4)} at {subject.shown(float(speed[at]))}"
            yield Check(title, Status.NOT_APPLICABLE, RULE, f"{names[i]} states no heat_rating; it loses {most}")
            continue
        yield heat_check(
            subject, case, RULE, title=title, element=names[i], speed=speed, power=lost, rating=float(rating),
            inputs="mean torques and speeds of the meshes",
        )  # fmt: skip


def _power(assembly: Assembly, speed: Array) -> dict[int, Array]:
    """Power lost (speed,) [W] by every element that loses some."""
    found: dict[int, Array] = {}
    each = assembly.each(speed) or [assembly]
    for one, own in zip(each, [speed[k : k + 1] for k in range(len(speed))] if len(each) > 1 else [speed], strict=True):
        table = one.table(len(own), own)
        lost = lost_power(one.topology, gear_losses(one.topology, one.packed.column, table), own)
        for i, power in lost.items():
            found[i] = np.concatenate([found[i], power]) if i in found else power
    return found
