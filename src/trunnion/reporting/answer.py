"""What an engineer asks first: is the line fit for its speeds, what binds, what lies just beyond?

Nothing here is drawn, and nothing compiled that the answer does not need: charts and pictures follow it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from trunnion.analyses.assessment.assess import by_case, checks_of, judgement, subject_of
from trunnion.analyses.assessment.check import Check, Status, worst
from trunnion.analyses.assessment.result import Assessment
from trunnion.analyses.assessment.separation import NEEDS as MODES_NEED
from trunnion.analyses.assessment.subject import NO_RESPONSE, Case, Subject, lossy
from trunnion.analyses.charts.axes import lowest_speed
from trunnion.analyses.linear.along import NoSharedMotion, StabilityAlong
from trunnion.analyses.linear.natural_frequencies import NaturalFrequencies, natural_frequencies
from trunnion.analyses.linear.resonance_speeds import ResonanceSpeeds, resonance_speeds
from trunnion.driveline.driveline import Driveline, hooke_joints
from trunnion.driveline.operating_speed import operating_speed, speed_unit
from trunnion.driveline.operation import Operation
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.steady_base import require_steady_base
from trunnion.errors import ComputationError, InputError
from trunnion.reporting.overview_findings import (
    BEYOND,
    along_findings,
    free_findings,
    line_findings,
    remark_findings,
    resonance_findings,
    response_findings,
    slow_findings,
)
from trunnion.reporting.ranges import speed_range
from trunnion.results.counts import few
from trunnion.results.finding import Finding, Gravity, by_gravity

NEARLY = 0.1
"""Spare margin below which a check deserves a word though it is satisfied."""
POINTS_BEYOND = 21


@dataclass(frozen=True)
class Answer:
    """The verdict on a line over its running range, and what belongs to it.

    operation: the description's, at the ``speed`` [rad/s] asked for (None without one); speed_range [rad/s]: of the
    description, or guessed from the line where it states none; subject: what was judged, its responses included;
    along: stability along the range at the joints' own angles, None where nothing makes the coefficients vary or where
    each speed takes its own motion; resonance_speeds: those in the range.
    """

    line: Driveline
    assembly: Assembly
    unit: str
    speed: float | None
    operation: Operation
    speed_range: tuple[float, float]
    natural_frequencies: NaturalFrequencies
    resonance_speeds: ResonanceSpeeds
    subject: Subject
    assessment: Assessment
    along: StabilityAlong | None
    findings: tuple[Finding, ...]


def answer(line: Driveline, *, speed: float | None = None, unit: str | None = None) -> Answer:
    """Judge ``line`` over its range; see ``overview`` for the parameters.

    Raises
    ------
    InputError : the line has no equations of motion, or no steady motion to judge.
    """
    unit = unit or speed_unit(line)
    assembly = assemble(line)
    if speed is not None or (line.operation and line.operation.speed):
        speed = operating_speed(line, speed)
        require_steady_base(assembly, assembly.table(1, speed))
    low, high = speed_range(line)
    subject = replace(subject_of(line, (low, high), None, unit), speed=speed)
    assessment = judgement(subject, checks_of(subject))
    every = resonance_speeds(assembly)
    here = every.within(low, high)
    along = _along(subject.cases[0])
    joints, slowest = hooke_joints(line), lowest_speed(assembly)
    findings = [
        *check_findings(assessment),
        *assessment.findings,
        *beyond_findings(subject, assessment),
        *(along_findings(assembly, along, unit) if along else ()),
        *line_findings(line, speed),
        *resonance_findings(here, (low, high), speed, unit),
        *(() if lossy(assembly) else response_findings(assembly, every, (low, high), unit)),
        *(slow_findings(high, slowest, unit) if joints and high <= slowest else ()),
        *(free_findings(assembly, along, unit) if joints and assembly.topology.free and not lossy(assembly) else ()),
        *remark_findings(line),
    ]
    return Answer(
        line=line,
        assembly=assembly,
        unit=unit,
        speed=speed,
        operation=(line.operation or Operation()).model_copy(update={"speed": speed}),
        speed_range=(low, high),
        natural_frequencies=natural_frequencies(assembly),
        resonance_speeds=here,
        subject=subject,
        assessment=assessment,
        along=along,
        findings=by_gravity(_once(findings)),
    )


def _once(findings: list[Finding]) -> list[Finding]:
    return list({finding.sentence: finding for finding in findings}.values())


def _along(case: Case) -> StabilityAlong | None:
    if not case.parametric:
        return None
    try:
        return case.along
    except (NoSharedMotion, InputError, ComputationError):  # the check says why
        return None


def check_findings(assessment: Assessment) -> list[Finding]:
    """What is exceeded, what nearly is, and what could not be judged, by margin; a reason that several share once."""
    found = []
    unjudged: dict[tuple[Gravity, str], list[str]] = {}
    for check in assessment.checks:
        if check.status is Status.EXCEEDED:
            gravity = Gravity.CAUTION if check.guideline else Gravity.DANGER
            found.append(Finding(gravity, f"{capital(check.name)} is exceeded: {check.because}."))
        elif check.status is Status.SATISFIED and check.spare < NEARLY:
            found.append(Finding(Gravity.CAUTION, f"{capital(check.name)} is nearly reached: {check.because}."))
        elif check.status is Status.NOT_JUDGED:
            gravity = Gravity.CAUTION if np.isfinite(check.margin) else Gravity.NOTE
            unjudged.setdefault((gravity, check.because.removeprefix(NO_RESPONSE)), []).append(check.name)
    needs: dict[str, list[tuple[Gravity, str, list[str]]]] = {}
    for (gravity, because), names in unjudged.items():
        said, _, need = because.partition(MODES_NEED)
        if need:
            needs.setdefault(need, []).append((gravity, said, names))
            continue
        found.append(
            Finding(gravity, f"{capital(few(names))} {'is' if len(names) == 1 else 'are'} not judged: {because}.")
        )
    return [*found, *(_modes(need, group) for need, group in needs.items())]


def _modes(need: str, group: list[tuple[Gravity, str, list[str]]]) -> Finding:
    """Modes that need the same checks, in one sentence."""
    names = [name for _, _, names in group for name in names]
    numbers = [name.removeprefix("separation of mode ") for name in names]
    listed = f"separation of {'mode' if len(names) == 1 else 'modes'} {_and(numbers)}"
    said = "; ".join(said for _, said, _ in group)
    that = "that needs" if len(names) == 1 else "these need"
    return Finding(group[0][0], f"{capital(listed)} is not judged: {said}; {that} {need}.")


def _and(words: list[str]) -> str:
    return " and ".join([", ".join(words[:-1]), words[-1]]) if len(words) > 1 else words[0]


def beyond_findings(subject: Subject, assessment: Assessment) -> list[Finding]:
    """Checks that would be exceeded up to ``BEYOND`` outside the range under any load case, and are not inside it; and
    where torques cannot be told there though they are inside: a table of excitations that ends, say."""
    low, high = subject.low, subject.high
    if not low < high:
        return []
    inside = {check.name for check in assessment.checks if check.status is Status.EXCEEDED}
    found = []
    for ends, side in (((1 - BEYOND) * low, low), "below"), ((high, (1 + BEYOND) * high), "above"):
        if not 0 < ends[0] < ends[1] or ends[1] <= lowest_speed(subject.cases[0].assembly):
            continue
        cases = [replace(case, low=ends[0], high=ends[1], points=POINTS_BEYOND) for case in subject.cases]
        there = replace(subject, low=ends[0], high=ends[1], cases=tuple(cases))
        checks = worst(
            check for k, case in enumerate(cases) for check in by_case(there, case, growth=not (k and case.costly))
        )
        found += [_beyond(c, side) for c in checks if c.status is Status.EXCEEDED and c.name not in inside]
        untold = [case.answer for known, case in zip(subject.cases, cases, strict=True) if known.response]
        for why in dict.fromkeys(answer for answer in untold if isinstance(answer, str)):
            found.append(Finding(Gravity.NOTE, f"{_just(side)} no torque is judged: {why}."))
    return found


def _just(side: str) -> str:
    return f"Just {side} the range (up to {100 * BEYOND:.0f} %)"


def _beyond(check: Check, side: str) -> Finding:
    return Finding(Gravity.CAUTION, f"{_just(side)} {check.name} would be exceeded: {check.because}.")


def capital(text: str) -> str:
    """A sentence that begins with a capital letter."""
    return text[:1].upper() + text[1:]
