"""How a line lags in a measured run, whose speed changes, and what is to be said of that."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.driveline.operating_speed import speed_unit
from trunnion.errors import ComputationError, InputError
from trunnion.measured.measured_run import measured_run
from trunnion.measured.predicted import PredictedChannels
from trunnion.measured.run_response import FIRST_GRID, RunResponse, run_response
from trunnion.results.finding import Finding, Gravity
from trunnion.results.units import figures
from trunnion.results.words import Words

WIDE = 0.01
"""Share by which the speed changes from which a recording counts as a run, in what is said of it."""
TELLS = 0.02
"""Share of an amplitude from which the lag is said, and from which what is not known of it is."""
EVEN = 0.005
"""Share of an amplitude that may be wrong because the acceleration changes."""


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
    if run.high - run.low > WIDE * run.high and (why := channels.uncounted):
        yield Finding(Gravity.NOTE, f"The torques that accelerate the line in this run are not counted: {why}.")
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
