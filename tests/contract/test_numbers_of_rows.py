"""What compiled equations read of many rows at once is what they read of each alone, of lines with every feature."""

from __future__ import annotations

import feature_lines
import numpy as np
import pytest

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.equations.line_system import LineSystem
from trunnion.equations.numbers_of_rows import numbers_of_rows


@pytest.mark.parametrize("key", feature_lines.CHANGES)
def test_rows_together_as_alone(key: str) -> None:
    compared = 0
    for base in (feature_lines.bent(), feature_lines.free(feature_lines.bent()), feature_lines.straight()):
        for change in feature_lines.CHANGES[key]:
            try:
                line = LineSystem(assemble(change(base)), 100.0)
                table = line.assembly.table(3, np.array([80.0, 100.0, 130.0]))
                table[:, 1:] *= 1 + 1e-3 * np.random.default_rng(1).uniform(-1, 1, table[:, 1:].shape)
                co = line.untwisted(table)
            except (tn.InputError, KeyError):  # this base has no place for it, or a speed of its own
                continue
            alone = np.stack([line.numbers(row, known=co, case=i) for i, row in enumerate(table)])
            np.testing.assert_allclose(numbers_of_rows(line, table, co), alone, rtol=1e-14, atol=0)
            compared += 1
    assert compared >= 2
