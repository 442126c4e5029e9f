"""The examples of docs/tongues.md run in order, and say what the page says they do."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from pages import run_page


@pytest.mark.slow
def test_examples_run_in_order(tmp_path: Path, monkeypatch: Any) -> None:
    monkeypatch.chdir(tmp_path)
    text, names = run_page("tongues")
    assert names["widest"].name == "subharmonic ω₂" and "searched completely" in text
    assert (tmp_path / "tongues.csv").exists()
