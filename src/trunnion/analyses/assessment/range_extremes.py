"""The largest torque of a spring and the largest growth rate over the running range of one load case."""

from __future__ import annotations

import numpy as np

from trunnion.analyses.assessment.compared import worst_of
from trunnion.analyses.assessment.subject import Case
from trunnion.analyses.linear.along import straight_decay
from trunnion.analyses.orders.response import order_response
from trunnion.analyses.orders.result import OrderResponse
from trunnion.arrays import Array
from trunnion.errors import ComputationError, InputError

NEAR = 0.8
"""Share of the largest value on the grid from which a peak may turn out to be the largest."""
ROUNDS, AROUND = 3, 9
"""Rounds of so many speeds each that close in on a peak."""


def _torques(response: OrderResponse, word: str) -> Array:
    """Torques (speed, spring) [N m]."""
    return response.peak_torque if word == "peak" else response.vibratory_torque


def largest_torque(case: Case, word: str, spring: int) -> tuple[float, float]:
    """Largest "peak" or "vibratory" torque [N m] of a spring over the range, infinite where there is no steady state,
    and its speed [rad/s]."""
    at, value = worst_of(_torques(case.answered, word)[:, spring])
    return value, float(case.speeds[at])


def exact_torque(case: Case, word: str, spring: int) -> tuple[float, float]:
    """As ``largest_torque``, every peak between two speeds of the grid that may be the largest closed in on."""
    value, speed = largest_torque(case, word, spring)
    grid = case.speeds
    if not np.isfinite(value) or len(grid) < 3:
        return value, speed
    values = _torques(case.answered, word)[:, spring]
    inner = (
        np.flatnonzero((values[1:-1] >= values[:-2]) & (values[1:-1] >= values[2:]) & (values[1:-1] > NEAR * value)) + 1
    )
    low, high = grid[inner - 1], grid[inner + 1]
    for _ in range(ROUNDS if len(inner) else 0):
        points = np.linspace(low, high, AROUND, axis=1)
        found = order_response(case.assembly, points.ravel())
        rows = _torques(found, word)[:, spring].reshape(points.shape)
        if not np.all(np.isfinite(rows)):
            return np.inf, speed
        top = rows.argmax(axis=1)
        each = np.arange(len(points))
        best = int(rows.max(axis=1).argmax())
        if rows[best].max() > value:
            value, speed = float(rows[best].max()), float(points[best, top[best]])
        low, high = points[each, np.maximum(top - 1, 0)], points[each, np.minimum(top + 1, AROUND - 1)]
    return value, speed


def largest_growth(case: Case) -> tuple[float, float] | None:
    """Largest growth rate over the range and its speed; of a line that nothing varies, its slowest decay."""
    try:
        if not case.parametric:
            speeds = case.speeds
            rates = np.array([-straight_decay(case.assembly, float(speed)) for speed in speeds])
        else:
            speeds, rates = case.along.speed, case.along.growth_rate
    except (InputError, ComputationError):
        return None
    if not np.any(np.isfinite(rates)):
        return None
    at = int(np.nanargmax(rates))
    everywhere = np.ptp(rates) <= 1e-9 * abs(rates[at])
    return float(rates[at]), np.nan if everywhere else float(speeds[at])
