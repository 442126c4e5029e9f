"""Checks that compare one number with its limit: the worst over the speeds of a load case, or one of the whole line."""

from __future__ import annotations

from dataclasses import replace
from math import nan

import numpy as np

from trunnion.design.assessment.assessment_input import NO_RESPONSE, AssessmentInput, LargestShare, LoadCaseResponse
from trunnion.design.assessment.cause import Cause
from trunnion.design.assessment.check import Check, Rule, Status, below, judged, percent
from trunnion.design.assessment.response_curve import ResponseCurve
from trunnion.driveline.quantities import QuantityKind, against, shown
from trunnion.results.counts import counted

WORTH_SAYING = 1e-3
"""Share of a value from which its error is said in the sentence."""
MOST_GAPS = 4
SEPARATION = "separation of"


def unanswered(subject: AssessmentInput, case: LoadCaseResponse, name: str, rule: Rule) -> Check:
    """Of a case that has no linear response, or of which it was not reached."""
    if case.ended_by:
        return not_reached(subject, case, name, rule, case.ended_by[0])
    return Check(name, Status.NOT_JUDGED, rule, f"{NO_RESPONSE}{case.answer}")


def not_reached(subject: AssessmentInput, case: LoadCaseResponse, name: str, rule: Rule, ended: str) -> Check:
    """Of what a time limit left out; ``ended``: what ended the search, as a clause."""
    because = f"{subject.ranges([(case.low, case.high)])} not judged: {ended}{case.suffix}"
    return Check(name, Status.NOT_JUDGED, rule, because, load_case=case.name, ended=ended)


def at_largest(
    subject: AssessmentInput,
    case: LoadCaseResponse,
    name: str,
    rule: Rule,
    found: LargestShare,
    kind: QuantityKind,
    *,
    required: float = 0.0,
    words: str = "",
    inputs: str = "",
    where: str = "",
    more: str = "",
    element: str = "",
    barred: tuple[tuple[float, float], ...] = (),
    cause: Cause | None = None,
    course: ResponseCurve | None = None,
) -> Check:
    """The check of a value that must not exceed its limit, where it comes nearest to it.

    Parameters
    ----------
    kind : of value and limit.
    words : both, where the plain numbers do not do.
    inputs : what went in besides the speeds.
    where, more : what the sentence says of the speed, and what it ends with.
    """
    value, limit, speed = found.value, found.limit, float(case.speeds[found.at])
    margin = below(value, limit)
    if found.end:
        words, where = f"without bound against {shown(limit, kind, digits=4)}", f", where {found.end} end"
    elif not words and np.isfinite(value):
        words = against(value, limit, kind)
    elif not np.isfinite(value):
        words = f"no steady state (undamped resonance) against {shown(limit, kind, digits=4)}"
    known = np.isfinite(found.error)  # a search that was ended knows nothing of what it did not reach
    unsure = f" (may be {100 * found.error / value:.2g} % more)" if known and found.error > WORTH_SAYING * value else ""
    led = f", {cause}" if cause else ""
    because = f"{words}{unsure} at {subject.shown(speed)}{where}, {percent(margin)}{led}{case.suffix}{more}"
    status = judged(margin, required)
    if known and status is Status.SATISFIED and judged(below(value + found.error, limit), required) is Status.EXCEEDED:
        status, because = Status.NOT_JUDGED, f"{because}; the search did not settle closely enough to tell"
    return Check(
        name, status, rule, because, margin=margin, required_margin=required, value=value, limit=limit, unit=kind.unit,
        speed=speed, inputs="; ".join(one for one in (inputs, looked_at(subject, case)) if one), load_case=case.name,
        barred=barred, element=element, cause=cause, course=course, error=found.error, covered=((case.low, case.high),),
    )  # fmt: skip


def looked_at(subject: AssessmentInput, case: LoadCaseResponse) -> str:
    """ "searched from 300 rpm to 2400 rpm at 131 speeds"."""
    if case.low == case.high:
        return ""
    count = counted(len(case.speeds), "speed")
    return f"searched from {subject.shown(case.low)} to {subject.shown(case.high)} at {count}"


def uncovered(subject: AssessmentInput, case: LoadCaseResponse, check: Check) -> Check:
    """A check of the response that holds wherever it could be judged: not judged where there are speeds at which it
    could not, or where a time limit ended the search."""
    if case.ended_by and check.judged:
        ended = case.ended_by[0]
        status = Status.NOT_JUDGED if check.status is Status.SATISFIED else check.status
        return replace(check, status=status, because=f"{check.because}; {ended}: more may hide", ended=ended)
    gaps = case.gaps
    if not gaps or not check.judged or check.name.startswith(SEPARATION):
        return check
    said = "; ".join(f"{subject.ranges([(gap.low, gap.high)])} not judged: {gap.why}" for gap in gaps[:MOST_GAPS])
    more = f"; and {len(gaps) - MOST_GAPS} more ranges" if len(gaps) > MOST_GAPS else ""
    status = Status.NOT_JUDGED if check.status is Status.SATISFIED else check.status
    covered = tuple((piece.low, piece.high) for piece in case.stable_pieces)
    return replace(check, status=status, because=f"{check.because}; {said}{more}", covered=covered)


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
    """The check of a rule of practice for the whole line; ``compared`` and ``numbers`` as of ``at_largest``."""
    value, limit, unit = compared
    margin = below(value, limit)
    return Check(
        name, judged(margin), rule, f"{numbers}, {percent(margin, binding=False)}", margin=margin, value=value,
        limit=limit, unit=unit, speed=speed, inputs=inputs, element=element,
    )  # fmt: skip
