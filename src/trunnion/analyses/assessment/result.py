"""What ``assess`` gives: a verdict, and every check with its margin."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from trunnion.analyses.assessment.check import Check, Status, merged, percent
from trunnion.results.counts import few
from trunnion.results.declared import Held, Result, axis, members_over, over, remarks
from trunnion.results.finding import Finding
from trunnion.results.speeds import show_speed, speed_factor


@dataclass(frozen=True, repr=False)
class Assessment(Result):
    """A line judged over its running range.

    verdict: exceeded, satisfied, or not judged where a limit is missing that alone could judge; checks: the binding
    one first, then by margin; barred: speed ranges [rad/s] that the line may only pass quickly; low, high: the running
    range, speed: the operating one [rad/s] or None; unit: of speeds in print; findings: what was said on the way.
    """

    verdict: Status
    checks: tuple[Check, ...]
    barred: tuple[tuple[float, float], ...]
    low: float
    high: float
    speed: float | None
    unit: str
    findings: tuple[Finding, ...] = ()

    @property
    def binding(self) -> Check | None:
        """The check that decides: exceeded most, or satisfied with the least margin; None where nothing is judged."""
        first = next(iter(self.checks), None)
        return first if first and first.status in (Status.EXCEEDED, Status.SATISFIED) else None

    @property
    def sentence(self) -> str:
        """The verdict in one sentence."""
        over_limit = [c for c in self.checks if c.status is Status.EXCEEDED]
        open_ones = [c for c in self.checks if c.status is Status.NOT_JUDGED]
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

    def _runs_where_barred(self) -> str:
        """Where only the operating speed keeps a range from being barred, as no sentence of a check says so."""
        for check in self.checks:
            if check.status is Status.EXCEEDED and passable(check, self.checks, None):
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
        yield over("check", "margin", [c.margin for c in self.checks], "1", "distance to the limit over the limit")
        yield from members_over("check", self.checks, required_margin="1")
        yield from members_over("check", self.checks, "in the unit of its check", value="", limit="")
        yield over("check", "check_unit", [c.unit for c in self.checks])
        yield from members_over("check", self.checks, "input speed where it binds", speed="rad/s")
        yield from members_over("check", self.checks, because="")
        yield from members_over("check", [c.rule for c in self.checks], formula="", source="", certainty="")
        yield from members_over("check", self.checks, inputs="", load_case="")
        yield from remarks(
            verdict=str(self.verdict),
            sentence=self.sentence,
            findings=[str(f) for f in self.findings],
            barred_rad_per_s=[float(x) for pair in self.barred for x in pair],
        )

    def table(self, unit: str | None = None) -> list[dict[str, object]]:
        """One row a check, speeds in ``unit``."""
        unit = unit or self.unit
        return [
            {
                "check": c.name,
                "status": str(c.status),
                "margin": percent(c.margin) if c.judged else "",
                f"speed [{unit}]": f"{c.speed * speed_factor(unit):.5g}" if c.speed == c.speed else "",
                "because": c.because,
            }
            for c in self.checks
        ]

    def __str__(self) -> str:
        span = f"{show_speed(self.low, self.unit)} to {show_speed(self.high, self.unit)}"
        rows = [f"assessment from {span}: {self.sentence}"]
        for c in self.checks:
            rows.append(f"  {c.status}: {c.name}: {c.because}")
            if c.judged:
                details = [c.rule.formula, f"{c.rule.source} ({c.rule.certainty})", c.inputs]
                rows.append(f"      {'; '.join(d for d in details if d)}")
        return "\n".join([*rows, *(f"  {finding}" for finding in self.findings)])


def passable(check: Check, checks: tuple[Check, ...], speed: float | None) -> bool:
    """Whether an exceeded check only bars speeds: its transient limit holds, and the line does not run there."""
    partner = (f"transient vibratory torque of {check.element}", f"{check.name}, passing")
    holds = any(c.name in partner and c.status is Status.SATISFIED for c in checks)
    inside = speed is not None and any(a <= speed <= b for a, b in check.barred)
    return bool(check.barred) and holds and not inside


def verdict_of(checks: tuple[Check, ...], speed: float | None) -> tuple[Status, tuple[tuple[float, float], ...]]:
    """The verdict over all checks, and the speed ranges that it bars."""
    exceeded = [c for c in checks if c.status is Status.EXCEEDED]
    barring = [c for c in exceeded if passable(c, checks, speed)]
    barred = merged(pair for c in barring for pair in c.barred)
    if len(barring) < len(exceeded):
        return Status.EXCEEDED, barred
    judged = any(c.status is Status.SATISFIED for c in checks)
    if any(c.status is Status.NOT_JUDGED for c in checks) or not judged:
        return Status.NOT_JUDGED, barred
    return Status.SATISFIED, barred
