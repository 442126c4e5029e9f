"""Pictures drawn by Matplotlib: for files, reports and notebooks.

Everything is set on the artists themselves: matplotlib's rcParams belong to the user and are not safe between
threads, nor is pyplot, which is not used. A figure is 16 cm wide with 11 pt text, which is still legible when printed
10 cm wide.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from textwrap import fill
from typing import Any, Literal

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import LinearSegmentedColormap, ListedColormap, LogNorm, Normalize, TwoSlopeNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.text import Annotation, Text
from matplotlib.ticker import FixedLocator, LogLocator, MaxNLocator, NullFormatter
from matplotlib.transforms import ScaledTranslation

from trunnion.arrays import Array
from trunnion.pictures import picture as described
from trunnion.pictures.formats import check_format
from trunnion.pictures.literal_figure import LiteralFigure
from trunnion.pictures.looks import FAINT, GRID, INK, PALETTES, Look, lone, look
from trunnion.pictures.numbers import written
from trunnion.pictures.picture import Axis, Panel, Picture, columns, edges, spread
from trunnion.writing import written_whole

TEXT, SMALL, TITLE = 11, 9.5, 12
DPI = 200
MARKERS = {
    "circle": "o", "square": "s", "triangle": "^", "inverted_triangle": "v", "diamond": "D", "plus": "P", "x": "x",
    "cross": "X", "dash": "_", "": "",
}  # fmt: skip
BESIDE: dict[str, Any] = {"pad": 0.02, "fraction": 0.045, "aspect": 28}
"""Place of a colour bar."""
NARROW = 5.5
"""Width of a panel [inches] in which few numbers stand along an axis."""
LEADER = 12
"""Length of the line from an axis to a name beside it [pt]."""
PITCH = 1.45
"""Room for one name, in heights of its text."""
UNDER = 44
"""From the lower edge of a panel to its legend [pt]."""
LETTER, HANDLE = 0.58, 5.0
"""Width of a letter, and of what stands before and behind a name in a legend, in sizes of the text."""
ROWS, ROW = 2, 0.19
"""Rows of names for which a picture has room, and the height of one more [inches]."""
INSET = (0.64, 0.45, 0.34, 0.5)
"""Place of a second panel in axes that were given."""
ARROW = {"arrowstyle": "-|>", "lw": 1.0, "shrinkA": 4, "shrinkB": 2}
LEGEND: dict[str, Any] = {"fontsize": SMALL, "frameon": False, "handlelength": 2.6, "labelcolor": INK}
ANCHORS = {
    "above": ((0, 4), "bottom"), "below": ((0, -3), "top"), "left": ((-4, 0), "right"), "right": ((4, 0), "left")
}  # fmt: skip
"""Shift of words [pt] and how they are aligned."""


def draw(picture: Picture, axes: Axes | None = None) -> Axes:
    """Draw ``picture`` on a figure of its own, or its first panel into ``axes`` and others inset; the first axes."""
    if axes is None:
        figure = new_figure(picture.width, picture.height + _more_rows(picture))
        drawn, width = _grid(figure, picture), picture.width / picture.columns
    else:
        figure, drawn = axes.figure.figure, [axes, *(axes.inset_axes(INSET) for _ in picture.panels[1:])]
        width = figure.get_figwidth() * axes.get_position().width / 0.8
    for one, panel in zip(drawn, picture.panels, strict=True):
        _panel(one, panel, width)
    if picture.shared:
        _words_once(drawn, picture)
    if picture.title:
        head(figure, picture.title)
    if picture.x_words:
        figure.supxlabel(picture.x_words, fontsize=TEXT - 1, color=INK)
    for one, panel in zip(drawn, picture.panels, strict=True):
        names = [item for item in panel.items if isinstance(item, described.EdgeNames)]
        if names:
            _edge_names(one, panel, names, width)
    return drawn[0]


def new_figure(width: float, height: float, *, layout: Literal["constrained"] | None = "constrained") -> Figure:
    """A figure [inches] drawn by Agg: no window, no pyplot, safe in threads; its places adapt to its texts."""
    figure = LiteralFigure(figsize=(width, height), layout=layout)
    FigureCanvasAgg(figure)
    return figure


def head(figure: Figure, title: str, size: float = TITLE) -> None:
    """A title at the left, in as many lines as the figure's width asks for."""
    words = _wrapped(title, figure.get_figwidth(), size)
    figure.suptitle(words, fontsize=size, color=INK, x=0.01, ha="left")


