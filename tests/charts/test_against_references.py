"""Charts of random chains against stored 80-bit references, between their pixels."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import Any

import pytest
from oracles.chains import Chain

import trunnion as tn
from trunnion.results.chart import ChartPoint
from trunnion.results.verdict import Verdict

pytestmark = pytest.mark.slow
FILE = Path(__file__).parents[1] / "data" / "chart_points.json"
PIXELS = 44
"""Per axis: just enough that a whole box is tried as one patch; where that fails its parts are integrated."""


@pytest.fixture(scope="module")
def compared() -> list[tuple[int, ChartPoint, float]]:
    """Index of the chain, the chart's answer and the reference, for every stored point."""
    entries: list[dict[str, Any]] = json.loads(FILE.read_text(encoding="utf-8"))["entries"]
    out = []
    for k, entry in enumerate(entries):
        chain = Chain(**entry["chain"])
        (x, *across), (y, *up) = entry["axes"]
        swept = "speed" in (x, y)
        chart = tn.stability_chart(
            chain.line(), x=(x, *across, PIXELS), y=(y, *up, PIXELS), speed=None if swept else chain.speed
        )
        assert chart.period == pytest.approx(chain.period)
        for point, radius in zip(entry["points"], entry["spectral_radius"], strict=True):
            out.append((k, chart.at(*point), radius))
    return out


def test_two_thousand_points(compared: list[tuple[int, ChartPoint, float]]) -> None:
    assert len(compared) == 2000
    interpolated = sum(point.interpolated for _, point, _ in compared)
    assert 200 < interpolated, "patches answer a good part of the points"


def test_every_error_is_below_its_estimate(compared: list[tuple[int, ChartPoint, float]]) -> None:
    short = [
        (k, point.x, point.y, abs(point.spectral_radius - radius), point.error_estimate)
        for k, point, radius in compared
        if not abs(point.spectral_radius - radius) <= point.error_estimate
    ]
    assert not short, f"{len(short)} of {len(compared)}, the first: {short[:5]}"


def test_no_verdict_is_wrong_and_few_are_open(compared: list[tuple[int, ChartPoint, float]]) -> None:
    wrong = [
        (k, point.x, point.y, radius, str(point))
        for k, point, radius in compared
        if point.verdict in (Verdict.STABLE, Verdict.UNSTABLE) and (point.verdict == Verdict.UNSTABLE) != (radius > 1)
    ]
    assert not wrong
    counts = Counter(point.verdict for _, point, _ in compared)
    assert counts[Verdict.FAILED] == counts[Verdict.MARGINAL] == 0
    assert counts[Verdict.UNDECIDED] < 0.005 * len(compared)
    assert counts[Verdict.STABLE] > 200 and counts[Verdict.UNSTABLE] > 50
