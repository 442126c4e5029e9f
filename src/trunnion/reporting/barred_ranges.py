"""Speed ranges beyond a limit in the report that is handed in: with all cylinders firing and with one out of work, and
whether they may be passed quickly."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from trunnion.design.assessment.check import Check, Status, merged
from trunnion.design.assessment.result import transient_checks
from trunnion.reporting.submission_contents import SubmissionContents
from trunnion.reporting.tables import Table
from trunnion.results.counts import listed
from trunnion.results.words import Words

FIRING, SILENT = "all cylinders firing", "one cylinder out of work"
HOLDS, EXCEEDED, NONE = "limit for transients holds", "limit for transients exceeded", "no limit for transients stated"
SAME = 1e-6
"""Share by which ends of ranges may differ and count as the same."""
MOST = 6
"""Ranges on the first sheet."""


@dataclass(frozen=True)
class BarredRange:
    """Input speeds [rad/s] beyond the limits of checks by ``names``, in a state of the cylinders ("" without any), and
    what is known of passing it."""

    low: float
    high: float
    names: tuple[str, ...]
    state: str
    passing: str


def barred_ranges(contents: SubmissionContents) -> tuple[BarredRange, ...]:
    """Those with all cylinders firing, then those that one out of work adds or widens."""
    firing = contents.firing_checks
    if not (contents.misfiring or contents.unsearched):
        return _alike(_of(firing, ""))
    silent = [check for one in contents.misfiring for check in one.checks]
    every = (*contents.seen.assessment.checks, *silent, *firing)
    known = list(_of(firing, FIRING))
    added = [one for one in _of(every, SILENT) if not any(_same(one, other) for other in known)]
    return _alike([*known, *added])


def _of(checks: Sequence[Check], state: str) -> Iterator[BarredRange]:
    """By check; of several of one name, those of load cases or cylinders, together."""
    for name in dict.fromkeys(check.name for check in checks if check.decides):
        own = [check for check in checks if check.name == name and check.decides]
        for low, high in merged(ends for check in own for ends in check.barred):
            yield BarredRange(low, high, (name,), state, _passing(own[0], checks))


def _passing(check: Check, checks: Iterable[Check]) -> str:
    found = {one.status for one in transient_checks(check, checks)}
    if Status.EXCEEDED in found:
        return EXCEEDED
    return HOLDS if found == {Status.SATISFIED} else NONE


def _same(one: BarredRange, other: BarredRange) -> bool:
    near = all(abs(a - b) <= SAME * abs(b) for a, b in ((one.low, other.low), (one.high, other.high)))
    return near and one.names == other.names and one.passing == other.passing


def _alike(ranges: Iterable[BarredRange]) -> tuple[BarredRange, ...]:
    """Checks that bar the same speeds in one."""
    found: dict[tuple[float, float, str, str], list[str]] = {}
    for one in ranges:
        found.setdefault((one.low, one.high, one.state, one.passing), []).extend(one.names)
    return tuple(
        BarredRange(low, high, tuple(names), state, passing)
        for (low, high, state, passing), names in found.items()
    )  # fmt: skip


def barred(contents: SubmissionContents) -> Table:
    """Every range, the checks that it lies beyond, when, and whether it may be passed."""
    words, speed = Words(contents.seen.unit), contents.seen.speed
    rows = []
    for one in barred_ranges(contents):
        inside = speed is not None and one.low <= speed <= one.high
        rows.append(
            {
                f"range [{words.unit}]": words.barred([(one.low, one.high)]),
                "beyond the limit": listed(one.names),
                **({"when": one.state} if one.state else {}),
                "passing": one.passing + ("; the operating speed lies in it" if inside else ""),
            }
        )
    return Table.of(rows)


def barred_on_first_sheet(contents: SubmissionContents) -> tuple[tuple[str, str], ...]:
    """Ranges, and why in a few words; the last says how many more there are."""
    words, ranges = Words(contents.seen.unit), barred_ranges(contents)
    rows = []
    for one in ranges[: MOST if len(ranges) <= MOST else MOST - 1]:
        why = one.names[0] if len(one.names) == 1 else f"{len(one.names)} checks"
        silent = f", {SILENT}" if one.state == SILENT else ""
        rows.append(
            (words.barred([(one.low, one.high)]), f"{why}{silent}{'' if one.passing == HOLDS else ': exceeded'}")
        )
    if len(ranges) > len(rows):
        rows.append((f"{len(ranges) - len(rows)} more", "section 7"))
    return tuple(rows)
