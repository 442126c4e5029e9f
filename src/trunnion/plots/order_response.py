"""Torque of one spring over speed, order by order, under the sum over the cycle."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from trunnion.arrays import Array
from trunnion.design.assessment.course import Course
from trunnion.driveline.operation import Operation
from trunnion.driveline.quantities import TORQUE, shown
from trunnion.errors import InputError
from trunnion.plots.over_speed import hatched, over_speed
from trunnion.plots.style import INK, PATTERNS, TEXT, curve_style, key_below, new_axes, printed
from trunnion.response.orders.result import OrderResponse
from trunnion.results.speeds import order_name, speed_factor
from trunnion.results.units import angle_words
from trunnion.steady.orders.forced_response import LINEAR_RANGE

MOST_ORDERS = 6
"""Curves of single orders drawn, the largest of them."""
DECADES = 3.0
"""Orders whose peak is farther below the largest are not drawn."""
LIMIT = "#a50026"


def draw(
    result: OrderResponse,
    axes: Axes | None = None,
    *,
    spring: str | None = None,
    unit: str | None = None,
    operating: Operation | None = None,
    limit: float | None = None,
    limits: Mapping[str, float] | None = None,
) -> Axes:
    """Torque amplitude of each order [N m] and vibratory torque, on a logarithmic axis.

    Parameters
    ----------
    spring : name of a shaft or mesh; by default the one with the largest vibratory torque.
    unit : of the speed; by default the one of the driveline's description.
    operating : its speed is marked.
    limit : vibratory torque [N m] that the spring bears, as a line across.
    limits : limits of torque [N m] by name, by default those of the description; with "max torque" the largest
        torque, mean and all, is drawn too.

    Raises
    ------
    InputError : no such spring.
    """
    unit = unit or result.unit
    column = _column(result, spring)
    axes = axes or new_axes(7.2, 4.3)
    x = result.speed * speed_factor(unit)
    whole = result.vibratory_torque[:, column]
    size = np.abs(result.torque[:, :, column])
    words = "all together, at most" if result.sum_is_bound else "all together (half peak to peak)"
    low, largest = order_curves(axes, x, whole, size, result, words)
    stated = result.limits[result.springs[column]] if limits is None and limit is None else limits
    known = ({} if limit is None else {"limit": limit}) | dict(stated or {})
    for i, (name, value) in enumerate(known.items()):
        said = printed(shown(value, TORQUE, digits=4))
        axes.axhline(value, color=LIMIT, lw=1.8, ls=PATTERNS[i % len(PATTERNS)], label=f"{name} {said}")
    if "max torque" in known:
        peak = result.peak_torque[:, column]
        axes.plot(x, peak, color=INK, lw=1.2, ls=PATTERNS[2], label="largest torque, mean and all")
        largest = max(largest, float(np.nanmax(np.nan_to_num(peak), initial=0.0)))
    if largest > 0:
        logarithmic(axes, low / 2, 2 * max([largest, *known.values()]))
    _beyond_the_linear_range(axes, x, result)
    over_speed(axes, x, unit, "vibratory torque [N·m]", operating)
    axes.set_title(result.springs[column].replace("$", r"\$"), fontsize=TEXT, color=INK)
    words_are_long = not np.all(result.linear) or "transient vibratory torque" in known or "max torque" in known
    key_below(axes, 2 if words_are_long else 3, handlelength=2.6)
    return axes


def order_curves(
    axes: Axes, x: Array, whole: Array, size: Array, of: OrderResponse | Course, words: str
) -> tuple[float, float]:
    """``whole`` (speed,) over its largest orders ``size`` (speed, order); between which values they lie."""
    marker = "o" if len(x) == 1 else None
    strongest = np.argsort(-np.nan_to_num(size).max(axis=0, initial=0.0))[:MOST_ORDERS]
    peaks = np.nan_to_num(size).max(axis=0, initial=0.0)
    largest = float(np.nan_to_num(whole).max(initial=0.0))
    axes.plot(x, whole, color=INK, lw=2.2, label=words, marker=marker)
    drawn = [int(k) for k in sorted(strongest) if peaks[k] > largest / 10**DECADES]
    for i, k in enumerate(drawn, start=1):
        look = curve_style(i) if marker is None else {**curve_style(i), "marker": marker}
        axes.plot(x, size[:, k], label=order_name(float(of.order[k]), float(of.frequency[k])), lw=1.5, **look)
    least = min([float(np.nanmin(whole, initial=largest)), *(float(peaks[k]) for k in drawn)])
    return max(least, 2 * largest / 10 ** (DECADES + 0.5)), largest


def logarithmic(axes: Axes, low: float, high: float) -> None:
    """Numbers as a reader writes them, 0.1 and 20 rather than powers."""
    axes.set_yscale("log")
    axes.set_ylim(low, high)
    digits = (1.0, 2.0, 5.0) if high < 1e3 * low else (1.0,)
    axes.yaxis.set_major_locator(LogLocator(subs=digits))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_formatter(NullFormatter())


def _beyond_the_linear_range(axes: Axes, x: Array, result: OrderResponse) -> None:
    """Hatched where joints swing too far for linear theory, and where no steady motion exists."""
    lost = ~np.all(np.isfinite(result.mean_torque) & np.isfinite(result.vibratory_torque), axis=1)
    if np.any(~result.linear & ~lost) and len(x) > 1:
        hatched(
            axes, x, ~result.linear & ~lost, f"a joint swings by more than {angle_words(LINEAR_RANGE)}: indication only"
        )
    if np.any(result.unstable) and len(x) > 1:
        axes.fill_between(
            x, 0, 1, where=result.unstable, transform=axes.get_xaxis_transform(), step="mid",
            facecolor="#b9a7ad", lw=0, zorder=0, label="unstable: not reached",
        )  # fmt: skip
    for i, at in enumerate(x[lost]):
        label = "no steady motion: undamped resonance" if i == 0 else None
        axes.axvline(at, color=LIMIT, ls=PATTERNS[2], lw=1.4, label=label)


def _column(result: OrderResponse, spring: str | None) -> int:
    if spring is None:
        return int(np.argmax(np.nan_to_num(result.vibratory_torque).max(axis=0)))
    if spring not in result.springs:
        raise InputError(
            "is not a shaft or mesh of this result", key="spring", value=spring,
            remedy=f"there are {', '.join(result.springs)}",
        )  # fmt: skip
    return result.springs.index(spring)
