"""What one check gives: a status, a margin, where, and why.

The margin is the distance of the value to its limit over the limit: 0.2 keeps 20 % free, −0.5 exceeds by half.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from enum import Enum
from math import inf, isfinite, isnan, nan

from trunnion.design.assessment.cause import Cause
from trunnion.design.assessment.response_curve import ResponseCurve
from trunnion.driveline.rules import RULES
from trunnion.results.fields import computed, internal, labelled, variable
from trunnion.results.units import range_words


class Status(Enum):
    """How a check ends."""

    SATISFIED = "satisfied"
    EXCEEDED = "exceeded"
    NOT_APPLICABLE = "not applicable"
    NOT_JUDGED = "not judged"

    def __str__(self) -> str:
        return self.value


PROVED, SEARCHED = "proved", "searched, not proved"
ROUNDING = 1e-12
"""Margin that adding up a handful of numbers may lose."""
SHOWN = {
    Status.EXCEEDED: "beyond guideline",
    Status.SATISFIED: "within guideline",
    Status.NOT_JUDGED: "guideline not judged",
    Status.NOT_APPLICABLE: str(Status.NOT_APPLICABLE),
}
"""How the status of a check that does not decide is printed."""


@dataclass(frozen=True)
class Rule:
    """What a check stands on: formula, source, how certain the rule is ("derived", "known", "typical", "yours"), and
    the name by which a file knows it (of ``driveline.rules.RULES``)."""

    formula: str
    source: str
    certainty: str
    name: str

    def __str__(self) -> str:
        return self.name


@labelled
class Check:
    """One check; its margins are NaN where nothing is judged, its error where nothing was searched."""

    name: str = internal()
    status: Status = variable()
    rule: Rule = variable()
    because: str = variable(words="one sentence")
    margin: float = variable("", "1", "distance to the limit over the limit", default=nan)
    required_margin: float = variable("", "1", default=0.0)
    value: float = variable(words="in the unit of its check", default=nan)
    limit: float = variable(words="in the unit of its check", default=nan)
    unit: str = variable(words="of value and limit", name="check_unit", default="")
    speed: float = variable("", "rad/s", "input speed where it binds", default=nan)
    inputs: str = variable(words="numbers that went in", default="")
    load_case: str = variable(words="empty for the line as stated", default="")
    barred: tuple[tuple[float, float], ...] = internal("speed ranges to pass quickly", "rad/s", default=())
    decides: bool = variable(words="whether the verdict rests on it", default=True)
    element: str = internal("that is judged", default="")
    cause: Cause | None = internal("the order that leads there and the mode that it is nearest to", default=None)
    course: ResponseCurve | None = internal(
        "value and limit at all speeds judged", default=None, repr=False, compare=False
    )
    error: float = variable(words="what the value may be low by, in the unit of its check", default=nan)
    covered: tuple[tuple[float, float], ...] = internal("speed ranges that it was judged over", "rad/s", default=())
    proof: str = variable(
        words='"proved" at every speed, "searched, not proved", or empty where nothing is searched or exceeded',
        default="",
    )
    bound: float = variable(words="proved not to be exceeded at any speed, in the unit of its check", default=nan)
    ended: str = internal("what ended its search before it was done, as a clause", default="")
    margin_said: str = internal("the margin in print, where a share of the limit says little", default="")

    @property
    @computed(variable(words="input speeds [rad/s] that it was judged over", name="covered"))
    def covered_in_words(self) -> str:
        """ "10 to 100, 120 to 200", in rad/s."""
        return ", ".join(range_words(f"{low:.6g}", f"{high:.6g}") for low, high in self.covered)

    @property
    def judged(self) -> bool:
        """Whether it was: satisfied or exceeded."""
        return self.status in (Status.SATISFIED, Status.EXCEEDED)

    @property
    def guideline(self) -> bool:
        """Whether it stands on a rule of practice, not on a limit, a rating or a physical check."""
        return RULES[self.rule.name].guideline

    @property
    def exceeded(self) -> bool:
        """Whether it is, and the verdict rests on it."""
        return self.decides and self.status is Status.EXCEEDED

    @property
    def satisfied(self) -> bool:
        """Whether it is, and the verdict rests on it."""
        return self.decides and self.status is Status.SATISFIED

    @property
    def missing(self) -> bool:
        """Whether the verdict rests on it, and it could not be judged."""
        return self.decides and self.status is Status.NOT_JUDGED

    @property
    def word(self) -> str:
        """The status in print: of a guideline that does not decide other words, so that it does not read as one."""
        return str(self.status) if self.decides else SHOWN[self.status]

    @property
    def words(self) -> str:
        """The same, "satisfied, proved" where a bound shows it at every speed."""
        return f"{self.word}, {PROVED}" if self.proof == PROVED else self.word

    @property
    def margin_word(self) -> str:
        """The margin in print, "" where nothing is judged."""
        if not self.judged:
            return ""
        return self.margin_said or percent(self.margin, binding=self.decides)

    @property
    def spare(self) -> float:
        """Margin beyond the one required."""
        return self.margin - self.required_margin


def below(value: float, limit: float) -> float:
    """Margin of a value that must not exceed ``limit``."""
    return 1 - value / limit if limit > 0 else (0.0 if value == 0 else -inf)


def above(value: float, limit: float) -> float:
    """Margin of a value that must reach ``limit``."""
    return value / limit - 1


def judged(margin: float, required: float = 0.0) -> Status:
    """Satisfied where the margin is the required one at least, or short of it by rounding."""
    return Status.SATISFIED if margin >= required - ROUNDING else Status.EXCEEDED


def percent(margin: float, *, binding: bool = True) -> str:
    """ "12 % free", "exceeded by 50 %", of what need not bind "50 % beyond"; of what must be reached, "5.5 times the
    least"."""
    if not isfinite(margin):
        return ("exceeded" if binding else "beyond") + " without bound" if margin < 0 else ""
    if margin > 1:
        return f"{1 + margin:.3g} times the least"
    if abs(margin) < ROUNDING:
        return "0 % free"
    share = f"{float(f'{abs(100 * margin):.3g}'):.10g} %"
    return f"{share} free" if margin >= 0 else f"exceeded by {share}" if binding else f"{share} beyond"


