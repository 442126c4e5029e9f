"""A stability chart as a picture: white is stable, dark unstable, darker where disturbances grow faster."""

from __future__ import annotations

from collections.abc import Iterable
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, ListedColormap
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import ScaledTranslation

from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline, hooke_joints
from trunnion.driveline.operation import Operation
from trunnion.driveline.parameters import SPEED
from trunnion.floquet.tongues.result import Tongues
from trunnion.modes.resonance_speeds import Resonance, resonance_speeds
from trunnion.plots.resonance_marks import mark_resonances
from trunnion.plots.style import ACCENT, INK, SMALL, TITLE, colour_bar, label_axes, new_axes, settle
from trunnion.plots.tongues import draw as draw_tongues
from trunnion.plots.tongues import hidden_key
from trunnion.results.chart import StabilityChart, is_log
from trunnion.results.quantity_axes import QuantityAxis, quantity_axis
from trunnion.results.speeds import show_speed, speed_factor
from trunnion.results.verdict import Verdict

SHADES = ("#bf4a33", "#8c2f39", "#4a1526", "#16060d")
"""Unstable, from slow to fast growth: falling lightness, all darker than what is not unstable."""
DECAY = ("#f3e3c3", "#e9f0f4", "#9fc4d8")
"""Stable everywhere, from slow to fast decay: all lighter than what is unstable."""
OTHERS = {
    Verdict.MARGINAL: ("#e9e9e9", "....", "marginal (no damping)"),
    Verdict.UNDECIDED: ("#c4c4c4", "////", "undecided (boundary)"),
    Verdict.FAILED: ("#ffffff", "xxxx", "not computed"),
}
"""Face, hatch and words of what is neither stable nor unstable."""
BESIDE: dict[str, Any] = {"pad": 0.02, "fraction": 0.045, "aspect": 28}
"""Place of the colour bar."""


def draw(
    chart: StabilityChart,
    axes: Axes | None = None,
    *,
    unit: str | None = None,
    resonances: Iterable[Resonance] | None = None,
    operating: Operation | None = None,
    tongues: Tongues | None = None,
) -> Axes:
    """Draw ``chart`` and return the axes (``axes.figure.savefig(…)``, or ``style.save``).

    Parameters
    ----------
    chart : what to draw.
    axes : to draw into; default a figure of its own.
    unit : of speeds, "rpm", "Hz" or "rad/s"; default the one of the description.
    resonances : named along the speed axis; default those of the chart's line up to order 2, () for none.
    operating : range and point to mark; default the operation of the chart's line.
    tongues : of the same line over the same axes, drawn as curves; those narrower than a pixel are marked.
    """
    line = chart.line  # None for matrices of one's own
    unit = unit or chart.unit
    operating = operating or (line.operation if line else None)
    axes = axes or new_axes()
    across = quantity_axis(chart.x_label, chart.x_unit, unit)
    up = quantity_axis(chart.y_label, chart.y_unit, unit)
    x, y = chart.x * across.factor, chart.y * up.factor
    _frame(axes, chart, x, y, across, up)
    _unstable(axes, chart, x, y)
    handles = [*_key(chart), *_others(axes, chart, x, y), *_operating(axes, chart, operating, across, up)]
    if tongues is not None:
        apart = float(np.diff(chart.x).max()) if len(chart.x) > 1 else 0.0
        draw_tongues(tongues, axes, unit=unit, pixel=apart)
        handles += [hidden_key()] if tongues.narrower_than(apart) else []
    settle(axes)  # the width decides what fits side by side
    width = 72 * axes.get_window_extent().width / axes.figure.dpi
    _legend(axes, handles, width)
    title, look = _title(chart, unit, int(width / (0.5 * TITLE))), {"fontsize": TITLE, "color": INK}
    axes.set_title(title, look, loc="left", linespacing=1.35, pad=10)
    if resonances is None and line is not None:
        resonances = resonance_speeds(line)
    if resonances and SPEED in (chart.x_label, chart.y_label):
        along = "x" if chart.x_label == SPEED else "y"
        settle(axes)  # now under title and legend: the length decides how many names fit
        room = mark_resonances(axes, resonances, speed_factor(unit), along=along)
        if along == "x":
            axes.set_title(title, look, loc="left", linespacing=1.35, pad=room + 10)
    return axes