def through(axes: Axes, *points: Array, **style: Any) -> None:
    """A line through points of the plane or of space."""
    axes.plot(*np.stack(points, axis=1), **style)


def settle(axes: Axes) -> None:
    """Give the axes of a figure the places that they will have, for what is fitted to the room there is."""
    figure = axes.figure.figure
    if isinstance(figure, LiteralFigure):
        figure.settle()
    else:
        figure.draw_without_rendering()


def save(figure: Figure, path: str | os.PathLike[str]) -> None:
    """Write the figure; an existing file is replaced only when all is written."""
    ending = check_format(path)
    with written_whole(path) as temporary:
        figure.savefig(temporary, format=ending, dpi=DPI)


# -- panels -----------------------------------------------------------------------------------------------------------


def _grid(figure: Figure, picture: Picture) -> list[Axes]:
    """Axes for every panel, row by row."""
    rows = -(-len(picture.panels) // picture.columns)
    ratios = {"height_ratios": picture.heights} if picture.heights else {}
    grid = figure.add_gridspec(rows, picture.columns, **ratios)
    made: list[Axes] = []
    for k, panel in enumerate(picture.panels):
        shared: dict[str, Any] = {"sharex": made[0]} if picture.shared and made else {}
        if panel.polar:
            shared = {"projection": "polar"}
        made.append(figure.add_subplot(grid[k // picture.columns, k % picture.columns], **shared))
    return made


def _words_once(drawn: Sequence[Axes], picture: Picture) -> None:
    """Numbers and words of common axes at the outer panels alone."""
    for k, (axes, panel) in enumerate(zip(drawn, picture.panels, strict=True)):
        if k + picture.columns < len(drawn):
            axes.tick_params(labelbottom=False)
            axes.set_xlabel("")
        if k % picture.columns and panel.y == picture.panel.y:
            axes.tick_params(labelleft=False)


def _panel(axes: Axes, panel: Panel, width: float) -> None:
    if not panel.frame:
        axes.set_axis_off()
    _scale(axes, panel)
    handles = [handle for item in panel.items for handle in _ITEMS[type(item)](axes, item, panel)]
    _axis(axes, "x", panel, width)
    _axis(axes, "y", panel, width)
    if panel.polar:
        _polar(axes)
    else:
        if panel.grid:
            axes.grid(which="major", axis=panel.grid, color=GRID, lw=0.6)  # type: ignore[arg-type]
        meshed = any(isinstance(item, described.ColouredGrid | described.Cells) for item in panel.items)
        axes.set_axisbelow(not meshed)
    if panel.even:
        axes.set_aspect("equal", adjustable="datalim" if panel.frame else "box")
    for spine in axes.spines.values():
        spine.set_color(INK)
    if panel.right is not None:
        _right(axes, panel)
    _titles(axes, panel, width)
    if handles and panel.key:
        _legend(axes, panel, handles, width)


def _scale(axes: Axes, panel: Panel) -> None:
    """Scales before anything is drawn, which some of it follows."""
    for name in "xy":
        axis = panel.axis(name)
        if axis.scale == "log":
            getattr(axes, f"set_{name}scale")("log")
        elif axis.scale == "symlog":
            getattr(axes, f"set_{name}scale")("symlog", linthresh=described.EVEN, linscale=described.WIDE)


def _axis(axes: Axes, name: str, panel: Panel, width: float) -> None:
    """Ends, ticks, numbers and words of one axis."""
    axis, own = panel.axis(name), axes.xaxis if name == "x" else axes.yaxis
    if panel.polar and name == "x":
        return
    low, high = axis.low, axis.high
    if low is not None or high is not None:
        axes.set_xlim(low, high) if name == "x" else axes.set_ylim(low, high)
    own.set_label_text(axis.label, fontsize=TEXT, color=INK, parse_math=False)
    own.set_tick_params(labelsize=SMALL if axis.names else TEXT, colors=INK, direction="out")
    few = name == "x" and (width < NARROW or bool(panel.y.names))
    _ticks(own, axis, few)


def _ticks(own: Any, axis: Axis, few: bool) -> None:
    """Where ticks stand, and what stands at them."""
    if axis.names:
        places = axis.ticks or range(len(axis.names))
        own.set_ticks(list(places), labels=list(axis.names))
        for label in own.get_ticklabels():
            label.set_parse_math(False)
    elif axis.ticks:
        own.set_major_locator(FixedLocator(list(axis.ticks)))
    elif axis.scale == "log":
        own.set_major_formatter(lambda value, _: written(value))
        own.set_minor_formatter(NullFormatter())
        low, high = own.get_view_interval()
        if high < 1e3 * low:
            own.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    else:
        own.get_major_formatter().set_useOffset(False)
        if few:
            own.set_major_locator(MaxNLocator(5, steps=[1, 2, 2.5, 5, 10]))
    if axis.names or axis.scale == "symlog":
        own.set_ticks([], minor=True)


def _polar(axes: Any) -> None:
    """A turn from the right, numbers along a ray that stay readable where curves cross them."""
    axes.tick_params(labelsize=SMALL, colors=INK)
    axes.set_rlabel_position(22.5)
    axes.set_anchor("N")  # what is free stands below the legend
    axes.set_axisbelow(False)
    axes.yaxis.set_major_locator(MaxNLocator(4))
    axes.grid(True, color="#cccccc", linewidth=0.6)
    axes.title.set_text(axes.yaxis.label.get_text())
    axes.title.set(fontsize=TEXT, color=INK, parse_math=False)
    axes.yaxis.label.set_text("")
    for text in axes.get_yticklabels():
        text.set_color(FAINT)
        text.set_bbox({"facecolor": "#ffffff", "edgecolor": "none", "alpha": 0.7, "pad": 0.6})


def _right(axes: Axes, panel: Panel) -> None:
    """A second vertical axis; words at both take the colour of what they are of."""
    assert panel.right is not None
    beside = axes.twinx()
    inner = Panel(panel.x, panel.right, panel.right_items)
    for item in panel.right_items:
        _ITEMS[type(item)](beside, item, inner)
    if panel.right.low is not None:
        beside.set_ylim(panel.right.low, panel.right.high)
    beside.tick_params(labelsize=TEXT, colors=INK, direction="out")
    beside.set_ylabel(panel.right.label, fontsize=TEXT, parse_math=False)
    for one, items in ((axes, panel.items), (beside, panel.right_items)):
        if len(items) == 1 and isinstance(items[0], described.Line):
            one.yaxis.label.set_color(look(items[0].role).colour)


def _titles(axes: Axes, panel: Panel, width: float, room: float = 0.0) -> None:
    """Words above a panel, over ``room`` [pt] for what stands there."""
    words, size, colour = (panel.title, TEXT, INK) if panel.title else (panel.remark, SMALL, FAINT)
    if words:
        pad = room + (10 if room else 6)
        place: dict[str, Any] = {"loc": "left", "pad": pad, "linespacing": 1.3, "parse_math": False}
        axes.set_title(_wrapped(words, width, size), fontsize=size, color=colour, **place)


def _wrapped(words: str, width: float, size: float) -> str:
    """Words in as many lines as a width [inches] asks for."""
    letters = max(int(72 * width / (0.56 * size)), 16)
    return "\n".join(fill(part, letters) for part in words.split("\n")).replace(described.UNBROKEN, " ")


# -- legends ----------------------------------------------------------------------------------------------------------


def _legend(axes: Axes, panel: Panel, handles: Sequence[Artist], width: float) -> None:
    """Every name once, where the panel says; as many columns as fit."""
    once = list({str(handle.get_label()): handle for handle in handles}.values())
    style: dict[str, Any] = {**LEGEND, "handles": once}
    if panel.key_title:
        style |= {"title": panel.key_title, "title_fontsize": SMALL, "alignment": "left"}
    figure = axes.figure.figure
    if panel.key in ("left", "right", "centre"):
        count, side = {"left": 1, "right": 2, "centre": 4}[panel.key], panel.key.replace("centre", "center")
        legend = figure.legend(**{**style, "loc": f"outside lower {side}", "ncols": count})
    elif panel.key == "inside":
        legend = axes.legend(loc="best", **style)
    elif panel.key == "beside":
        legend = axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), **style)
    else:
        below = axes.transAxes + ScaledTranslation(0, -UNDER / 72, figure.dpi_scale_trans)
        count = _columns([str(one.get_label()) for one in once], width - _aside(panel))
        legend = axes.legend(
            ncols=count, loc="upper left", bbox_to_anchor=(0.0, 0.0), bbox_transform=below, borderpad=0.0,
            borderaxespad=0.0, columnspacing=1.5, **style,
        )  # fmt: skip
    for text in (*legend.get_texts(), legend.get_title()):
        text.set_parse_math(False)
    legend.get_title().set_color(FAINT)


def _aside(panel: Panel) -> float:
    """Room that numbers and names at the left take, and colours at the right [inches]."""
    longest = max((len(line) for name in panel.y.names for line in name.split("\n")), default=0)
    meshed = any(isinstance(item, described.ColouredGrid) for item in panel.items)
    return 0.8 + longest * LETTER * SMALL / 72 + 1.2 * meshed


def _columns(names: Sequence[str], room: float) -> int:
    """Columns of a legend that has so many inches."""
    return columns(names, 72 * room / (SMALL * LETTER), HANDLE / LETTER)


def _more_rows(picture: Picture) -> float:
    """Height of the rows of legends beyond those that there is room for, so that the curves keep theirs [inches]."""
    more = 0.0
    for panel in picture.panels:
        names = list(dict.fromkeys(name for item in panel.items if (name := getattr(item, "name", ""))))
        if panel.key == "below" and names:
            width = picture.width / picture.columns
            lines = -(-len(names) // _columns(names, width - _aside(panel))) + bool(panel.key_title)
            more = max(more, ROW * max(lines - ROWS, 0))
    return more


# -- items ------------------------------------------------------------------------------------------------------------


def _stroke(one: Look) -> dict[str, Any]:
    """A line as matplotlib wants it."""
    dash = (0, one.dash) if one.dash else "-"
    return {"color": one.colour, "linewidth": one.width, "linestyle": dash, "zorder": one.layer}


def _filling(one: Look) -> dict[str, Any]:
    """An area as matplotlib wants it."""
    style = {"facecolor": one.inside or "none", "linewidth": one.width, "zorder": one.layer, "alpha": one.opacity}
    edge = one.colour if one.width or one.hatch else "none"
    return {**style, "edgecolor": edge, "hatch": one.hatch or None}


def _marking(one: Look) -> dict[str, Any]:
    """Marks as matplotlib wants them."""
    style = {"marker": MARKERS[one.marker], "ms": one.size, "mew": one.width, "mec": one.colour}
    return {**style, "mfc": one.inside or "none", "color": one.colour, "ls": "", "zorder": one.layer}


def _entry(role: str, name: str, kind: str) -> list[Artist]:
    """Of the legend, where it has a name."""
    if not name:
        return []
    one = look(role)
    if kind == "area":
        edge = one.colour if one.hatch or one.width else INK
        style = {**_filling(one), "edgecolor": edge, "linewidth": 0.6}
        return [Patch(label=name, **style)]
    if kind == "mark":
        return [Line2D([], [], label=name, **{**_marking(one), "ms": max(min(one.size, 9.0), 3.4)})]
    marks = {key: value for key, value in _marking(one).items() if key != "ls"} if one.marker else {}
    return [Line2D([], [], label=name, **{**marks, **({"mew": 1.0} if marks else {}), **_stroke(one)})]


def _line(axes: Axes, item: described.Line, panel: Panel) -> list[Artist]:
    one = look(item.role)
    x, y = np.asarray(item.x, dtype=float), np.asarray(item.y, dtype=float)
    marks: dict[str, Any] = {}
    if one.marker:
        style = _marking(one)
        marks = {key: style[key] for key in ("marker", "ms", "mfc", "mec")} | {"mew": 1.0 if one.every else 0.8}
        if not one.every:
            k = int(item.role.rpartition(" ")[2]) if item.role[-1].isdigit() else 0
            marks["markevery"] = (0.02 * (k % 7), 0.14)
    if np.isfinite(x + y).sum() == 1:
        return _lone_point(axes, item)
    if panel.polar:
        x = np.radians(x)
    axes.plot(x, y, label=item.name or None, clip_on=item.role != "operating range", solid_capstyle="butt",
              **{**marks, **_stroke(one)})  # fmt: skip
    return _entry(item.role, item.name, "line")


def _lone_point(axes: Axes, item: described.Line) -> list[Artist]:
    """A line of one point, as a mark in the legend too."""
    style = _marking(lone(item.role))
    axes.plot(item.x, item.y, label=item.name or None, **style)
    return [Line2D([], [], label=item.name, **{**style, "ms": min(style["ms"], 9.0)})] if item.name else []


def _points(axes: Axes, item: described.Points, panel: Panel) -> list[Artist]:
    one = look(item.role)
    style = _marking(one)
    if item.sizes is None:
        axes.plot(list(item.x), list(item.y), label=item.name or None, rasterized=len(item.x) > 20_000, **style)
    else:
        for k, (x, y, size) in enumerate(zip(item.x, item.y, item.sizes, strict=True)):
            name = (item.name or None) if k == 0 else None
            axes.plot(x, y, label=name, clip_on=False, **{**style, "ms": size})
    return _entry(item.role, item.name, "mark")


def _level(axes: Axes, item: described.Level, panel: Panel) -> list[Artist]:
    across = axes.axhline if item.on == "y" else axes.axvline
    across(item.value, label=item.name or None, **_stroke(look(item.role)))
    return _entry(item.role, item.name, "line")


def _spans(axes: Axes, item: described.Spans, panel: Panel) -> list[Artist]:
    strip = axes.axhspan if item.on == "y" else axes.axvspan
    for low, high in np.asarray(item.ends, dtype=float).tolist():
        strip(low, high, **_filling(look(item.role)))
    return _entry(item.role, item.name, "area")


def _band(axes: Axes, item: described.Band, panel: Panel) -> list[Artist]:
    low, high = (np.asarray(values, dtype=float) for values in (item.low, item.high))
    axes.fill_between(item.x, low, high, where=low != high, **_filling(look(item.role)))
    return _entry(item.role, item.name, "area")


def _shapes(axes: Axes, item: described.Shapes, panel: Panel) -> list[Artist]:
    axes.add_collection(PolyCollection(list(item.outlines), **_filling(look(item.role))))
    axes.autoscale_view()
    return _entry(item.role, item.name, "area")


def _bars(axes: Axes, item: described.Bars, panel: Panel) -> list[Artist]:
    draw_bars = axes.barh if item.lie else axes.bar
    draw_bars(list(item.at), np.asarray(item.size, dtype=float), item.thick, **_filling(look(item.role)))
    return _entry(item.role, item.name, "area")


def _mesh(axes: Axes, item: described.ColouredGrid, panel: Panel) -> list[Artist]:
    colours = item.colours
    palette = LinearSegmentedColormap.from_list(colours.palette, PALETTES[colours.palette])
    values = np.ma.masked_invalid(np.asarray(item.values, dtype=float))
    drawn: ScalarMappable
    if len(colours.levels):
        drawn = axes.contourf(item.x, item.y, values, levels=list(colours.levels), cmap=palette)
        axes.contour(item.x, item.y, values, levels=list(colours.levels), colors=INK, linewidths=0.6)
    else:
        norms: dict[str, Callable[[], Normalize]] = {
            "linear": lambda: Normalize(colours.low, colours.high),
            "log": lambda: LogNorm(colours.low, colours.high),
            "zero": lambda: TwoSlopeNorm(0.0, colours.low, colours.high),
        }
        cells = edges(np.asarray(item.x)), edges(np.asarray(item.y))
        drawn = axes.pcolormesh(*cells, values, cmap=palette, norm=norms[colours.scale](), rasterized=True)
    bar = axes.figure.figure.colorbar(drawn, ax=axes, **BESIDE)
    bar.set_label(colours.words, fontsize=TEXT, color=INK)
    bar.ax.tick_params(labelsize=SMALL, colors=INK)
    return []


def _cells(axes: Axes, item: described.Cells, panel: Panel) -> list[Artist]:
    one = look(item.role)
    where = np.asarray(item.where)
    if where.any():
        cells = edges(np.asarray(item.x)), edges(np.asarray(item.y))
        shown = np.ma.masked_where(~where, where.astype(float))
        axes.pcolormesh(*cells, shown, cmap=ListedColormap([one.inside]), rasterized=True)
        if one.hatch and min(where.shape) > 1:
            hatched = axes.contourf(
                item.x, item.y, where.astype(float), levels=[0.5, 1.5], colors="none", hatches=[one.hatch]
            )
            hatched.set_edgecolor(one.colour)
            hatched.set_linewidth(0.0)
    return _entry(item.role, item.name, "area")


def _words(axes: Axes, item: described.Texts, panel: Panel) -> list[Artist]:
    one = look(item.role)
    places = [ANCHORS[part] for part in item.beside.split() if part != "at"]
    shift = float(sum(move[0] for move, _ in places)), float(sum(move[1] for move, _ in places))
    aligned = [side for _, side in places]
    style: dict[str, Any] = {
        "ha": next((s for s in aligned if s in ("left", "right")), "center"),
        "va": next((s for s in aligned if s in ("top", "bottom")), "center"),
        "fontsize": TEXT if item.inside and not places else SMALL, "color": one.colour, "parse_math": False,
        "zorder": max(one.layer, 5.0), "annotation_clip": False,
    }  # fmt: skip
    if one.face:
        style["bbox"] = {"facecolor": one.face, "edgecolor": "none", "pad": 1.0, "alpha": 0.85}
    given: Any = "axes fraction" if item.inside else "data"
    for x, y, text in zip(item.x, item.y, item.texts, strict=True):
        if text:
            axes.annotate(text, (x, y), xycoords=given, xytext=shift, textcoords="offset points", **style)
    return []


def _arrows(axes: Axes, item: described.Arrows, panel: Panel) -> list[Artist]:
    colour = look(item.role).colour
    for begin, end in zip(np.asarray(item.begin).tolist(), np.asarray(item.end).tolist(), strict=True):
        axes.annotate("", end, begin, arrowprops={**ARROW, "color": colour})
    if not item.name:
        return []
    return [Line2D([], [], color=colour, marker=">", ms=5, lw=1.0, markevery=[0], label=item.name)]


def _key(axes: Axes, item: described.Key, panel: Panel) -> list[Artist]:
    return _entry(item.role, item.name, item.kind)


_ITEMS: dict[type, Callable[[Axes, Any, Panel], list[Artist]]] = {
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
    described.Arrows: _arrows,
    described.Key: _key,
    described.EdgeNames: lambda axes, item, panel: [],  # when the panel has its place
}


def _edge_names(axes: Axes, panel: Panel, items: Iterable[described.EdgeNames], width: float) -> None:
    """Names beside their places, when all else has its place; where they are crowded they are pushed apart."""
    settle(axes)
    for item in items:
        top = item.edge == "top"
        axis = panel.x if top else panel.y
        extent = axes.get_window_extent()
        pixels = extent.width if top else extent.height
        pitch = PITCH * SMALL / (72 * pixels / axes.figure.dpi)
        kept = sorted(list(zip(item.values, item.texts, strict=True))[: int(1 / pitch)])
        low, high = axes.get_xlim() if top else axes.get_ylim()
        ends = Axis(low=low, high=high, scale=axis.scale)
        exact = np.asarray(ends.share([value for value, _ in kept]))
        names = [
            _edge_name(axes, text, float(at), float(place), top)
            for (_, text), at, place in zip(kept, exact, spread(exact, pitch), strict=True)
        ]
        deepest = max((Text.get_window_extent(name) for name in names), key=lambda b: b.height, default=None)
        if top and deepest is not None:
            _titles(axes, panel, width, LEADER + 72 * deepest.height / axes.figure.dpi)


def _edge_name(axes: Axes, text: str, at: float, place: float, top: bool) -> Annotation:
    """A name outside the frame, joined to its place by a leader."""
    right, up = (0.0, LEADER / 72) if top else (LEADER / 72, 0.0)
    return axes.annotate(
        text,
        xy=(at, 1.0) if top else (1.0, at),
        xycoords="axes fraction",
        xytext=(place, 1.0) if top else (1.0, place),
        textcoords=axes.transAxes + ScaledTranslation(right, up, axes.figure.dpi_scale_trans),
        rotation=90 if top else 0,
        ha="center" if top else "left",
        va="bottom" if top else "center",
        fontsize=SMALL,
        color=INK,
        parse_math=False,
        arrowprops={
            "arrowstyle": "-", "color": FAINT, "lw": 0.7, "shrinkA": 1, "shrinkB": 0,
            "relpos": (0.5, 0.0) if top else (0.0, 0.5),
        },
    )  # fmt: skip
