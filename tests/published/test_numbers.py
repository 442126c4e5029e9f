"""Every printed number beside the computed one, and the verdict that the site prints."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from published.cases import BATCHES, SOURCES
from published.cases.chaos import spectrum
from published.printed_numbers import Batch, Verdict, last_place

STORED = Path(__file__).parents[2] / "docs/data/printed_numbers.json"
HOLDS = {Verdict.AGREES, Verdict.ROUNDING, Verdict.PRECISION}
IN_ERROR = {
    "S1": {
        "ω₁", "ω₂", "subharmonic ω1", "subharmonic ω2", "subharmonic ω2/3", "harmonic ω2/2", "harmonic ω2/4",
        "sum (ω2+ω1)/2", "sum (ω2+ω1)/4", "difference (ω2−ω1)/2", "difference (ω2−ω1)/4",
    },
    "S4": {"Ω₃"},
}  # fmt: skip


def named(batch: Batch) -> str:
    return f"{batch.source}: {batch.where}"


@pytest.mark.parametrize(
    "batch", [pytest.param(b, id=named(b), marks=pytest.mark.slow if b.slow else ()) for b in BATCHES]
)
def test_printed_beside_computed(batch: Batch) -> None:
    for row in batch.rows():
        if row.verdict in HOLDS:
            continue
        assert row.verdict in (Verdict.SOURCE, Verdict.DISPUTED, Verdict.UNDECIDED), row
        assert row.because and abs(row.difference) > 0.501 * last_place(row.printed), row
        if row.verdict is Verdict.SOURCE:
            assert row.what in IN_ERROR[batch.source], row


def test_there_are_many_of_many_sources() -> None:
    assert sum(len(batch.printed) for batch in BATCHES) >= 160
    assert {batch.source for batch in BATCHES} == set(SOURCES) and len(SOURCES) >= 20
    assert all(len(source.read) > 10 for source in SOURCES.values())
    assert len({named(batch) + batch.unit for batch in BATCHES}) == len(BATCHES)


def test_a_wrong_number_is_seen() -> None:
    wrong = Batch("IEEE 1977", "", "Hz", {"a": "15.73", "b": "15.72", "c": "15.71"}, lambda: [15.712] * 3)
    assert [row.verdict for row in wrong.rows()] == [Verdict.DIFFERS, Verdict.ROUNDING, Verdict.AGREES]
    nothing = Batch("IEEE 1977", "", "Hz", {"a": "0", "b": "0.0"}, lambda: [0.1, 0.0], absolute=0.01)
    assert [row.verdict for row in nothing.rows()] == [Verdict.DIFFERS, Verdict.AGREES]
    assert [last_place(text) for text in ("3", "3.14", "-3.2e2", "0.5e-3")] == pytest.approx([1, 0.01, 10, 1e-4])


def test_what_takes_long_is_stored_for_the_site() -> None:
    stored = json.loads(STORED.read_text(encoding="utf-8"))
    for batch in BATCHES:
        if batch.slow:
            rows = stored[named(batch)]["rows"]
            assert {row["what"]: row["printed"] for row in rows} == dict(batch.printed)
            computed = iter([row["computed"] for row in rows])
            again = Batch(**{**vars(batch), "compute": lambda computed=computed: [*computed]})
            assert [row.verdict.value for row in again.rows()] == [row["verdict"] for row in rows]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["jerk", "rossler", "regular rossler", "lorenz", "ueda"])
def test_exponents_add_up_to_the_divergence(name: str) -> None:
    """Of every motion they do, whatever anybody printed."""
    found = spectrum(name)
    assert abs(found.sum - found.divergence) < 1e-6 * abs(found.divergence)


@pytest.mark.slow
def test_of_two_spectra_in_print_one_is_excluded() -> None:
    """Ueda's oscillator: 0.1034 and 0.0999 have spectra of the same sum; a long run tells them apart."""
    found = spectrum("ueda")
    assert found.sum == pytest.approx(-0.05, abs=1e-9)
    assert abs(found.exponents[0] - 0.1034) < 2 * found.half_width[0]
    assert found.exponents[0] - 0.0999 > 1.5 * found.half_width[0]
