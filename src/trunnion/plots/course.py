"""What a check compares with its limit, over speed, order by order."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from trunnion.design.assessment.course import Course
from trunnion.driveline.operation import Operation
from trunnion.driveline.quantities import eye_unit
from trunnion.plots.order_response import LIMIT, logarithmic, order_curves
from trunnion.plots.over_speed import over_speed
from trunnion.plots.style import INK, PATTERNS, TEXT, key_below, new_axes, printed
from trunnion.results.speeds import speed_factor
from trunnion.results.units import signs


def draw(course: Course, axes: Axes | None = None, *, unit: str, operating: Operation | None = None) -> Axes:
    """The value of a check on a logarithmic axis, its largest orders and its limits, over speed in ``unit``."""
    axes = axes or new_axes(7.2, 4.3)
    x = course.speed * speed_factor(unit)
    value = np.where(np.isfinite(course.value), course.value, np.nan)
    reached = [float(one.max()) for one in course.limits.values()]
    symbol, size = eye_unit(max([*reached, float(np.nanmax(value, initial=0.0))]), course.kind)
    low, high = order_curves(axes, x, value / size, course.by_order / size, course, f"all together ({course.says})")
    for i, (name, limit) in enumerate(course.limits.items()):
        axes.plot(
            x, limit / size, color=LIMIT, lw=1.8, ls=PATTERNS[i % len(PATTERNS)], label=signs(name).replace("$", r"\$")
        )
        low, high = min(low, float(limit.min()) / size), max(high, float(limit.max()) / size)
    if high > 0:
        logarithmic(axes, low / 2, 2 * high)
    over_speed(axes, x, unit, f"{course.quantity.rpartition(' of ')[0]} [{printed(symbol)}]", operating)
    axes.set_title(course.quantity.replace("$", r"\$"), fontsize=TEXT, color=INK)
    key_below(axes, 2, handlelength=2.6)
    return axes
