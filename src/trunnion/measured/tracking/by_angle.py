"""Signals over the rotation instead of time: at equal angles, averaged turn by turn, and as a map of orders."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.interpolate import CubicSpline

from trunnion.arrays import Array
from trunnion.driveline.arguments import one_number, whole_number
from trunnion.errors import InputError
from trunnion.measured.signals.measurement import TURN, PulseTrain, SampledSignal
from trunnion.measured.signals.thinning import thinned
from trunnion.measured.tracking.rotation import MeasuredRotation
from trunnion.results.counts import counted
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, coordinate, internal, labelled, variable
from trunnion.results.result import Result
from trunnion.results.units import figures

PER_TURN = 256


def over_angle(
    channel: SampledSignal | PulseTrain, rotation: MeasuredRotation, per_turn: int, repeats: int = 1
) -> tuple[Array, Array]:
    """Whole turns of the input (turn,), the first a multiple of ``repeats``, and the channel at ``per_turn`` equal
    angles of each (turn, sample).

    Of a pulse train the deviation from uniform rotation [rad of its shaft].

    Raises
    ------
    InputError : not one whole turn.
    """
    first, last = rotation.span
    if isinstance(channel, PulseTrain):
        inside = (channel.times >= first) & (channel.times <= last)
        times, counted_angle = channel.times[inside], channel.angle[inside]
        angle = rotation.angle_at(times)
        ratio = float(np.polyfit(angle, counted_angle, 1)[0]) if len(times) > 2 else 1.0
        values = counted_angle - ratio * angle
    else:
        highest = per_turn * float(rotation.speed_at(np.linspace(first, last, 200)).max()) / TURN
        kept = thinned(channel, highest)
        inside = (kept.times >= first) & (kept.times <= last)
        times, values = kept.times[inside], kept.values[inside]
        angle = rotation.angle_at(times)
    if len(angle) < 4 or angle[-1] - angle[0] < TURN:
        raise InputError(
            "holds no whole turn while the rotation is known", element=channel.name, key="times",
            remedy="record both together",
        )  # fmt: skip
    begin = repeats * int(np.ceil(angle[0] / TURN / repeats))
    turns = np.arange(begin, int(np.floor(angle[-1] / TURN)))
    at = (turns[:, None] + np.arange(per_turn) / per_turn) * TURN
    return turns.astype(float), np.asarray(CubicSpline(angle, values)(at.ravel()).reshape(at.shape))


@labelled
class SynchronousAverage(Result):
    """The mean of a channel over many turns, what does not repeat with them averaged away."""

    angle: Array = coordinate("angle", "rad", "of the input within the turns")
    average: Array = variable("angle", "", "in units of the channel")
    deviation: Array = variable("angle", "", "standard deviation of the mean")
    name: str = attribute("of the channel")
    turns: int = attribute("that repeat")
    averaged: int = attribute("how many times")
    unit: str = internal("that speeds are printed in")

    def _lines(self) -> Iterator[str]:
        swing = figures(float(np.ptp(self.average)) / 2)
        over = counted(self.averaged, "repetition")
        yield f"synchronous average of {self.name} over {over} of {counted(self.turns, 'turn')}: ± {swing}"


def synchronous_average(
    channel: SampledSignal | PulseTrain, rotation: MeasuredRotation, *, turns: int = 1, per_turn: int = PER_TURN
) -> SynchronousAverage:
    """Mean of a channel over the rotation of the input, turn on turn.

    Pitch errors of a wheel repeat with its turns: they stay in the average, and look like orders of the shaft.

    Parameters
    ----------
    channel : a sampled signal, or a pulse train, of which the deviation from uniform rotation is averaged.
    rotation : of the input, of ``track_orders``.
    turns : that repeat: 2 of a four-stroke engine.
    per_turn : angles of a turn.

    Raises
    ------
    InputError : fewer than two repetitions.

    Examples
    --------
    >>> import numpy as np, trunnion as tn
    >>> wheel = tn.PulseTrain(2 * np.pi * np.arange(60 * 40) / 60 / 100.0, 60, name="wheel")
    >>> rotation = tn.track_orders(tn.Measurement([wheel]), [1]).rotation
    >>> gauge = tn.SampledSignal(5 * np.cos(200.0 * np.arange(5000) / 2000), 2000.0, name="gauge")
    >>> round(float(np.ptp(tn.synchronous_average(gauge, rotation).average)), 2)
    10.0
    """
    whole_number(turns, "turns", 1)
    rows = over_angle(channel, rotation, whole_number(per_turn, "per_turn", 4), turns)[1]
    count = len(rows) // turns
    if count < 2:
        raise InputError(
            "does not repeat within the recording", element=channel.name, key="turns", value=turns,
            remedy="record longer",
        )  # fmt: skip
    parts = rows[: count * turns].reshape(count, -1)
    angle = TURN * np.arange(parts.shape[1]) / per_turn
    spread = parts.std(axis=0, ddof=1) / np.sqrt(count)
    return SynchronousAverage(angle, parts.mean(axis=0), spread, channel.name, turns, count, "rpm")


@labelled
class MeasuredOrderMap(Result):
    """Amplitude of a channel over order and speed: windows of whole turns, weighted by a Hann window."""

    time: Array = variable("window", "s", "of the middle")
    speed: Array = coordinate("window", "rad/s", "of the input", name="speed")
    order: Array = coordinate("order", "1", "cycles per turn of the input")
    amplitude: Array = variable("window order", "", "in units of the channel")
    name: str = attribute("of the channel")
    window: int = attribute("turns")
    kind: str = attribute("of the channel")
    unit: str = internal("that speeds are printed in")

    def plot(self, axes: Axes | None = None) -> Axes:
        """Colours over order and speed; see ``pictures.measured.order_map``."""
        return drawing(self, "plot")(self, axes)

    def _lines(self) -> Iterator[str]:
        span = self.words.span(float(self.speed.min()), float(self.speed.max()))
        yield f"order map of {self.name}: {len(self.speed)} windows of {counted(self.window, 'turn')}, {span}"
        size = self.amplitude.max(axis=0)
        for k in np.argsort(-size[1:])[:3] + 1:
            at = int(self.amplitude[:, k].argmax())
            where = self.words.rounded(float(self.speed[at]))
            yield f"  order {self.order[k]:g}: {figures(float(size[k]))} at {where}"


def measured_order_map(
    channel: SampledSignal | PulseTrain,
    rotation: MeasuredRotation,
    *,
    highest: float = 12.0,
    window: int = 8,
    unit: str = "rpm",
) -> MeasuredOrderMap:
    """How strong each order of a channel is as the speed changes, orders resolved to 1/``window``.

    Parameters
    ----------
    channel : a sampled signal, or a pulse train, of which the deviation from uniform rotation is taken.
    rotation : of the input, of ``track_orders``.
    highest : order, in cycles per turn of the input.
    window : turns of one window; windows overlap by half.
    unit : of speeds in print.

    Raises
    ------
    InputError : fewer turns than two windows; orders beyond what the wheel's pulses show.

    Examples
    --------
    >>> import numpy as np, trunnion as tn
    >>> wheel = tn.PulseTrain(2 * np.pi * np.arange(60 * 40) / 60 / 100.0, 60, name="wheel")
    >>> rotation = tn.track_orders(tn.Measurement([wheel]), [1]).rotation
    >>> gauge = tn.SampledSignal(5 * np.cos(200.0 * np.arange(5000) / 2000), 2000.0, name="gauge")
    >>> found = tn.measured_order_map(gauge, rotation, highest=4.0)
    >>> float(found.order[found.amplitude[0].argmax()])
    2.0
    """
    turns = whole_number(window, "window", 1)
    top = one_number(highest, "highest")
    if isinstance(channel, PulseTrain) and top >= channel.pulses_per_turn / 2:
        raise InputError(
            f"is not seen by {channel.pulses_per_turn} pulses a turn", element=channel.name, key="highest", value=top,
            remedy=f"ask for orders below {channel.pulses_per_turn / 2:g}",
        )  # fmt: skip
    per_turn = 1 << int(np.ceil(np.log2(max(32.0, 4 * top))))
    if isinstance(channel, PulseTrain):
        per_turn = max(per_turn, 2 * channel.pulses_per_turn)
    _, rows = over_angle(channel, rotation, per_turn)
    if len(rows) < 2 * turns:
        raise InputError(
            f"needs a run of two windows at least, this one has {len(rows)} turns", element=channel.name, key="window",
            value=turns, remedy="take a longer run or a shorter window",
        )  # fmt: skip
    length = turns * per_turn
    shape = np.hanning(length + 1)[:-1]
    kept = int(np.floor(top * turns + 1e-9)) + 1
    values = rows.ravel()
    starts = np.arange(0, len(values) - length + 1, max(1, turns // 2) * per_turn)
    amplitude = np.empty((len(starts), kept))
    for row, at in zip(amplitude, starts, strict=True):
        part = values[at : at + length]
        row[:] = 2 * np.abs(np.fft.rfft((part - part.mean()) * shape))[:kept] / shape.sum()
        row[0] = abs(float(part.mean()))
    begin = over_angle(channel, rotation, 4)[0][0] * TURN
    middle = rotation.time_at(begin + (starts + length / 2) * TURN / per_turn)
    kind = channel.kind if isinstance(channel, SampledSignal) else "rotation"
    return MeasuredOrderMap(
        middle, rotation.speed_at(middle), np.arange(kept) / turns, amplitude, channel.name, turns, kind, unit
    )
