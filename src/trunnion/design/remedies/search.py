"""The smallest single changes that satisfy a check and break no other.

Every variable is moved away from its value step by step (``SIZES``, up and down) until enough of them satisfy the
check, then each is drawn back between the last step that failed and the first that did not, rounded to what a drawing
would say, and judged wholly. A window of values narrower than a step can be missed.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from trunnion.design.assessment.check import Check, Status
from trunnion.design.assessment.parametric import NAME as GROWTH
from trunnion.design.remedies.trials import Checks, TrialLine, TrialLines
from trunnion.design.sensitivity.variables import DesignVariable, Scale
from trunnion.numerics.threads import on_threads
from trunnion.waiting import OutOfTime

SIZES = (0.025, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.5, 0.6, 0.7)
"""Sizes of changes tried; the largest is a factor of two."""
FEWER_SIZES = (0.05, 0.1, 0.2, 0.35, 0.5, 0.7)
"""The same where every line costs seconds."""
PROBES = (0.2, 0.7)
"""Sizes at which a variable shows whether it matters at all."""
IDLE = 0.02
"""Share of the way to the goal that a variable has to move a margin to count as one that matters."""
CLOSEST = 2
"""Variables of which is said what they would break, where nothing else can be said."""
DRAWN = 5
"""Halvings between a step that fails and one that does not."""


@dataclass(frozen=True)
class CandidateChange:
    """A change that satisfies ``check``: the variable, its new value, all checks after it; or what it ``breaks``."""

    check: str
    variable: DesignVariable
    value: float
    after: Checks
    breaks: tuple[Check, ...] = ()

    @property
    def size(self) -> float:
        """|size| of the change."""
        return abs(self.variable.size(self.value))


@dataclass(frozen=True)
class Changes:
    """What a search found: changes that satisfy goals, smallest first; the closest where there is none; and what ended
    it before it was done, as a clause, "" where it was done."""

    found: list[CandidateChange]
    closest: list[CandidateChange]
    ended: str


class RemedySearch:
    """Looks for changes of one line that satisfy its ``goals``: by check, the spare margin to reach."""

    def __init__(
        self, trials: TrialLines, goals: dict[str, float], most: int, progress: Callable[[float], None] | None
    ):
        self.trials, self.goals, self.most, self.progress = trials, goals, most, progress
        self.variables = trials.design.variables
        self.sizes: tuple[float, ...] = FEWER_SIZES if trials.costly else SIZES
        self.probes: tuple[float, ...] = PROBES[1:] if trials.costly else PROBES

    def run(self) -> Changes:
        """The smallest changes for every goal, smallest first; of each variable the smaller direction. For goals
        without any, the smallest change that would do if it broke nothing."""
        passed: dict[str, dict[str, CandidateChange]] = {name: {} for name in self.goals}
        closest: list[CandidateChange] = []
        ended = ""
        try:
            self._search(passed, closest)
        except OutOfTime as error:
            ended = error.why
        found = [f for name in self.goals for f in sorted(passed[name].values(), key=lambda f: f.size)[: self.most]]
        return Changes(found, closest, ended)

    def _search(self, passed: dict[str, dict[str, CandidateChange]], closest: list[CandidateChange]) -> None:
        """Fill in what is found, by goal and variable, and the closest of goals without any."""
        matter = self._that_matter()
        last = 0.0
        for step, size in enumerate(self.sizes):
            open_goals = [name for name in self.goals if len(passed[name]) < self.most]
            if not open_goals:
                break
            self._ahead([(n, v, size) for n in open_goals for v in matter[n] if v.path not in passed[n]])
            for name in open_goals:
                self._step(name, matter[name], last, size, passed[name])
            last = size
            self._report_progress((step + 2) / (len(self.sizes) + 1))
        for name in self.goals:
            if not passed[name] and (one := self._closest(name, matter[name])):
                closest.append(one)
        self._report_progress(1.0)

    def _report_progress(self, share: float) -> None:
        if self.progress:
            self.progress(share)

    def _that_matter(self) -> dict[str, list[DesignVariable]]:
        """By goal the variables that move its margin; a nut that nothing hangs on is not turned twelve times."""
        kept: dict[str, list[DesignVariable]] = {}
        self._ahead([(n, v, size) for n in self.goals for v in self.variables for size in self.probes])
        for i, name in enumerate(self.goals):
            signed = [sign * size for size in self.probes for sign in (-1.0, 1.0)]
            kept[name] = [v for v in self.variables if any(self._moves(name, v, size) for size in signed)]
            self._report_progress((i + 1) / len(self.goals) / (len(self.sizes) + 1))
        return kept

    def _moves(self, name: str, variable: DesignVariable, size: float) -> bool:
        after = self._quick(variable, size)
        if after is None:
            return False
        before, now = self.trials.unchanged.get(name, self.trials.base[name]), self.trials.check(name, after)
        return now is None or not abs(now.spare - before.spare) <= IDLE * abs(self.goals[name] - before.spare)

    def _ahead(self, tasks: Iterable[tuple[str, DesignVariable, float]]) -> None:
        """Judge checks after changes of these sizes, up and down, side by side where every line costs seconds."""
        if self.trials.costly:
            lines: dict[tuple[str, float], list[tuple[str, DesignVariable, float]]] = {}
            for name, variable, size in tasks:
                for signed in (-size, size):
                    lines.setdefault((variable.path, signed), []).append((name, variable, signed))
            on_threads(lambda asked: [self._satisfies(*one) for one in asked], lines.values(), os.cpu_count() or 1)

    def _quick(self, variable: DesignVariable, size: float) -> TrialLine | None:
        value = variable.at(size)
        if variable.scale is Scale.BEND and value < 0:
            return None
        return self.trials.quick(variable, value)

    def _step(
        self, name: str, variables: list[DesignVariable], last: float, size: float, passed: dict[str, CandidateChange]
    ) -> None:
        """Add to ``passed`` what satisfies a goal with a change between the sizes ``last`` and ``size``, smallest
        first, until there are enough."""
        near = [
            (self._drawn(name, variable, sign * last, sign * size, self._helps), variable, sign * size)
            for variable in variables
            for sign in (-1.0, 1.0)
            if variable.path not in passed and self._helps(name, variable, sign * size)
        ]
        for least, variable, far in sorted(near, key=lambda one: abs(one[0])):
            if len(passed) >= self.most:
                return
            found = self._verified(name, variable, least, far) if variable.path not in passed else None
            if found:
                passed[variable.path] = found

    def _drawn(
        self, name: str, variable: DesignVariable, fails: float, passes: float,
        good: Callable[[str, DesignVariable, float], bool],
    ) -> float:  # fmt: skip
        """The size nearest to ``fails`` that is as ``good`` for a goal as ``passes``."""
        for _ in range(DRAWN):
            middle = (fails + passes) / 2
            if good(name, variable, middle):
                passes = middle
            else:
                fails = middle
        return passes

    def _verified(self, name: str, variable: DesignVariable, least: float, far: float) -> CandidateChange | None:
        for value in self._written(variable, least, far):
            after = self.trials.whole(variable, value)
            if after is not None and self._reached(name, after) and not self.trials.broken(name, after):
                return CandidateChange(name, variable, value, after.checks)
        return None

    def _closest(self, name: str, variables: list[DesignVariable]) -> CandidateChange | None:
        """The smallest change that satisfies a goal, and what it breaks, of the variables that do soonest."""
        sizes, near = (0.0, *self.sizes), []
        for variable in variables:
            for sign in (-1.0, 1.0):
                far = next((i for i in range(1, len(sizes)) if self._satisfies(name, variable, sign * sizes[i])), None)
                near += [(far, sign, variable)] if far is not None else []
        for far, sign, variable in sorted(near, key=lambda one: one[0])[:CLOSEST]:
            least = self._drawn(name, variable, sign * sizes[far - 1], sign * sizes[far], self._satisfies)
            value = next(self._written(variable, least, sign * sizes[far]))
            after = self.trials.whole(variable, value)
            if after is not None and self._reached(name, after) and (broken := self.trials.broken(name, after)):
                return CandidateChange(name, variable, value, {}, tuple(broken))
        return None

    def _written(self, variable: DesignVariable, size: float, far: float) -> Iterator[float]:
        """Values to judge wholly: the smallest that passes, rounded away from the present one; then somewhat more."""
        for share in (0.0, 0.3, 1.0):
            value = variable.tidy(variable.at(size + share * (far - size)))
            if variable.scale is not Scale.BEND or value >= 0:
                yield value
        yield variable.at(size)

    def _satisfies(self, name: str, variable: DesignVariable, size: float) -> bool:
        """Whether a change of signed ``size`` reaches a goal, as far as one sees when looking around."""
        after = self._quick(variable, size)
        return after is not None and not after.surely_exceeds(name) and self._reached(name, after)

    def _helps(self, name: str, variable: DesignVariable, size: float) -> bool:
        """The same, and breaks nothing."""
        after = self._quick(variable, size)
        return after is not None and self._satisfies(name, variable, size) and not self.trials.broken(name, after)

    def _reached(self, name: str, after: TrialLine) -> bool:
        check = self.trials.check(name, after)
        if check is None:
            return name.endswith(", passing")  # nothing is left to pass quickly
        if check.status is Status.NOT_APPLICABLE:
            return name == GROWTH  # a straight line that grew by its loads grows no more
        return check.status is Status.SATISFIED and bool(check.spare >= self.goals[name])


def goals_of(checks: tuple[Check, ...], near: float, *, shown: bool = False) -> dict[str, float]:
    """By check, the spare margin that a remedy has to reach: none for what is exceeded, ``near`` for what has less;
    with those that are ``shown`` only, or without."""
    found: dict[str, float] = {}
    for check in checks:
        if not (check.decides or shown):
            continue
        if check.status is Status.EXCEEDED:
            found[check.name] = 0.0
        elif check.status is Status.SATISFIED and np.isfinite(check.spare) and check.spare < near:
            found[check.name] = near
    return found
