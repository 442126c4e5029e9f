"""One look for all figures: sizes, colours, a figure without global state, its labels and legend, and saving it whole.

Everything is set on the artists themselves: matplotlib's rcParams belong to the user and are not safe between
threads. A figure is 16 cm wide with 11 pt text, which is still legible when printed 10 cm wide.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from textwrap import fill
from typing import Any, Literal

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from trunnion.arrays import Array
from trunnion.plots.formats import check_format
from trunnion.plots.literal_figure import LiteralFigure
from trunnion.plots.powers import PlainPowers
from trunnion.results.units import signs
from trunnion.writing import written_whole

WIDTH, HEIGHT = 6.3, 4.9
TEXT, SMALL, TITLE = 11, 9.5, 12
INK = "#1a1a1a"
FAINT = "#6b6b6b"
GRID = "#dddddd"
ACCENT = "#0072b2"
"""Blue of the palette of Okabe and Ito: told from the rest by every kind of colour vision."""
VERMILION = "#d55e00"
"""Its vermilion."""
COLOURS = (ACCENT, VERMILION, "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000")
"""Okabe and Ito's palette, told apart by every kind of colour vision; line styles tell them apart in grey."""
PATTERNS: tuple[Any, ...] = (
    "-",
    (0, (5, 1.5)),
    (0, (1, 1)),
    (0, (6, 1.5, 1, 1.5)),
    (0, (2.2, 2)),
    (0, (7, 1.3, 1, 1.3, 1, 1.3)),
    (0, (11, 3)),
)
MARKERS = ("", "o", "s", "^")
"""Seven patterns, each with one colour, then again with markers and the next colours: 28 styles, told apart in grey."""
STYLES = len(PATTERNS) * len(MARKERS)
UNBROKEN = "\u00a0"
"""Space at which a title does not break, as between a number and its unit."""
DPI = 200
NAME = 30
"""Letters of a name in a row before it breaks."""


def new_figure(width: float, height: float, *, layout: Literal["constrained"] | None = "constrained") -> Figure:
    """A figure [inches] drawn by Agg: no window, no pyplot, safe in threads; its places adapt to its texts."""
    figure = LiteralFigure(figsize=(width, height), layout=layout)
    FigureCanvasAgg(figure)
    return figure


def new_axes(width: float = WIDTH, height: float = HEIGHT) -> Axes:
    """Axes on a figure of their own [inches]."""
    return new_figure(width, height).add_subplot()


def curve_style(k: int) -> dict[str, Any]:
    """Colour, pattern and markers of curve ``k``; no two of ``STYLES`` curves look alike, in grey either."""
    cycle = k // len(PATTERNS)
    return {
        "color": COLOURS[(k + 3 * cycle) % len(COLOURS)],
        "linestyle": PATTERNS[k % len(PATTERNS)],
        "marker": MARKERS[cycle % len(MARKERS)],
        "markersize": 4.5,
        "markevery": (0.02 * (k % len(PATTERNS)), 0.14),
    }


def printed(quantity: str) -> str:
    """A number with its unit, or a unit alone, as a page prints it: "−3 N·m", "rad/s²"."""
    return signs(quantity).replace("-", "−")


def label_axes(axes: Axes, x: str, y: str = "", *, grid: bool = True) -> None:
    """Words at the axes, ticks and frame in the common look, and a grid; without ``y`` the ticks there are names."""
    axes.set_xlabel(x, fontsize=TEXT, color=INK)
    if y:
        axes.set_ylabel(y, fontsize=TEXT, color=INK)
    if grid:
        axes.grid(which="major", axis="both" if y else "x", color=GRID, lw=0.6)
    plain(axes)


def plain(axes: Axes) -> None:
    """Ticks and frame in the common look."""
    axes.tick_params(labelsize=TEXT, colors=INK, direction="out")
    for spine in axes.spines.values():
        spine.set_color(INK)


def rows_of_names(axes: Axes, names: Sequence[str], x: str) -> None:
    """Labels of bars or marks that lie in rows, the first on top, and the same look.

    Long names break into lines, and few numbers stand at the axis, which long names leave little room.
    """
    broken = [fill(name, NAME, break_long_words=False).replace(UNBROKEN, " ") for name in names]
    axes.set_yticks(range(len(names)), broken)
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.set_axisbelow(True)
    label_axes(axes, x)
    axes.tick_params(axis="y", labelsize=SMALL)
    if axes.get_xscale() == "linear":
        axes.xaxis.set_major_locator(MaxNLocator(5))


def head(figure: Figure, title: str, size: float = TITLE) -> None:
    """A title at the left, in as many lines as the figure's width asks for."""
    letters = int(72 * figure.get_figwidth() / (0.56 * size))
    wrapped = fill(title, letters).replace(UNBROKEN, " ")
    figure.suptitle(wrapped, fontsize=size, color=INK, x=0.01, ha="left")


def through(axes: Axes, *points: Array, **look: Any) -> None:
    """A line through points of the plane or of space."""
    axes.plot(*np.stack(points, axis=1), **look)


def headed(axes: Axes, text: str) -> None:
    """A small remark above the axes, at the left."""
    axes.set_title(text, fontsize=SMALL, color=FAINT, loc="left")


def key_below(axes: Axes, columns: int, handles: Sequence[Artist] | None = None, **look: Any) -> None:
    """The legend of ``axes`` below them, or the one of ``handles``; ``look`` as of ``Figure.legend``."""
    shown = axes.get_legend_handles_labels()[0] if handles is None else handles
    place = {"loc": "outside lower left", "ncols": columns, "fontsize": SMALL, "frameon": False}
    axes.figure.figure.legend(handles=shown, **{**place, **look})


def colour_bar(axes: Axes, drawn: ScalarMappable, words: str, **place: Any) -> None:
    """What the colours of a mesh mean; ``place`` as of ``Figure.colorbar``."""
    bar = axes.figure.figure.colorbar(drawn, ax=axes, **place)
    bar.set_label(words, fontsize=TEXT, color=INK)
    bar.ax.tick_params(labelsize=SMALL, colors=INK)


def logarithmic(axes: Axes, axis: Literal["x", "y"]) -> None:
    """Give one of the axes a logarithmic scale."""
    (axes.set_xscale if axis == "x" else axes.set_yscale)("log")
    own = axes.xaxis if axis == "x" else axes.yaxis
    own.set_major_formatter(PlainPowers())
    own.set_minor_formatter(PlainPowers())


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
