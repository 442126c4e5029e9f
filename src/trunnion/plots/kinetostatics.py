"""A turn of a transmission as pictures: curves over the input angle, polar curves, S2's four panels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from trunnion.arrays import Array
from trunnion.driveline.operating_speed import speed_unit
from trunnion.plots.style import (
    COLOURS,
    FAINT,
    INK,
    SMALL,
    STYLES,
    TEXT,
    TITLE,
    UNBROKEN,
    curve_style,
    head,
    label_axes,
    new_figure,
)
from trunnion.response.kinetostatics.result import Kinetostatics
from trunnion.results.speeds import show_speed, speed_factor

MARKS_PER_TURN = 8
SAME = 1e-9
"""Curves closer than this share of their size count as one."""
LEGEND_ROW = 0.24
"""Height of a row of a legend [inches]."""


@dataclass(frozen=True)
class _Curve:
    """What is drawn, under what name, in which colour and dash."""

    name: str
    values: Array
    style: int


def draw(result: Kinetostatics, *, unit: str | None = None) -> Figure:
    """Speeds, accelerations, torques and secondary couples over the input angle."""
    figure = new_figure(8.6, 7.2)
    axes = figure.subplots(2, 2, sharex=True)
    names, ratio, acceleration, torque = _shafts(result)
    percent = 100 * (ratio - 1)
    factor, torque_unit = _scale(torque, "N·m")
    alike = _alike(names, np.stack([percent, acceleration, torque], axis=1))
    _panel(axes[0, 0], result, _curves(alike, percent), "speed about its mean [%]")
    _panel(axes[0, 1], result, _curves(alike, acceleration), "angular acceleration [rad/s²]")
    geared = bool(np.any(np.abs(result.shaft_ratio) != 1))
    referring = "torque referred to the drive" if geared else "torque passed on"
    _panel(axes[1, 0], result, _curves(alike, torque / factor), f"{referring} [{torque_unit}]")
    words, couples = _couples(result)
    _panel(axes[1, 1], result, couples, words)
    axes[1, 1].set_ylim(bottom=0)
    _legend(figure, axes[0, 0], "outside lower left", "shafts")
    if couples:
        _legend(figure, axes[1, 1], "outside lower right", "forks", columns=2)
    head(figure, _title(result, unit))
    return figure


def draw_polar(result: Kinetostatics, *, unit: str | None = None) -> Figure:
    """Speeds, secondary couples and, where there are any, support forces around the turn."""
    names, ratio, _, _ = _shafts(result)
    panels = [("speed over its mean", _curves(_alike(names, ratio[:, None]), ratio))]
    if np.any(result.secondary_couple):
        panels.append(_couples(result))
    if result.supports is not None:
        panels.append(_of_vectors(result.supports.names, result.supports.force, "force on bearing", "N"))
    rows = max(len(curves) for _, curves in panels)
    height = 4.0 + LEGEND_ROW * rows
    figure = new_figure(3.9 * len(panels), height)
    grid = figure.add_gridspec(2, len(panels), height_ratios=[4.0, LEGEND_ROW * rows])
    for k, (label, curves) in enumerate(panels):
        axes = figure.add_subplot(grid[0, k], projection="polar")
        _polar(axes, result, label, curves)
        below = figure.add_subplot(grid[1, k])
        below.set_axis_off()
        below.legend(*axes.get_legend_handles_labels(), loc="upper center", borderaxespad=0, **_LEGEND)
    head(figure, _title(result, unit))
    return figure


def draw_paper(result: Kinetostatics) -> Figure:
    """S2's Figures 3 and 4: angular differences, speeds, accelerations and torques of two joints."""
    figure = new_figure(8.6, 7.0)
    axes = figure.subplots(2, 2, sharex=True)
    total = np.degrees(result.output_angle - result.mean_ratio * result.input_angle)
    _panel(axes[0, 0], result, [_Curve("output", total, 3)], "output − input angle [°]")
    axes[0, 0].yaxis.label.set_color(COLOURS[3])
    _twist_scale(axes[0, 0], result, 1e6 * result.twist[1])
    alike = _alike(result.shafts, np.stack([result.speed, result.acceleration, result.torque], axis=1))
    unit = speed_unit(result.line)
    _panel(axes[0, 1], result, _curves(alike, result.speed * speed_factor(unit)), f"angular speed [{unit}]")
    _panel(axes[1, 0], result, _curves(alike, result.acceleration), "angular acceleration [rad/s²]")
    _panel(axes[1, 1], result, _curves(alike, result.transmitted), "torque passed on [N·m]")
    for letter, ax in zip("abcd", axes.ravel(), strict=True):
        ax.set_title(letter, fontsize=TITLE, color=INK, loc="left", fontweight="bold")
    _legend(figure, axes[0, 1], "outside lower center", "b, c, d", columns=4)
    kind = "rigid" if result.rigid else "elastic"
    name = result.line.name or "transmission"
    head(figure, f"{name}, taken as {kind}")
    return figure


