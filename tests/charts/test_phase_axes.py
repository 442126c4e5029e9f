"""Charts over phases, planes and offsets, which are symmetric at quarter turns and nowhere between."""

from __future__ import annotations

import numpy as np
import pytest
from phase_charts import QUARTER, PhaseChart, phase_chart

import trunnion as tn
from trunnion.analyses.charts import chart_families
from trunnion.results.verdict import Verdict


def compare(asked: PhaseChart, points: int) -> None:
    """Random pixels of a chart against ``stability``: no error above its estimate, no verdict wrong, few open."""
    chart = asked.compute()
    assert chart.verdict.size >= chart_families.FEWEST_PIXELS
    assert chart.way == "patches"
    rng = np.random.default_rng(points)
    rows, columns = rng.integers(0, len(chart.y), points), rng.integers(0, len(chart.x), points)
    open_ones = 0
    for i, j in zip(rows.tolist(), columns.tolist(), strict=True):
        true = asked.truth(float(chart.x[j]), float(chart.y[i]))
        off = abs(true.spectral_radius - chart.spectral_radius[i, j])
        assert off <= true.error_estimate + chart.error_estimate[i, j], (chart.x[j], chart.y[i])
        said = Verdict(int(chart.verdict[i, j]))
        assert {said, true.verdict} != {Verdict.STABLE, Verdict.UNSTABLE}, (chart.x[j], chart.y[i])
        assert said is not Verdict.FAILED
        open_ones += said is Verdict.UNDECIDED
    assert open_ones <= 0.01 * points


@pytest.mark.parametrize("seed", [0, 3])
def test_a_few_points(seed: int) -> None:
    compare(phase_chart(seed), 25)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_five_hundred_points(seed: int) -> None:
    compare(phase_chart(seed), 500)


@pytest.mark.parametrize("path", ["Shaft 2.fork_offset", "HookeJoint 2.plane", "Shaft 1.fork_offset"])
def test_stiff_line_whose_axis_is_symmetric_at_its_corners_only(path: str) -> None:
    """At (169.53, 1.1414) the first is unstable; by half a period at the corners' phase it looked stable."""
    angle = np.deg2rad(25)
    line = tn.Driveline(
        [
            tn.ConstantSpeed(), tn.Shaft(stiffness=1e4, damping=1), tn.Disk(inertia=1), tn.HookeJoint(angle=angle),
            tn.Shaft(stiffness=1e4, damping=1), tn.Disk(inertia=0.5), tn.HookeJoint(angle=angle),
            tn.Shaft(stiffness=2e7, damping=1), tn.Disk(inertia=0.3),
        ]
    )  # fmt: skip
    asked = PhaseChart(line, ("speed", 60.0, 220.0), (path, 0.0, QUARTER), None)
    chart = asked.compute(150, 140)
    for x, y in ((169.5302, 1.141370), (164.1611, 0.847552)):
        point, true = chart.at(x, y), asked.truth(x, y)
        assert abs(point.spectral_radius - true.spectral_radius) <= point.error_estimate + true.error_estimate
        assert point.verdict is true.verdict
    assert chart.count(Verdict.UNDECIDED) < 0.01 * chart.verdict.size
