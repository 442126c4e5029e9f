"""``run_up``: passage through resonance at constant acceleration, against the steady response.

A line that passes a resonance quickly never reaches its steady amplitude; one that passes slowly does, and one
that is accelerated briskly is twisted by its own inertia. The torque is therefore told apart: what the loads and the
inertia behind a shaft ask for at each speed and acceleration (quasi-static), and what vibrates about that.

The acceleration sets in smoothly, as ½A(1 − cos πt/T) over a ramp of T seconds: set in at once it would twist the line
by twice its inertia torque and leave the slowest mode ringing. Over three of its periods that ringing is at most 1/35
of the inertia torque, cos(ωT/2)/((ωT/π)² − 1) without damping.

The acceleration is that of the drive. Where a line starts free, nothing turns at a prescribed speed: its disks with a
drive_share carry the torque that balances the loads at each speed and accelerates the whole inertia, were it rigid and
its joints straight. What dampers, bent joints and vibration take beyond that makes it lag, and a
resonance that takes more than what accelerates holds it back (Sommerfeld's effect), see ``RunUp.lag``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from trunnion.analyses.linear.natural_frequencies import natural_frequencies
from trunnion.analyses.motion.order_map import times_at_angles
from trunnion.analyses.motion.simulate import LineSimulation, simulate_line
from trunnion.analyses.orbits.free_orbit import closes, kept_speed_orbit
from trunnion.analyses.orbits.periodic_branch import periodic_branch
from trunnion.analyses.orbits.periodic_orbit import periodic_orbit
from trunnion.arrays import Array, Codes
from trunnion.driveline.arguments import one_number
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.equations.coefficients import Assembly
from trunnion.equations.line_system import LineSystem, line_system
from trunnion.equations.loads import drive_torques, given_shares, static_torque
from trunnion.equations.speed_profile import SpeedProfile
from trunnion.equations.steady_base import require_share
from trunnion.errors import InputError
from trunnion.numerics.curves import extremes_in
from trunnion.results.declared import Held, Result, axis, ending, fields_over, over, remarks
from trunnion.results.drawing import Axes, drawing
from trunnion.results.outcome import Outcome
from trunnion.results.speeds import show_speed

STEADY_SPEEDS = 81
RAMP_PERIODS = 3.0
"""Of the slowest mode, over which the acceleration sets in."""
RAMP_PIECES = 48
"""Straight pieces of the speed over the ramp; each changes the acceleration by 1/15 of its end value at most."""
STATIC_SPEEDS = 65
"""Speeds at which the static torque is computed; between them it is interpolated."""
MOST_TURNS = 20_000
"""Turns of one run, about a minute of computing."""


@dataclass(frozen=True)
class SteadyResponse:
    """Steady torque over speed: speed (points,) [rad/s]; largest (points, shaft), the largest |torque| [N m] of the
    periodic motion; swing (points, shaft): half of its peak-to-peak; verdict (points,) codes. In order along the
    branch, which may fold back."""

    speed: Array
    largest: Array
    swing: Array
    verdict: Codes


@dataclass(frozen=True, repr=False)
class RunUp(Result):
    """A passage at constant acceleration.

    speed (turns,) [rad/s] asked for in the middle of each turn, or of the little more that leaves none over, less the
    ``lag``; upper and lower
    (turns, shaft): the largest and smallest torque [N m] within it, found on the dense output; vibration (turns,
    shaft): the largest distance of the torque from the quasi-static one, which loads and inertia ask for; ramp [s]:
    over which the acceleration sets in; lag (turns,) [rad/s]: by how much the input turned slower on average than
    asked, which only a line that starts free can; steady: the steady response in the same range (None if not asked
    for).
    """

    simulation: LineSimulation
    acceleration: float
    ramp: float
    speed: Array
    upper: Array
    lower: Array
    vibration: Array
    lag: Array
    steady: SteadyResponse | None

    @property
    def unit(self) -> str:
        """Unit that speeds are printed in: that of the line's description."""
        return speed_unit(self.simulation.line.assembly.line)

    @property
    def outcome(self) -> Outcome:
        """How the run ended."""
        return self.simulation.outcome

    @property
    def shafts(self) -> tuple[str, ...]:
        """Names of the shafts."""
        return self.simulation.shafts

    @property
    def largest(self) -> Array:
        """Largest |torque| in each turn (turns, shaft) [N m]."""
        return np.maximum(np.abs(self.upper), np.abs(self.lower))

    @property
    def peak_torque(self) -> Array:
        """Largest |torque| of every shaft over the whole passage [N m]."""
        return np.asarray(self.largest.max(axis=0))

    @property
    def peak_speed(self) -> Array:
        """Input speed [rad/s] at which each shaft has it."""
        return self.speed[self.largest.argmax(axis=0)]

    @cached_property
    def steady_peak(self) -> Array:
        """Largest |torque| of every shaft among the steady motions found [N m]; NaN without them."""
        if self.steady is None or not np.isfinite(self.steady.largest).any():
            return np.full(len(self.shafts), np.nan)
        return np.asarray(np.nanmax(self.steady.largest, axis=0))

    @property
    def peak_vibration(self) -> Array:
        """Largest distance of every shaft's torque (shaft,) [N m] from the quasi-static one."""
        return np.asarray(self.vibration.max(axis=0))

    @property
    def vibration_speed(self) -> Array:
        """Input speed [rad/s] at which each shaft has it."""
        return self.speed[self.vibration.argmax(axis=0)]

    @cached_property
    def steady_vibration(self) -> Array:
        """Half of the largest peak-to-peak torque of every shaft among the steady motions found [N m]; NaN without."""
        if self.steady is None or not np.isfinite(self.steady.swing).any():
            return np.full(len(self.shafts), np.nan)
        return np.asarray(np.nanmax(self.steady.swing, axis=0))

    @cached_property
    def inertia_torque(self) -> Array:
        """What accelerates the inertia behind each shaft (shaft,) [N m] at the full acceleration, were it rigid and its
        joints straight."""
        return np.abs(_inertia_torque(self.simulation.line.assembly)) * self.acceleration

    def declared(self) -> Iterator[Held]:
        """Extremes and vibration of every torque turn by turn and in all, and the steady response."""
        yield axis("shaft", self.shafts)
        yield over("turn shaft", "torque_upper", self.upper, "N*m")
        yield over("turn shaft", "torque_lower", self.lower, "N*m")
        yield over("turn", "speed", self.speed, "rad/s")
        yield from fields_over("shaft", self, peak_torque="N*m", peak_speed="rad/s", inertia_torque="N*m")
        yield over("turn shaft", "vibration", self.vibration, "N*m")
        yield from fields_over("shaft", self, peak_vibration="N*m", vibration_speed="rad/s")
        yield over("turn", "lag", self.lag, "rad/s")
        if self.steady is not None:
            yield axis("steady_speed", self.steady.speed, "rad/s")
            yield over("steady_speed shaft", "steady_torque", self.steady.largest, "N*m")
            yield over("steady_speed shaft", "steady_swing", self.steady.swing, "N*m")
            yield over("steady_speed", "steady_verdict", self.steady.verdict)
        yield from remarks(acceleration=self.acceleration, ramp=self.ramp)
        yield from ending(self.outcome)

    def plot(self, axes: Axes | None = None, *, shaft: str = "", unit: str = "") -> Axes:
        """Envelope against the steady response; see ``trunnion.plots.run_up``."""
        return drawing(self, "plot")(self, axes, shaft=shaft, unit=unit)

    def describe(self, unit: str | None = None) -> str:
        """The result in a few lines, speeds in ``unit``, by default that of the line's description."""
        unit = unit or self.unit
        low, high = self.simulation.profile.speed[0], self.simulation.profile.speed[-1]
        rows = []
        for i, name in enumerate(self.shafts):
            against = self._against(i)
            rows.append(
                f"  {name}: at most {self.peak_torque[i]:.5g} N m, at {show_speed(self.peak_speed[i], unit)}; "
                f"{self.inertia_torque[i]:.5g} N m accelerate what is behind it, ± {self.peak_vibration[i]:.5g} N m "
                f"vibrate at {show_speed(self.vibration_speed[i], unit)}{against}"
            )
        head = (
            f"run from {show_speed(low, unit)} to {show_speed(high, unit)} at "
            f"{show_speed(self.acceleration, unit)}/s, set in over {self.ramp:.3g} s: {len(self.speed)} turns in "
            f"{self.simulation.end:.5g} s"
        )
        if self.simulation.line.assembly.topology.free:
            worst = int(np.argmax(np.abs(self.lag)))
            sense = "slower" if self.lag[worst] >= 0 else "faster"
            rows.append(
                f"  the drives carry the loads and accelerate the inertia; the input turned up to "
                f"{show_speed(abs(self.lag[worst]), unit)} {sense} than asked, at {show_speed(self.speed[worst], unit)}"
            )
        if self.simulation.line.sliders:
            rows.append("  no steady response beside it: clutches rub, which no branch follows; ask periodic_response")
        return "\n".join([head, *rows, f"  {self.outcome}"])

    def _against(self, i: int) -> str:
        """When the vibration of a shaft is largest, where that tells, and the steady one beside it."""
        profile = self.simulation.profile
        gained, passed = profile.at(self.ramp) - profile.speed[0], self.vibration_speed[i] - profile.speed[0]
        setting_in = abs(passed) < abs(gained)
        words = " while the acceleration sets in" if setting_in else ""
        if not np.isfinite(self.steady_vibration[i]):
            return words
        share = self.peak_vibration[i] / max(self.steady_vibration[i], 1e-300)
        times = "against" if setting_in else f"{share:.3g} times"
        return f"{words}, {times} the largest steady vibration found, ± {self.steady_vibration[i]:.5g} N m"

    def __str__(self) -> str:
        return self.describe()


