"""Every load case and every point of the schedules: the worst of each check, and where."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from math import nan

import numpy as np

from trunnion.arrays import Array
from trunnion.design.assessment.assess import assess, checks_of, judgement, subject_of
from trunnion.design.assessment.check import Check, Status, in_order, worst
from trunnion.design.assessment.result import Assessment, verdict_of
from trunnion.design.limits.stable_limit import HIGHEST, stable_limit
from trunnion.driveline.arguments import SpeedEnds, whole_number
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.driveline.operation import Operation
from trunnion.driveline.schedules import FOLLOWING, KEYS, Schedule
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.steady_base import has_periodic_base
from trunnion.floquet.ranges.span import Span
from trunnion.results.counts import few
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, computed, internal, labelled, members, variable
from trunnion.results.finding import Finding, Gravity, by_gravity
from trunnion.results.result import Result
from trunnion.results.variables import Attribute, Variable
from trunnion.results.words import Words

WORST = "the worst of each, the binding one first, load case within"
POINTS = 5
LIMIT_SPEEDS = 9
"""Speeds of the range at which a stable limit is solved for, beside the answer for all between."""


@labelled
class SchedulePoint:
    """One point of a schedule ("" for the line as stated), and the line there."""

    schedule: str = variable()
    over: str = internal('"travel" or "speed"')
    value: float = variable(words="travel [m] or speed [rad/s]", name="schedule_value")
    label: str = internal("what it is called")
    line: Driveline = internal("there")
    along: tuple[float, float] | None = internal("all of a schedule over speed, value NaN", "rad/s", default=None)


@labelled
class Envelope(Result):
    """A line judged under its load cases at every point of its schedules; see ``Assessment`` for the verdict.

    The largest stable value is NaN where none was asked for or it is unknown at one of the speeds.
    """

    verdict: Status = attribute()
    places: tuple[SchedulePoint, ...] = members(
        SchedulePoint, "place", "points of schedules, the line as stated first", name="label"
    )
    checks: tuple[Check, ...] = members(Check, "check", WORST, name="name", only="status load_case value speed because")
    where: tuple[int, ...] = internal("number of the place of each check")
    margin: Array = variable("place check", "1", "distance to the limit over the limit")
    parameter: str = attribute("whose largest stable value was asked for")
    limit: Array = variable("place", "{self.parameter_unit}", "largest stable {self.parameter}", name="stable_limit")
    parameter_unit: str = internal()
    low: float = internal("end of the running range", "rad/s")
    high: float = internal("end of the running range", "rad/s")
    unit: str = internal("of speeds in print")
    findings: tuple[Finding, ...] = attribute(default=())

    def plot(self, axes: Axes | None = None, *, schedule: str = "") -> Axes:
        """Margins of the worst checks along a schedule; see ``pictures.design.envelope``."""
        return drawing(self, "plot")(self, axes, schedule=schedule)

    @property
    @computed(attribute())
    def sentence(self) -> str:
        """The verdict in one sentence, and where the worst stands."""
        bind = next(iter(self.checks), None)
        if bind is None or not (bind.exceeded or bind.satisfied):
            return f"{self.verdict}: nothing could be judged"
        if self.verdict is Status.NOT_JUDGED:
            missing = few([check.name for check in self.checks if check.missing])
            return f"{self.verdict} over {len(self.places)} places: {missing} could not be judged"
        place = self.places[self.where[0]].label
        return f"{self.verdict} over {len(self.places)} places: {bind.name} binds {place}: {bind.because}"

    def declared(self) -> Iterator[Variable | Attribute]:
        """Margins over places and checks, and the stable limit over places."""
        yield from super().declared()
        yield Variable("worst_place", [self.places[k].label for k in self.where], "check")

    def _lines(self) -> Iterator[str]:
        yield f"envelope {self.words.over(self.low, self.high)}: {self.sentence}"
        for check, k in zip(self.checks, self.where, strict=True):
            where = f" {self.places[k].label}" if check.judged and len(self.places) > 1 else ""
            yield f"  {check.word}: {check.name}{where}: {check.because}"
        if self.parameter and np.isfinite(self.limit).any():
            k = int(np.nanargmin(self.limit))
            shown = self.words.parameter(self.parameter, self.parameter_unit)
            yield f"  {shown.quantity}: stable up to {shown.number(self.limit[k])}, least {self.places[k].label}"


def envelope(
    line: Driveline,
    speeds: SpeedEnds | None = None,
    *,
    points: int = POINTS,
    parameter: str = "",
    low: float = 0.0,
    high: float = HIGHEST,
    unit: str | None = None,
    progress: Callable[[float], None] | None = None,
) -> Envelope:
    """The worst of every check of ``assess`` over all load cases and all points of the schedules, and where it stands.

    Parameters
    ----------
    line : with ``operation.schedules`` and load cases; with neither it is ``assess``.
    speeds : lowest and highest input speed [rad/s]; default the description's. A schedule over speed is searched
        over all of it that lies within, its numbers following the speed, and shown at single speeds, ends included.
    points : of each schedule at least, evenly from end to end, beside the points that it states.
    parameter, low, high : also asks for the largest stable value of a parameter (as of ``stable_limit``) at every place
        and under every load case, over the range of speeds.
    unit : of speeds in sentences; default the one of the description.
    progress : called as progress(share done).

    Raises
    ------
    InputError : as ``assess``; a number of points below 2; a line at a point of a schedule that is refused.

    Examples
    --------
    >>> import trunnion as tn
    >>> bends = tn.Schedule(name="suspension", travel=["0 mm", "80 mm"], angles={"HookeJoint 1": ["2 deg", "6 deg"]})
    >>> running, shaft = tn.Operation(speed_range=(50.0, 70.0), schedules=[bends]), tn.Shaft(stiffness=1e4, damping=2.0)
    >>> parts = [tn.ConstantSpeed(), tn.HookeJoint(angle="2 deg"), shaft, tn.Disk(inertia=0.8)]
    >>> tn.envelope(tn.Driveline(parts, operation=running), points=2)
    <Envelope: envelope from 477.465 rpm to 668.451 rpm: not judged over 3 places: torque without limit could not be
      judged>
    """
    points = whole_number(points, "points", 2)
    report_progress = progress or (lambda share: None)
    stated = _stripped(line, line.operation, {}, {})
    first = assess(stated, speeds, unit=unit)
    words = Words(unit or speed_unit(line))
    places = [SchedulePoint("", "", nan, "as stated", stated)]
    for schedule in line.operation.schedules if line.operation else ():
        places += _places(line, schedule, points, (first.low, first.high), words)
        places += _whole(line, schedule, (first.low, first.high), words)
    judged, limits = [first], []
    for k, place in enumerate(places):
        if k:
            judged.append(_judged(line, place, first, unit))
        limits.append(_limit(place, parameter, (low, high), _span(place, first)))
        report_progress((k + 1) / len(places))
    return _together(line, places, judged, limits, parameter, words.of_speeds)


def _stripped(
    line: Driveline, operation: Operation | None, changes: dict[str, dict[str, float]], factors: dict[str, float]
) -> Driveline:
    """The line with numbers changed and without its schedules; without load cases too where loads are changed."""
    if operation is None:
        return line
    loaded = bool(factors) or any("load_torque" in fields for fields in changes.values())
    left = {"schedules": (), **({"load_cases": ()} if loaded else {})}
    return line.replace_all(changes, operation=operation.model_copy(update=left)).with_factors(factors)


def _places(
    line: Driveline, schedule: Schedule, points: int, span: tuple[float, float], words: Words
) -> Iterator[SchedulePoint]:
    at_speed = schedule.over == "speed"
    for value in schedule.between(points, *(span if at_speed else ())):
        shown = words.speed(value) if at_speed else f"{1e3 * value:.4g} mm"
        changed = _stripped(line, line.operation, schedule.changes_at(value), schedule.factors_at(value))
        yield SchedulePoint(schedule.name, schedule.over, value, f"at {schedule.name} {shown}", changed)


def _whole(line: Driveline, schedule: Schedule, span: tuple[float, float], words: Words) -> Iterator[SchedulePoint]:
    """All of a schedule over speed; not of a free–free line with joint angles, which is solved speed by speed, nor of
    factors on machines, whose torque may be a curve."""
    low, high = max(schedule.points[0], span[0]), min(schedule.points[-1], span[1])
    if schedule.over != "speed" or schedule.factors or not low < high:
        return
    # The line at the point where its joints are bent most: what is bent anywhere counts as bent.
    bend = [sum(abs(angles[k]) for angles in schedule.angles.values()) for k in range(len(schedule.points))]
    changed = _stripped(line, line.operation, schedule.changes_at(schedule.points[int(np.argmax(bend))]), {})
    if not has_periodic_base(assemble(changed)):
        label = f"along {schedule.name}, {words.ends(low, high)}"
        yield SchedulePoint(schedule.name, "speed", nan, label, changed, (low, high))


def _judged(line: Driveline, place: SchedulePoint, first: Assessment, unit: str | None) -> Assessment:
    """What is judged at a place, or along a schedule."""
    if place.along is None:
        return assess(place.line, _span(place, first), unit=unit)
    assert line.operation is not None
    schedule = next(one for one in line.operation.schedules if one.name == place.schedule)
    subject = subject_of(place.line, place.along, None, unit)
    cases = tuple(replace(case, follows=_following(case.assembly, schedule)) for case in subject.cases)
    subject = replace(subject, cases=cases)
    return judgement(subject, checks_of(subject, geometry=False))


def _following(assembly: Assembly, schedule: Schedule) -> Span:
    """The line whose numbers follow a schedule over speed."""
    columns = [
        (assembly.packed.resolve(f"{name}.{KEYS[key]}"), np.array(numbers))
        for key in FOLLOWING
        for name, numbers in getattr(schedule, key).items()
    ]

    def put(table: Array) -> None:
        for column, numbers in columns:
            column.put(table, np.interp(table[:, 0], schedule.points, numbers))

    return Span(assembly, schedule.points[0], schedule.points[-1], put, schedule.points)


def _span(place: SchedulePoint, first: Assessment) -> tuple[float, float]:
    """The speeds that a place is judged at: its own where the schedule goes over speed."""
    if place.along is not None:
        return place.along
    return (place.value, place.value) if place.over == "speed" else (first.low, first.high)


def _limit(place: SchedulePoint, parameter: str, ends: tuple[float, float], span: tuple[float, float]) -> float:
    """The least over load cases and speeds of the largest stable value."""
    if not parameter:
        return nan
    operation = place.line.operation
    cases = [place.line, *(place.line.with_load(c.name) for c in (operation.load_cases if operation else ()))]
    speeds = np.unique(np.linspace(*span, LIMIT_SPEEDS))
    speeds = speeds[speeds > 0]
    found = [stable_limit(case, parameter, speeds, low=ends[0], high=ends[1]) for case in cases]
    every = [ends[0] if one.whole.largest is None else one.whole.largest for one in found if one.whole is not None]
    return float(np.min(np.concatenate([*(one.limit for one in found), every])))  # unknown at one of them is unknown


def _not_reached(line: Driveline, first: Assessment) -> Iterator[str]:
    """What schedules over speed say nothing of, though the line is to run there."""
    for schedule in line.operation.schedules if line.operation else ():
        ends = schedule.points[0], schedule.points[-1]
        if schedule.over == "speed" and not ends[0] <= first.low <= first.high <= ends[1]:
            own = first.words.ends(*ends)
            yield f"Schedule {schedule.name} goes from {own}: at speeds beyond, the line is judged as stated alone"


def _together(
    line: Driveline,
    places: list[SchedulePoint],
    judged: list[Assessment],
    limits: list[float],
    parameter: str,
    unit: str,
) -> Envelope:
    every = [check for one in judged for check in one.checks]
    checks = in_order(worst(every))
    verdict = verdict_of(checks, judged[0].speed)[0]
    if any(one.verdict is Status.EXCEEDED for one in judged):
        verdict = Status.EXCEEDED
    said_at = [{(check.name, check.because) for check in one.checks} for one in judged]
    where = tuple(next(k for k, said in enumerate(said_at) if (c.name, c.because) in said) for c in checks)
    known = [{check.name: check.margin for check in one.checks} for one in judged]
    margin = np.array([[one.get(check.name, nan) for check in checks] for one in known])
    findings = [
        replace(finding, sentence=f"{place.label.capitalize()}: {finding.sentence}") if place.schedule else finding
        for place, one in zip(places, judged, strict=True)
        for finding in one.findings
        if not place.schedule or finding not in judged[0].findings
    ]
    searched = {place.schedule for place in places if place.along}
    single = [place for place in places if place.schedule and place.schedule not in searched]
    if single:
        count = f"{len(single)} points" if len(single) > 1 else "one point"
        named = ", ".join(dict.fromkeys(place.schedule for place in single))
        said = f"{named}: judged at {count}; between them nothing is looked at"
        findings.append(Finding(Gravity.NOTE, said))
    findings += [Finding(Gravity.NOTE, said) for said in _not_reached(line, judged[0])]
    unknown = [place.label for place, value in zip(places, limits, strict=True) if parameter and np.isnan(value)]
    if unknown:
        said = f"Up to which {parameter} the line is stable is not known {', '.join(unknown)}"
        said += ": it could not be told at some speed"
        findings.append(Finding(Gravity.CAUTION, said))
    operation = places[0].line.operation
    if len(places) == 1 and not (operation and operation.load_cases):
        said = "the description has no load cases and no schedules: judged as stated alone"
        findings.append(Finding(Gravity.NOTE, said))
    return Envelope(
        verdict=verdict,
        places=tuple(places),
        checks=checks,
        where=where,
        margin=margin.reshape(len(places), len(checks)),
        parameter=parameter,
        limit=np.array(limits),
        parameter_unit=assemble(places[0].line).packed.resolve(parameter).unit if parameter else "",
        low=judged[0].low,
        high=judged[0].high,
        unit=unit,
        findings=by_gravity(findings),
    )
