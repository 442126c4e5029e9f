"""``simulate``: a motion of a line or of any system in time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import overload

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import operating_speed
from trunnion.equations.amplitudes_by_speed import amplitudes_by_speed
from trunnion.equations.coefficients import Assembly
from trunnion.equations.line_system import LineSystem, line_system
from trunnion.equations.speed_profile import SpeedProfile
from trunnion.equations.steady_base import imbalance, require_share
from trunnion.errors import InputError
from trunnion.motion.simulation.converter_ends import converter_end
from trunnion.motion.simulation.input_rotation import TURN, InputRotation
from trunnion.motion.simulation.simulation import LineSimulation, Simulation, SystemSimulation
from trunnion.numerics.integration.integration import MOST_STEPS, TOLERANCE, integrate
from trunnion.results.outcome import Outcome
from trunnion.steady.shooting.integration_outcomes import outcome_of
from trunnion.systems.events import Event, watch
from trunnion.systems.system import System

PER_TURN = 128
MOST_SAMPLES = 200_000
REACHED = "reached"
"""Kind of the outcome of a piece that came to its end."""
MOST_TIMES = 64
"""As long as turns take at the speed that a free line begins with, after which it is not waited for any longer."""


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
) -> SystemSimulation: ...
@overload
def simulate(
    system: Driveline | Assembly,
    duration: float | None = None,
    *,
    turns: float | None = None,
    speed: float | str | SpeedProfile | None = None,
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
    speed: float | str | SpeedProfile | None = None,
    periods: float | None = None,
    start: ArrayLike | None = None,
    start_time: float = 0.0,
    times: ArrayLike | None = None,
    events: Sequence[Event] = (),
    tolerance: float = TOLERANCE,
    most_steps: int = MOST_STEPS,
    longest_step: float = np.inf,
    dense: bool = True,
) -> SystemSimulation | LineSimulation:
    """Integrate a driveline, or any system, in time.

    Parameters
    ----------
    system : a ``Driveline`` (or its ``Assembly``), or a ``System``.
    duration : length of the motion [s]; or one of ``turns``, ``periods`` and ``times`` instead.
    turns : of a driveline's input, its own where the line is free–free; the motion ends when they are made.
    speed : input speed of a driveline [rad/s], by default the file's operating speed; or a ``SpeedProfile``. A line
        that is free–free begins there: its disks with a drive_share carry what balances the loads at that speed, and
        what accelerates its inertia along a profile; ``input_speed`` and ``turns`` of the result tell how it really
        turns.
    periods : of a system's forcing.
    start : initial state. Of a driveline (2n,): deviations from uniform rotation [rad] and their rates [rad/s], by
        default the line without twist; of a system (n,), by default its own.
    start_time : of a system [s]; the phase of its forcing.
    times : (points,) [s], rising, at which states are wanted, the last of which may end the motion; by default every
        step of a system, and of a driveline evenly.
    events : zeros to locate (``Event``); some may stop the run.
    tolerance : error allowed per step, relative to the scale of a state + |x|.
    most_steps : steps after which the run ends.
    longest_step : of a system [s].
    dense : keep what ``at`` and ``times`` need, 8n numbers a step.

    Returns
    -------
    LineSimulation or SystemSimulation; its ``outcome`` says how it ended, and a failure keeps what was computed.

    Raises
    ------
    InputError : no or a wrong duration, speed, start, times or tolerance; what belongs to the other kind of subject; a
        speed that leaves the table of an excitation.

    Examples
    --------
    >>> import trunnion as tn
    >>> shaft = tn.Shaft(stiffness=1e3, damping=2.0)
    >>> line = tn.Driveline([tn.ConstantSpeed(), tn.HookeJoint(angle=0.2), shaft, tn.Disk(inertia=0.4)])
    >>> run = tn.simulate(line, speed=20.0, turns=30)
    >>> run.torque.shape[1], round(float(run.torque[-200:].max()), 2)
    (1, 17.55)
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
) -> SystemSimulation:
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
    run = integrate(
        system.equations, start_time, end, first, regime=system.regime_at(start_time, first),
        tolerance=tolerance, most_steps=most_steps,
        watch=watch(system, events), dense=dense, longest_step=longest_step, partly=True,
    )  # fmt: skip
    guards = (*(system.regimes.guards if system.regimes else ()), *(e.label for e in events))
    return SystemSimulation(system, run, outcome_of(system, run, tolerance, guards), tolerance, guards, wanted)


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


