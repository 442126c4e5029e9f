"""What would help: the smallest single changes that satisfy a check which is exceeded or has little margin."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np

from trunnion.arrays import Array
from trunnion.design.assessment.assess import checks_of, judgement, subject_of
from trunnion.design.assessment.assessment_input import AssessmentInput
from trunnion.design.assessment.bounds import with_bounds
from trunnion.design.assessment.check import Check, Status, percent
from trunnion.design.assessment.fatigue_life import NAME as FATIGUE
from trunnion.design.assessment.result import verdict_of
from trunnion.design.remedies.result import Remedies, Remedy
from trunnion.design.remedies.search import CandidateChange, Changes, RemedySearch, goals_of
from trunnion.design.remedies.trials import TrialLines
from trunnion.design.sensitivity.checks import check_slopes
from trunnion.design.sensitivity.directions import Neighbours, directions_of
from trunnion.design.sensitivity.variables import Design
from trunnion.driveline.arguments import SpeedEnds, one_number
from trunnion.driveline.driveline import Driveline
from trunnion.equations.coefficients import assemble
from trunnion.errors import InputError
from trunnion.modes.loaded_modes import loaded_modes
from trunnion.results.counts import counted
from trunnion.results.finding import Finding
from trunnion.results.units import in_words
from trunnion.waiting import OutOfTime, keeps_time, to_the_end

NEAR = 0.1
"""Spare margin below which a check is nearly binding."""
MOST = 3
MOVED = 0.02
"""Share by which a critical speed has to move to be named in a sentence."""


@keeps_time
def remedies(
    line: Driveline,
    speeds: SpeedEnds | None = None,
    *,
    load_case: str | None = None,
    unit: str | None = None,
    checks: Iterable[str] | None = None,
    near: float = NEAR,
    most: int = MOST,
    within: float | None = None,
    progress: Callable[[float], None] | None = None,
) -> Remedies:
    """The smallest single changes of stiffness, inertia, damping, joint angle or phase that satisfy a check.

    Each was found by moving one number step by step, up to a factor of two, 21° of a joint or half a turn of a phase.
    It was verified by judging the whole line again: no check that was satisfied is broken, none that was exceeded gets
    worse. ``verified`` of the result says at which speeds. Of free–free lines with joint angles sensitivities are those
    about the motion of rigid shafts. A range of values narrower than a step (3 to 10 %, of free–free lines with joint
    angles 5 to 20 %) can be missed. What is zero is not varied.

    Parameters
    ----------
    line, speeds, load_case, unit : as of ``assess``.
    checks : names of the checks to help; default all that decide and are exceeded or have less than ``near`` to spare,
        but for fatigue, which takes long.
    near : spare margin that a nearly binding check is to reach.
    most : changes to find for each check.
    within : seconds that it may take; what was found until then is given, and ``ended`` says so.
    progress : called as progress(share done).

    Raises
    ------
    InputError : as of ``assess``; no such check, or one that is not judged.

    Examples
    --------
    >>> import trunnion as tn
    >>> engine = tn.Disk(inertia=0.2, excitation=[{"order": 2, "amplitude": 100.0}])
    >>> shaft = tn.Shaft(stiffness=1e4, damping=2.0, name="shaft")
    >>> line = tn.Driveline([engine, shaft, tn.Disk(inertia=0.8)], limits=[tn.Limit(of="shaft", max_torque=400.0)])
    >>> print(tn.remedies(line, (90.0, 115.0), most=1).sentences[0])
    max torque of shaft: shaft stiffer by 5.3 % (10.53 kN m/rad) moves order 2 on mode 2 from 124.96 rad/s \
