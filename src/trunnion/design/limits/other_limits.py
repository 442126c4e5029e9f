"""Limits of the description beside stability: the value of a parameter at which each is reached first, by speed.

What is limited is the linear steady response of every order (``order_response``), as ``assess`` compares it: torques,
stresses, twists, speed fluctuation, acceleration, and ratings of couplings. It is computed at an even grid of values of
the parameter, looked at closely where it has a maximum below its limit, and the first passage is solved for. It is no
polynomial whose zeros could be counted: a peak narrower than a step whose flanks no value of the grid shows is missed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from trunnion.arrays import Array, Places
from trunnion.design.assessment.measures import (
    OF_LIMITS,
    allowed_by,
    name_of,
    of_limit,
    of_rating,
    rating_name,
)
from trunnion.design.limits.result import OtherLimit
from trunnion.driveline.limits import LIMIT_KINDS, OneLimit
from trunnion.driveline.parameters import Columns
from trunnion.equations.coefficients import Assembly
from trunnion.errors import ComputationError, InputError
from trunnion.numerics.bracketing import bracketed
from trunnion.response.orders.response import response_of_table
from trunnion.response.orders.result import OrderResponse
from trunnion.response.peaks.peak_limits import required_of, service_factors

Progress = Callable[[float], None]
Reached = tuple[tuple[OtherLimit, ...], str]
SCAN = 24
"""Steps of the grid of values."""
EXACT = 1e-10
"""How closely a passage is solved for, as a share of the range."""
LOOKS, ROUNDS = 9, 5
"""Points across a maximum in each round of looking closely, each round a quarter as wide."""


@dataclass(frozen=True)
class LimitCheck:
    """One limit: its name, what it allows [unit], and what is compared with it, (case,), from a response of a table."""

    name: str
    allowed: float
    unit: str
    values: Callable[[OrderResponse, Array], Array]


def other_limits(
    assembly: Assembly, columns: Columns, speed: Array, low: float, high: float, scan: int, report_progress: Progress
) -> Reached:
    """The value between ``low`` and ``high`` at which each limit of the line is reached first at every ``speed``.

    Behind the limits stands in words how they were looked for.
    """
    demands = demands_of(assembly)
    if not demands:
        return (), ""
    search = _LimitSearch(assembly, columns, demands, speed)
    try:
        reached = search.first(np.linspace(low, high, scan + 1), report_progress)
    except (InputError, ComputationError) as error:
        return (), f"limits of the description are not compared: {str(error).splitlines()[0]}"
    found = tuple(OtherLimit(d.name, d.allowed, d.unit, r) for d, r in zip(demands, reached, strict=True))
    return found, (
        f"limits of the description: linear response at {scan + 1} values and at maxima between them, passages solved "
        "for; a narrower peak may be missing"
    )


def demands_of(assembly: Assembly) -> list[LimitCheck]:
    """Every limit and rating of the line that its response can be compared with."""
    line, found = assembly.line, []
    for limit in line.limits_by_element:
        if limit.key in OF_LIMITS:
            allowed, unit = limit.value * (1 - limit.margin), LIMIT_KINDS[limit.key].unit
            found.append(LimitCheck(name_of(limit), allowed, unit, partial(_of_limit, assembly, limit)))
    for name, element in zip(line.names, line.elements, strict=True):
        for key in element.ratings:
            rating = getattr(element, key)
            if rating is None:
                continue
            unit, look = "W" if key == "heat_rating" else "N*m", partial(_of_rating, assembly, name, key)
            allowed = allowed_by(rating, key, service_factors(assembly, name)[0]) * (1 - required_of(assembly, name))
            found.append(LimitCheck(rating_name(name, key), allowed, unit, look))
    return found


def _of_limit(assembly: Assembly, limit: OneLimit, response: OrderResponse, table: Array) -> Array:
    measure = of_limit(assembly, limit, table)
    return np.full(len(table), -np.inf) if measure is None else measure.values(response)


def _of_rating(assembly: Assembly, name: str, key: str, response: OrderResponse, table: Array) -> Array:
    return of_rating(assembly, name, key, 1.0).values(response)


@dataclass(frozen=True)
class _LimitSearch:
    assembly: Assembly
    columns: Columns
    demands: list[LimitCheck]
    speed: Array

    def over(self, value: Array, speed: Array) -> Array:
        """What is compared over what is allowed, less 1 (demand, point); infinite at an undamped resonance."""
        table = self.assembly.table(len(value), speed)
        self.columns.put(table, value)
        response = response_of_table(self.assembly, table)
        over = np.stack([d.values(response, table) / d.allowed - 1 for d in self.demands])
        return np.where(np.isnan(over), np.inf, over)

    def first(self, grid: Array, report_progress: Progress) -> Array:
        """The first value (demand, speed) at which each limit is reached; infinite where none is."""
        over = np.full((len(self.demands), len(self.speed), len(grid)), np.nan)
        known = len(grid)
        for i, value in enumerate(grid.tolist()):
            over[:, :, i] = self.over(np.full(len(self.speed), value), self.speed)
            report_progress((i + 1) / len(grid))
            if i and np.all((over[:, :, : i + 1] >= 0).any(axis=2)):
                known = i + 1
                break
        over = over[:, :, :known]
        flat = over.reshape(-1, known)
        place = np.arange(len(flat))
        reached = np.full(len(flat), np.inf)
        begin, end = self._brackets(flat, grid[:known])
        reached[flat[:, 0] >= 0] = grid[0]
        pick = np.flatnonzero(np.isfinite(end) & (flat[:, 0] < 0))
        if len(pick):
            reached[pick] = bracketed(
                lambda value, own: self._of(place[pick[own]], value), begin[pick], end[pick], EXACT * np.ptp(grid)
            )
        return reached.reshape(over.shape[:2])

    def _of(self, place: Places, value: Array) -> Array:
        """The function of each place (its demand and speed) at a value each."""
        demand, at = np.divmod(place, len(self.speed))
        over = self.over(value, self.speed[at])[demand, np.arange(len(place))]
        return np.minimum(over, 1e6)  # brackets need finite ends

    def _brackets(self, over: Array, grid: Array) -> tuple[Array, Array]:
        """Ends (place,) of the first step, or flank of a maximum, across which a limit is passed; infinite if none."""
        rises = (over[:, :-1] < 0) & (over[:, 1:] >= 0)
        some, step = rises.any(axis=1), rises.argmax(axis=1)
        begin = np.where(some, grid[step], np.inf)
        end = np.where(some, grid[np.minimum(step + 1, len(grid) - 1)], np.inf)
        inner = over[:, 1:-1]
        tops = (inner < 0) & (inner >= over[:, :-2]) & (inner >= over[:, 2:])
        tops &= (inner > over[:, :-2]) | (inner > over[:, 2:])  # not along what is constant
        tops &= np.arange(1, len(grid) - 1) < np.where(some, step + 1, len(grid))[:, None]
        for k in np.flatnonzero(tops.any(axis=0)):
            place = np.flatnonzero(tops[:, k])
            best, top = self._highest(place, grid[k], grid[k + 2])
            sooner = (top >= 0) & (best < end[place])
            begin[place[sooner]], end[place[sooner]] = grid[k], best[sooner]
        return begin, end

    def _highest(self, place: Places, low: float, high: float) -> tuple[Array, Array]:
        """Where each function is highest between two values of the grid, and its value there."""
        begin, end = np.full(len(place), low), np.full(len(place), high)
        best, top = begin.copy(), np.full(len(place), -np.inf)
        for _ in range(ROUNDS):
            value = begin[:, None] + (end - begin)[:, None] * np.linspace(0, 1, LOOKS)
            over = self._of(np.repeat(place, LOOKS), value.ravel()).reshape(value.shape)
            here = over.argmax(axis=1)[:, None]
            best, top = np.take_along_axis(value, here, 1)[:, 0], np.take_along_axis(over, here, 1)[:, 0]
            if np.all(top >= 0):
                break
            step = 2 * (end - begin) / (LOOKS - 1)
            begin, end = np.maximum(begin, best - step / 2), np.minimum(end, best + step / 2)
        return best, top
