"""What a design is to be best in, and which checks it has to satisfy."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from math import inf, isfinite, nan

import numpy as np

from trunnion.design.assessment.assess import checks_of, subject_of
from trunnion.design.assessment.assessment_input import (
    WHOLE,
    AssessmentInput,
    LoadCaseResponse,
    SearchEffort,
    with_torques,
)
from trunnion.design.assessment.check import Check, Status, below
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.refusals import nearest
from trunnion.errors import ComputationError, InputError
from trunnion.numerics.threads import on_threads
from trunnion.response.kinetostatics.chain import chain
from trunnion.response.kinetostatics.phasing import irregularity_of
from trunnion.response.orders.response import order_response
from trunnion.steady.orders.forced_response import shaft_names

IRREGULARITY, GROWTH, SPARE = "irregularity", "growth rate", "least spare margin"
MARGIN = "margin of "
WORST = 10.0
"""The largest violation that one check can count, in margins."""
NEAR = 0.8
"""Share of the largest torque from which that of another load case may turn out to be the largest."""
UserAim = Callable[[Driveline], float]


@dataclass(frozen=True)
class Aim:
    """One aim: its name and unit, and whether the largest value is wanted, not the smallest; of a torque, "peak" or
    "vibratory", and whose."""

    name: str
    unit: str
    largest: bool = False
    own: UserAim | None = None
    word: str = ""
    spring: str = ""

    @property
    def judged(self) -> bool:
        """Whether it needs the checks."""
        return self.name == SPARE or self.name.startswith(MARGIN)

    @property
    def over_range(self) -> bool:
        """Whether it needs a range of speeds."""
        return self.own is None and self.name != IRREGULARITY


@dataclass(frozen=True)
class DesignProblem:
    """What every design is asked: aims, the range of speeds [rad/s] or None, the checks that must hold (None: all
    that decide; empty: none), and the names of the load cases that aims look at (None: all)."""

    aims: tuple[Aim, ...]
    speeds: tuple[float, float] | None
    load_case: str | None
    unit: str
    required_checks: frozenset[str] | None
    cases: frozenset[str] | None = None

    @property
    def checking(self) -> bool:
        """Whether checks are computed."""
        return self.speeds is not None and (
            self.required_checks is None or bool(self.required_checks) or any(a.judged for a in self.aims)
        )

    def answer(self, line: Driveline, effort: SearchEffort = WHOLE) -> DesignEvaluation:
        """The aims of one line, and by how much it violates checks; NaN where it cannot be computed."""
        try:
            return self._answer(line, effort)
        except (InputError, ComputationError):
            return DesignEvaluation(tuple(nan for _ in self.aims), inf, ())

    def require(self, line: Driveline) -> None:
        """Raise what refuses a line, if anything does.

        Raises
        ------
        InputError, ComputationError : as the analyses behind the aims.
        """
        self._answer(line, WHOLE)

    def _answer(self, line: Driveline, effort: SearchEffort) -> DesignEvaluation:
        subject = None
        if self.checking or any(aim.over_range for aim in self.aims):
            subject = self._subject(line, effort)
            if self.cases is not None:
                subject = replace(subject, cases=tuple(c for c in subject.cases if c.name in self.cases))
        checks = checks_of(subject) if subject is not None and self.checking else ()
        values = tuple(_value(aim, line, subject, checks) for aim in self.aims)
        asked = [c for c in checks if self._must_hold(c)]
        judged = [c for c in asked if c.judged or _unsettled(c)]
        broken = [c for c in judged if c.status is Status.EXCEEDED or _unsettled(c)]
        violation = sum(min(abs(c.spare), WORST) for c in broken)
        return DesignEvaluation(
            values, violation, tuple(c.name for c in broken), min((c.spare for c in judged), default=inf)
        )

    @property
    def of_torques(self) -> bool:
        """Whether nothing but torques is asked for, of which the load cases' largest counts."""
        return not self.checking and all(aim.word or not aim.over_range for aim in self.aims)

    def _subject(self, line: Driveline, effort: SearchEffort) -> AssessmentInput:
        subject = subject_of(line, self.speeds, self.load_case, self.unit, effort)
        springs = shaft_names(subject.cases[0].assembly)
        asked = tuple((aim.word, springs.index(aim.spring)) for aim in self.aims if aim.word)
        return replace(subject, cases=tuple(with_torques(subject.cases, asked))) if asked else subject

    def near_cases(self, line: Driveline, effort: SearchEffort = WHOLE) -> frozenset[str]:
        """Names of the load cases whose torques come near the largest; none where nothing can be computed."""
        try:
            subject = self._subject(line, effort)
            torques = [_torques(aim, subject) for aim in self.aims if aim.word]
        except (InputError, ComputationError):
            return frozenset()
        return frozenset(
            name for found in torques for name, value in found.items() if value >= NEAR * max(found.values())
        )

    def _must_hold(self, check: Check) -> bool:
        return check.decides if self.required_checks is None else check.name in self.required_checks