def in_order(checks: Iterable[Check]) -> tuple[Check, ...]:
    """What decides first, then what is shown only, each: what is exceeded, then what is satisfied, by spare margin,
    limits and ratings before guidelines."""
    return tuple(sorted(checks, key=_place))


def _place(check: Check) -> tuple[bool, bool, int, bool, float]:
    rank = [Status.EXCEEDED, Status.SATISFIED, Status.NOT_JUDGED, Status.NOT_APPLICABLE].index(check.status)
    aside = check.status is Status.NOT_APPLICABLE
    return aside, not check.decides, rank, check.status is Status.EXCEEDED and check.guideline, _known(check.spare)


def _known(number: float) -> float:
    return 0.0 if isnan(number) else number


def worst(checks: Iterable[Check]) -> tuple[Check, ...]:
    """Of checks of one name over several load cases, the one that binds, with the speeds that any of them bars; proved
    where all are."""
    by_name: dict[str, list[Check]] = {}
    for check in checks:
        by_name.setdefault(check.name, []).append(check)
    return tuple(
        replace(
            min(same, key=_severity),
            barred=merged(pair for check in same for pair in check.barred),
            proof=_proof({check.proof for check in same}),
        )
        for same in by_name.values()
    )


def _proof(proofs: set[str]) -> str:
    return PROVED if proofs == {PROVED} else SEARCHED if proofs & {PROVED, SEARCHED} else ""


def merged(ranges: Iterable[tuple[float, float]]) -> tuple[tuple[float, float], ...]:
    """Ranges with those that overlap joined."""
    found: list[tuple[float, float]] = []
    for low, high in sorted(ranges):
        if found and low <= found[-1][1]:
            found[-1] = (found[-1][0], max(high, found[-1][1]))
        else:
            found.append((low, high))
    return tuple(found)


def _severity(check: Check) -> tuple[int, float]:
    rank = [Status.EXCEEDED, Status.NOT_JUDGED, Status.SATISFIED, Status.NOT_APPLICABLE].index(check.status)
    return rank, _known(check.spare)
