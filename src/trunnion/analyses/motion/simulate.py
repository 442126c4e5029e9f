"""``simulate``: a motion of a line or of any system in time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import overload

import numpy as np
from numpy.typing import ArrayLike

from trunnion.analyses.motion.simulation import Simulation, positive_time, rising_times, simulate_system
from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import operating_speed
from trunnion.equations.coefficients import Assembly
from trunnion.equations.line_system import LineMotion, LineSystem, line_system
from trunnion.equations.speed_profile import SpeedProfile
from trunnion.equations.steady_base import require_share
from trunnion.errors import InputError
from trunnion.numerics.curves import Extremes, extremes_in
from trunnion.numerics.integration.integration import MOST_STEPS, TOLERANCE, joined
from trunnion.results.declared import Held, Result, axis, ending, fields_over, over, remark, remarks
from trunnion.results.drawing import Axes, drawing
from trunnion.results.outcome import Outcome
from trunnion.systems.events import Event
from trunnion.systems.system import System

PER_TURN = 128
MOST_SAMPLES = 200_000


@dataclass(frozen=True, repr=False)
class LineSimulation(Result):
    """A motion of a line.

    time (points,) [s]; rotation (points, coordinate): deviation from uniform rotation [rad], and rate [rad/s];
    twist [rad] and torque [N m] of every shaft (points, shaft), positive with the twist; pieces: one simulation
    per straight piece of the speed profile; outcome: how it ended.
    """

    line: LineSystem
    profile: SpeedProfile
    pieces: tuple[Simulation, ...]
    time: Array

    @property
    def outcome(self) -> Outcome:
        """How it ended."""
        return self.pieces[-1].outcome

    @cached_property
    def _run(self) -> Simulation:
        """All pieces as one, but for its system: that of the last."""
        return replace(self.pieces[-1], trajectory=joined([piece.trajectory for piece in self.pieces]))

    @property
    def end(self) -> float:
        """The last time [s]."""
        return self.pieces[-1].end

    @property
    def final(self) -> Array:
        """The last state (2n,)."""
        return self.pieces[-1].final

    @property
    def shafts(self) -> tuple[str, ...]:
        """Names of the shafts."""
        return self.line.shafts

    @property
    def steps(self) -> int:
        """Steps taken."""
        return self._run.trajectory.steps

    @property
    def event_time(self) -> Array:
        """Times of all events (events,) [s]."""
        return self._run.trajectory.event_time

    @property
    def cuts(self) -> Array:
        """Times (steps + 1,) [s] between which the motion is smooth."""
        return self._run.trajectory.time_of_state

    def at(self, time: ArrayLike) -> Array:
        """States (…, 2n) at any times of the run; NaN outside it."""
        return self._run.at(time)

    def motion_at(self, time: ArrayLike) -> LineMotion:
        """Twists, torques and rotations at times (m,) of the run."""
        return LineMotion(*self._observed(time, LineMotion._fields))

    def torque_at(self, time: ArrayLike) -> Array:
        """Torque (m, shaft) [N m] of every shaft at times (m,) of the run."""
        return self._observed(time, ("torque",))[0]

    def _observed(self, time: ArrayLike, names: tuple[str, ...]) -> list[Array]:
        times = np.atleast_1d(np.asarray(time, dtype=float))
        order = np.argsort(times, kind="stable")
        states, times = self.at(times[order]), times[order]
        ends = np.searchsorted(times, [*(piece.time_range[0] for piece in self.pieces), np.nextafter(self.end, np.inf)])
        parts = [
            self.line.observe(piece.system, times[i:j], states[i:j])
            for piece, i, j in zip(self.pieces, ends, ends[1:], strict=False)
        ]
        whole = []
        for columns in ([getattr(part, name) for part in parts] for name in names):
            found = np.full((len(times), columns[0].shape[1]), np.nan)
            found[order[ends[0] : ends[-1]]] = np.concatenate(columns)
            whole.append(found)
        return whole

    @cached_property
    def _motion(self) -> LineMotion:
        return self.motion_at(self.time)

    @cached_property
    def state(self) -> Array:
        """States (points, 2n) at ``time``."""
        return self.at(self.time)

    @property
    def twist(self) -> Array:
        """Twist [rad] of every shaft, (points, shaft)."""
        return self._motion.twist

    @property
    def torque(self) -> Array:
        """Torque [N m] of every shaft, (points, shaft)."""
        return self._motion.torque

    @property
    def input_speed(self) -> Array:
        """Input speed [rad/s] at ``time``."""
        return self.profile.at(self.time)

    @property
    def torque_peak_to_peak(self) -> Array:
        """Largest minus smallest torque of every shaft [N m] from the first to the last of ``time``."""
        return self.torque_extremes.span

    @cached_property
    def torque_extremes(self) -> Extremes:
        """Lowest and highest torque of every shaft [N m] from the first to the last of ``time``, and when; found on the
        dense output, whose error is about ten times the tolerance."""
        return extremes_in(self.torque_at, self.cuts, self.time[[0, -1]]).of(0)

    def declared(self) -> Iterator[Held]:
        """Deviations and rates of every inertia, twist and torque of every shaft, the input's course, over time."""
        n = len(self.line.names)
        yield axis("time", self.time, "s")
        yield axis("coordinate", self.line.names)
        yield axis("shaft", self.shafts)
        yield over("time coordinate", "rotation", self.state[:, :n], "rad")
        yield over("time coordinate", "rate", self.state[:, n : 2 * n], "rad/s")
        if self.line.sliders:
            yield axis("slider", [slider.name for slider in self.line.sliders])
            yield over("time slider", "deflection", self.state[:, 2 * n :], "rad")
        yield from fields_over("time shaft", self, twist="rad", torque="N*m")
        yield over("time", "input_speed", self.input_speed, "rad/s")
        yield over("time", "input_angle", self.profile.angle(self.time), "rad")
        yield remark("driveline", self.pieces[0].system.name)
        yield from ending(self.outcome)
        yield from remarks(tolerance=self.pieces[0].tolerance, steps=self.steps)

    def plot(self, axes: Axes | None = None, *, shafts: tuple[str, ...] = (), unit: str = "") -> Axes:
        """Torques over time; see ``trunnion.plots.motion``."""
        return drawing(self, "plot")(self, axes, shafts=shafts, unit=unit)

    def plot_order_map(
        self, axes: Axes | None = None, *, shaft: str = "", window: int = 8, highest: float = 12.0, unit: str = ""
    ) -> Axes:
        """Torque spectrum over time or speed; see ``trunnion.plots.order_map``."""
        return drawing(self, "plot_order_map")(self, axes, shaft=shaft, window=window, highest=highest, unit=unit)

    def __str__(self) -> str:
        rows = [
            f"  {name}: torque {low:.6g} … {high:.6g} N m"
            for name, low, high in zip(self.shafts, self.torque_extremes.low, self.torque_extremes.high, strict=True)
        ]
        turns = float(self.profile.angle(self.end)) / (2 * np.pi)
        head = f"motion of {self.pieces[0].system.name} over {self.end:.6g} s ({turns:.6g} turns): {self.steps} steps"
        return "\n".join([head, *rows, f"  {self.outcome}"])


