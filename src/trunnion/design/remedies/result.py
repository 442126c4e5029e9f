"""What ``remedies`` gives: changes that help, in sentences, and the sensitivities behind them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from trunnion.arrays import Array
from trunnion.design.assessment.check import Status
from trunnion.design.assessment.result import Assessment
from trunnion.design.sensitivity.variables import STEPS, DesignVariable
from trunnion.results.counts import counted
from trunnion.results.fields import attribute, coordinate, internal, labelled, members
from trunnion.results.fields import variable as stated
from trunnion.results.result import Result
from trunnion.results.variables import Attribute, Variable, attributes

SIZE = "|Δ ln p| of a factor, an angle over 30 deg of a joint and 257 deg of a phase"
STRONGEST = 3
"""Sensitivities printed of each check."""
LEAST, SHARE = 1e-5, 0.01
"""Changes of a value that no reader can see, and shares of the strongest, below which sensitivities are not printed."""


@labelled
class Remedy:
    """One change that satisfies a check and breaks no other."""

    check: str = stated(name="remedy_check")
    variable: str = stated(words="path of what changes", name="remedy_variable")
    before: float = stated(name="remedy_before")
    after: float = stated(name="remedy_after")
    unit: str = stated(words="of the variable", name="remedy_unit")
    size: float = stated(words=SIZE, name="remedy_size")
    value: float = stated(words="of the check after the change", name="remedy_value")
    margin: float = stated(words="of the check after the change", name="remedy_margin")
    required_margin: float = stated(words="of the check", name="remedy_required_margin")
    verdict: Status = stated(words="of the whole line after it", name="remedy_verdict")
    sentence: str = stated()

    @property
    def title(self) -> str:
        """The check and what changes."""
        return f"{self.check}: {self.variable}"

    def __str__(self) -> str:
        return self.sentence


@labelled
class Remedies(Result):
    """Smallest single changes for every check that is exceeded or has little margin, and what each check is
    sensitive to."""

    assessment: Assessment = internal("of the line as it is")
    checks: tuple[str, ...] = coordinate("check", words="those that are exceeded or have little margin")
    variables: tuple[DesignVariable, ...] = members(DesignVariable, "variable", name="path")
    sensitivity: Array = stated("check variable", words="d ln(value)/d ln(variable), of angles per radian")
    sensitivity_error: Array = stated("check variable")
    sensitivity_speed: Array = stated("check", "rad/s", "input speed where it was taken")
    remedies: tuple[Remedy, ...] = members(Remedy, "remedy", "smallest change first for each check", name="title")
    closest: dict[str, str] = internal("the smallest change for checks without a remedy, and what it breaks")
    lines: int = attribute("how many were judged")
    verified: str = attribute("which checks of the changed lines were judged anew, and where")
    ended: str = attribute("what ended the search before it was done, as a clause", default="")

    def of(self, check: str) -> tuple[Remedy, ...]:
        """What helps one check, smallest change first."""
        return tuple(remedy for remedy in self.remedies if remedy.check == check)

    def strongest(self, check: str, most: int = STRONGEST) -> list[tuple[DesignVariable, float]]:
        """Variables that a check's value follows most, with its change [-] for +1 % of a factor, +1 deg of a joint's
        angle, +10 deg of a phase; none that is within its error, or too small to matter."""
        at = self.checks.index(check)
        step = np.array([STEPS[v.scale][0] for v in self.variables])
        scaled, error = self.sensitivity[at] * step, self.sensitivity_error[at] * step
        size = np.abs(np.nan_to_num(scaled))
        matters = (size >= max(LEAST, SHARE * size.max(initial=0.0))) & ~(size <= error)
        order = np.argsort(-size)[:most]
        return [(self.variables[i], float(scaled[i])) for i in order if matters[i]]

    @property
    def sentences(self) -> tuple[str, ...]:
        """One sentence a remedy, or that there is none, for every check."""
        if not self.checks:
            if self.assessment.ended:
                return (f"nothing that is judged is exceeded or nearly binding; {self.assessment.ended}",)
            return ("no check is exceeded or nearly binding: nothing to remedy",)
        found = []
        for check in self.checks:
            known = self.of(check)
            found += [f"{check}: {remedy.sentence}" for remedy in known]
            if not known and self.ended:
                found.append(f"{check}: no change was found that satisfies it and breaks no other check: {self.ended}")
            elif not known:
                none = (
                    f"{check}: no single change of up to a factor of two, 21 deg of a joint or half a turn of a phase "
                    "satisfies it and breaks no other check"
                )
                found.append("; ".join([none, *([self.closest[check]] if check in self.closest else [])]))
            elif self.ended:
                found.append(f"{check}: {self.ended}, so that other changes may help too")
        return tuple(found)

    def declared(self) -> Iterator[Variable | Attribute]:
        """Sensitivities over (check, variable), remedies along their own axis."""
        yield from super().declared()
        yield Variable("closest", [self.closest.get(check, "") for check in self.checks], "check")
        yield from attributes(verdict=self.assessment.verdict)

    def _lines(self) -> Iterator[str]:
        yield (
            f"remedies: {counted(len(self.remedies), 'single change')} for {counted(len(self.checks), 'check')}, "
            f"{counted(self.lines, 'line')} judged"
        )
        if self.remedies:
            yield f"  each verified by judging the changed line: {self.verified}"
        yield from (f"  {sentence}" for sentence in self.sentences)
        yield from (f"  {sentence}" for check in self.checks for sentence in self.sensitivity_sentences(check))

    def sensitivity_sentences(self, check: str) -> list[str]:
        """What the value of a check follows most, in one sentence; none where it has no value."""
        known = self.strongest(check)
        if not known:
            return []
        parts = [f"{100 * change:+.3g} % for {STEPS[v.scale][1]} of {v.path}" for v, change in known]
        return [f"{check} follows most: {', '.join(parts)}"]
