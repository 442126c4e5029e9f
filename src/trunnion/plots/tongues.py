"""Tongues as curves: their boundaries, tips and names, alone or over a stability chart."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from trunnion.arrays import Array, Flags
from trunnion.driveline.operating_speed import speed_unit
from trunnion.floquet.tongues.result import Tongue, Tongues
from trunnion.floquet.tongues.windows import StableWindows
from trunnion.plots.style import ACCENT, INK, SMALL, TEXT, label_axes, logarithmic, new_axes
from trunnion.results.quantity_axes import quantity_axis

FACE, EDGE = "#d9c3c9", "#4a1526"
WIDE = 100.0
"""How many times the low end of a searched range the high end must be for a logarithmic axis."""
LEAP = 100.0
"""How many times steeper than on the whole an edge must run to count as leaping."""
LABELLED = 12
"""Names written at most: those of the fastest growth."""


def draw(
    tongues: Tongues,
    axes: Axes | None = None,
    *,
    unit: str | None = None,
    pixel: float | None = None,
    labelled: int = LABELLED,
    wide: bool = False,
) -> Axes:
    """Draw ``tongues`` and return the axes.

    Parameters
    ----------
    axes : of a chart with the same axes and unit, to draw over; default a figure of its own.
    unit : of speeds; default the one of the description.
    pixel : distance of a chart's pixels along x (SI): tongues nowhere as wide are marked, as its picture may hide them.
    labelled : how many names are written.
    wide : whether y runs over powers of ten, in a figure of its own.
    """
    alone = axes is None
    axes = axes if axes is not None else new_axes()
    unit = unit or (speed_unit(tongues.line) if tongues.line is not None else "rad/s")
    across = quantity_axis(tongues.x_label, tongues.x_unit, unit)
    up = quantity_axis(tongues.y_label, tongues.y_unit, unit)
    hidden = set() if pixel is None else {t.number for t in tongues.narrower_than(pixel)}
    for tongue in tongues:
        edge = tongue.boundary * (across.factor, up.factor)
        if alone:
            axes.fill(edge[:, 0], edge[:, 1], color=FACE, lw=0, zorder=1)
        for side in (tongue.low, tongue.high):
            shown = np.where(_leaps(side, tongue), np.nan, side)
            axes.plot(shown * across.factor, tongue.y * up.factor, color=EDGE if alone else ACCENT, lw=1.1, zorder=6)
        if tongue.number in hidden:
            x, y = _middle(tongue)
            axes.plot(x * across.factor, y * up.factor, marker="v", ms=6, color=ACCENT, mec="white", zorder=7)
    if alone:
        axes.set_xlim(*(v * across.factor for v in tongues.x_range))
        if wide:
            logarithmic(axes, "y")
        axes.set_ylim(*(v * up.factor for v in tongues.y_range))
        label_axes(axes, across.label, up.label, grid=False)
        _names(axes, tongues, across.factor, up.factor, labelled)
    if not len(tongues):
        axes.text(0.5, 0.5, "no instability found", transform=axes.transAxes, ha="center", fontsize=TEXT, color=INK)
    return axes


def draw_windows(
    found: StableWindows, axes: Axes | None = None, *, unit: str | None = None, labelled: int = LABELLED
) -> Axes:
    """The unstable regions over speed and parameter, and the windows in which every speed is stable."""
    low, high = found.tongues.y_range
    axes = draw(found.tongues, axes, unit=unit, labelled=labelled, wide=0 < WIDE * low <= high)
    factor = quantity_axis(found.parameter, found.unit, "rad/s").factor
    for low, high in found.windows.tolist():
        axes.axhspan(low * factor, high * factor, color=ACCENT, alpha=0.12, lw=0, zorder=0)
    return axes


def hidden_key() -> Any:
    """What the marks mean, for a legend."""
    return Line2D([], [], marker="v", ls="", color=ACCENT, mec="white", ms=6, label="region narrower than a pixel")


def _leaps(side: Array, tongue: Tongue) -> Flags:
    """Where an edge leaps because another tongue joins or parts, so that no line is drawn across."""
    steps, apart = np.abs(np.diff(side)), np.abs(np.diff(tongue.y))
    steep = steps > LEAP * np.median(np.abs(side.max() - side.min()) / max(np.ptp(tongue.y), 1e-300)) * apart
    wide = steps > 0.3 * np.minimum(tongue.high - tongue.low, np.inf)[:-1]
    return np.append(steep & wide & (steps > 0.002 * np.ptp(tongue.boundary[:, 0])), False)


def _middle(tongue: Tongue) -> tuple[float, float]:
    k = len(tongue.y) // 2
    return float(tongue.low[k] + tongue.high[k]) / 2, float(tongue.y[k])


def _beginning(tongue: Tongue) -> tuple[float, float] | None:
    """Its tip, or from where on it is known."""
    faint = float(tongue.low[0] + tongue.high[0]) / 2, float(tongue.y[0])
    return faint if tongue.tip is None and "below" in tongue.fades else tongue.tip


def _names(axes: Axes, tongues: Tongues, across: float, up: float, most: int) -> None:
    """Names under the tips, leaving out those that would stand on another."""
    taken: list[tuple[float, float]] = []
    to_axes = axes.transData - axes.transAxes
    named = [(t.resonance, _beginning(t)) for t in tongues]
    for resonance, place in [one for one in named if None not in one][:most]:
        assert resonance is not None and place is not None
        x, y = place[0] * across, place[1] * up
        right, top = to_axes.transform((x, y))
        if any(abs(right - a) < 0.13 and abs(top - b) < 0.06 for a, b in taken):
            continue
        taken.append((right, top))
        near_left, near_right = right < 0.08, right > 0.92
        near_bottom = top < 0.05  # below it stand the numbers of the axis
        axes.annotate(
            resonance.label,
            (x, y),
            xytext=(4, 3) if near_bottom else (0, -3),
            textcoords="offset points",
            ha="left" if near_left or near_bottom and not near_right else "right" if near_right else "center",
            va="bottom" if near_bottom else "top",
            fontsize=SMALL,
            color=INK,
            zorder=8,
        )
