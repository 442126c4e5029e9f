"""Is the line fit for its speeds, which limit binds first, by what margin?"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator

from trunnion.design.assessment.assessment_input import WHOLE, AssessmentInput, LoadCaseResponse, SearchEffort, cases_of
from trunnion.design.assessment.bending import bending
from trunnion.design.assessment.bounds import with_bounds
from trunnion.design.assessment.brake_heat import brake_heat
from trunnion.design.assessment.check import Check, in_order, worst
from trunnion.design.assessment.compared import uncovered
from trunnion.design.assessment.converter_heat import converter_heat
from trunnion.design.assessment.coupling_heat import coupling_heat
from trunnion.design.assessment.couplings import coupling_ratings
from trunnion.design.assessment.deciding import weighed
from trunnion.design.assessment.fatigue_life import fatigue_life
from trunnion.design.assessment.gear_hammer import gear_hammer
from trunnion.design.assessment.gear_heat import gear_heat
from trunnion.design.assessment.joint_angles import joint_angles, turn_of, uniformity
from trunnion.design.assessment.parametric import parametric_stability
from trunnion.design.assessment.result import Assessment, verdict_of
from trunnion.design.assessment.separation import separation
from trunnion.design.assessment.ship_shafts import ship_shafts
from trunnion.design.assessment.slip_clutches import slip_clutches
from trunnion.design.assessment.stated_limits import stated_limits
from trunnion.driveline.arguments import SpeedEnds, running_range
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import operating_speed, speed_unit, stated_range
from trunnion.driveline.operation import Operation
from trunnion.equations.coefficients import assemble
from trunnion.equations.steady_base import require_balance
from trunnion.errors import InputError
from trunnion.floquet.stability.shaken_stages import shaken_stages
from trunnion.numerics.threads import on_threads
from trunnion.results.counts import all_of
from trunnion.results.finding import Finding, Gravity, by_gravity
from trunnion.results.words import Words
from trunnion.waiting import OutOfTime, keeps_time

AT_MOST = re.compile(r"up to (\d[\d.]*(?:e[+-]?\d+)?) %")
"""A largest share in a sentence."""
OF_RESPONSE = (
    stated_limits, coupling_ratings, coupling_heat, brake_heat, converter_heat, gear_heat, ship_shafts, gear_hammer,
    slip_clutches,
)  # fmt: skip


@keeps_time
def assess(
    line: Driveline,
    speeds: SpeedEnds | None = None,
    *,
    load_case: str | None = None,
    unit: str | None = None,
    within: float | None = None,
) -> Assessment:
    """Every limit of the description and every rule that applies, over the running range.

    Limits, ratings and physical checks always decide; guidelines where the ``application`` of the description says so.

    Parameters
    ----------
    line : the driveline, with its ``limits``.
    speeds : lowest and highest input speed [rad/s]; default the description's range, or its operating speed alone.
    load_case : name of one of the line's load cases; by default the line is judged as stated and under each of them.
    unit : of speeds in sentences; default the one of the description.
    within : seconds that it may take; what is not reached by then is not judged, and says so.

    Raises
    ------
    InputError : no speed and no range, a range that is reversed, no such load case; torques that balance neither as
        stated nor in any load case.

    Examples
    --------
    >>> import trunnion as tn
    >>> engine = tn.Disk(inertia=0.2, excitation=[{"order": 2, "amplitude": 100.0}])
    >>> parts = [engine, tn.Shaft(stiffness=1e4, damping=2.0, name="shaft"), tn.Disk(inertia=0.8)]
    >>> line = tn.Driveline(parts, limits=[tn.Limit(of="shaft", max_torque=400.0)])
    >>> judged = tn.assess(line, (90.0, 110.0))
    >>> print(judged.verdict, judged.binding.name, round(judged.binding.margin, 3))
    satisfied max torque of shaft 0.129
    """
    subject = subject_of(line, speeds, load_case, unit, partly=True)
    require_steady_case(subject)
    return assessment_of(subject)


def require_steady_case(subject: AssessmentInput) -> None:
    """Refuse a line whose torques balance in none of its cases, so that there is no motion to judge.

    Raises
    ------
    InputError : as ``require_balance`` says it of the line as stated.
    """
    speed = subject.high if subject.speed is None else min(max(subject.speed, subject.low), subject.high)
    refusals = []
    for case in subject.cases:
        try:
            require_balance(case.assembly, case.assembly.table(1, speed))
        except InputError as error:
            refusals.append(error)
        else:
            return
    raise refusals[0]


def assessment_of(subject: AssessmentInput) -> Assessment:
    """All checks, with what a few boxes prove of those that are searched."""
    return judgement(subject, *with_bounds(subject, checks_of(subject)))


def judgement(subject: AssessmentInput, checks: tuple[Check, ...], notes: Iterable[Finding] = ()) -> Assessment:
    """What follows from the checks of a line; ``notes`` of what they stand on."""
    verdict, barred = verdict_of(checks, subject.speed)
    findings = by_gravity(
        [*_outside(subject), *_findings(subject.cases, subject.unit), *shaken_stages(assemble(subject.line)), *notes]
    )
    return Assessment(
        verdict=verdict, checks=checks, barred=barred, low=subject.low, high=subject.high, speed=subject.speed,
        unit=subject.unit, findings=findings, operation=subject.line.operation or Operation(),
    )  # fmt: skip


def subject_of(
    line: Driveline,
    speeds: SpeedEnds | None,
    load_case: str | None,
    unit: str | None,
    effort: SearchEffort = WHOLE,
    *,
    partly: bool = False,
) -> AssessmentInput:
    """What is judged: see ``assess``; ``effort``: how closely; ``partly``: what there is where a time limit ends it."""
    if load_case is not None:
        line = line.with_load(load_case)
    low, high, speed = _range(line, speeds)
    every = cases_of(line, low, high, effort, partly=partly)
    return AssessmentInput(
        line, low, high, speed, unit or speed_unit(line), every[:1] if load_case is not None else every
    )


def checks_of(subject: AssessmentInput, *, geometry: bool = True) -> tuple[Check, ...]:
    """All checks in order, of each the load case that binds; ``geometry``: those that no load case changes, too."""
    prepare(subject.cases)
    found = list(worst(check for case in subject.cases for check in by_case(subject, case)))
    if geometry:
        found += [*of_line(subject), *fatigue_life(subject)]
    return in_order(weighed(found, subject.line.operation))


def prepare(cases: tuple[LoadCaseResponse, ...]) -> None:
    """Compute what the checks look at, cases side by side."""
    try:
        on_threads(LoadCaseResponse.prepare, cases, os.cpu_count() or 1)
    except OutOfTime:
        if not all(case.partly for case in cases):
            raise  # otherwise each check says that it was not reached


def _range(line: Driveline, speeds: SpeedEnds | None) -> tuple[float, float, float | None]:
    stated = line.operation.speed if line.operation else None
    if speeds is None:
        speeds = stated_range(line) or 2 * (operating_speed(line, None),)
    return *running_range(speeds), stated


def by_case(subject: AssessmentInput, case: LoadCaseResponse, *, growth: bool = True) -> Iterator[Check]:
    """The checks of one load case; ``growth``: parametric stability too, which takes longest."""
    yield from of_response(subject, case)
    yield from separation(subject, case)
    if growth:
        yield from parametric_stability(subject, case)


def of_response(subject: AssessmentInput, case: LoadCaseResponse) -> Iterator[Check]:
    """The checks that look at the linear response by order."""
    for rule in OF_RESPONSE:
        yield from (uncovered(subject, case, check) for check in rule(subject, case))


def of_line(subject: AssessmentInput) -> Iterator[Check]:
    """The checks of geometry, which no load case changes."""
    assembly, turn = subject.cases[0].assembly.at(subject.high), turn_of(subject)
    yield from joint_angles(subject, assembly, turn)
    yield from uniformity(subject, turn)
    yield from bending(subject, assembly)


def _outside(subject: AssessmentInput) -> Iterator[Finding]:
    """An operating speed beyond the running range that the description states: nothing is judged where it runs."""
    speed, stated = subject.speed, stated_range(subject.line)
    if speed is None or stated is None:
        return
    if any(low <= speed <= high for low, high in (stated, (subject.low, subject.high))):
        return
    over = Words(subject.unit).ends(*stated)
    yield Finding(
        Gravity.DANGER,
        f"It runs at {subject.shown(speed)}, outside its speed_range, {over}: no check looks there, and rules by the "
        "rated speed take that one. Widen speed_range, or check speed.",
    )


def _findings(cases: tuple[LoadCaseResponse, ...], unit: str) -> tuple[Finding, ...]:
    """What the responses say of themselves, once; what only some load cases say, with their names; of what differs in
    nothing but how large a share is at most, the largest."""
    said: dict[str, list[tuple[Finding, str]]] = {}
    for case in cases:
        for finding in case.response.findings_in(unit) if case.response else ():
            said.setdefault(AT_MOST.sub("up to %", finding.sentence), []).append((finding, case.name))
    everywhere = sum(case.response is not None for case in cases)
    found = []
    for alike in said.values():
        finding = max((one for one, _ in alike), key=_share)
        names = list(dict.fromkeys(name for _, name in alike))
        found.append(finding if len(names) == everywhere or names == [""] else _of_cases(finding, names))
    return by_gravity(found)


def _share(finding: Finding) -> float:
    """The share [%] that is said to be the largest; 0 without one."""
    found = AT_MOST.search(finding.sentence)
    return float(found[1]) if found else 0.0


def _of_cases(finding: Finding, names: list[str]) -> Finding:
    named = [name for name in names if name]
    cases = f"load case{'s' if len(named) > 1 else ''} {all_of(named)}"
    where = f"as stated and in {cases}" if len(named) < len(names) else cases
    return Finding(finding.gravity, f"{where[0].upper()}{where[1:]}: {finding.sentence}")
