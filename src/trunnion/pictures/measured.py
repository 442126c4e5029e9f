"""Measured orders over speed with their intervals, and maps of orders."""

from __future__ import annotations

import numpy as np

from trunnion.measured.tracking.by_angle import MeasuredOrderMap
from trunnion.measured.tracking.result import MeasuredOrders, unit_of
from trunnion.pictures.looks import curve
from trunnion.pictures.picture import Axis, Band, ColouredGrid, Colours, Item, Line, Picture, single
from trunnion.pictures.shared import over_speed, place_of
from trunnion.results.speeds import speed_factor
from trunnion.results.units import order_words

MOST_ORDERS = 6
"""Curves drawn, the largest of them."""
DECADES = 3.0
"""Orders whose peak is farther below the largest are not drawn."""
MAP_DECADES = 3.0
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
    column = place_of(channel, found.channels, 0, "channel", "no channel", f"there are {', '.join(found.channels)}")
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
