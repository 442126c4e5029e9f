"""What a line can be seen to do: turn, swing in a mode, answer what excites it, let a disturbance grow, pass a
resonance. Each comes from the analysis of that name; nothing is computed here but how stations turn with it."""

from __future__ import annotations

import cmath
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from trunnion.animation.movement import (
    TO_BE_SEEN,
    Movement,
    exaggerated,
    parted,
    rigid_angles,
    station_deviation,
    with_massless,
)
from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import operating_speed, speed_unit, stated_range
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.kinematics import base_motion
from trunnion.equations.steady_base import has_joint_angles, has_periodic_base
from trunnion.errors import ComputationError, InputError, TrunnionError
from trunnion.results.words import HERTZ, Words

if TYPE_CHECKING:
    from trunnion.floquet.stability.stability import Stability
    from trunnion.motion.orbits.periodic_response import PeriodicResponse
    from trunnion.motion.passing.run_up import RunUp
    from trunnion.motion.simulation.simulation import LineSimulation
    from trunnion.motion.transients.result import Transient

PER_TURN, PER_CYCLE, FEWEST, MOST_FRAMES = 96, 20, 96, 6000
"""Frames: of a turn, of a cycle of the highest order that matters, at least, and at most."""
MOST_NUMBERS = 400_000
"""Angles that a page holds at most."""
MOST_TURNS = 12
"""Of a motion that repeats; what takes longer is shown that far."""
SEEN = 1e-3
"""Share of the largest amplitude below which an order does not count."""
A_TURN, A_CYCLE, A_PASSAGE = 4.0, 2.0, 24.0
"""Seconds that a turn, a cycle of a mode and a whole passage take to watch."""
GROWN = 10.0
"""By what factor a disturbance grows, or dies out, before it begins again."""
BESIDE = (0.99, 1.01, 0.98, 1.02, 0.95, 1.05, 0.9, 1.1, 0.85, 1.15, 0.8, 1.25, 0.7, 1.4, 0.6, 1.6, 0.5, 2.0)
"""Of the speed: where a disturbance of the other kind is looked for."""


def turning(line: Driveline | Assembly, speed: float | str | None = None) -> tuple[Assembly, Movement]:
    """One period of the line with rigid shafts, up to ``MOST_TURNS``."""
    assembly = assemble(line)
    at = operating_speed(assembly.line, speed)
    table, turns = assembly.table(1, at), _turns(assembly)
    tau = 2 * np.pi * np.linspace(0.0, turns[0], _count(assembly, PER_TURN * turns[0]) + 1)
    angle = rigid_angles(assembly, table, tau)
    nothing = np.zeros((len(tau), len(assembly.topology.compliances)))
    words = Words(speed_unit(assembly.line))
    how = "its joints make the shafts behind them uneven" if has_joint_angles(assembly) else "nothing makes it uneven"
    said = f"The line turns at {words.speed(at)}, shafts rigid: {how}."
    return assembly, Movement(
        "turning", said, tau / at, angle, np.zeros_like(angle), nothing, turns[1], slow=A_TURN * at / (2 * np.pi),
        notes=_not_whole(turns),
    )  # fmt: skip


def mode(line: Driveline | Assembly, number: int = 1) -> tuple[Assembly, Movement]:
    """One cycle of an undamped mode of the straight line, counted without those that do not vibrate."""
    from trunnion.modes.natural_frequencies import natural_frequencies

    assembly = assemble(line)
    found, topo = natural_frequencies(assembly), assembly.topology
    elastic = len(found.elastic)
    if isinstance(number, bool) or not isinstance(number, int | np.integer) or not 1 <= number <= elastic:
        raise InputError("is not a mode that vibrates", key="mode", value=number, remedy=f"give 1 to {elastic}")
    place = found.still + int(number) - 1
    frequency = float(found.undamped_frequency[place])
    cycle = np.linspace(0.0, 2 * np.pi, FEWEST + 1)
    shape = found.shape[:, place]
    deviation = np.cos(cycle)[:, None] * (topo.turning @ shape)
    table = assembly.table(1)
    stiffness = assembly.coefficients(table, any_frequency=True).stiffness[0]
    torque = np.cos(cycle)[:, None] * (stiffness * (topo.elongations @ shape))
    moved = with_massless(assembly, deviation)
    rigid = np.broadcast_to(rigid_angles(assembly, table, np.zeros(1)), moved.shape)
    most = found.names[int(np.abs(shape).argmax())]
    ratio = found.damping_ratio[place]
    damped = "overdamped" if np.isnan(ratio) else f"damping ratio {ratio:.3g}"
    said = (
        f"Mode {number} of the straight line: {HERTZ.speed(frequency)} undamped, {damped}. {most} moves most; the size "
        "is arbitrary, torques are for 1 rad there."
    )
    one = Movement(
        f"mode {number}", said, cycle / frequency, rigid, moved, torque, arbitrary=True,
        slow=A_CYCLE * frequency / (2 * np.pi),
    )  # fmt: skip
    return assembly, replace(one, factor=float(f"{TO_BE_SEEN:.1g}"))


