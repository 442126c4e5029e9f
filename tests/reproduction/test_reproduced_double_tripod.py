"""S4 computed anew: all its figures, its claims, the refutation."""

from __future__ import annotations

import pytest

pytestmark = pytest.mark.slow


def test_figures_9_to_30(study, tmp_path) -> None:  # type: ignore[no-untyped-def]
    found = study("double-tripod")
    assert [f.number for f in found.figures] == [str(n) for n in range(9, 31)]
    written = found.save(tmp_path / "out")
    assert len(written) == 1 + 22 + 2 and all(path.stat().st_size > 5000 for path in written)
    assert "historical curve" in written[0].read_text(encoding="utf-8")


def test_no_claim_of_chaos_holds(study) -> None:  # type: ignore[no-untyped-def]
    found = study("double-tripod")
    claims, others = found.tables[2].rows, found.tables[3].rows
    assert len(claims) == 10 and all(r.computed == "no chaos" for r in claims)
    assert len(others) == 9 and all("-" in r.computed and "+" not in r.computed for r in others)
    held = ["corrected", "confirmed", "corrected", "corrected", "confirmed", "not decided", "confirmed"]
    assert [c.holds for c in found.conclusions] == [*held, "not decided", "not decided", "not decided", "added"]
    assert found.argument is not None and "10.73" in str(found)
