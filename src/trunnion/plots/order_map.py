"""Order map (waterfall): amplitude of torque over order and input speed."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm

from trunnion.motion.simulation.order_map import OrderMap, order_map
from trunnion.motion.simulation.simulation import LineSimulation
from trunnion.plots.style import colour_bar, label_axes, new_axes
from trunnion.results.speeds import speed_factor

DECADES = 3.0
LEAST = 0.01
"""Relative change of the speed over a run that makes it an axis: a line that starts free always drifts a bit."""


def draw(
    result: LineSimulation | OrderMap,
    axes: Axes | None = None,
    *,
    shaft: str = "",
    window: int = 8,
    highest: float = 12.0,
    unit: str = "",
) -> Axes:
    """Torque amplitude of one shaft (the first, or ``shaft``), three decades below the largest.

    Over input speed where it rises or falls all along, over time where it does not.
    """
    found = result if isinstance(result, OrderMap) else order_map(result, window=window, highest=highest)
    axes, unit = axes or new_axes(7.2, 4.6), unit or found.unit
    i = found.shafts.index(shaft) if shaft else 0
    change = np.diff(found.speed)
    varies = len(change) and (np.all(change > 0) or np.all(change < 0)) and np.ptp(found.speed) > LEAST * found.speed[0]
    x = found.speed * speed_factor(unit) if varies else found.time
    amplitude = found.amplitude[:, 1:, i]
    top = max(float(amplitude.max()), 1e-300)
    order = np.argsort(x)
    shown = axes.pcolormesh(
        x[order], found.order[1:], np.maximum(amplitude[order].T, top / 10**DECADES),
        norm=LogNorm(top / 10**DECADES, top), cmap="viridis", shading="nearest", rasterized=True,
    )  # fmt: skip
    colour_bar(axes, shown, f"torque amplitude of {found.shafts[i]} [N·m]")
    words = f"input speed [{unit}]" if varies else "time [s]"
    label_axes(axes, words, "order [cycles per turn of the input]", grid=False)
    return axes
