"""Judging a line with one number changed, quickly to search and wholly to be sure.

Of a bent line that starts free every speed takes a motion of its own. There the search looks at the response about the
motion of rigid shafts, right to first order in what joints force; what it finds is judged about the line's own motions,
over the whole range on a coarser grid.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from trunnion.analyses.assessment.assess import by_case, checks_of, of_line
from trunnion.analyses.assessment.check import Check, Status, worst
from trunnion.analyses.assessment.parametric import NAME as GROWTH
from trunnion.analyses.assessment.remedies.variables import Design, DesignVariable, Scale
from trunnion.analyses.assessment.result import verdict_of
from trunnion.analyses.assessment.subject import Subject, cases_of, lossy
from trunnion.driveline.driveline import Driveline

QUICK_POINTS = 41
"""Speeds of the even part of the grid while searching; the peaks of the modes get more, as ever."""
THINNED = 4
"""Every so many of them where every line costs seconds."""
WORSE = 1e-3
"""Share of a limit by which what is exceeded already may be exceeded more."""

Checks = dict[str, Check]


class Trials:
    """Changed lines, each judged once.

    quick: the checks of the load cases that bind, on a coarser grid of speeds; whole: all of them as ``assess`` does,
    of lines that have motions of their own on the coarser grid.
    """

    def __init__(self, subject: Subject, base: tuple[Check, ...], design: Design, targets: Iterable[Check]) -> None:
        self.subject, self.design = subject, design
        self.base: Checks = {check.name: check for check in base}
        self.verdict = verdict_of(base, subject.speed)[0]
        self.costly = subject.cases[0].costly
        self.points = QUICK_POINTS if self.costly and not lossy(subject.cases[0].assembly) else None
        targets = tuple(targets)
        self.growth = any(check.name == GROWTH for check in targets)
        self.of_line = {check.name for check in targets} & {check.name for check in of_line(subject)}
        # What the response says to a change that helps a check of the line is left to the whole judgement where costly.
        asked = [check for check in targets if not (self.costly and check.name in self.of_line)]
        self.cases = {check.load_case for check in asked}
        self._quick: dict[tuple[str, float], Checks | None] = {}
        self._whole: dict[tuple[str, float], Checks | None] = {}
        self.unchanged = self._judge(subject.line, None)

    @property
    def verified(self) -> str:
        """At which speeds ``whole`` judges."""
        subject = self.subject
        even = self.points or subject.cases[0].points
        if subject.low == subject.high or subject.cases[0].given:
            return f"all checks at {subject.shown(subject.high)}"
        span = f"{subject.shown(subject.low)} to {subject.shown(subject.high)}"
        return f"all checks from {span}, at {even} speeds evenly and those about the peaks"

    @property
    def count(self) -> int:
        """Lines judged so far."""
        return len(self._quick) + len(self._whole)

    def quick(self, variable: DesignVariable, value: float) -> Checks | None:
        """Checks by name; None where the line is refused."""
        key = variable.path, value
        if key not in self._quick:
            line = self.design.changed(variable, value)
            self._quick[key] = None if line is None else self._judge(line, variable)
        return self._quick[key]

    def whole(self, variable: DesignVariable, value: float) -> Checks | None:
        """All checks by name, in order; None where the line is refused."""
        key = variable.path, value
        if key not in self._whole:
            line = self.design.changed(variable, value)
            found = None if line is None else checks_of(self.of(line, self.points))
            self._whole[key] = None if found is None else {check.name: check for check in found}
        return self._whole[key]

    def of(self, line: Driveline, points: int | None = None) -> Subject:
        """The same question about another line."""
        subject = self.subject
        cases = cases_of(line, subject.low, subject.high, *((points,) if points else ()))[: len(subject.cases)]
        return replace(subject, line=line, cases=cases, naming=False)

    def _judge(self, line: Driveline, variable: DesignVariable | None) -> Checks:
        subject = self.of(line, QUICK_POINTS)
        cases = [case for case in subject.cases if case.name in self.cases]
        if self.costly:
            cases = [
                replace(case, rough=True, given=(*case.speeds[:-1:THINNED].tolist(), case.speeds[-1])) for case in cases
            ]
        found = list(worst(check for case in cases for check in by_case(subject, case, growth=self.growth)))
        if self.of_line or variable is None or variable.scale is not Scale.FACTOR:
            found += of_line(subject)
        return {check.name: check for check in found}

    def breaks(self, after: Checks, *, whole: bool) -> list[str]:
        """Names of checks that a change breaks, or makes worse where they are exceeded already."""
        before = self.base if whole else self.unchanged
        found = [name for name, check in after.items() if _broken(before.get(name), check)]
        if whole and self.verdict is not Status.EXCEEDED:
            found += ["the verdict"] * (verdict_of(tuple(after.values()), self.subject.speed)[0] is Status.EXCEEDED)
        return found


def _broken(before: Check | None, after: Check) -> bool:
    if after.status is Status.EXCEEDED:
        if before is None or before.status is not Status.EXCEEDED:
            return True
        return after.margin < before.margin - WORSE * (1 + abs(before.margin))
    return after.status is Status.NOT_JUDGED and before is not None and before.status is Status.SATISFIED
