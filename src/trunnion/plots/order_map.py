"""Order map (waterfall): amplitude of torque over order and input speed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trunnion.analyses.motion.order_map import OrderMap, order_map
from trunnion.analyses.motion.simulate import LineSimulation
from trunnion.plots.style import INK, SMALL, TEXT, new_axes, plain
from trunnion.results.speeds import speed_factor

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DECADES = 3.0


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

    Over input speed where it changes, over time where it does not.
    """
    from matplotlib.colors import LogNorm

    found = result if isinstance(result, OrderMap) else order_map(result, window=window, highest=highest)
    axes, unit = axes or new_axes(7.2, 4.6), unit or found.unit
    i = found.shafts.index(shaft) if shaft else 0
    varies = abs(found.speed[-1] - found.speed[0]) > 1e-6 * found.speed[0]
    x = found.speed * speed_factor(unit) if varies else found.time
    amplitude = found.amplitude[:, 1:, i]
    top = max(float(amplitude.max()), 1e-300)
    order = np.argsort(x)
    shown = axes.pcolormesh(
        x[order], found.order[1:], np.maximum(amplitude[order].T, top / 10**DECADES),
        norm=LogNorm(top / 10**DECADES, top), cmap="viridis", shading="nearest", rasterized=True,
    )  # fmt: skip
    bar = axes.figure.figure.colorbar(shown, ax=axes)
    bar.set_label(f"torque amplitude of {found.shafts[i]} [N·m]", fontsize=TEXT, color=INK)
    bar.ax.tick_params(labelsize=SMALL)
    axes.set_xlabel(f"input speed [{unit}]" if varies else "time [s]", fontsize=TEXT, color=INK)
    axes.set_ylabel("order [cycles per turn of the input]", fontsize=TEXT, color=INK)
    plain(axes)
    return axes
