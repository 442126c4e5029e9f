"""One look for all figures: sizes, colours, a figure without global state, and saving it whole.

Everything is set on the artists themselves: matplotlib's rcParams belong to the user and are not safe between
threads. A figure is 16 cm wide with 11 pt text, which is still legible when printed 10 cm wide.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from trunnion.errors import InputError
from trunnion.writing import written_whole

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH, HEIGHT = 6.3, 4.9
TEXT, SMALL, TITLE = 11, 9.5, 12
INK = "#1a1a1a"
FAINT = "#6b6b6b"
ACCENT = "#0072b2"
"""Blue of the palette of Okabe and Ito: told from the rest by every kind of colour vision."""
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000")
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
FORMATS = ("png", "pdf", "svg")
DPI = 200


def new_axes(width: float = WIDTH, height: float = HEIGHT) -> Axes:
    """Axes on a figure of their own [inches], drawn by Agg: no window, no pyplot, safe in threads."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    from trunnion.plots.literal_figure import LiteralFigure

    figure = LiteralFigure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure.add_subplot()


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
    return quantity.replace("*", "·").replace("^2", "²").replace("^3", "³").replace("-", "−")


def plain(axes: Axes) -> None:
    """Ticks and frame in the common look."""
    axes.tick_params(labelsize=TEXT, colors=INK, direction="out")
    for spine in axes.spines.values():
        spine.set_color(INK)


def logarithmic(axes: Axes, axis: Literal["x", "y"]) -> None:
    """Give one of the axes a logarithmic scale."""
    from trunnion.plots.powers import PlainPowers

    (axes.set_xscale if axis == "x" else axes.set_yscale)("log")
    own = axes.xaxis if axis == "x" else axes.yaxis
    own.set_major_formatter(PlainPowers())
    own.set_minor_formatter(PlainPowers())


def settle(axes: Axes) -> None:
    """Give the axes of a figure the places that they will have, for what is fitted to the room there is."""
    from trunnion.plots.literal_figure import LiteralFigure

    figure = axes.figure.figure
    if isinstance(figure, LiteralFigure):
        figure.settle()
    else:
        figure.draw_without_rendering()


def check_format(path: str | os.PathLike[str]) -> str:
    """``png``, ``pdf`` or ``svg`` by the file's ending; InputError for another."""
    ending = Path(path).suffix.removeprefix(".").lower()
    if ending not in FORMATS:
        raise InputError(
            "is not a picture this program writes",
            key="output",
            value=str(path),
            remedy="end it in .png, .pdf or .svg",
        )
    return ending


def save(figure: Figure, path: str | os.PathLike[str]) -> None:
    """Write the figure; an existing file is replaced only when all is written."""
    ending = check_format(path)
    with written_whole(path) as temporary:
        figure.savefig(temporary, format=ending, dpi=DPI)
