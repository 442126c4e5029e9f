"""Checks that compare one number with its limit: the worst over the speeds of a load case, or one of the whole line."""

from __future__ import annotations

from math import nan

import numpy as np

from trunnion.analyses.assessment.cause import Cause
from trunnion.analyses.assessment.check import Check, Rule, Status, below, judged, percent
from trunnion.analyses.assessment.course import Course
from trunnion.analyses.assessment.subject import NO_RESPONSE, Case, Subject
from trunnion.arrays import Array


def unanswered(case: Case, name: str, rule: Rule) -> Check:
    """Of a case that has no linear response."""
    return Check(name, Status.NOT_JUDGED, rule, f"{NO_RESPONSE}{case.answer}")


def worst_of(values: Array) -> tuple[int, float]:
    """Place and size of the largest over speeds (speed,); infinite where there is no steady state."""
    at = int(np.argmax(np.where(np.isfinite(values), values, np.inf)))
    return at, float(values[at]) if np.isfinite(values[at]) else np.inf


def at_worst(
    subject: Subject,
    case: Case,
    name: str,
    rule: Rule,
    at: int,
    compared: tuple[float, float, str],
    numbers: str,
    *,
    required: float = 0.0,
    inputs: str = "",
    where: str = "",
    more: str = "",
    element: str = "",
    barred: tuple[tuple[float, float], ...] = (),
    cause: Cause | None = None,
    course: Course | None = None,
) -> Check:
    """The check of a value that must not exceed its limit, at number ``at`` of the speeds of ``case``.

    Parameters
    ----------
    compared : value, limit and their unit.
    numbers : both in words.
    where, more : what the sentence says of the speed, and what it ends with.
    """
    value, limit, unit = compared
    speed, margin = float(case.speeds[at]), below(value, limit)
    led = f", {cause}" if cause else ""
    because = f"{numbers} at {subject.shown(speed)}{where}, {percent(margin)}{led}{case.suffix}{more}"
    return Check(
        name, judged(margin, required), rule, because, margin, required, value, limit, unit, speed, inputs, case.name,
        barred, element=element, cause=cause, course=course,
    )  # fmt: skip


def guideline(
    name: str,
    rule: Rule,
    compared: tuple[float, float, str],
    numbers: str,
    *,
    speed: float = nan,
    inputs: str = "",
    element: str = "",
) -> Check:
    """The check of a rule of practice for the whole line; ``compared`` and ``numbers`` as of ``at_worst``."""
    value, limit, unit = compared
    margin = below(value, limit)
    return Check(
        name, judged(margin), rule, f"{numbers}, {percent(margin)}", margin, 0.0, value, limit, unit, speed, inputs,
        guideline=True, element=element,
    )  # fmt: skip
