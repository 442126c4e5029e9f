"""Views of the registry: each goes by its name and asks what it is said to show."""

from __future__ import annotations

import inspect
from pathlib import Path

import pytest

from trunnion.registry import ANALYSES, VIEWS, found_at


@pytest.mark.parametrize("one", [one for one in ANALYSES if one.view], ids=lambda one: one.name)
def test_a_view_asks_what_it_is_said_to_show(one) -> None:
    source = Path(inspect.getfile(found_at(VIEWS[one.view]))).read_text(encoding="utf-8")
    assert f'Call("tn.{one.name}"' in source


def test_views_go_by_their_names() -> None:
    assert [name for name, address in VIEWS.items() if found_at(address).name != name] == []
