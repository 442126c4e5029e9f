"""The verdict on stability of driven lines whose own motion changes it, against motions and multipliers by equations
and an integration of the tests' own."""

from __future__ import annotations

import re

import numpy as np
import pytest
from oracles.random_swung_lines import random_swung_line
from oracles.swung_trees import SwungTree

import trunnion as tn
from trunnion.design.assessment.check import Check, Status

SAID = re.compile(r"swing in a disturbance (grows|decays) by (\S+) 1/s at (\S+) rad/s")


def said(check: Check) -> tuple[float, float]:
    """Growth [1/s] about the line's own motion and the speed [rad/s] that a check names."""
    found = SAID.search(check.because)
    assert found is not None, check.because
    sign = 1.0 if found[1] == "grows" else -1.0
    return sign * float(found[2]), float(found[3])


def growth(line: tn.Driveline, speed: float) -> float:
    return float(np.log(SwungTree(line).radius(speed)) * speed / np.pi)


@pytest.mark.parametrize("seed", [6101, 6104])
def test_a_range_beside_what_is_unstable_about_the_static_twist(seed: int) -> None:
    """Its upper end is stable about the static twist by a little, and unstable about the motion that the line makes."""
    line, rng = random_swung_line(seed, driven=True)
    modes = SwungTree(line).modes()
    i, j = rng.integers(len(modes), size=2)
    middle = float(modes[i] + modes[j]) / 2
    whole = tn.assess(line, (0.95 * middle, 1.05 * middle)).check("parametric stability")
    assert whole.status is Status.EXCEEDED
    rate, speed = said(whole)
    assert rate == pytest.approx(growth(line, speed), rel=2e-2, abs=1e-3)
    low = whole.barred[0][0] * (1 - 1e-5)
    assert growth(line, low) > 0 > tn.stability(line, low).growth_rate
    beside = tn.assess(line, (0.95 * middle, low)).check("parametric stability")
    assert beside.status is Status.EXCEEDED and beside.value > 0 and beside.speed == pytest.approx(low)
    assert beside.value == pytest.approx(growth(line, beside.speed), rel=1e-4)


def test_nothing_is_said_where_the_line_hardly_swings() -> None:
    """Of a line that is free its own motion is what is judged anyway."""
    line, _ = random_swung_line(6105, driven=True)
    assert "swing in" not in tn.assess(line, (145.0, 165.0)).check("parametric stability").because
    free, _ = random_swung_line(6105, driven=False)
    assert "swing in" not in tn.assess(free, (145.0, 165.0)).check("parametric stability").because
