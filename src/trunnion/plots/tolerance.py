"""What tolerances do: the distribution of the growth rate, and the parameters by what they explain of it."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from trunnion.design.tolerance.study import ToleranceStudy
from trunnion.plots.style import ACCENT, INK, SMALL, TEXT, label_axes, new_axes
from trunnion.results.speeds import show_speed

APART = 1.0
"""Widths of the distribution between it and 0 from which on 0 is named: drawn, it would leave a sliver of the rest."""
CROWDED = 0.5
"""Share of lines in one bar above which the few others, those that grow among them, would not be seen beside it."""
LIMIT = "#4a1526"
SHOWN = 8
"""Parameters shown at most."""


def draw(study: ToleranceStudy, axes: Axes | None = None) -> Axes:
    """Histogram of the growth rate at the speed where it is fastest; below it (within ``axes``) the ranking."""
    names, shares = zip(*study.ranking[:SHOWN], strict=True)
    if axes is None:
        rows = 0.3 * len(names)
        axes = new_axes(7.2, 4.1 + rows)
        grid = axes.figure.figure.add_gridspec(2, 1, height_ratios=(2.8, rows))
        axes.set_subplotspec(grid[0, 0])
        side, room = axes.figure.figure.add_subplot(grid[1, 0]), 3.0
    else:
        side, room = axes.inset_axes((0.64, 0.45, 0.34, 0.5)), 1e3  # the ranking stands above the bars
    fastest = int(np.nanmax(study.growth_rate, axis=1).argmax())
    rates = study.growth_rate[fastest]
    rates = rates[np.isfinite(rates)]
    counts, _, _ = axes.hist(rates, bins=int(np.clip(2 * np.sqrt(len(rates)), 12, 60)), color="#b9a7ad", lw=0)
    few = np.max(counts) > CROWDED * len(rates)
    if few:
        axes.set_yscale("log")
        axes.set_ylim(0.5, room * np.max(counts))
    _limit(axes, float(rates.min()), float(rates.max()))
    at = show_speed(float(study.speeds[fastest]), study.unit)
    label_axes(axes, f"growth rate at {at} [1/s]", "lines, logarithmic" if few else "lines", grid=False)
    low, high = study.interval
    title = f"stable with probability {study.probability:.4g} ({low:.4g} to {high:.4g})"
    axes.set_title(title, fontsize=TEXT, color=INK, loc="left")
    side.barh(range(len(names)), [100 * s for s in shares], color=ACCENT)
    side.set_yticks(range(len(names)), names, fontsize=SMALL)
    side.invert_yaxis()
    side.set_xlabel("explains of the scatter [%]", fontsize=SMALL)
    side.tick_params(labelsize=SMALL)
    return axes


def _limit(axes: Axes, slowest: float, fastest: float) -> None:
    """The limit of stability, growth rate 0; where all lines are far to one side of it, an arrow to it."""
    width = fastest - slowest
    if slowest - APART * width <= 0 <= fastest + APART * width or not width > 0:
        axes.axvline(0.0, color=LIMIT, lw=1.4)
        return
    stable = fastest < 0
    axes.set_xlim(slowest - 0.05 * width, fastest + 0.05 * width)
    axes.xaxis.set_major_locator(MaxNLocator(5))
    if axes.get_yscale() == "linear":
        axes.set_ylim(top=1.15 * axes.get_ylim()[1])
    away = (-fastest if stable else slowest) / width
    said = f"0, the limit, {away:.2g} widths away {'→' if stable else ''}".strip()
    axes.text(
        0.99 if stable else 0.01, 0.97, said if stable else f"← {said}", transform=axes.transAxes,
        ha="right" if stable else "left", va="top", fontsize=SMALL, color=LIMIT,
    )  # fmt: skip
