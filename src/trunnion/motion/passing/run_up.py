"""``run_up``: passage through resonance at constant acceleration, against the steady response.

A line that passes a resonance quickly never reaches its steady amplitude; one that passes slowly does, and one
that is accelerated briskly is twisted by its own inertia. The torque is therefore told apart: what the loads and the
inertia behind a shaft ask for at each speed and acceleration (quasi-static), and what vibrates about that.

The acceleration is that of the drive. Where a line starts free, nothing turns at a prescribed speed: its disks with a
drive_share carry the torque that balances the loads at each speed asked for and accelerates the whole inertia, were it
rigid and its joints straight. What dampers, bent joints and vibration take beyond that makes it lag, and a resonance
that takes all that accelerates captures it (Sommerfeld's effect); ``capture`` tells how such a run ends.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.arguments import one_speed
from trunnion.driveline.driveline import Driveline
from trunnion.equations.coefficients import Assembly
from trunnion.equations.line_system import LineSystem, line_system
from trunnion.equations.loads import drive_torques, given_shares, static_torque
from trunnion.equations.steady_base import require_share
from trunnion.errors import InputError
from trunnion.motion.orbits.periodic_branch import periodic_branch
from trunnion.motion.passing.capture import run_to_the_end, slipped
from trunnion.motion.passing.run_up_ending import RunUpEnding
from trunnion.motion.passing.run_up_result import RunUp, SteadyResponse
from trunnion.motion.passing.schedule import Schedule, check, schedule
from trunnion.motion.simulation.input_rotation import TURN
from trunnion.motion.simulation.line_simulation import LineSimulation
from trunnion.motion.simulation.simulate import simulate_line
from trunnion.numerics.curves import extremes_in
from trunnion.steady.shooting.free_orbit import closes, kept_speed_orbit
from trunnion.steady.shooting.periodic_orbit import periodic_orbit
from trunnion.waiting import OutOfTime, keeps_time, time_is_up, time_kept

BEGINNING = inf, 0.3
"""Of a time limit, what finding the motion to begin on leaves to the run, and the share that it takes."""
STEADY_SPEEDS = 81
STATIC_SPEEDS = 65
"""Speeds at which the static torque is computed; between them it is interpolated."""
SLOWEST = 1e-3
"""Share of the first speed below which no static torque is asked for: a line that stops has none by speed."""
EVENED = 9
"""Turns over which the lag is averaged for the acceleration that a line which starts free has."""
LOOSER, LOOSEST = 100.0, 1e-6
"""How much looser the tolerance of a second run is whose ending must be the same, and how loose it may be."""


@keeps_time
def run_up(
    line: Driveline | Assembly,
    first: float | str,
    last: float | str,
    *,
    acceleration: float,
    ramp: float | None = None,
    steady: int = STEADY_SPEEDS,
    tolerance: float = 1e-9,
    within: float | None = None,
) -> RunUp:
    """Run a line from speed ``first`` to ``last`` at an acceleration that sets in smoothly and then stays.

    Parameters
    ----------
    first, last : input speeds [rad/s], numbers or texts with a unit; a lower ``last`` runs down.
    acceleration : its magnitude [rad/s²].
    ramp : time [s] over which the acceleration sets in; by default three periods of the slowest mode, at most until
        half of the speed range is passed; 0 for at once.
    steady : number of speeds, at least, at which the steady periodic motion is computed for comparison; 0 leaves
        it out.
    within : seconds that it may take; the run is given as far as it came by then, and ``ended`` says what is left out.

    The run begins on the periodic motion at ``first`` where there is one, otherwise without twist (a line that starts
    free: twisted by its mean torques). A line that starts free and is behind at the end is followed further, its drives
    holding their last torque, until it reaches the last speed or hangs: ``outcome.kind`` is "reached", "captured",
    "short of torque", "stalled" or "undecided". Where it was behind on the way, another run at another tolerance must
    end alike.

    Raises
    ------
    InputError : speeds or acceleration not positive; a negative ramp, or one too long for the speeds; a line that
        starts free without a drive_share; more than 20 000 turns.
    """
    first, last = one_speed(first, "first"), one_speed(last, "last")
    check(first, last, acceleration)
    if isinstance(steady, bool) or not isinstance(steady, int | np.integer) or steady < 0:
        raise InputError("must be a whole number, 0 for none", element="run_up", key="steady", value=steady)
    prepared = line_system(line, first)
    require_share(prepared.assembly)
    asked = schedule(prepared.assembly, first, last, acceleration, ramp)
    ended = ""
    try:
        with time_kept(*BEGINNING):
            begun, extra = _begin(prepared)
    except OutOfTime as error:
        begun, extra = prepared.twisted() if prepared.assembly.topology.free else prepared.rest(), 0.0
        ended = f"{error.why}: the run does not begin on the periodic motion at the first speed"
    run, ending = _run(prepared, asked, begun, extra, tolerance)
    if not run.outcome.ok and (why := time_is_up()):
        ended = f"{why}: the run is not whole"
    elif ending is not None and not ending.on_time:
        other = LOOSER * tolerance if LOOSER * tolerance <= LOOSEST else tolerance / LOOSER
        again = _run(prepared, asked, begun, extra, other)[1]
        if why := time_is_up():
            ended = f"{why}: no run at another tolerance confirms how it ends"
        elif again is not None and again.kind != ending.kind:
            ending = replace(ending, kind="undecided", ways=(ending.kind, again.kind))
    # Windows of equal angle, a turn or a little more, so that none is left over.
    angle = run.whole.furthest
    windows = max(int(angle / TURN), 1)
    edges = np.append(run.whole.times_at(angle * np.arange(windows) / windows), run.end)
    speed = np.diff(run.whole.angle(edges)) / np.diff(edges)
    lag = np.diff(asked.profile.angle(edges)) / np.diff(edges) - speed
    middle = (edges[:-1] + edges[1:]) / 2
    own = _Own(asked, middle, lag) if ending is not None else None
    quasi_static, count = _quasi_static(prepared.assembly, asked, own), len(run.shafts)

    def curves(times: Array) -> Array:
        torque = run.torque_at(times)
        return np.hstack([torque, torque - quasi_static(times)])

    seen = extremes_in(curves, run.cuts, edges)
    found = None
    try:
        found = _steady(prepared.assembly, first, last, steady) if steady else None
    except OutOfTime as error:
        ended = ended or f"{error.why}: no steady response beside the run"
    return RunUp(
        simulation=run,
        schedule=asked,
        time=middle,
        speed=speed,
        upper=seen.high[:, :count],
        lower=seen.low[:, :count],
        vibration=seen.largest[:, count:],
        lag=lag,
        inertia_torque=np.abs(_inertia_torque(prepared.assembly)) * asked.acceleration,
        steady=found,
        ending=ending,
        ended=ended,
    )


def _run(
    prepared: LineSystem, asked: Schedule, begun: Array, extra: float, tolerance: float
) -> tuple[LineSimulation, RunUpEnding | None]:
    """The run, and how it ends where the line starts free."""
    run = simulate_line(
        prepared.assembly, asked.profile.time[-1], speed=asked.profile, start=begun, tolerance=tolerance, drive=extra
    )
    let_go = slipped(run, asked) if run.outcome.ok else None
    if let_go is not None or not run.starts_free:
        return run, let_go
    return run_to_the_end(run, asked, extra, tolerance)


def _begin(prepared: LineSystem) -> tuple[Array, float]:
    """The state to begin with, and what a free line's drives give there [N m at the input] beyond the balance."""
    if prepared.assembly.topology.free:
        begun = prepared.twisted()
        if not closes(prepared):
            return begun, 0.0
        found = kept_speed_orbit(prepared, settle=False)
        return (found.orbit.start, found.extra_torque) if found.orbit.outcome.ok else (begun, 0.0)
    begun = prepared.rest()
    if prepared.system.forcing_period is not None and not prepared.assembly.topology.dragged:
        orbit = periodic_orbit(prepared.system, start=begun, settle=False)
        begun = orbit.start if orbit.outcome.ok else begun
    return begun, 0.0


