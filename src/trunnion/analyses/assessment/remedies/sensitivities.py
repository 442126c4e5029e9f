"""How the value of a check follows every design variable, at the speed where it binds.

A largest value over speed changes as its value at that speed does, to first order (the peak's own shift counts for
nothing): so the speed is made exact first, then every variable is moved there by a ten-thousandth and by twice that.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from trunnion.analyses.assessment.assess import by_case, of_line
from trunnion.analyses.assessment.check import Check
from trunnion.analyses.assessment.parametric import NAME as GROWTH
from trunnion.analyses.assessment.remedies.trials import at_speed
from trunnion.analyses.assessment.remedies.variables import Design, DesignVariable, Scale
from trunnion.analyses.assessment.subject import Case, Subject, cases_of
from trunnion.driveline.driveline import Driveline

Array = NDArray[np.float64]
STEP = 1e-4
"""Step of ln p, and of an angle in rad."""
ROUNDS, AROUND = 4, 17
"""Rounds of so many speeds each that close in on a peak."""


@dataclass(frozen=True)
class Sensitivity:
    """d ln(value)/d ln p of a check's value, or d ln(value)/dφ [1/rad] for an angle, and its error; where it was
    taken, ``speed`` [rad/s]."""

    check: str
    path: str
    slope: float
    error: float
    speed: float


def sensitivities(subject: Subject, design: Design, checks: Iterable[Check]) -> list[tuple[Sensitivity, ...]]:
    """Of every check to every design variable; NaN where a check has no value."""
    seen: dict[tuple[str, float, str, float], dict[str, float]] = {}

    def moved(case: Case, speed: float, check: Check, variable: DesignVariable, by: float) -> float:
        key = case.name, speed, variable.path if by else "", by
        if key not in seen or check.name == GROWTH:
            value = variable.value * np.exp(by) if variable.scale is Scale.FACTOR else variable.value + by
            line = design.changed(variable, value) if by else subject.line
            seen[key] = {} if line is None else _values(*_of(subject, case, line), check, speed)
        return seen[key].get(check.name, np.nan)

    found = []
    for check in checks:
        case = next((c for c in subject.cases if c.name == check.load_case), subject.cases[0])
        speed = _peak(subject, case, check)
        row = []
        for variable in design.variables:
            here = moved(case, speed, check, variable, 0.0)
            near, far = (
                (moved(case, speed, check, variable, h) - moved(case, speed, check, variable, -h)) / (2 * h)
                for h in (STEP, 2 * STEP)
            )
            slope = (4 * near - far) / 3
            with np.errstate(divide="ignore", invalid="ignore"):
                relative, error = np.divide((slope, abs(slope - near)), here)
            row.append(Sensitivity(check.name, variable.path, float(relative), float(error), speed))
        found.append(tuple(row))
    return found


def _of(subject: Subject, case: Case, line: Driveline) -> tuple[Subject, Case]:
    changed = replace(subject, line=line, cases=cases_of(line, subject.low, subject.high))
    return changed, next(c for c in changed.cases if c.name == case.name)


def _values(subject: Subject, case: Case, check: Check, speed: float) -> dict[str, float]:
    """Values by check at one speed of one load case, and of the line where ``check`` is one of it."""
    found: list[Check] = []
    if np.isfinite(speed):
        one = at_speed(subject, case, speed)
        found = list(by_case(one, one.cases[0], growth=check.name == GROWTH))
    if not any(one.name == check.name for one in found):
        found += of_line(subject)
    return {one.name: one.value for one in found}


def _peak(subject: Subject, case: Case, check: Check) -> float:
    """The speed where a check binds, made exact where that is a peak between two speeds of the grid."""
    grid, speed = case.speeds, check.speed
    if check.name == GROWTH or not np.any(grid == speed) or not np.isfinite(check.value):
        return speed
    at = int(np.argmax(grid == speed))
    low, high = grid[max(at - 1, 0)], grid[min(at + 1, len(grid) - 1)]
    for _ in range(ROUNDS):
        points = np.linspace(low, high, AROUND)
        one = replace(case, given=tuple(float(p) for p in points))
        here = replace(subject, cases=(one,))
        found = next((c for c in by_case(here, one, growth=False) if c.name == check.name), None)
        if found is None or not np.any(points == found.speed):
            return speed
        speed = found.speed
        low, high = max(low, speed - (high - low) / 16), min(high, speed + (high - low) / 16)
    return float(speed)
