"""The examples of docs/tongues.md run in order, and say what the page says they do."""

from __future__ import annotations

import contextlib
import io
import re
from pathlib import Path
from typing import Any

PAGE = (Path(__file__).parents[2] / "docs" / "tongues.md").read_text(encoding="utf-8")


def test_examples_run_in_order(tmp_path: Path, monkeypatch: Any) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        for block in re.findall(r"^```python\n(.*?)^```", PAGE, flags=re.DOTALL | re.MULTILINE):
            exec(block, names)
    assert names["widest"].name == "subharmonic ω₂" and "searched completely" in printed.getvalue()
    assert (tmp_path / "tongues.csv").exists()
