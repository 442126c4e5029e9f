"""What fits on the first sheet of the report that is handed in: one A4 page with verdict, checks, cautions, signatures.

Heights are those that submission.css has in print, by lines of text; tests print the sheets and measure them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import ceil

from trunnion.reporting import submission_tables as tables
from trunnion.reporting.barred_ranges import barred_on_first_sheet
from trunnion.reporting.submission_contents import SubmissionContents
from trunnion.reporting.tables import Table
from trunnion.results.finding import Finding

ROOM = 975.0
"""Pixels of an A4 page between its margins, less a reserve of two per cent."""
HEADER, SKETCH, SIGNATURES, REMAINDER = 100.0, 160.0, 125.0, 24.0
"""Title and document, the drawing, the block to sign, and "7 more: section 9" [px]."""
LEAST_DRAWING = 38
"""Height of the drawing [mm] that SKETCH holds."""
MILLIMETRES = 0.9 * 25.4 / 96
"""Of a pixel that is left over, with a reserve."""
MOST_FINDINGS = 3
FEWEST_CHECKS = 2


def first_sheet(
    contents: SubmissionContents, malfunction: Sequence[str], grave: Sequence[Finding]
) -> tuple[Table, list[Finding], int]:
    """The checks and the findings of the first sheet, of both as many as fit, the binding and the gravest first; and
    the height of the drawing [mm], which gets what they leave."""
    checks = tables.first_checks(contents)
    room = ROOM - _without_lists(contents, malfunction)
    found: list[Finding] = []
    rows = len(checks.rows)
    while rows > FEWEST_CHECKS and _checks(checks, rows) > room:
        rows -= 1
    for one in grave[:MOST_FINDINGS]:
        while rows > FEWEST_CHECKS and _checks(checks, rows) + _findings([*found, one]) > room:
            rows -= 1
        if _checks(checks, rows) + _findings([*found, one]) > room:
            break
        found.append(one)
    left = room - _checks(checks, rows) - _findings(found)
    return replace(checks, rows=checks.rows[:rows]), found, LEAST_DRAWING + int(max(left, 0.0) * MILLIMETRES)


def _without_lists(contents: SubmissionContents, malfunction: Sequence[str]) -> float:
    line = contents.seen.line
    height = HEADER + SKETCH + SIGNATURES + 2 * REMAINDER
    height += 17.0 * max(_lines(line.description or "", 70) - 2, 0) + 25.0 * (_lines(line.name or "", 34) - 1)
    height += _verdict(contents.seen.assessment.sentence)
    if malfunction:
        height += _verdict(f"With one cylinder out of work exceeded (section 6): {'; '.join(malfunction)}.")
    block = 31.0 + sum(17.0 * _lines(str(row[1]), 24) + 2.0 for row in tables.particulars(contents).rows)
    ranges = 31.0 + sum(
        17.0 * max(_lines(ends, 18), _lines(why, 26)) + 2.0 for ends, why in barred_on_first_sheet(contents)
    )
    return height + max(block, ranges)


def _verdict(text: str) -> float:
    return 21.0 + 21.0 * _lines(text, 64)


def _checks(table: Table, rows: int) -> float:
    return 50.0 + sum(3.0 + 17.3 * _lines(str(row[1]), 42) for row in table.rows[:rows])


def _findings(found: Sequence[Finding]) -> float:
    return sum(17.0 + 16.0 * _lines(one.sentence, 84) for one in found)


def _lines(text: str, width: int) -> int:
    return max(ceil(len(text) / width), 1)