def run_up(
    line: Driveline | Assembly,
    first: float,
    last: float,
    *,
    acceleration: float,
    ramp: float | None = None,
    steady: int = STEADY_SPEEDS,
    tolerance: float = 1e-9,
) -> RunUp:
    """Run a line from speed ``first`` to ``last`` at an acceleration that sets in smoothly and then stays.

    Parameters
    ----------
    first, last : input speeds [rad/s]; a lower ``last`` runs down.
    acceleration : its magnitude [rad/s²].
    ramp : time [s] over which the acceleration sets in; by default three periods of the slowest mode, at most until
        half of the speed range is passed; 0 for at once.
    steady : number of speeds, at least, at which the steady periodic motion is computed for comparison; 0 leaves
        it out.

    The run begins on the periodic motion at ``first`` where there is one, otherwise without twist (a line that starts
    free: twisted by its mean torques).

    Raises
    ------
    InputError : speeds or acceleration not positive; a negative ramp, or one too long for the speeds; a line that
        starts free without a drive_share; more than 20 000 turns.
    """
    _check(first, last, acceleration)
    if isinstance(steady, bool) or not isinstance(steady, int | np.integer) or steady < 0:
        raise InputError("must be a whole number, 0 for none", element="run_up", key="steady", value=steady)
    prepared = line_system(line, first)
    require_share(prepared.assembly)
    length = _ramp(prepared.assembly, first, last, acceleration, ramp)
    profile = _profile(first, last, acceleration, length)
    begun, extra = _begin(prepared)
    run = simulate_line(
        prepared.assembly, profile.time[-1], speed=profile, start=begun, tolerance=tolerance, drive=extra
    )
    # Windows of equal angle, a turn or a little more, so that none is left over.
    angle = float(profile.angle(run.end))
    windows = max(int(angle / (2 * np.pi)), 1)
    edges = np.append(times_at_angles(run, angle * np.arange(windows) / windows), run.end)
    quasi_static, count = _quasi_static(prepared.assembly, profile, length, first, last), len(run.shafts)

    def curves(times: Array) -> Array:
        torque = run.torque_at(times)
        return np.hstack([torque, torque - quasi_static(times)])

    seen = extremes_in(curves, run.cuts, edges)
    lag = -np.diff(run.motion_at(edges).rotation[:, 0]) / np.diff(edges)
    return RunUp(
        simulation=run,
        acceleration=float(acceleration),
        ramp=length,
        speed=profile.at(times_at_angles(run, angle * (np.arange(windows) + 0.5) / windows)) - lag,
        upper=seen.high[:, :count],
        lower=seen.low[:, :count],
        vibration=seen.largest[:, count:],
        lag=lag,
        steady=_steady(prepared.assembly, first, last, steady) if steady else None,
    )


