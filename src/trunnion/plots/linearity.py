"""Linear beside nonlinear: the amplitude of every order of one spring, and how far the two are apart."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from trunnion.errors import InputError
from trunnion.motion.linearity.linearity_check import LinearityCheck
from trunnion.plots.style import ACCENT, INK, SMALL, TEXT, VERMILION, label_axes, new_axes
from trunnion.results.speeds import show_speed

MOST = 16
"""Orders drawn, the largest of them."""
BAR = 0.38


def draw(
    check: LinearityCheck, axes: Axes | None = None, *, spring: str | None = None, unit: str | None = None
) -> Axes:
    """Two bars an order [N m], linear and nonlinear; a mark at the size of their difference, phases counted.

    Parameters
    ----------
    spring : name of a shaft, mesh or coupling; by default the one where the two are farthest apart.
    unit : of the speed; by default the one of the driveline's description.

    Raises
    ------
    InputError : no such spring; no motion to draw.
    """
    check.nonlinear.outcome.require()
    s = _column(check, spring)
    axes = axes if axes is not None else new_axes(7.2, 3.9)
    linear, true = np.abs(check.linear_torque[:, s]), np.abs(check.nonlinear_torque[:, s])
    shown = np.sort(np.argsort(-np.fmax(linear, true), kind="stable")[:MOST])
    x = np.arange(len(shown))
    axes.bar(x - BAR / 2, linear[shown], BAR, color=ACCENT, label="linear")
    axes.bar(x + BAR / 2, true[shown], BAR, color=VERMILION, hatch="//", edgecolor="white", lw=0, label="nonlinear")
    axes.plot(x, check.difference[shown, s], "_", ms=16, mew=2.2, color=INK, label="difference, phases counted")
    axes.set_xticks(x, [f"{check.order[k]:.4g}" for k in shown])
    label_axes(axes, "order [cycles per turn of the input]", f"torque of {check.springs[s]} [N·m]", grid=False)
    words = "linear theory holds" if check.holds else "linear theory misleads"
    at = show_speed(check.speed, unit or check.unit)
    apart = f"apart by {100 * check.relative_difference[s]:.2g} % of the largest order"
    axes.set_title(f"{at}: {words}, {apart}", fontsize=TEXT, loc="left")
    axes.legend(fontsize=SMALL, frameon=False)
    return axes


def _column(check: LinearityCheck, spring: str | None) -> int:
    if spring is None:
        return int(np.nanargmax(check.relative_difference))
    if spring not in check.springs:
        raise InputError(
            "is not a spring of this line", key="spring", value=spring, remedy=f"it has: {', '.join(check.springs)}"
        )
    return check.springs.index(spring)
