"""S5 computed anew."""

from __future__ import annotations

import pytest


@pytest.mark.slow
def test_conclusions(study) -> None:  # type: ignore[no-untyped-def]
    found = study("gear-rattle")
    held = ["not decided", "confirmed", "corrected", "corrected", "not decided", "not decided", "added"]
    assert [c.holds for c in found.conclusions] == held
    ranges = next(t for t in found.tables if t.title == "The range of the cubic fit").rows
    assert [r.place for r in ranges] == [f"fit to ±{n} b" for n in range(2, 11)]
    # An independent review: +6.5, +2.9, +0.4 % of height and −0.03, +0.3, +1.2 % of place.
    for row, height in zip(ranges[4:7], ("+6.5", "+2.9", "+0.4"), strict=True):
        assert f"height {height} %" in row.remark
