"""Histories of torque that a fatigue life is made of: steady motions, simulations, run-ups, measured torques."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from math import nan

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.driveline.refusals import nearest
from trunnion.errors import InputError
from trunnion.motion.passing.passing_result import Passing
from trunnion.motion.passing.run_up import RunUp
from trunnion.motion.simulation.simulation import LineSimulation
from trunnion.motion.transients.result import Transient
from trunnion.numerics.turning_points import TurningPoints, reversals, turning_points
from trunnion.response.orders.result import OrderResponse
from trunnion.results.finding import Finding, Gravity
from trunnion.results.verdict import Verdict

Source = LineSimulation | RunUp | Transient | Passing | OrderResponse | Mapping[str, ArrayLike]
HOUR = 3600.0
FEWEST = 3
"""Values of a history: it goes and comes back."""
CELLS = 2
"""Of a cycle of the highest order, each looked at in eight parts."""
FIRST_WINDOW, MOST_CYCLES = 64, 200_000
"""Swings of the slowest excitation that a motion without a period is first counted over, and how many of the fastest
the longest window holds."""
SETTLED = 1e-2
"""Share of its swing that a torque may have in two windows and be the same."""


@dataclass(frozen=True)
class LoadHistory:
    """One history of torques and how often it comes.

    Parameters
    ----------
    source : a result of ``simulate``, ``run_up``, ``transient`` or ``passing``; of ``order_response``, at its first
        ``speed`` or the one asked for; or torques [N m] by the name of their element, each (points,).
    share : of the operating time that is spent so, over and over; the shares of all histories add up to 1.
    per_hour : how often it comes in an operating hour, instead.
    duration : of one pass of the torques [s]; measured torques with a ``share`` need it.
    name : in results.
    speed : of ``order_response`` [rad/s].

    Raises
    ------
    InputError : share and per_hour at once or neither, a history that is too short, numbers that are not finite.

    Examples
    --------
    >>> LoadHistory({"shaft": [0.0, 2400.0, -900.0, 0.0]}, per_hour=0.01, name="jam").name
    'jam'
    """

    source: Source
    share: float | None = None
    per_hour: float | None = None
    duration: float | None = None
    name: str = ""
    speed: float | None = None

    def __post_init__(self) -> None:
        given = [key for key in ("share", "per_hour") if getattr(self, key) is not None]
        if len(given) != 1:
            problem = "conflicts with share" if given else "is missing"
            raise InputError(problem, element=self._label, key="per_hour", value=self.per_hour, remedy="give one")
        for key in (*given, "duration"):
            value = getattr(self, key)
            if value is not None and not (np.isfinite(value) and value > 0):
                raise InputError("must be positive", element=self._label, key=key, value=value, remedy="0.5, say")
        if self.share is not None and self.share > 1:
            remedy = "0.6, say: all shares add up to 1"
            raise InputError(
                "is more than the whole", element=self._label, key="share", value=self.share, remedy=remedy
            )
        if isinstance(self.source, Mapping):
            if self.share is not None and self.duration is None:
                remedy = "say how many seconds the torques last, or give per_hour"
                raise InputError("is needed with share", element=self._label, key="duration", remedy=remedy)
            for name, values in self.source.items():
                self._check(name, values)
        elif not isinstance(self.source, LineSimulation | RunUp | Transient | Passing | OrderResponse):
            remedy = "give what simulate, run_up, transient, passing or order_response returns, or torques by element"
            kind = type(self.source).__name__
            raise InputError(
                f"is not a load history but of type {kind}", element=self._label, key="source", remedy=remedy
            )

    @property
    def _label(self) -> str:
        return f"history {self.name}".strip()

    def _check(self, name: str, values: ArrayLike) -> None:
        found = np.asarray(values, dtype=float)
        where = {"element": self._label, "key": name}
        if found.ndim != 1 or len(found) < FEWEST:
            problem = f"is too short: {found.size} values" if found.ndim == 1 else "is not a row of torques"
            raise InputError(problem, **where, remedy=f"give {FEWEST} torques or more: it goes and comes back")
        if not np.all(np.isfinite(found)):
            at = int(np.flatnonzero(~np.isfinite(found))[0])
            raise InputError(f"is not finite at value {at + 1}", **where, remedy="cut it out or fill it in")


@dataclass(frozen=True)
class TorqueHistory:
    """One history as it is counted.

    points : turning points [N m] by the name of the spring or element; rate : how often it comes [1/s]; more : what an
    amplitude may be low by [N m], by name, where there is no period to count; repeats : whether the end is followed by
    the beginning; without : why there is no motion to count, "" where there is one; findings : what is to be said of
    the motion.
    """

    name: str
    points: Mapping[str, TurningPoints] = field(default_factory=dict)
    rate: float = nan
    more: Mapping[str, float] = field(default_factory=dict)
    repeats: bool = True
    without: str = ""
    findings: tuple[Finding, ...] = ()

    def of(self, element: str, spring: str) -> TurningPoints:
        """The torque of an element, by its own name or by that of the spring which it is part of."""
        for name in (element, spring):
            if name in self.points:
                return self.points[name]
        remedy = nearest(element, self.points)
        raise InputError("has no torque of this element", element=f"history {self.name}", key=element, remedy=remedy)


def torque_history(history: LoadHistory, place: int) -> TorqueHistory:
    """What is counted of a history, the ``place``-th of all.

    Raises
    ------
    InputError : a motion that failed, or a speed that the response does not have.
    """
    source, name = history.source, history.name or f"history {place}"
    if isinstance(source, OrderResponse):
        at = 0 if history.speed is None else int(np.abs(source.speed - history.speed).argmin())
        if history.speed is not None and abs(source.speed[at] - history.speed) > 1e-9 * history.speed:
            known = ", ".join(source.words.speed(float(one)) for one in source.speed[:8])
            raise InputError(
                "is not a speed of the response", key="speed", value=history.speed, remedy=f"there are {known}"
            )
        return of_response(source, at, name, share=history.share, per_hour=history.per_hour)
    if isinstance(source, LineSimulation | RunUp | Transient | Passing):
        run = source.simulation if isinstance(source, RunUp) else source.run if isinstance(source, Passing) else source
        if not run.outcome.ok or (isinstance(source, Passing) and not source.passes):
            ended = source.outcome if isinstance(source, Passing) else run.outcome
            raise InputError(f"did not come to its end: {ended}", element=f"history {name}", remedy="mend the run")
        return of_run(run, name, share=history.share, per_hour=history.per_hour)
    points = {key: _of_values(np.asarray(values, dtype=float)) for key, values in source.items()}
    return TorqueHistory(name, points, _rate(history.share, history.per_hour, history.duration))


def of_run(
    run: LineSimulation | Transient, name: str, *, share: float | None = None, per_hour: float | None = None
) -> TorqueHistory:
    """A motion in time, from its beginning to its end."""
    points = dict(zip(run.shafts, turning_points(run.torque_at, run.cuts), strict=True))
    return TorqueHistory(name, points, _rate(share, per_hour, run.end - float(run.cuts[0])))


def of_response(
    response: OrderResponse, at: int, name: str, *, share: float | None = None, per_hour: float | None = None
) -> TorqueHistory:
    """One period of the steady motion at speed number ``at``; without a period, so long a part of it that a longer one
    swings no farther."""
    said = tuple(one for one in response.findings if one.gravity < Gravity.NOTE)
    spectrum, where = response.spectrum, response.words.speed(float(response.speed[at]))
    channels = spectrum.channels.torque
    amplitude, mean = spectrum.amplitude[at][:, channels], spectrum.mean[at, channels]
    if not (np.all(np.isfinite(amplitude)) and np.all(np.isfinite(mean))):
        return TorqueHistory(name, without=f"no steady state exists at {where}")
    if response.verdict[at] == Verdict.UNSTABLE:
        return TorqueHistory(name, without=f"the line is unstable at {where}")

    def torque(times: Array) -> Array:
        return spectrum.wave(at, amplitude, mean, times)

    turning = np.abs(spectrum.angular_frequency[at])
    turning = turning[turning > 0]
    period = spectrum.period(at)
    if not len(turning) or not np.any(amplitude):
        still, length, more = np.array([0.0, HOUR]), HOUR, dict[str, float]()
        found = [TurningPoints(still, np.array([one, one]), 0.0) for one in torque(np.zeros(1))[0].tolist()]
    elif period is not None:
        length, more = period, {}
        found = list(_over(torque, length, turning))
    else:
        length, found, left = _without_period(torque, turning)
        more = dict(zip(response.springs, left.tolist(), strict=True))
    points = dict(zip(response.springs, found, strict=True))
    return TorqueHistory(name, points, _rate(share, per_hour, length), more, period is not None, findings=said)


def _over(torque: Callable[[Array], Array], length: float, turning: Array) -> tuple[TurningPoints, ...]:
    cells = int(np.ceil(CELLS * turning.max() * length / (2 * np.pi))) + 1
    return turning_points(torque, np.linspace(0.0, length, cells + 1))


def _without_period(torque: Callable[[Array], Array], turning: Array) -> tuple[float, list[TurningPoints], Array]:
    """Windows that are doubled until the extremes of every torque stay; by how much they still moved."""
    length, before = FIRST_WINDOW * 2 * np.pi / float(turning.min()), None
    while True:
        found = list(_over(torque, length, turning))
        ends = np.array([[one.value.min(), one.value.max()] for one in found])
        swing = ends[:, 1] - ends[:, 0]
        moved = swing if before is None else np.abs(ends - before).max(axis=1)
        if np.all(moved <= SETTLED * swing) or length * turning.max() / (2 * np.pi) > MOST_CYCLES / 2:
            return length, found, moved
        length, before = 2 * length, ends


def _of_values(values: Array) -> TurningPoints:
    kept = reversals(values)
    return TurningPoints(kept.astype(float), values[kept], 0.0)


def _rate(share: float | None, per_hour: float | None, duration: float | None) -> float:
    """How often a history of a ``duration`` [s] comes [1/s]."""
    if share is None:
        assert per_hour is not None
        return per_hour / HOUR
    assert duration is not None
    return share / duration
