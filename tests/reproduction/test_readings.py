"""A label follows from the readings of a statement: no row of a study keeps one that a reading contradicts."""

from __future__ import annotations

import itertools
import re

import pytest

from trunnion.papers.reproduce import PAPERS
from trunnion.papers.shared.result import LABELS, Conclusion, Reading

LEFT_OPEN = {
    "two-shaft-cardan": {
        "A stiffer second shaft": ("as drawn", "up to 12"),
        "More damping": ("above Ω = 1", "as printed for the base state"),
        "A higher speed": ("bands between", "bands half as wide"),
    },
    "bicardan-elastic": {
        "The elasticity of the shaft": ("N mm/rad", "N m/rad"),
        "It has a reduced": ("N mm/rad", "N m/rad"),
        "It makes": ("N mm/rad", "N m/rad"),
        "The deviation": ("in the example", "in other cases"),
        "The twist": ("varies little", "is justified"),
    },
    "three-shaft-cardan": {
        "As a whole": ("joints in phase", "forks in line"),
        "A larger inertia": ("below Ω = 1", "above"),
        "A higher speed": ("bands between", "bands half as wide"),
    },
    "double-tripod": {
        "The motion is chaotic": ("printed χ_n", "Appendix B"),
        "DIE1 beats": ("as (25) is printed", "turns with Θ/2"),
        "DOE3 beats": ("as (26) is printed", "turns with Θ/2"),
        "The range of": ("printed geometry", "times sin²β"),
        "The natural frequencies": ("printed geometry", "times sin²β"),
    },
    "gear-rattle": {
        "Multiple scales": ("±4 b", "±8 b"),
        "The formula shows what backlash": ("scaled with b", "held"),
        "The formula shows what damping": ("±5 b", "±10 b"),
    },
}
"""What each paper leaves open, by statement: two readings of which each must stand there with its number."""


def label(*says: int) -> str:
    return Conclusion("A.", tuple(Reading(f"reading {i}", "1 %", s) for i, s in enumerate(says))).holds


def test_one_reading_that_speaks_otherwise_decides_the_label() -> None:
    assert label(1) == label(1, 1, 1) == "confirmed"
    assert label(-1) == label(-1, -1) == "corrected"
    for count in (2, 3, 4):
        for says in itertools.product((-1, 0, 1), repeat=count):
            if len(set(says)) > 1 or 0 in says:
                assert label(*says) == "not decided", says


def test_both_sides_are_shown() -> None:
    shown = Conclusion("A.", (Reading("box", "2 → 1 %", -1), Reading("wide", "1 → 2 %", 1)), "Why.").evidence
    assert shown == "For it: wide: 1 → 2 %. Against it: box: 2 → 1 %. Why."


def test_no_label_can_be_typed() -> None:
    with pytest.raises(TypeError):
        Conclusion("A.", (Reading("box", "1 %", 1),), holds="confirmed")  # type: ignore[call-arg]
    with pytest.raises(AttributeError):
        Conclusion("A.", (Reading("box", "1 %", 1),)).holds = "corrected"  # type: ignore[misc]


@pytest.mark.parametrize(
    "readings", [(), (Reading("box", "1 %", 1), Reading("box", "2 %", 1))], ids=["none", "two of one name"]
)
def test_refused(readings: tuple[Reading, ...]) -> None:
    with pytest.raises(ValueError, match="readings of different names"):
        Conclusion("A.", readings)


def test_a_reading_has_a_number_and_says_one_of_three() -> None:
    with pytest.raises(ValueError, match="no number"):
        Reading("box", "it grows", 1)
    with pytest.raises(ValueError, match="none of"):
        Reading("box", "1 %", 2)


@pytest.mark.slow
@pytest.mark.parametrize("name", PAPERS)
def test_every_row_of_every_study(study, name: str) -> None:  # type: ignore[no-untyped-def]
    """Every reading stands in the row with its own figures, and the label is what they agree on."""
    found = study(name)
    for conclusion in found.conclusions:
        says = [r.says for r in conclusion.readings]
        expected = {(1,): "confirmed", (-1,): "corrected"}.get(tuple(set(says)), "not decided")
        assert conclusion.holds == (expected if conclusion.in_paper else "added"), conclusion.statement
        for reading in conclusion.readings:
            assert f"{reading.name}: {reading.figures}" in conclusion.evidence
        assert f"| **{conclusion.holds}** |" in found.markdown() and conclusion.holds in LABELS


@pytest.mark.slow
@pytest.mark.parametrize("name", PAPERS)
def test_what_the_paper_leaves_open_stands_there_twice(study, name: str) -> None:  # type: ignore[no-untyped-def]
    found = study(name)
    for start, alternatives in LEFT_OPEN[name].items():
        [conclusion] = [c for c in found.conclusions if c.statement.startswith(start)]
        for words in alternatives:
            figures = [r.figures for r in conclusion.readings if words in r.name]
            assert figures and all(re.search(r"\d", f) for f in figures), (start, words)


@pytest.mark.slow
@pytest.mark.parametrize("name", PAPERS)
def test_what_is_assumed_is_listed_with_its_effect(study, name: str) -> None:  # type: ignore[no-untyped-def]
    found = study(name)
    assert found.assumed is not None and len(found.assumed.rows) >= 3
    for row in found.assumed.rows:
        assert row.place and row.published and row.computed and row.remark, row
    assert any(re.search(r"\d", row.remark) for row in found.assumed.rows)
    assert all(f"| {row.place} | {row.published} |" in found.markdown() for row in found.assumed.rows)
