"""How a line lags in a measured run, whose speed changes, and what is to be said of that."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import polynomial

from trunnion.arrays import Array, Complex
from trunnion.driveline.operating_speed import speed_unit
from trunnion.errors import ComputationError, InputError
from trunnion.measured.predicted import PredictedChannels
from trunnion.measured.run_response import FIRST_GRID, RunResponse, run_response
from trunnion.measured.tracking.result import MeasuredOrders
from trunnion.results.finding import Finding, Gravity
from trunnion.results.units import figures
from trunnion.results.words import Words

TELLS = 0.02
"""Share of an amplitude from which the lag is said, and from which what is not known of it is."""
EVEN = 0.005
"""Share of an amplitude that may be wrong because the acceleration changes."""
STEADY = 1e-4
"""Share within which speeds are one."""
PARTS = 4
"""Parts of a run whose accelerations are compared."""


@dataclass(frozen=True)
class MeasuredRun:
    """The range of speeds of a run [rad/s], its acceleration [rad/s²], and the least and largest of a part of it."""

    low: float
    high: float
    acceleration: float
    least: float
    largest: float

    @property
    def one_way(self) -> bool:
        """Whether the speed rises all the time, or falls all the time."""
        return self.least * self.largest > 0

    @property
    def change(self) -> float:
        """By which share of it the acceleration changes."""
        return max(abs(self.largest - self.acceleration), abs(self.least - self.acceleration)) / abs(self.acceleration)


def measured_run(data: MeasuredOrders) -> MeasuredRun | None:
    """The run of tracked windows; None where the speed stays."""
    ends = np.array([[-1.0, 1.0]])
    windows = data.rotation.windows
    at = np.array([polynomial.polyval(ends, polynomial.polyder(one.smooth))[0] / one.half for one in windows])
    low, high = float(at.min()), float(at.max())
    if high - low <= STEADY * high:
        return None
    rank = np.argsort(data.time)
    time, speed = data.time[rank], data.speed[rank]
    if len(time) < 2:
        return MeasuredRun(low, high, data.acceleration, data.acceleration, data.acceleration)
    slopes = [_slope(time, speed)]
    if len(time) >= 4 * PARTS:
        slopes += [_slope(*part) for part in zip(*(np.array_split(one, PARTS) for one in (time, speed)), strict=True)]
    if not slopes[0]:
        return None
    return MeasuredRun(low, high, slopes[0], min(slopes), max(slopes))


def _slope(time: Array, speed: Array) -> float:
    return float(np.polyfit(time - time.mean(), speed, 1)[0])


def channels_on_run(channels: PredictedChannels, row: Array, first: int = FIRST_GRID) -> RunResponse | None:
    """The response on the run at the channels, of a line by its packed numbers ``row`` (column,); None where the speed
    stays, or the lag is not known.

    first : number of speeds to begin with.
    """
    run = measured_run(channels.data)
    if run is None or not run.one_way:
        return None

    def respond(speed: Array) -> Complex:
        table = np.tile(row, (len(speed), 1))
        table[:, 0] = speed
        return channels.at(table)

    try:
        return run_response(respond, run.low, run.high, run.acceleration, channels.data.order, first)
    except (ComputationError, InputError):
        return None


def share_of_lag(found: RunResponse, largest: Array) -> Array:
    """The largest lag of each order and channel (order, channel) over the ``largest`` amplitude."""
    off = np.abs(found.passing - found.steady).max(axis=0)
    return np.asarray(np.divide(off, largest, out=np.zeros(off.shape), where=largest > 0))


def lag_findings(channels: PredictedChannels, found: RunResponse | None) -> Iterator[Finding]:
    """What to know of the lag of a run, by the response on it, None where that is not known."""
    data = channels.data
    run = measured_run(data)
    if run is None:
        return
    words = Words(data.unit or speed_unit(channels.assembly.line))
    least, largest_rate = words.acceleration(run.least), words.acceleration(run.largest)
    if not run.one_way:
        yield Finding(
            Gravity.CAUTION,
            f"The speed goes up and down (from {least} to {largest_rate}), and how "
            "the line lags is not counted: the steady response is compared; take a run-up or a run-down by itself.",
        )
        return
    if found is None:
        yield Finding(
            Gravity.CAUTION,
            "The lag of this run is not known, for a resonance of the line is too sharp, or without damping: the "
            "steady response is compared.",
        )
        return
    # Orders that are small beside the others of their channel do not tell.
    largest = np.maximum(found.largest, TELLS * found.largest.max(axis=0))
    share = share_of_lag(found, largest)
    if share.max(initial=0.0) >= TELLS:
        o, c = np.unravel_index(int(share.argmax()), share.shape)
        name = data.channels[channels.columns[c]]
        yield Finding(
            Gravity.NOTE,
            f"At this acceleration a line does not settle: order {data.order[o]:g} of {name} is off the steady "
            f"response by up to {figures(100 * float(share[o, c]), 2)} % of its largest amplitude, which is counted.",
        )
    if share.max(initial=0.0) * run.change >= EVEN:
        yield Finding(
            Gravity.CAUTION,
            f"The acceleration changes from {least} to {largest_rate}, and the lag is that of "
            f"{words.acceleration(run.acceleration)}; run up evenly, or more slowly.",
        )
    unknown = np.divide(
        found.unsure_at(data.speed).max(axis=0), largest, out=np.zeros(largest.shape), where=largest > 0
    )
    if unknown.max(initial=0.0) >= TELLS:
        yield Finding(
            Gravity.CAUTION,
            "The run begins near a resonance, and how the line moved before is not known: its first windows may be off "
            f"by up to {figures(100 * float(unknown.max()), 2)} % of the largest amplitude; begin further away.",
        )
