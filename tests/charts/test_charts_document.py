"""The examples of docs/charts.md run in order, and say what the page says they do."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from pages import run_page

from trunnion.results.verdict import Verdict


@pytest.mark.slow
def test_examples_run_in_order(tmp_path: Path, monkeypatch: Any) -> None:
    monkeypatch.chdir(tmp_path)
    text, names = run_page("charts")
    assert text.count("stability chart, ") == 2 and "checked at 24 random points" in text
    assert names["point"].verdict == Verdict.UNSTABLE
    assert names["close"].verdict.shape == (400, 400)
    assert names["again"].at(1.62, 0.5).spectral_radius == names["point"].spectral_radius