_LEGEND: dict[str, Any] = {"fontsize": SMALL, "frameon": False, "handlelength": 2.8, "labelcolor": INK}


def _title(result: Kinetostatics, unit: str | None) -> str:
    unit = unit or speed_unit(result.line)
    name = f"{result.line.name}: " if result.line.name else ""
    kind = "rigid shafts" if result.rigid else "elastic shafts"
    inertia = ", with inertia torques" if result.inertia else ""
    speed = f"input {show_speed(result.input_speed, unit)}".replace(" ", UNBROKEN)
    return f"{name}{kind}{inertia}, {speed}"


def _shafts(result: Kinetostatics) -> tuple[tuple[str, ...], Array, Array, Array]:
    """Names, speed over mean, acceleration, torque referred to the drive; the output where no Shaft is.

    Referred to the drive, torques behind a ratio share the scale of those in front of it.
    """
    if not result.shafts:
        speed = result.output_speed[None] / (result.input_speed * result.mean_ratio)
        return ("output",), speed, result.output_acceleration[None], result.drive_torque[None]
    ratio = result.shaft_ratio[:, None]
    speed = result.speed / (result.input_speed * ratio)
    return result.shafts, speed, result.acceleration, result.transmitted * ratio


def _couples(result: Kinetostatics) -> tuple[str, list[_Curve]]:
    return _of_vectors(result.forks, result.secondary_couple, "secondary couple on fork", "N·m")


def _of_vectors(names: Sequence[str], vectors: Array, words: str, unit: str) -> tuple[str, list[_Curve]]:
    """Sizes of vectors (name, 2, point): the words at their axis, and their curves."""
    size = np.hypot(vectors[:, 0], vectors[:, 1])
    factor, shown = _scale(size, unit)
    return f"{words} [{shown}]", _curves(_alike(names, size[:, None]), size / factor)


def _alike(names: Sequence[str], values: Array) -> list[tuple[str, int]]:
    """Names and rows of the curves (name, quantity, point) that differ; alike in every quantity is one."""
    size = np.max(np.abs(values), axis=(0, 2), initial=0.0)[:, None]
    return [(_joined(together), row) for together, row in groups(names, values, SAME * size)]


def groups(names: Sequence[str], values: Array, within: float | Array) -> list[tuple[list[str], int]]:
    """Names that share a curve, and the row of its values (name, …): none of them further apart than ``within``."""
    found: list[tuple[list[str], int]] = []
    for row, name in enumerate(names):
        for together, first in found:
            if np.all(np.abs(values[row] - values[first]) <= within):
                together.append(name)
                break
        else:
            found.append(([name], row))
    return found


def _joined(names: list[str]) -> str:
    return ", ".join(names) if len(names) < 4 else f"{names[0]}, {names[1]} and {len(names) - 2} more"


def _curves(alike: Sequence[tuple[str, int]], values: Array) -> list[_Curve]:
    return [_Curve(name, values[row], k) for k, (name, row) in enumerate(alike)]