@overload
def simulate(
    system: System,
    duration: float | None = None,
    *,
    periods: float | None = None,
    start: ArrayLike | None = None,
    start_time: float = 0.0,
    times: ArrayLike | None = None,
    events: Sequence[Event] = (),
    tolerance: float = TOLERANCE,
    most_steps: int = MOST_STEPS,
    longest_step: float = np.inf,
    dense: bool = True,
) -> Simulation: ...
@overload
def simulate(
    system: Driveline | Assembly,
    duration: float | None = None,
    *,
    turns: float | None = None,
    speed: float | SpeedProfile | None = None,
    start: ArrayLike | None = None,
    times: ArrayLike | None = None,
    events: Sequence[Event] = (),
    tolerance: float = TOLERANCE,
    most_steps: int = MOST_STEPS,
    dense: bool = True,
) -> LineSimulation: ...


def simulate(
    system: System | Driveline | Assembly,
    duration: float | None = None,
    *,
    turns: float | None = None,
    speed: float | SpeedProfile | None = None,
    periods: float | None = None,
    start: ArrayLike | None = None,
    start_time: float = 0.0,
    times: ArrayLike | None = None,
    events: Sequence[Event] = (),
    tolerance: float = TOLERANCE,
    most_steps: int = MOST_STEPS,
    longest_step: float = np.inf,
    dense: bool = True,
) -> Simulation | LineSimulation:
    """Integrate a line, or any system, in time.

    Parameters
    ----------
    duration : [s]; or ``turns`` of a driveline's input; or ``periods`` of a system's forcing; or up to the last of
        ``times``.
    speed : input speed of a driveline [rad/s] (default: the file's operating speed), or a ``SpeedProfile``. A line that
        starts free begins there: its disks with a drive_share carry what balances the loads at that speed, and what
        accelerates its inertia along a profile; how it really turns is what the rotations tell.
    start : initial state. Of a driveline (2n,): deviations from uniform rotation [rad] and their rates [rad/s], by
        default the line without twist; of a system (n,), by default its own.
    start_time : of a system [s]; the phase of its forcing.
    times : at which states are wanted (rising) [s]; by default every step of a system, and of a driveline evenly.
    events : zeros to locate; some may stop the run.
    tolerance : error allowed per step, relative to the scale of a state + |x|.
    most_steps, longest_step : of the integration; ``longest_step`` [s] of a system.
    dense : keep what ``at`` and ``times`` need, 8n numbers a step.

    Returns
    -------
    A result whose ``outcome`` says how it ended; a failure keeps what was computed.

    Raises
    ------
    InputError : no or a wrong duration, speed, start, times or tolerance; what belongs to the other kind of subject.
    """
    if isinstance(system, System):
        _refuse("belongs to a driveline", "leave it out", turns=turns, speed=speed)
        return simulate_system(
            system, duration, periods=periods, start=start, start_time=start_time, times=times, events=events,
            tolerance=tolerance, most_steps=most_steps, longest_step=longest_step, dense=dense,
        )  # fmt: skip
    if not isinstance(system, Driveline | Assembly):
        raise InputError(
            f"is a {type(system).__name__}, which cannot be simulated",
            key="system",
            remedy="give a Driveline or a System, tn.reference_system('duffing'), say",
        )
    other = {"start_time": start_time or None, "longest_step": longest_step if np.isfinite(longest_step) else None}
    _refuse("belongs to a System", "give a duration, or turns of the input", periods=periods, **other)
    return simulate_line(
        system, duration, speed=speed, turns=turns, start=start, times=times, events=events, tolerance=tolerance,
        most_steps=most_steps, dense=dense,
    )  # fmt: skip