def _inertia_torque(assembly: Assembly) -> Array:
    """Torque of every compliance (shaft,) [N m] per acceleration of the input [rad/s²], in the sense of its twist."""
    topo = assembly.topology
    coefficients = assembly.coefficients(assembly.table(1), statically_twisted=False, free_play=True)
    ratios = np.abs(topo.mean_speeds)
    needed = coefficients.inertia * ratios
    if topo.free:
        share = given_shares(topo, assembly.packed.column, assembly.table(1))
        needed = needed + drive_torques(topo, share, needed @ ratios)
    return np.asarray(static_torque(topo, needed)[0])


@dataclass(frozen=True)
class _Own:
    """Speed and acceleration of a line that starts free: what is asked, less its ``lag`` (turns,) [rad/s] about
    ``time`` (turns,) [s], evened out over some turns so that vibration of the rotation does not count as
    acceleration."""

    asked: Schedule
    time: Array
    lag: Array

    @cached_property
    def _even(self) -> Array:
        kernel = np.ones(EVENED) / EVENED
        return np.convolve(np.pad(self.lag, EVENED // 2, mode="edge"), kernel, mode="valid")

    def at(self, times: Array) -> tuple[Array, Array]:
        """Speed [rad/s] and acceleration [rad/s²] (times,)."""
        slope = np.gradient(self._even, self.time) if len(self.time) > 1 else np.zeros(1)
        speed = self.asked.profile.at(times) - np.interp(times, self.time, self._even)
        return speed, self.asked.rate(times) - np.interp(times, self.time, slope)


def _quasi_static(assembly: Assembly, asked: Schedule, own: _Own | None) -> Callable[[Array], Array]:
    """Times → torque (times, shaft) [N m] that loads and inertia ask for at their speed and acceleration."""
    ends = [asked.first, asked.last] if own is None else [asked.first, asked.last, *own.at(own.time)[0]]
    speeds = np.linspace(max(min(ends), SLOWEST * asked.first), max(ends), STATIC_SPEEDS)
    table = np.repeat(assembly.table(1), STATIC_SPEEDS, axis=0)
    table[:, 0] = speeds
    static = assembly.coefficients(table, free_play=True).torque
    inertia = _inertia_torque(assembly)

    def torque(times: Array) -> Array:
        speed, rate = (asked.profile.at(times), asked.rate(times)) if own is None else own.at(times)
        held = np.stack([np.interp(speed, speeds, column) for column in static.T], axis=1)
        return held + rate[:, None] * inertia

    return torque


def _steady(assembly: Assembly, first: float, last: float, points: int) -> SteadyResponse | None:
    """The branch of steady motions over the range, folds and all; what was found of it."""
    prepared = line_system(assembly, first)
    if prepared.system.forcing_period is None or (assembly.topology.free and not closes(prepared)):
        return None
    if prepared.sliders or assembly.topology.dragged:  # no branch follows them
        return None
    branch = periodic_branch(
        assembly, "speed", min(first, last), max(first, last), longest_step=1 / points, tolerance=1e-10
    )
    return SteadyResponse(branch.parameter, branch.largest, branch.peak_to_peak / 2, branch.verdict)
