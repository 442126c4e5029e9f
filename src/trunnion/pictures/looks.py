"""How each role looks: one palette, dashes, marks and hatches for files and for the browser.

The colours of curves are those of Okabe and Ito, told apart by every kind of colour vision; dashes and marks tell
them apart in grey. What judges is dark where it is bad: regions without stability, limits that are exceeded.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace

INK = "#1a1a1a"
FAINT = "#6b6b6b"
GRID = "#dddddd"
WHITE = "#ffffff"
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000")
"""Okabe and Ito's palette."""
ACCENT, VERMILION, GREEN, PINK, SKY, YELLOW, _ = COLOURS
DASHES: tuple[tuple[float, ...], ...] = (
    (), (5, 1.5), (1, 1), (6, 1.5, 1, 1.5), (2.2, 2), (7, 1.3, 1, 1.3, 1, 1.3), (11, 3)
)  # fmt: skip
"""On and off, in widths of the line."""
MARKERS = ("", "circle", "square", "triangle")
"""Seven dashes, each with one colour, then again with markers and the next colours."""
STYLES = len(DASHES) * len(MARKERS)
"""Curves of which no two look alike, in grey either."""
HATCHES = ("", "////", "xxxx", "....", "||||", "----", "\\\\\\\\")
BROKEN, CROSSED = (4, 2), (4, 3)
DARK = "#4a1526"
"""The edge of what is unstable."""
DULL, BAD, WORST = "#b9a7ad", "#8c2f39", "#a50026"
MUTED = ("#0072b2", "#f0b84c", "#004d3a", "#dba6c2", "#a03c00")
"""Dark and light in turn."""


@dataclass(frozen=True)
class Look:
    """Of a line, a mark or an area.

    colour, width, dash : of a line [pt], or of the edge of a mark or an area; dash in widths of the line, () unbroken.
    face : inside of a mark or an area; None for the colour, "" for nothing.
    marker, size : of a mark [pt]; every : of a line with marks, whether all points have one, or a few.
    hatch : in matplotlib's letters; opacity; layer : what lies upon what.
    """

    colour: str = INK
    width: float = 1.4
    dash: tuple[float, ...] = ()
    face: str | None = None
    marker: str = ""
    size: float = 6.0
    every: bool = False
    hatch: str = ""
    opacity: float = 1.0
    layer: float = 2.0

    @property
    def inside(self) -> str:
        """Colour of the inside, "" for none."""
        return self.colour if self.face is None else self.face


def curve(number: int) -> str:
    """The role of the curve of that number."""
    return f"curve {number}"


def _curve(k: int) -> Look:
    cycle = k // len(DASHES)
    return Look(
        COLOURS[(k + 3 * cycle) % len(COLOURS)], 1.5, DASHES[k % len(DASHES)],
        marker=MARKERS[cycle % len(MARKERS)], size=4.5,
    )  # fmt: skip


def _area(
    face: str, layer: float = 1.0, hatch: str = "", edge: str = "", width: float = 0.0, opacity: float = 1.0
) -> Look:
    return Look(edge or face, width, (), face, hatch=hatch, layer=layer, opacity=opacity)


def _mark(marker: str, colour: str = INK, size: float = 6.0, face: str | None = None, width: float = 1.0) -> Look:
    return Look(colour, width, (), face, marker, size, layer=5.0)


