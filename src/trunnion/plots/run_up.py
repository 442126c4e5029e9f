"""A passage through resonance: torque envelope against the steady response."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from trunnion.motion.passing.run_up import RunUp
from trunnion.plots.style import COLOURS, FAINT, headed, key_below, label_axes, new_axes
from trunnion.results.speeds import about_speed, rounded_speed, show_acceleration, show_speed, speed_factor
from trunnion.results.verdict import Verdict


def draw(result: RunUp, axes: Axes | None = None, *, shaft: str = "", unit: str = "") -> Axes:
    """Largest |torque| of one shaft in every turn (the most loaded one, or ``shaft``) over input speed.

    The steady response is drawn where it was computed: full where the motion is stable, dotted where it is not.
    """
    axes = axes or new_axes(7.2, 4.3)
    i = result.shafts.index(shaft) if shaft else int(np.argmax(result.peak_torque))
    unit = unit or result.unit
    factor = speed_factor(unit)
    if result.steady is not None:
        x, y = result.steady.speed * factor, result.steady.largest[:, i]
        unstable = result.steady.verdict == Verdict.UNSTABLE
        axes.plot(x, np.where(unstable, np.nan, y), color=COLOURS[0], lw=1.6, label="steady motion, stable")
        if unstable.any():
            hollow: dict[str, Any] = {"color": COLOURS[0], "ms": 3, "mfc": "none"}
            axes.plot(x, np.where(unstable, y, np.nan), "o", label="steady motion, unstable", **hollow)
    axes.axhline(result.inertia_torque[i], color=FAINT, lw=1, ls="--", label="accelerates what is behind it")
    axes.plot(result.speed * factor, result.largest[:, i], color=COLOURS[1], lw=1.3, label="largest in each turn")
    axes.plot(
        result.peak_speed[i] * factor, result.peak_torque[i], "D", color=COLOURS[1], ms=6,
        label=f"{result.peak_torque[i]:.4g} N·m at {rounded_speed(result.peak_speed[i], unit)}",
    )  # fmt: skip
    label_axes(axes, f"input speed [{unit}]", f"largest torque of {result.shafts[i]} [N·m]")
    axes.set_ylim(bottom=0)
    asked = result.schedule
    ends = f"{show_speed(asked.first, unit)} to {show_speed(asked.last, unit)}"
    title = f"{ends} at {show_acceleration(asked.acceleration, unit)}"
    if result.ending is not None and result.ending.kind != "reached":
        hung = result.ending.hung_speed
        title += f": {result.ending.kind} at {about_speed(hung, unit)}"
        axes.axvline(hung * factor, color=FAINT, lw=1, ls=":", label="where it hangs")
    headed(axes, title)
    key_below(axes, 2)
    return axes
