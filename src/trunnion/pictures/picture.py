"""A picture as data: series, axes, marks, bands and words, which ``draw_matplotlib`` and ``draw_bokeh`` draw alike.

Nothing here knows a library or a colour: what a thing is, its ``role``, decides how it looks (see ``looks``). All
numbers are those of the axes, in the units that stand there.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from textwrap import fill
from typing import Any, TypeAlias

import numpy as np

from trunnion.arrays import Array, Flags

NAME = 30
"""Letters of a name in a row before it breaks."""
UNBROKEN = "\u00a0"
"""Space at which words do not break, as between a number and its unit."""
MARGIN = 0.05
"""Share of what is shown that an axis leaves free at either side, where its ends are not stated."""
EVEN = 100.0
"""Up to where an axis is even that is logarithmic beyond, to either side of 0."""
WIDE = 1.2
"""Length of its even part on one side of 0 to 90 % of a decade."""


@dataclass(frozen=True)
class Axis:
    """What runs along an axis: words, unit ("" for none), ends (None: by what is shown), scale, ticks.

    scale : "linear", "log", or "symlog", which is even up to ``EVEN`` and logarithmic beyond.
    names : in place of numbers at ``ticks``, by default at 0, 1, 2 …; the first of rows stands on top.
    """

    words: str = ""
    unit: str = ""
    low: float | None = None
    high: float | None = None
    scale: str = "linear"
    ticks: Sequence[float] = ()
    names: Sequence[str] = ()

    @property
    def label(self) -> str:
        """``input speed [rpm]``."""
        return f"{self.words} [{self.unit}]" if self.unit else self.words

    def logarithmic(self, low: float, high: float) -> Axis:
        """The same over powers of ten, between two ends."""
        return replace(self, low=low, high=high, scale="log")

    def scaled(self, values: Any) -> Array:
        """Values as the axis spaces them."""
        given = np.asarray(values, dtype=float)
        if self.scale == "log":
            with np.errstate(divide="ignore", invalid="ignore"):
                return np.asarray(np.log10(given))
        if self.scale == "symlog":
            far = np.abs(given) > EVEN
            beyond = np.sign(given) * (1 + np.log10(np.where(far, np.abs(given), EVEN) / EVEN) * 0.9 / WIDE)
            return np.asarray(np.where(far, beyond, given / EVEN))
        return given

    def share(self, value: Any) -> Array:
        """Where values lie along an axis whose ends are stated, from 0 to 1."""
        low, high = self.scaled([self.low, self.high])
        return np.asarray((self.scaled(value) - low) / (high - low))


@dataclass(frozen=True)
class Line:
    """Points joined by a line; NaN parts it. ``name`` stands in the legend ("": not there), ``says`` what it is."""

    x: Any
    y: Any
    role: str
    name: str = ""
    says: str = ""


@dataclass(frozen=True)
class Points:
    """Marks at points, of ``sizes`` of their own where these are given; ``says`` what each of them is."""

    x: Any
    y: Any
    role: str
    name: str = ""
    sizes: Any = None
    says: Sequence[str] = ()


@dataclass(frozen=True)
class Level:
    """A line across the whole panel, at a value of the axis ``on``."""

    value: float
    role: str
    name: str = ""
    on: str = "y"


@dataclass(frozen=True)
class Spans:
    """Strips across the whole panel, between pairs (n, 2) of values of the axis ``on``."""

    ends: Any
    role: str
    name: str = ""
    on: str = "x"


@dataclass(frozen=True)
class Band:
    """What lies between two curves over x."""

    x: Any
    low: Any
    high: Any
    role: str
    name: str = ""


@dataclass(frozen=True)
class Shapes:
    """Closed outlines (n, 2); ``says`` what each of them is."""

    outlines: Sequence[Array]
    role: str
    name: str = ""
    says: Sequence[str] = ()


@dataclass(frozen=True)
class Bars:
    """Bars from 0 to ``size`` at places along x, or along y where they ``lie``; ``says`` what each of them is."""

    at: Any
    size: Any
    thick: float
    role: str
    name: str = ""
    lie: bool = False
    says: Sequence[str] = ()


@dataclass(frozen=True)
class Colours:
    """What the colours of a mesh mean: words for the bar beside it, colours, the values at their ends.

    scale : "linear", "log", or "zero", which has its middle colour at 0.
    levels : between which values a colour does not change.
    """

    words: str
    palette: str
    low: float
    high: float
    scale: str = "linear"
    levels: Sequence[float] = ()


@dataclass(frozen=True)
class ColouredGrid:
    """Values (y, x) at points of a grid as coloured cells, NaN for none; or, between ``colours.levels``, as contours.

    ``says`` are values (y, x) for the pointer where others are coloured than are known.
    """

    x: Any
    y: Any
    values: Any
    colours: Colours
    says: Any = None


@dataclass(frozen=True)
class Cells:
    """Cells of a grid where something holds (y, x)."""

    x: Any
    y: Any
    where: Flags
    role: str
    name: str = ""


@dataclass(frozen=True)
class Texts:
    """Words at points, which they stand ``beside``: "at", "above", "below", "left" or "right", also two of them.

    inside : points are shares of the panel's width and height, not numbers of the axes.
    """

    x: Any
    y: Any
    texts: Sequence[str]
    role: str = "words"
    beside: str = "at"
    inside: bool = False


@dataclass(frozen=True)
class EdgeNames:
    """Names at values of an axis, outside the panel and spread so that no two touch: at its "top" or "right".

    Where not all find room the first ones stay; ``says`` is more about each.
    """

    values: Any
    texts: Sequence[str]
    edge: str = "top"
    says: Sequence[str] = ()


@dataclass(frozen=True)
class Arrows:
    """Arrows between points (n, 2)."""

    begin: Any
    end: Any
    role: str
    name: str = ""


@dataclass(frozen=True)
class Key:
    """An entry of the legend alone: a "line", a "mark" or an "area"."""

    role: str
    name: str
    kind: str = "line"


Item: TypeAlias = (
    Line | Points | Level | Spans | Band | Shapes | Bars | ColouredGrid | Cells | Texts | EdgeNames | Arrows | Key
)


@dataclass(frozen=True)
class Panel:
    """One pair of axes, and what is shown in it.

    title, remark : words above, in ink, or small and faint.
    key : where the legend stands, "below", "inside" or "beside" the panel; below the whole picture for all its panels
        at its "left" or "right" or in its "centre"; "" for none.
    grid : lines at ticks of "both" axes, of "x" or of "y", or of none ("").
    right : a second vertical axis, of ``right_items``.
    frame : whether axes are drawn at all; even : one unit is as long up as across; polar : x are degrees of a turn.
    """

    x: Axis
    y: Axis
    items: Sequence[Item]
    title: str = ""
    remark: str = ""
    key: str = "below"
    key_title: str = ""
    grid: str = "both"
    right: Axis | None = None
    right_items: Sequence[Line] = ()
    frame: bool = True
    even: bool = False
    polar: bool = False

    def with_items(self, *more: Item) -> Panel:
        """The same with more in it."""
        return replace(self, items=(*self.items, *more))

    def axis(self, name: str) -> Axis:
        """``x`` or ``y`` by its name."""
        return self.x if name == "x" else self.y


@dataclass(frozen=True)
class Picture:
    """Panels in rows of ``columns``, a title above them, and the size on paper [inches].

    heights : of rows of panels to one another; shared : rows and columns of panels have common axes.
    """

    panels: Sequence[Panel]
    width: float = 7.2
    height: float = 4.3
    columns: int = 1
    title: str = ""
    heights: Sequence[float] = ()
    shared: bool = False
    x_words: str = ""

    def __iter__(self) -> Iterator[Panel]:
        return iter(self.panels)

    @property
    def panel(self) -> Panel:
        """The first, or the only one."""
        return self.panels[0]

    def with_panel(self, **changes: Any) -> Picture:
        """The same with its first panel changed."""
        return replace(self, panels=(replace(self.panel, **changes), *self.panels[1:]))


def single(
    x: Axis, y: Axis, items: Iterable[Item], width: float = 7.2, height: float = 4.3, title: str = "", **more: Any
) -> Picture:
    """A picture of one panel; ``more`` as of ``Panel``."""
    return Picture((Panel(x, y, tuple(items), title, **more),), width, height)


def points_at(at: Any, role: str, name: str = "", sizes: Any = None, says: Sequence[str] = ()) -> Points:
    """Marks at places (n, 2)."""
    x, y = np.reshape(np.asarray(at, dtype=float), (-1, 2)).T
    return Points(x, y, role, name, sizes, says)


def rows(names: Sequence[str]) -> Axis:
    """The vertical axis of what lies in rows, the first on top; long names break into lines."""
    broken = tuple(fill(name, NAME, break_long_words=False).replace(UNBROKEN, " ") for name in names)
    return Axis(low=len(names) - 0.4, high=-0.6, names=broken)


def runs(x: Array, where: Flags) -> Array:
    """Ends (n, 2) of stretches of rising ``x`` at whose points something holds, out to the middle between points."""
    edge = edges(x)
    change = np.diff(np.concatenate([[0], np.asarray(where, dtype=int), [0]]))
    return np.column_stack([edge[np.flatnonzero(change > 0)], edge[np.flatnonzero(change < 0)]])


def edges(values: Array) -> Array:
    """Edges of the cells around the points of an axis; a single point gets a cell of 2 % of its value."""
    if len(values) == 1:
        half = 0.01 * abs(float(values[0])) or 0.5
        return np.array([values[0] - half, values[0] + half])
    middle = (values[1:] + values[:-1]) / 2
    return np.concatenate([[2 * values[0] - middle[0]], middle, [2 * values[-1] - middle[-1]]])


def columns(names: Sequence[str], room: float, key: float) -> int:
    """The most columns of a legend, filled one after another, the first ones longer, that fit into so many letters.

    ``key`` is the room, in letters, of what stands before and behind a name.
    """
    widths = [len(name) + key for name in names]
    for count in range(len(widths), 1, -1):
        if sum(map(max, np.array_split(widths, count))) <= room:
            return count
    return 1


def spread(wanted: Array, pitch: float) -> Array:
    """Places in [0, 1] as near to the wanted ones (ascending) as a distance of ``pitch`` between them allows.

    Crowded names form blocks, each centred on the mean of its own wanted places.
    """
    blocks: list[list[float]] = []  # [sum of (wanted − offset within the block), members]
    starts: list[float] = []
    for value in wanted:
        blocks.append([float(value), 1])
        starts.append(float(value))
        while True:
            total, count = blocks[-1]
            starts[-1] = float(np.clip(total / count, 0.0, max(0.0, 1.0 - (count - 1) * pitch)))
            if len(blocks) < 2 or starts[-2] + blocks[-2][1] * pitch <= starts[-1] + 1e-12:
                break
            total, count = blocks.pop()
            starts.pop()
            before = blocks[-1]
            blocks[-1] = [before[0] + total - count * before[1] * pitch, before[1] + count]
    return np.array([s + i * pitch for s, (_, n) in zip(starts, blocks, strict=True) for i in range(int(n))])
