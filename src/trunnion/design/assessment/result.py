"""What ``assess`` gives: a verdict, and every check with its margin."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from trunnion.design.assessment.check import Check, Status, merged
from trunnion.driveline.operation import Operation
from trunnion.driveline.rules import APPLICATIONS, RULES, SwitchedOff, Weight
from trunnion.results.counts import few
from trunnion.results.declared import Held, Result, axis, members_over, over, remarks
from trunnion.results.finding import Finding
from trunnion.results.speeds import show_speed, speed_factor

SEPARATION = "separation"
STATE_APPLICATION = 'state application in [operation], as "road", to let those decide that fit the machine'


@dataclass(frozen=True, repr=False)
class Assessment(Result):
    """A line judged over its running range.

    verdict: exceeded, satisfied, or not judged where a limit is missing that alone could judge; checks: the binding
    one first, then by margin; barred: speed ranges [rad/s] that the line may only pass quickly; low, high: the running
    range, speed: the operating one [rad/s] or None; unit: of speeds in print; findings: what was said on the way;
    operation: of the line, which states its application and the rules that are switched off.
    """

    verdict: Status
    checks: tuple[Check, ...]
    barred: tuple[tuple[float, float], ...]
    low: float
    high: float
    speed: float | None
    unit: str
    findings: tuple[Finding, ...] = ()
    operation: Operation = Operation()

    @property
    def application(self) -> str | None:
        """What the line is, by its description; None where it does not say."""
        return self.operation.application

    @property
    def switched_off(self) -> tuple[SwitchedOff, ...]:
        """Rules that the description switches off, with their reasons."""
        return self.operation.switched_off

    @property
    def binding(self) -> Check | None:
        """The check that decides: exceeded most, or satisfied with the least margin; None where nothing is judged."""
        return next((check for check in self.checks if check.exceeded or check.satisfied), None)

    @property
    def ended(self) -> str:
        """What ended the search before all of it was judged, as a clause; "" where nothing did."""
        return next((check.ended for check in self.checks if check.ended), "")

    @property
    def shown_beyond(self) -> tuple[Check, ...]:
        """Guidelines that the line is beyond and that do not decide."""
        return tuple(check for check in self.checks if check.status is Status.EXCEEDED and not check.decides)

    @property
    def rests_on(self) -> str:
        """Which guidelines the verdict rests on, in one sentence."""
        if self.application is None:
            return f"No application is stated: guidelines are shown and do not decide; {STATE_APPLICATION}."
        off = {one.rule for one in self.switched_off}
        deciding = [one for one in RULES.values() if one.weight(self.application) is Weight.DECIDES]
        named = [one.name for one in deciding if one.guideline and one.name not in off]
        guidelines = f"the guidelines {', '.join(named)} decide" if named else "no guideline decides"
        about = APPLICATIONS[self.application]
        return f"Application {self.application} ({about}): {guidelines} beside limits, ratings and physical checks."

    @property
    def sentence(self) -> str:
        """The verdict in one sentence; of a line without application also which guidelines it is beyond."""
        verdict = self._of_verdict()
        ended = f"; {self.ended}" if self.ended not in verdict else ""
        return verdict + ended + self._beyond_guidelines()

    def _of_verdict(self) -> str:
        over_limit = [c for c in self.checks if c.exceeded]
        open_ones = [c for c in self.checks if c.missing]
        bind = self.binding
        if self.verdict is Status.EXCEEDED:
            assert bind is not None
            more = f"; {len(over_limit) - 1} more exceeded" if len(over_limit) > 1 else ""
            rule = " (a guideline)" if bind.guideline else ""
            return f"exceeded: {bind.name}{rule}, {bind.because}{more}{self._runs_where_barred()}"
        if self.verdict is Status.NOT_JUDGED:
            names = few([c.name for c in open_ones])
            open_end = f"{names} could not be judged" if names else "no limit is stated"
            return f"not judged: nothing that is judged is exceeded, but {open_end}"
        if self.barred:
            ranges = " and ".join(f"{show_speed(a, self.unit)} to {show_speed(b, self.unit)}" for a, b in self.barred)
            return f"satisfied where {ranges} is barred and passed quickly: there only transient limits hold"
        assert bind is not None
        return f"satisfied: {bind.name} binds, {bind.because}"

    def _beyond_guidelines(self) -> str:
        beyond = dict.fromkeys(check.rule.name for check in self.shown_beyond)
        beyond.pop(SEPARATION, None)  # limits of torque judge it
        if not beyond or self.application is not None:
            return ""
        return f"; beyond guidelines that are shown only ({', '.join(beyond)}): {STATE_APPLICATION}"

    def _runs_where_barred(self) -> str:
        """Where only the operating speed keeps a range from being barred, as no sentence of a check says so."""
        for check in self.checks:
            if check.exceeded and passable(check, self.checks, None):
                for low, high in check.barred:
                    if self.speed is not None and low <= self.speed <= high:
                        ends = f"{show_speed(low, self.unit)} to {show_speed(high, self.unit)}"
                        return f"; it runs at {show_speed(self.speed, self.unit)}, within {ends} that it may only pass"
        return ""

    def check(self, name: str) -> Check:
        """The check called ``name``; KeyError where there is none."""
        for one in self.checks:
            if one.name == name:
                return one
        raise KeyError(name)

    def declared(self) -> Iterator[Held]:
        """Status, margin, value and limit over the checks."""
        yield axis("check", [c.name for c in self.checks])
        yield over("check", "status", [str(c.status) for c in self.checks])
        yield over("check", "rule", [c.rule.name for c in self.checks])
        yield over("check", "decides", np.array([c.decides for c in self.checks], dtype=np.int8))
        yield over("check", "margin", [c.margin for c in self.checks], "1", "distance to the limit over the limit")
        yield from members_over("check", self.checks, required_margin="1")
        yield from members_over("check", self.checks, "in the unit of its check", value="", limit="")
        about = "what the value may be low by, in the unit of its check"
        yield from members_over("check", self.checks, about, error="")
        yield over("check", "check_unit", [c.unit for c in self.checks])
        yield from members_over("check", self.checks, "input speed where it binds", speed="rad/s")
        yield from members_over("check", self.checks, because="")
        yield from members_over("check", [c.rule for c in self.checks], formula="", source="", certainty="")
        yield from members_over("check", self.checks, inputs="", load_case="")
        covered = [", ".join(f"{low:.6g} to {high:.6g}" for low, high in c.covered) for c in self.checks]
        yield over("check", "covered", covered, about="input speeds [rad/s] that it was judged over")
        yield from remarks(
            verdict=str(self.verdict),
            sentence=self.sentence,
            application=self.application or "",
            switched_off=[str(one) for one in self.switched_off],
            findings=[str(f) for f in self.findings],
            barred_rad_per_s=[float(x) for pair in self.barred for x in pair],
        )

    def table(self, unit: str | None = None) -> list[dict[str, object]]:
        """One row a check, speeds in ``unit``."""
        unit = unit or self.unit
        return [
            {
                "check": c.name,
                "status": c.word,
                "margin": c.margin_word,
                f"speed [{unit}]": f"{c.speed * speed_factor(unit):.5g}" if c.speed == c.speed else "",
                "because": c.because,
            }
            for c in self.checks
        ]

    def __str__(self) -> str:
        span = f"{show_speed(self.low, self.unit)} to {show_speed(self.high, self.unit)}"
        rows = [f"assessment from {span}: {self.sentence}"]
        for c in self.checks:
            rows.append(f"  {c.word}: {c.name}: {c.because}")
            if c.judged:
                details = [c.rule.formula, f"{c.rule.source} ({c.rule.certainty})", c.inputs]
                rows.append(f"      {'; '.join(d for d in details if d)}")
        rows.append(f"  {self.rests_on}")
        rows += [f"  switched off: {one}" for one in self.switched_off]
        return "\n".join([*rows, *(f"  {finding}" for finding in self.findings)])


def passable(check: Check, checks: tuple[Check, ...], speed: float | None) -> bool:
    """Whether an exceeded check only bars speeds: its transient limit holds, and the line does not run there."""
    partner = (f"transient vibratory torque of {check.element}", f"{check.name}, passing")
    holds = any(c.name in partner and c.status is Status.SATISFIED for c in checks)
    inside = speed is not None and any(a <= speed <= b for a, b in check.barred)
    return bool(check.barred) and holds and not inside


def verdict_of(checks: tuple[Check, ...], speed: float | None) -> tuple[Status, tuple[tuple[float, float], ...]]:
    """The verdict over the checks that decide, and the speed ranges that it bars."""
    exceeded = [c for c in checks if c.exceeded]
    barring = [c for c in exceeded if passable(c, checks, speed)]
    barred = merged(pair for c in barring for pair in c.barred)
    if len(barring) < len(exceeded):
        return Status.EXCEEDED, barred
    if any(c.missing for c in checks) or not any(c.satisfied for c in checks):
        return Status.NOT_JUDGED, barred
    return Status.SATISFIED, barred
