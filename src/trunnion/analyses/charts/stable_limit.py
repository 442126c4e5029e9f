"""The largest value of a parameter up to which a line is stable, over speed.

At each speed the parameter is scanned upwards over an even grid and the first step from "not unstable" to
"unstable" is bisected on the chart's own function, whose error is known. Instability in an interval narrower
than a step of the scan is missed; where the line is stable again above the limit, ``intervals`` counts it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from trunnion.analyses.charts.stability_chart import stability_chart
from trunnion.analyses.features import left_out
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.driveline.parameters import Parameter
from trunnion.equations.coefficients import Assembly
from trunnion.errors import InputError
from trunnion.results.chart import StabilityChart, require_pixels
from trunnion.results.declared import Held, Result, axis, over, remark
from trunnion.results.drawing import drawing
from trunnion.results.finding import Finding
from trunnion.results.speeds import show_speed, speed_factor
from trunnion.results.verdict import Verdict

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]

SCAN = 240
BISECTIONS = 14
"""Halvings of one step of the scan: 1/240 of the range down to 3e-7 of it."""
HIGHEST = float(np.deg2rad(60.0))


class LimitKind(IntEnum):
    """What a limit is; codes of the int8 array."""

    CROSSING = 0
    BEYOND = 1
    AT_ONCE = 2
    UNKNOWN = 3


MEANING = {
    LimitKind.CROSSING: "unstable just above the limit",
    LimitKind.BEYOND: "no instability found up to the end of the scan",
    LimitKind.AT_ONCE: "unstable from the start of the scan",
    LimitKind.UNKNOWN: "could not be computed",
}


@dataclass(frozen=True, repr=False)
class StableLimit(Result):
    """Largest stable value of ``parameter`` at each speed.

    speed (speed,) [rad/s]; limit (speed,) in SI units: the value below which no instability was found; kind
    (speed,): codes of ``LimitKind``; intervals (speed,): how many separate unstable intervals the scan met;
    low, high, step: the scan; ``findings`` say what of the line is left out; speed_unit: that speeds are printed in.
    """

    parameter: str
    unit: str
    speed: Array
    limit: Array
    kind: NDArray[np.int8]
    intervals: NDArray[np.int64]
    low: float
    high: float
    step: float
    accuracy: float
    findings: tuple[Finding, ...] = ()
    speed_unit: str = "rad/s"

    @property
    def smallest(self) -> float:
        """The largest value that is stable at all these speeds; ``high`` where nothing was unstable."""
        return float(np.nanmin(self.limit))

    @property
    def critical_speed(self) -> float | None:
        """The speed [rad/s] that limits it; None where nothing was unstable."""
        if not np.any((self.kind == LimitKind.CROSSING) | (self.kind == LimitKind.AT_ONCE)):
            return None
        return float(self.speed[int(np.nanargmin(self.limit))])

    def declared(self) -> Iterator[Held]:
        """The limit, its kind and the stable intervals above it over speed."""
        meanings = " ".join(k.name.lower() for k in LimitKind)
        codes = np.array([int(k) for k in LimitKind], dtype=np.int8)
        yield axis("speed", self.speed, "rad/s")
        yield over("speed", "limit", self.limit, self.unit, f"largest stable {self.parameter}")
        yield over("speed", "kind", self.kind, flag_values=codes, flag_meanings=meanings)
        yield over("speed", "intervals", self.intervals, "1")
        yield remark("scan_low", self.low)
        yield remark("scan_high", self.high)
        yield remark("scan_step", self.step)
        yield remark("accuracy", self.accuracy)

    def plot(self, axes: Axes | None = None, **options: Any) -> Axes:
        """The limit over speed; see ``plots.stable_limit.draw``."""
        return drawing(self, "plot")(self, axes, **options)

    def describe(self, unit: str | None = None) -> str:
        """The result in a few lines, speeds in ``unit``, by default that of the line's description."""
        unit, at = unit or self.speed_unit, self.critical_speed
        where = f"set at {show_speed(at, unit)}" if at else "the end of the scan"
        low, high = float(self.speed.min()) * speed_factor(unit), show_speed(float(self.speed.max()), unit)
        several = int(np.count_nonzero(self.intervals > 1))
        lines = [
            f"largest stable {self.parameter} at {len(self.speed)} speeds from {low:.6g} to {high}: "
            f"{self.smallest:.6g} {self.unit}, {where}",
            f"  first crossing of a scan in steps of {self.step:.3g} {self.unit}, bisected to {self.accuracy:.1e}",
        ]
        if several:
            lines.append(f"  at {several} speeds the line is stable again above the limit, and unstable once more")
        return "\n".join([*lines, *(f"  {finding}" for finding in self.findings)])

    def __str__(self) -> str:
        return self.describe()


