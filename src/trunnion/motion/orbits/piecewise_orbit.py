"""Periodic motions of one mass on a piecewise linear spring, or of a driveline, by shooting with the exact motion.

The motion over one or several periods and its derivatives by start and parameter are known to rounding, saltation at
every change of stage included (``numerics/piecewise_linear``), so Newton's method closes the orbit to rounding and the
multipliers are those of the motion itself. An orbit that touches a breakpoint or the end of a stage (grazing) has no
derivative there; ``clearance`` and, of a line, ``slowest_crossing`` say how near that is.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import overload

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.equations.clutch_capacity import refuse_overload
from trunnion.equations.coefficients import Assembly
from trunnion.equations.staged_line import StagedLine, refuse_lost_speed, staged_line
from trunnion.errors import InputError
from trunnion.motion.orbits.exact_map import LineMap, OscillatorMap
from trunnion.motion.orbits.exact_orbit_result import ExactOrbit, PiecewiseOrbit
from trunnion.motion.orbits.spring_contacts import SpringContact
from trunnion.motion.orbits.stuck_clutches import StuckClutch, slips_on, stuck_clutches
from trunnion.motion.simulation.exact_motion import StageEvents, first_stages, stage_events, start_state
from trunnion.numerics.continuation.newton import Root
from trunnion.numerics.piecewise_linear.piecewise import Passage, move
from trunnion.numerics.piecewise_linear.staged_flow import StagedPassage, kernel
from trunnion.results.outcome import Outcome
from trunnion.steady.shooting.closing import by_modulus, close, refuse_speed
from trunnion.steady.shooting.judging import ExactClosing
from trunnion.systems.maps import checked_periods
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator

CONTACT = ("none", "upper", "lower", "both")
"""Sides touched, by the code of the measurement."""
SETTLED = 100
"""Periods after which a motion shows which sliders stick."""
FLAT, LONGER, MOST_FLAT = -1e-9, 4.0, 12
"""Slope above which a spring takes up nothing of a shift; growth of the steps there, and how many are taken until it is
taken to go on without end."""
TRIES = 40
"""Motions in which an end of the continuum is looked for."""
REACHED = 1e-9
"""Room that a slider may have left there, over the deflection at which it slips."""
CHANCES = 2
"""Motions in which a slider is tried as one that sticks: the first may begin before the motion has settled."""
UNDETERMINED = "not determined"
"""Kind of the outcome where motions close, but no single one."""
SINGULAR = 1e-12
"""Smallest singular value over the largest below which the condition of closing determines nothing."""


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
    """The periodic motion near ``start``, stable or not.

    Parameters
    ----------
    oscillator : or a driveline that ``exact_motion`` takes.
    start : x and x′ near it at phase zero, by default rest at the static equilibrium; of a driveline twists and rates
        (2m,) as in ``exact_motion``.
    speed : of a driveline as in ``exact_motion``.
    periods : forcing periods in one period of the motion.
    settle : where shooting fails, let 50 and then 500 periods pass and shoot again.

    Returns
    -------
    An orbit whose ``outcome`` says whether it was found; otherwise its numbers are NaN. Of a driveline an
    ``ExactOrbit``.

    Raises
    ------
    InputError : a start that is not two finite numbers; an undamped linear resonance; a driveline that has no exact
        motion, no excitation or none with a common period, or a clutch that carries more than it holds; a start beyond
        what friction holds.
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
    closing, root = close(first, lambda guess: ExactClosing(over_period, over_period.scale(first)), settle=settle)
    if not root.converged:
        return _no_orbit_of_mass(over_period, root, _not_converged(root, "the end of a sweep"))
    return _orbit_of_mass(over_period, root.x, root.iterations)


def _not_converged(root: Root, source: str) -> Outcome:
    words = f"shooting did not converge (residual {root.size:.1e}); start closer, for example from {source}"
    return Outcome(False, "not converged", f"{words}, or give more periods if the motion is a subharmonic")


