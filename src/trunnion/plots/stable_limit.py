"""The largest stable value of a parameter over speed, the unstable ranges above it, and the limits beside it."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from trunnion.arrays import Array
from trunnion.design.limits.result import LimitKind, StableLimit
from trunnion.driveline.operation import Operation
from trunnion.plots.over_speed import mark_operating
from trunnion.plots.stability_chart import edges
from trunnion.plots.style import ACCENT, INK, SMALL, TEXT, key_below, label_axes, new_axes
from trunnion.results.quantity_axes import quantity_axis
from trunnion.results.speeds import speed_factor

UNSTABLE, EDGE = "#b9a7ad", "#4a1526"
BESIDE = ("#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
"""Colours of Okabe and Ito's palette that neither verdicts nor marks use."""
DASHES = ("-", (0, (5, 2)), (0, (1, 1.5)))


def draw(
    limit: StableLimit,
    axes: Axes | None = None,
    *,
    unit: str = "",
    operating: Operation | None = None,
    values: dict[str, float] | None = None,
) -> Axes:
    """Draw ``limit`` over speed: unstable ranges, the largest stable value, and where other limits are reached.

    Parameters
    ----------
    unit : of the speed; default the description's.
    operating : its speed is marked.
    values : where the line stands, by name (SI units); each is a horizontal mark.
    """
    axes = axes or new_axes(7.2, 3.6)
    unit = unit or limit.speed_unit
    up = quantity_axis(limit.parameter, limit.unit, unit)
    x, y = limit.speed * speed_factor(unit), limit.limit * up.factor
    beyond = limit.kind == LimitKind.BEYOND
    ends_of_columns = edges(x)
    if limit.whole is None:
        _unstable(axes, limit, ends_of_columns, up.factor)
    else:
        _regions(axes, limit, up.factor, speed_factor(unit))
    few = len(x) == 1 or limit.whole is not None  # between its points the line would claim what is not so
    look: dict[str, Any] = {"marker": ".", "ls": ""} if few else {"lw": 1.4}
    axes.plot(x, np.where(beyond, np.nan, y), color=EDGE, zorder=3, **look)
    shown = _others(axes, limit, x, up.factor)
    _values(axes, values or {}, up.factor, limit)
    if operating and operating.speed:
        mark_operating(axes, operating.speed * speed_factor(unit), zorder=5)
    shown_speeds = ends_of_columns if len(x) == 1 else x
    axes.set_xlim(shown_speeds[0], shown_speeds[-1])
    axes.set_ylim(limit.low * up.factor, limit.high * up.factor)
    label_axes(axes, f"input speed [{unit}]", up.label, grid=False)
    if beyond.all() and not (limit.whole and len(limit.whole.tongues)):
        axes.text(
            0.5, 0.5, "no instability found", transform=axes.transAxes, ha="center", va="center", fontsize=TEXT,
            color=INK, bbox={"facecolor": "white", "edgecolor": "none", "pad": 3}, zorder=6,
        )  # fmt: skip
    _key(axes, limit, bool(operating and operating.speed), shown)
    return axes


def _unstable(axes: Axes, limit: StableLimit, ends: Array, factor: float) -> None:
    """Every unstable range of every speed, as wide as its column between two of ``ends``."""
    corners = [
        [(ends[i], a), (ends[i + 1], a), (ends[i + 1], b), (ends[i], b)]
        for i, ranges in enumerate(limit.unstable)
        for a, b in (ranges * factor).tolist()
    ]
    axes.add_collection(PolyCollection(corners, facecolor=UNSTABLE, edgecolor=UNSTABLE, lw=0.3, zorder=1))


def _regions(axes: Axes, limit: StableLimit, factor: float, speed: float) -> None:
    """Every unstable region between the lowest and the highest speed, and the ends of what is stable at all of them."""
    assert limit.whole is not None
    shapes = [
        np.column_stack([np.concatenate([t.low, t.high[::-1]]) * speed, np.concatenate([t.y, t.y[::-1]]) * factor])
        for t in limit.whole.tongues
    ]
    axes.add_collection(PolyCollection(shapes, facecolor=UNSTABLE, edgecolor=EDGE, lw=0.8, zorder=1))
    for end in np.unique(limit.whole.windows):
        if limit.low < end < limit.high:
            axes.axhline(end * factor, color=EDGE, lw=1.4, ls=(0, (4, 2)), zorder=3)


def _others(axes: Axes, limit: StableLimit, x: Array, factor: float) -> list[Line2D]:
    """Where limits of the description are reached first."""
    shown = []
    for k, other in enumerate(o for o in limit.others if np.any(o.reached <= limit.high)):
        y = np.where(other.reached <= limit.high, other.reached * factor, np.nan)
        look: dict[str, Any] = {"color": BESIDE[k % len(BESIDE)], "ls": DASHES[k // len(BESIDE) % len(DASHES)]}
        shown += axes.plot(x, y, lw=1.5, marker="." if len(x) == 1 else None, zorder=4, label=other.name, **look)
    return shown


def _values(axes: Axes, values: dict[str, float], factor: float, limit: StableLimit) -> None:
    """Where the line stands: short marks at the right edge, names of equal values together."""
    together: dict[float, list[str]] = {}
    for name, value in values.items():
        if limit.low <= value <= limit.high:
            together.setdefault(round(value * factor, 6), []).append(name)
    below, step_aside = -np.inf, 0
    crowded = 0.07 * (limit.high - limit.low) * factor
    for value, names in sorted(together.items()):
        look: dict[str, Any] = {"color": ACCENT, "lw": 1.2, "ls": (0, (1, 1.5)), "zorder": 5}
        axes.axhline(value, **look)
        # A label too close above the one below stands to its left.
        step_aside = (step_aside + 1) % 4 if value - below < crowded else 0
        below = value
        axes.annotate(
            f"{', '.join(names)}", (0.995 - 0.16 * step_aside, value), xycoords=("axes fraction", "data"),
            xytext=(0, 2), textcoords="offset points", ha="right", va="bottom", fontsize=SMALL, color=ACCENT, zorder=6,
            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.8},
        )  # fmt: skip


def _key(axes: Axes, limit: StableLimit, operating: bool, others: list[Line2D]) -> None:
    handles: list[Line2D | Patch] = [Patch(facecolor="white", edgecolor=INK, label="stable")]
    whole = limit.whole
    if np.all(limit.kind == LimitKind.BEYOND) and not (whole and len(whole.tongues)):
        handles[0].set_label("stable up to the end of the range")
    else:
        handles.append(Patch(facecolor=UNSTABLE, edgecolor=INK, label="unstable"))
        look: dict[str, Any] = {"lw": 1.4} if whole is None else {"marker": ".", "ls": ""}
        handles.append(Line2D([], [], color=EDGE, label=f"largest stable value at {len(limit.speed)} speeds", **look))
    if whole is not None and len(whole.tongues):
        handles.append(
            Line2D([], [], color=EDGE, lw=1.4, ls=(0, (4, 2)), label="ends of what is stable at every speed")
        )
    handles += others
    if operating:
        handles.append(Line2D([], [], color=ACCENT, ls=(0, (5, 3)), lw=1.5, label="operating speed"))
    key_below(axes, 2 if others else 3, handles)
