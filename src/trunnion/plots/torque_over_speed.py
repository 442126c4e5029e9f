"""Torque amplitude of every shaft over speed, shaded where the linear response is an indication only."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trunnion.analyses.linear.forced_response import LINEAR_RANGE
from trunnion.analyses.linear.speed_sweep import SpeedSweep
from trunnion.driveline.operation import Operation
from trunnion.plots.style import ACCENT, INK, SMALL, TEXT, curve_style, logarithmic, new_axes, plain
from trunnion.results.speeds import speed_factor

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DECADES = 4.0
"""Smallest amplitude shown, in decades below the largest."""


def draw(sweep: SpeedSweep, axes: Axes | None = None, *, unit: str = "", operating: Operation | None = None) -> Axes:
    """Half peak-to-peak torque [N m], on a logarithmic axis since resonances span decades.

    Parameters
    ----------
    unit : of the speed; default the description's.
    operating : its speed is marked.
    """
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    axes = axes or new_axes(7.2, 4.3)
    unit = unit or sweep.unit
    x = sweep.speed * speed_factor(unit)
    handles: list[Line2D | Patch] = []
    for i, shaft in enumerate(sweep.shafts):
        handles += axes.plot(x, sweep.torque_amplitude[:, i], label=shaft, lw=1.5, **curve_style(i))
    largest = float(np.nanmax(sweep.torque_amplitude))
    if largest > 0:
        logarithmic(axes, "y")
        least = max(float(np.nanmin(sweep.torque_amplitude)), largest / 10**DECADES)
        axes.set_ylim(least / 1.5, 2.0 * largest)
    axes.set_xlim(x[0], x[-1])
    if not np.all(sweep.linear):
        axes.fill_between(
            x, 0, 1, where=~sweep.linear, transform=axes.get_xaxis_transform(), step="mid",
            facecolor="#e2e2e2", edgecolor="#8a8a8a", hatch="////", lw=0, zorder=0,
        )  # fmt: skip
        words = f"a joint's input swings by more than {LINEAR_RANGE:g} rad: indication only"
        handles.append(Patch(facecolor="#e2e2e2", edgecolor="#8a8a8a", hatch="////", lw=0, label=words))
    if operating and operating.speed and x[0] <= operating.speed * speed_factor(unit) <= x[-1]:
        at = operating.speed * speed_factor(unit)
        handles.append(axes.axvline(at, color=ACCENT, ls=(0, (5, 3)), lw=1.5, label="operating speed"))
    axes.set_xlabel(f"input speed [{unit}]", fontsize=TEXT, color=INK)
    axes.set_ylabel("torque amplitude [N·m]", fontsize=TEXT, color=INK)
    axes.grid(which="major", color="#dddddd", lw=0.6)
    plain(axes)
    columns = 3 if np.all(sweep.linear) else 2  # the words for the hatching are long
    axes.figure.figure.legend(
        handles=handles, loc="outside lower left", ncols=columns, fontsize=SMALL, frameon=False,
        columnspacing=1.5, handlelength=2.6,
    )  # fmt: skip
    return axes
