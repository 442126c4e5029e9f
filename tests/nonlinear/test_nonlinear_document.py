"""The examples of docs/nonlinear.md run in order, and say what the page says they do."""

from __future__ import annotations

import contextlib
import io
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "nonlinear.md").read_text(encoding="utf-8")


@pytest.mark.slow
def test_examples_run_in_order() -> None:
    names: dict[str, Any] = {}
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        for block in re.findall(r"^```python\n(.*?)^```", PAGE, flags=re.DOTALL | re.MULTILINE):
            exec(block, names)
    text = printed.getvalue()
    assert "stable periodic motion" in text and "linear theory: growth rate" in text
    assert [p.kind for p in names["branch"].special] == ["period doubling", "period doubling"]
    assert names["orbit"].outcome.ok and names["strobe"].system.compiled
    assert len(names["series"].branch.folds) == 2 and "harmonic balance with" in text
    assert np.isfinite(names["safe"].slowest), str(names["safe"])
    assert names["passage"].peak_torque[0] < names["passage"].steady_peak[0]
