"""docs/reproduced.md says what the studies say, in the same words."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from trunnion.papers.reproduce import PAPERS
from trunnion.papers.shared.result import Reproductions

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


@pytest.mark.slow
def test_all_papers_on_one_page(study, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    """An index that leads to every study, in the order of their numbers, and every picture shown once."""
    found = Reproductions(tuple(study(name) for name in PAPERS))
    page, *pictures = found.save(tmp_path / "all")
    text = page.read_text(encoding="utf-8")
    heads = [text.index(f"({number})</h1>") for number in ("S1", "S2", "S3", "S4", "S5")]
    assert heads == sorted(heads)
    for one in found.studies:
        assert f'href="#{one.name}"' in text
        assert f'id="{one.name}"' in text
    for picture in pictures:
        assert picture.is_file()
    assert text.count("<img ") == len(pictures)
    assert not re.findall(r'(?:src|href)="(?!data:|#)', text)  # nothing is fetched
