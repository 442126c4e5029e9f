"""Periodic motions of one mass on a piecewise linear spring, or of a driveline, by shooting with the exact motion.

The motion over one or several periods and its derivatives by start and parameter are known to rounding, saltation at
every change of stage included (``numerics/piecewise_linear``), so Newton's method closes the orbit to rounding and the
multipliers are those of the motion itself. An orbit that touches a breakpoint or the end of a stage (grazing) has no
derivative there; ``clearance`` and, of a line, ``slowest_crossing`` say how near that is.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any, Generic, TypeVar, overload

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Complex
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.equations.clutch_capacity import refuse_overload
from trunnion.equations.coefficients import Assembly
from trunnion.equations.staged_line import StagedLine, refuse_lost_speed, staged_line
from trunnion.errors import InputError
from trunnion.motion.orbits.clutches import StuckClutch, Watched, continuum, slipping_on
from trunnion.motion.orbits.exact_map import LineMap, OscillatorMap
from trunnion.motion.orbits.spring_contacts import SpringContact, contact_state
from trunnion.motion.simulation.exact_motion import StageEvents, stage_events, start_state
from trunnion.numerics.continuation.newton import Root
from trunnion.numerics.curves import fourier
from trunnion.numerics.piecewise_linear import piecewise, staged_flow
from trunnion.numerics.piecewise_linear.staged_flow import kernel
from trunnion.results.fields import attribute, computed, coordinate, internal, labelled, variable
from trunnion.results.of_systems import ending
from trunnion.results.outcome import Outcome
from trunnion.results.result import Result
from trunnion.results.speeds import frequency_unit, show_speed
from trunnion.results.units import mean_and_swing
from trunnion.results.variables import Attribute, Coordinate, Variable
from trunnion.results.verdict import MEANING
from trunnion.steady.shooting.periodic_orbit import Orbit
from trunnion.steady.shooting.shooting_problem import (
    ShootingProblem,
    beside_sticking,
    by_modulus,
    close,
    exact_verdict,
    holding,
    refuse_speed,
    sticking,
)
from trunnion.systems.maps import checked_periods
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator

Number = TypeVar("Number", float, Array)
NUMBERS = ("lowest", "highest", "mean", "peak_to_peak", "impacts", "impact_energy", "impact_impulse")
SETTLED = 100
"""Periods after which a motion shows which sliders stick."""
UNDETERMINED = "not determined"
"""Kind of the outcome where motions close, but no single one."""
SINGULAR = 1e-12
"""Smallest singular value over the largest below which the condition of closing determines nothing."""


@labelled
class Displacement(Generic[Number]):
    """What the x of an oscillator does in a forcing period; numbers, or arrays (points,) of several motions."""

    lowest: Number = internal("x")
    highest: Number = internal("x")
    mean: Number = internal("of x")
    impacts: Number = internal("entries into contact")
    impact_energy: Number = internal("Σ m v²/2 of them")
    impact_impulse: Number = internal("Σ m |v| of them")

    @property
    def peak_to_peak(self) -> Number:
        """Highest minus lowest x."""
        return self.highest - self.lowest


@labelled
class TorqueRange:
    """Torques of the springs of a line in one motion (spring,) or several (points, spring)."""

    torque_low: Array = internal("lowest", "N*m", "… spring")
    torque_high: Array = internal("highest", "N*m", "… spring")

    @property
    def torque_peak_to_peak(self) -> Array:
        """Highest minus lowest torque (…, spring) [N m]."""
        return self.torque_high - self.torque_low


@labelled
class PiecewiseOrbit(Result, Displacement[float], Orbit):
    """A periodic motion of an oscillator and what it does in a forcing period; states are x and x′ at phase zero."""

    oscillator: PiecewiseOscillator = internal("that moves")
    periods: int = attribute("of the forcing until it closes")
    crossings: Array = internal("time, x, x′ and the regime begun", axes="crossing 4")
    sides: str = internal("that it touches")
    clearance: float = variable("", "", "least distance of an extremum from a breakpoint")

    @property
    @computed(attribute())
    def contact(self) -> str:
        """none, one-sided or two-sided."""
        return contact_state(self.sides)

    def motion(self, count: int = 512) -> tuple[Array, Array]:
        """Times (count,) over the orbit's period, its end left out, and states (count, 2)."""
        o = self.oscillator
        times = self.periods * o.period * np.arange(count) / count
        return times, piecewise.states(o.regimes, o.coefficients, o.frequency, self.start, times)

    def harmonics(self, highest: int) -> Complex:
        """Fourier coefficients (highest + 1,) of x: x = Re Σ c_k e^{2πikt/T}, integrated between its crossings."""
        o = self.oscillator

        def x(times: Array) -> Array:
            found = piecewise.states(o.regimes, o.coefficients, o.frequency, self.start, np.concatenate([[0.0], times]))
            return found[1:, :1]

        cuts = np.unique(np.concatenate([[0.0], self.crossings[:, 0], [self.periods * o.period]]))
        return fourier(x, cuts, highest)[:, 0]

    def declared(self) -> Iterator[Variable | Attribute]:
        """What the fields hold, the motion over its period, its crossings, the numbers read off it and the ending."""
        yield from super().declared()
        times, motion = self.motion() if self.outcome.ok else (np.zeros(0), np.zeros((0, 2)))
        yield Coordinate("time", times, "time", "s")
        yield Variable("x", motion[:, 0], "time")
        yield Variable("v", motion[:, 1], "time")
        yield Variable("crossing_time", self.crossings[:, 0], "crossing", "s")
        yield from (Variable(name, getattr(self, name)) for name in NUMBERS)
        yield Attribute("oscillator", self.oscillator.name)
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


