"""Bokeh figures in one look: sizes, labels, colours told by every kind of colour vision, no logo."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from bokeh.models import BasicTickFormatter, ColumnDataSource, HoverTool, Span
from bokeh.plotting import figure

BLUE, ORANGE, GREEN, PINK = "#0072b2", "#d55e00", "#009e73", "#cc79a7"
SKY, YELLOW, INK, FAINT = "#56b4e9", "#b58900", "#1a1a1a", "#6b6b6b"
COLOURS = (BLUE, ORANGE, GREEN, PINK, SKY, YELLOW, INK)
DASHES = ("solid", "dashed", "dotdash", "dotted", "12 4", "10 3 2 3 2 3", "3 3")
"""One for every colour: lines are told apart without it."""


def look(k: int) -> dict[str, Any]:
    """Colour and dash of the k-th line."""
    return {"line_color": COLOURS[k % len(COLOURS)], "line_dash": DASHES[k % len(DASHES)]}


def plot(x: str, y: str, *, height: int = 340, title: str = "", **more: Any) -> Any:
    """A figure as wide as there is place, with labelled axes."""
    made = figure(
        height=height,
        sizing_mode="stretch_width",
        x_axis_label=x,
        y_axis_label=y,
        title=title,
        tools=more.pop("tools", "pan,wheel_zoom,box_zoom,reset"),
        active_scroll=None,
        **more,
    )
    made.toolbar.logo = None
    made.name = title
    for axis in made.axis:
        axis.axis_label_text_font_style = "normal"
        axis.axis_label_text_font_size = "14px"
        axis.major_label_text_font_size = "13px"
        if isinstance(axis.formatter, BasicTickFormatter):
            axis.formatter.power_limit_high = 7  # 200000 N·m, not 2.000e+5
    made.grid.grid_line_color = "#e3e6ea"
    return made


def shape(height: int) -> Any:
    """A figure of how much every inertia turns, named below; see ``name_inertias``."""
    made = plot("", "rotation, largest 1", height=height, x_range=[], tools="")
    made.xaxis.major_label_orientation = 0.6
    made.add_layout(Span(location=0, dimension="width", line_color=FAINT))
    return made


def name_inertias(made: Any, names: Sequence[str]) -> None:
    """The names below a figure of shapes. Where they stay the browser is not asked to draw again."""
    if list(made.x_range.factors) != list(names):
        made.x_range.factors = list(names)


def hover(made: Any, renderers: list[Any], tips: list[tuple[str, str]], **more: Any) -> None:
    """Values under the pointer."""
    made.add_tools(HoverTool(renderers=renderers, tooltips=tips, **more))


def source(**columns: Any) -> Any:
    """Columns that a figure draws."""
    return ColumnDataSource(data=columns)


def put(into: ColumnDataSource, columns: dict[str, Any]) -> None:
    """Columns in place of those that a figure draws. Where nothing differs the browser is not asked to draw again."""
    now = into.data
    if now.keys() != columns.keys() or not all(_alike(now[key], columns[key]) for key in columns):
        into.data = columns


def put_rows(into: ColumnDataSource, rows: Sequence[Sequence[Any]]) -> None:
    """The same of rows, whose parts stand in the order in which the columns were named."""
    put(into, {name: [row[k] for row in rows] for k, name in enumerate(into.data)})


def _alike(a: Any, b: Any) -> bool:
    if isinstance(a, np.ndarray) and isinstance(b, np.ndarray):
        return a.shape == b.shape and a.dtype == b.dtype and np.array_equal(a, b, equal_nan=a.dtype.kind in "fc")
    if isinstance(a, list | tuple) and isinstance(b, list | tuple):
        return len(a) == len(b) and all(map(_alike, a, b))
    return type(a) is type(b) and bool(a == b)