def response(line: Driveline | Assembly, speed: float | str | None = None) -> tuple[Assembly, Movement]:
    """The linear response to all that excites the line, over its period."""
    from trunnion.steady.orders.spectrum import order_spectrum

    assembly = assemble(line)
    at = operating_speed(assembly.line, speed)
    if has_periodic_base(assembly):
        raise InputError(
            "is free–free and has joint angles: it has no linear response about even rotation", element="driveline",
            key="what", value="response", remedy="ask for motion, its true periodic motion",
        )  # fmt: skip
    topo, table = assembly.topology, assembly.table(1, at)
    spectrum = order_spectrum(assembly, np.array([at]))
    places, size = spectrum.channels, np.abs(spectrum.amplitude[0])
    if not np.isfinite(size[:, places.torque]).all():
        raise ComputationError(f"there is no steady response at {at:.6g} rad/s: an undamped resonance")
    loud = size.max(axis=1, initial=0.0) > SEEN * size.max(initial=0.0)
    highest = float(np.abs(spectrum.angular_frequency[0, loud]).max(initial=at) / at)
    common = float(spectrum.common_turns or 0)
    turns = (common, True) if 0 < common <= MOST_TURNS else (float(MOST_TURNS if common else 4), False)
    if not spectrum.order:
        turns = (1.0, True)
    frames = _count(assembly, max(PER_TURN, PER_CYCLE * highest) * turns[0])
    tau = 2 * np.pi * np.linspace(0.0, turns[0], frames + 1)
    seen = spectrum.wave(0, np.nan_to_num(spectrum.amplitude[0]), np.nan_to_num(spectrum.mean[0]), tau / at)
    rigid = rigid_angles(assembly, table, tau)
    twisted = base_motion(topo, assembly.coefficients(table, any_frequency=True), tau)
    moved = twisted.angle[0] - rigid + station_deviation(topo, twisted.relative[0], seen[:, places.deviation])
    moved = with_massless(assembly, moved)
    words = Words(speed_unit(assembly.line))
    said = f"Linear response to all that excites the line, at {words.speed(at)}."
    one = Movement(
        "response", said, tau / at, rigid, moved, seen[:, places.torque], turns[1], slow=A_TURN * at / (2 * np.pi),
        notes=(*_not_whole(turns), *_coarse(frames, highest * turns[0])),
    )  # fmt: skip
    return assembly, exaggerated(one, topo)


def motion(line: Driveline | Assembly, speed: float | str | None = None) -> tuple[Assembly, Movement]:
    """The true periodic motion at a speed: joints at large swing, gaps that open and close."""
    from trunnion.motion.orbits.periodic_response import PeriodicResponse, periodic_response

    found = periodic_response(line, speed, compare=False)
    assert isinstance(found, PeriodicResponse)
    return periodic_movement(found)


