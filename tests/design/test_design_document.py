"""The examples of docs/design.md run in order, and say what the page says they do."""

from __future__ import annotations

from typing import Any

import pytest
from pages import ROOT, run_page


@pytest.mark.slow
def test_examples_run_in_order(monkeypatch: Any) -> None:
    monkeypatch.chdir(ROOT)
    text, names = run_page("design")
    assert "joint 2.angle" in text
    assert "joint 2, angle: 5 deg → 6 deg" in text
    assert names["phased"].aim[0] < 1e-9 and names["tuned"].aim[0] < 70
