"""Growth rate of the slowest disturbance over speed: the margin of stability along the running range."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from trunnion.driveline.operation import Operation
from trunnion.floquet.stability.along import StabilityAlong
from trunnion.plots.over_speed import over_speed
from trunnion.plots.style import INK, key_below, new_axes
from trunnion.results.speeds import speed_factor

UNSTABLE = "#8c2f39"


def draw(found: StabilityAlong, axes: Axes | None = None, *, unit: str, operating: Operation | None = None) -> Axes:
    """Growth rate [1/s] over speed in ``unit``; above zero the line is unstable."""
    axes = axes or new_axes(7.2, 3.6)
    x, rate = found.speed * speed_factor(unit), found.growth_rate
    axes.plot(x, rate, color=INK, lw=1.6, label="slowest disturbance", marker="o" if len(x) == 1 else None)
    axes.axhline(0.0, color=UNSTABLE, lw=1.6, label="limit of stability")
    if np.any(rate > 0):
        axes.fill_between(x, 0.0, rate, where=rate > 0, color=UNSTABLE, alpha=0.6, lw=0, label="unstable")
    low, high = float(np.nanmin(rate, initial=0.0)), float(np.nanmax(rate, initial=0.0))
    room = 0.08 * max(high - low, 1e-12)
    axes.set_ylim(low - room, high + room)
    over_speed(axes, x, unit, "growth rate [1/s]", operating)
    key_below(axes, 4)
    return axes
