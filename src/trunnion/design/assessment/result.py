"""What ``assess`` gives: a verdict, and every check with its margin."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from trunnion.design.assessment.check import Check, Status, merged
from trunnion.driveline.operation import Operation
from trunnion.driveline.rules import APPLICATIONS, RULES, SwitchedOff, Weight
from trunnion.results.counts import few
from trunnion.results.fields import attribute, computed, internal, labelled, members
from trunnion.results.finding import Finding
from trunnion.results.result import Result

SEPARATION = "separation"
COLUMNS = (
    "status proof rule decides margin required_margin value bound limit error unit speed because "
    "rule.formula rule.source rule.certainty inputs load_case covered_in_words"
)
"""What datasets hold of each check."""
STATE_APPLICATION = 'state application in [operation], as "road", to let those decide that fit the machine'


@labelled
class Assessment(Result):
    """A line judged over its running range; not judged where a limit is missing that alone could judge."""

    verdict: Status = attribute("exceeded, satisfied or not judged")
    checks: tuple[Check, ...] = members(
        Check, "check", "the binding one first, then by margin", name="name", only=COLUMNS
    )
    barred: tuple[tuple[float, float], ...] = internal("speed ranges that it may only pass quickly", "rad/s")
    low: float = internal("end of the running range", "rad/s")
    high: float = internal("end of the running range", "rad/s")
    speed: float | None = internal("operating speed, if there is one", "rad/s")
    unit: str = internal("of speeds in print")
    findings: tuple[Finding, ...] = attribute("what was said on the way", default=())
    operation: Operation = internal("what the line states of itself", default=Operation())

    @property
    @computed(attribute(name="barred_rad_per_s"))
    def _barred(self) -> list[float]:
        return [float(end) for pair in self.barred for end in pair]

    @property
    def application(self) -> str | None:
        """What the line is, by its description; None where it does not say."""
        return self.operation.application

    @property
    @computed(attribute(name="application"))
    def _applied(self) -> str:
        return self.application or ""

    @property
    @computed(attribute())
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
        guidelines = f"the {_guidelines(named)}" if named else "no guideline decides"
        about = APPLICATIONS[self.application]
        return f"Application {self.application} ({about}): {guidelines} beside limits, ratings and physical checks."

    @property
    @computed(attribute())
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
            ranges = self.words.barred(self.barred)
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
                        here, ends = self.words.speed(self.speed), self.words.barred([(low, high)])
                        return f"; it runs at {here}, within {ends} that it may only pass"
        return ""

    def check(self, name: str) -> Check:
        """The check called ``name``; KeyError where there is none."""
        for one in self.checks:
            if one.name == name:
                return one
        raise KeyError(name)

    def table(self, unit: str | None = None) -> list[dict[str, object]]:
        """One row a check, speeds in ``unit``."""
        words = self.in_unit(unit).words
        return [
            {
                "check": c.name,
                "status": c.words,
                "margin": c.margin_word,
                f"speed [{words.unit}]": f"{c.speed * words.factor:.5g}" if c.speed == c.speed else "",
                "because": c.because,
            }
            for c in self.checks
        ]

    def _lines(self) -> Iterator[str]:
        yield f"assessment {self.words.over(self.low, self.high)}: {self.sentence}"
        for c in self.checks:
            yield f"  {c.words}: {c.name}: {c.because}"
            if c.judged:
                details = [c.rule.formula, f"{c.rule.source} ({c.rule.certainty})", c.inputs]
                yield f"      {'; '.join(d for d in details if d)}"
        yield f"  {self.rests_on}"
        yield from (f"  switched off: {one}" for one in self.switched_off)


def transient_checks(check: Check, checks: Iterable[Check]) -> list[Check]:
    """Of ``checks`` those of what may be borne for passing quickly what ``check`` is about."""
    names = (f"transient vibratory torque of {check.element}", f"{check.name}, passing")
    return [one for one in checks if one.name in names]


def passable(check: Check, checks: tuple[Check, ...], speed: float | None) -> bool:
    """Whether an exceeded check only bars speeds: its transient limit holds, and the line does not run there."""
    holds = any(one.status is Status.SATISFIED for one in transient_checks(check, checks))
    inside = speed is not None and any(a <= speed <= b for a, b in check.barred)
    return bool(check.barred) and holds and not inside


def _guidelines(names: list[str]) -> str:
    """ "guideline a decides", "guidelines a, b and c decide"."""
    if len(names) == 1:
        return f"guideline {names[0]} decides"
    return f"guidelines {', '.join(names[:-1])} and {names[-1]} decide"


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
