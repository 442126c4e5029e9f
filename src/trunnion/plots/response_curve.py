"""A branch of periodic motions: peak-to-peak over the parameter, stable and unstable, with its jumps."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from trunnion.driveline.refusals import nearest
from trunnion.errors import InputError
from trunnion.motion.orbits.branch import PeriodicBranch
from trunnion.plots.style import COLOURS, FAINT, INK, key_below, label_axes, new_axes
from trunnion.results.quantity_axes import quantity_axis
from trunnion.results.verdict import Verdict

MARKS = {
    "fold": "o",
    "period doubling": "s",
    "Neimark–Sacker": "^",
    "branch point": "D",
    "grazing": "x",
}


def draw(
    result: PeriodicBranch, axes: Axes | None = None, *, curve: str = "", unit: str = "", jumps: bool = True
) -> Axes:
    """One curve (the first, or ``curve``): full where stable, dashed where not, special points marked.

    Parameters
    ----------
    unit : of a speed on the axis, by default that of the line's description.
    jumps : draw an arrow from every fold to the stable motion that is left there.

    Raises
    ------
    InputError : no such curve.
    """
    axes = axes or new_axes(7.2, 4.4)
    i = _place(result, curve)
    across = result.axis if not unit or result.label != "speed" else quantity_axis("speed", result.unit, unit)
    factor = across.factor
    x, y, stable = result.parameter * factor, result.peak_to_peak[:, i], result.stable
    # A fold or a doubling belongs to both sides, so that the line has no gap.
    between = (result.verdict != Verdict.STABLE) & (result.verdict != Verdict.UNSTABLE)
    axes.plot(x, np.where(stable | between, y, np.nan), color=COLOURS[0], lw=1.7, label="stable")
    if not stable.all():
        axes.plot(x, np.where(~stable, y, np.nan), color=COLOURS[1], lw=1.3, ls=(0, (4, 2)), label="unstable")
    for kind, mark in MARKS.items():
        points = [p for p in result.special if p.kind == kind]
        if points:
            places = [p.parameter * factor for p in points]
            axes.plot(places, [p.peak_to_peak[i] for p in points], mark, color=INK, ms=6, mfc="none", ls="", label=kind)
    if jumps:
        for fold in result.folds:
            landing = _landing(result, fold.parameter, float(fold.peak_to_peak[i]), i)
            if landing is not None:
                at = fold.parameter * factor
                arrow = {"arrowstyle": "-|>", "color": FAINT, "lw": 1.0, "shrinkA": 5, "shrinkB": 2}
                axes.annotate("", (at, landing), (at, float(fold.peak_to_peak[i])), arrowprops=arrow)
    name = result.curves[i]
    torque = result.curve_unit == "N*m"
    label_axes(axes, across.label, f"torque of {name}, peak to peak [N·m]" if torque else f"{name}, peak to peak")
    axes.set_ylim(bottom=0)
    key_below(axes, 4)
    return axes


def _place(result: PeriodicBranch, curve: str) -> int:
    if not curve:
        return 0
    if curve not in result.curves:
        raise InputError("is no curve of this branch", key="curve", value=curve, remedy=nearest(curve, result.curves))
    return result.curves.index(curve)


def _landing(result: PeriodicBranch, value: float, left: float, i: int) -> float | None:
    """The stable motion that a slow passage over a fold jumps to: the nearest other one at that parameter."""
    side = result.parameter - value
    found = []
    for k in np.flatnonzero(side[:-1] * side[1:] < 0):
        share = side[k] / (side[k] - side[k + 1])
        level = result.peak_to_peak[k, i] + share * (result.peak_to_peak[k + 1, i] - result.peak_to_peak[k, i])
        if result.stable[k] and result.stable[k + 1] and abs(level - left) > 0.03 * max(left, level):
            found.append(float(level))
    return min(found, key=lambda level: abs(level - left), default=None)
