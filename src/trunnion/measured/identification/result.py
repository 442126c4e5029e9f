"""What ``identify`` gives: values with intervals, how well they fit, what else would fit, and the line with them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Complex, Flags, Places
from trunnion.design.limits.result import StableLimit
from trunnion.driveline.changes import Change, changes
from trunnion.driveline.driveline import Driveline
from trunnion.measured.identification.knowable import Knowable, shown_value
from trunnion.measured.tracking.result import MeasuredOrders
from trunnion.results.counts import counted
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, coordinate, internal, labelled, variable
from trunnion.results.finding import Finding
from trunnion.results.result import Result
from trunnion.results.units import figures


@dataclass(frozen=True)
class TongueDistance:
    """How far the line is from the nearest region of instability, along one parameter that is raised.

    limit, low, high : the factor of all joint angles at which instability begins, and its interval of 95 % by the
    parameters' own; infinite where none is reached. limits : the search at the best values.
    """

    parameter: str
    limit: float
    low: float
    high: float
    limits: StableLimit

    @property
    def sentence(self) -> str:
        """The answer in a line."""
        top = figures(float(self.limits.high), 3)
        if not np.isfinite(self.limit):
            return f"No instability up to {top} times all joint angles, at the speeds searched."
        span = f"{figures(self.low, 3)} to {figures(self.high, 3)}"
        return f"Instability begins at {figures(self.limit, 3)} times all joint angles (95 %: {span})."


@labelled
class Identification(Result):
    """Numbers of a line that fit measured orders best, each with its interval of 95 %."""

    parameters: tuple[str, ...] = coordinate("parameter")
    units: tuple[str, ...] = variable("parameter", "", "SI unit", name="parameter_unit")
    before: Array = variable("parameter", "", "as the line stated it, SI units")
    value: Array = variable("parameter", "", "that fits best, SI units")
    low: Array = variable("parameter", "", "end of the interval of 95 %")
    high: Array = variable("parameter", "", "end of the interval of 95 %")
    low_open: Flags = variable("parameter", "1", "1 where the interval reaches the bound")
    high_open: Flags = variable("parameter", "1", "1 where the interval reaches the bound")
    deviation: Array = variable("parameter", "", "standard deviation by Fisher's information there, SI units")
    gaussian: Flags = variable("parameter", "1", "1 where the interval is as wide as a Gaussian's, to either side")
    drawn_low: Array = variable("parameter", "", "end of what holds 95 % of the draws; NaN without draws, SI units")
    drawn_high: Array = variable("parameter", "", "end of what holds 95 % of the draws; NaN without draws, SI units")
    correlation: Array = variable("parameter other", "1", "between the parameters")
    chi_square: float = attribute("sum of squares of residuals over their standard deviations")
    freedom: int = attribute("numbers compared beyond those fitted")
    scale: float = attribute("by which variances were raised: chi_square over freedom where that is above 1")
    probability: float = attribute("that noise alone fits as badly")
    held_out: float | None = attribute("the same ratio of a run that was not fitted")
    begin: float = attribute("rotation of the input at the first pulse", "rad")
    residual: Array = variable("channel order", "1", "rms of residuals over their standard deviations")
    channels: tuple[str, ...] = coordinate("channel")
    order: Array = coordinate("order", "1")
    independent: float = attribute("independent draws that those of the likelihood are worth; 0 without")
    draws: Array = internal("values drawn from the likelihood, SI units", axes="draw parameter")
    twins: tuple[Mapping[str, float], ...] = internal("other values that fit as well, SI units")
    line: Driveline = internal("with the values found")
    original: Driveline = internal("as it was")
    knowable: Knowable = internal("what could be known, before anything was fitted")
    distance: TongueDistance | None = internal("from the nearest region of instability")
    measured: MeasuredOrders = internal("that was fitted")
    predicted: Complex = internal("of the line found, at the windows fitted", axes="window order channel")
    windows: Places = internal("places of the windows fitted", axes="window")
    findings: tuple[Finding, ...] = internal("what to read first")
    unit: str = internal("of speeds in print")

    @property
    def changes(self) -> tuple[Change, ...]:
        """What the line found states otherwise than the one that was given."""
        return changes(self.original, self.line)

    @property
    def unknown(self) -> Flags:
        """Parameters (parameter,) whose interval is open at both ends."""
        return np.asarray(self.low_open & self.high_open)

    def table(self) -> list[dict[str, object]]:
        """One row a parameter."""
        rows: list[dict[str, object]] = []
        for k, name in enumerate(self.parameters):
            # As many digits as tell the ends of the interval apart.
            across, size = float(self.high[k] - self.low[k]), float(np.abs([self.low[k], self.high[k]]).max())
            digits = int(np.clip(np.ceil(np.log10(max(size, 1e-300) / max(across, 1e-300))) + 2, 3, 9))
            low, high = (shown_value(one[k], self.units[k], digits) for one in (self.low, self.high))
            low = f"{low} (bound)" if self.low_open[k] else low
            high = f"{high} (bound)" if self.high_open[k] else high
            rows.append(
                {
                    "parameter": name,
                    "was": shown_value(self.before[k], self.units[k]),
                    "fits": "not known" if self.unknown[k] else shown_value(self.value[k], self.units[k], digits),
                    "95 % from": low,
                    "to": high,
                }
            )
        return rows

    def plot(self, axes: Axes | None = None, *, channel: str = "") -> Axes:
        """Measured and fitted orders over speed; see ``pictures.measured.identification``."""
        return drawing(self, "plot")(self, axes, channel=channel)

    @property
    def headline(self) -> str:
        """What was fitted, and how well."""
        return (
            f"{counted(len(self.parameters), 'parameter')} from {self.freedom + len(self.parameters)} numbers: χ² is "
            f"{figures(self.chi_square / max(self.freedom, 1), 3)} of what noise explains"
        )

    def _lines(self) -> Iterator[str]:
        yield self.headline
        for row in self.table():
            yield f"  {row['parameter']}: {row['fits']} (95 %: {row['95 % from']} to {row['to']}), was {row['was']}"
        if self.independent:
            worth = figures(self.independent, 2)
            for k, name in enumerate(self.parameters):
                low, high = (shown_value(one[k], self.units[k], 4) for one in (self.drawn_low, self.drawn_high))
                yield f"  {name}: {low} to {high} hold 95 % of draws from its likelihood ({worth} independent ones)"
        for twin in self.twins:
            units = dict(zip(self.parameters, self.units, strict=True))
            words = ", ".join(f"{name} {shown_value(value, units[name])}" for name, value in twin.items())
            yield f"  fits as well: {words}"
        if self.held_out is not None:
            yield f"  a run that was not fitted: χ² is {figures(self.held_out, 3)} of what noise explains"
        if self.distance is not None:
            yield f"  {self.distance.sentence}"
