"""Pictures drawn by Bokeh for the browser: the same palette, dashes, marks and ends of axes as in files.

What a figure holds is replaced in place, and only where it differs, so that the browser draws again what has changed
and nothing else. No script is written: everything is data of Bokeh's own models.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from textwrap import wrap
from typing import Any

import numpy as np
from bokeh.models import (
    Arrow,
    BasicTicker,
    BasicTickFormatter,
    ColorBar,
    ColumnDataSource,
    FixedTicker,
    HoverTool,
    Legend,
    LegendItem,
    LinearAxis,
    LinearColorMapper,
    LogColorMapper,
    LogTicker,
    Range1d,
    VeeHead,
)
from bokeh.plotting import figure
from bokeh.plotting.contour import contour_data

from trunnion.arrays import Array
from trunnion.pictures import picture as described
from trunnion.pictures.looks import INK, PALETTES, WHITE, Look, lone, look
from trunnion.pictures.picture import MARGIN, Axis, Panel, Picture, columns, edges, runs, spread

PIXELS, POINT = 74, 4 / 3
"""Pixels of an inch of a picture's height, and of a point."""
HATCHES = {
    "": " ", "/": "right_diagonal_line", "x": "diagonal_cross", ".": "dot", "|": "vertical_line",
    "-": "horizontal_line", "\\": "left_diagonal_line",
}  # fmt: skip
MARKERS = {"cross": "x", "": "circle"}
"""Those that have another name here."""
NUMBERS = BasicTickFormatter(power_limit_high=7, power_limit_low=-4)
IN_A_ROW, ROW = 3, 24
"""Most names in a row of the legend, and its height in pixels."""
LOW = 240
"""Pixels of height up to which a picture has no room for buttons; it still answers the pointer."""
KEYS = 32
"""Rows for entries of the legend at first."""
PLACE, KEY = 62.0, 6.0
"""Letters of a row of the legend in the narrowest page, and the room of the line before a name."""
WIDE, NARROW = 40, 34
"""Letters of a title, or of a name in the legend, in one line of the narrowest page, and of one that has half of it."""
SHARE, LETTER = 0.66, 7.5
"""Share of a picture's height beside which the words of its axis stand, and the pixels of a letter of them."""
FINE = 400
"""Cells across into which a mesh is cut whose points are not evenly apart."""
SHADES = 256
FEW = 12
"""Marks along a curve that has them at a few of its points."""

_LINE = ("xs", "ys", "colour", "dash", "width", "says")
_AREA = ("fill", "opacity", "edge", "width", "hatch", "says")
_MARK = ("x", "y", "marker", "size", "fill", "opacity", "edge", "width", "says")
COLUMNS = {
    "mesh": ("image", "says", "x", "y", "dw", "dh"),
    "upright strips": ("low", "high", *_AREA), "level strips": ("low", "high", *_AREA),
    "areas": ("xs", "ys", *_AREA), "bars": ("left", "right", "bottom", "top", *_AREA),
    "upright lines": ("at", *_LINE[2:]), "level lines": ("at", *_LINE[2:]),
    "lines": _LINE, "right lines": _LINE, "marks": _MARK, "arrows": ("x0", "y0", "x1", "y1", "colour"),
    "words": ("x", "y", "text", "colour", "align", "baseline", "dx", "dy", "angle", "ground"),
    "keys": ("x", "y", "xs", "ys", "colour", "dash", "line", "marker", "size", *_AREA),
}  # fmt: skip
"""What a figure draws, by kind, in the order in which it lies upon one another."""


