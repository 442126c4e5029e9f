"""The examples of docs/nonlinear.md run in order, and say what the page says they do."""

from __future__ import annotations

import numpy as np
import pytest
from pages import run_page


@pytest.mark.slow
def test_examples_run_in_order() -> None:
    text, names = run_page("nonlinear")
    assert "stable periodic motion" in text and "linear theory: growth rate" in text
    assert [p.kind for p in names["branch"].special] == ["period doubling", "period doubling"]
    assert names["orbit"].outcome.ok and names["strobe"].system.compiled
    assert len(names["series"].branch.folds) == 2 and "harmonic balance with" in text
    assert np.isfinite(names["safe"].slowest), str(names["safe"])
    assert names["slow"].outcome.kind == "captured" and "captured at 41.1 rad/s" in text
    assert names["passage"].peak_torque[0] < names["passage"].steady_peak[0]