def periodic_movement(found: PeriodicResponse) -> tuple[Assembly, Movement]:
    """A periodic motion that is computed already."""
    if not found.outcome.ok:
        raise ComputationError(f"no periodic motion is found there: {found.outcome.sentence}")
    assembly, turns = found.line.assembly, found.turns
    whole = (turns, True) if turns <= MOST_TURNS else (float(MOST_TURNS), False)
    start = float(found.trajectory.time_of_state[0])
    length = found.period * whole[0] / turns
    frames = _count(assembly, max(4 * PER_TURN * whole[0], found.trajectory.steps * 2))
    time = np.linspace(0.0, length, frames + 1)
    inside = start + np.minimum(time, found.period * (1 - 1e-12))
    seen = found.motion_at(inside)
    table = assembly.table(1, found.speed)
    angle = assembly.topology.mean_speeds * (found.speed * (start + time))[:, None] + seen.rotation
    rigid, moved = parted(assembly, table, angle)
    words = Words(found.unit)
    contacts = [str(one) for one in found.contacts]
    said = f"The line's own periodic motion at {words.speed(found.speed)}, {turns:.4g} turns long."
    one = Movement(
        "motion", " ".join([said, *contacts]), time, rigid, moved, seen.torque, whole[1],
        slow=A_TURN * found.speed / (2 * np.pi), notes=_not_whole(whole),
    )  # fmt: skip
    return assembly, exaggerated(one, assembly.topology)


def disturbance(
    line: Driveline | Assembly, speed: float | str | None = None, beside: float | str | None = None
) -> tuple[Assembly, tuple[Movement, ...]]:
    """The disturbance that grows fastest at a speed, or decays slowest; next to it that at another speed, by default
    the nearest one looked at where it does the opposite."""
    from trunnion.floquet.stability.stability import stability
    from trunnion.results.verdict import Verdict

    assembly = assemble(line)
    if has_periodic_base(assembly):
        raise InputError(
            "is free–free and has joint angles: disturbances of its own motion are not drawn", element="driveline",
            key="what", value="disturbance", remedy="put a ConstantSpeed in front, or ask for motion",
        )  # fmt: skip
    at = operating_speed(assembly.line, speed)
    first = stability(assembly, at)

    def other() -> Iterator[Stability]:
        span = stated_range(assembly.line) or (0.0, np.inf)
        fit = [share * at for share in BESIDE]
        for there in [v for v in fit if span[0] <= v <= span[1]] + [v for v in fit if not span[0] <= v <= span[1]]:
            try:
                yield stability(assembly, there)
            except TrunnionError:
                continue

    second = None
    if beside is not None:
        second = stability(assembly, operating_speed(assembly.line, beside))
    else:
        opposite = {Verdict.UNSTABLE: Verdict.STABLE, Verdict.STABLE: Verdict.UNSTABLE}.get(first.verdict)
        second = next((one for one in other() if one.verdict is opposite), None)
    shown = [_disturbed(assembly, one) for one in (first, second) if one is not None]
    if second is None:
        note = "At none of the speeds looked at, from half to twice this one, does it do otherwise."
        shown = [replace(shown[0], notes=(*shown[0].notes, note))]
    return assembly, tuple(shown)


