"""What ``remedies`` gives: changes that help, in sentences, and the sensitivities behind them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.design.assessment.check import Status
from trunnion.design.assessment.result import Assessment
from trunnion.design.sensitivity.variables import STEPS, DesignVariable
from trunnion.results.counts import counted
from trunnion.results.declared import Held, Result, axis, over, remark, remarks_of

STRONGEST = 3
"""Sensitivities printed of each check."""
LEAST, SHARE = 1e-5, 0.01
"""Changes of a value that no reader can see, and shares of the strongest, below which sensitivities are not printed."""


@dataclass(frozen=True)
class Remedy:
    """One change that satisfies ``check`` and breaks no other.

    variable: path of what changes, from ``before`` to ``after`` in ``unit``; size: |Δ ln p| of a factor, an angle over
    30 deg of a joint and 257 deg of a phase; value, margin and required_margin: of the check after the change;
    verdict: of the whole line after it.
    """

    check: str
    variable: str
    before: float
    after: float
    unit: str
    size: float
    value: float
    margin: float
    required_margin: float
    verdict: Status
    sentence: str

    def __str__(self) -> str:
        return self.sentence


@dataclass(frozen=True, repr=False)
class Remedies(Result):
    """Smallest single changes for every check that is exceeded or has little margin, and what each check is
    sensitive to.

    checks: names of those checks; remedies: smallest change first for each of them; sensitivity (check, variable):
    d ln(value)/d ln p, of angles d ln(value)/dφ [1/rad], with sensitivity_error; sensitivity_speed (check,) [rad/s]:
    where it was taken; closest: for checks without a remedy the smallest change that would satisfy them, and what it
    breaks; assessment: of the line as it is; lines: how many were judged; verified: which checks of the
    changed lines were judged anew, and where; ended: what ended the search before it was done, as a clause, "" where it
    was done.
    """

    assessment: Assessment
    checks: tuple[str, ...]
    variables: tuple[DesignVariable, ...]
    sensitivity: Array
    sensitivity_error: Array
    sensitivity_speed: Array
    remedies: tuple[Remedy, ...]
    closest: dict[str, str]
    lines: int
    verified: str
    ended: str = ""

    def of(self, check: str) -> tuple[Remedy, ...]:
        """What helps one check, smallest change first."""
        return tuple(remedy for remedy in self.remedies if remedy.check == check)

    def strongest(self, check: str, most: int = STRONGEST) -> list[tuple[DesignVariable, float]]:
        """Variables that a check's value follows most, with its change [1] for +1 % of a factor, +1 deg of a joint's
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

    def declared(self) -> Iterator[Held]:
        """Sensitivities over (check, variable), remedies along their own axis."""
        yield axis("check", list(self.checks))
        yield axis("variable", [v.path for v in self.variables])
        yield over("variable", "present", [v.value for v in self.variables], about="in the unit of the variable")
        yield over("variable", "variable_unit", [v.unit for v in self.variables])
        about = "d ln(value)/d ln(variable), of angles per radian"
        yield over("check variable", "sensitivity", self.sensitivity, about=about)
        yield over("check variable", "sensitivity_error", self.sensitivity_error)
        yield over("check", "sensitivity_speed", self.sensitivity_speed, "rad/s", "input speed where it was taken")
        yield over("check", "closest", [self.closest.get(check, "") for check in self.checks])
        yield axis("remedy", [f"{r.check}: {r.variable}" for r in self.remedies])
        for key in ("check", "variable", "before", "after", "unit", "size", "value", "margin", "required_margin"):
            yield over("remedy", f"remedy_{key}", [getattr(r, key) for r in self.remedies])
        yield over("remedy", "remedy_verdict", [str(r.verdict) for r in self.remedies])
        yield over("remedy", "sentence", [r.sentence for r in self.remedies])
        yield remark("verdict", str(self.assessment.verdict))
        yield from remarks_of(self, "lines", "verified", "ended")

    def __str__(self) -> str:
        rows = [
            f"remedies: {counted(len(self.remedies), 'single change')} for {counted(len(self.checks), 'check')}, "
            f"{counted(self.lines, 'line')} judged"
        ]
        rows += [f"  each verified by judging the changed line: {self.verified}"] if self.remedies else []
        rows += [f"  {sentence}" for sentence in self.sentences]
        for check in self.checks:
            rows += [f"  {sentence}" for sentence in self.sensitivity_sentences(check)]
        return "\n".join(rows)

    def sensitivity_sentences(self, check: str) -> list[str]:
        """What the value of a check follows most, in one sentence; none where it has no value."""
        known = self.strongest(check)
        if not known:
            return []
        parts = [f"{100 * change:+.3g} % for {STEPS[v.scale][1]} of {v.path}" for v, change in known]
        return [f"{check} follows most: {', '.join(parts)}"]
