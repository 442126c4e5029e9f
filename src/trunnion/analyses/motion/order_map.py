"""Order map of a motion: how strong each order of the input's rotation is, as the speed changes.

The torque is read at equal steps of the input's angle, so that an order is a line whatever the speed does, and
transformed over windows of a few turns (Hann, overlapping by half). A pure order shows its amplitude.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.analyses.motion.simulate import LineSimulation
from trunnion.arrays import Array
from trunnion.driveline.operating_speed import speed_unit
from trunnion.errors import InputError

FEWEST_PER_TURN, PER_STEP = 64, 4
"""Samples: what swings faster than two of them would fold back on the orders shown. An integrator takes several steps
to a swing, so four times as many samples miss none; what folds back of the bends at changes of stage stays below 1e-4
of them."""
WINDOW = 8


@dataclass(frozen=True)
class OrderMap:
    """amplitude (window, order, shaft) [N m] at speed (window,) [rad/s] and time (window,) [s] over order (order,)
    in cycles per turn of the input; unit: what speeds read in."""

    time: Array
    speed: Array
    order: Array
    amplitude: Array
    shafts: tuple[str, ...]
    unit: str = "rad/s"


def times_at_angles(run: LineSimulation, angles: Array) -> Array:
    """Times [s] at which the input stands at ``angles`` [rad] (rising)."""
    out = np.full(len(angles), np.nan)
    for end, course in run.profile.courses(run.end):
        turned = angles - course.angle
        length = end - course.since
        last = (course.speed + course.acceleration * length / 2) * length
        inside = (turned >= -1e-12) & (turned <= last * (1 + 1e-12))
        # The root of ½at² + wt = θ that stays finite as a → 0.
        root = np.sqrt(np.maximum(course.speed**2 + 2 * course.acceleration * turned[inside], 0.0))
        out[inside] = np.clip(course.since + 2 * turned[inside] / (course.speed + root), course.since, end)
    return out


def order_map(run: LineSimulation, *, window: int = WINDOW, highest: float = 12.0) -> OrderMap:
    """The order map of a simulated run, of ``window`` turns each.

    Raises
    ------
    InputError : fewer turns than two windows.
    """
    turns = int(float(run.profile.angle(run.end)) / (2 * np.pi))
    if isinstance(window, bool) or window != int(window) or window < 1 or turns < 2 * window:
        raise InputError(
            f"needs a run of at least two windows, this one has {turns} turns",
            element="order map", key="window", value=window, remedy="take a longer run or a shorter window",
        )  # fmt: skip
    per_turn = _per_turn(run, turns, highest)
    count = window * per_turn
    shape = np.hanning(count + 1)[:-1]
    starts = np.arange(0, turns * per_turn - count + 1, count // 2)
    times = times_at_angles(run, 2 * np.pi * np.arange(turns * per_turn) / per_turn)
    torque = run.torque_at(times)
    kept = int(np.floor(highest * window + 1e-9)) + 1
    amplitude = np.empty((len(starts), kept, torque.shape[1]))
    for row, at in zip(amplitude, starts, strict=True):
        part = torque[at : at + count]
        # Without its mean, which the window would smear into the lowest orders.
        row[:] = 2 * np.abs(np.fft.rfft((part - part.mean(axis=0)) * shape[:, None], axis=0))[:kept] / shape.sum()
        row[0] = np.abs(part.mean(axis=0))
    middle = times[starts + count // 2]
    return OrderMap(
        middle,
        run.profile.at(middle),
        np.arange(kept) / window,
        amplitude,
        run.shafts,
        speed_unit(run.line.assembly.line),
    )


def _per_turn(run: LineSimulation, turns: int, highest: float) -> int:
    """Samples a turn that show all that the motion holds in its busiest turn."""
    edges = times_at_angles(run, 2 * np.pi * np.arange(turns + 1.0))
    steps = int(np.diff(np.searchsorted(run.cuts, edges)).max())
    return 1 << int(np.ceil(np.log2(max(FEWEST_PER_TURN, PER_STEP * steps, 4 * highest))))
