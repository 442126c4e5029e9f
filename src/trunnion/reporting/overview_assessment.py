"""What an engineer asks first: is the line fit for its speeds, what binds, what lies just beyond?

Nothing here is drawn, and nothing compiled that the answer does not need: charts and pictures follow it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from functools import reduce
from typing import Any

import numpy as np

from trunnion.design.assessment.assess import assessment_of, by_case, require_steady_case, subject_of
from trunnion.design.assessment.assessment_input import NO_RESPONSE, QUICK, AssessmentInput, LoadCaseResponse, lossy
from trunnion.design.assessment.check import Check, worst
from trunnion.design.assessment.deciding import weighed
from trunnion.design.assessment.result import STATE_APPLICATION, Assessment
from trunnion.design.assessment.separation import LIMITED
from trunnion.design.assessment.separation import NEEDS as MODES_NEED
from trunnion.design.assessment.separation import ONE as ONE_MODE
from trunnion.driveline.driveline import Driveline, hooke_joints
from trunnion.driveline.operating_speed import known_speed, operating_speed, speed_unit
from trunnion.driveline.operation import Operation
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.loads import curve_ends
from trunnion.equations.steady_base import require_turning
from trunnion.errors import ComputationError, InputError
from trunnion.floquet.charts.axes import lowest_speed
from trunnion.floquet.stability.stability_over_speed import SpeedBySpeedError, StabilityOverSpeed
from trunnion.modes.natural_frequencies import NaturalFrequencies, natural_frequencies
from trunnion.modes.resonance_speeds import ResonanceSpeeds, resonance_speeds
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
from trunnion.results.words import Words
from trunnion.waiting import OutOfTime, time_is_up, to_the_end

NEARLY = 0.1
"""Spare margin below which a check deserves a word though it is satisfied."""


@dataclass(frozen=True)
class AssessableLine:
    """A line that can be judged, and over which range.

    speed [rad/s]: the one asked for, None without one; speed_range [rad/s]: of the description, or guessed from the
    line where it states none; subject: what is judged, its responses once they are needed.
    """

    line: Driveline
    assembly: Assembly
    unit: str
    speed: float | None
    speed_range: tuple[float, float]
    subject: AssessmentInput


@dataclass(frozen=True)
class AssessedLine(AssessableLine):
    """The verdict alone, before what lies beside the range is looked at."""

    assessment: Assessment


@dataclass(frozen=True)
class OverviewAssessment(AssessedLine):
    """The verdict on a line over its running range, and what belongs to it.

    operation: the description's, at the ``speed`` asked for; along: stability along the range at the joints' own
    angles, None where nothing makes the coefficients vary or where each speed takes its own periodic steady state;
    resonance_speeds: those in the range.
    """

    operation: Operation
    natural_frequencies: NaturalFrequencies
    resonance_speeds: ResonanceSpeeds
    along: StabilityOverSpeed | None
    findings: tuple[Finding, ...]


def asked(line: Driveline, *, speed: float | str | None = None, unit: str | None = None) -> AssessableLine:
    """What there is to judge of ``line``; see ``overview`` for the parameters.

    Raises
    ------
    InputError : the line has no equations of motion, or no steady motion to judge.
    """
    unit = unit or speed_unit(line)
    assembly = assemble(line)
    if speed is not None or known_speed(line) is not None:
        speed = operating_speed(line, speed)
        require_turning(assembly, assembly.table(1, speed))
    low, high = speed_range(line)
    subject = replace(subject_of(line, (low, high), None, unit, partly=True), speed=speed)
    if speed is not None:
        require_steady_case(subject)
    return AssessableLine(line, assembly, unit, speed, (low, high), subject)


def judged(of: AssessableLine) -> AssessedLine:
    """The verdict over the range."""
    return AssessedLine(**_parts(of), assessment=assessment_of(of.subject))


def answer(of: AssessedLine) -> OverviewAssessment:
    """What an engineer asks next: what lies just beyond the range, which resonances stand in it, what else binds."""
    line, assembly, words, speed, (low, high) = of.line, of.assembly, Words(of.unit), of.speed, of.speed_range
    with to_the_end():
        every, modes = resonance_speeds(assembly), natural_frequencies(assembly)
    here = every.within(low, high)
    along = _along(of.subject.cases[0])
    joints, slowest = hooke_joints(line), lowest_speed(assembly)
    freely = joints and assembly.topology.free and not lossy(assembly)
    parts: list[Callable[[], Iterable[Finding]]] = [
        lambda: check_findings(of.assessment),
        lambda: of.assessment.findings,
        lambda: beyond_findings(of.subject, of.assessment),
        lambda: along_findings(assembly, along, words) if along else (),
        lambda: line_findings(line, speed),
        lambda: resonance_findings(here, (low, high), speed, words),
        lambda: () if lossy(assembly) else response_findings(assembly, every, (low, high), words),
        lambda: slow_findings(high, slowest, words) if joints and high <= slowest else (),
        lambda: free_findings(assembly, along, words) if freely else (),
        lambda: remark_findings(line),
    ]
    findings = [finding for part in parts for finding in _in_time(part)]
    return OverviewAssessment(
        **_parts(of),
        operation=(line.operation or Operation()).model_copy(update={"speed": speed}),
        natural_frequencies=modes,
        resonance_speeds=here,
        along=along,
        findings=by_gravity(_once(findings)),
    )


def _in_time(part: Callable[[], Iterable[Finding]]) -> list[Finding]:
    """Findings, or the note that a time limit ended their search."""
    try:
        return list(part())
    except OutOfTime as error:
        return [Finding(Gravity.NOTE, f"Not all findings were searched: {error.why}.")]


def _parts(of: AssessableLine) -> dict[str, Any]:
    return {field.name: getattr(of, field.name) for field in fields(of)}


def _once(findings: list[Finding]) -> list[Finding]:
    """Each once, as sentences that end."""
    ended = (replace(one, sentence=f"{one.sentence.removesuffix('.')}.") for one in findings)
    return list({finding.sentence: finding for finding in ended}.values())


def _along(case: LoadCaseResponse) -> StabilityOverSpeed | None:
    if not case.parametric:
        return None
    try:
        return case.along
    except (SpeedBySpeedError, InputError, ComputationError, OutOfTime):  # the check says why
        return None


def check_findings(assessment: Assessment) -> list[Finding]:
    """What is exceeded, what nearly is, what could not be judged, by margin, a reason that several share once; then
    what the line is beyond though no verdict rests on it."""
    found = []
    unjudged: dict[tuple[Gravity, str], list[str]] = {}
    for check in assessment.checks:
        if check.exceeded:
            found.append(Finding(Gravity.DANGER, f"{capital(check.name)} is exceeded: {check.because}."))
        elif check.satisfied and check.spare < NEARLY:
            found.append(Finding(Gravity.CAUTION, f"{capital(check.name)} is nearly reached: {check.because}."))
        elif check.missing:
            gravity = Gravity.CAUTION if np.isfinite(check.margin) else Gravity.NOTE
            unjudged.setdefault((gravity, check.because.removeprefix(NO_RESPONSE)), []).append(check.name)
    for (gravity, because), names in unjudged.items():
        are = "is" if len(names) == 1 else "are"
        found.append(Finding(gravity, f"{capital(few(names))} {are} not judged: {because}."))
    return [*found, *shown_findings(assessment)]


def shown_findings(assessment: Assessment) -> Iterator[Finding]:
    """Modes that orders meet, in one sentence, and guidelines that the line is beyond, where neither decides."""
    modes = [check for check in assessment.shown_beyond if check.name.startswith(ONE_MODE)]
    others = [check for check in assessment.shown_beyond if check not in modes]
    if modes:
        numbers = [check.name.removeprefix(ONE_MODE) for check in modes]
        listed = f"separation of {'mode' if len(modes) == 1 else 'modes'} {_and(numbers)}"
        said = [check.because.partition(MODES_NEED) for check in modes]
        need = said[0][2]
        gravity = Gravity.NOTE if need == LIMITED else Gravity.CAUTION
        met = "; ".join(one[0] for one in said)
        yield Finding(gravity, f"{capital(listed)} is below 10 %: {met}{MODES_NEED}{need}.")
    if others:
        listed = "; ".join(f"{check.name} ({check.because})" for check in others)
        if assessment.application:
            yield Finding(Gravity.NOTE, f"Beyond guidelines that do not decide here: {listed}.")
        else:
            yield Finding(Gravity.CAUTION, f"Beyond guidelines that are shown only: {listed}; {STATE_APPLICATION}.")


def _and(words: list[str]) -> str:
    return " and ".join([", ".join(words[:-1]), words[-1]]) if len(words) > 1 else words[0]


def beyond_findings(subject: AssessmentInput, assessment: Assessment) -> list[Finding]:
    """Checks that would be exceeded up to ``BEYOND`` outside the range under any load case, and are not inside it; and
    where torques cannot be told there though they are inside: a table of excitations that ends, say."""
    low, high = subject.low, subject.high
    if not low < high:
        return []
    inside = {check.name for check in assessment.checks if check.exceeded}
    found = []
    for ends, side in (((1 - BEYOND) * low, low), "below"), ((high, (1 + BEYOND) * high), "above"):
        if why := time_is_up():
            found.append(Finding(Gravity.NOTE, f"{_just(side)} nothing was searched: {why}."))
            continue
        ends, cut = _covered(subject, ends)
        if cut:
            found.append(Finding(Gravity.NOTE, f"{_just(side)} nothing is judged {cut}."))
        if not 0 < ends[0] < ends[1]:
            continue
        cases = [replace(case, low=ends[0], high=ends[1], effort=QUICK) for case in subject.cases]
        there = replace(subject, low=ends[0], high=ends[1], cases=tuple(cases))
        checks = worst(
            check for k, case in enumerate(cases) for check in by_case(there, case, growth=not (k and case.costly))
        )
        counting = weighed(checks, subject.line.operation)
        gaps = [f"; {there.ranges([(g.low, g.high)])} not judged: {g.why}" for case in cases for g in case.span.gaps]
        found += [_beyond(c, side, gaps) for c in counting if c.exceeded and c.name not in inside]
        undecided = [case.answer for known, case in zip(subject.cases, cases, strict=True) if known.response]
        reasons = [answer for answer in undecided if isinstance(answer, str)]
        whole = "; ".join(reasons)
        reasons += [
            f"{there.ranges([(g.low, g.high)])}, {g.why}"
            for case in cases
            for g in case.span.gaps
            if g.why not in whole
        ]
        for why in dict.fromkeys(reasons):
            found.append(Finding(Gravity.NOTE, f"{_just(side)} no torque is judged: {why}."))
    return found


def _covered(subject: AssessmentInput, ends: tuple[float, float]) -> tuple[tuple[float, float], str]:
    """As much of a range as the curves of all machines cover, and what is cut off: there the line has no steady
    motion."""
    assembly = subject.cases[0].assembly
    (low, high), why = ends, []
    for name, first, last in curve_ends(assembly.topology, assembly.packed.column, assembly.table(1, subject.low)):
        if first > ends[0] or last < ends[1]:
            low, high = max(low, first), min(high, last)
            why.append(f"that of {name} covers {subject.ranges([(first, last)])}")
    return (low, high), f"where a curve ends, {'; '.join(why)}" if why else ""


def _just(side: str) -> str:
    return f"Just {side} the range (up to {100 * BEYOND:.0f} %)"


def _beyond(check: Check, side: str, gaps: Sequence[str]) -> Finding:
    """In words, without the ``gaps`` of its search, which are said by themselves."""
    because = reduce(lambda text, gap: text.replace(gap, ""), gaps, check.because)
    return Finding(Gravity.CAUTION, f"{_just(side)} {check.name} would be exceeded: {because}.")


def capital(text: str) -> str:
    """A sentence that begins with a capital letter."""
    return text[:1].upper() + text[1:]