def simulate_line(
    line: Driveline | Assembly,
    duration: float | None = None,
    *,
    speed: float | str | SpeedProfile | None = None,
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
    prepared = line_system(line, profile.speed[0], leaves=True, slips=True, swing=True)
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
    state = prepared.rest() if start is None else prepared.system.checked_start(start)
    if len(profile.time) > 1:
        require_share(prepared.assembly)
    go = _IntegrationSettings(tuple(events), tolerance, most_steps, dense)
    if turns is not None and prepared.assembly.topology.free:
        pieces = _made_turns(prepared, profile, state, turns, duration, go)
    else:
        pieces = _along(prepared, profile, state, duration, drive, go)
    run = LineSimulation.of(prepared, profile, pieces)
    if wanted is None:
        return _sampled(run) if dense else run
    return replace(run, times=wanted)


def prolonged(run: LineSimulation, duration: float, drive: float, *, tolerance: float = TOLERANCE) -> LineSimulation:
    """A run along a profile, followed for another ``duration`` [s] behind the end of the profile.

    ``drive`` [N m at the input] is what a free line's drives give there beyond what balances the loads at the last
    speed.
    """
    end, course = run.profile.courses(run.end + duration)[-1]
    row = run.line.assembly.table(1, run.profile.speed[0])[0]
    system = run.line.system.reading(
        run.line.numbers(row, course, drive, amplitudes=_amplitudes(run.line, run.profile))
    )
    piece = _IntegrationSettings((), tolerance, MOST_STEPS, True).on(system, run.final, run.end, end)
    return _sampled(LineSimulation.of(run.line, run.profile, [*run.pieces, piece]))


def _sampled(run: LineSimulation) -> LineSimulation:
    """The run at even times, so many in a turn."""
    count = int(np.clip(PER_TURN * run.turns, 256, MOST_SAMPLES))
    return replace(run, times=np.linspace(0.0, run.end, count + 1))


@dataclass(frozen=True)
class _IntegrationSettings:
    """How a line is integrated."""

    events: tuple[Event, ...]
    tolerance: float
    most_steps: int
    dense: bool

    def on(self, system: System, state: Array, since: float, until: float) -> Simulation:
        """From one time to another [s]."""
        return simulate_system(
            system, until - since, start=state, start_time=since, events=self.events, tolerance=self.tolerance,
            most_steps=self.most_steps, dense=self.dense,
        )  # fmt: skip


def _along(
    prepared: LineSystem, profile: SpeedProfile, state: Array, duration: float, drive: float, go: _IntegrationSettings
) -> list[Simulation]:
    """The pieces of a run along a profile."""
    row = prepared.assembly.table(1, profile.speed[0])[0]
    known = prepared.untwisted(row[None])
    pieces: list[Simulation] = []
    amplitudes = _amplitudes(prepared, profile)
    for end, course in profile.courses(duration):
        system = prepared.system
        if len(profile.time) > 1:
            system = system.reading(prepared.numbers(row, course, drive, known, amplitudes=amplitudes))
        elif amplitudes:
            system = _leaving(prepared, profile, amplitudes)
        piece = go.on(system, state, course.since, end)
        ended = converter_end(prepared, piece.end, piece.final, system.numbers, piece.outcome)
        pieces.append(replace(piece, outcome=ended))
        state = piece.final
        if pieces[-1].outcome.kind != REACHED:
            break
    return pieces


def _amplitudes(line: LineSystem, profile: SpeedProfile) -> dict[int, Array]:
    """Of the excitations that vary, over the speeds of a profile, where the line leaves the first of them; else none:
    they keep the amplitude of that."""
    row = line.assembly.table(1, profile.speed[0])
    if len(profile.time) == 1 and not imbalance(line.assembly, row)[0]:
        return {}
    return amplitudes_by_speed(line, row[0], min(profile.speed), max(profile.speed))


def _leaving(line: LineSystem, profile: SpeedProfile, amplitudes: dict[int, Array]) -> System:
    """The system of a line that leaves the speed at which it begins, under these amplitudes over the speed."""
    row = line.assembly.table(1, profile.speed[0])[0]
    return line.system.reading(line.numbers(row, amplitudes=amplitudes))


def _made_turns(
    prepared: LineSystem, profile: SpeedProfile, state: Array, turns: float, guess: float, go: _IntegrationSettings
) -> list[Simulation]:
    """The pieces of a run of a free line until its input has made ``turns``, which takes ``guess`` [s] at the speed
    that it begins with."""
    amplitudes = _amplitudes(prepared, profile)
    system = _leaving(prepared, profile, amplitudes) if amplitudes else prepared.system
    pieces, span, until, furthest = list[Simulation](), guess, 0.0, 0.0
    dense = replace(go, dense=True)
    while True:
        pieces.append(dense.on(system, state, until, until + span))
        turning = LineSimulation.of(prepared, profile, pieces).input
        reached = float(turning.times_at(np.array([TURN * turns]))[0])
        if np.isfinite(reached):
            pieces[-1] = dense.on(system, state, until, reached)
            break
        if pieces[-1].outcome.kind != REACHED:
            break
        stuck = until > 0 and turning.furthest <= furthest
        until, state, furthest = pieces[-1].end, pieces[-1].final, turning.furthest
        if stuck or until >= MOST_TIMES * guess:
            pieces[-1] = replace(pieces[-1], outcome=_too_slow(turning, turns))
            break
        speed = turning.last_turn()[1]
        left = TURN * turns - turning.furthest
        span = float(np.clip(1.1 * left / speed, guess / 8, until)) if speed > 0 else until
    return pieces if go.dense else [piece.without_dense_output() for piece in pieces]


def _too_slow(turning: InputRotation, turns: float) -> Outcome:
    """A free line that does not get as far as it was asked to."""
    made = f"the input made {turning.furthest / TURN:.3g} of the {turns:g} turns asked for in {turning.end:.4g} s"
    return Outcome(False, "too slow", f"{made}; give a duration, or let the drive give more torque than the loads take")
