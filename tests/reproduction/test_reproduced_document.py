"""docs/reproduced.md says what the studies say, in the same words."""

from __future__ import annotations

from pathlib import Path

import pytest

from trunnion.studies.reproduce import PAPERS

PAGE = (Path(__file__).parents[2] / "docs" / "reproduced.md").read_text(encoding="utf-8")


@pytest.mark.slow
@pytest.mark.parametrize("name", PAPERS)
def test_conclusions_stand_in_the_document(study, name: str) -> None:  # type: ignore[no-untyped-def]
    """Written there by ``python docs/figures/reproduced.py``."""
    assert study(name).markdown() in PAGE


def test_no_table_typed_by_hand() -> None:
    rest = PAGE
    for name in PAPERS:
        assert PAGE.count(f"<!-- {name} -->") == PAGE.count(f"<!-- end of {name} -->") == 1
        rest = rest.split(f"<!-- {name} -->")[0] + rest.split(f"<!-- end of {name} -->")[1]
    assert "| statement |" not in rest