def _refuse(problem: str, remedy: str, **given: object) -> None:
    for key, value in given.items():
        if value is not None:
            raise InputError(problem, key=key, value=value, remedy=remedy)


def simulate_line(
    line: Driveline | Assembly,
    duration: float | None = None,
    *,
    speed: float | SpeedProfile | None = None,
    turns: float | None = None,
    start: ArrayLike | None = None,
    times: ArrayLike | None = None,
    events: Sequence[Event] = (),
    tolerance: float = TOLERANCE,
    most_steps: int = MOST_STEPS,
    dense: bool = True,
    drive: float = 0.0,
) -> LineSimulation:
    """As ``simulate``; ``drive`` [N m at the input] is what a free line's drives give beyond what keeps its course."""
    description = line.line if isinstance(line, Assembly) else line
    profile = speed
    if not isinstance(profile, SpeedProfile):
        profile = SpeedProfile([0.0], [operating_speed(description, profile)])
    prepared = line_system(line, profile.speed[0])
    wanted = None if times is None else rising_times(times, 0.0)
    if turns is not None:
        if duration is not None:
            raise InputError("is given beside a duration", key="turns", value=turns, remedy="leave one of them out")
        if len(profile.time) > 1:
            raise InputError("goes with a constant speed", key="turns", value=turns, remedy="give a duration")
        duration = 2 * np.pi * turns / profile.speed[0]
    if duration is None and wanted is not None:
        duration = float(wanted[-1])
    duration = positive_time(duration, "give seconds, or turns of the input")
    state = prepared.rest() if start is None else prepared.system.checked(start, "start")
    if len(profile.time) > 1:
        require_share(prepared.assembly)
    row = prepared.assembly.table(1, profile.speed[0])[0]
    pieces: list[Simulation] = []
    known = prepared.untwisted(row[None])
    for end, course in profile.courses(duration):
        system = prepared.system
        if len(profile.time) > 1:
            system = system.reading(prepared.numbers(row, course, drive, known))
        pieces.append(
            simulate_system(
                system, end - course.since, start=state, start_time=course.since, events=events,
                tolerance=tolerance, most_steps=most_steps, dense=dense,
            )
        )  # fmt: skip
        state = pieces[-1].final
        if pieces[-1].end < end:
            break
    reached = pieces[-1].end
    if wanted is None:
        turned = float(profile.angle(reached)) / (2 * np.pi)
        count = int(np.clip(PER_TURN * turned, 256, MOST_SAMPLES))
        wanted = np.linspace(0.0, reached, count + 1) if dense else np.array([reached])
    return LineSimulation(prepared, profile, tuple(pieces), wanted[wanted <= reached])