to 128.23 rad/s: margin 0.405 %
    """
    subject = subject_of(line, speeds, load_case, unit, partly=True)
    base, notes = with_bounds(subject, checks_of(subject))
    return remedies_of(subject, base, notes, checks=checks, near=near, most=most, progress=progress)


def remedies_of(
    subject: AssessmentInput,
    base: tuple[Check, ...],
    notes: Iterable[Finding] = (),
    *,
    checks: Iterable[str] | None = None,
    near: float = NEAR,
    most: int = MOST,
    progress: Callable[[float], None] | None = None,
) -> Remedies:
    """The same for a line whose checks, ``base``, are known, with ``notes`` of them."""
    judged = judgement(subject, base, notes)
    goals = _goals(base, checks, near)
    design = Design(subject.line)
    by_name = {check.name: check for check in base}
    targets = [by_name[name] for name in goals]
    changes, verified, lines = Changes([], [], ""), "", 0
    slope, error = (np.full((len(targets), len(design.variables)), np.nan) for _ in range(2))
    speed = np.full(len(targets), np.nan)
    try:
        # What a check follows takes far less time than what would help it.
        slope, error, speed = _sensitivities(subject, design, targets)
        lines += 4 * len(targets) * len(design.variables)
        if goals:
            trials = TrialLines(subject, base, design, targets)
            changes = RemedySearch(trials, goals, most, progress).run()
            verified = trials.verified
            lines += trials.count
    except OutOfTime as ending:
        changes = replace(changes, ended=ending.why)
    with to_the_end():
        said = tuple(_remedy(subject, design, by_name[one.check], one) for one in changes.found)
        closest = {one.check: _closest(one, by_name) for one in changes.closest}
    return Remedies(
        assessment=judged,
        checks=tuple(goals),
        variables=design.variables,
        sensitivity=slope,
        sensitivity_error=error,
        sensitivity_speed=speed,
        remedies=said,
        closest=closest,
        lines=lines,
        verified=verified,
        ended=changes.ended,
    )


def _sensitivities(subject: AssessmentInput, design: Design, checks: Sequence[Check]) -> tuple[Array, Array, Array]:
    """d ln(value)/d ln p of checks' values by design variables (check, variable), d ln(value)/dφ [1/rad] for angles;
    their errors; the speed (check,) [rad/s] where they were taken. NaN where a check has no value. Of lines with joint
    angles that are free–free about the motion of rigid shafts, right to first order in what joints force."""
    assembly = subject.cases[0].assembly
    directions = directions_of(assembly, [v.path for v in design.variables]) if design.variables else ()
    if subject.cases[0].costly:
        subject = replace(subject, cases=tuple(replace(case, rough=True) for case in subject.cases))
    found = check_slopes(subject, Neighbours(assembly), directions, checks)
    size = np.array([one.size for one in directions]).reshape(1, -1)
    value = found.value[:, :1]
    with np.errstate(divide="ignore", invalid="ignore"):
        return found.slope[:, 0] * size / value, found.error[:, 0] * size / np.abs(value), found.speed


def _goals(base: tuple[Check, ...], asked: Iterable[str] | None, near: float) -> dict[str, float]:
    if not 0 <= one_number(near, "near", "near=0.1, say") < 1:
        raise InputError("must be at least 0 and below 1", key="near", value=near, remedy="near=0.1, say")
    if asked is None:  # a life takes a passage or more for each trial
        return goals_of(tuple(check for check in base if check.rule.name != FATIGUE), near)
    known = goals_of(base, np.inf, shown=True)
    found = {}
    for name in asked:
        if name not in known:
            problem = "is not judged" if any(check.name == name for check in base) else "is not a check of this line"
            remedy = f"there are {', '.join(known)}" if known else "nothing is judged; state limits"
            raise InputError(problem, key="checks", value=name, remedy=remedy)
        found[name] = min(known[name], near)
    return found


def _remedy(subject: AssessmentInput, design: Design, before: Check, found: CandidateChange) -> Remedy:
    variable, after = found.variable, found.after.get(before.name)
    value, margin = (after.value, after.margin) if after else (np.nan, np.nan)
    return Remedy(
        check=before.name,
        variable=variable.path,
        before=variable.value,
        after=found.value,
        unit=variable.unit,
        size=found.size,
        value=value,
        margin=margin,
        required_margin=before.required_margin,
        verdict=verdict_of(tuple(found.after.values()), subject.speed)[0],
        sentence=_sentence(subject, design, before, after, found),
    )


def _sentence(
    subject: AssessmentInput, design: Design, before: Check, after: Check | None, found: CandidateChange
) -> str:
    change = found.variable.worded(found.value)
    if after is None:
        return f"{change} leaves nothing to pass quickly"
    if after.status is Status.NOT_APPLICABLE:
        return f"{change} lets nothing grow"
    left = f"margin {100 * after.margin:.3g} %"
    if before.required_margin:
        left += f", {100 * before.required_margin:.3g} % required"
    moved = _critical(subject, design, before, found)
    if moved is not None and before.cause is not None:
        here, there = moved
        what = f"{before.cause.name} on mode {before.cause.mode}"
        return f"{change} moves {what} from {subject.shown(here)} to {subject.shown(there)}: {left}"
    return f"{change} brings it from {_shown(subject, before)} to {_shown(subject, after)}: {left}"


def _shown(subject: AssessmentInput, check: Check) -> str:
    """The value of a check in an engineer's unit, speeds in the file's."""
    return subject.shown(check.value) if check.unit == "rad/s" else in_words(check.value, check.unit)


def _closest(found: CandidateChange, base: dict[str, Check]) -> str:
    """ "coupling softer by 18 % (32.8 kN m/rad) would, but gear hammer in gearbox is then exceeded by 4 %"."""
    first = found.breaks[0]
    now, before = percent(first.margin), base.get(first.name)
    if first.status is not Status.EXCEEDED:
        how = "can then not be judged any more"
    elif before is not None and before.status is Status.EXCEEDED:
        how = f"gets worse, {now}" if now != percent(before.margin) else "gets slightly worse"
    else:
        how = f"is then {now}"
    more = f", and {counted(len(found.breaks) - 1, 'check')} more" if len(found.breaks) > 1 else ""
    return f"{found.variable.worded(found.value)} would, but {first.name} {how}{more}"


def _critical(
    subject: AssessmentInput, design: Design, before: Check, found: CandidateChange
) -> tuple[float, float] | None:
    """The speed at which the order that leads meets its mode, before and after; None where it hardly moves."""
    cause = before.cause
    if cause is None or not cause.mode or not abs(cause.off) < 0.5 or not np.isfinite(cause.critical):
        return None
    line = design.changed(found.variable, found.value)
    assert line is not None
    if before.load_case:
        line = line.with_load(before.load_case)
    assembly = assemble(line)
    number = cause.mode - 1 - assembly.topology.still
    natural = float(loaded_modes(assembly, np.array([before.speed]))[0][0, number].imag)
    there = (natural - cause.frequency) / cause.order
    here = cause.critical
    return (here, float(there)) if np.isfinite(there) and abs(np.log(there / here)) > MOVED else None