def stable_limit(
    line: Driveline | Assembly,
    parameter: str | Parameter,
    speeds: ArrayLike,
    *,
    low: float = 0.0,
    high: float = HIGHEST,
    scan: int = SCAN,
    tolerance: float = 1e-9,
    progress: Callable[[float], None] | None = None,
) -> StableLimit:
    """The largest stable value of ``parameter`` at each of ``speeds`` [rad/s], by scan and bisection.

    Parameters
    ----------
    parameter : as for a chart: "HookeJoint 1.angle", "HookeJoint *.angle", "factor of Shaft *.stiffness".
    low, high : range that is scanned, SI units; by default 0 to 60° for angles.
    scan : steps of the scan.
    tolerance : of the chart behind it.

    Undecided points (the spectral radius is 1 to within its error) and marginal ones (undamped lines) do not
    count as unstable.

    Raises
    ------
    InputError : as ``stability_chart``; fewer than two speeds.
    """
    speed = np.asarray(speeds, dtype=float)
    if speed.ndim != 1 or len(speed) < 2 or not np.all(np.isfinite(speed)) or not np.all(speed > 0):
        raise InputError(
            "must be two or more positive numbers", key="speeds", remedy="tn.rpm(np.linspace(300, 3000, 200))"
        )
    if isinstance(scan, int) and scan > 0:
        require_pixels(len(speed), scan + 1)
    across = ("speed", float(speed.min()), float(speed.max()), 2)
    chart = stability_chart(line, across, (parameter, low, high, scan + 1), tolerance=tolerance, progress=progress)
    return limit_of_chart(chart, speed)


def limit_of_chart(chart: StabilityChart, speeds: ArrayLike = (), *, own: bool = False) -> StableLimit:
    """The limit of a chart's y parameter, scanned at the chart's own y.

    Parameters
    ----------
    chart : with the speed along x, freshly computed or read by ``load_chart``.
    speeds : inside the chart's x axis [rad/s]; those outside are moved to its nearest end.
    own : add the chart's own speeds, whose pixels are known already.
    """
    if chart.x_label != "speed" or chart.resample is None or len(chart.y) < 2:
        raise InputError("needs a chart with the speed along x that can still be evaluated", element="chart")
    asked = np.unique(np.clip(np.asarray(speeds, dtype=float), chart.x.min(), chart.x.max()))
    values = chart.y
    parts = [chart.on(asked, values).verdict] if len(asked) else []
    speed = np.concatenate([asked, chart.x]) if own else asked
    verdict = np.concatenate([*parts, chart.verdict] if own else parts, axis=1)
    order = np.argsort(speed)
    speed, verdict = speed[order], verdict[:, order]
    low, high = float(values[0]), float(values[-1])
    unstable = verdict == Verdict.UNSTABLE
    first = np.argmax(unstable, axis=0)
    some = unstable.any(axis=0)
    kind = np.where(~some, LimitKind.BEYOND, np.where(first == 0, LimitKind.AT_ONCE, LimitKind.CROSSING))
    kind = np.where(np.all(verdict == Verdict.FAILED, axis=0), LimitKind.UNKNOWN, kind).astype(np.int8)
    limit = np.where(some, values[first], high).astype(float)
    for i in np.flatnonzero(kind == LimitKind.CROSSING):
        limit[i] = _bisect(chart, float(speed[i]), float(values[first[i] - 1]), float(values[first[i]]))
    limit[kind == LimitKind.UNKNOWN] = np.nan
    starts = unstable & ~np.vstack([np.zeros((1, len(speed)), dtype=bool), unstable[:-1]])
    step = float(np.diff(values).max())
    said = left_out("stable_limit", chart.line) if chart.line is not None else ()
    accuracy = step / 2**BISECTIONS
    several = starts.sum(axis=0)
    shown = speed_unit(chart.line) if chart.line is not None else "rad/s"
    return StableLimit(chart.y_label, chart.y_unit, speed, limit, kind, several, low, high, step, accuracy, said, shown)


def _bisect(chart: StabilityChart, speed: float, stable: float, unstable: float) -> float:
    for _ in range(BISECTIONS):
        middle = (stable + unstable) / 2
        if chart.at(speed, middle).verdict is Verdict.UNSTABLE:
            unstable = middle
        else:
            stable = middle
    return stable
