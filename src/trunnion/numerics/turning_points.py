"""Where curves turn: every local extremum of a curve that is smooth between cuts, as dense output is between steps.

Cycles are counted from turning points, and a largest damage hangs on a high power of their values: samples that just
miss them count too little. Every cell is looked at in eight parts, and each part that holds a turning point is closed
in on. What swings within a part is not seen: an integrator's step holds much less than a swing.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Integers
from trunnion.numerics.curves import BLOCK, EDGE, PARTS, Curves

ZOOMS, ZOOM_PARTS = 4, 16
"""Each zoom shrinks a bracket of two parts to two of sixteen; a smooth top is then known to a share of 1e-10."""


@dataclass(frozen=True)
class TurningPoints:
    """Of one curve: time and value (points,), both ends included, and what the last zoom still changed a value by."""

    time: Array
    value: Array
    error: float


def turning_points(curves: Curves, cuts: Array) -> tuple[TurningPoints, ...]:
    """The turning points of every curve from the first to the last cut.

    Parameters
    ----------
    curves : times (m,) → values (m, curves).
    cuts : rising; between neighbours the curves are smooth and eight parts of a cell show each of their swings.
    """
    times, values = zip(*_sampled(curves, cuts), strict=True)
    time, value = np.concatenate(times), np.concatenate(values)
    return tuple(_of_curve(curves, column, time, value[:, column]) for column in range(value.shape[1]))


def reversals(values: Array) -> Integers:
    """Numbers of the values (points,) at which their course turns, the first and the last among them."""
    steps = np.diff(values)
    moving = np.flatnonzero(steps)
    turns = moving[1:][np.sign(steps[moving[1:]]) != np.sign(steps[moving[:-1]])]
    return np.unique(np.concatenate([[0], turns, [len(values) - 1]]))


def _sampled(curves: Curves, cuts: Array) -> Iterator[tuple[Array, Array]]:
    """Times and values (points, curves), both sides of every cut, block by block; of long blocks what turns alone, and
    what stands beside it."""
    begin, length = cuts[:-1], np.diff(cuts)
    shares = np.concatenate([[EDGE], np.arange(1, PARTS) / PARTS, [1 - EDGE]])
    for i in range(0, len(begin), BLOCK):
        part = slice(i, i + BLOCK)
        time = (begin[part, None] + length[part, None] * shares).ravel()
        value = curves(time)
        kept = np.unique(np.concatenate([reversals(column) for column in value.T]))
        beside = np.unique(np.concatenate([kept + k for k in (-2, -1, 0, 1, 2)]).clip(0, len(time) - 1))
        yield time[beside], value[beside]


def _of_curve(curves: Curves, column: int, time: Array, value: Array) -> TurningPoints:
    # The first and the last value may hide a turning point beside them.
    turns = reversals(value)
    at, found, error = time[turns], value[turns], np.zeros(len(turns))
    for i in range(0, len(turns), BLOCK):
        part = slice(i, i + BLOCK)
        at[part], found[part], error[part] = _closed_in(curves, column, time, value, turns[part])
    whole = np.concatenate([value[:1], found, value[-1:]])
    times = np.concatenate([time[:1], at, time[-1:]])
    kept = reversals(whole)
    return TurningPoints(times[kept], whole[kept], float(error.max(initial=0.0)))


def _closed_in(curves: Curves, column: int, time: Array, value: Array, turns: Integers) -> tuple[Array, Array, Array]:
    """Times and values of the extrema about samples ``turns``, and by how much the last zoom raised each.

    Nothing is interpolated: a curve may jump or bend at a cut.
    """
    last = len(time) - 1
    left, right = np.maximum(turns - 1, 0), np.minimum(turns + 1, last)
    up = np.where(value[turns] == value[left], value[turns] > value[right], value[turns] > value[left])
    sign = np.where(up, 1.0, -1.0)[:, None]
    # At a cut two samples stand at one place: the bracket takes the next.
    twin = 4 * EDGE
    near = time[turns] - time[left] < twin * (time[right] - time[left])
    left = np.where(near, np.maximum(left - 1, 0), left)
    near = time[right] - time[turns] < twin * (time[right] - time[left])
    right = np.where(near, np.minimum(right + 1, last), right)
    low, high, rows = time[left], time[right], np.arange(len(turns))
    at, top = time[turns], sign[:, 0] * value[turns]
    for _ in range(ZOOMS):
        times = low[:, None] + (high - low)[:, None] * np.arange(ZOOM_PARTS + 1) / ZOOM_PARTS
        values = sign * curves(times.ravel())[:, column].reshape(times.shape)
        best = values.argmax(axis=1)
        before, found = top, values[rows, best]
        at, top = np.where(found > before, times[rows, best], at), np.maximum(before, found)
        middle = best.clip(1, ZOOM_PARTS - 1)
        low, high = times[rows, middle - 1], times[rows, middle + 1]
    return at, sign[:, 0] * top, top - before
