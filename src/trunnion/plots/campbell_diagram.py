"""Campbell diagram: modes with their margin over speed, excitation lines, crossings by amplification."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from trunnion.arrays import Array
from trunnion.driveline.operation import Operation
from trunnion.plots.over_speed import over_speed
from trunnion.plots.resonance_marks import spread
from trunnion.plots.style import FAINT, INK, SMALL, VERMILION, key_below, new_axes
from trunnion.response.campbell_diagram import CampbellDiagram, ExcitationLine
from trunnion.results.speeds import speed_factor

BAND = "#dde6ee"
HEADROOM = 1.35
"""Height of the picture over the highest mode that is crossed, or else the lowest mode."""


def draw(
    result: CampbellDiagram,
    axes: Axes | None = None,
    *,
    unit: str | None = None,
    frequency_unit: str = "Hz",
    operating: Operation | None = None,
) -> Axes:
    """Draw ``result``: input speed in ``unit`` (default: the description's) across, frequency up.

    The area of a crossing's mark grows with its amplification.
    """
    unit = unit or result.unit
    axes = axes or new_axes(7.2, 4.6)
    x, y = speed_factor(unit), speed_factor(frequency_unit)
    speed = result.speed
    top = _top(result)
    axes.set_ylim(0, top * y)
    for m in range(len(result.mode)):
        w = result.frequency[:, m]
        low, high = (1 - result.margin) * w * y, (1 + result.margin) * w * y
        around = None if m else f"±{100 * result.margin:.3g} % of a mode"
        axes.fill_between(speed * x, low, high, color=BAND, lw=0, zorder=1, label=around)
        axes.plot(speed * x, w * y, color=INK, lw=1.3, zorder=3, label=None if m else "mode")
    for i, line in enumerate(result.lines):
        at = _ends(result, line)
        label = None if i else "excitation"
        axes.plot(at * x, line.at(at) * y, color=VERMILION, lw=1.2, zorder=2, label=label)
    for i, c in enumerate(result.crossings):
        if c.frequency <= top:
            size = 5 + 2.2 * min(np.log2(max(c.amplification, 1.0)), 6.0)
            label = None if i else "crossing, larger with 1/(2ζ)"
            axes.plot(
                c.speed * x, c.frequency * y, "o", ms=size, mfc="white", mec=VERMILION, mew=1.5, zorder=5,
                clip_on=False, label=label,
            )  # fmt: skip
    _name_lines(axes, result, top, x, y)
    _name_modes(axes, result, top, y, frequency_unit)
    over_speed(axes, speed * x, unit, f"frequency [{frequency_unit}]", operating, grid=False)
    key_below(axes, 3)
    return axes


def _top(result: CampbellDiagram) -> float:
    crossed = [c.frequency for c in result.crossings]
    lowest = float(np.nanmin(result.frequency)) if np.any(np.isfinite(result.frequency)) else float(result.speed[-1])
    reach = max((float(line.at(result.speed[-1])) for line in result.lines), default=lowest)
    return HEADROOM * max([lowest, *crossed]) if crossed else 1.06 * max(lowest, min(reach, HEADROOM * lowest))


def _ends(result: CampbellDiagram, line: ExcitationLine) -> Array:
    """Speeds [rad/s] between which an excitation is a straight line: the range, and where it stands still within it."""
    low, high = result.speed[[0, -1]]
    return np.array([low, line.standstill, high] if low < line.standstill < high else [low, high])


def _name_lines(axes: Axes, result: CampbellDiagram, top: float, x: float, y: float) -> None:
    """Each line's name near where it leaves the picture, lines of one slope together."""
    for line in result.lines:
        begin, end = map(float, _ends(result, line)[-2:])
        if line.order and line.at(end) > top:
            end = line.standstill + top / abs(line.order)
        at = begin + 0.93 * (end - begin)
        if end <= begin or (line.order and line.at(at) > top):
            continue
        text = line.name.removeprefix("order ") if not line.frequency else line.name
        axes.annotate(
            text, (at * x, float(line.at(at)) * y), fontsize=SMALL, color=VERMILION, ha="center",
            va="center", bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.0}, zorder=6,
        )  # fmt: skip


def _name_modes(axes: Axes, result: CampbellDiagram, top: float, y: float, unit: str) -> None:
    """Numbers and frequencies at the right edge, pushed apart where modes are close."""
    last = result.frequency[-1]
    seen = [m for m in np.argsort(last) if last[m] < top]
    if not seen:
        return
    height = 72 * axes.get_window_extent().height / axes.figure.dpi
    places = spread(np.array([last[m] for m in seen]) / top, 1.25 * SMALL / max(0.8 * height, 1.0))
    for m, place in zip(seen, places, strict=True):
        axes.annotate(
            f"{result.mode[m]}:  {last[m] * y:.4g} {unit}",
            xy=(1.0, last[m] / top), xycoords="axes fraction", xytext=(1.025, place), textcoords="axes fraction",
            fontsize=SMALL, color=INK, va="center", annotation_clip=False,
            arrowprops={"arrowstyle": "-", "color": FAINT, "lw": 0.6, "shrinkA": 2, "shrinkB": 0, "relpos": (0, 0.5)},
        )  # fmt: skip
