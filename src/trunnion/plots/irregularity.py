"""Speed of every shaft over one turn of the input: what the joints make of a constant input speed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trunnion.analyses.kinetostatics.result import Kinetostatics
from trunnion.plots.style import INK, SMALL, TEXT, curve_style, new_axes, plain

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SAME = 1e-9


def draw(result: Kinetostatics, axes: Axes | None = None) -> Axes:
    """Speed about its own mean [%] of each shaft; shafts that turn alike share a curve."""
    axes = axes or new_axes(7.2, 3.4)
    turn = np.degrees(result.input_angle)
    percent = 100 * (result.speed / (result.input_speed * result.shaft_ratio)[:, None] - 1)
    groups: list[tuple[list[str], int]] = []
    for row, name in enumerate(result.shafts):
        for names, first in groups:
            if np.all(np.abs(percent[row] - percent[first]) <= 100 * SAME):
                names.append(name)
                break
        else:
            groups.append(([name], row))
    for i, (names, row) in enumerate(groups):
        label = ", ".join(names) if len(names) < 4 else f"{names[0]} … {names[-1]} ({len(names)} shafts)"
        axes.plot(turn, percent[row], **curve_style(i), lw=1.6, label=label)
    axes.set_xlim(0, 360 * result.turns)
    if result.turns == 1:
        axes.set_xticks(range(0, 361, 45))
    axes.axhline(0, color="#bbbbbb", lw=0.7, zorder=0)
    axes.set_xlabel("input angle [°]", fontsize=TEXT, color=INK)
    axes.set_ylabel("speed about its mean [%]", fontsize=TEXT, color=INK)
    plain(axes)
    axes.figure.figure.legend(
        loc="outside lower left", ncols=2, fontsize=SMALL, frameon=False, handlelength=2.6, columnspacing=1.5
    )
    return axes