def _orbit_of_mass(place: OscillatorMap, start: Array, iterations: int) -> PiecewiseOrbit:
    oscillator = place.oscillator
    passage, found = place(start), place.measure(start)
    closes = float(np.abs(passage.state - start).max())
    return PiecewiseOrbit(
        oscillator=oscillator,
        start=start,
        periods=place.periods,
        multipliers=by_modulus(passage.tangents),
        monodromy=passage.tangents,
        crossings=passage.run.crossings,
        lowest=found["low"],
        highest=found["high"],
        mean=found["mean"],
        sides=CONTACT[int(found["contact"])],
        impacts=found["impacts"],
        impact_energy=oscillator.inertia * found["energy"],
        impact_impulse=oscillator.inertia * found["impulse"],
        clearance=_clearance(oscillator, start, place.length),
        iterations=iterations,
        outcome=Outcome(True, "found", f"closes to {closes:.1e} after {iterations} iterations"),
    )


def _clearance(oscillator: PiecewiseOscillator, start: Array, length: float) -> float:
    if not oscillator.breakpoints:
        return float("inf")
    run: Passage = move(
        oscillator.regimes, oscillator.coefficients, oscillator.frequency, start, 0.0, length, tangents=False,
        extrema=True,
    )  # fmt: skip
    extrema = run.events[run.events[:, 3] < 0, 1]
    if not len(extrema):
        return float("inf")
    return float(np.abs(extrema[:, None] - np.array(oscillator.breakpoints)).min())


def _no_orbit_of_mass(place: OscillatorMap, root: Root, outcome: Outcome) -> PiecewiseOrbit:
    nan = float("nan")
    return PiecewiseOrbit(
        place.oscillator, root.x, place.periods, np.full(2, nan, dtype=complex), np.full((2, 2), nan),
        np.zeros((0, 4)), nan, nan, nan, "none", nan, nan, nan, nan, root.iterations, outcome,
    )  # fmt: skip


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
    refuse_lost_speed(line)


def orbit_near(line: StagedLine, start: Array, value: float, periods: int, settle: bool = True) -> ExactOrbit:
    """The periodic motion near ``start`` (2m,) at a value of the clock.

    Raises
    ------
    InputError : a clutch that carries more than it holds.
    """
    place = LineMap(value, periods, line)
    if not line.sliders:
        return _closed(place, start, settle)
    if not line.turns:
        refuse_overload(line.assembly, line.speed_at(value))
    orbit = _rubbing(place, start, settle)
    return orbit if orbit.outcome.ok else replace(orbit, outcome=_slipping(place, start) or orbit.outcome)


def _rubbing(place: LineMap, start: Array, settle: bool) -> ExactOrbit:
    """The periodic motion of a line with sliders. Which of them stick is told by the motion once it has settled, and
    again by every orbit found."""
    line = place.line
    settled = place.settle(start[place.kept], SETTLED) if settle else start[place.kept]
    if settled is None:
        words = "stages change too often in a period; raise damping"
        return _no_orbit_of_line(place, start, Outcome(False, "chatter", words))
    whole = place.whole(settled)
    rows, slipped = place.idle(place.watched(settled), whole), Counter[int]()
    for _ in range(2 * CHANCES * len(line.sliders) + 1):
        found = place.sticking(rows, whole)
        orbit = _closed(found, whole, settle)
        if not (orbit.outcome.ok or orbit.outcome.kind == UNDETERMINED):
            return orbit
        idle = found.idle(found.watched(orbit.start[found.kept]), orbit.start)
        slipped.update(rows - idle)
        stick = {row for row in idle if slipped[row] < CHANCES}
        if stick == rows:
            return orbit
        # First those slip that cannot stick after all; then those stick that turn out not to slip.
        rows, whole = rows & stick if rows - idle else stick, line.within_limits(orbit.start)
    words = "no motion agrees with which of its sliders stick; start closer, from the end of a longer tn.exact_motion"
    return _no_orbit_of_line(place, start, Outcome(False, "not converged", words))


def _slipping(place: LineMap, start: Array) -> Outcome | None:
    """What to say where a clutch slips on with every period once the line has settled."""
    line, states = place.line, [start[place.kept]]
    for wait in (SETTLED, 1, 1):
        settled = place.settle(states[-1], wait)
        if settled is None:
            return None
        states.append(settled)
    twists = np.array([place.whole(state)[: len(line.springs)] for state in states[1:]])
    return slips_on(line.assembly, line.speed_at(place.value), line.placed, twists)


def _closed(place: LineMap, start: Array, settle: bool) -> ExactOrbit:
    closing, root = close(
        start[place.kept], lambda guess: ExactClosing(place, place.scale(place.whole(guess))), settle=settle
    )
    if not root.converged:
        outcome = _not_converged(root, "the final state of a longer tn.exact_motion")
        return _no_orbit_of_line(place, start, outcome)
    if not _determined(root, closing.scale):
        words = (
            "no one motion closes: some disturbance returns unchanged, as where an undamped line is driven at its "
            "own frequency; give some damping or another frequency"
        )
        return _no_orbit_of_line(place, place.whole(root.x), Outcome(False, UNDETERMINED, words))
    return _orbit_of_line(place, root.x, root.iterations)