@dataclass(frozen=True)
class DesignEvaluation:
    """Values of the aims, the violation of checks (0 where all hold), the names of those violated, and the least margin
    beyond the one required."""

    values: tuple[float, ...]
    violation: float
    broken: tuple[str, ...]
    spare: float = inf

    @property
    def possible(self) -> bool:
        """Whether there are values at all."""
        return all(isfinite(value) for value in self.values)


def aims_of(line: Driveline, aims: object) -> tuple[Aim, ...]:
    """One aim or two, by name or as a function of the line.

    Raises
    ------
    InputError : none or more than two; unknown names.
    """
    given = aims if isinstance(aims, tuple | list) else (aims,)
    if not 1 <= len(given) <= 2:
        raise InputError("must be one aim or two", key="aims", value=len(given), remedy='aims="irregularity", say')
    found = tuple(_aim(line, one) for one in given)
    if len({one.name for one in found}) < len(found):
        raise InputError("names one aim twice", key="aims", value=found[0].name, remedy="leave one out")
    return found


def _aim(line: Driveline, given: object) -> Aim:
    if callable(given):
        return Aim(getattr(given, "__name__", "own aim"), "1", own=given)
    from trunnion.equations.coefficients import assemble

    known = [Aim(IRREGULARITY, "1"), Aim(GROWTH, "1/s"), Aim(SPARE, "1", largest=True)]
    for word in ("peak", "vibratory"):
        for spring in shaft_names(assemble(line)):
            known.append(Aim(f"{word} torque of {spring}", "N*m", word=word, spring=spring))
    if isinstance(given, str) and given.startswith(MARGIN):
        return Aim(given, "1", largest=True)
    for aim in known:
        if aim.name == given:
            return aim
    remedy = f'{nearest(str(given), [aim.name for aim in known])}; "margin of CHECK", or a function of a line'
    raise InputError("is not an aim", key="aims", value=given, remedy=remedy)


def _unsettled(check: Check) -> bool:
    """Whether a check holds by less than its value may be low by: not judged, and no design to end at."""
    return (
        not check.judged and check.error > 0 and below(check.value + check.error, check.limit) < check.required_margin
    )


def _value(aim: Aim, line: Driveline, subject: AssessmentInput | None, checks: Iterable[Check]) -> float:
    if aim.own is not None:
        return float(aim.own(line))
    if aim.name == IRREGULARITY:
        return float(irregularity_of(chain(line), (), np.zeros((1, 0)))[0])
    assert subject is not None
    if aim.name == GROWTH:
        found = [one for case in subject.cases if (one := case.largest_growth()) is not None]
        return max(found)[0] if found else nan
    if aim.judged:
        return min(_margins(aim, checks), default=nan)
    return max(_torques(aim, subject).values(), default=nan)


def _torques(aim: Aim, subject: AssessmentInput) -> dict[str, float]:
    """The largest torque of the aim's spring [N m] by load case that has a response."""
    on_threads(LoadCaseResponse.respond_all, subject.cases, os.cpu_count() or 1)
    cases = [case for case in subject.cases if case.response is not None]
    if not cases:
        order_response(subject.cases[0].assembly, [subject.high])  # raises what refuses it
    return {case.name: case.largest_torque(aim.word, shaft_names(case.assembly).index(aim.spring))[0] for case in cases}


def _margins(aim: Aim, checks: Iterable[Check]) -> Iterator[float]:
    for check in checks:
        if not check.judged:
            continue
        if aim.name == SPARE and check.decides:
            yield check.spare
        elif aim.name == f"{MARGIN}{check.name}":
            yield check.margin
