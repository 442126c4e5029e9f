"""Periodic motions that are exact in pieces, as results: of one mass, and of a driveline with stages."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.driveline.operating_speed import speed_unit
from trunnion.equations.staged_line import StagedLine
from trunnion.motion.orbits.spring_contacts import SpringContact, contact_state
from trunnion.motion.orbits.stuck_clutches import StuckClutch
from trunnion.motion.simulation.exact_motion import StageEvents
from trunnion.numerics.curves import fourier
from trunnion.numerics.piecewise_linear.piecewise import states
from trunnion.numerics.piecewise_linear.staged_flow import move
from trunnion.results.declared import Held, Result, axis, ending, fields_over, over, remarks
from trunnion.results.outcome import Outcome
from trunnion.results.speeds import frequency_unit, show_speed
from trunnion.results.verdict import MEANING, Verdict
from trunnion.steady.shooting.judging import exact_verdict
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator

NUMBERS = ("lowest", "highest", "mean", "peak_to_peak", "impacts", "impact_energy", "impact_impulse", "clearance")


class ExactMotion:
    """What has multipliers known to rounding."""

    multipliers: Complex

    @property
    def verdict(self) -> Verdict:
        """Stable, unstable, or not told apart."""
        return exact_verdict(self.multipliers)


@dataclass(frozen=True, repr=False)
class PiecewiseOrbit(ExactMotion, Result):
    """A periodic motion and what it does in a forcing period.

    start (2,): x and x′ at phase zero; periods: forcing periods until it closes; multipliers (2,) by falling modulus;
    crossings (count, 4): time, x, x′ and regime begun; lowest, highest, mean of x; sides touched; impacts: entries
    into contact, per forcing period, with Σ m v²/2 (impact_energy) and Σ m |v| (impact_impulse) of them; clearance:
    least distance of an extremum from a breakpoint; iterations of the shooting.
    """

    oscillator: PiecewiseOscillator
    start: Array
    periods: int
    multipliers: Complex
    monodromy: Array
    crossings: Array
    lowest: float
    highest: float
    mean: float
    sides: str
    impacts: float
    impact_energy: float
    impact_impulse: float
    clearance: float
    iterations: int
    outcome: Outcome

    @property
    def peak_to_peak(self) -> float:
        """Highest minus lowest x."""
        return self.highest - self.lowest

    @property
    def contact(self) -> str:
        """none, one-sided or two-sided."""
        return contact_state(self.sides)

    def motion(self, count: int = 512) -> tuple[Array, Array]:
        """Times (count,) over the orbit's period, its end left out, and states (count, 2)."""
        o = self.oscillator
        times = self.periods * o.period * np.arange(count) / count
        return times, states(o.regimes, o.coefficients, o.frequency, self.start, times)

    def harmonics(self, highest: int) -> Complex:
        """Fourier coefficients (highest + 1,) of x: x = Re Σ c_k e^{2πikt/T}, integrated between its crossings."""
        o = self.oscillator

        def x(times: Array) -> Array:
            found = states(o.regimes, o.coefficients, o.frequency, self.start, np.concatenate([[0.0], times]))
            return found[1:, :1]

        cuts = np.unique(np.concatenate([[0.0], self.crossings[:, 0], [self.periods * o.period]]))
        return fourier(x, cuts, highest)[:, 0]

    def declared(self) -> Iterator[Held]:
        """The motion over its period, its crossings and multipliers, and the numbers read off it."""
        times, motion = self.motion() if self.outcome.ok else (np.zeros(0), np.zeros((0, 2)))
        yield axis("time", times, "s")
        yield over("time", "x", motion[:, 0])
        yield over("time", "v", motion[:, 1])
        yield over("crossing", "crossing_time", self.crossings[:, 0], "s")
        yield over("multiplier_number", "multiplier", self.multipliers, "1")
        yield from fields_over("", self, **dict.fromkeys(NUMBERS, ""))
        yield from remarks(
            oscillator=self.oscillator.name, verdict=str(self.verdict), contact=self.contact, periods=self.periods
        )
        yield from ending(self.outcome)

    def __str__(self) -> str:
        if not self.outcome.ok:
            return f"no periodic motion of {self.oscillator.name}: {self.outcome}"
        at = show_speed(self.oscillator.frequency, frequency_unit(self.oscillator.speed_unit))
        return (
            f"{self.verdict} periodic motion of {self.oscillator.name} at ω = {at} "
            f"over {self.periods} forcing period{'s' if self.periods > 1 else ''}: {MEANING[self.verdict]}\n"
            f"  x = {self.mean:.6g} with {self.peak_to_peak:.6g} peak to peak; contact {self.contact}, "
            f"{self.impacts:g} impacts per period; {self.clearance:.2g} from grazing\n"
            f"  multipliers {self.multipliers[0]:.8g}, {self.multipliers[1]:.8g}; {self.outcome}"
        )


