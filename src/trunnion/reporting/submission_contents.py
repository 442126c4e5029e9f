"""What is handed in beyond the verdict: mass–elastic system, modes, powers, torques of every shaft, malfunction, heat.

Everything is computed once, from the responses that the verdict stands on; nothing is drawn here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from trunnion.design.assessment.assess import of_response
from trunnion.design.assessment.assessment_input import LoadCaseResponse, with_torques
from trunnion.design.assessment.check import Check, worst
from trunnion.design.assessment.deciding import weighed
from trunnion.design.assessment.measures import torque_measures
from trunnion.design.assessment.other_excitations import with_other_excitations
from trunnion.driveline.engine import Engine
from trunnion.driveline.operation import Operation
from trunnion.driveline.silent_cylinders import SILENT, Cylinder, cylinders
from trunnion.equations.coefficients import assemble
from trunnion.errors import ComputationError, InputError
from trunnion.modes.mass_elastic import HolzerTable, holzer
from trunnion.reporting.overview_assessment import OverviewAssessment
from trunnion.reporting.ranges import diagram_range
from trunnion.response.campbell_diagram import CampbellDiagram, campbell_diagram
from trunnion.results.counts import listed
from trunnion.waiting import OutOfTime, keep_time

Found = TypeVar("Found")
MOST_MODES = 8
"""Modes of which a Holzer table is printed."""
POWERS = 9
"""Speeds at which torque and power are stated."""
ALIKE = 1e-9
"""Share by which the largest values of two load cases may differ and count as the same."""
WORDS = ("vibratory", "peak")
"""Torques that are searched of every spring."""


@dataclass(frozen=True)
class MeanPower:
    """Mean torque [N m] and power [W] of a spring at one input speed [rad/s], under one load case ("" as described)."""

    case: str
    speed: float
    spring: str
    torque: float
    power: float


@dataclass(frozen=True)
class LargestTorque:
    """A largest value over range and load cases; its input speed [rad/s], its case, and what it may be low by."""

    value: float
    speed: float
    case: str
    error: float


@dataclass(frozen=True)
class ShaftTorque:
    """The largest values of one spring, and the order that leads at the largest vibratory torque.

    vibratory, peak: torques [N m]; stress: vibratory [Pa], NaN without a diameter; heat [W]: at the speeds searched.
    """

    spring: str
    vibratory: LargestTorque
    peak: LargestTorque
    stress: float
    heat: LargestTorque
    leading: str


@dataclass(frozen=True)
class Malfunction:
    """One cylinder out of work, ``how``: "misfiring" or "cut out".

    vibratory: largest torque [N m] of every spring over range and load cases; checks: those of the response that
    decide; ended: what ended the search before it was done, "" where nothing did.
    """

    cylinder: str
    vibratory: tuple[LargestTorque, ...]
    checks: tuple[Check, ...]
    ended: str
    how: str = SILENT["misfiring"]

    def __str__(self) -> str:
        return f"{self.cylinder}, {self.how}"


@dataclass(frozen=True)
class SubmissionContents:
    """Results of the report that is handed in; None or empty where a question does not apply.

    normal: checks with all cylinders firing, None where those of the verdict are that; left_out: what was not computed,
    or in part, and why; unsearched: cylinders among them, which were not put out of
    work; complete: whether every torque of every shaft was searched to the end.
    """

    seen: OverviewAssessment
    campbell: CampbellDiagram | None
    holzer: tuple[HolzerTable, ...]
    powers: tuple[MeanPower, ...]
    shafts: tuple[ShaftTorque, ...]
    firing: tuple[LargestTorque, ...]
    misfiring: tuple[Malfunction, ...]
    cases: tuple[LoadCaseResponse, ...]
    normal: tuple[Check, ...] | None
    left_out: tuple[str, ...]
    unsearched: tuple[str, ...]
    complete: bool

    @property
    def firing_checks(self) -> tuple[Check, ...]:
        """With all cylinders firing; of a line without cylinders those of the verdict."""
        return self.seen.assessment.checks if self.normal is None else self.normal


def gather(
    seen: OverviewAssessment,
    progress: Callable[[float], None] | None = None,
    doing: Callable[[str], None] | None = None,
) -> SubmissionContents:
    """What belongs on the pages after the verdict; ``progress`` is called as progress(share done), ``doing`` with the
    cylinder that is searched out of work.

    Where a time limit ends it, what is known by then, and ``left_out`` says what is missing.
    """
    left_out: list[str] = []
    done = _Share(progress, doing, seen)

    def unless_refused(question: str, answer: Callable[[], Found]) -> Found | None:
        try:
            return answer()
        except (InputError, ComputationError) as error:
            left_out.append(f"{question}: {error}")
        except OutOfTime as error:
            left_out.append(f"{question}: not computed, {error.why}")
        return None

    low, high = diagram_range(*seen.speed_range)
    speeds = np.linspace(max(low, high / 200), high, 201)
    campbell = unless_refused("Campbell diagram", lambda: campbell_diagram(seen.assembly, speeds))
    asked = [case for case in seen.subject.cases if case.response is not None]
    left_out += [f"Torques{case.suffix}: {case.answer}" for case in seen.subject.cases if case.response is None]
    cases = _searched(asked, left_out, done)
    loaded = [case for case in cases if case.name in _load_cases(seen)]  # a cylinder out of work leaves the mean torque
    powers = unless_refused("Torque and power", lambda: tuple(p for case in loaded for p in _powers(case)))
    shafts = unless_refused("Torques of the shafts", lambda: _shafts(cases))
    firing = unless_refused("All cylinders firing", lambda: _all_firing(seen, cases)) or ()
    normal = unless_refused("All cylinders firing", lambda: _vibratory(firing)) if firing else None
    misfiring, unsearched = _malfunctions(seen, firing if normal else (), left_out, done)
    left_out += [f"Torques{case.suffix}: searched in part, {why}" for case in cases for why in {*case.ended_by}]
    left_out += [f"Malfunction, {one}: searched in part, {one.ended}" for one in misfiring if one.ended]
    return SubmissionContents(
        seen=seen,
        campbell=campbell,
        holzer=tuple(holzer(seen.natural_frequencies, mode) for mode in _modes(seen, campbell)),
        powers=powers or (),
        shafts=shafts or (),
        firing=normal or (),
        misfiring=misfiring,
        cases=cases,
        normal=_normal(seen, firing),
        left_out=tuple(left_out),
        unsearched=unsearched,
        complete=len(cases) == len(seen.subject.cases) and not any(case.ended_by for case in cases),
    )


class _Share:
    """Counts the searches that are done: of every load case, and of every cylinder out of work."""

    def __init__(
        self,
        progress: Callable[[float], None] | None,
        doing: Callable[[str], None] | None,
        seen: OverviewAssessment,
    ) -> None:
        self.progress, self.doing, self.done = progress, doing, 0
        self.all = len(seen.subject.cases) + len(_out_of_work(seen))

    def begin(self, what: str) -> None:
        """Say what is searched next."""
        if self.doing is not None:
            self.doing(what)

    def step(self) -> None:
        self.done += 1
        if self.progress is not None:
            self.progress(min(self.done / self.all, 1.0))


def _searched(cases: list[LoadCaseResponse], left_out: list[str], done: _Share) -> tuple[LoadCaseResponse, ...]:
    """Cases in which the torques of all springs are searched, not only those that a limit bounds; without those that a
    time limit ended before anything was known."""
    springs = range(len(cases[0].answered.springs)) if cases else ()
    found = []
    for case in with_torques(cases, tuple((word, s) for word in WORDS for s in springs)):
        if case.response is None:
            left_out.append(f"Torques{case.suffix}: not computed, {case.answer}")
        else:
            found.append(case)
        done.step()
    return tuple(found)


def _modes(seen: OverviewAssessment, campbell: CampbellDiagram | None) -> list[int]:
    """Modes up to the highest that an excitation meets in the range; the lowest elastic one in any case."""
    found = seen.natural_frequencies
    first = found.still + 1
    met = [crossing.mode for crossing in campbell.crossings] if campbell else []
    return list(range(first, min(max(met, default=first), first + MOST_MODES - 1, len(found.mode)) + 1))


def _powers(case: LoadCaseResponse) -> Iterator[MeanPower]:
    """Of the spring that carries the most power, over the range."""
    response, topo = case.answered, case.assembly.topology
    if not response.springs:
        return
    ratios = np.array(
        [topo.mean_speeds[topo.reference[c.far_group] if c.far is None else c.far] for c in topo.compliances]
    )
    most = int(np.nan_to_num(np.abs(response.mean_torque * ratios)).max(axis=0).argmax())
    low, high = max(case.low, case.speeds[0]), case.high
    speeds = np.linspace(low, high, POWERS) if low < high else np.array([high])
    torque = case.respond(speeds).mean_torque[:, most]
    for speed, one in zip(speeds, torque, strict=True):
        power = abs(float(one * ratios[most] * speed))
        yield MeanPower(case.name, float(speed), response.springs[most], abs(float(one)), power)


def _shafts(cases: tuple[LoadCaseResponse, ...]) -> tuple[ShaftTorque, ...]:
    return tuple(_shaft(cases, s, name) for s, name in enumerate(cases[0].answered.springs)) if cases else ()


def _shaft(cases: tuple[LoadCaseResponse, ...], spring: int, name: str) -> ShaftTorque:
    vibratory = _largest(cases, "vibratory", spring)
    leads = next(case for case in cases if case.name == vibratory.case).answered
    heats = [(*case.answered.largest(case.answered.heat[:, spring]), case.name, np.nan) for case in cases]
    return ShaftTorque(
        spring=name,
        vibratory=vibratory,
        peak=_largest(cases, "peak", spring),
        stress=vibratory.value * float(leads.stress_factor[spring]),
        heat=LargestTorque(*max(heats)),
        leading=leads.leading(name)[0],
    )


def _largest(cases: Iterable[LoadCaseResponse], word: str, spring: int) -> LargestTorque:
    """Of all cases, the first of those that are alike; infinite where a steady state is missing."""
    tops = []
    for case in cases:
        (measure,) = torque_measures(case.assembly, ((word, spring),))
        found = case.largest(measure)
        tops.append(LargestTorque(found.value, float(case.speeds[found.at]), case.name, found.error))
    most = max(top.value for top in tops)
    return next(top for top in tops if top.value >= most * (1 - ALIKE))


def _load_cases(seen: OverviewAssessment) -> set[str]:
    """Names of the line as described and of the load cases that it states."""
    return {"", *(one.name for one in (seen.line.operation or Operation()).load_cases)}


def _all_firing(seen: OverviewAssessment, cases: tuple[LoadCaseResponse, ...]) -> tuple[LoadCaseResponse, ...]:
    """Load cases of a line with cylinders, none of them out of work; () of a line without cylinders."""
    parts = seen.line.as_stated.parts
    if not any(True for _ in cylinders(parts)):
        return ()
    stated = [case for case in cases if case.name in _load_cases(seen)]  # not those that put a cylinder out of work
    working = {
        name: {key: None for key in SILENT if getattr(one, key, None) is not None}
        for name, one in parts
        if any(getattr(one, key, None) is not None for key in SILENT)
    }
    if not working:
        return tuple(stated)
    return tuple(replace(case, assembly=assemble(case.assembly.line.replace_all(working))) for case in stated)


def _normal(seen: OverviewAssessment, firing: tuple[LoadCaseResponse, ...]) -> tuple[Check, ...] | None:
    """Checks of the response with all cylinders firing, where the verdict is also about cylinders out of work."""
    asked = seen.line.operation or Operation()
    silent = any(getattr(one, key, None) is not None for _, one in seen.line.as_stated.parts for key in SILENT)
    if not firing or not (silent or asked.misfiring or asked.cut_out):
        return None
    try:
        found = worst(check for case in firing for check in of_response(seen.subject, case))
        return tuple(weighed(found, seen.operation))
    except OutOfTime:
        return None


def _vibratory(cases: tuple[LoadCaseResponse, ...]) -> tuple[LargestTorque, ...]:
    return tuple(_largest(cases, "vibratory", s) for s in range(len(cases[0].answered.springs)))


def _out_of_work(seen: OverviewAssessment) -> list[tuple[str, Cylinder]]:
    """Every cylinder by the key that puts it out of work. Cut out as well where a misfire leaves the gas torque of
    compression, which is then gone."""
    parts = seen.line.as_stated.parts
    compressing = {name for name, one in parts if isinstance(one, Engine) and one.compresses}
    every = [("misfiring", one) for one in cylinders(parts)]
    return every + [("cut_out", one) for one in cylinders(parts, "cut_out") if one.owner in compressing]


def _malfunctions(
    seen: OverviewAssessment, firing: tuple[LoadCaseResponse, ...], left_out: list[str], done: _Share
) -> tuple[tuple[Malfunction, ...], tuple[str, ...]]:
    """Every cylinder out of work in turn, each searched by itself: other orders lead then, at other speeds. Also those
    of which nothing is known, as where a time limit ended it before."""
    found: list[Malfunction] = []
    unsearched: dict[str, list[str]] = {}  # by reason
    for key, one in _out_of_work(seen):
        called = one.owner if one.alone else f"cylinder {one.number} of {one.owner}"
        try:
            if not firing:
                raise ComputationError("there is no response with all cylinders firing to compare with")
            keep_time()
            done.begin(f"{called}, {SILENT[key]}")
            found.append(_malfunction(seen, firing, key, one, called))
        except (InputError, ComputationError) as error:
            unsearched.setdefault(str(error), []).append(f"{called}, {SILENT[key]}")
        except OutOfTime as error:
            unsearched.setdefault(error.why, []).append(f"{called}, {SILENT[key]}")
        done.step()
    left_out += [f"Malfunction, not computed, {why}: {listed(names)}" for why, names in unsearched.items()]
    return tuple(found), tuple(name for names in unsearched.values() for name in names)


def _malfunction(
    seen: OverviewAssessment, firing: tuple[LoadCaseResponse, ...], key: str, one: Cylinder, called: str
) -> Malfunction:
    failing = tuple(_without(case, one.owner, key, one.number) for case in firing)
    for case in failing:
        if case.response is None:
            raise OutOfTime(case.ended_by[0]) if case.ended_by else ComputationError(str(case.answer))
    found = weighed(worst(check for case in failing for check in of_response(seen.subject, case)), seen.operation)
    return Malfunction(
        cylinder=called,
        vibratory=_vibratory(failing),
        checks=tuple(check for check in found if check.exceeded or check.satisfied or check.missing),
        ended="; ".join({why: None for case in failing for why in case.ended_by}),
        how=SILENT[key],
    )


def _without(case: LoadCaseResponse, name: str, key: str, number: int) -> LoadCaseResponse:
    # Which mode leads is not printed of them, and takes the modes of every speed; nor are peaks.
    effort, asked = replace(case.effort, named=False), tuple(one for one in case.torques if one[0] == "vibratory")
    failing = assemble(case.assembly.line.replace(name, **{key: number}))
    return replace(with_other_excitations(case, failing), effort=effort, torques=asked)
