"""Two lines side by side: every margin before and after, or what changed of frequencies and torques."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from trunnion.design.comparison.result import Comparison, Difference
from trunnion.errors import InputError
from trunnion.plots.style import ACCENT, INK, VERMILION, key_below, new_axes, rows_of_names

MARGIN = "margin of "
SHOWN = 12
"""Rows at most."""
EVEN, FARTHEST = 100.0, 1e6
"""Margins [%] up to which the axis is even, and beyond logarithmic; and where one without end stands."""
TICKS = (50.0, 100.0, 1e3, 1e4, 1e5, 1e6)
"""Numbers at an axis that is logarithmic beyond ±100 %, to either side of 0."""
BETWEEN = (300.0, 3e3)
"""More of them where there are few."""


def draw(found: Comparison, axes: Axes | None = None, *, most: int = SHOWN) -> Axes:
    """Margins of checks that differ, before as rings and after as dots; relative changes where nothing was judged."""
    margins = [one for one in found.of_kind("margin") if one.matters]
    if margins:
        margins.sort(key=lambda one: (_shown(found, one), np.nanmin([one.before, one.after])))
        return _margins(found, margins[:most], axes)
    moved = [one for one in found.differences if one.matters and np.isfinite(one.relative)]
    if not moved:
        unjudged = found.changes and None in found.verdicts
        remedy = "name speeds, as speeds=(tn.rpm(300), tn.rpm(2400))" if unjudged else "change a value"
        raise InputError("has nothing to draw: no result differs", element="comparison", remedy=remedy)
    return _changes(found, moved[:most], axes)


def _margins(found: Comparison, rows: list[Difference], axes: Axes | None) -> Axes:
    axes = axes if axes is not None else new_axes(7.6, 1.7 + 0.36 * len(rows))
    for place, one in enumerate(rows):
        ends = np.clip([100 * one.before, 100 * one.after], -FARTHEST, FARTHEST)
        better = not ends[1] < ends[0]
        axes.plot(ends, [place, place], color=ACCENT if better else VERMILION, lw=2.2, zorder=2)
        before, after = found.names if not place else (None, None)
        axes.plot(ends[:1], [place], "o", mfc="white", mec=INK, ms=7, zorder=3, label=before)
        axes.plot(ends[1:], [place], "o", color=INK, ms=7, zorder=3, label=after)
    axes.axvline(0.0, color=INK, lw=1.0)
    far = np.nanmax([abs(100 * end) for one in rows for end in (one.before, one.after)])
    words = "margin [%]" + ", logarithmic beyond ±100" * bool(far > EVEN)
    if far > EVEN:
        _logarithmic_beyond(axes)
    names = [one.name.removeprefix(MARGIN) + " (guideline, shown)" * _shown(found, one) for one in rows]
    return _finished(axes, names, words)


def _logarithmic_beyond(axes: Axes) -> None:
    """Even up to ``EVEN`` and logarithmic beyond, so that no two far margins fall onto one another."""
    low, high = axes.dataLim.intervalx
    axes.set_xscale("symlog", linthresh=EVEN, linscale=1.2)
    axes.set_xlim(min(1.5 * low, -0.2 * EVEN), max(1.5 * high, 0.2 * EVEN))
    ends = axes.get_xlim()
    every = (0.0, *TICKS, *(BETWEEN if max(-ends[0], ends[1]) < TICKS[3] else ()))
    axes.set_xticks([tick for t in every for tick in {-t, t} if ends[0] <= tick <= ends[1]])
    axes.xaxis.set_major_formatter(lambda value, _: f"{value + 0.0:,.0f}".replace(",", "\u202f").replace("-", "−"))
    axes.set_xticks([], minor=True)


def _shown(found: Comparison, margin: Difference) -> bool:
    """Whether a margin is that of a guideline that decides neither before nor after."""
    name = margin.name.removeprefix(MARGIN)
    every = [check for judged in found.assessments if judged for check in judged.checks if check.name == name]
    return not any(check.decides for check in every)


def _changes(found: Comparison, rows: list[Difference], axes: Axes | None) -> Axes:
    axes = axes if axes is not None else new_axes(7.6, 1.5 + 0.34 * len(rows))
    axes.barh(range(len(rows)), [100 * one.relative for one in rows], color=ACCENT, height=0.62, label=found.names[1])
    axes.axvline(0.0, color=INK, lw=1.0)
    return _finished(axes, [one.name for one in rows], f"change from {found.names[0]} [%]")


def _finished(axes: Axes, names: list[str], x: str) -> Axes:
    rows_of_names(axes, names, x)
    key_below(axes, 2, loc="outside lower right", labelcolor=INK)
    return axes
