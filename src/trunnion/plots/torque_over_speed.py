"""Torque amplitude of every shaft over speed, shaded where the linear response is an indication only."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from trunnion.driveline.operation import Operation
from trunnion.plots.over_speed import hatched, over_speed
from trunnion.plots.style import curve_style, key_below, logarithmic, new_axes
from trunnion.response.speed_sweep import SpeedSweep
from trunnion.results.speeds import speed_factor
from trunnion.results.units import angle_words
from trunnion.steady.orders.forced_response import LINEAR_RANGE

DECADES = 4.0
"""Smallest amplitude shown, in decades below the largest."""


def draw(sweep: SpeedSweep, axes: Axes | None = None, *, unit: str = "", operating: Operation | None = None) -> Axes:
    """Half peak-to-peak torque [N m], on a logarithmic axis since resonances span decades.

    Parameters
    ----------
    unit : of the speed; default the description's.
    operating : its speed is marked.
    """
    axes = axes or new_axes(7.2, 4.3)
    unit = unit or sweep.unit
    x = sweep.speed * speed_factor(unit)
    for i, shaft in enumerate(sweep.shafts):
        axes.plot(x, sweep.torque_amplitude[:, i], label=shaft, lw=1.5, **curve_style(i))
    known = sweep.torque_amplitude[np.isfinite(sweep.torque_amplitude)]
    largest = float(known.max(initial=0.0))
    if largest > 0:
        logarithmic(axes, "y")
        least = max(float(known.min()), largest / 10**DECADES)
        axes.set_ylim(least / 1.5, 2.0 * largest)
    if not np.all(sweep.linear):
        hatched(
            axes, x, ~sweep.linear, f"a joint's input swings by more than {angle_words(LINEAR_RANGE)}: indication only"
        )
    over_speed(axes, x, unit, "torque amplitude [N·m]", operating)
    columns = 3 if np.all(sweep.linear) else 2  # the words for the hatching are long
    key_below(axes, columns, columnspacing=1.5, handlelength=2.6)
    return axes
