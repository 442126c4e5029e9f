"""A figure of many curves that are replaced together: names below it, values under the pointer."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import panel as pn
from bokeh.events import Tap
from bokeh.models import HoverTool, Legend, LegendItem, Span

from trunnion.app.parts import figures

IN_A_ROW, ROW = 3, 28
"""Most names in a row of the legend, and its height in pixels."""
PLACE, LETTER, KEY = 420, 6.7, 40
"""Pixels of a row in the narrowest page, of a letter of a name, and of the line before it."""
WIDE, NARROW = 52, 34
"""Letters of a title in one line over the narrowest picture, and over one that has half of the page."""
MOST = 24
"""Curves that one figure shows."""


class Curve(NamedTuple):
    """One of them; colour and dash where it does not take the next of the palette."""

    name: str
    x: Any
    y: Any
    colour: str = ""
    dash: str = ""


class Curves:
    """Curves on common axes. ``set`` replaces all of them."""

    def __init__(
        self,
        x: str,
        y: str,
        *,
        height: int = 320,
        title: str = "",
        tap: Callable[[float], None] | None = None,
        **more: Any,
    ) -> None:
        self.figure = figures.plot(x, y, height=height, title=title, **more)
        self.words, self.is_narrow, self.height = title, False, height
        self.source = figures.source(xs=[], ys=[], colour=[], dash=[], width=[], name=[])
        self.areas = figures.source(xs=[], ys=[])
        self.figure.patches(
            "xs", "ys", source=self.areas, color=figures.ORANGE, fill_alpha=0.25, line_alpha=0.0,
            hatch_pattern="right_diagonal_line", hatch_alpha=0.4, hatch_color=figures.ORANGE,
        )  # fmt: skip
        drawn = self.figure.multi_line(
            "xs", "ys", line_color="colour", line_dash="dash", line_width="width", source=self.source
        )
        self.figure.add_tools(
            HoverTool(renderers=[drawn], tooltips=[("", "@name"), ("", "($x, $y)")], line_policy="interp")
        )
        self.legend = Legend(
            items=[LegendItem(label={"field": "name"}, renderers=[drawn])], ncols=IN_A_ROW, location="top_left",
            label_text_font_size="12px", spacing=8, margin=2, padding=2, border_line_color=None,
        )  # fmt: skip
        self.figure.add_layout(self.legend, "below")
        self.marks: dict[str, tuple[Any, LegendItem]] = {}
        self.cursor = Span(location=None, dimension="height", line_color=figures.INK, line_dash="dotted", line_width=2)
        self.figure.add_layout(self.cursor)
        if tap:
            self.figure.on_event(Tap, lambda event: tap(float(event.x)))
        self.panel = pn.pane.Bokeh(self.figure, sizing_mode="stretch_width")

    def mark(self, name: str, shape: str, colour: str, size: int = 9) -> None:
        """Marks beside the curves, none at first; see ``put_marks``."""
        source = figures.source(x=[], y=[])
        drawn = self.figure.scatter("x", "y", source=source, marker=shape, size=size, color=colour, fill_alpha=0.2)
        item = LegendItem(label=name, renderers=[drawn], visible=False)
        self.legend.items = [*self.legend.items, item]
        self.marks[name] = source, item
        figures.hover(self.figure, [drawn], [("", name), ("", "($x, $y)")])

    def put_marks(self, name: str, x: Any, y: Any) -> None:
        """Marks in place of those of that name; the legend names them where there are any."""
        source, item = self.marks[name]
        figures.put(source, {"x": np.asarray(x, dtype=float), "y": np.asarray(y, dtype=float)})
        item.visible = len(source.data["x"]) > 0
        self._make_room()

    def fill(self, areas: Sequence[tuple[Any, Any]]) -> None:
        """Areas (x, y) under the curves, in place of those that are."""
        figures.put_rows(self.areas, [(np.asarray(x), np.asarray(y)) for x, y in areas])

    def set(
        self, curves: Sequence[Curve], *, x: str = "", y: str = "", title: str = "", cursor: float | None = None
    ) -> None:
        """At most ``MOST`` curves; labels that are given replace the old ones."""
        rows = []
        for k, one in enumerate(curves[:MOST]):
            usual = figures.look(k)
            colour, dash = one.colour or usual["line_color"], one.dash or usual["line_dash"]
            rows.append((np.asarray(one.x, dtype=float), np.asarray(one.y, dtype=float), colour, dash, 2.0, one.name))
        figures.put_rows(self.source, rows)
        self._make_room()
        self.cursor.location = cursor
        if x:
            self.figure.xaxis.axis_label = x
        if y:
            self.figure.yaxis.axis_label = y
        if title:
            self.title(title)

    def title(self, text: str) -> None:
        """Words above the figure, in lines that it holds."""
        self.words = text
        self.figure.title.text = "\n".join(textwrap.wrap(text, NARROW if self.is_narrow else WIDE))

    def _make_room(self) -> None:
        """Rows of the legend below the picture, which keeps its height and holds every name."""
        names = [*self.source.data["name"], *(name for name, (_, item) in self.marks.items() if item.visible)]
        columns = (
            1 if self.is_narrow else next(n for n in range(IN_A_ROW, 0, -1) if n == 1 or _width(names, n) <= PLACE)
        )
        self.legend.ncols = columns
        rows, usual = (-(-len(names) // n) for n in (columns, IN_A_ROW))
        self.figure.height = self.height + ROW * (rows - usual)

    def narrow(self, narrow: bool) -> None:
        """Half of the page, or all of it."""
        self.is_narrow = narrow
        self._make_room()
        self.title(self.words)


def _width(names: Sequence[str], columns: int) -> float:
    """Pixels of a legend, which is filled column by column."""
    rows = -(-len(names) // columns)
    return sum(KEY + LETTER * max(map(len, names[k : k + rows])) for k in range(0, len(names), max(rows, 1)))