def _frame(axes: Axes, chart: StabilityChart, x: Array, y: Array, across: QuantityAxis, up: QuantityAxis) -> None:
    for values, axis, set_scale, set_limits in (
        (x, axes.xaxis, axes.set_xscale, axes.set_xlim),
        (y, axes.yaxis, axes.set_yscale, axes.set_ylim),
    ):
        if is_log(values):
            set_scale("log")
            axis.set_major_formatter("{x:g}")
        set_limits(*((values[0], values[-1]) if len(values) > 1 else edges(values)))
    label_axes(axes, across.label, up.label, grid=False)
    axes.set_axisbelow(False)  # ticks over the mesh


def edges(values: Array) -> Array:
    """Edges of the cells around the points of an axis; a single point gets a cell of 2 % of its value."""
    if len(values) == 1:
        half = 0.01 * abs(float(values[0])) or 0.5
        return np.array([values[0] - half, values[0] + half])
    middle = (values[1:] + values[:-1]) / 2
    return np.concatenate([[2 * values[0] - middle[0]], middle, [2 * values[-1] - middle[-1]]])


def _unstable(axes: Axes, chart: StabilityChart, x: Array, y: Array) -> None:
    bad = chart.verdict == Verdict.UNSTABLE
    if not bad.any():
        _decay(axes, chart, x, y)
        return
    growth = 100 * (np.where(bad, chart.spectral_radius, np.nan) ** (2 * np.pi / chart.period) - 1)
    mesh = axes.pcolormesh(
        edges(x),
        edges(y),
        np.ma.masked_invalid(growth),
        cmap=LinearSegmentedColormap.from_list("unstable", SHADES),
        vmin=0.0,
        vmax=float(np.nanmax(growth)),
        rasterized=True,
    )
    colour_bar(axes, mesh, "growth per turn of the input [%]", **BESIDE)


def _decay(axes: Axes, chart: StabilityChart, x: Array, y: Array) -> None:
    """Where nothing is unstable, how fast the slowest disturbance dies out: the margin that is left."""
    if min(chart.verdict.shape) < 2 or chart.count(Verdict.STABLE) < chart.verdict.size:
        return
    decay = 100 * (1 - chart.spectral_radius ** (2 * np.pi / chart.period))
    low, high = float(decay.min()), float(decay.max())
    levels = MaxNLocator(7).tick_values(low, high) if high > 1.01 * low else np.array([0.99 * low, 1.01 * high])
    drawn = axes.contourf(x, y, decay, levels=levels, cmap=LinearSegmentedColormap.from_list("decay", DECAY))
    axes.contour(x, y, decay, levels=levels, colors=INK, linewidths=0.6)
    colour_bar(axes, drawn, "decay of the slowest disturbance per turn [%]", **BESIDE)


def _others(axes: Axes, chart: StabilityChart, x: Array, y: Array) -> list[Any]:
    """Hatched patches for the rest; a point of its own still shows by its grey."""
    handles = []
    for verdict, (face, hatch, words) in OTHERS.items():
        there = chart.verdict == verdict
        if not there.any():
            continue
        mesh = np.ma.masked_where(~there, there.astype(float))
        axes.pcolormesh(edges(x), edges(y), mesh, cmap=ListedColormap([face]), rasterized=True)
        if min(there.shape) > 1:
            drawn = axes.contourf(x, y, there.astype(float), levels=[0.5, 1.5], colors="none", hatches=[hatch])
            drawn.set_edgecolor("#555555")
            drawn.set_linewidth(0.0)
        handles.append(Patch(facecolor=face, edgecolor="#555555", hatch=hatch, label=words))
    return handles


def _key(chart: StabilityChart) -> list[Any]:
    handles = []
    if chart.count(Verdict.STABLE):
        everywhere = chart.count(Verdict.STABLE) == chart.verdict.size and min(chart.verdict.shape) > 1
        words = "stable at every point (yellow: slowest decay)" if everywhere else "stable"
        handles.append(Patch(facecolor=DECAY[1] if everywhere else "white", edgecolor=INK, label=words))
    if chart.count(Verdict.UNSTABLE):
        handles.append(Patch(facecolor=SHADES[1], edgecolor=INK, label="unstable (darker: faster)"))
    return handles