def height_of(picture: Picture) -> int:
    """Pixels of a panel, without the rows of its legend beyond the first."""
    return int(PIXELS * picture.height / -(-len(picture.panels) // picture.columns))


class Drawn:
    """One panel as a figure. ``show`` replaces what it holds by that of another panel of the same ``kind_of``.

    Polar panels are drawn over the angle, as there are no polar axes.
    """

    def __init__(self, panel: Panel, height: int = 320, name: str = "") -> None:
        self.kind, self.is_narrow = self.kind_of(panel, height), False
        ranges = {"match_aspect": True} if panel.even else {"x_range": Range1d(0, 1), "y_range": Range1d(0, 1)}
        self.figure = figure(
            height=height, sizing_mode="stretch_width", tools="pan,wheel_zoom,box_zoom,reset", active_scroll=None,
            toolbar_location="right" if height > LOW else None,
            x_axis_type="log" if panel.x.scale == "log" else "linear",
            y_axis_type="log" if panel.y.scale == "log" else "linear", **ranges,
        )  # fmt: skip
        self.figure.toolbar.logo = None
        for axis in self.figure.axis:
            _plain(axis)
        self.ends: dict[str, tuple[float, float]] = {}
        self.entries: list[tuple[str, str, str]] = []
        self.most = {"words": 0, "keys": KEYS}
        self.words = ""
        self.sources = {kind: ColumnDataSource({one: [] for one in names}) for kind, names in COLUMNS.items()}
        for kind, source in self.sources.items():
            source.name = f"{name}-{kind}" if name else None
        self._glyphs(panel)
        self.show(panel, height)

    @staticmethod
    def kind_of(panel: Panel, height: int) -> tuple[Any, ...]:
        """Kinds of axes and colours of a panel, and whether it has buttons, which cannot be replaced in place."""
        named = [bool(axis.names or axis.ticks) for axis in (panel.x, panel.y)]
        ends = (panel.right is not None, panel.even, height > LOW)
        return panel.x.scale, panel.y.scale, *named, _logarithmic(panel), *ends

    def show(self, panel: Panel, height: int) -> None:
        """Replace what the figure holds, where it differs; ``height`` in pixels without further rows of the legend."""
        self.height = height
        self.aside = max((len(line) for name in panel.y.names for line in name.split("\n")), default=0)
        rows = self._rows(panel)
        for kind, names in COLUMNS.items():
            put(self.sources[kind], {one: [row[k] for row in rows[kind]] for k, one in enumerate(names)})
        self._axes(panel)
        self._colours(panel)
        self._title(panel.title or panel.remark)
        self._legend(panel)

    @property
    def names(self) -> list[str]:
        """What the legend names."""
        return [item.label["value"] for item in self.legend.items if item.visible]

    def narrow(self, narrow: bool) -> None:
        """Half of the page, or all of it."""
        self.is_narrow = narrow
        self._fit()

    # -- made once ----------------------------------------------------------------------------------------------------

    def _glyphs(self, panel: Panel) -> None:
        made, source = self.figure, self.sources
        area = {
            "fill_color": "fill", "fill_alpha": "opacity", "line_color": "edge", "line_width": "width",
            "hatch_pattern": "hatch", "hatch_color": "edge", "hatch_alpha": 0.6,
        }  # fmt: skip
        line = {"line_color": "colour", "line_dash": "dash", "line_width": "width"}
        mark = {
            "marker": "marker", "size": "size", "fill_color": "fill", "fill_alpha": "opacity", "line_color": "edge",
            "line_width": "width",
        }  # fmt: skip
        self.mapper = _mapper(panel)
        box = ("x", "y", "dw", "dh")
        mesh = made.image("image", *box, source=source["mesh"], color_mapper=self.mapper)
        made.vstrip("low", "high", source=source["upright strips"], **area)
        made.hstrip("low", "high", source=source["level strips"], **area)
        areas = made.patches("xs", "ys", source=source["areas"], **area)
        bars = made.quad("left", "right", "top", "bottom", source=source["bars"], **area)
        upright = made.vspan("at", source=source["upright lines"], **line)
        level = made.hspan("at", source=source["level lines"], **line)
        lines = [made.multi_line("xs", "ys", source=source["lines"], **line)]
        if panel.right is not None:
            made.extra_y_ranges = {"right": Range1d(0, 1)}
            made.add_layout(_plain(LinearAxis(y_range_name="right")), "right")
            lines.append(made.multi_line("xs", "ys", source=source["right lines"], y_range_name="right", **line))
        marks = made.scatter("x", "y", source=source["marks"], **mark)
        made.add_layout(
            Arrow(source=source["arrows"], x_start="x0", y_start="y0", x_end="x1", y_end="y1", line_color="colour",
                  end=VeeHead(size=7, fill_color="colour", line_color="colour"))
        )  # fmt: skip
        made.text(
            "x", "y", "text", source=source["words"], text_color="colour", text_align="align",
            text_baseline="baseline", x_offset="dx", y_offset="dy", angle="angle", text_font_size="12px",
            background_fill_color="ground", background_fill_alpha=0.8, padding=1,
        )  # fmt: skip
        keys = {"line_color": "colour", "line_dash": "dash", "line_width": "line"}
        self.key_glyphs = {
            "area": made.patches("xs", "ys", source=source["keys"], **area),
            "line": made.multi_line("xs", "ys", source=source["keys"], **keys),
            "mark": made.scatter("x", "y", source=source["keys"], **mark),
        }
        for drawn, tips in (
            ([mesh], [("", "@says{0.000}")]), ([areas, bars, upright, level], [("", "@says")]),
            (lines, [("", "@says"), ("", "($x, $y)")]), ([marks], [("", "@says"), ("", "(@x, @y)")]),
        ):  # fmt: skip
            made.add_tools(HoverTool(renderers=drawn, tooltips=tips, line_policy="interp"))
        self.legend = Legend(
            items=[], ncols=IN_A_ROW, location="top_left", label_text_font_size="12px", spacing=8, margin=2, padding=2,
            border_line_color=None, title_text_font_size="12px",
        )  # fmt: skip
        made.add_layout(self.legend, "below")
        self.bar = ColorBar(color_mapper=self.mapper, width=14, padding=4, title_text_font_style="normal")
        made.add_layout(self.bar, "right")

    # -- what is shown ------------------------------------------------------------------------------------------------

    def _rows(self, panel: Panel) -> dict[str, list[tuple[Any, ...]]]:
        """Rows of every source."""
        rows: dict[str, list[tuple[Any, ...]]] = defaultdict(list)
        for item in panel.items:
            for kind, row in _ROWS[type(item)](item, panel):
                rows[kind].append(row)
        rows["right lines"] = [row for item in panel.right_items for _, row in _line(item, panel)]
        if panel.even:  # what is shown follows from what is drawn
            ends = [(axis.low, axis.high) for axis in (panel.x, panel.y)]
            corners = [corner for corner in zip(*ends, strict=True) if None not in corner]
            rows["words"] += [(x, y, "", INK, "left", "middle", 0, 0, 0.0, WHITE) for x, y in corners]
        self.entries = list({name: (role, name, kind) for role, name, kind in _entries(panel)}.values())
        rows["keys"] = [_key(role, kind) for role, _, kind in self.entries]
        for kind, spare in _SPARE.items():
            self.most[kind] = max(self.most[kind], len(rows[kind]))
            rows[kind] += [spare] * (self.most[kind] - len(rows[kind]))
        return rows

    def _axes(self, panel: Panel) -> None:
        made = self.figure
        for name, axis, own in (("x", panel.x, made.xaxis[0]), ("y", panel.y, made.yaxis[0])):
            letters = int(self.height * SHARE / LETTER) if name == "y" else WIDE
            _update(own, axis_label="\n".join(wrap(axis.label, letters)) or None, visible=panel.frame)
            _ticks(own, axis)
            if not panel.even:
                self._range(name, getattr(made, f"{name}_range"), extent(axis, *_shown(panel.items, name)))
        for grid, name in ((made.xgrid[0], "x"), (made.ygrid[0], "y")):
            _update(grid, visible=panel.frame and panel.grid in ("both", name), grid_line_color="#e3e6ea")
        made.outline_line_color = "#e5e5e5" if panel.frame else None
        if panel.right is not None:
            _update(made.yaxis[1], axis_label=panel.right.label)
            self._range("right", made.extra_y_ranges["right"], extent(panel.right, *_shown(panel.right_items, "y")))

    def _range(self, name: str, own: Any, ends: tuple[float, float]) -> None:
        """New ends of an axis, where they are others than before: else a part that was zoomed into stays."""
        if self.ends.get(name) != ends:
            self.ends[name] = ends
            own.update(start=ends[0], end=ends[1], reset_start=ends[0], reset_end=ends[1])

    def _colours(self, panel: Panel) -> None:
        meshes = [item for item in panel.items if isinstance(item, described.ColouredGrid)]
        _update(self.bar, visible=bool(meshes))
        for colours in (mesh.colours for mesh in meshes):
            _update(self.mapper, low=colours.low, high=colours.high, palette=palette(colours))
            _update(self.bar, title=colours.words)

    def _title(self, text: str) -> None:
        self.words = text
        self.figure.name = text
        self._fit()

    def _legend(self, panel: Panel) -> None:
        """Every name once. Entries stay, hidden where there is nothing to say: a document walks through all that stands
        on its page whenever a model comes or goes."""
        entries = [] if not panel.key else self.entries
        made = list(self.legend.items)
        for k, (_, name, kind) in enumerate(entries):
            words, parts = "\n".join(wrap(name, WIDE)), [self.key_glyphs[part] for part in _parts(kind)]
            if k == len(made):
                made.append(LegendItem(label={"value": words}, index=k, renderers=parts))
            elif made[k].label["value"] != words:
                made[k].label = {"value": words}
            _update(made[k], renderers=parts, visible=True)
        for item in made[len(entries) :]:
            _update(item, visible=False)
        if len(made) > len(self.legend.items):
            self.legend.items = made
        _update(self.legend, title=panel.key_title or None)
        self._fit()

    def _fit(self) -> None:
        """Rows of the legend below the picture, which keeps its height and holds every name; lines of the title."""
        names = self.names
        across = 1 if self.is_narrow else min(columns(names, PLACE - self.aside, KEY), IN_A_ROW)
        high = [max(name.count("\n") for name in names[k : k + across]) for k in range(0, len(names), across)]
        rows = len(high) + bool(self.legend.title)
        letters = NARROW if self.is_narrow else WIDE
        lines = [line for part in self.words.split("\n") for line in wrap(part, letters)]
        _update(self.legend, ncols=across, visible=bool(names))
        _update(self.figure, height=self.height + ROW * max(rows - 1, 0) + 16 * (sum(high) + max(len(lines) - 1, 0)))
        _update(self.figure.title, text="\n".join(lines))
        if isinstance(self.figure.xaxis[0].ticker, BasicTicker):
            _update(self.figure.xaxis[0].ticker, desired_num_ticks=3 if self.is_narrow else 6)


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


def _update(model: Any, **values: Any) -> None:
    """Values of a model, those that differ."""
    changed = {key: value for key, value in values.items() if getattr(model, key) != value}
    if changed:
        model.update(**changed)


def palette(colours: described.Colours) -> list[str]:
    """Colours from the low end to the high one, or one between every two levels."""
    given = np.array([[int(one[k : k + 2], 16) for k in (1, 3, 5)] for one in PALETTES[colours.palette]], dtype=float)
    count = len(colours.levels) - 1 if colours.levels else SHADES
    place = (np.arange(count) + 0.5) / count
    if colours.scale == "zero":
        value = colours.low + place * (colours.high - colours.low)
        place = np.where(value < 0, 0.5 - 0.5 * value / colours.low, 0.5 + 0.5 * value / colours.high)
    at = np.linspace(0, 1, len(given))
    mixed = np.stack([np.interp(place, at, given[:, k]) for k in range(3)], axis=1).round().astype(int)
    return [f"#{r:02x}{g:02x}{b:02x}" for r, g, b in mixed.tolist()]


def extent(axis: Axis, low: float, high: float) -> tuple[float, float]:
    """Ends of an axis in its own spacing: those that are stated, else those of what is shown, with a margin."""
    ends = [None if end is None else float(_spaced(axis, end)) for end in (axis.low, axis.high)]
    if not (np.isfinite(low) and np.isfinite(high)):
        low, high = (1.0, 10.0) if axis.scale == "log" else (0.0, 1.0)
    inner = np.log10([low, high]) if axis.scale == "log" else np.array([low, high])
    room = MARGIN * float(inner[1] - inner[0]) or 0.5
    outer = inner + [-room, room]
    found = 10**outer if axis.scale == "log" else outer
    return tuple(float(found[k]) if end is None else end for k, end in enumerate(ends))  # type: ignore[return-value]


def _logarithmic(panel: Panel) -> bool:
    """Whether colours stand for powers of ten."""
    return any(isinstance(item, described.ColouredGrid) and item.colours.scale == "log" for item in panel.items)


def _mapper(panel: Panel) -> Any:
    """How values of a mesh become colours."""
    kind = LogColorMapper if _logarithmic(panel) else LinearColorMapper
    return kind(palette=[WHITE], low=1, high=2, nan_color="rgba(0, 0, 0, 0)")


def _plain(axis: Any) -> Any:
    axis.update(
        axis_label_text_font_style="normal", axis_label_text_font_size="14px", major_label_text_font_size="13px",
        formatter=NUMBERS.clone(),
    )  # fmt: skip
    return axis


def _ticks(own: Any, axis: Axis) -> None:
    """Where ticks stand, and what stands at them."""
    if axis.names or axis.ticks:
        places = [float(_spaced(axis, at)) for at in axis.ticks or range(len(axis.names))]
        if not isinstance(own.ticker, FixedTicker):
            own.ticker = FixedTicker(ticks=places)
        _update(own.ticker, ticks=places)
        names = dict(zip(places, axis.names, strict=False)) if axis.names else {}
        _update(own, major_label_overrides=names)
    elif isinstance(own.ticker, LogTicker):
        _update(own.ticker, mantissas=[1, 2, 5])


def _spaced(axis: Axis, values: Any) -> Array:
    """Values where they stand: as they are, or spaced as Bokeh's axes cannot."""
    return axis.scaled(values) if axis.scale == "symlog" else np.asarray(values, dtype=float)


def _shown(items: Sequence[Any], name: str) -> tuple[float, float]:
    """The least and the greatest value of items along an axis."""
    found = [np.asarray(one, dtype=float).ravel() for item in items for one in _values(item, name)]
    every = np.concatenate(found) if found else np.zeros(0)
    every = every[np.isfinite(every)]
    return (float(every.min()), float(every.max())) if every.size else (np.nan, np.nan)


def _values(item: Any, name: str) -> list[Any]:
    """What an item shows along an axis."""
    match item:
        case described.Line() | described.Points():
            return [getattr(item, name)]
        case described.Band():
            return [item.x] if name == "x" else [item.low, item.high]
        case described.Shapes():
            return [outline[:, "xy".index(name)] for outline in item.outlines]
        case described.ColouredGrid() | described.Cells():
            return [edges(np.asarray(getattr(item, name), dtype=float))]
        case described.Bars():
            at = np.asarray(item.at, dtype=float)
            wide = [at - item.thick / 2, at + item.thick / 2]
            return wide if (name == "y") == item.lie else [item.size, [0.0]]
        case described.Level() | described.Spans():
            return [item.value if isinstance(item, described.Level) else item.ends] if item.on == name else []
    return []


def _entries(panel: Panel) -> list[tuple[str, str, str]]:
    """Role, name and kind of everything that the legend names, in order."""
    kinds = {described.Points: "mark", described.Line: "line", described.Level: "line", described.Arrows: "line"}
    found = []
    every: list[Any] = [*panel.items, *panel.right_items]
    for item in every:
        if name := getattr(item, "name", ""):
            kind = item.kind if isinstance(item, described.Key) else kinds.get(type(item), "area")
            if isinstance(item, described.Line) and np.isfinite(np.asarray(item.x) + np.asarray(item.y)).sum() == 1:
                kind = "lone mark"
            elif kind == "line" and look(item.role).marker:
                kind = "marked line"
            found.append((item.role, name, kind))
    return found


def _parts(kind: str) -> list[str]:
    """Which glyphs make an entry of the legend."""
    return ["line", "mark"] if kind == "marked line" else ["mark"] if kind == "lone mark" else [kind]


def _key(role: str, kind: str) -> tuple[Any, ...]:
    """An entry of the legend, which stands nowhere in the picture."""
    one = lone(role) if kind == "lone mark" else look(role)
    nowhere = [np.nan, np.nan]
    area = _area(one, "")
    if kind == "area":
        area = (*area[:2], area[2] if one.width or one.hatch else INK, 1.0, *area[4:])
    elif "mark" in kind:
        area = _mark(one, "")[2:]
    size = POINT * max(min(one.size, 9.0), 3.4)
    return np.nan, np.nan, nowhere, nowhere, one.colour, _dash(one), POINT * one.width, _marker(one), size, *area


def _dash(one: Look) -> str:
    """On and off in pixels."""
    return " ".join(str(max(round(part * one.width * POINT), 1)) for part in one.dash) or "solid"


def _marker(one: Look) -> str:
    return MARKERS.get(one.marker, one.marker)


def _stroke(one: Look, says: str) -> tuple[Any, ...]:
    return one.colour, _dash(one), POINT * one.width, says


def _area(one: Look, says: str) -> tuple[Any, ...]:
    opacity, hatch = (one.opacity if one.inside else 0.0), HATCHES[one.hatch[:1]]
    return one.inside or WHITE, opacity, one.colour, POINT * one.width, hatch, says


def _mark(one: Look, says: str) -> tuple[Any, ...]:
    """Marker and size, then as of an area without a hatch."""
    fill, opacity, edge, width, hatch, said = _area(one, says)
    return _marker(one), POINT * one.size, fill, opacity, edge, width, hatch, said


def _says(item: Any, k: Any = 0) -> str:
    """What the pointer shows: what the item says of its k-th part, its name, or what it is."""
    said = getattr(item, "says", "")
    said = (said[k] if len(said) > k else "") if not isinstance(said, str) else said
    return str(said or item.name or item.role.rstrip(" 0123456789"))


def _xy(panel: Panel, x: Any, y: Any) -> tuple[Array, Array]:
    return _spaced(panel.x, x), _spaced(panel.y, y)


def _line(item: described.Line, panel: Panel) -> list[tuple[str, tuple[Any, ...]]]:
    one, (x, y) = look(item.role), _xy(panel, item.x, item.y)
    rows: list[tuple[str, tuple[Any, ...]]] = [("lines", (x, y, *_stroke(one, _says(item))))]
    known = np.flatnonzero(np.isfinite(x + y))
    if len(known) == 1:
        return [("marks", _at(x[known[0]], y[known[0]], lone(item.role), _says(item)))]
    if one.marker:
        few = known if one.every else known[:: max(len(known) // FEW, 1)]
        rows += [("marks", _at(x[k], y[k], one, _says(item))) for k in few]
    return rows


def _at(x: float, y: float, one: Look, says: str, size: float | None = None) -> tuple[Any, ...]:
    marker, usual, fill, opacity, edge, width, _, said = _mark(one, says)
    return float(x), float(y), marker, usual if size is None else POINT * float(size), fill, opacity, edge, width, said


def _points(item: described.Points, panel: Panel) -> list[tuple[str, tuple[Any, ...]]]:
    one, (x, y) = look(item.role), _xy(panel, item.x, item.y)
    sizes = [None] * len(x) if item.sizes is None else item.sizes
    return [("marks", _at(x[k], y[k], one, _says(item, k), sizes[k])) for k in np.flatnonzero(np.isfinite(x + y))]


def _level(item: described.Level, panel: Panel) -> list[tuple[str, tuple[Any, ...]]]:
    kind = "level lines" if item.on == "y" else "upright lines"
    return [(kind, (float(_spaced(panel.axis(item.on), item.value)), *_stroke(look(item.role), _says(item))))]


def _spans(item: described.Spans, panel: Panel) -> list[tuple[str, tuple[Any, ...]]]:
    kind = "level strips" if item.on == "y" else "upright strips"
    ends = _spaced(panel.axis(item.on), item.ends).tolist()
    return [(kind, (low, high, *_area(look(item.role), _says(item)))) for low, high in ends]


def _band(item: described.Band, panel: Panel) -> list[tuple[str, tuple[Any, ...]]]:
    x, low = _xy(panel, item.x, item.low)
    _, high = _xy(panel, item.x, item.high)
    known = np.isfinite(x + low + high)
    outline = np.concatenate([x[known], x[known][::-1]]), np.concatenate([low[known], high[known][::-1]])
    return [("areas", (*outline, *_area(look(item.role), _says(item))))]


def _shapes(item: described.Shapes, panel: Panel) -> list[tuple[str, tuple[Any, ...]]]:
    one = look(item.role)
    return [
        ("areas", (*_xy(panel, outline[:, 0], outline[:, 1]), *_area(one, _says(item, k))))
        for k, outline in enumerate(item.outlines)
    ]


def _bars(item: described.Bars, panel: Panel) -> list[tuple[str, tuple[Any, ...]]]:
    one, rows = look(item.role), []
    along = panel.x if item.lie else panel.y
    base = along.low if along.scale == "log" and along.low else 0.0
    for k, (at, size) in enumerate(zip(item.at, np.asarray(item.size, dtype=float), strict=True)):
        side, length = (at - item.thick / 2, at + item.thick / 2), sorted((base, float(size)))
        box = (*length, *side) if item.lie else (*side, *length)
        said = f"{_says(item, k)} {float(size):.4g}".strip() if not item.says else _says(item, k)
        rows.append(("bars", (*map(float, box), *_area(one, said))))
    return rows


def _words(item: described.Texts, panel: Panel) -> list[tuple[str, tuple[Any, ...]]]:
    one, beside = look(item.role), item.beside.split()
    align = "right" if "left" in beside else "left" if "right" in beside else "center"
    baseline = "bottom" if "above" in beside else "top" if "below" in beside else "middle"
    dx = -6 if align == "right" else 6 if align == "left" else 0
    dy = -4 if baseline == "bottom" else 4 if baseline == "top" else 0
    x, y = np.asarray(item.x, dtype=float), np.asarray(item.y, dtype=float)
    if item.inside:
        x, y = (_inside(panel, name, share) for name, share in (("x", x), ("y", y)))
    x, y = _xy(panel, x, y)
    ground = one.face or "rgba(0, 0, 0, 0)"
    texts = zip(x.tolist(), y.tolist(), item.texts, strict=True)
    return [("words", (a, b, text, one.colour, align, baseline, dx, dy, 0.0, ground)) for a, b, text in texts if text]


def _inside(panel: Panel, name: str, share: Array) -> Array:
    """Numbers of an axis at shares of its length."""
    low, high = extent(panel.axis(name), *_shown(panel.items, name))
    if panel.axis(name).scale == "log":
        return np.asarray(low * (high / low) ** share)
    return np.asarray(low + share * (high - low))


def _edge_names(item: described.EdgeNames, panel: Panel) -> list[tuple[str, tuple[Any, ...]]]:
    """Names inside the frame at its edge, and dotted lines across at what they name."""
    top = item.edge == "top"
    axis, says = (panel.x if top else panel.y), item.says or item.texts
    values = np.asarray(item.values, dtype=float)
    order = np.argsort(values)
    rows: list[tuple[str, tuple[Any, ...]]] = []
    if top:
        for k in order:
            rows.append(("upright lines", (values[k], *_stroke(look("named"), says[k]))))
        return rows
    low, high = extent(axis, *_shown(panel.items, "y"))
    shares = spread((values[order] - low) / (high - low), 0.065)
    x = float(_inside(panel, "x", np.array(1.0)))
    ground = look("boxed words").face
    for k, share in zip(order, shares, strict=True):
        row = (x, float(low + share * (high - low)), item.texts[k], INK, "right", "middle", -4, 0, 0.0, ground)
        rows.append(("words", row))
    return rows


def _cells(item: described.Cells, panel: Panel) -> list[tuple[str, tuple[Any, ...]]]:
    """Cells beside each other in a row as one."""
    one, x, up = look(item.role), np.asarray(item.x, dtype=float), edges(np.asarray(item.y, dtype=float))
    return [
        ("bars", (left, right, float(up[j]), float(up[j + 1]), *_area(one, _says(item))))
        for j, row in enumerate(np.asarray(item.where))
        for left, right in runs(x, row).tolist()
    ]


def _arrows(item: described.Arrows, panel: Panel) -> list[tuple[str, tuple[Any, ...]]]:
    begin, end = (np.stack(_xy(panel, *np.asarray(one, dtype=float).T), axis=1) for one in (item.begin, item.end))
    return [("arrows", (*a, *b, look(item.role).colour)) for a, b in zip(begin.tolist(), end.tolist(), strict=True)]


def _even(axis: Axis, points: Any) -> tuple[Any, float, float]:
    """Of cells evenly apart on an axis: which points they show, where they begin, how long they are together."""
    cut = edges(np.asarray(points, dtype=float))
    spaced = np.log10(cut) if axis.scale == "log" else cut
    steps = np.diff(spaced)
    places = np.arange(len(points))
    if len(points) > 1 and np.ptp(steps) > 1e-6 * np.abs(steps).max():
        count = max(FINE, len(points))
        middles = spaced[0] + (np.arange(count) + 0.5) * (spaced[-1] - spaced[0]) / count
        places = np.clip(np.searchsorted(spaced, middles) - 1, 0, len(points) - 1)
    return places, float(cut[0]), float(cut[-1] - cut[0])


def _mesh(item: described.ColouredGrid, panel: Panel) -> list[tuple[str, tuple[Any, ...]]]:
    """An image, and lines at the levels of its colours that have some."""
    (across, x, width), (up, y, height) = _even(panel.x, item.x), _even(panel.y, item.y)
    shown = [
        np.asarray(np.ma.filled(one, np.nan), dtype=np.float32)[np.ix_(up, across)]
        for one in (item.values, item.values if item.says is None else item.says)
    ]
    rows: list[tuple[str, tuple[Any, ...]]] = [("mesh", (*shown, x, y, width, height))]
    if levels := list(item.colours.levels):
        values, stroke = np.asarray(item.values, dtype=float), look("contour")
        found: Any = contour_data(item.x, item.y, values, levels=levels, want_fill=False).line_data
        rows += [
            ("lines", (*_xy(panel, along, over), *_stroke(stroke, f"{item.colours.words} {level:.4g}")))
            for level, along, over in zip(levels, found.xs, found.ys, strict=True)
        ]
    return rows


_SPARE: dict[str, tuple[Any, ...]] = {
    "words": (np.nan, np.nan, "", INK, "left", "middle", 0, 0, 0.0, WHITE),
    "keys": _key("line", "line"),
}  # fmt: skip
"""Rows that show nothing. Words and keys never become fewer: Bokeh measures texts, and draws entries of legends, by the
number of rows before."""
_ROWS: dict[type, Any] = {
    described.Line: _line,
    described.Points: _points,
    described.Level: _level,
    described.Spans: _spans,
    described.Band: _band,
    described.Shapes: _shapes,
    described.Bars: _bars,
    described.ColouredGrid: _mesh,
    described.Cells: _cells,
    described.Texts: _words,
    described.EdgeNames: _edge_names,
    described.Arrows: _arrows,
    described.Key: lambda item, panel: [],
}
