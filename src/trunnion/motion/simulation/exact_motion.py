"""``exact_motion``: a driveline with backlash and stages in time, exact within every stage.

Within a combination of stages the line is linear with constant coefficients; its motion is summed as a Taylor series to
rounding, and the changes of stage are located to rounding (``numerics/staged_flow_kernel``). There is no tolerance.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Integers
from trunnion.driveline.driveline import Driveline
from trunnion.equations.coefficients import Assembly
from trunnion.equations.sliders import beyond_capacity
from trunnion.equations.staged_line import StagedLine, refuse_lost_speed, staged_line
from trunnion.errors import InputError
from trunnion.laws.stages import STICKS
from trunnion.motion.simulation.simulate import positive_time
from trunnion.numerics.piecewise_linear.staged_flow import StagedSegment, kernel, move
from trunnion.results.fields import computed, coordinate, internal, labelled, variable
from trunnion.results.of_systems import ending
from trunnion.results.outcome import Outcome
from trunnion.results.result import Result
from trunnion.results.variables import Attribute, Variable
from trunnion.systems.regimes import SLACK

MOST_EVENTS = 100_000
SAMPLES = 1024


@dataclass(frozen=True)
class StageEvents:
    """Changes of stage in order of time.

    time (events,) [s]; spring (events,): places in ``springs``, behind them sliders; stage (events,): the one
    begun, counted from 0 as the stiffnesses are; side (events,): −1 or +1 in contact below or above the softest
    stage, 0 in it; rate (events,): twist rate [rad/s].
    """

    time: Array
    spring: Integers
    stage: Integers
    side: Integers
    rate: Array

    def __len__(self) -> int:
        return len(self.time)


@labelled
class ExactMotion(Result):
    """A motion of a line with stages.

    States are twists, then rates, where ``line.turns`` those of the first inertia's rotation after the springs' in each
    half, sliders between them. Twist and torque are positive as in ``simulate``, a mesh a shaft behind its rigid pair.
    """

    line: StagedLine = internal("that moved")
    start: Array = internal("first state", axes="state")
    start_time: float = internal("first time", "s")
    time: Array = coordinate("time", "s")
    state: Array = internal("at every time", axes="time state", repr=False)
    stage: Integers = internal("of springs, then of sliders", axes="time spring", repr=False)
    events: StageEvents = internal("changes of stage", repr=False)
    final: Array = internal("last state", axes="state")
    end: float = internal("time reached", "s")
    outcome: Outcome = internal("how it ended")

    @property
    @computed(coordinate("spring"), after="time")
    def springs(self) -> tuple[str, ...]:
        """Names of the springs."""
        return self.line.springs

    @property
    @computed(variable("time spring", "rad"))
    def twist(self) -> Array:
        """Twist of every spring (points, spring) [rad]."""
        return self.state[:, : len(self.springs)]

    @property
    @computed(variable("time spring", "rad/s", name="twist_rate"))
    def rate(self) -> Array:
        """Twist rate of every spring (points, spring) [rad/s]."""
        return self.state[:, self.line.size :][:, : len(self.springs)]

    @property
    @computed(variable("time spring", "N*m"))
    def torque(self) -> Array:
        """Torque of every spring (points, spring) [N m]."""
        return self.line.flow().torque(self.state, self.stage)[:, : len(self.springs)]

    @property
    def torque_low(self) -> Array:
        """Lowest torque of every spring (spring,) [N m] over the whole run, between the reported times too."""
        return self._seen[:, kernel().TORQUE_LOW]

    @property
    def torque_high(self) -> Array:
        """Highest torque of every spring (spring,) [N m] over the whole run, between the reported times too."""
        return self._seen[:, kernel().TORQUE_HIGH]

    @cached_property
    def _seen(self) -> Array:
        """What the run shows of every spring; see ``numerics/piecewise_linear/staged_flow_kernel``."""
        flow, most = self.line.flow(), len(self.events) + 1
        run = move(flow, self.start, self.start_time, self.end, watch=True, most_events=most)
        return run.seen[: len(self.springs)]

    def at(self, time: ArrayLike) -> Array:
        """States (times, 2m) at rising times of the run, as exact as the run itself; NaN outside it."""
        times = np.atleast_1d(np.asarray(time, dtype=float))
        inside = (times >= self.start_time) & (times <= self.end)
        out = np.full((len(times), 2 * self.line.size), np.nan)
        order = np.argsort(times[inside], kind="stable")
        found = move(
            self.line.flow(), self.start, self.start_time, self.end, times=times[inside][order],
            most_events=len(self.events) + 1,
        )  # fmt: skip
        out[np.flatnonzero(inside)[order]] = found.states
        return out

    def declared(self) -> Iterator[Variable | Attribute]:
        """What the fields hold, stages, the located changes of stage and the ending."""
        yield from super().declared()
        yield Variable("stage", self.stage[:, : len(self.springs)], "time spring")
        yield Variable("event_time", self.events.time, "event", "s")
        yield Variable("event_spring", np.array([self.line.rows[i] for i in self.events.spring], dtype=str), "event")
        yield Variable("event_stage", self.events.stage, "event")
        yield Variable("event_side", self.events.side, "event")
        yield Attribute("driveline", self.line.name)
        yield from ending(self.outcome)

    def __str__(self) -> str:
        rows = []
        slips = np.sum((self.events.spring >= len(self.springs)) & (self.events.side != 0))
        for e, name in enumerate(self.springs):
            count = int(np.sum(self.events.spring == e))
            extent = f"{self.torque_low[e]:.6g} … {self.torque_high[e]:.6g} N m"
            changes = f", {count} changes of stage" if self.line.counts[e] > 1 else ""
            rows.append(f"  {name}: torque {extent}{changes}")
        span = f"from {self.start_time:.6g} to {self.end:.6g} s"
        head = f"exact motion of {self.line.name} {span}, {len(self.events)} events"
        if self.line.sliders:
            rows.append(f"  {', '.join(self.line.sliders)}: slipped {slips} times")
        return "\n".join([head, *rows, f"  {self.outcome}"])


def exact_motion(
    line: Driveline | Assembly,
    duration: float | None = None,
    *,
    speed: float | str | None = None,
    start: ArrayLike | None = None,
    start_time: float = 0.0,
    times: ArrayLike | None = None,
    most_events: int = MOST_EVENTS,
) -> ExactMotion:
    """The motion of a line whose springs are linear stage by stage, to rounding: no step size, no tolerance.

    Takes shafts, gear meshes with backlash and transmission error, shafts with stages, ratios, branches, loads
    (constant, viscous, harmonic); not bent Hooke's or tripod joints, a varying mesh stiffness or quadratic loads, for
    which there is ``simulate``. Torques by order act at the mean rotation.

    Parameters
    ----------
    line : a ``Driveline`` or its ``Assembly``.
    duration : [s]; by default up to the last of ``times``.
    speed : mean input speed [rad/s], by default that of the line's operation; only where meshes, orders or viscous
        loads depend on it.
    start : twists [rad] of all springs, then their rates [rad/s], (2m,); by default the line turning uniformly, every
        disk where rigid shafts would hold it. Sliders start as if last without twist, or as the deflections behind the
        twists say.
    start_time : time of the start [s].
    times : (points,) [s], rising, to be reported; by default 1025 over the whole run.
    most_events : changes of stage after which the run ends.

    Returns
    -------
    ExactMotion; where the changes of stage accumulate its ``outcome`` says so, and it ends there.

    Raises
    ------
    InputError : a line that has no exact motion, or is free–free and leaves the speed that its excitation turns with;
        no duration, a start of the wrong size, times outside the run.

    Examples
    --------
    >>> import trunnion as tn
    >>> motor = tn.Disk(inertia=0.05, excitation=[{"order": 2, "amplitude": 20.0}])
    >>> play = tn.PiecewiseShaft(breakpoints=[-0.02, 0.02], stiffnesses=[2e4, 0.0, 2e4], damping=1.0)
    >>> drive = [tn.ConstantSpeed(), tn.Shaft(stiffness=3e4, damping=1.5), motor]
    >>> line = tn.Driveline([*drive, play, tn.Disk(inertia=0.2, load_torque=4.0)])
    >>> run = tn.exact_motion(line, 0.5, speed=60.0)
    >>> run.twist.shape, round(float(run.torque_high[1]), 3)
    ((1025, 2), 1.086)
    """
    prepared = staged_line(line, speed)
    refuse_lost_speed(prepared)
    shown = None if times is None else np.atleast_1d(np.asarray(times, dtype=float))
    if duration is None and shown is not None and shown.size:
        duration = float(shown[-1]) - start_time
    duration = positive_time(duration, "give seconds, or times")
    if isinstance(most_events, bool) or most_events != int(most_events) or most_events < 1:
        raise InputError("must be a whole number from 1", key="most_events", value=most_events)
    end = start_time + duration
    if shown is None:
        shown = start_time + duration * np.arange(SAMPLES + 1) / SAMPLES
    elif not (np.all(np.diff(shown) >= 0) and shown[0] >= start_time and shown[-1] <= end):
        raise InputError(
            "must rise and lie within the run", key="times", value=[float(shown[0]), float(shown[-1])],
            remedy=f"choose times from {start_time:g} to {end:g} s",
        )  # fmt: skip
    first = start_state(prepared, start)
    run = move(prepared.flow(), first, start_time, end, times=shown, most_events=int(most_events))
    reached = shown <= run.time
    return ExactMotion(
        prepared, first, start_time, shown[reached], run.states[reached], run.shown_stages[reached],
        stage_events(prepared, run.events), run.state, run.time, _outcome(prepared, run),
    )  # fmt: skip


def start_state(line: StagedLine, start: ArrayLike | None) -> Array:
    """A start as given, or rest.

    Raises
    ------
    InputError : not 2m finite numbers; a slider loaded beyond what it holds.
    """
    if start is None:
        return line.rest()
    state = np.array(start, dtype=float)
    if state.shape == (2 * (line.size - len(line.sliders)),):
        state = line.from_twists(state)
    if state.shape != (2 * line.size,) or not np.isfinite(state).all():
        names = ", ".join([*line.rows, *(["rotation of the first disk"] if line.turns else [])])
        raise InputError(
            f"must be {2 * line.size} finite numbers", element=line.name, key="start", value=f"shape {state.shape}",
            remedy=f"give the twists of {names}, then their rates",
        )  # fmt: skip
    for row, name in zip(line.slider_rows, line.sliders, strict=True):
        stiffness, reach = line.pieces[row, STICKS, 1], line.knots[row]
        if abs(state[row]) > (1 + SLACK) * reach:
            words, remedy = beyond_capacity(name, stiffness * state[row], stiffness * reach, reach)
            raise InputError(words, element=line.name, key="start", remedy=remedy)
    return line.within_limits(state)


def stage_events(line: StagedLine, events: Array) -> StageEvents:
    """The events (count, 5) of a passage."""
    spring, stage = events[:, 1].astype(np.int64), events[:, 2].astype(np.int64)
    return StageEvents(events[:, 0], spring, stage, line.sides[spring, stage], events[:, 3])


def _outcome(line: StagedLine, run: StagedSegment) -> Outcome:
    if run.done:
        return Outcome(True, "reached", f"reached {run.time:g} s with {len(run.events)} changes of stage")
    busiest = np.bincount(run.events[:, 1].astype(np.int64), minlength=line.size)
    name = line.rows[int(np.argmax(busiest[: len(line.rows)]))]
    since = float(run.events[0, 0]) if len(run.events) else run.time
    return Outcome(
        False, "chatter",
        f"{name} changes its stage too often: {len(run.events)} events from t = {since:g} to {run.time:g} s, where the "
        "run ends; raise most_events, ask for less time at once, or raise damping",
    )  # fmt: skip
