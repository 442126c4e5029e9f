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


@pytest.mark.parametrize(("seed", "wide"), [(6101, 0.1), (6104, 0.05)])
def test_ranges_are_those_about_the_motion_that_the_line_makes(seed: int, wide: float) -> None:
    """They begin and end where growth by the test's own motion and multipliers is nought, which growth about the static
    twist is not."""
    line, rng = random_swung_line(seed, driven=True)
    modes = SwungTree(line).modes()
    i, j = rng.integers(len(modes), size=2)
    middle = float(modes[i] + modes[j]) / 2
    low, high = (1 - wide) * middle, (1 + wide) * middle
    whole = tn.assess(line, (low, high)).check("parametric stability")
    assert whole.status is Status.EXCEEDED
    rate, speed = said(whole)
    assert speed == pytest.approx(whole.speed, rel=1e-4)
    assert rate == pytest.approx(growth(line, speed), rel=2e-2, abs=1e-3)
    assert whole.value == pytest.approx(growth(line, whole.speed), rel=1e-4)
    outer = [end for pair in whole.covered for end in pair]  # of the range, and where the motion breaks off
    every = [(end, side) for pair in whole.barred for end, side in zip(pair, (1, -1), strict=True)]
    ends = [(end, side) for end, side in every if np.abs(np.array(outer) / end - 1).min() > 1e-4]
    assert ends
    for end, inwards in ends:
        assert growth(line, end * (1 + 2e-6 * inwards)) > 0 > growth(line, end * (1 - 2e-6 * inwards))
    static = [tn.stability(line, end).growth_rate for end, _ in ends]
    assert max(map(abs, static)) > 1e-3


def test_nothing_is_said_where_the_line_hardly_swings() -> None:
    """Of a line that is free its own motion is what is judged anyway."""
    line, _ = random_swung_line(6105, driven=True)
    assert "swing in" not in tn.assess(line, (145.0, 165.0)).check("parametric stability").because
    free, _ = random_swung_line(6105, driven=False)
    assert "swing in" not in tn.assess(free, (145.0, 165.0)).check("parametric stability").because
