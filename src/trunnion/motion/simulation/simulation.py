"""Simulation of a system: a motion from a start, with dense output, events and an outcome."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Integers
from trunnion.errors import InputError
from trunnion.numerics.curves import extremes_in
from trunnion.numerics.integration.integration import MOST_STEPS, TOLERANCE, Trajectory, integrate
from trunnion.results.declared import Held, Result, axis, ending, over, parameters_of, remark, remarks
from trunnion.results.drawing import Axes, drawing
from trunnion.results.outcome import Outcome
from trunnion.results.quantity_axes import state_axes
from trunnion.steady.shooting.integration_outcomes import outcome_of
from trunnion.systems.events import Event, watch
from trunnion.systems.system import System


@dataclass(frozen=True, repr=False)
class Simulation(Result):
    """A motion.

    time (points,) [s] and state (points, n) where asked for (by default at every step); event_time (events,),
    event_name, and the states before and after each, (events, n); regime (points,) by number. ``at`` gives
    the state anywhere between; ``outcome`` says how it ended.
    """

    system: System
    time: Array
    state: Array
    regime: Integers
    event_time: Array
    event_name: tuple[str, ...]
    event_before: Array
    event_after: Array
    outcome: Outcome
    trajectory: Trajectory
    tolerance: float

    @property
    def final(self) -> Array:
        """The last state (n,)."""
        return self.trajectory.final[0]

    @property
    def end(self) -> float:
        """The last time [s]."""
        return self.trajectory.time

    def at(self, time: ArrayLike) -> Array:
        """States at any times of the run, (..., n), to about ten times the tolerance; NaN outside it.

        Raises
        ------
        InputError : the run was made with ``dense=False``.
        """
        if not len(self.trajectory.coefficients) and self.trajectory.steps:
            raise InputError("was left out", element="simulation", key="dense", value=False, remedy="set dense=True")
        times = np.asarray(time, dtype=float)
        inside = (times >= self.time_range[0]) & (times <= self.time_range[1])
        found = self.trajectory.at(np.where(inside, times, self.time_range[0]))
        return np.asarray(np.where(inside[..., None], found, np.nan))

    def without_dense_output(self) -> Simulation:
        """The same without what ``at`` needs."""
        return replace(self, trajectory=replace(self.trajectory, coefficients=self.trajectory.coefficients[:0]))

    @property
    def time_range(self) -> tuple[float, float]:
        """First and last time [s]."""
        start = self.trajectory.start
        return (float(start[0]) if len(start) else self.trajectory.time), self.trajectory.time

    @cached_property
    def range(self) -> tuple[Array, Array]:
        """Smallest and largest value (n,) of every state from the first to the last of ``time``: found on the dense
        output; among the steps without it, or where a right-hand side that fails left it without numbers."""
        run = self.trajectory
        dense = len(run.coefficients) > 0 and bool(np.isfinite(run.coefficients).all())
        if not dense or len(self.time) < 2:
            return self.state.min(axis=0), self.state.max(axis=0)
        found = extremes_in(run.at, run.time_of_state, self.time[[0, -1]]).of(0)
        return found.low, found.high

    def declared(self) -> Iterator[Held]:
        """Every state and the regime over time, and the located events."""
        yield axis("time", self.time, "s")
        yield axis("state", self.system.states)
        for i, (name, unit) in enumerate(zip(self.system.states, self.system.units, strict=True)):
            yield over("time", name, self.state[:, i], unit)
        yield over("time", "regime", self.regime)
        yield over("event", "event_time", self.event_time, "s")
        yield over("event", "event_name", np.array(self.event_name, dtype=str))
        yield over("event state", "state_before", self.event_before)
        yield over("event state", "state_after", self.event_after)
        yield remark("system", self.system.name)
        yield from ending(self.outcome)
        yield from remarks(
            tolerance=self.tolerance,
            steps=self.trajectory.steps,
            tangents="exact" if self.system.exact_tangents else "differenced",
        )
        yield from parameters_of(self.system)

    def plot(self, axes: Axes | None = None, *, states: tuple[str, ...] = ()) -> Axes:
        """Time histories; see ``pictures.motion``."""
        return drawing(self, "plot")(self, axes, states=states)

    def plot_portrait(self, axes: Axes | None = None, *, x: str = "", y: str = "", from_time: float = 0.0) -> Axes:
        """One state over another; see ``pictures.motion``."""
        return drawing(self, "plot_portrait")(self, axes, x=x, y=y, from_time=from_time)

    def __str__(self) -> str:
        low, high = self.time_range
        least, most = self.range
        axes = state_axes(self.system)
        rows = [
            f"  {name}: {least[i] * axis.factor:.6g} … {axis.number(float(most[i]))}, at the end "
            f"{self.final[i] * axis.factor:.10g}"
            for i, (name, axis) in enumerate(zip(self.system.states, axes, strict=True))
        ]
        events = f", {len(self.event_time)} events" if self.event_name else ""
        head = (
            f"motion of {self.system.name} from t = {low:g} to {high:.6g} s: {self.trajectory.steps} steps at "
            f"tolerance {self.tolerance:g}{events}"
        )
        return "\n".join([head, *rows, f"  {self.outcome}"])


def simulate_system(
    system: System,
    duration: float | None = None,
    *,
    start: ArrayLike | None = None,
    start_time: float = 0.0,
    times: ArrayLike | None = None,
    periods: float | None = None,
    events: Sequence[Event] = (),
    tolerance: float = TOLERANCE,
    most_steps: int = MOST_STEPS,
    longest_step: float = np.inf,
    dense: bool = True,
) -> Simulation:
    """Integrate a system from ``start``.

    Parameters
    ----------
    duration : [s]; or ``periods`` of the forcing; or up to the last of ``times``.
    start : initial state (n,); by default the system's own.
    start_time : [s]; the phase of the forcing.
    times : at which ``time`` and ``state`` are wanted (rising); by default every step taken.
    events : zeros to locate; some may stop the run.
    tolerance : error allowed per step, relative to the scale of a state + |x|.
    dense : keep what ``at`` and ``times`` need, 8n numbers a step.

    Returns
    -------
    A result whose ``outcome`` says how it ended; a failure keeps what was computed.

    Raises
    ------
    InputError : no or a wrong duration, start, times or tolerance.
    """
    end, wanted = _span(system, duration, periods, start_time, times)
    if not (np.isfinite(tolerance) and 1e-15 <= tolerance < 1):
        raise InputError("must lie between 1e-15 and 1", key="tolerance", value=tolerance, remedy="1e-9, say")
    if wanted is not None and not dense:
        raise InputError("is needed for times", element="simulation", key="dense", value=False, remedy="leave it out")
    first = _start(system, start)
    regime = system.regime_at(start_time, first)
    run = integrate(
        system.equations, start_time, end, first, regime=regime, tolerance=tolerance, most_steps=most_steps,
        watch=watch(system, events), dense=dense, longest_step=longest_step, partly=True,
    )  # fmt: skip
    guards = (*(system.regimes.guards if system.regimes else ()), *(e.label for e in events))
    outcome = outcome_of(system, run, tolerance, guards)
    time = run.time_of_state if wanted is None else wanted[wanted <= run.time]
    return Simulation(
        system=system,
        time=time,
        state=run.state if wanted is None else run.at(time),
        regime=_regimes(run, time, regime),
        event_time=run.event_time,
        event_name=tuple(guards[int(i)] for i in run.event_which),
        event_before=run.event_before,
        event_after=run.event_after,
        outcome=outcome,
        trajectory=run,
        tolerance=tolerance,
    )


def _regimes(run: Trajectory, time: Array, first: int) -> Integers:
    if not run.steps:
        return np.full(len(time), first, dtype=np.int64)
    return run.regime[np.searchsorted(run.start[1:], time, side="right")]


def _span(
    system: System, duration: float | None, periods: float | None, start: float, times: ArrayLike | None
) -> tuple[float, Array | None]:
    wanted = None if times is None else rising_times(times, start)
    if periods is not None:
        if system.forcing_period is None:
            raise InputError(
                "has no meaning for an autonomous system", element=system.name, key="periods", value=periods,
                remedy="give a duration",
            )  # fmt: skip
        duration = periods * system.forcing_period
    if duration is None and wanted is not None:
        return float(wanted[-1]), wanted
    return start + positive_time(duration, "give a duration in seconds, or periods"), wanted


def rising_times(times: ArrayLike, start: float) -> Array:
    """``times`` as an array that rises from ``start`` on."""
    try:
        wanted = np.asarray(times, dtype=float)
    except (TypeError, ValueError):
        wanted = np.zeros(0)
    if wanted.ndim != 1 or not len(wanted) or not np.all(np.isfinite(wanted)) or np.any(np.diff(wanted) <= 0):
        raise InputError("must be a rising list of times", key="times", remedy="np.linspace(0, 1, 200), say")
    if wanted[0] < start:
        raise InputError("begins before start_time", key="times", value=float(wanted[0]))
    return wanted


def positive_time(duration: object, remedy: str) -> float:
    """A duration [s], checked."""
    number = isinstance(duration, int | float | np.number) and not isinstance(duration, bool)
    if not number or not (np.isfinite(duration) and duration > 0):  # type: ignore[call-overload,operator]
        raise InputError("must be a positive time", key="duration", value=duration, remedy=remedy)
    return float(duration)  # type: ignore[arg-type]


def _start(system: System, start: ArrayLike | None) -> Array:
    if start is None:
        if system.start is None:
            raise InputError("is missing", element=system.name, key="start", remedy=f"give {', '.join(system.states)}")
        return system.start
    return system.checked_start(start)
