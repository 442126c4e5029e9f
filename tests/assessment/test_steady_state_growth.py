"""The verdict on stability of driven lines whose own motion changes it, against motions and multipliers by equations
and an integration of the tests' own."""

from __future__ import annotations

import re

import numpy as np
import pytest
from oracles.random_swung_lines import random_swung_line
from oracles.swung_trees import SwungTree

import trunnion as tn
from trunnion.design.assessment import driven_motions
from trunnion.design.assessment.check import Check, Status
from trunnion.design.assessment.driven_motions import ranges_about_motions
from trunnion.equations.coefficients import assemble
from trunnion.floquet.ranges.span import Span
from trunnion.floquet.ranges.unstable import UnstableRanges, unstable_ranges
from trunnion.floquet.stability.stability_over_speed import stability_along

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


@pytest.mark.parametrize("seed", [6101, 6104])
def test_of_long_lines_speeds_are_looked_at_where_the_verdict_is_closest(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The upper end of the second range is stable about the static twist by a little, and unstable about the motion
    that the line makes."""
    monkeypatch.setattr(driven_motions, "LONG", 2)
    line, rng = random_swung_line(seed, driven=True)
    modes = SwungTree(line).modes()
    i, j = rng.integers(len(modes), size=2)
    middle = float(modes[i] + modes[j]) / 2
    whole = tn.assess(line, (0.95 * middle, 1.05 * middle)).check("parametric stability")
    assert whole.status is Status.EXCEEDED and "judged about its static twist" in whole.because
    low = whole.barred[0][0] * (1 - 1e-5)
    assert growth(line, low) > 0 > tn.stability(line, low).growth_rate
    beside = tn.assess(line, (0.95 * middle, low)).check("parametric stability")
    assert beside.status is Status.EXCEEDED and beside.value > 0 and beside.speed == pytest.approx(low)
    assert beside.value == pytest.approx(growth(line, beside.speed), rel=1e-4)
    assert "looked at where the verdict is closest" in beside.because and beside.barred[-1] == (low, low)


def test_a_fold_across_the_end_of_the_range_is_not_judged() -> None:
    """Several motions have these speeds, which stability refuses; the range begins among them."""
    line, _ = random_swung_line(6101, driven=True)
    check = tn.assess(line, (86.78, 117.4)).check("parametric stability")
    assert "86.78 rad/s to 86.809 rad/s not judged: the line's periodic steady state folds back" in check.because
    assert check.covered[0][0] == pytest.approx(86.809, abs=1e-3)
    for speed in (86.785, 86.8):
        with pytest.raises(tn.ComputationError, match="several periodic motions"):
            tn.stability(line, speed, about_steady_state=True)
    tn.stability(line, 86.82, about_steady_state=True)


def swinging(*more: tn.PiecewiseShaft) -> tn.Driveline:
    """A driven line whose joint swings by some degrees."""
    shafts = [tn.Shaft(stiffness=2e3, damping=2.0), tn.Disk(inertia=0.4), tn.HookeJoint(name="joint", angle=0.4)]
    last = more or (tn.Shaft(stiffness=3e3, damping=2.0),)
    return tn.Driveline([tn.ConstantSpeed(), *shafts, *last, tn.Disk(inertia=0.3, load_torque=40.0)])


STAGED = tn.PiecewiseShaft.symmetric([(3e3, 0.5), (9e3, None)], damping=2.0)


@pytest.mark.parametrize(
    ("line", "why"),
    [
        pytest.param(
            swinging(STAGED), "it has stages or play, with which each speed takes its own motion", id="stages"
        ),
        pytest.param(swinging(), "", id="followed"),
    ],
)
def test_why_a_motion_is_not_followed_is_said(line: tn.Driveline, why: str) -> None:
    because = tn.assess(line, (30.0, 60.0)).check("parametric stability").because
    said = re.search(r"judged about its static twist, though its joints swing by up to (\S+)° by linear", because)
    assert bool(said) is bool(why)
    assert why in because
    assert said is None or 1 < float(said[1]) < 60


def test_a_line_whose_numbers_follow_the_speed_is_judged_about_its_static_twist() -> None:
    """As along a schedule of an envelope."""
    assembly = assemble(swinging())
    span = Span(assembly, 30.0, 60.0, put=lambda table: None)

    def static() -> UnstableRanges:
        return unstable_ranges(span, lambda speed: stability_along(assembly, speed))

    found = ranges_about_motions(span, 0.1, 9, np.zeros(0), static)
    assert found.not_followed == "its numbers follow the speed" and not found.about_steady_state


def test_nothing_is_said_where_the_line_hardly_swings() -> None:
    """Of a line that is free its own motion is what is judged anyway."""
    line, _ = random_swung_line(6105, driven=True)
    assert "swing in" not in tn.assess(line, (145.0, 165.0)).check("parametric stability").because
    free, _ = random_swung_line(6105, driven=False)
    assert "swing in" not in tn.assess(free, (145.0, 165.0)).check("parametric stability").because
