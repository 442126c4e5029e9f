"""Torque of one spring over speed, order by order, under the sum over the cycle."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trunnion.analyses.orders.result import OrderResponse
from trunnion.driveline.operation import Operation
from trunnion.errors import InputError
from trunnion.plots.kinetostatics import COLOURS, DASHES
from trunnion.plots.style import ACCENT, INK, SMALL, TEXT, new_axes, plain
from trunnion.results.speeds import show_speed, speed_factor

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST_ORDERS = 6
"""Curves of single orders drawn, the largest of them."""
DECADES = 4.0
"""Smallest amplitude shown, in decades below the largest."""


def draw(
    result: OrderResponse,
    axes: Axes | None = None,
    *,
    spring: str | None = None,
    unit: str | None = None,
    operating: Operation | None = None,
) -> Axes:
    """Torque amplitude of each order [N m] and vibratory torque, on a logarithmic axis.

    Parameters
    ----------
    spring : name of a shaft or mesh; by default the one with the largest vibratory torque.
    unit : of the speed; by default the one of the driveline's description.
    operating : its speed is marked.

    Raises
    ------
    InputError : no such spring.
    """
    unit = unit or result.unit
    column = _column(result, spring)
    axes = axes or new_axes(7.2, 4.3)
    x = result.speed * speed_factor(unit)
    whole = result.vibratory_torque[:, column]
    size = np.abs(result.torque[:, :, column])
    strongest = np.argsort(-np.nan_to_num(size).max(axis=0, initial=0.0))[:MOST_ORDERS]
    largest = np.nanmax(whole, initial=0.0)
    words = "all together, at most" if result.sum_is_bound else "all together (half peak to peak)"
    axes.plot(x, whole, color=INK, lw=2.2, label=words)
    for i, k in enumerate(sorted(strongest)):
        if np.nanmax(size[:, k]) > largest / 10**DECADES:
            look = {"color": COLOURS[i % len(COLOURS)], "ls": DASHES[i % len(DASHES)], "lw": 1.4}
            axes.plot(x, size[:, k], label=_name(result, int(k)), **look)
    if largest > 0:
        axes.set_yscale("log")
        axes.set_ylim(max(np.nanmin(whole) / 20, largest / 10**DECADES), 2 * largest)
    if len(x) > 1:
        axes.set_xlim(x[0], x[-1])
    if operating and operating.speed and x[0] <= operating.speed * speed_factor(unit) <= x[-1]:
        axes.axvline(
            operating.speed * speed_factor(unit), color=ACCENT, ls=(0, (5, 3)), lw=1.5, label="operating speed"
        )
    axes.set_title(result.springs[column].replace("$", r"\$"), fontsize=TEXT, color=INK)
    axes.set_xlabel(f"input speed [{unit}]", fontsize=TEXT, color=INK)
    axes.set_ylabel("vibratory torque [N·m]", fontsize=TEXT, color=INK)
    axes.grid(which="major", color="#dddddd", lw=0.6)
    plain(axes)
    axes.figure.figure.legend(loc="outside lower left", ncols=3, fontsize=SMALL, frameon=False, handlelength=2.6)
    return axes


def _column(result: OrderResponse, spring: str | None) -> int:
    if spring is None:
        return int(np.nanargmax(np.nan_to_num(result.vibratory_torque).max(axis=0)))
    if spring not in result.springs:
        raise InputError(
            "is not a shaft or mesh of this result", key="spring", value=spring,
            remedy=f"there are {', '.join(result.springs)}",
        )  # fmt: skip
    return result.springs.index(spring)


def _name(result: OrderResponse, k: int) -> str:
    if not result.frequency[k]:
        return f"order {result.order[k]:.4g}"
    side = f" {result.order[k]:+g} per turn" if result.order[k] else ""
    return f"{show_speed(result.frequency[k], 'Hz')}{side}"
