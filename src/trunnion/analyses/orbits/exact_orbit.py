"""Periodic motions of a driveline with stages by shooting with its exact motion.

The motion over a period and its derivatives by start and parameter are known to rounding, saltation at every change of
stage included (``numerics/staged_flow``), so Newton's method closes the orbit to rounding and the multipliers are
those of the motion itself. Where it touches the end of a stage (grazing) there is no derivative; ``clearance`` and
``slowest_crossing`` say how near that is.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike

from trunnion.analyses.motion.exact_motion import StageEvents, first_stages, stage_events, start_state
from trunnion.analyses.orbits.closing import by_modulus, checked_periods, close
from trunnion.analyses.orbits.exact_map import LineMap
from trunnion.analyses.orbits.judging import ExactClosing, exact_verdict
from trunnion.analyses.orbits.spring_contacts import SpringContact
from trunnion.arrays import Array, Complex
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.equations.coefficients import Assembly
from trunnion.equations.staged_line import StagedLine, staged_line
from trunnion.errors import InputError
from trunnion.numerics.continuation.newton import Root
from trunnion.numerics.piecewise_linear.staged_flow import StagedPassage, kernel, move
from trunnion.results.declared import Held, Result, axis, ending, fields_over, over, remark
from trunnion.results.outcome import Outcome
from trunnion.results.speeds import frequency_unit, show_speed
from trunnion.results.verdict import MEANING, Verdict

SETTLED = 100
"""Periods after which a motion shows which sliders stick."""
SINGULAR = 1e-12
"""Smallest singular value over the largest below which the condition of closing determines nothing."""


@dataclass(frozen=True, repr=False)
class ExactOrbit(Result):
    """A periodic motion of a line with stages and what it does in its period.

    value: speed or common frequency of the excitation [rad/s], whichever turns the line's excitation; start (2m,):
    twists [rad], then rates [rad/s], at t = 0; period [s], ``periods`` times that of the excitation; multipliers
    (2m,) by falling modulus and monodromy (2m, 2m), without the rotation of a line that starts free; twist_low,
    twist_high, twist_mean [rad], torque_low, torque_high, torque_mean [N m] (spring,); contacts: sides, impacts and
    their energy, per spring with stages; clearance [rad]: least distance of an extremum of a twist from an end of its
    stage, before it or behind it, inf without one; slowest_crossing [rad/s]: smallest rate at a change of stage, inf
    without one; iterations of the shooting; stuck: sliders that never slip, whose multipliers, exactly 1, are set
    aside.
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
    stuck: tuple[str, ...] = ()

    @property
    def springs(self) -> tuple[str, ...]:
        """Names of the springs."""
        return self.line.springs

    @property
    def torque_peak_to_peak(self) -> Array:
        """Highest minus lowest torque (spring,) [N m]."""
        return self.torque_high - self.torque_low

    @property
    def verdict(self) -> Verdict:
        """Stable, unstable, or not told apart."""
        return exact_verdict(self.multipliers)

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
        yield from fields_over("spring", self, twist_low="rad", twist_high="rad", twist_mean="rad")
        yield from fields_over("spring", self, torque_low="N*m", torque_high="N*m", torque_mean="N*m")
        yield from fields_over("spring", self, torque_peak_to_peak="N*m")
        yield over("event", "event_time", self.events.time, "s")
        yield over("event", "event_spring", np.array([self.line.rows[i] for i in self.events.spring], dtype=str))
        yield over("multiplier_number", "multiplier", self.multipliers, "1")
        yield from fields_over("", self, period="s", clearance="rad", slowest_crossing="rad/s")
        yield remark("driveline", self.line.name)
        yield remark("verdict", str(self.verdict))
        yield remark("value", self.value)
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
                *(f"  {name} sticks throughout; its multiplier, exactly 1, is set aside" for name in self.stuck),
                f"  {near}{slow}; largest multiplier {abs(self.multipliers[0]):.8g}; {self.outcome}",
            ]
        )


def exact_orbit(
    line: Driveline | Assembly,
    start: ArrayLike | None = None,
    *,
    speed: float | None = None,
    periods: int = 1,
    settle: bool = True,
) -> ExactOrbit:
    """See ``piecewise_orbit``."""
    prepared = staged_line(line, speed)
    refuse_found_speed(prepared)
    return orbit_near(prepared, start_state(prepared, start), prepared.value, checked_periods(periods), settle)


def refuse_found_speed(line: StagedLine) -> None:
    """Refuse a line whose excitation turns with a speed that its own loads lead to.

    Raises
    ------
    InputError : so.
    """
    if line.turns and line.clock in ("speed", "both"):
        raise InputError(
            "starts free under viscous loads, so the speed that its excitation turns with is a result, not given",
            element="driveline", key="viscous_load",
            remedy="put a ConstantSpeed in front, or use tn.periodic_response, which finds the speed",
        )  # fmt: skip


