"""Figures of a reproduction: charts side by side as the paper draws them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from trunnion.arrays import Array
from trunnion.modes.resonance_speeds import Resonance, resonance_speeds
from trunnion.plots.paper_chart import draw
from trunnion.plots.style import ACCENT, FAINT, INK, SMALL, TEXT, TITLE, head, new_figure, plain
from trunnion.results.chart import StabilityChart
from trunnion.studies.shared.result import PaperFigure


@dataclass(frozen=True)
class Panel:
    """A chart, its caption, the paper's axis label along y, the paper's speed range, the named resonances."""

    chart: StabilityChart
    caption: str
    y_label: str
    limits: tuple[float, float]
    named: tuple[Resonance, ...]


def panel(chart: StabilityChart, caption: str, y_label: str, limits: tuple[float, float], name: bool = True) -> Panel:
    """A panel with the resonances of the chart's line up to order 2."""
    assert chart.line is not None
    named = tuple(resonance_speeds(chart.line)) if name else ()
    return Panel(chart, caption, y_label, limits, tuple(r for r in named if r.speed >= chart.x[0]))


def side_by_side(panels: Sequence[Panel]) -> Figure:
    """One or two panels, dark = unstable."""
    figure = new_figure(5.0 * len(panels) + 0.4, 4.6)
    grid: Any = figure.subplots(1, len(panels), squeeze=False)
    for axes, p in zip(grid[0], panels, strict=True):
        draw(
            p.chart, axes, x_label="speed Ω [1]", y_label=p.y_label, x_limits=p.limits, resonances=p.named,
            caption=p.caption,
        )  # fmt: skip
    return figure


def charts_figure(number: str, caption: str, assumed: str, *panels: Panel) -> PaperFigure:
    """A figure of the paper that shows one or two charts."""
    return PaperFigure(number, caption, assumed, partial(side_by_side, panels), tuple(p.chart for p in panels))


def curves(
    x: Array, rows: Sequence[tuple[str, Array]], marks: Sequence[tuple[float, str]], y_label: str, title: str
) -> Figure:
    """Spectral radii over speed, one small panel each under a common speed axis; marks are named speeds."""
    figure = new_figure(7.2, 1.55 * len(rows) + 0.8)
    grid: Any = figure.subplots(len(rows), 1, sharex=True, squeeze=False)
    for k, (axes, (name, values)) in enumerate(zip(grid[:, 0], rows, strict=True)):
        axes.axhline(1.0, color=FAINT, lw=0.8)
        axes.plot(x, values, color=INK, lw=1.2)
        axes.fill_between(x, 1.0, np.maximum(values, 1.0), color="#8c2f39", lw=0)
        axes.set_title(name, fontsize=SMALL, color=INK, loc="right")
        plain(axes)
        axes.tick_params(labelsize=SMALL)
        axes.set_xlim(x[0], x[-1])
        low, high = float(values.min()), float(values.max())
        axes.set_ylim(min(low, 0.999) - 0.05 * (high - low), max(high, 1.001) + 0.08 * (high - low))
        for at, word in marks:
            axes.axvline(at, color=ACCENT, lw=0.8, ls=(0, (4, 3)), zorder=0)
            if k == 0:
                place = axes.get_xaxis_transform()
                axes.text(at, 1.03, word, transform=place, fontsize=SMALL, color=ACCENT, ha="center", va="bottom")
    grid[-1, 0].set_xlabel("speed Ω [1]", fontsize=TEXT, color=INK)
    figure.supylabel(y_label, fontsize=TEXT, color=INK)
    head(figure, title, TITLE - 1)
    return figure