def _begin(prepared: LineSystem) -> tuple[Array, float]:
    """The state to begin with, and what a free line's drives give there [N m at the input] beyond the balance."""
    if prepared.assembly.topology.free:
        begun = prepared.twisted()
        if not closes(prepared):
            return begun, 0.0
        found = kept_speed_orbit(prepared, settle=False)
        return (found.orbit.start, found.extra_torque) if found.orbit.outcome.ok else (begun, 0.0)
    begun = prepared.rest()
    if prepared.system.forcing_period is not None:
        orbit = periodic_orbit(prepared.system, start=begun, settle=False)
        begun = orbit.start if orbit.outcome.ok else begun
    return begun, 0.0


def _check(first: float, last: float, acceleration: float) -> None:
    for key, value in (("first", first), ("last", last), ("acceleration", acceleration)):
        if not 0 < one_number(value, key, "tn.rpm(500), say") < np.inf:
            raise InputError(
                "must be positive", element="run_up", key=key, value=float(value), remedy="tn.rpm(500), say"
            )
    if first == last:
        raise InputError("is also the last speed", element="run_up", key="first", value=float(first))
    duration = abs(last - first) / acceleration
    if (first + last) / 2 * duration > 2 * np.pi * MOST_TURNS:
        raise InputError(
            f"makes a run of more than {MOST_TURNS} turns",
            element="run_up", key="acceleration", value=float(acceleration),
            remedy="accelerate faster, or ask periodic_response for the steady motion",
        )  # fmt: skip