def _closed(result: Kinetostatics, y: Array) -> tuple[Array, Array]:
    """Degrees and values with the end of the last turn put back, where the curve closes."""
    degrees = np.degrees(result.input_angle)
    return np.append(degrees, 360.0 * result.turns), np.append(y, y[0])


def _line(axes: Axes, x: Array, y: Array, curve: _Curve) -> None:
    every = max((len(x) - 1) // MARKS_PER_TURN, 1)
    marks = (5 * curve.style * every // 7 % every, every)  # those of different curves side by side
    axes.plot(x, y, **{**curve_style(curve.style), "markevery": marks}, linewidth=1.6, label=curve.name)


def _panel(axes: Axes, result: Kinetostatics, curves: Sequence[_Curve], label: str) -> None:
    for curve in curves:
        _line(axes, *_closed(result, curve.values), curve)
    place = axes.get_subplotspec()
    label_axes(axes, "input angle [°]" if place is None or place.is_last_row() else "", label)
    axes.set_xlim(0, 360 * result.turns)
    axes.set_xticks(np.arange(0, 360 * result.turns + 1, 90 * result.turns))
    axes.ticklabel_format(axis="y", useOffset=False)
    values = np.array([c.values for c in curves]) if curves else np.zeros(1)
    size, swing = float(np.max(np.abs(values))), float(np.ptp(values))
    if swing < 1e-9 * max(size, 1e-3):  # rounding of a level curve must not fill the panel
        middle = float(np.mean(values))
        margin = 0.05 * abs(middle) or 1.0
        axes.set_ylim(middle - margin, middle + margin)


def _legend(figure: Any, axes: Axes, where: str, title: str, columns: int = 1) -> None:
    handles, labels = axes.get_legend_handles_labels()
    if len(handles) > STYLES:
        title += f" (styles repeat after {STYLES})"
    legend = figure.legend(handles, labels, loc=where, title=title, ncols=columns, alignment="left", **_LEGEND)
    legend.get_title().set_fontsize(SMALL)
    legend.get_title().set_color(FAINT)


def _twist_scale(axes: Axes, result: Kinetostatics, twist: Array) -> None:
    """The twist of the shaft between the joints, thousands of times smaller, on a scale of its own."""
    right = axes.twinx()
    right.tick_params(labelsize=TEXT, colors=INK, direction="out")
    _line(right, *_closed(result, twist), _Curve("twist", twist, 1))
    right.set_ylabel("twist [µrad]", fontsize=TEXT, color=COLOURS[1])
    if not np.any(twist):
        right.set_ylim(-1, 1)


def _polar(axes: Any, result: Kinetostatics, label: str, curves: Sequence[_Curve]) -> None:
    axes.tick_params(labelsize=SMALL, colors=INK)
    for curve in curves:
        x, y = _closed(result, curve.values)
        _line(axes, np.radians(x), y, curve)
    values = np.array([c.values for c in curves])
    low, high = float(values.min()), float(values.max())
    swing = max(high - low, 1e-3 * abs(high), 1e-12)
    # a small swing about a large mean is shown about an inner circle that is not zero
    axes.set_rlim(low - swing if low > 2 * swing else 0.0, high + 0.05 * swing)
    axes.set_rlabel_position(22.5)
    axes.set_axisbelow(False)  # the numbers stay readable where curves cross them
    axes.yaxis.set_major_locator(MaxNLocator(4))
    axes.grid(True, color="#cccccc", linewidth=0.6)
    for text in axes.get_yticklabels():
        text.set_color(FAINT)
        text.set_bbox({"facecolor": "#ffffff", "edgecolor": "none", "alpha": 0.7, "pad": 0.6})
    axes.set_title(label, fontsize=TEXT, color=INK, pad=12)


def _scale(values: Array, unit: str) -> tuple[float, str]:
    """Factor and unit in which the largest value reads well."""
    return (1e3, f"k{unit}") if np.size(values) and np.max(np.abs(values)) >= 1e4 else (1.0, unit)
