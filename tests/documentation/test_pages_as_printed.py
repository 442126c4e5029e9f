"""What the pages print is what a reader gets who types it in."""

from __future__ import annotations

from pathlib import Path

import pytest
from as_printed import ROOT, blocks_of, run, same

LONG = ("first-hour-researcher.md", "how-do-i.md", "index.md", "assess.md", "report.md")
"""They take more than a few seconds."""
THEORY = tuple(f"theory/{path.name}" for path in sorted((ROOT / "docs/theory").glob("*.md")))
OLDER = ("animation.md", "components.md", "conventions.md", "fatigue.md")
PAGES = ("first-hour-engineer.md", "exchange.md", *THEORY, *OLDER, *LONG)


@pytest.mark.filterwarnings("ignore::trunnion.InputRemark")
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow) if name in LONG else name for name in PAGES]
)
def test_a_page_prints_what_stands_there(name: str, tmp_path: Path) -> None:
    assert run(ROOT / "docs" / name, tmp_path) == []


def test_what_differs_is_seen(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("```python\nprint(1)\n```\n\n```text\n2\n```\n\n```console\n$ trunnion --version\nno\n```\n")
    (tmp_path / "run").mkdir()
    assert len(run(page, tmp_path / "run")) == 2


def test_blocks_left_out_say_why() -> None:
    for path in (ROOT / "docs").glob("*.md"):
        for block in blocks_of(path.read_text(encoding="utf-8")):
            assert not block.skipped or len(block.skipped) > len("not run: ") + 10, path


def test_dots_stand_for_what_is_left_out() -> None:
    assert same("a ... c\n", "a b\n c\n") and not same("a ... d\n", "a b c\n")