def _disturbed(assembly: Assembly, found: Stability) -> Movement:
    """The critical Floquet mode of a line as Re[p e^{λt}], p with the period of the coefficients."""
    from trunnion.equations.linear import line_matrices, periodic_linear_system
    from trunnion.floquet.propagation.floquet_modes import propagated

    topo, at = assembly.topology, found.speed
    table = assembly.table(1, at)
    n = topo.size
    critical = int(np.abs(np.abs(found.multipliers) - found.spectral_radius).argmin())
    multiplier, mode_state = complex(found.multipliers[critical]), found.floquet_modes[:, critical]
    mode_state = mode_state / mode_state[np.abs(mode_state[:n]).argmax()]  # real where it is largest, at the start
    system = periodic_linear_system(assembly, table)
    run = propagated(system, 1e-10)
    turns = found.period / (2 * np.pi)
    frames = _count(assembly, max(PER_TURN * turns, PER_CYCLE * max(system.frequencies, default=1.0) * turns))
    least = 1 << int(np.ceil(np.log2(frames)))
    at_rest = run.states(np.zeros(2 * n), least)
    state = run.states(np.ascontiguousarray(mode_state.real), least) - at_rest
    state = state + 1j * (run.states(np.ascontiguousarray(mode_state.imag), least) - at_rest)
    exponent, tau = cmath.log(multiplier) / found.period, np.linspace(0.0, found.period, len(state))
    shape = state[:, :n] * np.exp(-exponent * tau)[:, None]
    few = max(1, (len(state) - 1) // _enough(shape, PER_TURN * turns))
    tau, shape = tau[::few], shape[::few]
    co = assembly.coefficients(table)
    base, matrices = base_motion(topo, co, tau), line_matrices(topo, co, tau)
    moved = station_deviation(topo, base.relative[0], shape)
    if topo.graph:
        twist = shape @ topo.elongations.T
    else:
        twist = np.zeros((len(tau), len(topo.compliances)), dtype=complex)
        for e, (far, near) in enumerate(topo.ends):
            twist[:, e] = (shape[:, far] if far >= 0 else 0) - (
                matrices.ratio[0, :, e] * shape[:, near] if near >= 0 else 0
            )
    largest = np.abs(moved).max()
    moved, torque = with_massless(assembly, moved / largest), co.stiffness[0] * twist / largest
    rate = exponent * at
    words = Words(found.unit)
    grows = found.growth_rate > 0
    said = f"{words.speed(at)}, {found.verdict}: the disturbance that {'grows fastest' if grows else 'decays slowest'} "
    said += f"({found.growth_rate:+.4g} 1/s, × {abs(multiplier) ** (1 / turns):.5g} a turn)"
    named = f", of the {found.resonance.in_words}" if found.resonance is not None else ""
    one = Movement(
        "grows" if grows else "decays", f"{said}{named}. Its size is arbitrary; what the line does without it is left "
        "out.", tau / at, rigid_angles(assembly, table, tau), moved, torque, growth=rate, arbitrary=True,
        factor=float(f"{TO_BE_SEEN:.1g}"), slow=A_TURN * at / (2 * np.pi),
    )  # fmt: skip
    return one


def run_up(
    line: Driveline | Assembly,
    speeds: tuple[float, float] | None = None,
    acceleration: float | None = None,
) -> tuple[Assembly, Movement]:
    """A passage at constant acceleration, by default over the range of the file in ten seconds; where it is too long
    for the frames, the part of it around the largest vibration."""
    from trunnion.motion.passing.run_up import run_up as passage

    assembly = assemble(line)
    ends = speeds or stated_range(assembly.line)
    if ends is None or ends[0] == ends[1]:
        raise InputError("are not known", key="speeds", remedy="give the lowest and the highest speed")
    rate = acceleration if acceleration is not None else abs(ends[1] - ends[0]) / 10.0
    return passage_movement(passage(assembly, *ends, acceleration=rate, steady=0))


def passage_movement(found: RunUp) -> tuple[Assembly, Movement]:
    """A run-up that is computed already."""
    run: LineSimulation = found.simulation
    worst = int(np.abs(found.vibration).max(axis=1).argmax())
    words, rate = Words(found.unit), found.acceleration
    ends = found.schedule.first, found.schedule.last
    said = (
        f"Run-up from {words.ends(*ends)} at {rate:.4g} rad/s²: the largest vibration stands at "
        f"{words.speed(float(found.speed[worst]))}. {found.outcome.sentence}"
    )
    shown = run.line.assembly
    reference = run.profile.angle
    time, notes = _window(shown, run.end, float(found.time[worst]), lambda t: reference(t) / (2 * np.pi), PER_TURN)
    seen = run.motion_at(time)
    table = shown.table(1, run.line.speed)
    angle = shown.topology.mean_speeds * reference(time)[:, None] + seen.rotation
    rigid, moved = parted(shown, table, angle)
    one = Movement(
        "run-up",
        said,
        time,
        rigid,
        moved,
        seen.torque,
        repeats=False,
        slow=A_PASSAGE / (time[-1] - time[0]),
        notes=notes,
    )
    return shown, exaggerated(one, shown.topology)


def transient(line: Driveline | Assembly, scenario: str | None = None) -> tuple[Assembly, Movement]:
    """A scenario of the file, by default its first."""
    from trunnion.motion.transients.transient import transient as follow

    assembly = assemble(line)
    known = [one.name for one in assembly.line.scenarios]
    if not scenario and not known:
        raise InputError(
            "has no scenario", element="driveline", key="scenario", remedy="write [[scenario]] in its file"
        )
    found: Transient = follow(assembly, scenario or known[0])
    return transient_movement(found)


def passing(
    line: Driveline | Assembly, speeds: tuple[float, float] | None = None, scenario: str | None = None
) -> tuple[Assembly, Movement]:
    """From one speed to another under the torques of a scenario or of a motor of the line, or as far as it comes."""
    from trunnion.motion.passing.passing import passing as follow

    ends = speeds or stated_range(assemble(line).line)
    if ends is None:
        raise InputError("are not known", key="speeds", remedy="give the lowest and the highest speed")
    found = follow(line, ends, scenario=scenario)
    shown, one = transient_movement(found.run)
    return shown, replace(one, title="passing", said=found.outcome.sentence)


def transient_movement(found: Transient) -> tuple[Assembly, Movement]:
    """A transient that is computed already."""
    shown = found.line.assembly
    peak = float(found.peak_time[int(np.abs(found.peak_torque).argmax())])
    even = found.time
    turned = np.abs(found.moving.angle[:, 0] - found.moving.angle[0, 0]) / (2 * np.pi)

    def turns(t: Array) -> Array:
        return np.interp(t, even, np.maximum.accumulate(turned))

    time, notes = _window(shown, found.end, peak, turns, PER_TURN, found.start_time, found.steps)
    seen = found.at(time, applied=False)
    rigid, moved = parted(shown, shown.table(1, found.line.speed), seen.angle)
    said = f"{found.name or 'transient'} over {found.end - found.start_time:.4g} s: {found.outcome.sentence}"
    one = Movement(
        "transient", said, time, rigid, moved, seen.torque, repeats=False, slow=A_PASSAGE / (time[-1] - time[0]),
        notes=notes,
    )  # fmt: skip
    return shown, exaggerated(one, shown.topology)


def _window(
    assembly: Assembly, end: float, peak: float, turns: object, per_turn: float, start: float = 0.0, steps: int = 0
) -> tuple[Array, tuple[str, ...]]:
    """Times of the frames: the whole motion, or the part of it around its ``peak`` that they can show."""
    assert callable(turns)
    span = np.linspace(start, end, 4001)
    needed = np.asarray(turns(span)) * per_turn
    steps_by_time = np.linspace(0.0, 2.0 * steps, len(span))
    needed = np.maximum(needed - needed[0], steps_by_time)
    most = min(MOST_FRAMES, MOST_NUMBERS // len(assembly.topology.stations))
    if needed[-1] <= most:
        return np.linspace(start, end, max(FEWEST, int(needed[-1])) + 1), ()
    at = float(np.interp(peak, span, needed))
    first = float(np.clip(at - 0.6 * most, 0.0, needed[-1] - most))
    begin, last = (float(np.interp(k, needed, span)) for k in (first, first + most))
    note = f"Shown is {begin:.4g} to {last:.4g} s of {end - start:.4g} s, around the largest torque."
    return np.linspace(begin, last, most + 1), (note,)


def _turns(assembly: Assembly) -> tuple[float, bool]:
    """Turns of the input to show, and whether all of the line is back in phase after them."""
    period = assembly.topology.period_turns() if assembly.topology.rates else 1
    whole = float(np.ceil(float(period))) if float(period) < 1 else float(period)
    if (whole / float(period)) % 1:
        whole = float(period)
    return (whole, True) if whole <= MOST_TURNS else (float(MOST_TURNS), False)


def _count(assembly: Assembly, wanted: float) -> int:
    """Frames: as many as wanted, within what a page holds."""
    most = min(MOST_FRAMES, MOST_NUMBERS // len(assembly.topology.stations))
    return int(np.clip(np.ceil(wanted), FEWEST, max(most, FEWEST)))


def _enough(shape: Array, least: float) -> int:
    """Of samples of a period (time, n), both ends included, how many show every harmonic that matters; a power of 2."""
    size = np.abs(np.fft.fft(shape[:-1], axis=0)).max(axis=1)
    order = np.minimum(np.arange(len(size)), np.arange(len(size), 0, -1))
    highest = order[size > SEEN * size.max()].max()
    return 1 << int(np.ceil(np.log2(max(PER_CYCLE * highest, least))))


def _not_whole(turns: tuple[float, bool]) -> tuple[str, ...]:
    return () if turns[1] else (f"It does not repeat within {turns[0]:g} turns; that many are shown.",)


def _coarse(frames: int, cycles: float) -> tuple[str, ...]:
    """What is said where the fastest order has few frames."""
    if frames >= 8 * cycles:
        return ()
    return (f"The highest order has {frames / cycles:.2g} frames a cycle only: look at it over fewer turns.",)
