"""``run_up``: passage through resonance at constant acceleration, against the steady response.

A line that passes a resonance quickly never reaches its steady amplitude; one that passes slowly does, and one
that is accelerated briskly is twisted by its own inertia. The torque is therefore divided: what the loads and the
inertia behind a shaft ask for at each speed and acceleration (quasi-static), and what vibrates about that.

The acceleration is that of the drive. Where a line is free–free, nothing turns at a prescribed speed: its disks with a
drive_share carry the torque that balances the loads at each speed asked for and accelerates the whole inertia, were it
rigid and its joints straight. What dampers, angled joints and vibration take beyond that makes it lag, and a resonance
that takes all that accelerates captures it (Sommerfeld's effect); ``capture`` tells how such a run ends.

Amplitudes of excitations that go with the speed or the load are those at the mean speed of the moment
(``equations.amplitudes_by_speed``).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil, inf

import numpy as np
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from trunnion.arrays import Array, Codes
from trunnion.driveline.arguments import one_speed
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.slip_clutches import SlipClutch
from trunnion.equations.amplitudes_by_speed import refuse_uncovered
from trunnion.equations.coefficients import Assembly
from trunnion.equations.harmonics import line_harmonics
from trunnion.equations.inertia_torque import inertia_torque
from trunnion.equations.line_regimes import staged_springs
from trunnion.equations.line_system import LineSystem, line_system
from trunnion.equations.prepared_line import in_series
from trunnion.equations.released import refuse_pendulums
from trunnion.equations.steady_base import require_share
from trunnion.errors import InputError
from trunnion.motion.orbits.periodic_branch import periodic_branch
from trunnion.motion.passing.capture import RunUpEnding, run_to_the_end, slipped
from trunnion.motion.passing.schedule import SpeedSchedule, check, schedule
from trunnion.motion.simulation.input_rotation import TURN
from trunnion.motion.simulation.simulate import simulate_line
from trunnion.motion.simulation.simulation import LineSimulation
from trunnion.numerics.curves import extremes_in
from trunnion.response.orders.response import order_response, swing_of_torques
from trunnion.response.speed_sweep import sweep_speeds
from trunnion.results.counts import counted
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, computed, coordinate, internal, labelled, variable
from trunnion.results.of_systems import ending
from trunnion.results.outcome import Outcome
from trunnion.results.result import Result
from trunnion.results.speeds import about_speed, rounded_speed, show_acceleration, show_speed
from trunnion.results.units import figures
from trunnion.results.variables import Attribute, Coordinate, Variable
from trunnion.steady.shooting.free_orbit import is_periodic, kept_speed_orbit
from trunnion.steady.shooting.periodic_orbit import periodic_orbit
from trunnion.waiting import OutOfTime, keeps_time, time_is_up, time_kept

BEGINNING = inf, 0.3
"""Of a time limit, what finding the motion to begin on leaves to the run, and the share that it takes."""
STEADY_SPEEDS = 81
STATIC_SPEEDS = 65
"""Speeds at which the static torque is computed; between them it is interpolated."""
SLOWEST = 1e-3
"""Share of the first speed below which no static torque is asked for: a line that stops has none by speed."""
LONGEST_CYCLE = 4
"""Turns of a run whose largest torques are looked at together, at most; those of a four-stroke engine are two."""
EVENED = 9
"""Turns over which the lag is averaged for the acceleration that a free–free line has."""
LOOSER, LOOSEST = 100.0, 1e-6
"""How much looser the tolerance of a second run is whose ending must be the same, and how loose it may be."""


@dataclass(frozen=True)
class SteadyResponse:
    """Steady torque over speed: speed (points,) [rad/s]; largest (points, shaft), the largest |torque| [N m] of the
    periodic motion; swing (points, shaft): half of its peak-to-peak; verdict (points,) codes. In order along the
    branch, which may fold back.

    linear: what is to be known where it is no branch but the linear response, as a clause; "" of a branch.
    """

    speed: Array
    largest: Array
    swing: Array
    verdict: Codes
    linear: str = ""


@labelled
class RunUp(Result):
    """A passage at constant acceleration, turn by turn of the input, the last with the little that leaves none over.

    The speed of a free–free line is that of the whole line, whose vibration does not count; the quasi-static torque is
    what loads and inertia ask for at the speed and acceleration that the line has.
    """

    simulation: LineSimulation = internal("the motion")
    schedule: SpeedSchedule = internal("the speed asked for")
    time: Array = variable("turn", "s", "middle of the turn")
    speed: Array = variable("turn", "rad/s", "mean")
    upper: Array = variable("turn shaft", "N*m", "largest torque", name="torque_upper")
    lower: Array = variable("turn shaft", "N*m", "smallest torque", name="torque_lower")
    vibration: Array = variable("turn shaft", "N*m", "largest distance of the torque from the quasi-static one")
    swing: Array = variable(
        "turn shaft",
        "N*m",
        "half peak to peak of its distance from the quasi-static one, over the period about the turn",
    )
    lag: Array = variable("turn", "rad/s", "by how much a free–free line turned slower than asked")
    inertia_torque: Array = variable(
        "shaft", "N*m", "accelerates the inertia behind it at the full acceleration, were it rigid and joints straight"
    )
    steady: SteadyResponse | None = internal("response in the same range, None if not asked for")
    ending: RunUpEnding | None = internal("of a free–free line, None where the speed is prescribed")
    unit: str = internal("of speeds in print")
    period: int = attribute("turns in which each excitation by order repeats, four at most", default=1)
    ended: str = attribute("what a time limit left out, as a clause", default="")

    @property
    @computed(attribute())
    def acceleration(self) -> float:
        """Magnitude asked for [rad/s²]."""
        return self.schedule.acceleration

    @property
    @computed(attribute())
    def ramp(self) -> float:
        """Time over which it sets in [s]."""
        return self.schedule.ramp

    @property
    def outcome(self) -> Outcome:
        """How the run ended, speeds in the unit of the line's description: ``kind`` is "reached", "slipped" where a
        clutch let go, or for a free–free line "captured", "short of torque", "stalled" or "undecided"; see
        ``RunUpEnding``."""
        return self.outcome_in(self.unit)

    def outcome_in(self, unit: str) -> Outcome:
        """The same, speeds in ``unit``."""
        failed = self.simulation.outcome
        return failed if self.ending is None else self.ending.outcome(failed, unit)

    @property
    @computed(coordinate("shaft"))
    def shafts(self) -> tuple[str, ...]:
        """Names of the shafts."""
        return self.simulation.shafts

    @property
    def largest(self) -> Array:
        """Largest |torque| in each turn (turns, shaft) [N m]."""
        return np.maximum(np.abs(self.upper), np.abs(self.lower))

    @property
    def envelope(self) -> Array:
        """The same over the ``period`` about each turn."""
        return np.asarray(maximum_filter1d(self.largest, self.period, axis=0, mode="nearest"))

    @property
    @computed(variable("shaft", "N*m"))
    def peak_torque(self) -> Array:
        """Largest |torque| of every shaft over the whole passage [N m]."""
        return np.asarray(self.largest.max(axis=0))

    @property
    @computed(variable("shaft", "rad/s"))
    def peak_speed(self) -> Array:
        """Mean input speed [rad/s] of the turn in which each shaft has it."""
        return self.speed[self.largest.argmax(axis=0)]

    @cached_property
    def steady_peak(self) -> Array:
        """Largest |torque| of every shaft among the steady motions found [N m]; NaN without them."""
        if self.steady is None or not np.isfinite(self.steady.largest).any():
            return np.full(len(self.shafts), np.nan)
        return np.asarray(np.nanmax(self.steady.largest, axis=0))

    @property
    @computed(variable("shaft", "N*m"))
    def peak_vibration(self) -> Array:
        """Largest distance of every shaft's torque (shaft,) [N m] from the quasi-static one."""
        return np.asarray(self.vibration.max(axis=0))

    @property
    @computed(variable("shaft", "rad/s"))
    def vibration_speed(self) -> Array:
        """Mean input speed [rad/s] of the turn in which each shaft has it."""
        return self.speed[self.vibration.argmax(axis=0)]

    @property
    @computed(variable("shaft", "N*m"))
    def peak_swing(self) -> Array:
        """Half of the largest peak-to-peak of every shaft's torque (shaft,) [N m] about the quasi-static one, which is
        what the steady vibration is compared with."""
        return np.asarray(self.swing.max(axis=0))

    @cached_property
    def steady_vibration(self) -> Array:
        """Half of the largest peak-to-peak torque of every shaft among the steady motions found [N m]; NaN without."""
        if self.steady is None or not np.isfinite(self.steady.swing).any():
            return np.full(len(self.shafts), np.nan)
        return np.asarray(np.nanmax(self.steady.swing, axis=0))

    def declared(self) -> Iterator[Variable | Attribute]:
        """What the fields hold, the steady response and the ending."""
        if self.steady is not None:
            yield Coordinate("steady_speed", self.steady.speed, "steady_speed", "rad/s")
            yield Variable("steady_torque", self.steady.largest, "steady_speed shaft", "N*m")
            yield Variable("steady_swing", self.steady.swing, "steady_speed shaft", "N*m")
            yield Variable("steady_verdict", self.steady.verdict, "steady_speed")
            yield Attribute("steady_linear", self.steady.linear)
        if self.ending is not None:
            yield from self.ending.declared()
        yield from super().declared()
        yield from ending(self.outcome)

    def plot(self, axes: Axes | None = None, *, shaft: str = "", unit: str = "") -> Axes:
        """Envelope against the steady response; see ``pictures.motion.run_up``."""
        return drawing(self, "plot")(self, axes, shaft=shaft, unit=unit)

    def __str__(self) -> str:
        unit, rows = self.unit, []
        for i, name in enumerate(self.shafts):
            against = self._against(i)
            rows.append(
                f"  {name}: at most {self.peak_torque[i]:.5g} N m, at {rounded_speed(self.peak_speed[i], unit)}; "
                f"{self.inertia_torque[i]:.5g} N m accelerate what is behind it, ± {self.peak_swing[i]:.5g} N m "
                f"vibrate at {rounded_speed(self.speed[int(self.swing[:, i].argmax())], unit)}{against}"
            )
        asked = self.schedule
        made = f"{counted(len(self.speed), 'turn')} in {self.simulation.end:.5g} s"
        head = (
            f"run from {show_speed(asked.first, unit)} to {show_speed(asked.last, unit)} at "
            f"{show_acceleration(asked.acceleration, unit)}, set in over {asked.ramp:.3g} s: {made}"
        )
        if self.simulation.starts_free:
            worst = int(np.argmax(np.abs(self.lag)))
            sense = "slower" if self.lag[worst] >= 0 else "faster"
            rows.append(
                f"  the drives carry the loads and accelerate the inertia; the line turned up to "
                f"{about_speed(abs(self.lag[worst]), unit)} {sense} than asked, at "
                f"{rounded_speed(self.speed[worst], unit)}"
            )
            if self.simulation.beyond_table:
                rows.append(f"  {self.simulation.beyond_table}")
        if self.steady is not None and self.steady.linear:
            rows.append(f"  {self.steady.linear}")
        if self.simulation.line.sliders:
            rows.append("  no steady response beside it: clutches rub, which no branch follows; ask periodic_response")
        if self.ended:
            rows.append(f"  {self.ended}")
        return "\n".join([head, *rows, f"  {self.outcome}"])

    def _against(self, i: int) -> str:
        """When the vibration of a shaft is largest, where that tells, and the steady one beside it."""
        setting_in = self.time[int(self.swing[:, i].argmax())] < self.ramp
        words = " while the acceleration sets in" if setting_in else ""
        if not np.isfinite(self.steady_vibration[i]):
            return words
        share = self.peak_swing[i] / max(self.steady_vibration[i], 1e-300)
        times = "against" if setting_in else f"{share:.3g} times"
        return f"{words}, {times} the largest steady vibration found, ± {self.steady_vibration[i]:.5g} N m"


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

    The run begins on the periodic motion at ``first`` where there is one, otherwise without twist (a line that starts
    free: twisted by its mean torques). A free–free line that lags behind at the end is followed further. Its
    drives hold their last torque until it reaches the last speed or hangs. ``outcome.kind`` is "reached", "captured",
    "short of torque", "stalled" or "undecided". Where the line lagged on the way, a second run at another tolerance
    must end alike.

    Excitations whose amplitude goes with the speed or the load have the one of the mean speed of the moment, and of the
    load that is balanced there, without what accelerates.

    Parameters
    ----------
    line : a ``Driveline`` or its ``Assembly``.
    first, last : input speeds [rad/s], numbers or texts with a unit; a lower ``last`` runs down.
    acceleration : its magnitude [rad/s²].
    ramp : time [s] over which the acceleration sets in; by default three periods of the slowest mode, at most until
        half of the speed range is passed; 0 for at once.
    steady : number of speeds, at least, at which the steady periodic motion is computed for comparison; 0 leaves it
        out.
    tolerance : error allowed per step.
    within : seconds that it may take; the run is given as far as it came by then, and ``ended`` says what is left out.

    Returns
    -------
    RunUp: torque of every shaft [N m] over time and speed, its largest value, and the steady response beside it.

    Raises
    ------
    InputError : speeds or acceleration not positive; a negative ramp, or one too long for the speeds; a line that
        is free–free without a drive_share; speeds that the table of an excitation does not cover, or one that varies
        on a line parts of which may slip; more than 20 000 turns.

    Examples
    --------
    >>> import trunnion as tn
    >>> shaft = tn.Shaft(stiffness=1e3, damping=2.0)
    >>> line = tn.Driveline([tn.ConstantSpeed(), tn.HookeJoint(angle=0.2), shaft, tn.Disk(inertia=0.4)])
    >>> run = tn.run_up(line, 15.0, 35.0, acceleration=20.0, steady=0)
    >>> run.outcome.kind, round(float(max(abs(run.upper).max(), abs(run.lower).max())), 1)
    ('reached', 76.8)
    """
    first, last = one_speed(first, "first"), one_speed(last, "last")
    check(first, last, acceleration)
    if isinstance(steady, bool) or not isinstance(steady, int | np.integer) or steady < 0:
        raise InputError("must be a whole number, 0 for none", element="run_up", key="steady", value=steady)
    refuse_pendulums(line.line if isinstance(line, Assembly) else line)
    prepared = line_system(in_series(line), first)
    require_share(prepared.assembly)
    prepared.refuse_change()
    refuse_uncovered(prepared, prepared.assembly.table(1, first)[0], min(first, last), max(first, last))
    asked = schedule(prepared.assembly, first, last, acceleration, ramp)
    ended = ""
    try:
        with time_kept(*BEGINNING):
            begun, extra = _begin(prepared)
    except OutOfTime as error:
        begun, extra = prepared.twisted() if prepared.assembly.topology.free else prepared.rest(), 0.0
        ended = f"{error.why}: the run does not begin on the periodic motion at the first speed"
    begun = _let_slip(prepared, begun)
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
    own = _FreeInputSpeed(asked, middle, lag) if ending is not None else None
    quasi_static, count = _quasi_static(run.line.assembly, asked, own), len(run.shafts)

    def curves(times: Array) -> Array:
        torque = run.torque_at(times)
        return np.hstack([torque, torque - quasi_static(times)])

    seen, period = extremes_in(curves, run.cuts, edges), _cycle(prepared)
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
        swing=_swing(seen.high[:, count:], seen.low[:, count:], period),
        lag=lag,
        inertia_torque=np.abs(inertia_torque(run.line.assembly)) * asked.acceleration,
        steady=found,
        ending=ending,
        unit=run.unit,
        period=period,
        ended=ended,
    )


def _run(
    prepared: LineSystem, asked: SpeedSchedule, begun: Array, extra: float, tolerance: float
) -> tuple[LineSimulation, RunUpEnding | None]:
    """The run, and how it ends where the line is free–free."""
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
        if not is_periodic(prepared):
            return begun, 0.0
        found = kept_speed_orbit(prepared, settle=False)
        return (found.start, found.values[-1]) if found.outcome.ok else (begun, 0.0)
    begun = prepared.rest()
    if prepared.system.forcing_period is not None and not prepared.assembly.topology.dragged:
        orbit = periodic_orbit(prepared.system, start=begun, settle=False)
        begun = orbit.start if orbit.outcome.ok else begun
    return begun, 0.0


def _let_slip(prepared: LineSystem, state: Array) -> Array:
    """The same state of the line in which slip clutches may slip, both sides of which turn as one."""
    free = line_system(prepared.assembly, prepared.speed, slips=True)
    if free.assembly is prepared.assembly:
        return state
    motion, speed = prepared.moving(np.zeros(1), state[None], prepared.system.numbers)
    firsts, topo, n = free.assembly.topology.firsts, free.assembly.topology, prepared.assembly.topology.size
    rates = speed[0, firsts] - topo.mean_speeds[firsts] * prepared.speed
    return np.concatenate([motion.rotation[0, firsts], rates, state[2 * n :]])


def _cycle(prepared: LineSystem) -> int:
    """Turns in which each excitation by order repeats by itself, as far as runs are looked at in so many together."""
    turning = [abs(one.order) for one in line_harmonics(prepared.assembly) if one.order and one.acts]
    rates = [rate for rate in (*turning, *prepared.assembly.topology.rates) if rate]
    return min(ceil(1 / min(rates)), LONGEST_CYCLE) if rates else 1


def _swing(high: Array, low: Array, turns: int) -> Array:
    """Half of highest less lowest (turn, shaft), over so many ``turns`` about each."""
    about = {"size": turns, "axis": 0, "mode": "nearest"}
    return np.asarray(maximum_filter1d(high, **about) - minimum_filter1d(low, **about)) / 2


@dataclass(frozen=True)
class _FreeInputSpeed:
    """Speed and acceleration of a free–free line: what is asked, less its ``lag`` (turns,) [rad/s] about
    ``time`` (turns,) [s], evened out over some turns so that vibration of the rotation does not count as
    acceleration."""

    asked: SpeedSchedule
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


def _quasi_static(assembly: Assembly, asked: SpeedSchedule, own: _FreeInputSpeed | None) -> Callable[[Array], Array]:
    """Times → torque (times, shaft) [N m] that loads and inertia ask for at their speed and acceleration."""
    ends = [asked.first, asked.last] if own is None else [asked.first, asked.last, *own.at(own.time)[0]]
    speeds = np.linspace(max(min(ends), SLOWEST * asked.first), max(ends), STATIC_SPEEDS)
    table = np.repeat(assembly.table(1), STATIC_SPEEDS, axis=0)
    table[:, 0] = speeds
    static = assembly.coefficients(table, free_play=True).torque
    inertia = inertia_torque(assembly)

    def torque(times: Array) -> Array:
        speed, rate = (asked.profile.at(times), asked.rate(times)) if own is None else own.at(times)
        loads = np.stack([np.interp(speed, speeds, column) for column in static.T], axis=1)
        return loads + rate[:, None] * inertia

    return torque


def _steady(assembly: Assembly, first: float, last: float, points: int) -> SteadyResponse | None:
    """The branch of steady motions over the range, folds and all; what was found of it. The linear response of a smooth
    straight line with excitations that vary, as an engine's, whose branch takes minutes, or on which oil alone drags
    something along, which no branch follows."""
    prepared = line_system(assembly, first)
    if prepared.system.forcing_period is None or (assembly.topology.free and not is_periodic(prepared)):
        return None
    clutched = any(isinstance(one, SlipClutch) for one in assembly.line.elements)
    if prepared.sliders or clutched:  # no branch follows them
        return None
    low, high = min(first, last), max(first, last)
    row = assembly.table(1, low)
    bent = any(law.nonuniform for law in prepared.untwisted(row).joints)
    smooth = not (bent or staged_springs(assembly, row[0]))
    if smooth and (assembly.topology.dragged or any(one.law.varies for one in prepared.torques)):
        return _linear(assembly, sweep_speeds(assembly, low, high, max(points, 2)))
    if assembly.topology.dragged:
        return None
    branch = periodic_branch(assembly, "speed", low, high, longest_step=1 / points, tolerance=1e-10)
    return SteadyResponse(branch.parameter, branch.largest, branch.peak_to_peak / 2, branch.verdict)


def _linear(assembly: Assembly, speeds: Array) -> SteadyResponse:
    """The linear steady response of a line whose equations are linear but for the angle at which torques act."""
    found = order_response(assembly, speeds)
    shift, name = swing_of_torques(assembly, found.spectrum)
    said = "the steady response is linear"
    if name:
        said += f": the swing of {name} can shift up to {figures(100 * shift, 2)} % of its torque to other orders"
    return SteadyResponse(found.speed, found.peak_torque, found.vibratory_torque, found.judged(), said)