def _operating(
    axes: Axes, chart: StabilityChart, operating: Operation | None, across: QuantityAxis, up: QuantityAxis
) -> list[Any]:
    """The range as a bar along each axis' edge, the speed as a dashed line, the point as a diamond."""
    handles: list[Any] = []
    here: list[float | None] = []
    for label, axis, along in ((chart.x_label, across, "x"), (chart.y_label, up, "y")):
        low, high = sorted(getattr(axes, f"get_{along}lim")())
        ends = np.clip(np.multiply(_range_of(label, operating) or (0, 0), axis.factor), low, high)
        if ends[0] < ends[1]:
            edge = (ends, (0, 0)) if along == "x" else ((0, 0), ends)
            look: dict[str, Any] = {"color": ACCENT, "lw": 3, "solid_capstyle": "butt", "clip_on": False, "zorder": 6}
            axes.plot(*edge, transform=getattr(axes, f"get_{along}axis_transform")(), **look)
            handles = [Line2D([], [], color=ACCENT, lw=3, label="operating range")]
        value = _value_of(label, chart.line, operating)
        here.append(value * axis.factor if value is not None and low <= value * axis.factor <= high else None)
    if here[0] is not None and here[1] is not None:
        look = {"ms": 8, "mfc": "white", "mec": ACCENT, "mew": 2, "ls": "none", "zorder": 7}
        (point,) = axes.plot(here[0], here[1], "D", label="operating point", **look)
        return [*handles, point]
    for value, label, line in (
        (here[0], chart.x_label, axes.axvline),
        (here[1], chart.y_label, axes.axhline),
    ):
        if value is not None and label == SPEED:
            dashed: dict[str, Any] = {"color": ACCENT, "ls": (0, (5, 3)), "lw": 1.6, "zorder": 4}
            handles.append(line(value, label="operating speed", **dashed))
    return handles


def _range_of(label: str, operating: Operation | None) -> tuple[float, float] | None:
    if operating is None:
        return None
    if label == SPEED:
        return operating.speed_range
    return operating.angle_range if label.startswith("HookeJoint") and label.endswith(".angle") else None


def _value_of(label: str, line: Driveline | None, operating: Operation | None) -> float | None:
    """Where the line stands on an axis; None where that is not one number."""
    if label == SPEED:
        return operating.speed if operating else None
    owner, _, key = label.rpartition(".")
    if key != "angle" or line is None:
        return None
    angles = {abs(angle) for name, angle in hooke_joints(line) if owner in (name, "HookeJoint *")}
    return angles.pop() if len(angles) == 1 else None


def _legend(axes: Axes, handles: list[Any], width: float) -> None:
    """Below the axis label, outside the data; as many columns as fit into ``width`` [pt]."""
    below = axes.transAxes + ScaledTranslation(0, -44 / 72, axes.figure.dpi_scale_trans)
    axes.legend(
        handles=handles,
        loc="upper left",
        bbox_to_anchor=(0.0, 0.0),
        bbox_transform=below,
        ncols=_columns([SMALL * (0.5 * len(h.get_label()) + 4) for h in handles], width),
        fontsize=SMALL,
        frameon=False,
        borderaxespad=0.0,
        borderpad=0.0,
        handlelength=1.8,
        columnspacing=1.5,
    )


def _columns(widths: list[float], room: float) -> int:
    """The most columns, filled one after another, whose widest entries fit side by side."""
    for columns in range(len(widths), 1, -1):
        rows = -(-len(widths) // columns)
        if sum(max(widths[i : i + rows]) for i in range(0, len(widths), rows)) <= room:
            return columns
    return 1


def _title(chart: StabilityChart, unit: str, characters: int) -> str:
    """The line's name, and what is held fixed, in lines of so many characters."""
    line = chart.line
    if line is None:
        return "Stability chart"
    name = line.name or f"driveline of {len(line.elements)} elements"
    fixed = [] if chart.speed is None else [f"at {show_speed(chart.speed, unit)}"]
    varied = (chart.x_label, chart.y_label)
    if not any(label.startswith(("HookeJoint *", "factor of HookeJoint *")) for label in varied):
        angles = [f"{n} {np.rad2deg(a):.3g}°" for n, a in hooke_joints(line) if f"{n}.angle" not in varied]
        fixed += angles if len(angles) <= 3 else [f"{len(angles)} joint angles as described"]
    whole = [f"Stability of {name}", *([", ".join(fixed)] if fixed else [])]
    return "\n".join(fill(part, max(characters, 20)) for part in whole)
