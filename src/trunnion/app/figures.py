"""Bokeh figures in one look: sizes, labels, colours told by every kind of colour vision, no logo."""

from __future__ import annotations

import html
from typing import Any

import numpy as np
from bokeh.models import BasicTickFormatter, ColumnDataSource, HoverTool, Legend
from bokeh.plotting import figure

BLUE, ORANGE, GREEN, PINK = "#0072b2", "#d55e00", "#009e73", "#cc79a7"
SKY, YELLOW, INK, FAINT = "#56b4e9", "#b58900", "#1a1a1a", "#6b6b6b"
COLOURS = (BLUE, ORANGE, GREEN, PINK, SKY, YELLOW, INK)
DASHES = ("solid", "dashed", "dotdash", "dotted", "12 4", "10 3 2 3 2 3", "3 3")
"""One for every colour: lines are told apart without it."""


def look(k: int) -> dict[str, Any]:
    """Colour and dash of the k-th line."""
    return {"line_color": COLOURS[k % len(COLOURS)], "line_dash": DASHES[k % len(DASHES)]}


def plot(x: str, y: str, *, height: int = 340, title: str = "", about: str = "", **more: Any) -> Any:
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
    made.name = about or title
    for axis in made.axis:
        axis.axis_label_text_font_style = "normal"
        axis.axis_label_text_font_size = "14px"
        axis.major_label_text_font_size = "13px"
        if isinstance(axis.formatter, BasicTickFormatter):
            axis.formatter.power_limit_high = 7  # 200000 N·m, not 2.000e+5
    made.grid.grid_line_color = "#e3e6ea"
    return made


def legend(made: Any, items: list[Any], place: str = "right") -> None:
    """A legend beside the figure; a click hides a line."""
    for old in list(made.legend):
        made.right = [r for r in made.right if r is not old]
        made.below = [r for r in made.below if r is not old]
    box = Legend(items=items, click_policy="hide", label_text_font_size="12px", spacing=1, padding=4)
    made.add_layout(box, place)


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


def _alike(a: Any, b: Any) -> bool:
    if isinstance(a, np.ndarray) and isinstance(b, np.ndarray):
        return a.shape == b.shape and a.dtype == b.dtype and np.array_equal(a, b, equal_nan=a.dtype.kind in "fc")
    if isinstance(a, list | tuple) and isinstance(b, list | tuple):
        return len(a) == len(b) and all(map(_alike, a, b))
    return type(a) is type(b) and bool(a == b)


def text(words: object) -> str:
    """Words for an HTML pane."""
    return html.escape(str(words))
