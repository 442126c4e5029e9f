"""Every feature of a line is either written to files of other programs, with equal modes, or refused by name."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from feature_lines import CHANGES, bent, unbent

import trunnion as tn
from trunnion.errors import InputError
from trunnion.exchange.held import HELD

BY_OTHERS = ("viscous load", "free start", "damping in contact only", "loss factor")
"""Held, and refused with what their lines have besides: no stated speed, a drive share, stages, a loss factor alone."""


@pytest.mark.filterwarnings("ignore::trunnion.InputRemark")
@pytest.mark.parametrize("to", ["csv", "modelica"])
def test_written_whole_or_refused(to: str, tmp_path: Path) -> None:
    path, written = tmp_path / {"csv": "line.csv", "modelica": "line.mo"}[to], set()
    for key, (_, change) in CHANGES.items():
        line = change(unbent(bent()))
        try:
            tn.export_line(line, path, to)
        except InputError as refused:
            assert key not in HELD or "is bent" in str(refused) or key in BY_OTHERS, (key, str(refused))
            continue
        written.add(key)
        found, known = (tn.natural_frequencies(one) for one in (tn.import_line(path), line))
        assert found.undamped_frequency == pytest.approx(known.undamped_frequency, rel=1e-12, abs=1e-9), key
        one, other = (np.sort_complex(each.eigenvalue.ravel()) for each in (found, known))
        assert np.abs(one - other).max() <= 1e-12 * np.abs(other).max(), key
    assert written <= set(HELD)
    assert {"ratio", "belt", "tyre", "vehicle", "planetary set", "closed loop", "gear mesh", "tuned damper"} <= written
    assert {"tube inertia", "branch", "load torque", "prescribed far end"} <= written
