"""Measured orders over speed with their intervals, and maps of orders."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from trunnion.equations.coefficients import assemble
from trunnion.errors import InputError
from trunnion.measured.identification.result import Identification
from trunnion.measured.overlay import MeasuredComparison
from trunnion.measured.peaks import PredictedPeaks
from trunnion.measured.tracking.by_angle import MeasuredOrderMap
from trunnion.measured.tracking.result import MeasuredOrders, unit_of
from trunnion.motion.passing.run_up import RunUp, run_up
from trunnion.pictures.campbell_diagram import campbell_diagram as picture_of_campbell
from trunnion.pictures.looks import curve
from trunnion.pictures.motion import run_up as picture_of_run_up
from trunnion.pictures.picture import (
    Axis,
    Band,
    ColouredGrid,
    Colours,
    Item,
    Key,
    Line,
    Picture,
    Points,
    points_at,
    single,
)
from trunnion.pictures.shared import over_speed, place_of
from trunnion.response.campbell_diagram import CampbellDiagram, campbell_diagram
from trunnion.results.speeds import frequency_unit as reading_of_frequencies
from trunnion.results.speeds import speed_factor
from trunnion.results.units import figures, order_words

MOST_ORDERS = 6
"""Curves drawn, the largest of them."""
DECADES = 3.0
"""Orders whose peak is farther below the largest are not drawn."""
MAP_DECADES = 3.0
CAMPBELL_SPEEDS = 201
STILL = 0.02
"""Share by which the speed of a run-up changes at least."""
MARK, LEAST_MARK = 13.0, 0.01
"""Size [pt] of the mark of the largest amplitude on a Campbell diagram, and the share of it from which one is drawn."""
WORDS = {
    "rotation": "rotation",
    "torque": "torque",
    "acceleration": "acceleration",
    "speed": "speed",
    "other": "signal",
}


def orders(found: MeasuredOrders, *, channel: str = "") -> Picture:
    """The largest orders of one channel (the first, or ``channel``) over speed, each with its interval of 95 %.

    Raises
    ------
    InputError : no such channel.
    """
    column = place_of(channel, found.channels, 0, "channel", "not a channel", f"there are {', '.join(found.channels)}")
    symbol, size = unit_of(found.kinds[column], float(np.nanmax(np.abs(found.amplitude[:, :, column]), initial=0.0)))
    x, y = found.speed * speed_factor(found.unit), np.abs(found.amplitude[:, :, column]) / size
    half, rank = found.half_width[:, :, column] / size, np.argsort(x)
    peaks = np.nan_to_num(y).max(axis=0, initial=0.0)
    largest = float(peaks.max(initial=0.0))
    drawn = sorted(k for k in np.argsort(-peaks)[:MOST_ORDERS].tolist() if peaks[k] > largest / 10**DECADES)
    least = max(min((float(np.nanmin(y[:, k])) for k in drawn), default=0.0), 2 * largest / 10 ** (DECADES + 0.5))
    items: list[Item] = []
    for i, k in enumerate(drawn):
        low, high = np.maximum(y[rank, k] - half[rank, k], least / 4), y[rank, k] + half[rank, k]
        items.append(Band(x[rank], low, high, f"interval {i}", "interval of 95 %" if not i else ""))
        items.append(Line(x[rank], y[rank, k], curve(i), order_words(float(found.order[k]))))
    up = Axis(f"{WORDS[found.kinds[column]]} amplitude", symbol)
    up = up.logarithmic(least / 2, 2 * largest) if largest > 0 else up
    return over_speed(x[rank], found.unit, up, items, title=f"{found.channels[column]}, measured")


def comparison(found: MeasuredComparison, *, channel: str = "") -> Picture:
    """Measured marks with their intervals over predicted curves, of one channel (the first that moves).

    Raises
    ------
    InputError : no such channel.
    """
    return _over(found, channel)


def line_campbell(found: MeasuredComparison) -> CampbellDiagram:
    """Modes and excitations of the line over the speeds that were tracked.

    Raises
    ------
    InputError : as of ``campbell_diagram``.
    """
    low, high = float(found.speed.min()), float(found.speed.max())
    low, high = (0.95 * low, 1.05 * high) if high - low < 0.05 * high else (low, high)
    return campbell_diagram(found.assembly, np.linspace(low, high, CAMPBELL_SPEEDS))


def line_run_up(found: MeasuredComparison) -> RunUp:
    """The line's own motion through the speeds that were tracked, in the direction and at the rate of the input.

    Raises
    ------
    InputError : the input kept its speed; as of ``run_up``.
    """
    first, last = (float(f"{one:.4g}") for one in found.speed[[0, -1]])
    if abs(last - first) < STILL * max(first, last):
        raise InputError(
            "is of a steady speed, which no run-up compares with", key="data",
            remedy="record a run-up, or look at plot()",
        )  # fmt: skip
    return run_up(found.assembly, first, last, acceleration=abs(found.acceleration), steady=0)


def on_campbell(found: MeasuredComparison, *, channel: str = "") -> Picture:
    """The Campbell diagram of the line, with the measured orders of one channel (the first that moves) where they are:
    the area of a mark grows with the amplitude, up to the largest; a ring stands at the peak of each order.

    Raises
    ------
    InputError : no such channel.
    """
    column = _moving(found, channel)
    diagram = line_campbell(found)
    frequency = reading_of_frequencies(found.unit)
    base = picture_of_campbell(diagram, unit=found.unit, frequency_unit=frequency)
    x, y = speed_factor(found.unit), speed_factor(frequency)
    sizes = np.abs(found.measured[:, :, column])
    known = np.isfinite(sizes) & (sizes > found.half_width[:, :, column])
    top = float(np.max(sizes[known], initial=0.0))
    if not top:
        return base
    symbol, unit_size = unit_of(found.kinds[column], top)
    window, order = np.nonzero(known & (sizes > LEAST_MARK * top))
    at = np.column_stack([found.speed[window] * x, found.speed[window] * found.order[order] * y])
    share = sizes[window, order] / top
    items: list[Item] = []
    for k in np.unique(order).tolist():
        if found.measured_peak(k, column)[0] not in window[order == k]:
            continue
        row, speed, _ = found.measured_peak(k, column)
        name = f"peak of {order_words(float(found.order[k]))}: {figures(float(sizes[row, k]) / unit_size, 3)} {symbol}"
        items.append(Points([speed * x], [speed * found.order[k] * y], "measured peak", "", says=[name.rstrip()]))
    if items:
        items.append(Key("measured peak", "peak of an order", "mark"))
    words = f"measured at {found.channels[column]}, up to {figures(top / unit_size, 3)} {symbol}".rstrip()
    marks = points_at(at, "measured", words, MARK * np.sqrt(share))
    up = base.panel.y
    reach = max(float(up.high or 0.0), 1.05 * float(at[:, 1].max()))
    return base.with_panel(items=(*base.panel.items, marks, *items), y=replace(up, high=reach))


def on_run_up(found: MeasuredComparison, *, channel: str = "") -> Picture:
    """The largest torque that one channel (the first that measures one) shows in each window, on the line's own run-up.

    Raises
    ------
    InputError : no channel that measures a torque; the input kept its speed; as of ``run_up``.
    """
    column = found.torque_channel(channel)
    base = picture_of_run_up(line_run_up(found), shaft=found.places[column], unit=found.unit)
    x = found.speed * speed_factor(found.unit)
    marks = Points(x, found.extreme[:, column], "measured", f"largest measured at {found.channels[column]}")
    return base.with_panel(items=(*base.panel.items, marks))


def identification(found: Identification, *, channel: str = "") -> Picture:
    """The same over the line that was found.

    Raises
    ------
    InputError : no such channel.
    """
    data = found.measured
    columns = [data.column(name) for name in found.channels]
    rows = found.windows
    measured, half = data.amplitude[rows][:, :, columns], data.half_width[rows][:, :, columns]
    speed = data.speed[rows]
    rank = np.argsort(speed)
    none = np.full(found.predicted.shape[1:], np.nan)
    shown = MeasuredComparison(
        speed=speed, order=data.order, channels=found.channels, kinds=tuple(data.kinds[c] for c in columns),
        measured=measured, predicted=found.predicted, half_width=half, peak=none, peak_speed=none, peak_error=none,
        begin=found.begin, off=found.residual.T, outside=found.residual.T, findings=(), unit=found.unit,
        curve=PredictedPeaks(speed[rank], found.predicted[rank], none, none, none),
        places=tuple(data.places[c] for c in columns), extreme=data.extreme[rows][:, columns],
        acceleration=data.acceleration, assembly=assemble(found.line),
    )  # fmt: skip
    return comparison(shown, channel=channel)


def _moving(found: MeasuredComparison, channel: str) -> int:
    """The channel of a name, or the first that moves.

    Raises
    ------
    InputError : no such channel.
    """
    moves = int(np.argmax(np.abs(found.curve.amplitude).max(axis=(0, 1)) > 0))
    known = f"there are {', '.join(found.channels)}"
    return place_of(channel, found.channels, moves, "channel", "not a channel", known)


def _over(found: MeasuredComparison, channel: str) -> Picture:
    curves, column = np.abs(found.curve.amplitude), _moving(found, channel)
    size_of, factor = np.abs(found.measured[:, :, column]), speed_factor(found.unit)
    symbol, size = unit_of(found.kinds[column], float(np.nanmax(size_of, initial=0.0)))
    rank = np.argsort(found.speed)
    x, y = found.speed[rank] * factor, size_of[rank] / size
    along, wanted = found.curve.speed * factor, curves[:, :, column] / size
    peaks = np.maximum(np.nan_to_num(y).max(axis=0, initial=0.0), wanted.max(axis=0, initial=0.0))
    largest = float(peaks.max(initial=0.0))
    drawn = sorted(k for k in np.argsort(-peaks)[:MOST_ORDERS].tolist() if peaks[k] > largest / 10**DECADES)
    least = max(min((float(np.nanmin(y[:, k])) for k in drawn), default=0.0), 2 * largest / 10 ** (DECADES + 0.5))
    items: list[Item] = []
    for i, k in enumerate(drawn):
        around = found.half_width[rank, k, column] / size
        low, high = np.maximum(y[:, k] - around, least / 4), y[:, k] + around
        order = order_words(float(found.order[k]))
        items.append(Band(x, low, high, f"interval {i}", "measured, interval of 95 %" if not i else ""))
        items.append(Points(x, y[:, k], f"dot {i}", f"{order}, measured"))
        items.append(Line(along, np.where(wanted[:, k] > 0, wanted[:, k], np.nan), curve(i), f"{order}, predicted"))
    up = Axis(f"{WORDS[found.kinds[column]]} amplitude", symbol)
    up = up.logarithmic(least / 2, 2 * largest) if largest > 0 else up
    return over_speed(x, found.unit, up, items, title=f"{found.channels[column]}: measured and predicted")


def order_map(found: MeasuredOrderMap) -> Picture:
    """Amplitude over order and speed, three decades below the largest."""
    x, rank = found.speed * speed_factor(found.unit), np.argsort(found.speed)
    symbol, size = unit_of(found.kind, float(found.amplitude[:, 1:].max()))
    amplitude = found.amplitude[:, 1:] / size
    top = max(float(amplitude.max()), 1e-300)
    least = top / 10**MAP_DECADES
    unit = f" [{symbol}]" if symbol else ""
    colours = Colours(f"{WORDS[found.kind]} amplitude of {found.name}{unit}", "amplitude", least, top, "log")
    mesh = ColouredGrid(x[rank], found.order[1:], np.maximum(amplitude[rank].T, least), colours)
    return single(Axis("input speed", found.unit), Axis("order"), [mesh], height=4.6, grid="")
