"""How the value of a check follows every design variable, in logarithms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from trunnion.analyses.assessment.check import Check
from trunnion.analyses.assessment.remedies.variables import Design
from trunnion.analyses.assessment.subject import Subject
from trunnion.analyses.sensitivity.checks import check_slopes
from trunnion.analyses.sensitivity.directions import Neighbours, directions_of
from trunnion.arrays import Array


@dataclass(frozen=True)
class LogarithmicSlopes:
    """d ln(value)/d ln p of checks' values by design variables (check, variable), d ln(value)/dφ [1/rad] for angles;
    error; speed (check,) [rad/s] where they were taken."""

    slope: Array
    error: Array
    speed: Array


def sensitivities(subject: Subject, design: Design, checks: Sequence[Check]) -> LogarithmicSlopes:
    """Of every check to every design variable; NaN where a check has no value. Of bent lines that start free about the
    motion of rigid shafts, right to first order in what joints force."""
    assembly = subject.cases[0].assembly
    directions = directions_of(assembly, [v.path for v in design.variables]) if design.variables else ()
    if subject.cases[0].costly:
        subject = replace(subject, cases=tuple(replace(case, rough=True) for case in subject.cases))
    found = check_slopes(subject, Neighbours(assembly), directions, checks)
    size = np.array([one.size for one in directions]).reshape(1, -1)
    value = found.value[:, :1]
    with np.errstate(divide="ignore", invalid="ignore"):
        return LogarithmicSlopes(
            found.slope[:, 0] * size / value, found.error[:, 0] * size / np.abs(value), found.speed
        )
