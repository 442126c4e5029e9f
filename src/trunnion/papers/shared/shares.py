"""How much of a part of a chart is unstable, with its sampling error: the number behind "more" and "less"."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot

import numpy as np

from trunnion.arrays import Flags
from trunnion.papers.shared.result import Reading, agreed
from trunnion.results.chart import StabilityChart
from trunnion.results.verdict import Verdict

SPLIT = 4
"""Every SPLIT-th row and column make one of SPLIT² interleaved grids, whose scatter gives the standard error."""
BEYOND = 2.0
"""Standard errors by which two shares must differ for one to count as larger."""


@dataclass(frozen=True)
class Share:
    """Unstable share ``value`` [%] of evenly spaced pixels and its standard ``error`` [%].

    The error is that of the mean of 16 interleaved grids (every fourth row and column), each an evenly spaced sample
    of the same box, plus half of what is undecided.
    """

    value: float
    error: float

    def __str__(self) -> str:
        return f"{self.value:.2f} ± {self.error:.2f}"


def share(
    chart: StabilityChart, x: tuple[float, float] = (0.0, np.inf), y: tuple[float, float] = (0.0, np.inf)
) -> Share:
    """Unstable share of the pixels between two values of x and of y (the upper ends left out)."""
    columns = (chart.x >= x[0]) & (chart.x < x[1])
    rows = (chart.y >= y[0]) & (chart.y < y[1])
    inside = chart.verdict[np.ix_(rows, columns)]
    unstable = inside == Verdict.UNSTABLE
    parts = [unstable[i::SPLIT, j::SPLIT] for i in range(SPLIT) for j in range(SPLIT)]
    means = [part.mean() for part in parts if part.size]
    scatter = float(np.std(means, ddof=1) / np.sqrt(len(means))) if len(means) > 1 else 1.0
    open_ = float(np.mean((inside != Verdict.UNSTABLE) & (inside != Verdict.STABLE)))
    return Share(100 * float(unstable.mean()), 100 * (scatter + open_ / 2))


def sampled_share(flags: Flags, digits: int) -> str:
    """``12.3 ± 1.1 %``: share of independent samples and its standard error, which is left out where all are alike."""
    part = float(np.mean(flags))
    error = np.sqrt(part * (1 - part) / len(flags))
    return f"{100 * part:.{digits}f}" + (f" ± {100 * error:.{digits}f}" if error else "") + " %"


def bands(chart: StabilityChart, edges: tuple[float, ...], *, along: str, **rest: tuple[float, float]) -> list[Share]:
    """The share in each band between neighbouring ``edges`` along x or y."""
    return [share(chart, **{along: pair}, **rest) for pair in zip(edges[:-1], edges[1:], strict=True)]


def percents(values: Sequence[Share]) -> str:
    """``3.10 ± 0.02, 9.80 ± 0.04 %``."""
    return ", ".join(map(str, values)) + " %"


def change(before: Share, after: Share) -> int:
    """+1 if the share grows by more than the sampling can explain, −1 if it shrinks so, else 0."""
    step = after.value - before.value
    if abs(step) <= BEYOND * hypot(before.error, after.error):
        return 0
    return 1 if step > 0 else -1


def steps(values: Sequence[Share]) -> list[int]:
    """``change`` from each share to the next."""
    return [change(a, b) for a, b in zip(values[:-1], values[1:], strict=True)]


def in_bands(
    of: str, chart: StabilityChart, edges: tuple[float, ...], *, along: str, **rest: tuple[float, float]
) -> tuple[Reading, ...]:
    """Whether the share of a chart rises from band to band, in the given bands and in bands half as wide."""
    low, high = np.array(edges[:-1]), np.array(edges[1:])
    halves = tuple(np.sort(np.concatenate([edges, (low + high) / 2])).tolist())
    readings = []
    for width, ends in (("bands", edges), ("bands half as wide", halves)):
        values = bands(chart, ends, along=along, **rest)
        shown = " between " + ", ".join(f"{end:.3g}" for end in ends) if ends is edges else ""
        readings.append(Reading(f"{of}, {width}{shown}", percents(values), agreed(steps(values))))
    return tuple(readings)
