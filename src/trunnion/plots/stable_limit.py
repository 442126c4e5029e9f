"""The largest stable value of a parameter over speed: stable below the line, not known to be above it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from trunnion.analyses.charts.stable_limit import LimitKind, StableLimit
from trunnion.driveline.operation import Operation
from trunnion.plots.quantity_axes import quantity_axis
from trunnion.plots.style import ACCENT, INK, SMALL, TEXT, new_axes, plain
from trunnion.results.speeds import speed_factor

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw(
    limit: StableLimit,
    axes: Axes | None = None,
    *,
    unit: str = "rpm",
    operating: Operation | None = None,
    values: dict[str, float] | None = None,
) -> Axes:
    """Draw ``limit`` over speed.

    Parameters
    ----------
    unit : of the speed.
    operating : its speed is marked.
    values : where the line stands, by name (SI units); each is a horizontal mark.
    """
    axes = axes or new_axes(7.2, 3.6)
    up = quantity_axis(limit.parameter, limit.unit, unit)
    order = np.argsort(limit.speed)
    x, y = limit.speed[order] * speed_factor(unit), limit.limit[order] * up.factor
    top = limit.high * up.factor
    axes.fill_between(x, y, top, color="#b9a7ad", lw=0, zorder=1)
    axes.plot(x, y, color="#4a1526", lw=1.4, zorder=3)
    ends = limit.kind[order] == LimitKind.BEYOND
    if ends.any() and not ends.all():
        axes.plot(x, np.where(ends, y, np.nan), color="white", lw=1.6, zorder=4)
    _values(axes, values or {}, up.factor, limit)
    if operating and operating.speed:
        axes.axvline(operating.speed * speed_factor(unit), color=ACCENT, ls=(0, (5, 3)), lw=1.5, zorder=5)
    axes.set_xlim(x[0], x[-1])
    axes.set_ylim(limit.low * up.factor, top)
    axes.set_xlabel(f"input speed [{unit}]", fontsize=TEXT, color=INK)
    axes.set_ylabel(up.label, fontsize=TEXT, color=INK)
    plain(axes)
    _key(axes, bool(ends.all()), bool(operating and operating.speed))
    return axes


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


def _key(axes: Axes, all_stable: bool, operating: bool) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Line2D | Patch] = [Patch(facecolor="white", edgecolor=INK, label="stable")]
    if all_stable:
        handles[0].set_label("stable up to the end of the scan")
    else:
        handles.append(Patch(facecolor="#b9a7ad", edgecolor=INK, label="at and above the first instability"))
    if operating:
        handles.append(Line2D([], [], color=ACCENT, ls=(0, (5, 3)), lw=1.5, label="operating speed"))
    axes.figure.figure.legend(handles=handles, loc="outside lower left", ncols=3, fontsize=SMALL, frameon=False)