def orbit_near(line: StagedLine, start: Array, value: float, periods: int, settle: bool = True) -> ExactOrbit:
    """The periodic motion near ``start`` (2m,) at a value of the clock."""
    if not line.sliders:
        return _orbit(LineMap(value, periods, line), start, settle)
    # Which sliders stick is told by the motion once it has settled, and again by the orbit found.
    place, orbit = LineMap(value, periods, line), None
    settled = place.settle(start[place.kept], SETTLED) if settle else start[place.kept]
    if settled is None:
        return _missing(place, start, Outcome(False, "chatter", "stages change too often in a period; raise damping"))
    whole = place.whole(settled)
    passage = place.watched(settled)
    for _ in range(2 * len(line.sliders) + 1):
        tried, place = place, replace(place, stuck=place.idle(passage, whole))
        orbit = _orbit(place, whole, settle)
        if not orbit.outcome.ok:
            break
        passage, whole = place.watched(orbit.start[place.kept]), orbit.start
        if place.idle(passage, whole) == place.stuck or place.stuck == tried.stuck:
            break
    assert orbit is not None
    return orbit


def _orbit(over_period: LineMap, start: Array, settle: bool) -> ExactOrbit:
    def closing(guess: Array) -> ExactClosing:
        return ExactClosing(over_period, over_period.scale(over_period.whole(guess)))

    found, root = close(start[over_period.kept], closing, settle=settle)
    if root.converged and not _determined(root, found.scale):
        words = (
            "no one motion closes: some disturbance returns unchanged, as where an undamped line is driven at its "
            "own frequency; give some damping or another frequency"
        )
        return _missing(over_period, start, Outcome(False, "not determined", words))
    if root.converged:
        return orbit_at(over_period, root.x, root.iterations)
    words = (
        f"shooting did not converge (residual {root.size:.1e}); start closer, for example from the "
        "final state of a longer tn.exact_motion, or give more periods if the motion is a subharmonic"
    )
    return _missing(over_period, start, Outcome(False, "not converged", words))


def _determined(root: Root, scale: Array) -> bool:
    """Whether the closing condition fixes the motion: its derivative is not singular."""
    sizes = np.linalg.svd(root.derivative * scale[None, :] / scale[:, None], compute_uv=False)
    return bool(sizes[-1] > SINGULAR * max(sizes[0], 1.0))


def orbit_at(place: LineMap, part: Array, iterations: int = 0) -> ExactOrbit:
    """The orbit through a state of the map known to lie on it."""
    line, start, length = place.line, place.whole(part), place.length
    passage, k, count = place(part, watch=True), kernel(), len(place.line.springs)
    run = passage.run
    closes = float(np.max(np.abs(passage.state - part) / place.scale(start)))
    seen, rates = run.seen[:count], run.events[run.events[:, 1] < count, 4]
    return ExactOrbit(
        line=line,
        value=place.value,
        start=start,
        period=length,
        periods=place.periods,
        multipliers=by_modulus(passage.tangents),
        monodromy=passage.tangents,
        events=stage_events(line, run),
        twist_low=seen[:, k.LOW],
        twist_high=seen[:, k.HIGH],
        twist_mean=seen[:, k.TWIST_SUM] / length,
        torque_low=seen[:, k.TORQUE_LOW],
        torque_high=seen[:, k.TORQUE_HIGH],
        torque_mean=seen[:, k.TORQUE_SUM] / length,
        contacts=contacts_of(place, start, run),
        clearance=float(seen[:, k.CLEARANCE].min()),
        slowest_crossing=float(np.abs(rates).min()) if len(rates) else float("inf"),
        iterations=iterations,
        outcome=Outcome(True, "found", f"closes to {closes:.1e} after {iterations} iterations"),
        stuck=tuple(line.rows[row] for row, _ in place.stuck),
    )


def contacts_of(place: LineMap, start: Array, run: StagedPassage) -> tuple[SpringContact, ...]:
    """What every spring with stages touches in a watched passage from ``start`` (2m,), and how hard it lands.

    An impact is a passage from the softest stage to another, its energy ½ m q̇² with the inertia m that the rest of the
    line opposes to a push between the ends of the spring.
    """
    line, found = place.line, []
    first, events = first_stages(line, start), stage_events(line, run)
    for e in line.staged:
        own = events.spring == e
        sides = np.concatenate([[line.sides[e, first[e]]], events.side[own]])
        landed = (sides[1:] != 0) & (sides[:-1] == 0)
        speeds = np.abs(events.rate[own][landed])
        shares = run.seen[e, kernel().SHARES :][: line.counts[e]] / place.length
        stages = line.sides[e, : line.counts[e]]
        found.append(SpringContact.of(line.springs[e], shares, stages, speeds, 1 / line.inverse[e, e]))
    return tuple(found)


def _missing(place: LineMap, start: Array, outcome: Outcome) -> ExactOrbit:
    nan, n, count = float("nan"), place.size, len(place.line.springs)
    none, whole = np.full(count, nan), np.zeros(0, dtype=np.int64)
    return ExactOrbit(
        place.line, place.value, start, place.length, place.periods, np.full(n, nan, dtype=complex),
        np.full((n, n), nan), StageEvents(np.zeros(0), whole, whole, whole, np.zeros(0)), none, none, none, none, none,
        none, (), nan, nan, 0, outcome,
    )  # fmt: skip
