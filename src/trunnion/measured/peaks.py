"""Where the orders that a line predicts are largest between two speeds: searched, whatever speeds were tracked."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.errors import ComputationError, InputError
from trunnion.floquet.ranges.resonances import resonances
from trunnion.floquet.ranges.span import Span
from trunnion.measured.lag import share_of_lag
from trunnion.measured.predicted import PredictedChannels
from trunnion.measured.run_response import RunResponse
from trunnion.response.orders.response import response_about, steady_states_of
from trunnion.response.orders.result import OrderResponse
from trunnion.response.ranges.largest import Largest, SearchedQuantity, first_speeds, search

TOLERANCE = 1e-4
"""Share of a peak that may still be missing."""
STEADY = 1e-4
"""Share within which speeds are one: far less than any resonance is wide that a bench shows."""
KNOWN = 0.01
"""Share that may be missing of a peak that counts as found."""
LAGS = 1e-3
"""Share of a peak by which a run has to be off the steady response for its own peaks to be read."""
FINER = 8
"""Speeds at which the response on a run is read for one at which it is known."""
CLUSTER = np.array([-6.0, -3.0, -1.5, -0.75, -0.3, 0.0, 0.3, 0.75, 1.5, 3.0, 6.0])
"""Speeds about each resonance, in half-widths of its peak: what draws it."""


@dataclass(frozen=True)
class PredictedPeaks:
    """Amplitudes (speed, order, channel) at the speeds (speed,) [rad/s] that were looked at, at the angle 0; and of
    each order and channel (order, channel) the largest size, its speed [rad/s] and what it may be low by.

    why : what kept the search from its end, "" where nothing did; the speeds are those that were tracked then.
    """

    speed: Array
    amplitude: Complex
    at: Array
    value: Array
    error: Array
    why: str = ""


def predicted_peaks(channels: PredictedChannels, bare: Complex, run: RunResponse | None) -> PredictedPeaks:
    """The peaks between the lowest and the highest speed that were tracked.

    bare : what the line predicts at the tracked speeds. run : its response on the run, None where that is not known.
    """
    tracked = channels.data.speed
    low, high = float(tracked.min()), float(tracked.max())
    if run is not None and share_of_lag(run, run.largest).max(initial=0.0) > LAGS:
        return _on_run(run, low, high)
    if high - low <= STEADY * high:  # one speed, at which there is nothing to search
        return replace(_read(tracked, bare, ""), error=np.zeros(bare.shape[1:]))
    try:
        found = _searched(channels, low, high)
    except (InputError, ComputationError) as error:
        return _read(tracked, bare, str(error))
    if found.ended or not np.all(found.error <= KNOWN * found.value):
        return _read(tracked, bare, found.ended or "some peak is infinite, a resonance without damping")
    values = channels.of(found.response.spectrum)
    shape = values.shape[1:]
    return PredictedPeaks(
        found.response.speed, values, found.response.speed[found.at].reshape(shape), found.value.reshape(shape),
        found.error.reshape(shape),
    )  # fmt: skip


def _searched(channels: PredictedChannels, low: float, high: float) -> Largest:
    assembly = channels.assembly
    span = Span(assembly, low, high)
    met = resonances(span)
    about = (met.speed[:, None] + np.maximum(met.width, 1e-9 * met.speed)[:, None] * CLUSTER).ravel()
    first = [
        np.union1d(part, about[(about > part[0]) & (about < part[-1])]) for part in first_speeds(span.pieces, met)
    ]  # fmt: skip
    respond = partial(response_about, assembly, motions=steady_states_of(assembly))
    shape = (len(channels.data.order), len(channels.columns))
    quantities = [_quantity(channels, k, c) for k in range(shape[0]) for c in range(shape[1])]
    return search(assembly, respond, first, quantities, tolerance=TOLERANCE)


def _on_run(run: RunResponse, low: float, high: float) -> PredictedPeaks:
    """Those of a run on which the line lags."""
    speed = np.linspace(low, high, FINER * (len(run.speed) - 1) + 1)
    values = run.steady_at(speed) + run.lag(speed)
    found = _read(speed, values, "")
    size = np.abs(values)
    # A parabola rises above the nearest of its points by no more than an eighth of their second difference.
    between = np.abs(np.diff(size, 2, axis=0)).max(axis=0, initial=0.0) / 8
    return replace(found, error=run.error * run.largest + between)


def _quantity(channels: PredictedChannels, order: int, channel: int) -> SearchedQuantity:
    def parts(found: OrderResponse) -> Complex:
        return channels.of(found.spectrum)[:, order, [channel]]

    return SearchedQuantity(lambda found: np.asarray(np.abs(parts(found)[:, 0])), parts)


def _read(speed: Array, bare: Complex, why: str) -> PredictedPeaks:
    """What the tracked speeds alone show."""
    rank = np.argsort(speed)
    size = np.nan_to_num(np.abs(bare))
    at = size.argmax(axis=0)
    value = np.take_along_axis(size, at[None], axis=0)[0]
    return PredictedPeaks(speed[rank], bare[rank], speed[at], value, np.full(value.shape, np.inf), why)
