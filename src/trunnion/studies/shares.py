"""How much of a part of a chart is unstable: the number behind "more" and "less" in a paper's conclusions."""

from __future__ import annotations

import numpy as np

from trunnion.results.chart import StabilityChart
from trunnion.results.verdict import Verdict


def share(
    chart: StabilityChart, x: tuple[float, float] = (0.0, np.inf), y: tuple[float, float] = (0.0, np.inf)
) -> float:
    """Unstable share [%] of the pixels between two values of x and of y (the upper ends left out)."""
    columns = (chart.x >= x[0]) & (chart.x < x[1])
    rows = (chart.y >= y[0]) & (chart.y < y[1])
    return 100 * float(np.mean(chart.verdict[np.ix_(rows, columns)] == Verdict.UNSTABLE))


def bands(chart: StabilityChart, edges: tuple[float, ...], *, along: str, **rest: tuple[float, float]) -> list[float]:
    """The share in each band between neighbouring ``edges`` along x or y."""
    return [share(chart, **{along: pair}, **rest) for pair in zip(edges[:-1], edges[1:], strict=True)]


def percents(values: list[float]) -> str:
    """``3.1, 9.8, 22 %``."""
    return ", ".join(f"{v:.3g}" for v in values) + " %"


def rising(values: list[float]) -> bool:
    """Whether every value exceeds the one before."""
    return all(b > a for a, b in zip(values[:-1], values[1:], strict=True))
