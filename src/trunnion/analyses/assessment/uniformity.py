"""Uniformity of the whole line, the guideline of Cardan-shaft makers.

    U = (largest − smallest output speed)/mean ≤ 0.0027     (Elbe)

the irregularity of one Hooke's joint of 2.98°, U = sin β tan β.
"""

from __future__ import annotations

from collections.abc import Iterator

from trunnion.analyses.assessment.check import Check, Rule, Status
from trunnion.analyses.assessment.compared import guideline
from trunnion.analyses.assessment.subject import Subject
from trunnion.analyses.kinetostatics import Kinetostatics
from trunnion.analyses.kinetostatics.limits import EVEN_RUNNING
from trunnion.driveline.driveline import hooke_joints
from trunnion.driveline.quantities import DEGREE

RULE = Rule("U = (n_max − n_min)/n ≤ 0.0027", "Elbe, Cardan shafts", "typical")


def uniformity(subject: Subject, turn: Kinetostatics | None) -> Iterator[Check]:
    """U at the end of every branch, shafts rigid."""
    if not hooke_joints(subject.line):
        yield Check("uniformity", Status.NOT_APPLICABLE, RULE, "the line has no Hooke's joint")
        return
    if turn is None:
        yield Check("uniformity", Status.NOT_APPLICABLE, RULE, "the output is prescribed")
        return
    for branch in turn.branches:
        end = turn.on_branch(branch)
        u = end.irregularity
        angle = end.equivalent_angle / DEGREE
        numbers = f"U = {u:.4g} against 0.0027, as one joint of {angle:.3g} deg"
        title = "uniformity" if len(turn.branches) == 1 else f"uniformity of {branch}"
        yield guideline(title, RULE, (u, EVEN_RUNNING, "1"), numbers, inputs="rigid shafts")
