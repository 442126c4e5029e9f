"""A certificate as boxes: what is proved and what is left open, over the two directions that were split most."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from trunnion.arrays import Array
from trunnion.floquet.tolerance.certify import StabilityCertificate
from trunnion.plots.style import INK, TEXT, VERMILION, key_below, label_axes, new_axes
from trunnion.results.quantity_axes import quantity_axis

PROVED, OPEN, UNSTABLE = "#d6e6f2", "#b5b5b5", VERMILION
"""Light, dark and a mark: told apart in grey and by every kind of colour vision."""
MOST_LINES = 400
"""Boxes whose outlines are drawn; more of them would be all lines."""


def draw(found: StabilityCertificate, axes: Axes | None = None) -> Axes:
    """Boxes over the two directions that were split most; the others lie behind one another, open ones in front."""
    axes = axes if axes is not None else new_axes()
    names, units = ("speed", *found.parameters), ("rad/s", *found.units)
    across, up = most_split(found)
    shown = [quantity_axis(names[k], units[k], found.unit) for k in (across, up)]
    keys: list[Patch | Line2D] = []
    parts = (
        ("proved stable", found.proved_low, found.proved_high, PROVED, ""),
        ("left open", found.undecided_low, found.undecided_high, OPEN, "///"),
    )
    for order, (name, low, high, colour, hatch) in enumerate(parts):
        if not len(low):
            continue
        corners = _corners(low, high, (across, up)) * [shown[0].factor, shown[1].factor]
        edge = INK if len(low) <= MOST_LINES else "none"
        style: dict[str, Any] = {"facecolor": colour, "hatch": hatch, "edgecolor": edge, "linewidth": 0.4}
        axes.add_collection(PolyCollection(list(corners), zorder=1 + order, **style))
        keys.append(Patch(label=f"{name} ({len(low)} boxes)", facecolor=colour, hatch=hatch, edgecolor=INK, lw=0.4))
    if found.counterexample is not None:
        x, y = (found.counterexample[names[k]] * axis.factor for k, axis in zip((across, up), shown, strict=True))
        mark: dict[str, Any] = {"marker": "X", "ms": 11, "color": UNSTABLE, "mec": INK, "ls": ""}
        axes.plot(x, y, zorder=4, **mark)
        keys.append(Line2D([], [], label="unstable line", **mark))
    low, high = found.ends
    axes.set_xlim(low[across] * shown[0].factor, high[across] * shown[0].factor)
    axes.set_ylim(low[up] * shown[1].factor, high[up] * shown[1].factor)
    label_axes(axes, shown[0].label, shown[1].label, grid=False)
    axes.set_title(_title(found), fontsize=TEXT, color=INK, loc="left")
    key_below(axes, 3, keys)
    return axes


def most_split(found: StabilityCertificate) -> tuple[int, int]:
    """Speed and parameters as numbers from 0: the two that were halved most often, the lower first."""
    sides = np.concatenate([found.proved_high - found.proved_low, found.undecided_high - found.undecided_low])
    low, high = found.ends
    halved = np.log2((high - low) / np.maximum(sides, 1e-300)).mean(axis=0)
    first, second = np.sort(np.argsort(-halved, kind="stable")[:2]).tolist()
    return first, second


def _corners(low: Array, high: Array, sides: tuple[int, int]) -> Array:
    """Corners (box, corner, 2) of boxes seen along the other directions."""
    a, b = sides
    across, up = np.stack([low[:, a], high[:, a]]), np.stack([low[:, b], high[:, b]])
    return np.stack([across[[0, 1, 1, 0]].T, up[[0, 0, 1, 1]].T], axis=2)


def _title(found: StabilityCertificate) -> str:
    head = "proved stable" if found.counterexample is None else "not stable: one line is unstable"
    if found.verdict == "undecided":
        head = f"undecided: {100 * found.undecided_share:.3g} % of the volume left open"
    behind = len(found.parameters) - 1
    if not behind:
        return head
    others = "1 other direction" if behind == 1 else f"{behind} other directions"
    return f"{head}\nboxes of {others} behind one another"
