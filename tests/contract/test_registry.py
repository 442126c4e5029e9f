"""The one table of analyses is true: every name leads somewhere, and what it is shown by shows it."""

from __future__ import annotations

import inspect
import re
from pathlib import Path

import pytest

import trunnion as tn
from trunnion.features import ROWS
from trunnion.registry import ANALYSES, VIEWS, found_at

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


@BY_NAME
def test_a_view_asks_what_it_is_said_to_show(one) -> None:
    if one.view:
        pytest.importorskip("panel")
        source = Path(inspect.getfile(found_at(VIEWS[one.view]))).read_text(encoding="utf-8")
        assert f'Call("tn.{one.name}"' in source


def test_names_stand_once_and_rows_are_used() -> None:
    names = [one.name for one in ANALYSES]
    assert len(set(names)) == len(names)
    assert {one.features for one in ANALYSES} - {""} == set(ROWS)


def test_views_go_by_their_names() -> None:
    pytest.importorskip("panel")
    assert [name for name, address in VIEWS.items() if found_at(address).name != name] == []
