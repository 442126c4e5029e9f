"""Stability charts as papers print them: dark = unstable, nothing else, in the paper's symbols."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap

from trunnion.modes.resonance_speeds import Resonance
from trunnion.plots.resonance_marks import mark_resonances
from trunnion.plots.stability_chart import edges
from trunnion.plots.style import INK, SMALL, label_axes, settle
from trunnion.results.chart import StabilityChart
from trunnion.results.verdict import Verdict

DARK, GREY = "#1c1c22", "#c4c4c4"


def draw(
    chart: StabilityChart,
    axes: Axes,
    *,
    x_label: str,
    y_label: str,
    x_limits: tuple[float, float] | None = None,
    resonances: Sequence[Resonance] = (),
    caption: str = "",
) -> Axes:
    """Draw ``chart`` into ``axes`` in black and white.

    Parameters
    ----------
    x_label, y_label : the paper's symbols.
    x_limits : of the paper's axis, where the chart covers less of it; the rest is hatched.
    resonances : named along the top.
    caption : in the lower left corner.
    """
    for verdict, colour in ((Verdict.UNSTABLE, DARK), (Verdict.UNDECIDED, GREY)):
        there = chart.verdict == verdict
        if there.any():
            mesh = np.ma.masked_where(~there, there.astype(float))
            axes.pcolormesh(edges(chart.x), edges(chart.y), mesh, cmap=ListedColormap([colour]), rasterized=True)
    low, high = x_limits or (float(chart.x[0]), float(chart.x[-1]))
    axes.set_xlim(low, high)
    axes.set_ylim(float(chart.y[0]), float(chart.y[-1]))
    hatch: dict[str, Any] = {"facecolor": "white", "edgecolor": "#9a9a9a", "hatch": "////", "lw": 0}
    if chart.x[0] > low:
        axes.axvspan(low, float(chart.x[0]), **hatch)
    label_axes(axes, x_label, y_label, grid=False)
    axes.set_axisbelow(False)
    if caption:
        axes.set_title(caption, fontsize=SMALL, color=INK, loc="left", y=1.0, pad=42 if resonances else 6)
    if resonances:
        settle(axes)
        room = mark_resonances(axes, resonances, 1.0, along="x")
        axes.set_title(caption, fontsize=SMALL, color=INK, loc="left", pad=room + 6)
    return axes
