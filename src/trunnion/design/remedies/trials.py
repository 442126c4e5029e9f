"""Judging a line with one number changed, quickly to search and wholly to be sure.

Checks are judged in groups, that of the check in question first: what does not satisfy it, or breaks another, costs no
more. Of a free–free line with joint angles every speed takes its periodic steady state. There the search looks at the
response about the motion of rigid shafts, right to first order in what joints force; what it finds is judged about the
periodic steady states, as ``assess`` does.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

from trunnion.design.assessment.assess import OF_RESPONSE, of_line, prepare
from trunnion.design.assessment.assessment_input import (
    TRIAL,
    WHOLE,
    AssessmentInput,
    LoadCaseResponse,
    SearchEffort,
    cases_of,
)
from trunnion.design.assessment.check import Check, Status, in_order, worst
from trunnion.design.assessment.deciding import weighed
from trunnion.design.assessment.fatigue_life import NAME as FATIGUE
from trunnion.design.assessment.fatigue_life import fatigue_life
from trunnion.design.assessment.parametric import NAME as GROWTH
from trunnion.design.assessment.parametric import parametric_stability
from trunnion.design.assessment.result import verdict_of
from trunnion.design.assessment.separation import ALL as SEPARATED
from trunnion.design.assessment.separation import ONE as SEPARATION_OF_ONE
from trunnion.design.assessment.separation import separation
from trunnion.design.sensitivity.variables import Design, DesignVariable
from trunnion.driveline.driveline import Driveline
from trunnion.waiting import keep_time

WORSE = 1e-3
"""Share of a limit by which what is exceeded already may be exceeded more."""

Checks = dict[str, Check]
Group = Callable[[AssessmentInput], Iterable[Check]]


def _by_case(rule: Callable[[AssessmentInput, LoadCaseResponse], Iterable[Check]]) -> Group:
    return lambda subject: worst(check for case in subject.cases for check in rule(subject, case))


GROUPS: tuple[Group, ...] = (of_line, *map(_by_case, (*OF_RESPONSE, separation, parametric_stability)), fatigue_life)
"""Checks that are judged together, what takes longest last: growth, then fatigue, which may run through passages."""


class TrialLine:
    """One line, of which groups of checks are judged as they are asked for; ``whole``: all of them will be."""

    def __init__(self, subject: AssessmentInput, groups: int, whole: bool = False) -> None:
        self.subject, self.groups, self.whole = subject, groups, whole
        self._found: dict[int, Checks] = {}

    def group(self, number: int) -> Checks:
        """The checks of one group, by name."""
        if number not in self._found:
            if self.whole and number and not any(self._found):
                prepare(self.subject.cases)
            found = weighed(GROUPS[number](self.subject), self.subject.line.operation)
            self._found[number] = {check.name: check for check in found}
        return self._found[number]

    def surely_exceeds(self, name: str) -> bool:
        """Whether some speeds show already that a check of the response is exceeded, before its largest value is
        searched for."""
        return any(case.surely_exceeds(name) for case in self.subject.cases)

    def in_turn(self, first: int) -> Iterator[Checks]:
        """The groups one by one, that with the number ``first`` before the others."""
        for number in (first, *(i for i in range(self.groups) if i != first)):
            yield self.group(number)

    @property
    def checks(self) -> Checks:
        """All of them by name, in order."""
        return {check.name: check for check in in_order(c for found in self.in_turn(0) for c in found.values())}


Known = dict[tuple[str, float], TrialLine | None]
"""Changed lines by the variable and its value; None where the line is refused."""


class TrialLines:
    """Changed lines, each judged once.

    quick: the checks of the load cases that bind, largest values to a hundredth; whole: all of them as ``assess`` does.
    """

    def __init__(
        self, subject: AssessmentInput, base: tuple[Check, ...], design: Design, targets: Iterable[Check]
    ) -> None:
        self.subject, self.design = subject, design
        self.base: Checks = {check.name: check for check in base}
        self.verdict = verdict_of(base, subject.speed)[0]
        self.costly = subject.cases[0].costly
        targets = tuple(targets)
        of_line = TrialLine(subject, 1).checks
        # What the response says to a change that helps a check of the line is left to the whole judgement where costly.
        asked = [check for check in targets if not (self.costly and check.name in of_line)]
        self.cases = {check.load_case for check in asked}
        growth = any(check.name == GROWTH for check in targets)
        life = any(check.rule.name == FATIGUE for check in targets)
        self.groups = (len(GROUPS) - (not life) - (not (life or growth))) if asked else 1
        self._quick: Known = {}
        self._whole: Known = {}
        unchanged = self._looked_at(subject.line)
        self.of = {name: i for i, found in enumerate(unchanged.in_turn(0)) for name in found}
        """By name of a check the number of its group."""
        self.unchanged = unchanged.checks

    @property
    def verified(self) -> str:
        """At which speeds ``whole`` judges."""
        subject = self.subject
        if subject.low == subject.high or subject.cases[0].given:
            return f"all checks at {subject.shown(subject.high)}"
        span = f"{subject.shown(subject.low)} to {subject.shown(subject.high)}"
        return f"all checks from {span}, as assess does"

    @property
    def count(self) -> int:
        """Lines judged so far."""
        return len(self._quick) + len(self._whole)

    def quick(self, variable: DesignVariable, value: float) -> TrialLine | None:
        """The changed line to look around; None where it is refused."""
        return self._judged(self._quick, variable, value, self._looked_at)

    def whole(self, variable: DesignVariable, value: float) -> TrialLine | None:
        """The changed line to be judged wholly; None where it is refused."""
        return self._judged(self._whole, variable, value, self._judged_wholly)

    def _judged(
        self, known: Known, variable: DesignVariable, value: float, judge: Callable[[Driveline], TrialLine]
    ) -> TrialLine | None:
        key = variable.path, value
        keep_time()
        if key not in known:
            line = self.design.changed(variable, value)
            known[key] = None if line is None else judge(line)
        return known[key]

    def _judged_wholly(self, line: Driveline) -> TrialLine:
        return TrialLine(self._asked(line, WHOLE), len(GROUPS), whole=True)

    def _asked(self, line: Driveline, effort: SearchEffort) -> AssessmentInput:
        """The same question about another line."""
        subject = self.subject
        cases = cases_of(line, subject.low, subject.high, effort)[: len(subject.cases)]
        return replace(subject, line=line, cases=cases, naming=False)

    def _looked_at(self, line: Driveline) -> TrialLine:
        subject = self._asked(line, TRIAL)
        cases = tuple(case for case in subject.cases if case.name in self.cases) or subject.cases[:1]
        if self.costly:
            cases = tuple(replace(case, rough=True) for case in cases)
        return TrialLine(replace(subject, cases=cases), self.groups)

    def check(self, name: str, trial: TrialLine) -> Check | None:
        """One check of a changed line, others judged with it only where they belong to its group; of a mode that no
        order meets any more, that of all such modes."""
        found = trial.group(self.of[name]) if name in self.of else trial.checks
        return found.get(name) or (found.get(SEPARATED) if name.startswith(SEPARATION_OF_ONE) else None)

    def broken(self, name: str, trial: TrialLine) -> list[Check]:
        """What a change made for the check called ``name`` breaks, or makes worse where it is exceeded already: of the
        first group of checks where there is any. A change that only spoils the verdict, by the operating speed in a
        barred range, say, breaks all that is exceeded."""
        before = self.base if trial.whole else self.unchanged
        for found in trial.in_turn(self.of.get(name, 0)):
            broken = [check for check in found.values() if _broken(before.get(check.name), check)]
            if broken:
                return broken
        if trial.whole and self.verdict is not Status.EXCEEDED:
            after = tuple(trial.checks.values())
            if verdict_of(after, self.subject.speed)[0] is Status.EXCEEDED:
                return [check for check in after if check.exceeded]
        return []


def _broken(before: Check | None, after: Check) -> bool:
    if after.exceeded:
        if before is None or not before.exceeded:
            return True
        return after.margin < before.margin - WORSE * (1 + abs(before.margin))
    return after.missing and before is not None and before.satisfied