_METHODS = {
    "exact": Look(INK, 3.0),
    "shooting": Look(INK, 3.0),
    "harmonic balance": Look(SKY, 1.2),  # upon the exact curve, with which it coincides
    "describing function": Look(VERMILION, 1.5),
    "averaging": Look(GREEN, 3.6),  # beneath multiple scales, with which it coincides
    "multiple scales": Look(PINK, 1.5),
    "other method": Look(FAINT, 1.4),
    "doubled": Look(FAINT, 2.2, layer=1.5),
}
"""Of methods that find a response."""
_CONTACTS = {"none": "#a6d5f2", "one-sided": "#e08a00", "two-sided": "#8c2d04"}
"""Darker with every side touched, so that they are told apart in grey too."""
_OTHERS = ("#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
"""Colours of limits that neither verdicts nor marks use."""

_CLASSES = ("#440154", "#3b528b", "#21918c", "#5ec962", "#d9b300")
"""From low to high, lighter the higher."""

LOOKS: dict[str, Look] = {
    # lines of every picture
    "line": Look(),
    "sum": Look(width=2.2),
    "largest": Look(width=1.2, dash=DASHES[2]),
    "base": Look(width=1.0),
    "zero": Look(FAINT, 0.8, CROSSED),
    "mark": Look(FAINT, 0.8, (1, 2)),
    "cursor": Look(INK, 2.0, (1, 2), layer=6.0),
    "here": _mark("x", INK, 12.0, width=3.0),
    "operating": Look(ACCENT, 1.5, (5, 3)),
    "operating range": Look(ACCENT, 3.0, layer=6.0),
    "operating point": replace(_mark("diamond", ACCENT, 8.0, WHITE, 2.0), layer=7.0),
    "bar": _area(ACCENT),
    "jump": Look(FAINT, 1.0),
    "abrupt": Look(INK, 1.0),
    "contour": Look(INK, 0.6),
    "named": Look(INK, 0.8, (1, 3)),
    # words
    "words": Look(INK),
    "faint words": Look(FAINT),
    "boxed words": Look(INK, face=WHITE, layer=6.0),
    # over speed
    "indication": _area("#e2e2e2", 0.0, "////", "#8a8a8a"),
    "not reached": _area(DULL, 0.0),
    "lost": Look(WORST, 1.4, DASHES[2]),
    "margin": _area("#dde6ee"),
    "mode": Look(width=1.3, layer=3.0),
    "excitation": Look(VERMILION, 1.2),
    "excitation name": Look(VERMILION, face=WHITE, layer=6.0),
    "crossing": _mark("circle", VERMILION, 6.0, WHITE, 1.5),
    "measured": replace(_mark("circle", ACCENT, 5.0), opacity=0.55),
    "measured peak": _mark("x", INK, 8.0, width=1.8),
    "limit of stability": Look(BAD, 1.6),
    "growing": _area(BAD, opacity=0.6),
    "named speed": Look(ACCENT, 0.8, CROSSED, layer=0.0),
    "unstable part": _area(BAD),
    # stability over two parameters
    "stable": _area(WHITE, edge=INK, width=1.0),
    "stable everywhere": _area("#e9f0f4", edge=INK, width=1.0),
    "unstable": _area(BAD, edge=INK, width=1.0),
    "marginal": _area("#e9e9e9", hatch="....", edge="#555555"),
    "undecided": _area("#c4c4c4", hatch="////", edge="#555555"),
    "failed": _area(WHITE, hatch="xxxx", edge="#555555"),
    "printed unstable": _area("#1c1c22"),
    "printed undecided": _area("#c4c4c4"),
    "not covered": _area(WHITE, hatch="////", edge="#9a9a9a"),
    "tongue": _area("#d9c3c9"),
    "tongue edge": Look(DARK, 1.1, layer=6.0),
    "tongue over": Look(ACCENT, 1.1, layer=6.0),
    "narrow tongue": replace(_mark("inverted_triangle", WHITE, 6.0, ACCENT), layer=7.0),
    "window": _area(ACCENT, 0.0, opacity=0.12),
    "unstable region": _area(DULL, edge=DARK, width=0.8),
    "unstable column": _area(DULL, edge=DULL, width=0.3),
    "largest stable": Look(DARK, 1.4, layer=3.0),
    "largest stable point": replace(_mark("circle", DARK, 3.5), layer=3.0),
    "end of stable": Look(DARK, 1.4, BROKEN, layer=3.0),
    "stands": Look(ACCENT, 1.2, (1, 1.5), layer=5.0),
    "stands name": Look(ACCENT, face=WHITE, layer=6.0),
    "proved": _area("#d6e6f2", edge=INK, width=0.4),
    "proved, many": _area("#d6e6f2"),
    "open": _area("#b5b5b5", 2.0, "///", INK, 0.4),
    "open, many": _area("#b5b5b5", 2.0, "///"),
    "counterexample": _mark("cross", INK, 11.0, VERMILION),
    # design
    "counted": _area(DULL),
    "stability ends": Look(DARK, 1.4),
    "upwards": _area(ACCENT),
    "downwards": _area(VERMILION, opacity=0.55),
    "better": Look(ACCENT, 2.2),
    "worse": Look(VERMILION, 2.2),
    "before": _mark("circle", INK, 7.0, WHITE),
    "after": _mark("circle", INK, 7.0),
    "reached peak": _mark("circle", WHITE, 7.0, INK),
    "allowed peak": _mark("diamond", INK, 8.0, WHITE),
    "bounds": Look("#c8c8c8", 4.0, layer=1.0),
    "begin": _mark("square", INK, 8.0, WHITE),
    "taken": _mark("circle", INK, 9.0),
    "reaches": Look(INK, 1.4, layer=4.0),
    "best": _mark("circle", ACCENT, 9.0),
    "front": Look(ACCENT, 1.2, (), None, "circle", 5.0, True),
    "satisfied": _area(ACCENT),
    "exceeded": _area(VERMILION, hatch="////", edge=INK),
    "undeciding": _area(FAINT),
    "undeciding, bad": _area(FAINT, hatch="////", edge=INK),
    # modes and joints
    "shape": Look(ACCENT, 0.9, (), None, "circle", 4.5, True),
    "shape later": Look(VERMILION, 1.2, (5, 3)),
    "reach": Look(ACCENT, 1.2),
    "rest": Look(FAINT, 0.8),
    "input arm": Look(ACCENT, 4.0),
    "output arm": Look(VERMILION, 4.0, (1.5, 0.8)),
    "ring": Look(FAINT, 1.0),
    "multiplier": _mark("circle", VERMILION, 8.0),
    # motions
    "path": Look(ACCENT, 0.7),
    "fine path": Look(ACCENT, 0.5),
    "orbit": Look(ACCENT, 1.6),
    "start": _mark("circle", VERMILION, 6.0),
    "point": _mark("circle", ACCENT, 5.0),
    "map points": _mark("circle", ACCENT, 2.5, width=0.0),
    "crowded points": _mark("circle", ACCENT, 1.0, width=0.0),
    "single point": _mark("circle", ACCENT, 4.0, width=0.0),
    "not found": _area("#9a9a9a"),
    "steady": Look(ACCENT, 1.6),
    "steady, unstable": _mark("circle", ACCENT, 3.0, ""),
    "accelerates": Look(FAINT, 1.0, (3.7, 1.6)),
    "turns": Look(VERMILION, 1.3),
    "top": _mark("diamond", VERMILION, 6.0),
    "captured half": Look(VERMILION, 2.6, layer=5.0),
    "hangs": Look(FAINT, 1.0, (1, 1.65)),
    "linear": _area(ACCENT),
    "nonlinear": _area(VERMILION, hatch="//", edge=WHITE),
    "difference": _mark("dash", INK, 16.0, width=2.2),
    # responses with their jumps
    "stable branch": Look(ACCENT, 1.7),
    "unstable branch": Look(VERMILION, 1.3, BROKEN),
    "unstable motions": Look(FAINT, 1.2, BROKEN),
    "fold": _mark("circle", face=""),
    "period doubling": _mark("square", face=""),
    "Neimark–Sacker": _mark("triangle", face=""),
    "branch point": _mark("diamond", face=""),
    "grazing": _mark("x"),
    "sweep": Look("#bbbbbb", 0.8, layer=1.0),
    "sweep up": _mark("triangle", ACCENT, 4.5, ""),
    "sweep down": _mark("inverted_triangle", YELLOW, 4.5, ""),
    "index of sweep up": Look(VERMILION, 1.2, (), "", "triangle", 4.0),
    "index of sweep down": Look(ACCENT, 1.2, (), "", "inverted_triangle", 4.0),
    "loose": _mark("dash", INK, 8.0, width=0.8),
    "no basin": _area("#eeeeee", edge=FAINT),
    "attractor": replace(_mark("x", INK, 8.0, width=1.8), layer=6.0),
    "attractor ground": _mark("x", WHITE, 10.0, width=4.5),
    **_METHODS,
    **{f"{name}, unstable": replace(one, width=0.8 * one.width, dash=BROKEN) for name, one in _METHODS.items()},
    **{f"{name}, up": _mark("triangle", colour, 3.4) for name, colour in _CONTACTS.items()},
    **{f"{name}, down": _mark("inverted_triangle", colour, 6.0, "") for name, colour in _CONTACTS.items()},
}

VARIANTS = 3
"""Variants that are told apart on the same axes."""
_VARIANT_DASHES = ((2, 1.5), (6, 1.5), (1, 2.5))

FAMILIES: dict[str, Callable[[int], Look]] = {
    "curve": _curve,
    "plain": lambda k: replace(_curve(k), marker="", width=1.2),
    "steady": lambda k: replace(_curve(k), marker="", width=1.2, dash=(5, 3)),
    "turns": lambda k: replace(_curve(k), marker="", width=1.5, dash=()),
    "marked": lambda k: replace(
        _curve(k), dash=(), every=True, size=5.0,
        marker=("circle", "square", "triangle", "diamond", "inverted_triangle", "plus")[k % 6],
    ),
    "theory": lambda k: _mark("circle", _curve(k).colour, 3.5, WHITE),
    "dotted": lambda k: replace(_curve(k), marker="circle", width=1.3, size=2.0, every=True),
    "envelope": lambda k: _area(_curve(k).colour, opacity=0.35),
    "variant": lambda k: Look(FAINT, 1.2, _VARIANT_DASHES[k % VARIANTS]),
    "class": lambda k: Look(_CLASSES[k % len(_CLASSES)], 0.7),
    "interval": lambda k: _area(_curve(k).colour, opacity=0.25),
    "bar": lambda k: _area(_curve(k).colour, hatch=HATCHES[k % len(HATCHES)], edge=WHITE, width=0.3),
    "dots": lambda k: _mark("circle", COLOURS[k % len(COLOURS)], 0.8, width=0.0),
    "dot": lambda k: _mark("circle", COLOURS[k % len(COLOURS)], 5.0),
    "limit": lambda k: Look(WORST, 1.8, DASHES[k % len(DASHES)]),
    "other limit": lambda k: Look(
        _OTHERS[k % len(_OTHERS)], 1.5, ((), (5, 2), (1, 1.5))[k // len(_OTHERS) % 3], layer=4.0
    ),
    "basin": lambda k: _area(MUTED[k % len(MUTED)]),
    "fit, unstable": lambda k: Look(_OTHERS[::-1][k % 5], 1.0, BROKEN),
    "fit": lambda k: Look(_OTHERS[::-1][k % 5], 1.8, ((), (6, 1.5, 1, 1.5), (1, 1))[k % 3]),
}  # fmt: skip
"""Roles of which there are many, told apart by a number: "curve 0", "limit 1"."""

LONE = ("square", "triangle", "diamond", "inverted_triangle", "plus", "cross")
"""Shapes of curves of one point."""

PALETTES: dict[str, tuple[str, ...]] = {
    # falling lightness, all darker than what is not unstable, from slow to fast growth
    "growth": ("#bf4a33", "#8c2f39", "#4a1526", "#16060d"),
    # all lighter than what is unstable, from slow to fast decay
    "decay": ("#f3e3c3", "#e9f0f4", "#9fc4d8"),
    # viridis
    "amplitude": (
        "#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30", "#fde725",
    ),
    # blue below 0, red above, white between
    "signed": (
        "#053061", "#2166ac", "#4393c3", "#92c5de", "#d1e5f0", "#f7f7f7", "#fddbc7", "#f4a582", "#d6604d", "#b2182b",
        "#67001f",
    ),
}  # fmt: skip
"""Colours of meshes, from the low end to the high one; colours between are mixed."""


_VARIANT = re.compile(r"of variant ([0-9]+): (.*)")


def look(role: str) -> Look:
    """The look of a role, or of one of a family; of a curve of another variant that of the curve, but for its dash."""
    if found := _VARIANT.fullmatch(role):
        own = look(found[2])
        return replace(
            own, dash=_VARIANT_DASHES[int(found[1]) % VARIANTS], width=0.8 * own.width, layer=own.layer - 0.1
        )
    family, _, number = role.rpartition(" ")
    return FAMILIES[family](int(number)) if number.isdigit() and family in FAMILIES else LOOKS[role]


def lone(role: str) -> Look:
    """Of a line of that role which has one point alone, a mark: curves by shapes, having no dashes to be told apart by;
    a bar where it bounds."""
    one, (family, _, number) = look(role), role.rpartition(" ")
    if family.endswith("limit"):
        return _mark("dash", one.colour, 12.0, width=2.0)
    shape = LONE[int(number) % len(LONE)] if number.isdigit() else "circle"
    return _mark(shape, one.colour, 6.0)
