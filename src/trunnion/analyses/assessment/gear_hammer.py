"""Gear hammer: a mesh separates where its vibratory torque is larger than its mean torque.

    half of peak-to-peak of the torque ≤ |mean torque|   (known)

A rigid Ratio has no mesh to separate. Backlash and what follows after separation belong to the nonlinear analyses.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from trunnion.analyses.assessment.check import Check, Rule, Status
from trunnion.analyses.assessment.compared import at_worst, unanswered
from trunnion.analyses.assessment.course import SWING, course
from trunnion.analyses.assessment.own_limits import bands, spring_of
from trunnion.analyses.assessment.subject import Case, Subject, cause
from trunnion.driveline.gears import GearPair
from trunnion.driveline.quantities import TORQUE

RULE = Rule("half of peak-to-peak ≤ |mean torque|", "loss of contact", "known")
NOTHING = 1e-3
"""Share of its vibratory torque below which a mesh carries no mean torque: what losses and rounding leave."""


def gear_hammer(subject: Subject, case: Case) -> Iterator[Check]:
    """Every mesh of the line."""
    pairs = [n for n, e in subject.line.parts if isinstance(e, GearPair)]
    if not pairs:
        yield Check("gear hammer", Status.NOT_APPLICABLE, RULE, "the line has no GearPair")
    for name in pairs:
        title = f"gear hammer in {name}"
        if isinstance(case.answer, str):
            yield unanswered(case, title, RULE)
            continue
        c = spring_of(case.assembly, name)
        swing, mean = case.answer.vibratory_torque[:, c], np.abs(case.answer.mean_torque[:, c])
        swing = np.where(np.isfinite(swing), swing, np.inf)
        if np.all(mean <= NOTHING * swing):
            yield _idle(subject, case, title)
            continue
        with np.errstate(divide="ignore", invalid="ignore"):
            at = int(np.argmax(np.where(mean > 0, swing / mean, np.inf)))
        required = subject.required(name)
        numbers = f"±{swing[at]:.4g} N*m about a mean of {mean[at]:.4g} N*m"
        by_order = np.abs(case.answer.torque[:, :, c])
        yield at_worst(
            subject, case, title, RULE, at, (float(swing[at]), float(mean[at]), "N*m"), numbers, required=required,
            element=name, barred=bands(case.speeds, swing, mean * (1 - required)), cause=cause(case, at, by_order[at]),
            course=course(case.answer, f"torque of {name}", TORQUE, SWING, swing, {"mean torque": mean}, by_order),
        )  # fmt: skip


def _idle(subject: Subject, case: Case, title: str) -> Check:
    """Of a mesh that carries no mean torque; where the line has load cases, they judge it."""
    if not case.name and len(subject.cases) > 1:
        return Check(title, Status.NOT_APPLICABLE, RULE, "no mean torque without a load case: under load it is judged")
    because = "the mesh carries no mean torque, so that any vibration parts its teeth: state a load_torque"
    return Check(title, Status.NOT_JUDGED, RULE, because + case.suffix, load_case=case.name)