def _ramp(assembly: Assembly, first: float, last: float, acceleration: float, asked: float | None) -> float:
    """Seconds over which the acceleration sets in."""
    longest = abs(last - first) / acceleration
    if asked is None:
        slow = [w for w in natural_frequencies(assembly).frequency if w > 0]
        return min(RAMP_PERIODS * 2 * np.pi / float(min(slow)), longest) if slow else 0.0
    if not 0 <= one_number(asked, "ramp", "2.0 seconds, say") < 2 * longest:
        raise InputError(
            "does not fit in the run", element="run_up", key="ramp", value=float(asked),
            remedy=f"give 0 to {2 * longest:.4g} s, or leave it out",
        )  # fmt: skip
    return float(asked)


def _profile(first: float, last: float, acceleration: float, ramp: float) -> SpeedProfile:
    """Speed whose slope rises as ½A(1 − cos πt/T) over the ramp T, in straight pieces, and then stays A."""
    sense, duration = float(np.sign(last - first)), abs(last - first) / acceleration + ramp / 2
    t = ramp * np.arange(RAMP_PIECES + 1) / RAMP_PIECES if ramp > 0 else np.zeros(1)
    gained = acceleration * (t / 2 - ramp / (2 * np.pi) * np.sin(np.pi * t / ramp)) if ramp > 0 else np.zeros(1)
    return SpeedProfile([*t, duration], [*(first + sense * gained), last])


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


def _quasi_static(
    assembly: Assembly, profile: SpeedProfile, ramp: float, first: float, last: float
) -> Callable[[Array], Array]:
    """Times → torque (times, shaft) [N m] that loads and inertia ask for at their speed and acceleration."""
    speeds = np.linspace(min(first, last), max(first, last), STATIC_SPEEDS)
    table = np.repeat(assembly.table(1), STATIC_SPEEDS, axis=0)
    table[:, 0] = speeds
    static = assembly.coefficients(table, free_play=True).torque
    inertia = _inertia_torque(assembly) * (profile.speed[-1] - profile.speed[-2])
    inertia = inertia / (profile.time[-1] - profile.time[-2])

    def torque(times: Array) -> Array:
        at = profile.at(times)
        rise = np.where(times < ramp, (1 - np.cos(np.pi * times / ramp)) / 2, 1.0) if ramp > 0 else np.ones(len(times))
        held = np.stack([np.interp(at, speeds, column) for column in static.T], axis=1)
        return held + rise[:, None] * inertia

    return torque


def _steady(assembly: Assembly, first: float, last: float, points: int) -> SteadyResponse | None:
    """The branch of steady motions over the range, folds and all; what was found of it."""
    prepared = line_system(assembly, first)
    if prepared.system.forcing_period is None or (assembly.topology.free and not closes(prepared)):
        return None
    if prepared.sliders:  # no branch follows them
        return None
    branch = periodic_branch(
        assembly, "speed", min(first, last), max(first, last), longest_step=1 / points, tolerance=1e-10
    )
    return SteadyResponse(branch.parameter, branch.largest, branch.peak_to_peak / 2, branch.verdict)
