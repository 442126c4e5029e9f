"""Newton's method, with and without steps that take the derivative from before."""

from __future__ import annotations

import numpy as np
import pytest

from trunnion.numerics.continuation.newton import solve

GOLDEN = (np.sqrt(5.0) - 1) / 2


class Counted:
    """x + ½ tanh-coupled neighbours − c: a root that is known, every evaluation counted."""

    def __init__(self, size: int, bend: float) -> None:
        self.size, self.bend = size, bend
        self.root = np.sin(GOLDEN * np.arange(1, size + 1))
        self.right = self._left(self.root)
        self.whole = self.cheap = 0

    def _left(self, x: np.ndarray) -> np.ndarray:
        return np.asarray(3 * x + self.bend * np.tanh(x + np.roll(x, 1)))

    def whole_residual(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        self.whole += 1
        slope = self.bend / np.cosh(x + np.roll(x, 1)) ** 2
        derivative = 3 * np.eye(self.size) + np.diag(slope) + np.roll(np.diag(slope), -1, axis=1)
        return self._left(x) - self.right, derivative

    def alone(self, x: np.ndarray) -> np.ndarray:
        self.cheap += 1
        return self._left(x) - self.right


@pytest.mark.parametrize("bend", [0.01, 0.3, 1.2])
def test_steps_with_the_derivative_from_before_lead_to_the_same_root(bend: float) -> None:
    size = 12
    plain, chords = Counted(size, bend), Counted(size, bend)
    found = solve(plain.whole_residual, np.zeros(size), np.ones(size), tolerance=1e-11)
    other = solve(chords.whole_residual, np.zeros(size), np.ones(size), tolerance=1e-11, alone=chords.alone)
    for one in (found, other):
        assert one.converged and one.x == pytest.approx(plain.root, abs=1e-13)
    assert chords.whole < plain.whole and chords.cheap > 0


@pytest.mark.parametrize("off", [np.nan, 1.0])
def test_where_the_residual_alone_brings_nothing_whole_steps_go_on(off: float) -> None:
    size = 12
    asked = Counted(size, 0.3)
    found = solve(
        asked.whole_residual, np.zeros(size), np.ones(size), tolerance=1e-11, alone=lambda x: np.full(size, off)
    )
    assert found.converged and found.x == pytest.approx(asked.root, abs=1e-11)
