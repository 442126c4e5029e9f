"""Figures of a reproduction: charts side by side as the paper draws them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from trunnion.arrays import Array
from trunnion.modes.resonance_speeds import Resonance, resonance_speeds
from trunnion.papers.shared.result import PaperFigure
from trunnion.pictures.picture import MARGIN, Axis, Band, EdgeNames, Item, Level, Line, Panel, Picture
from trunnion.pictures.stability_chart import paper_panel
from trunnion.results.chart import StabilityChart

SPEED = "speed Ω [1]"


@dataclass(frozen=True)
class ChartPanel:
    """A chart, its caption, the paper's axis label along y, the paper's speed range, the named resonances."""

    chart: StabilityChart
    caption: str
    y_label: str
    limits: tuple[float, float]
    named: tuple[Resonance, ...]


def panel(
    chart: StabilityChart, caption: str, y_label: str, limits: tuple[float, float], name: bool = True
) -> ChartPanel:
    """A panel with the resonances of the chart's line up to order 2."""
    assert chart.line is not None
    named = tuple(resonance_speeds(chart.line)) if name else ()
    return ChartPanel(chart, caption, y_label, limits, tuple(r for r in named if r.speed >= chart.x[0]))


def side_by_side(panels: Sequence[ChartPanel]) -> Picture:
    """One or two panels, dark = unstable."""
    shown = [paper_panel(one.chart, SPEED, one.y_label, one.limits, one.named, one.caption) for one in panels]
    return Picture(shown, 5.0 * len(shown) + 0.4, 4.6, len(shown))


def charts_figure(number: str, caption: str, assumed: str, *panels: ChartPanel) -> PaperFigure:
    """A figure of the paper that shows one or two charts."""
    return PaperFigure(number, caption, assumed, partial(side_by_side, panels), tuple(p.chart for p in panels))


def curves(
    x: Array, rows: Sequence[tuple[str, Array]], marks: Sequence[tuple[float, str]], y_label: str, title: str
) -> Picture:
    """Curves over speed, one small panel each under a common speed axis, filled above 1; marks are named speeds."""
    across, shown = Axis(SPEED, "", float(x[0]), float(x[-1])), []
    for k, (name, values) in enumerate(rows):
        low, high = float(values.min()), float(values.max())
        room = MARGIN * (high - low)
        up = Axis(y_label if k == len(rows) // 2 else "", "", min(low, 0.999) - room, max(high, 1.001) + 1.6 * room)
        items: list[Item] = [Level(at, "named speed", on="x") for at, _ in marks]
        items += [
            Level(1.0, "jump"),
            Line(x, values, "line"),
            Band(x, np.ones(len(x)), np.maximum(values, 1.0), "unstable part"),
        ]
        if not k:
            items.append(EdgeNames([at for at, _ in marks], [word for _, word in marks]))
        shown.append(Panel(across, up, items, remark=name, key="", grid=""))
    return Picture(shown, 7.2, 1.55 * len(rows) + 0.8, title=title, shared=True)
