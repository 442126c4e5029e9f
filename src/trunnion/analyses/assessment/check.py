"""What one check gives: a status, a margin, where, and why.

The margin is the distance of the value to its limit over the limit: 0.2 keeps 20 % free, −0.5 exceeds by half.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from enum import Enum
from math import inf, isfinite, isnan, nan

from trunnion.analyses.assessment.cause import Cause
from trunnion.analyses.assessment.course import Course


class Status(Enum):
    """How a check ends."""

    SATISFIED = "satisfied"
    EXCEEDED = "exceeded"
    NOT_APPLICABLE = "not applicable"
    NOT_JUDGED = "not judged"

    def __str__(self) -> str:
        return self.value


@dataclass(frozen=True)
class Rule:
    """What a check stands on: formula, source, and how certain the rule is ("derived", "known", "typical", "yours")."""

    formula: str
    source: str
    certainty: str


@dataclass(frozen=True)
class Check:
    """One check.

    margin and required_margin [1], NaN where nothing is judged; value and limit in ``unit`` (SI); speed: of the input
    where it binds [rad/s]; because: one sentence; inputs: the numbers that went in; load_case: "" for the line as
    stated; barred: speed ranges [rad/s] to pass quickly; guideline: a rule of practice, not a limit or rating; cause:
    the order that leads there and the mode that it is nearest to; course: value and limit at all speeds judged.
    """

    name: str
    status: Status
    rule: Rule
    because: str
    margin: float = nan
    required_margin: float = 0.0
    value: float = nan
    limit: float = nan
    unit: str = ""
    speed: float = nan
    inputs: str = ""
    load_case: str = ""
    barred: tuple[tuple[float, float], ...] = ()
    guideline: bool = False
    element: str = ""
    cause: Cause | None = None
    course: Course | None = field(default=None, repr=False, compare=False)

    @property
    def judged(self) -> bool:
        """Whether it was: satisfied or exceeded."""
        return self.status in (Status.SATISFIED, Status.EXCEEDED)

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
    """Satisfied where the margin is the required one at least."""
    return Status.SATISFIED if margin >= required else Status.EXCEEDED


def percent(margin: float) -> str:
    """ "12 % free", "exceeded by 50 %"; of what must be reached, "5.5 times the least"."""
    if not isfinite(margin):
        return "exceeded without bound" if margin < 0 else ""
    if margin > 1:
        return f"{1 + margin:.3g} times the least"
    share = f"{float(f'{abs(100 * margin):.3g}'):.10g} %"
    return f"{share} free" if margin >= 0 else f"exceeded by {share}"


def in_order(checks: Iterable[Check]) -> tuple[Check, ...]:
    """What is exceeded first, then what is satisfied, each by spare margin, limits and ratings before guidelines."""
    return tuple(sorted(checks, key=_place))


def _place(check: Check) -> tuple[int, bool, float]:
    rank = [Status.EXCEEDED, Status.SATISFIED, Status.NOT_JUDGED, Status.NOT_APPLICABLE].index(check.status)
    return rank, check.status is Status.EXCEEDED and check.guideline, _known(check.spare)


def _known(number: float) -> float:
    return 0.0 if isnan(number) else number


def worst(checks: Iterable[Check]) -> tuple[Check, ...]:
    """Of checks of one name over several load cases, the one that binds, with the speeds that any of them bars."""
    by_name: dict[str, list[Check]] = {}
    for check in checks:
        by_name.setdefault(check.name, []).append(check)
    return tuple(
        replace(min(same, key=_severity), barred=merged(pair for check in same for pair in check.barred))
        for same in by_name.values()
    )


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
