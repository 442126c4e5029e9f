"""Gears: the power that they lose stays below what they bear continuously.

Σ L |ω| + M_d ω ≤ P, of all meshes of an element and of its drag, at the mean torques and speeds
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from trunnion.arrays import Array
from trunnion.design.assessment.assessment_input import AssessmentInput, LoadCaseResponse
from trunnion.design.assessment.check import Check, Rule, Status, judged, percent
from trunnion.driveline.loss_curves import loses
from trunnion.driveline.quantities import POWER, against, shown
from trunnion.equations.coefficients import Assembly
from trunnion.equations.gear_losses import lost_power
from trunnion.equations.loads import gear_losses

RULE = Rule("P lost ≤ P over the mean speeds", "the maker's sheet", "yours", "gear-heat")
POINTS = 257
"""Speeds at which it is looked at."""


def gear_heat(subject: AssessmentInput, case: LoadCaseResponse) -> Iterator[Check]:
    """All gears of the line that lose power; nothing of lines without any."""
    names = case.assembly.line.names
    lossy = [i for i, element in enumerate(case.assembly.line.elements) if loses(element)]
    if not lossy:
        return
    speed = np.linspace(case.low, case.high, POINTS if case.high > case.low else 1)
    power = _power(case.assembly, speed)
    for i in lossy:
        lost, rating = power[i], getattr(case.assembly.line.elements[i], "heat_rating", None)
        title, at = f"heat of {names[i]}", int(power[i].argmax())
        value, there = float(lost[at]), float(speed[at])
        if rating is None:
            most = f"{shown(value, POWER, digits=4)} at {subject.shown(there)}"
            yield Check(title, Status.NOT_APPLICABLE, RULE, f"{names[i]} states no heat_rating; it loses {most}")
            continue
        margin = 1 - value / float(rating)
        yield Check(
            title, judged(margin), RULE,
            f"{against(value, float(rating), POWER)} at {subject.shown(there)}, {percent(margin)}{case.suffix}",
            margin=margin, value=value, limit=float(rating), unit="W", speed=there, load_case=case.name,
            inputs="mean torques and speeds of the meshes", error=_error(lost, at), element=names[i],
            covered=((case.low, case.high),),
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


def _error(power: Array, at: int) -> float:
    """What the top between two points may rise above the higher one: nothing at an end of the range."""
    if not 0 < at < len(power) - 1:
        return 0.0
    return float(max(2 * power[at] - power[at - 1] - power[at + 1], 0.0))
