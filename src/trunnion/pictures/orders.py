"""Torques over speed: order by order under their sum, of every shaft, over one period; and what a check compares."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TypeGuard

import numpy as np

from trunnion.arrays import Array
from trunnion.design.assessment.response_curve import ResponseCurve
from trunnion.driveline.operation import Operation
from trunnion.driveline.quantities import TORQUE, eye_unit, shown, signs
from trunnion.floquet.stability.stability_over_speed import StabilityOverSpeed
from trunnion.pictures.looks import curve
from trunnion.pictures.picture import Axis, Band, Item, Level, Line, Picture, single
from trunnion.pictures.shared import over_speed, place_of, printed, stretches
from trunnion.response.misfire import Misfire
from trunnion.response.orders.result import OrderResponse
from trunnion.response.speed_sweep import SpeedSweep
from trunnion.results.speeds import order_name, speed_factor
from trunnion.results.units import angle_words
from trunnion.results.words import Words
from trunnion.steady.orders.forced_response import LINEAR_RANGE

MOST_ORDERS = 6
"""Curves of single orders drawn, the largest of them."""
DECADES = 3.0
"""Orders whose peak is farther below the largest are not drawn."""
SHOWN = 4.0
"""Smallest amplitude of a shaft shown, in decades below the largest."""
INDICATION = f"swings by more than {angle_words(LINEAR_RANGE)}: indication only"


def order_response(
    result: OrderResponse,
    *,
    spring: str | None = None,
    unit: str | None = None,
    operating: Operation | None = None,
    limit: float | None = None,
    limits: Mapping[str, float] | None = None,
) -> Picture:
    """Torque amplitude of each order [N m] and vibratory torque, on a logarithmic axis; where it is not reached.

    Parameters
    ----------
    spring : name of a shaft or mesh; by default the one with the largest vibratory torque.
    unit : of the speed; by default the one of the driveline's description.
    operating : its speed is marked.
    limit : vibratory torque [N m] that the spring bears, as a line across.
    limits : limits of torque [N m] by name, by default those of the description; with "max torque" the largest
        torque, mean included, is drawn too.

    Raises
    ------
    InputError : no such spring.
    """
    drawn = torque_by_order(result, spring=spring, unit=unit, operating=operating, limit=limit, limits=limits)
    x = result.speed * speed_factor(unit or result.unit)
    return drawn.with_panel(
        items=(*drawn.panel.items, *stretches(x, result.unstable, "not reached", "unstable: not reached"))
    )


def torque_by_order(
    result: OrderResponse,
    *,
    spring: str | None = None,
    unit: str | None = None,
    operating: Operation | None = None,
    limit: float | None = None,
    limits: Mapping[str, float] | None = None,
) -> Picture:
    """``order_response`` without the stability of every speed, which takes longer."""
    unit = unit or result.unit
    column = _column(result, spring)
    x = result.speed * speed_factor(unit)
    words = "all together, at most" if result.sum_is_bound else "all together (half peak to peak)"
    size = np.abs(result.torque[:, :, column])
    items, low, largest = _order_curves(x, result.vibratory_torque[:, column], size, result, words)
    stated = result.limits[result.springs[column]] if limits is None and limit is None else limits
    known = ({} if limit is None else {"limit": limit}) | dict(stated or {})
    for i, (name, value) in enumerate(known.items()):
        items.append(Level(value, f"limit {i}", f"{name} {printed(shown(value, TORQUE, digits=4))}"))
    if "max torque" in known:
        peak = result.peak_torque[:, column]
        items.append(Line(x, peak, "largest", "largest torque, mean included"))
        largest = max(largest, float(np.nanmax(np.nan_to_num(peak), initial=0.0)))
    items += _beyond_the_linear_range(x, result)
    up = Axis("vibratory torque", "N m")
    if largest > 0:
        up = up.logarithmic(low / 2, 2 * max([largest, *known.values()]))
    return over_speed(x, unit, up, items, operating, title=result.springs[column])


def misfire(result: Misfire, *, unit: str | None = None, operating: Operation | None = None) -> Picture:
    """With the worst cylinder out of work: the spring whose torque it raises most, as ``order_response``, beside the
    largest vibratory torque of the line as stated."""
    spring, unit = result.raised, unit or result.unit
    drawn = order_response(result.response, spring=spring, unit=unit, operating=operating)
    usual = float(result.normal[result.springs.index(spring)])
    level = Level(usual, "stands", f"largest with {result.stated}: {printed(shown(usual, TORQUE, digits=4))}")
    items = (*drawn.panel.items, level) if np.isfinite(usual) else drawn.panel.items
    return drawn.with_panel(items=items, title=f"vibratory torque of {spring}, {result.worst_in_words}")


def course(found: ResponseCurve, *, unit: str, operating: Operation | None = None) -> Picture:
    """The value of a check on a logarithmic axis, its largest orders and its limits, over speed in ``unit``."""
    x = found.speed * speed_factor(unit)
    value = np.where(np.isfinite(found.value), found.value, np.nan)
    reached = [float(one.max()) for one in found.limits.values()]
    symbol, size = eye_unit(max([*reached, float(np.nanmax(value, initial=0.0))]), found.kind)
    items, low, high = _order_curves(x, value / size, found.by_order / size, found, f"all together ({found.says})")
    for i, (name, limit) in enumerate(found.limits.items()):
        items.append(Line(x, limit / size, f"limit {i}", signs(name)))
        low, high = min(low, float(limit.min()) / size), max(high, float(limit.max()) / size)
    up = Axis(found.quantity.rpartition(" of ")[0], printed(symbol))
    up = up.logarithmic(low / 2, 2 * high) if high > 0 else up
    return over_speed(x, unit, up, items, operating, title=found.quantity)


def same_looks(pictures: Sequence[Picture]) -> list[Picture]:
    """The pictures with one look for each order, that of the first in which it is drawn or the next that is free."""
    known: dict[str, str] = {}
    for one in pictures:
        for item in one.panel.items:
            if _is_order(item):
                known.setdefault(item.name, curve(1 + len(known)))
    return [
        one.with_panel(
            items=tuple(replace(item, role=known[item.name]) if _is_order(item) else item for item in one.panel.items)
        )
        for one in pictures
    ]


def _is_order(item: Item) -> TypeGuard[Line]:
    return isinstance(item, Line) and item.role.startswith(f"{curve(0).split()[0]} ")


def wave(result: OrderResponse, *, spring: str | None = None, unit: str | None = None) -> Picture:
    """Torque [N m] of one spring, as of ``order_response``, over a period at the first speed."""
    form, column = result.wave(), _column(result, spring)
    name = result.springs[column]
    title = f"torque of {name} over one period at {Words(unit or result.unit).speed(form.speed)}"
    items = [Line(1e3 * form.time, form.torque[:, column], curve(0), name)]
    across = Axis("time", "ms", 0.0, 1e3 * float(form.time[-1]))
    return single(across, Axis("torque", "N m"), items, height=3.6, title=title, key="")


def speed_sweep(sweep: SpeedSweep, *, unit: str = "", operating: Operation | None = None) -> Picture:
    """Half peak-to-peak torque of every shaft [N m], on a logarithmic axis since resonances span decades.

    Parameters
    ----------
    unit : of the speed; default the description's.
    operating : its speed is marked.
    """
    unit = unit or sweep.unit
    x, size = sweep.speed * speed_factor(unit), sweep.torque_amplitude
    items: list[Item] = [Line(x, size[:, i], curve(i), shaft) for i, shaft in enumerate(sweep.shafts)]
    items += stretches(x, ~sweep.linear, "indication", f"a joint's input {INDICATION}")
    known = size[np.isfinite(size)]
    largest = float(known.max(initial=0.0))
    up = Axis("torque amplitude", "N m")
    if largest > 0:
        up = up.logarithmic(max(float(known.min()), largest / 10**SHOWN) / 1.5, 2.0 * largest)
    return over_speed(x, unit, up, items, operating)


def growth_over_speed(found: StabilityOverSpeed, *, unit: str, operating: Operation | None = None) -> Picture:
    """Growth rate [1/s] of the slowest disturbance over speed in ``unit``; above zero the line is unstable."""
    x, rate = found.speed * speed_factor(unit), found.growth_rate
    items: list[Item] = [
        Line(x, rate, "line", "slowest disturbance"), Level(0.0, "limit of stability", "limit of stability")
    ]  # fmt: skip
    if np.any(rate > 0):
        items.append(Band(x, np.zeros(len(x)), np.where(rate > 0, rate, 0.0), "growing", "unstable"))
    low, high = float(np.nanmin(rate, initial=0.0)), float(np.nanmax(rate, initial=0.0))
    room = 0.08 * max(high - low, 1e-12)
    return over_speed(x, unit, Axis("growth rate", "1/s", low - room, high + room), items, operating, height=3.6)


def _order_curves(
    x: Array, whole: Array, size: Array, of: OrderResponse | ResponseCurve, words: str
) -> tuple[list[Item], float, float]:
    """``whole`` (speed,) over its largest orders ``size`` (speed, order), and between which values they lie."""
    peaks = np.nan_to_num(size).max(axis=0, initial=0.0)
    strongest = np.argsort(-peaks)[:MOST_ORDERS]
    largest = float(np.nan_to_num(whole).max(initial=0.0))
    drawn = [int(k) for k in sorted(strongest) if peaks[k] > largest / 10**DECADES]
    items: list[Item] = [Line(x, whole, "sum", words)]
    for i, k in enumerate(drawn, start=1):
        items.append(Line(x, size[:, k], curve(i), order_name(float(of.order[k]), float(of.frequency[k]))))
    least = min([float(np.nanmin(whole, initial=largest)), *(float(peaks[k]) for k in drawn)])
    return items, max(least, 2 * largest / 10 ** (DECADES + 0.5)), largest


def _beyond_the_linear_range(x: Array, result: OrderResponse) -> list[Item]:
    """Hatched where joints swing too far for linear theory; lines where no steady motion exists."""
    lost = ~np.all(np.isfinite(result.mean_torque) & np.isfinite(result.vibratory_torque), axis=1)
    words = "no steady motion: undamped resonance"
    return [
        *stretches(x, ~result.linear & ~lost, "indication", f"a joint {INDICATION}"),
        *(Level(float(at), "lost", "" if i else words, "x") for i, at in enumerate(x[lost])),
    ]


def _column(result: OrderResponse, spring: str | None) -> int:
    largest = int(np.argmax(np.nan_to_num(result.vibratory_torque).max(axis=0)))
    remedy = f"there are {', '.join(result.springs)}"
    return place_of(spring, result.springs, largest, "spring", "not a shaft or mesh of this result", remedy)
