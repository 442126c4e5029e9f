"""Charts of random stiff lines between their pixels, against ``stability`` of each point by itself."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import pytest

import trunnion as tn
from trunnion.design.limits.stable_limit import LimitKind, limit_of_chart
from trunnion.equations.coefficients import assemble
from trunnion.floquet.charts import chart_families
from trunnion.floquet.charts.axes import axis
from trunnion.floquet.charts.chart_pixels import judge_matrices
from trunnion.results.chart import ChartPoint, StabilityChart
from trunnion.results.verdict import Verdict

DAMPINGS = (0.0, 1e-2, 0.05, 0.2)
"""Damping ratios of the shafts by themselves, one for each line in turn."""
EASY = (14, 19)
"""Lines whose charts need few nodes."""
SPEED, ANGLE = "speed", "factor of HookeJoint *.angle"
STEEPEST = 0.3
"""Of joint angles [rad]."""


@dataclass(frozen=True)
class Compared:
    line: int
    point: ChartPoint
    true: tn.Stability

    @property
    def off(self) -> float:
        return abs(self.point.spectral_radius - self.true.spectral_radius)


def stiff_line(seed: int, angle: float | None = None) -> tn.Driveline:
    """Four to six disks, two joints; stiffnesses spread over up to 1e6, a gear ratio in some."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(4, 7))
    spread = 10.0 ** rng.uniform(2, 6)
    stiffness = 1e3 * spread ** np.append(rng.permutation([0.0, 1.0]), rng.random(count - 2))
    inertia = 10.0 ** rng.uniform(-2, 0, count)
    zeta = DAMPINGS[seed % len(DAMPINGS)]
    bends = set(rng.choice(count - 1, 2, replace=False).tolist())
    elements: list[tn.Element] = [tn.ConstantSpeed()]
    for i, (k, j) in enumerate(zip(rng.permutation(stiffness), inertia, strict=True)):
        damping = 2 * zeta * np.sqrt(k * j)
        elements += [tn.Shaft(stiffness=k, damping=damping, fork_offset=rng.uniform(0, 1)), tn.Disk(inertia=j)]
        if i in bends:
            share = float(rng.uniform(0.5, 1))
            elements.append(tn.HookeJoint(angle=share * (0.2 if angle is None else angle)))
    return tn.Driveline(elements)


def charted(seed: int) -> StabilityChart:
    line = stiff_line(seed, 1.0)
    frequency = tn.natural_frequencies(line).undamped_frequency
    slow = max(frequency[1] / 2, frequency[-1] / 150)
    return tn.stability_chart(line, (SPEED, slow, 3 * slow, 20), (ANGLE, 0.0, STEEPEST, 12))


def compared(seeds: Iterable[int], points: int, patch: pytest.MonkeyPatch, seconds: float) -> list[Compared]:
    """Random points of a chart of each line, whose few nodes may cost so many seconds."""
    patch.setattr(chart_families, "without_groups", lambda *others: 1e6 * seconds)
    out = []
    for seed in seeds:
        chart, rng = charted(seed), np.random.default_rng(seed + 1000)
        for _ in range(points):
            speed, factor = rng.uniform(chart.x[0], chart.x[-1]), rng.uniform(0, STEEPEST)
            true = tn.stability(stiff_line(seed, factor), speed=speed)
            out.append(Compared(seed, chart.at(speed, factor), true))
    return out


def hold(found: list[Compared], interpolated: float) -> None:
    """No error above its estimate, no wrong verdict, few undecided; the share of points that came from patches."""
    short = [(f.line, f.point, f.off) for f in found if not f.off <= f.point.error_estimate + f.true.error_estimate]
    assert not short, f"{len(short)} of {len(found)}, the first: {short[:3]}"
    sure = (Verdict.STABLE, Verdict.UNSTABLE)
    wrong = [
        (f.line, f.point, f.true.spectral_radius)
        for f in found
        if f.point.verdict in sure and f.true.verdict in sure and f.point.verdict != f.true.verdict
    ]
    assert not wrong
    counts = Counter(f.point.verdict for f in found)
    assert counts[Verdict.FAILED] == 0
    assert counts[Verdict.UNDECIDED] <= 1e-3 * len(found)
    assert sum(f.point.interpolated for f in found) >= interpolated * len(found)


@pytest.mark.parametrize("seed", EASY)
def test_every_pixel_against_integration(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Few nodes tell what Taylor and Runge–Kutta steps of the whole period find at every pixel."""
    monkeypatch.setattr(chart_families, "without_groups", lambda *others: 1e7)
    chart = charted(seed)
    assert not chart.function.direct and chart.way == "patches"
    assembly = assemble(stiff_line(seed, 1.0))
    axes = [axis(assembly, (p, v[0], v[-1], 2), "x")[0] for p, v in ((SPEED, chart.x), (ANGLE, chart.y))]
    family = chart_families.LineFamily(assembly, axes[0], axes[1], float("nan"), True, half_windows=False)
    x, y = np.tile(chart.x, len(chart.y)), np.repeat(chart.y, len(chart.x))
    found = judge_matrices(*family.matrices(x, y, 1e-12, 2))
    off = np.abs(found.radius - chart.spectral_radius.ravel())
    assert np.all(off <= chart.error_estimate.ravel() + found.error)
    assert np.median(off) < 1e-8
    unstable = np.any(chart.verdict == Verdict.UNSTABLE, axis=0)
    assert np.array_equal(limit_of_chart(chart, own=True).kind == LimitKind.BEYOND, ~unstable)
    assert chart.count(Verdict.UNDECIDED) == 0


@pytest.mark.parametrize("seed", EASY)
def test_points_between_pixels(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    hold(compared([seed], 5, monkeypatch, 10.0), 1.0)


@pytest.mark.slow
def test_five_hundred_points(monkeypatch: pytest.MonkeyPatch) -> None:
    hold(compared(range(20), 25, monkeypatch, 20.0), 0.3)
