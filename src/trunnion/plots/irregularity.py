"""Speed of every shaft over one turn of the input: what the joints make of a constant input speed."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from trunnion.plots.kinetostatics import SAME, groups
from trunnion.plots.style import curve_style, key_below, label_axes, new_axes
from trunnion.response.kinetostatics.result import Kinetostatics


def draw(result: Kinetostatics, axes: Axes | None = None) -> Axes:
    """Speed about its own mean [%] of each shaft; shafts that turn alike share a curve."""
    axes = axes or new_axes(7.2, 3.4)
    turn = np.degrees(result.input_angle)
    percent = 100 * (result.speed / (result.input_speed * result.shaft_ratio)[:, None] - 1)
    for i, (names, row) in enumerate(groups(result.shafts, percent, 100 * SAME)):
        label = ", ".join(names) if len(names) < 4 else f"{names[0]} … {names[-1]} ({len(names)} shafts)"
        axes.plot(turn, percent[row], **curve_style(i), lw=1.6, label=label)
    axes.set_xlim(0, 360 * result.turns)
    if result.turns == 1:
        axes.set_xticks(range(0, 361, 45))
    axes.axhline(0, color="#bbbbbb", lw=0.7, zorder=0)
    label_axes(axes, "input angle [°]", "speed about its mean [%]", grid=False)
    key_below(axes, 2, handlelength=2.6, columnspacing=1.5)
    return axes
