"""What a check compares with its limit, over speed, order by order."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from trunnion.analyses.assessment.course import Course
from trunnion.analyses.orders.result import order_name
from trunnion.driveline.operation import Operation
from trunnion.driveline.quantities import eye_unit
from trunnion.plots.order_response import LIMIT, logarithmic, mark_operating, order_curves
from trunnion.plots.style import INK, PATTERNS, SMALL, TEXT, new_axes, plain, printed
from trunnion.results.speeds import speed_factor

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]


def draw(course: Course, axes: Axes | None = None, *, unit: str, operating: Operation | None = None) -> Axes:
    """The value of a check on a logarithmic axis, its largest orders and its limits, over speed in ``unit``."""
    axes = axes or new_axes(7.2, 4.3)
    x = course.speed * speed_factor(unit)
    value = np.where(np.isfinite(course.value), course.value, np.nan)
    reached = [float(one.max()) for one in course.limits.values()]
    symbol, size = eye_unit(max([*reached, float(np.nanmax(value, initial=0.0))]), course.kind)
    names = [order_name(float(o), float(f)) for o, f in zip(course.order, course.frequency, strict=True)]
    low, high = order_curves(axes, x, value / size, course.by_order / size, names, f"all together ({course.says})")
    for i, (name, limit) in enumerate(course.limits.items()):
        axes.plot(x, limit / size, color=LIMIT, lw=1.8, ls=PATTERNS[i % len(PATTERNS)], label=_printed(name))
        low, high = min(low, float(limit.min()) / size), max(high, float(limit.max()) / size)
    if high > 0:
        logarithmic(axes, low / 2, 2 * high)
    if len(x) > 1:
        axes.set_xlim(x[0], x[-1])
    mark_operating(axes, x, operating, unit)
    axes.set_title(course.quantity.replace("$", r"\$"), fontsize=TEXT, color=INK)
    axes.set_xlabel(f"input speed [{unit}]", fontsize=TEXT, color=INK)
    axes.set_ylabel(f"{course.quantity.rpartition(' of ')[0]} [{printed(symbol)}]", fontsize=TEXT, color=INK)
    axes.grid(which="major", color="#dddddd", lw=0.6)
    plain(axes)
    axes.figure.figure.legend(loc="outside lower left", ncols=2, fontsize=SMALL, frameon=False, handlelength=2.6)
    return axes


def _printed(text: str) -> str:
    return text.replace("*", "·").replace("^2", "²").replace("$", r"\$")
