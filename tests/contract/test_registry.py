"""The one table of analyses is true: every name leads somewhere, and what it is shown by shows it."""

from __future__ import annotations

import inspect
import re
from pathlib import Path

import pytest

import trunnion as tn
from trunnion.features import ROWS
from trunnion.registry import ANALYSES, found_at

ROOT = Path(__file__).parents[2]
BY_NAME = pytest.mark.parametrize("one", ANALYSES, ids=lambda one: one.name)


@BY_NAME
def test_an_analysis_is_a_public_function_with_a_sentence(one) -> None:
    assert inspect.isfunction(getattr(tn, one.name))
    assert re.fullmatch(r"[A-Z].*[.]", one.sentence) and len(one.sentence) < 120
    assert not one.features or one.features in ROWS


@BY_NAME
def test_a_command_goes_by_the_name_of_its_analysis_and_stands_on_the_first_page(one) -> None:
    if one.command:
        assert found_at(one.command).__name__ == one.name
        assert f"`{one.name.replace('_', '-')}" in (ROOT / "docs" / "README.md").read_text(encoding="utf-8")


def test_names_stand_once_and_rows_are_used() -> None:
    names = [one.name for one in ANALYSES]
    assert len(set(names)) == len(names)
    assert {one.features for one in ANALYSES} - {""} == set(ROWS)