@dataclass(frozen=True, repr=False)
class ExactOrbit(ExactMotion, Result):
    """A periodic motion of a line with stages and what it does in its period.

    value: speed or common frequency of the excitation [rad/s], whichever turns the line's excitation; start (2m,):
    twists [rad], then rates [rad/s], at t = 0; period [s], ``periods`` times that of the excitation; multipliers
    (2m,) by falling modulus and monodromy (2m, 2m), without the rotation of a line that starts free; twist_low,
    twist_high, twist_mean [rad], torque_low, torque_high, torque_mean [N m] (spring,); contacts: sides, impacts and
    their energy, per spring with stages; clearance [rad]: least distance of an extremum of a twist from an end of its
    stage, before it or behind it, inf without one; slowest_crossing [rad/s]: smallest rate at a change of stage, inf
    without one; iterations of the shooting; continuum: the clutches with sliders that never slip, which make
    this motion one of a continuum; the multipliers of those sliders, exactly 1, are set aside.
    """

    line: StagedLine
    value: float
    start: Array
    period: float
    periods: int
    multipliers: Complex
    monodromy: Array = field(repr=False)
    events: StageEvents = field(repr=False)
    twist_low: Array
    twist_high: Array
    twist_mean: Array
    torque_low: Array
    torque_high: Array
    torque_mean: Array
    contacts: tuple[SpringContact, ...]
    clearance: float
    slowest_crossing: float
    iterations: int
    outcome: Outcome
    continuum: tuple[StuckClutch, ...] = ()

    @property
    def springs(self) -> tuple[str, ...]:
        """Names of the springs."""
        return self.line.springs

    @property
    def stuck(self) -> tuple[str, ...]:
        """Names of the sliders that never slip."""
        return tuple(name for clutch in self.continuum for name in clutch.sliders)

    @property
    def torque_peak_to_peak(self) -> Array:
        """Highest minus lowest torque (spring,) [N m]."""
        return self.torque_high - self.torque_low

    def motion(self, count: int = 512) -> tuple[Array, Array, Array]:
        """Times (count,) over the period, its end left out, states (count, 2m) and torques (count, spring)."""
        times, flow = self.period * np.arange(count) / count, self.line.flow(self.value)
        run = move(flow, self.start, 0.0, self.period, times=times)
        return times, run.states, flow.torque(run.states, run.shown_stages)[:, : len(self.springs)]

    def declared(self) -> Iterator[Held]:
        """Twist and torque over the period, extremes and means of every spring, changes of stage and multipliers."""
        count = len(self.springs)
        times, states, torque = np.zeros(0), np.zeros((0, count)), np.zeros((0, count))
        if self.outcome.ok:
            times, states, torque = self.motion()
        yield axis("time", times, "s")
        yield axis("spring", self.springs)
        yield over("time spring", "twist", states[:, :count], "rad")
        yield over("time spring", "torque", torque, "N*m")
        yield from fields_over(
            "spring", self, twist_low="rad", twist_high="rad", twist_mean="rad", torque_low="N*m", torque_high="N*m",
            torque_mean="N*m", torque_peak_to_peak="N*m",
        )  # fmt: skip
        yield over("event", "event_time", self.events.time, "s")
        yield over("event", "event_spring", np.array([self.line.rows[i] for i in self.events.spring], dtype=str))
        yield over("multiplier_number", "multiplier", self.multipliers, "1")
        yield from fields_over("", self, period="s", clearance="rad", slowest_crossing="rad/s")
        yield from remarks(driveline=self.line.name, verdict=str(self.verdict), value=self.value)
        yield from remarks(continuum="; ".join(map(str, self.continuum)))
        yield from ending(self.outcome)

    def __str__(self) -> str:
        unit = speed_unit(self.line.assembly.line)
        by_speed, frequencies = self.line.clock == "speed", frequency_unit(unit)
        at = f"Ω = {show_speed(self.value, unit)}" if by_speed else f"ω = {show_speed(self.value, frequencies)}"
        if not self.outcome.ok:
            return f"no periodic motion of {self.line.name} at {at}: {self.outcome}"
        rows = [
            f"  {name}: torque {mean:.6g} N m, {swing:.6g} N m peak to peak"
            for name, mean, swing in zip(self.springs, self.torque_mean, self.torque_peak_to_peak, strict=True)
        ]
        near = f"{self.clearance:.2g} rad from grazing" if np.isfinite(self.clearance) else "no stage end is approached"
        slowest = show_speed(float(f"{self.slowest_crossing:.2g}"), unit)
        slow = f", slowest crossing {slowest}" if np.isfinite(self.slowest_crossing) else ""
        return "\n".join(
            [
                f"{self.verdict} periodic motion of {self.line.name} at {at}, period {self.period:.6g} s: "
                f"{MEANING[self.verdict]}",
                *rows,
                *(f"  {contact}" for contact in self.contacts),
                *(f"  {clutch}" for clutch in self.continuum),
                f"  {near}{slow}; largest multiplier {abs(self.multipliers[0]):.8g}; {self.outcome}",
            ]
        )
