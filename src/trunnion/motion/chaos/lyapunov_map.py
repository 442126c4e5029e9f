"""Lyapunov exponents over one parameter, and the largest over two; values are shared by threads."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextvars import copy_context
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Flags, Integers
from trunnion.driveline.driveline import Driveline
from trunnion.motion.chaos.chaos_subject import (
    BYTES_A_VALUE,
    as_system,
    first_starts,
    tilted_frame,
    usual_time,
    values_of,
    whole_number,
)
from trunnion.motion.chaos.lyapunov_spectrum import shear_bound
from trunnion.numerics.averages import average
from trunnion.numerics.integration.integration import IntegrationEnd
from trunnion.numerics.memory import require_memory
from trunnion.numerics.workers import Workers, workers_of_client
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, computed, coordinate, internal, labelled, variable
from trunnion.results.of_systems import about
from trunnion.results.outcome import Outcome
from trunnion.results.quantity_axes import axis_of_parameter
from trunnion.results.result import Result
from trunnion.results.variables import Attribute, Variable
from trunnion.systems.maps import TimedMap
from trunnion.systems.system import System
from trunnion.waiting import keep_time

Request = tuple[str, float, float, int]


@labelled
class LyapunovSweep(Result):
    """Exponents over one parameter, the largest first; NaN where the motion failed."""

    system: System = internal("that was followed")
    parameter: str = internal("that was moved")
    values: Array = coordinate("value", "{self.parameter_unit}", "{self.parameter}")
    exponents: Array = variable("value order", "1/s", "Lyapunov exponents, natural logarithm", name="exponent")
    half_width: Array = variable("value order", "1/s", "of the intervals of confidence")
    periods: int = attribute("averaged over")
    transient: int = attribute("periods left out before")
    tolerance: float = attribute("error allowed per step")
    outcome: Outcome = internal("how it ended")

    @property
    def parameter_unit(self) -> str:
        """SI unit of the parameter."""
        return self.system.parameter_units.get(self.parameter, "1")

    @property
    @computed(coordinate("order"), after="values")
    def order(self) -> Integers:
        """Number of each exponent, from 1 (order,)."""
        return np.arange(1, self.exponents.shape[1] + 1)

    @property
    def positive(self) -> Flags:
        """Where (values,) the largest exponent is above 0 by more than its interval."""
        return np.asarray(self.exponents[:, 0] - self.half_width[:, 0] > 0)

    def declared(self) -> Iterator[Variable | Attribute]:
        """What the fields hold, and the system."""
        yield from super().declared()
        yield from about(self.system, self.outcome)

    def plot(self, axes: Axes | None = None, *, mark: float | None = None) -> Axes:
        """Exponents over the parameter."""
        return drawing(self, "plot")(self, axes, mark=mark)

    def __str__(self) -> str:
        known = np.isfinite(self.exponents[:, 0])
        along = axis_of_parameter(self.system, self.parameter)
        head = (
            f"Lyapunov exponents of {self.system.name} over {self.parameter} = {self.values[0] * along.factor:.6g} … "
            f"{along.number(float(self.values[-1]))}, {len(self.values)} values, {self.periods} periods each"
        )
        if not known.any():
            return f"{head}\n  {self.outcome}"
        top = int(np.nanargmax(self.exponents[:, 0]))
        at = along.number(float(self.values[top]))
        most = f"{self.exponents[top, 0]:+.5g} ± {self.half_width[top, 0]:.2g} 1/s at {at}"
        share = f"positive at {int(self.positive.sum())} of {int(known.sum())}"
        return f"{head}\n  {share}; the largest is {most}\n  {self.outcome}"


@labelled
class LyapunovMap(Result):
    """The largest exponent over two parameters; NaN where the motion failed."""

    system: System = internal("that was followed")
    parameters: tuple[str, str] = internal("along x and along y")
    x: Array = coordinate("x", "{self.parameter_units[0]}", "{self.parameters[0]}")
    y: Array = coordinate("y", "{self.parameter_units[1]}", "{self.parameters[1]}")
    exponent: Array = variable("y x", "1/s", "largest Lyapunov exponent, natural logarithm")
    half_width: Array = variable("y x", "1/s", "of its interval of confidence")
    periods: int = attribute("averaged over")
    transient: int = attribute("periods left out before")
    tolerance: float = attribute("error allowed per step")
    threads: int = internal("that computed it")
    outcome: Outcome = internal("how it ended")

    @property
    def parameter_units(self) -> tuple[str, ...]:
        """SI units of the parameters."""
        return tuple(self.system.parameter_units.get(parameter, "1") for parameter in self.parameters)

    @property
    def positive(self) -> Flags:
        """Where (y, x) the exponent is above 0 by more than its interval."""
        return np.asarray(self.exponent - self.half_width > 0)

    def declared(self) -> Iterator[Variable | Attribute]:
        """What the fields hold, and the system."""
        yield from super().declared()
        yield from about(self.system, self.outcome)

    def plot(self, axes: Axes | None = None) -> Axes:
        """The map in colour, white at 0; see ``pictures.chaos.lyapunov_map``."""
        return drawing(self, "plot")(self, axes)

    def __str__(self) -> str:
        known = int(np.isfinite(self.exponent).sum())
        share = 100 * float(self.positive.sum()) / max(known, 1)
        return (
            f"largest Lyapunov exponent of {self.system.name} over {self.parameters[0]} and {self.parameters[1]}, "
            f"{len(self.x)} × {len(self.y)} points, {self.periods} periods each\n"
            f"  positive at {share:.3g} % of {known}; from {np.nanmin(self.exponent):+.4g} to "
            f"{np.nanmax(self.exponent):+.4g} 1/s\n  {self.outcome}"
        )


def lyapunov_sweep(
    subject: System | Driveline,
    parameter: str,
    values: ArrayLike | tuple[float, float, int],
    *,
    periods: int = 1000,
    transient: int = 300,
    exponents: int | None = None,
    speed: float | str | None = None,
    start: ArrayLike | None = None,
    interval: float | None = None,
    tolerance: float = 1e-9,
    threads: int | None = None,
    client: Any = None,
    progress: Callable[[float], None] | None = None,
) -> LyapunovSweep:
    """Lyapunov exponents at every value of one parameter, each motion beginning at ``start``.

    Parameters
    ----------
    subject : a ``System``, or a ``Driveline``.
    parameter : a name among the system's parameters; of a driveline "speed" or "HookeJoint 1.angle", say.
    values : (first, last, how many), or rising values (values,), in SI units.
    periods : averaged over.
    transient : periods left out before.
    exponents : how many, the largest first; by default all.
    speed : input speed of a driveline [rad/s], where it is not the parameter.
    start : state (n,); by default the system's own.
    interval : length of a period [s] where the system has none; by default about once around.
    tolerance : error allowed per step.
    threads : by default one per processor.
    client : a ``distributed.Client``, whose workers compute the same numbers instead.
    progress : called as progress(share done).

    Returns
    -------
    LyapunovSweep: exponents (values, exponents) [1/s] and half the widths of their intervals of confidence.

    Raises
    ------
    InputError : no such parameter; a wrong count.

    Examples
    --------
    >>> import trunnion as tn
    >>> duffing = tn.reference_system("duffing")
    >>> found = tn.lyapunov_sweep(duffing, "force", (0.1, 0.3, 3), periods=200, transient=100)
    >>> found.exponents.shape, bool((found.exponents < 0).all())
    ((3, 2), True)
    """
    system = as_system(subject, speed)
    chosen = values_of(system, parameter, values)
    count = whole_number("exponents", system.size if exponents is None else exponents, 1, system.size)
    points = [{parameter: float(v)} for v in chosen]
    mean, width, failed = _all(
        system,
        points,
        count,
        periods,
        transient,
        start,
        interval,
        tolerance,
        _threads(threads),
        workers_of_client(client),
        progress,
    )
    order = np.argsort(-mean, axis=1, kind="stable")
    mean, width = np.take_along_axis(mean, order, 1), np.take_along_axis(width, order, 1)
    return LyapunovSweep(
        system, parameter, chosen, mean, width, periods, transient, tolerance, _failed_in_part(failed, len(chosen))
    )


def lyapunov_map(
    subject: System | Driveline,
    x: Request,
    y: Request,
    *,
    periods: int = 500,
    transient: int = 100,
    speed: float | str | None = None,
    start: ArrayLike | None = None,
    interval: float | None = None,
    tolerance: float = 1e-8,
    threads: int | None = None,
    client: Any = None,
    progress: Callable[[float], None] | None = None,
) -> LyapunovMap:
    """The largest Lyapunov exponent over two parameters, each motion beginning at ``start``.

    Parameters
    ----------
    subject : a ``System``, or a ``Driveline``.
    x, y : (parameter, first, last, how many), in SI units.
    periods : averaged over.
    transient : periods left out before.
    speed : input speed of a driveline [rad/s], where it is not a parameter of the map.
    start : state (n,); by default the system's own.
    interval : length of a period [s] where the system has none; by default about once around.
    tolerance : error allowed per step.
    threads : by default one per processor.
    client : a ``distributed.Client``, whose workers compute the same numbers instead.
    progress : called as progress(share done).

    Returns
    -------
    LyapunovMap: the exponent [1/s] at every pair of values, and an outcome for those that were not reached.

    Raises
    ------
    InputError : no such parameter; a wrong count or range.

    Examples
    --------
    >>> import trunnion as tn
    >>> duffing = tn.reference_system("duffing")
    >>> found = tn.lyapunov_map(duffing, ("force", 0.1, 0.3, 3), ("frequency", 0.9, 1.1, 2), periods=50)
    >>> found.exponent.shape, bool((found.exponent < 0).all())
    ((2, 3), True)
    """
    system = as_system(subject, speed)
    columns, rows = values_of(system, x[0], x[1:]), values_of(system, y[0], y[1:])
    needed = float(BYTES_A_VALUE) * len(rows) * len(columns)
    require_memory(needed, key="x, y", value=f"{len(columns)} x {len(rows)}", remedy="ask for fewer values")
    points = [{x[0]: float(a), y[0]: float(b)} for b in rows for a in columns]
    used = _threads(threads)
    mean, width, failed = _all(
        system, points, 1, periods, transient, start, interval, tolerance, used, workers_of_client(client), progress
    )
    shape = (len(rows), len(columns))
    return LyapunovMap(
        system, (x[0], y[0]), columns, rows, mean.reshape(shape), width.reshape(shape), periods, transient, tolerance,
        used, _failed_in_part(failed, len(points)),
    )  # fmt: skip


@dataclass(frozen=True)
class _Question:
    """What is asked at every point: ``count`` exponents of ``system`` from ``state``."""

    system: System
    count: int
    periods: int
    transient: int
    state: Array
    interval: float | None
    tolerance: float

    def at(self, point: Mapping[str, float]) -> tuple[Array, Array] | None:
        """Exponents (count,) and half widths of their intervals; None where the motion did not reach its end."""
        here = self.system.with_parameters(point)
        length = self.interval or here.forcing_period or usual_time(here, self.state, self.tolerance)
        frame = tilted_frame(self.system, self.count)
        motion = TimedMap.over(here, length, tolerance=self.tolerance).motion(self.state, frame)
        found = motion.run(self.transient)
        if found.end is IntegrationEnd.REACHED:
            found = motion.run(self.periods)
        if found.end is not IntegrationEnd.REACHED:
            return None
        result, bound = average(found.growth / length), shear_bound(self.periods, length)
        # What lies within the bound may be 0 and only seem not to be.
        width = np.where(np.abs(result.mean) <= bound, np.fmax(result.half_width, bound), result.half_width)
        return np.asarray(result.mean), np.asarray(width)

    def at_each(self, points: Sequence[Mapping[str, float]]) -> list[tuple[Array, Array] | None]:
        """The same of several points, which a worker does in turn."""
        return [self.at(point) for point in points]


def _all(
    system: System, points: list[dict[str, float]], count: int, periods: int, transient: int, start: ArrayLike | None,
    interval: float | None, tolerance: float, threads: int, workers: Workers | None,
    progress: Callable[[float], None] | None,
) -> tuple[Array, Array, list[str]]:  # fmt: skip
    whole_number("periods", periods, 1)
    whole_number("transient", transient, 0)
    question = _Question(system, count, periods, transient, first_starts(system, start, 1)[0], interval, tolerance)
    mean, width = np.full((len(points), count), np.nan), np.full((len(points), count), np.nan)
    report_progress = progress or (lambda share: None)
    failed: dict[int, str] = {}
    found = _by_threads(question, points, threads) if workers is None else _by_workers(question, points, workers)
    for done, (place, one) in enumerate(found, start=1):
        if one is None:
            failed[place] = str(points[place])
        else:
            mean[place], width[place] = one
        report_progress(done / len(points))
    return mean, width, [failed[place] for place in sorted(failed)]


def _by_threads(question: _Question, points: list[dict[str, float]], threads: int) -> Iterator[tuple[int, Any]]:
    with ThreadPoolExecutor(threads if question.system.compiled else 1) as pool:
        waiting = [pool.submit(copy_context().run, question.at, point) for point in points]
        try:
            for place, each in enumerate(waiting):
                yield place, each.result()
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


def _by_workers(question: _Question, points: list[dict[str, float]], workers: Workers) -> Iterator[tuple[int, Any]]:
    parts = workers.parts(len(points))
    left = len(parts)
    for number, found in workers.each(question.at_each, ([points[k] for k in part] for part in parts)):
        yield from zip(parts[number], found, strict=True)
        left -= 1
    if left:
        keep_time()


def _threads(threads: int | None) -> int:
    if threads is not None:
        return whole_number("threads", threads, 1)
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _failed_in_part(failed: list[str], total: int) -> Outcome:
    if not failed:
        return Outcome(True, "reached", "every point was reached")
    sentence = f"at {len(failed)} of {total} points the motion did not reach its end, first {failed[0]}"
    return Outcome(False, "failed in part", sentence)
