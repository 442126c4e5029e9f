"""Charts over phases, planes and offsets, which are symmetric at quarter turns and nowhere between."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from oracles.sampling import quick_every
from phase_charts import QUARTER, PhaseChart, phase_chart

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.floquet.charts import chart_families
from trunnion.floquet.charts.axes import axis
from trunnion.floquet.charts.chart_families import LineFamily
from trunnion.floquet.charts.chart_pixels import Pixels, judge_matrices
from trunnion.results.verdict import Verdict

Places = NDArray[np.int64]
OPPOSITE = np.full(len(Verdict), -1)
"""What contradicts a verdict, by its code."""
OPPOSITE[Verdict.STABLE], OPPOSITE[Verdict.UNSTABLE] = Verdict.UNSTABLE, Verdict.STABLE


def direct(asked: PhaseChart, chart: tn.StabilityChart, rows: Places, columns: Places) -> Pixels:
    """Those pixels by direct integration over whole periods, at a thousandth of the chart's tolerance."""
    assembly = assemble(asked.line)
    (across, _), (up, _) = (axis(assembly, (*ends, 2), key) for ends, key in ((asked.x, "x"), (asked.y, "y")))
    speed = float("nan") if asked.speed is None else asked.speed
    family = LineFamily(assembly, across, up, speed, True, half_windows=False)
    return judge_matrices(*family.matrices(chart.x[columns], chart.y[rows], 1e-12, 2))


def compare(asked: PhaseChart, points: int, by_hand: int) -> None:
    """Random pixels of a chart: no error above its estimate, no verdict wrong, few open.

    All ``points`` against direct integration, the first ``by_hand`` of them against ``stability`` of a line with both
    numbers put in.
    """
    chart = asked.compute()
    assert chart.verdict.size >= chart_families.FEWEST_PIXELS
    assert chart.way == "patches"
    rng = np.random.default_rng(points)
    rows, columns = rng.integers(0, len(chart.y), points), rng.integers(0, len(chart.x), points)
    radius, error, verdict = (
        part[rows, columns] for part in (chart.spectral_radius, chart.error_estimate, chart.verdict)
    )
    true = direct(asked, chart, rows, columns)
    assert np.max(np.abs(true.radius - radius) / np.maximum(true.error + error, 1e-300)) <= 1
    assert not np.any(OPPOSITE[true.verdict] == verdict)
    assert not np.any(verdict == Verdict.FAILED)
    assert np.count_nonzero(verdict == Verdict.UNDECIDED) <= 0.01 * points
    for i in range(by_hand):
        x, y = float(chart.x[columns[i]]), float(chart.y[rows[i]])
        said = asked.truth(x, y)
        for own, off, verdicts in ((radius, error, verdict), (true.radius, true.error, true.verdict)):
            assert abs(said.spectral_radius - own[i]) <= said.error_estimate + off[i], (x, y)
            assert {said.verdict, Verdict(int(verdicts[i]))} != {Verdict.STABLE, Verdict.UNSTABLE}, (x, y)


@pytest.mark.parametrize("seed", [0, 3])
def test_a_few_points(seed: int) -> None:
    compare(phase_chart(seed), 25, 8)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_five_hundred_points(seed: int) -> None:
    compare(phase_chart(seed), 500, 10)


@pytest.mark.parametrize("path", quick_every(3, ["Shaft 2.fork_offset", "HookeJoint 2.plane", "Shaft 1.fork_offset"]))
@pytest.mark.slow
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
