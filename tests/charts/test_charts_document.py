"""The examples of docs/charts.md run in order, and say what the page says they do."""

from __future__ import annotations

import contextlib
import io
import re
from pathlib import Path
from typing import Any

from trunnion.results.verdict import Verdict

PAGE = (Path(__file__).parents[2] / "docs" / "charts.md").read_text(encoding="utf-8")


def test_examples_run_in_order(tmp_path: Path, monkeypatch: Any) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        for block in re.findall(r"^```python\n(.*?)^```", PAGE, flags=re.DOTALL | re.MULTILINE):
            exec(block, names)
    text = printed.getvalue()
    assert text.count("stability chart, ") == 2 and "checked at 24 random points" in text
    assert names["point"].verdict == Verdict.UNSTABLE
    assert names["close"].verdict.shape == (400, 400)
    assert names["again"].at(1.62, 0.5).spectral_radius == names["point"].spectral_radius
