"""What pictures over the input speed share: limits, labels, the operating speed, hatched and shaded ranges."""

from __future__ import annotations

from matplotlib.axes import Axes

from trunnion.arrays import Array, Flags
from trunnion.driveline.operation import Operation
from trunnion.plots.style import ACCENT, label_axes
from trunnion.results.speeds import speed_factor


def over_speed(
    axes: Axes, x: Array, unit: str, up: str, operating: Operation | None = None, *, grid: bool = True
) -> None:
    """Limits and labels of a picture over input speeds ``x`` in ``unit``, and its mark at the operating speed."""
    if len(x) > 1:
        axes.set_xlim(x[0], x[-1])
    at = operating.speed * speed_factor(unit) if operating and operating.speed else None
    if at is not None and x[0] <= at <= x[-1]:
        mark_operating(axes, at)
    label_axes(axes, f"input speed [{unit}]", up, grid=grid)


def mark_operating(axes: Axes, at: float, zorder: float = 2) -> None:
    """A line across at the operating speed, in numbers of the axis."""
    axes.axvline(at, color=ACCENT, ls=(0, (5, 3)), lw=1.5, label="operating speed", zorder=zorder)


def hatched(axes: Axes, x: Array, where: Flags, words: str) -> None:
    """Speeds where what is drawn is an indication only."""
    axes.fill_between(
        x, 0, 1, where=where, transform=axes.get_xaxis_transform(), step="mid",
        facecolor="#e2e2e2", edgecolor="#8a8a8a", hatch="////", lw=0, zorder=0, label=words,
    )  # fmt: skip