@labelled
class ExactOrbit(Result, TorqueRange, Orbit):
    """A periodic motion of a line with stages and what it does in its period.

    States are twists [rad], then rates [rad/s], at t = 0; multipliers and monodromy leave out the rotation of a
    free–free line and the sliders of ``continuum``, whose multipliers are exactly 1.
    """

    torque_low: Array = variable("spring", "N*m", "lowest")
    torque_high: Array = variable("spring", "N*m", "highest")
    period: float = variable("", "s")
    line: StagedLine = internal("that moves")
    value: float = attribute("speed or common frequency of the excitation, whichever turns it", "rad/s")
    periods: int = internal("of the excitation until it closes")
    events: StageEvents = internal("changes of stage", repr=False)
    twist_low: Array = variable("spring", "rad", "lowest")
    twist_high: Array = variable("spring", "rad", "highest")
    twist_mean: Array = variable("spring", "rad")
    torque_mean: Array = variable("spring", "N*m")
    contacts: tuple[SpringContact, ...] = internal("sides, impacts and their energy, per spring with stages")
    clearance: float = variable(
        "", "rad", "least distance of an extremum of a twist from an end of its stage, inf without one"
    )
    slowest_crossing: float = variable("", "rad/s", "smallest rate at a change of stage, inf without one")
    continuum: tuple[StuckClutch, ...] = internal(
        "the clutches with sliders that never slip, which make this motion one of a continuum"
    )

    @property
    @computed(coordinate("spring"))
    def springs(self) -> tuple[str, ...]:
        """Names of the springs."""
        return self.line.springs

    @property
    def stuck(self) -> tuple[str, ...]:
        """Names of the sliders that never slip."""
        return tuple(name for clutch in self.continuum for name in clutch.sliders)

    def motion(self, count: int = 512) -> tuple[Array, Array, Array]:
        """Times (count,) over the period, its end left out, states (count, 2m) and torques (count, spring)."""
        times, flow = self.period * np.arange(count) / count, self.line.flow(self.value)
        run = staged_flow.move(flow, self.start, 0.0, self.period, times=times)
        return times, run.states, flow.torque(run.states, run.shown_stages)[:, : len(self.springs)]

    def declared(self) -> Iterator[Variable | Attribute]:
        """What the fields hold, twist and torque over the period, changes of stage and the ending."""
        yield from super().declared()
        count = len(self.springs)
        times, states, torque = np.zeros(0), np.zeros((0, count)), np.zeros((0, count))
        if self.outcome.ok:
            times, states, torque = self.motion()
        yield Coordinate("time", times, "time", "s")
        yield Variable("twist", states[:, :count], "time spring", "rad")
        yield Variable("torque", torque, "time spring", "N*m")
        yield Variable("torque_peak_to_peak", self.torque_peak_to_peak, "spring", "N*m")
        yield Variable("event_time", self.events.time, "event", "s")
        yield Variable("event_spring", np.array([self.line.rows[i] for i in self.events.spring], dtype=str), "event")
        yield Attribute("driveline", self.line.name)
        yield Attribute("continuum", "; ".join(map(str, self.continuum)))
        yield from ending(self.outcome)

    def __str__(self) -> str:
        unit = speed_unit(self.line.assembly.line)
        by_speed, frequencies = self.line.independent_variable == "speed", frequency_unit(unit)
        at = f"Ω = {show_speed(self.value, unit)}" if by_speed else f"ω = {show_speed(self.value, frequencies)}"
        if not self.outcome.ok:
            return f"no periodic motion of {self.line.name} at {at}: {self.outcome}"
        rows = [
            f"  {name}: torque {mean_and_swing(mean, swing, 'N m')}"
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


def refuse_unbounded(oscillator: PiecewiseOscillator) -> None:
    """Refuse a linear oscillator driven, undamped, at its own frequency.

    Raises
    ------
    InputError : its motion grows without bound.
    """
    c, s, _ = oscillator.regimes.pieces[0]
    force = oscillator.coefficients
    for k in range(1, len(force)) if len(oscillator.slopes) == 1 and c == 0 else ():
        if force[k] != 0 and abs(s - (k * oscillator.frequency) ** 2) < 1e-7 * s:
            raise InputError(
                "makes the undamped resonant motion grow without bound: there is no periodic motion",
                element=oscillator.name, key="damping", value=0.0, remedy="give some damping or another frequency",
            )  # fmt: skip


@overload
def piecewise_orbit(
    oscillator: PiecewiseOscillator, start: ArrayLike | None = None, *, periods: int = 1, settle: bool = True
) -> PiecewiseOrbit: ...
@overload
def piecewise_orbit(
    oscillator: Driveline | Assembly,
    start: ArrayLike | None = None,
    *,
    speed: float | str | None = None,
    periods: int = 1,
    settle: bool = True,
) -> ExactOrbit: ...


def piecewise_orbit(
    oscillator: PiecewiseOscillator | Driveline | Assembly,
    start: ArrayLike | None = None,
    *,
    speed: float | str | None = None,
    periods: int = 1,
    settle: bool = True,
) -> PiecewiseOrbit | ExactOrbit:
    """The exact periodic motion near ``start``, stable or not, of a piecewise linear oscillator or a driveline.

    Parameters
    ----------
    oscillator : a ``PiecewiseOscillator``, or a driveline that ``exact_motion`` takes.
    start : x and x′ near it at phase zero, by default rest at the static equilibrium; of a driveline twists [rad] and
        rates [rad/s] (2m,) as in ``exact_motion``.
    speed : of a driveline [rad/s], as in ``exact_motion``.
    periods : forcing periods in one period of the motion.
    settle : where shooting fails, let 50 and then 500 periods pass and shoot again.

    Returns
    -------
    PiecewiseOrbit, or of a driveline ExactOrbit. Its ``outcome`` says whether a motion was found; otherwise its numbers
    are NaN.

    Raises
    ------
    InputError : a start that is not two finite numbers; an undamped linear resonance; a driveline that has no exact
        motion, no excitation or none with a common period, or a clutch that carries more than it holds; a start beyond
        what friction holds.

    Examples
    --------
    >>> import trunnion as tn
    >>> gap = tn.PiecewiseOscillator.gap(half_gap=1.0, damping=0.05, mean_force=0.2, force=0.4, frequency=0.7)
    >>> orbit = tn.piecewise_orbit(gap)
    >>> str(orbit.verdict), round(orbit.peak_to_peak, 4), orbit.impacts
    ('stable', 6.5652, 2.0)
    """
    periods = checked_periods(periods)
    if isinstance(oscillator, Driveline | Assembly):
        line = staged_line(oscillator, speed)
        refuse_found_speed(line)
        return orbit_near(line, start_state(line, start), line.value, periods, settle)
    refuse_speed(oscillator.name, speed)
    first = np.array([oscillator.equilibrium(), 0.0] if start is None else start, dtype=float)
    if first.shape != (2,) or not np.isfinite(first).all():
        raise InputError("must be x and x′, two finite numbers", element=oscillator.name, key="start", value=start)
    refuse_unbounded(oscillator)
    over_period = OscillatorMap.of(oscillator, periods)
    return _of_mass(
        over_period,
        close(first, lambda guess: ShootingProblem(over_period, over_period.scale(first)), settle=settle)[1],
    )


def _not_converged(root: Root, source: str) -> Outcome:
    words = f"shooting did not converge (residual {root.size:.1e}); start closer, for example from {source}"
    return Outcome(False, "not converged", f"{words}, or give more periods if the motion is a subharmonic")


def _found(missed: Array, iterations: int) -> Outcome:
    return Outcome(True, "found", f"closes to {np.abs(missed).max():.1e} after {iterations} iterations")


def _of_mass(place: OscillatorMap, root: Root) -> PiecewiseOrbit:
    if root.converged:
        passage, seen = place(root.x), place.measured(root.x)[0]
        outcome, crossings = _found(passage.state - root.x, root.iterations), passage.run.crossings
        clearance = _clearance(place.oscillator, root.x, place.length)
    else:
        passage, seen, crossings, clearance = place.nowhere(), place.unmeasured, np.zeros((0, 4)), float("nan")
        outcome = _not_converged(root, "the end of a sweep")
    values = by_modulus(passage.tangents)
    return PiecewiseOrbit(
        start=root.x,
        period=place.length,
        multipliers=values,
        monodromy=passage.tangents,
        verdict=exact_verdict(values),
        iterations=root.iterations,
        outcome=outcome,
        oscillator=place.oscillator,
        periods=place.periods,
        crossings=crossings,
        clearance=clearance,
        **fields_of(PiecewiseOrbit, seen),
    )


def fields_of(kind: Any, seen: Mapping[str, Any]) -> dict[str, Any]:
    """Those of the values seen in a motion that are fields of a result."""
    return {name: value for name, value in seen.items() if name in kind.__dataclass_fields__}


def _clearance(oscillator: PiecewiseOscillator, start: Array, length: float) -> float:
    if not oscillator.breakpoints:
        return float("inf")
    run = piecewise.move(
        oscillator.regimes, oscillator.coefficients, oscillator.frequency, start, 0.0, length, tangents=False,
        extrema=True,
    )  # fmt: skip
    extrema = run.events[run.events[:, 3] < 0, 1]
    if not len(extrema):
        return float("inf")
    return float(np.abs(extrema[:, None] - np.array(oscillator.breakpoints)).min())


def refuse_found_speed(line: StagedLine) -> None:
    """Refuse a line whose excitation turns with a speed that its own loads lead to.

    Raises
    ------
    InputError : so.
    """
    if line.turns and line.independent_variable in ("speed", "both"):
        raise InputError(
            "is free–free under viscous loads, so the speed that its excitation turns with is a result, not given",
            element="driveline", key="viscous_load",
            remedy="put a ConstantSpeed in front, or use tn.periodic_response, which finds the speed",
        )  # fmt: skip
    refuse_lost_speed(line)


def orbit_near(line: StagedLine, start: Array, value: float, periods: int, settle: bool = True) -> ExactOrbit:
    """The periodic motion near ``start`` (2m,) at a value of the clock.

    Raises
    ------
    InputError : a clutch that carries more than it holds.
    """
    place = LineMap(value, periods, line)
    if line.sliders and not line.turns:
        refuse_overload(line.assembly, line.speed_at(value))
    orbit = _closed(place, start, settle)
    if orbit.outcome.ok or not line.sliders:
        return orbit

    def twists(states: Array) -> Array:
        return np.array([place.whole(state)[: len(line.springs)] for state in states])

    found = slipping_on(line.assembly, line.speed_at(value), line.placed, place, start[place.kept], twists)
    return replace(orbit, outcome=found or orbit.outcome)


def _closed(place: LineMap, start: Array, settle: bool) -> ExactOrbit:
    """The motion near ``start`` (2m,). Which sliders stick shows in the motion once it has settled, and again by
    every motion that closes."""
    begin, fixed = start[place.kept], tuple[int, ...]()
    if place.sliders:
        settled = place.settle(begin, SETTLED) if settle else begin
        if settled is None:
            words = "stages change too often in a period; raise damping"
            return _of_line(place, start, Outcome(False, "chatter", words))
        begin, fixed = settled, place.idle(settled)

    def problem_at(guess: Array) -> ShootingProblem[LineMap]:
        return ShootingProblem(place, place.scale(place.whole(guess)))

    problem, root = close(begin, lambda guess: holding(problem_at(guess), fixed), settle=settle)
    if not root.converged:
        return _of_line(place, place.whole(begin), _not_converged(root, "the final state of a longer tn.exact_motion"))
    found = sticking(replace(problem, map=place), root, fixed)
    if found is None:
        words = (
            "no motion agrees with which of its sliders stick; start closer, from the end of a longer tn.exact_motion"
        )
        return _of_line(place, place.whole(root.x), Outcome(False, "not converged", words))
    problem, root, fixed = found
    if not _determined(root, problem.scale, len(fixed)):
        words = (
            "no one motion closes: some disturbance returns unchanged, as where an undamped line is driven at its "
            "own frequency; give some damping or another frequency"
        )
        return _of_line(place, place.whole(root.x), Outcome(False, UNDETERMINED, words))
    return _of_line(problem.map, problem.map.whole(root.x), None, root.iterations)


def _determined(root: Root, scale: Array, fixed: int) -> bool:
    """Whether the closing condition fixes the motion, but for what ``fixed`` sliders leave open: its derivative has no
    further direction in which it is singular."""
    sizes = np.linalg.svd(root.derivative * scale[None, :] / scale[:, None], compute_uv=False)
    return bool(sizes[-1 - fixed] > SINGULAR * max(sizes[0], 1.0))


def _of_line(place: LineMap, start: Array, failed: Outcome | None, iterations: int = 0) -> ExactOrbit:
    """The orbit from ``start`` (2m,), or one of NaN where it ``failed``."""
    line, part, scale = place.line, start[place.kept], place.scale(start)
    passage = place.nowhere() if failed else place(part, watch=True)
    seen = place.unmeasured if failed else place.told_of(part, passage.run)
    events, matrix = np.zeros((0, 5)) if failed else passage.run.events, passage.tangents
    rates = events[events[:, 1] < len(line.springs), 4]
    if place.fixed:
        matrix = beside_sticking(place, part, matrix * scale / scale[:, None], scale)[0]
    values = by_modulus(matrix)
    alike = not any(line.counts[line.source[line.slider_rows[i]]] > 1 for i in place.fixed)
    return ExactOrbit(
        start=start,
        period=place.length,
        multipliers=values,
        monodromy=passage.tangents,
        verdict=exact_verdict(values),
        iterations=iterations,
        outcome=failed or _found((passage.state - part) / scale, iterations),
        line=line,
        value=place.value,
        periods=place.periods,
        events=stage_events(line, events),
        slowest_crossing=float("nan") if failed else float(np.abs(rates).min(initial=np.inf)),
        continuum=continuum(line.assembly, line.placed, ShootingProblem(place, scale), part, _watched, alike),
        **fields_of(ExactOrbit, seen),
    )


def _watched(place: LineMap, part: Array) -> Watched:
    """What ``clutches`` asks of a motion."""
    seen, k, rows = place.watched(part).seen, kernel(), place.line.slider_rows
    return Watched(seen[rows, k.LOW], seen[rows, k.HIGH], seen[: rows.start, k.TWIST_SUM] / place.length)