def _determined(root: Root, scale: Array) -> bool:
    """Whether the closing condition fixes the motion: its derivative is not singular."""
    sizes = np.linalg.svd(root.derivative * scale[None, :] / scale[:, None], compute_uv=False)
    return bool(sizes[-1] > SINGULAR * max(sizes[0], 1.0))


def _orbit_of_line(place: LineMap, part: Array, iterations: int) -> ExactOrbit:
    line, start, length = place.line, place.whole(part), place.length
    passage, k, count = place(part, watch=True), kernel(), len(place.line.springs)
    run = passage.run
    closes = float(np.max(np.abs(passage.state - part) / place.scale(start)))
    seen, rates = run.seen[:count], run.events[run.events[:, 1] < count, 4]
    found = ExactOrbit(
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
    )
    return replace(found, continuum=_continuum(place, found, run)) if place.stuck else found


def _continuum(place: LineMap, orbit: ExactOrbit, run: StagedPassage) -> tuple[StuckClutch, ...]:
    """The clutches with sliders that never slip in a watched passage."""
    line, k, first = place.line, kernel(), len(place.line.springs)
    rows, stuck = list(line.slider_rows), [row - first for row, _ in place.stuck]
    staged = any(line.counts[line.source[row]] > 1 for row, _ in place.stuck)

    def ends(own: list[int]) -> tuple[float, float]:
        rows = [first + i for i in own]
        return _end(place, orbit, run, rows, k.HIGH), _end(place, orbit, run, rows, k.LOW)

    return stuck_clutches(
        line.assembly, line.placed, stuck, run.seen[rows, k.LOW], run.seen[rows, k.HIGH], orbit.twist_mean,
        ends if staged else None,
    )  # fmt: skip


def _end(place: LineMap, orbit: ExactOrbit, run: StagedPassage, rows: list[int], side: int) -> float:
    """Mean twist [rad] of a clutch where its sliders, in ``rows``, all just reach where they slip at the highest or the
    lowest twist of the motion (``side``); NaN where none is found.

    They do where that twist is h and they stand at ± their reach − h beside it. How far the twist then lies above h
    falls with h, as the spring of the clutch takes up what the sliders no longer carry: by secants.
    """
    line, clutch, sign = place.line, int(place.line.source[rows[0]]), 1.0 if side == kernel().HIGH else -1.0
    others = tuple((row, beside) for row, beside in place.stuck if row not in rows)
    state, h, slope, before, flat = orbit.start, float(run.seen[clutch, side]), -1.0, (np.nan, np.nan), 0
    for _ in range(TRIES):
        own = tuple((row, sign * line.knots[row] - h) for row in rows)
        tried = replace(place, stuck=tuple(sorted(others + own)))
        root = ExactClosing(tried, tried.scale(state)).solve(state[tried.kept])
        if not root.converged:
            break
        state, seen = tried.whole(root.x), tried.watched(root.x).seen
        above = float(seen[clutch, side] - h)
        if abs(above) <= REACHED * min(line.knots[row] for row in rows):
            return float(seen[clutch, kernel().TWIST_SUM] / tried.length)
        last = slope
        if np.isfinite(before[0]):
            slope = (above - before[1]) / (h - before[0])
        if slope > FLAT:  # a stage in which the spring takes up nothing
            slope, flat = last / LONGER, flat + 1
        if flat > MOST_FLAT:
            return -sign * np.inf
        before, h = (h, above), h - above / slope
    return float("nan")


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


def _no_orbit_of_line(place: LineMap, start: Array, outcome: Outcome) -> ExactOrbit:
    nan, n, count = float("nan"), place.size, len(place.line.springs)
    none, whole = np.full(count, nan), np.zeros(0, dtype=np.int64)
    return ExactOrbit(
        place.line, place.value, start, place.length, place.periods, np.full(n, nan, dtype=complex),
        np.full((n, n), nan), StageEvents(np.zeros(0), whole, whole, whole, np.zeros(0)), none, none, none, none, none,
        none, (), nan, nan, 0, outcome,
    )  # fmt: skip
