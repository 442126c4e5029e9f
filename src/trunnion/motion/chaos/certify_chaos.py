"""A verdict on a motion: regular, chaotic, unbounded or undecided, with its reasons (THA–LEA–PM).

The three steps of Bugaru and Vasile (Appl. Sci. 12, 2022, 6182), with exponents of the standard definition:
time history (THA: is the motion bounded, has it settled), Lyapunov exponents (LEA: the criteria below), Poincaré map
(PM: does it repeat). The 0–1 test of the map is a second, independent witness.

    unbounded   the motion grows until it cannot be followed, or states and rates grow from block to block of the run;
                clocks and what turns (states that may move by a period without changing any rate) do not count
    regular     the map repeats (periodic), or does not but neighbours do not part and the 0–1 test agrees
                (quasi-periodic), or the motion has come to rest
    chaotic     the largest exponent is above 0 by more than its interval, by more than what a regular motion's
                slow shear gives in that time, and the 0–1 test agrees
    undecided   anything else: the reasons say what is missing

The criteria (37)–(39) of the method (Bugaru and Vasile, section 5) certify chaos where

    (37) the largest exponent is positive,  (38) one exponent is near 0,  (39) the sum is negative.

(38) holds for every forced system, whose phase is a state with exponent 0, and for every bounded autonomous motion
that is not at rest, whose tangent has exponent 0. (39) holds for every motion of a system that shrinks volumes
everywhere, so for every damped one, and for none of a system that preserves them. Where the answer is known
beforehand they say nothing about the motion.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Flags
from trunnion.driveline.driveline import Driveline
from trunnion.errors import InputError
from trunnion.motion.chaos.chaos_subject import (
    as_system,
    clocks,
    first_starts,
    motion_size,
    phases,
    turn_of,
    turns,
    usual_section,
)
from trunnion.motion.chaos.chaos_zero_one import FEWEST as FEWEST_FOR_TEST
from trunnion.motion.chaos.chaos_zero_one import ZeroOne, zero_one_test
from trunnion.motion.chaos.lyapunov_map import LyapunovSweep, lyapunov_sweep
from trunnion.motion.chaos.lyapunov_spectrum import FEWEST, FIRST, LyapunovSpectrum, lyapunov_spectrum, shear_bound
from trunnion.motion.chaos.poincare_map import PoincareMap, poincare_map
from trunnion.numerics.integration.integration import IntegrationEnd
from trunnion.results.drawing import Figure, drawing
from trunnion.results.fields import attribute, internal, labelled
from trunnion.results.outcome import Outcome
from trunnion.results.result import Result
from trunnion.results.variables import Attribute, Variable, attributes
from trunnion.steady.shooting.repetition import modulo
from trunnion.systems.events import Event
from trunnion.systems.system import System
from trunnion.systems.user_functions import REACH, STEP
from trunnion.waiting import OutOfTime, keeps_time, time_is_up

EXACT, DIFFERENCED = 1e-14, 1e-11
"""Divergence over the size of ∂f/∂x (differenced: times that of the state, too) that rounding may give."""
POINTS = 3000
"""Points of the Poincaré map."""
BLOCKS, GROWN = 8, 2.0
"""A state, or a rate, that rises in each of so many blocks, by this factor in all, grows."""
LOOKED_AT = 32
"""Samples of each block at which rates are looked at."""
UNSTABLE = "at rest on an unstable equilibrium"
VAGUE, UNDAMPED = 0.1, 1e-9
"""Share of the mean damping from which an interval says nothing, and the damping of a period that is none."""
AT_REST = 1e-7
"""Size of a motion over its scale that counts as rest."""
SWEPT, SWEEP_POINTS, SWEEP_PERIODS = 0.1, 25, 400
SPECTRUM_SHARE = 0.6
"""Of the time, where the exponents are also swept."""
SWEPT_NAMES = ("excitation", "frequency", "speed")


@dataclass(frozen=True)
class Criterion:
    """name, value [1/s], whether it holds, whether it could have failed for this system, and why."""

    name: str
    value: float
    holds: bool
    discriminates: bool
    why: str

    def __str__(self) -> str:
        use = "discriminates" if self.discriminates else "cannot discriminate"
        return f"{self.name}: {self.value:+.4g} 1/s, {'holds' if self.holds else 'fails'}; {use}: {self.why}"


def criteria(
    system: System, spectrum: LyapunovSpectrum, *, clock: bool, at_rest: bool, bounded: bool = True
) -> tuple[Criterion, ...]:
    """The three criteria for one motion; ``clock``: one of the states is a phase that runs evenly."""
    exponents, width = spectrum.exponents, spectrum.half_width
    forced = system.forcing_period is not None
    first = Criterion(
        "(37) largest exponent positive", spectrum.largest, spectrum.positive, True,
        "a motion may part from its neighbours or not",
    )  # fmt: skip
    automatic = forced or clock or (bounded and not at_rest)
    near = 0.0 if forced else float(exponents[np.argmin(np.abs(exponents))])
    if forced:
        why = "every forced system has an exponent 0, that of its phase"
    elif clock:
        why = "one state is a phase that runs evenly and has exponent 0, whatever the motion does"
    elif not bounded:
        why = "the motion is not bounded, so the exponent of its own direction may be any"
    elif not at_rest:
        why = "every bounded autonomous motion that is not at rest has an exponent 0, that of its own direction"
    elif spectrum.largest < 0:
        why = "the motion has come to rest"
    else:
        why = "the motion is at rest on an unstable equilibrium"
    holds = automatic or bool(np.any(np.abs(exponents) <= width))
    second = Criterion("(38) an exponent near 0", near, holds, not automatic, why)
    return first, second, _third(system, spectrum)


def _third(system: System, spectrum: LyapunovSpectrum) -> Criterion:
    name, total = "(39) sum of the exponents negative", spectrum.sum
    if system.regimes is not None and system.equations.jump:
        return Criterion(name, total, bool(total < 0), True, "the jumps of the motion change volumes, too")
    low, high, rounding = _divergences(system, spectrum)
    if max(-low, high) <= rounding:
        why = "volumes are preserved, so the sum is 0 but for rounding, whatever the motion does"
        return Criterion(name, total, False, False, why)
    if low > 0 or high < 0:
        kind, rate = ("shrink", -high) if high < 0 else ("grow", low)
        words = f"{rate:.6g} 1/s along every motion of this system"
        if system.divergence is None:
            words = f"{rate:.4g} 1/s or more everywhere on the motion"
        return Criterion(name, total, high < 0, False, f"volumes {kind} at {words}")
    return Criterion(name, total, bool(total < 0), True, "volumes shrink in places and grow in others")


def _divergences(system: System, spectrum: LyapunovSpectrum) -> tuple[float, float, float]:
    """Smallest and largest divergence where the motion was sampled, all around the forcing, and its rounding."""
    states = np.concatenate([run.states[:: max(len(run.states) // 50, 1)] for run in spectrum.runs])
    matrices = np.array([system.jacobian(t, x, system.regime_at(t, x)) for x in states for t in phases(system)])
    size = float(np.max(np.abs(matrices)))
    if system.divergence is not None:
        return spectrum.divergence, spectrum.divergence, EXACT * size
    furthest = 1 + min(float(np.max(np.abs(states) / np.asarray(system.scale))), STEP / REACH)
    rounding = EXACT * size if system.exact_tangents else DIFFERENCED * size * furthest
    traces = np.trace(matrices, axis1=1, axis2=2)
    return float(traces.min()), float(traces.max()), rounding


class ChaosVerdict(StrEnum):
    """What a motion is."""

    REGULAR = "regular"
    CHAOTIC = "chaotic"
    UNBOUNDED = "unbounded"
    UNDECIDED = "undecided"


@dataclass(frozen=True)
class Witness:
    """What one start gave: its map, the 0–1 test of it (None if there are too few points), and what it says."""

    map: PoincareMap | None
    test: ZeroOne | None
    verdict: ChaosVerdict
    kind: str
    reasons: tuple[str, ...]


@labelled
class ChaosCertificate(Result):
    """A verdict with its evidence: the exponents, the map, the 0–1 test and the sweep."""

    system: System = internal("that was judged")
    verdict: ChaosVerdict = attribute()
    kind: str = attribute(
        '"periodic", "quasi-periodic" or "at rest" of a regular motion, "at rest on an unstable equilibrium" of an '
        "undecided one"
    )
    repeat: int = attribute("forcing periods, or returns to the section, after which a periodic motion closes")
    period: float = internal("time after which it closes, NaN of another", "s")
    reasons: tuple[str, ...] = internal("one sentence each")
    criteria: tuple[Criterion, ...] = internal("(37) to (39)")
    spectrum: LyapunovSpectrum = internal("the exponents")
    map: PoincareMap | None = internal("of the motion")
    zero_one: ZeroOne | None = internal("the 0–1 test of its points")
    sweep: LyapunovSweep | None = internal("exponents over a parameter")

    def declared(self) -> Iterator[Variable | Attribute]:
        """The exponents, with the verdict and its reasons."""
        yield from self.spectrum.declared()
        yield from super().declared()
        yield from attributes(reasons="\n".join(self.reasons), criteria="\n".join(map(str, self.criteria)))
        if self.zero_one is not None:
            yield Attribute("zero_one_test", self.zero_one.k)
        if np.isfinite(self.period):
            yield Attribute("period", self.period)

    def plot(self) -> Figure:
        """Portrait, exponents, and the map at two numbers of points."""
        return drawing(self, "plot")(self).figure

    def __str__(self) -> str:
        what = {"": ""}.get(self.kind, f", {self.kind}")
        if self.kind == "periodic":
            unit = "forcing period" if self.system.forcing_period is not None else "return"
            what += f", closes after {self.repeat} {unit}{'s' if self.repeat > 1 else ''} ({self.period:.6g} s)"
        lines = [f"{self.system.name}: {self.verdict}{what}"]
        lines += [f"  {reason}" for reason in self.reasons]
        lines += [f"  {criterion}" for criterion in self.criteria]
        if self.zero_one is not None:
            lines.append(f"  {self.zero_one}")
        return "\n".join(lines)


@keeps_time
def certify_chaos(
    subject: System | Driveline,
    periods: int | None = None,
    *,
    duration: float | None = None,
    speed: float | str | None = None,
    start: ArrayLike | None = None,
    starts: int = 2,
    section: Event | None = None,
    points: int = POINTS,
    transient: int | None = None,
    sweep: tuple[str, float, float, int] | bool = True,
    tolerance: float = 1e-10,
    within: float | None = None,
    progress: Callable[[float], None] | None = None,
) -> ChaosCertificate:
    """Certify what a motion is, by time history, Lyapunov exponents, Poincaré map and the 0–1 test.

    Parameters
    ----------
    subject : a ``System``, or a ``Driveline`` at ``speed``.
    periods : forcing periods to average exponents over; by default as ``lyapunov_spectrum`` does.
    duration : instead of ``periods`` [s].
    speed : input speed of a driveline [rad/s], by default its operating speed.
    start : a state (n,), or several (starts, n); by default the system's own and neighbours of it.
    starts : how many motions to follow.
    section : of the map of an autonomous system; by default the mean of the state that moves most.
    points : of the map.
    transient : periods to let pass before averaging; by default 500.
    sweep : (parameter, first, last, how many) for the exponents over a parameter in the figure; by default the forcing
        frequency or speed by ± 10 %; False for none.
    tolerance : error allowed per step.
    within : seconds that it may take; what is known by then is judged, and the reasons say what ended it.
    progress : called as progress(share done).

    Returns
    -------
    ChaosCertificate. Starts that lead to different motions make it undecided: certify each with ``starts=1``.

    Raises
    ------
    InputError : as ``lyapunov_spectrum`` and ``poincare_map``.

    Examples
    --------
    >>> import trunnion as tn
    >>> duffing = tn.reference_system("duffing")
    >>> found = tn.certify_chaos(duffing, 300, starts=1, points=300, sweep=False)
    >>> str(found.verdict)
    'regular'
    """
    system = as_system(subject, speed)
    request = _sweep_request(system, sweep)
    report_progress = progress or (lambda share: None)
    last = SPECTRUM_SHARE if request is not None else 1.0
    spectrum = lyapunov_spectrum(
        system, periods, duration=duration, start=start, starts=starts, transient=transient, tolerance=tolerance,
        progress=lambda share: report_progress(last * share),
    )  # fmt: skip
    report_progress(last)
    states = np.concatenate([run.states[-8:] for run in spectrum.runs])
    running = clocks(system, states) if len(states) and np.all(np.isfinite(states)) else {}
    ended = time_is_up()
    witnesses = [_in_time(system, spectrum, i, section, points, running) for i in range(len(spectrum.runs))]
    first = witnesses[0]
    same = all((w.verdict, w.kind) == (first.verdict, first.kind) for w in witnesses)
    verdict, kind, reasons = first.verdict, first.kind, first.reasons
    if not same:
        words = "; ".join(f"start {i} {w.kind or w.verdict}" for i, w in enumerate(witnesses, start=1))
        verdict, kind = ChaosVerdict.UNDECIDED, ""
        each = (f"start {i}: {reason}" for i, w in enumerate(witnesses, start=1) for reason in w.reasons)
        reasons = (f"the starts do not agree ({words}): certify each with starts=1, or over a longer time", *each)
    elif not spectrum.agree:
        reasons = (*reasons, "the starts agree on this and differ in their exponents: there may be several attractors")
    repeat = first.map.repeat if first.map is not None and kind == "periodic" else 0
    judged: tuple[Criterion, ...] = ()
    if spectrum.samples >= 2:
        judged = criteria(
            system, spectrum, clock=bool(running), at_rest=any(w.kind in ("at rest", UNSTABLE) for w in witnesses),
            bounded=all(w.verdict is not ChaosVerdict.UNBOUNDED for w in witnesses),
        )  # fmt: skip
    swept = None
    if request is not None and verdict is not ChaosVerdict.UNBOUNDED:
        try:
            swept = lyapunov_sweep(
                system, request[0], request[1:], periods=SWEEP_PERIODS, start=first_starts(system, start, 1)[0],
                tolerance=max(tolerance, 1e-9), progress=lambda share: report_progress(last + (1 - last) * share),
            )  # fmt: skip
        except OutOfTime as error:
            reasons = (*reasons, f"no exponents over {request[0]}: {error.why}")
    if ended:
        samples = min(len(run.growth) for run in spectrum.runs)
        reasons = (*reasons, f"{ended} after {samples} samples of the exponents")
    return ChaosCertificate(
        system, verdict, kind, repeat, _period(first.map, repeat), reasons, judged, spectrum, first.map, first.test,
        swept,
    )  # fmt: skip


def _sweep_request(system: System, sweep: tuple[str, float, float, int] | bool) -> tuple[str, float, float, int] | None:
    if sweep is False:
        return None
    if sweep is not True:
        if not isinstance(sweep, tuple) or len(sweep) != 4:
            raise InputError("must be (parameter, first, last, how many)", key="sweep", value=sweep)
        return sweep
    name = next((n for n in SWEPT_NAMES if n in system.parameters), None)
    if name is None or system.parameters[name] <= 0:
        return None
    value = system.parameters[name]
    return name, (1 - SWEPT) * value, (1 + SWEPT) * value, SWEEP_POINTS


def _in_time(
    system: System, spectrum: LyapunovSpectrum, i: int, section: Event | None, points: int, running: dict[int, float]
) -> Witness:
    try:
        return _witness(system, spectrum, i, section, points, running)
    except OutOfTime as error:
        return Witness(None, None, ChaosVerdict.UNDECIDED, "", (f"no map: {error.why}",))


def _witness(
    system: System, spectrum: LyapunovSpectrum, i: int, section: Event | None, points: int, running: dict[int, float]
) -> Witness:
    run, interval = spectrum.runs[i], spectrum.interval
    ending = spectrum.outcome.kind
    # Another start's end is not this one's.
    stopped = run.end is not IntegrationEnd.REACHED
    if stopped and ending in ("blow-up", "not finite", "step too small"):
        reason = f"the motion cannot be followed for ever: {spectrum.outcome}"
        return Witness(None, None, ChaosVerdict.UNBOUNDED, "", (reason,))
    if stopped:
        return Witness(None, None, ChaosVerdict.UNDECIDED, "", (str(spectrum.outcome),))
    if len(run.growth) < FEWEST:
        return Witness(None, None, ChaosVerdict.UNDECIDED, "", (_too_short(spectrum, i),))
    size, turning = motion_size(system, run.states[-1], interval, spectrum.tolerance), turns(system, run.states)
    whole = modulo(run.states, turning, np.asarray(system.scale))
    scale = np.asarray(system.scale) + np.abs(whole[-64:]).max(axis=0)
    still = [j for j in range(system.size) if j not in running]
    if (growing := _growing(system, whole, running, turning)) is not None:
        return growing
    exponent, width = spectrum.by_start[i][0], spectrum.by_start_half_width[i][0]
    width = max(width, spectrum.sum_error if np.isfinite(spectrum.sum_error) else 0.0)
    forced = system.forcing_period is not None
    rests = not forced and not running and bool(np.all(size <= AT_REST * scale))
    if rests and exponent < 0:
        return Witness(
            None, None, ChaosVerdict.REGULAR, "at rest",
            (f"the motion has come to rest; disturbances die out at {-exponent:.4g} 1/s",),
        )  # fmt: skip
    if rests and exponent > width:
        return Witness(
            None, None, ChaosVerdict.UNDECIDED, UNSTABLE,
            (f"the motion is {UNSTABLE}: disturbances grow at {exponent:.4g} 1/s; start beside it",),
        )  # fmt: skip
    mapped = _map(system, spectrum, i, section, points, running, turning, size)
    if not mapped.outcome.ok:
        return Witness(mapped, None, ChaosVerdict.UNDECIDED, "", (f"no map: {mapped.outcome}",))
    test = _test(system, mapped, still, turning)
    return _judge(spectrum, i, mapped, test, exponent, width)


def _judge(
    spectrum: LyapunovSpectrum, i: int, mapped: PoincareMap, test: ZeroOne | None, exponent: float, width: float
) -> Witness:
    forced = spectrum.system.forcing_period is not None
    shear = shear_bound(len(spectrum.runs[i].growth), spectrum.interval)
    parts = bool(exponent > max(width, shear))
    words = f"largest exponent {exponent:+.4g} ± {width:.2g} 1/s"
    if mapped.repeat and not parts:
        times = "point" if mapped.repeat == 1 else "points"
        return Witness(
            mapped, test, ChaosVerdict.REGULAR, "periodic", (f"{words}; the map repeats after {mapped.repeat} {times}",)
        )
    if mapped.settling and not parts:
        longer = spectrum.transient + 4 * len(spectrum.runs[i].growth)
        reason = f"the map is {mapped.repetition} to {longer} periods or more"
        return Witness(mapped, test, ChaosVerdict.UNDECIDED, "", (words, reason))
    if test is None:
        reason = f"{len(mapped.points)} points are too few for the 0–1 test; give {FEWEST_FOR_TEST} periods or more"
        return Witness(mapped, test, ChaosVerdict.UNDECIDED, "", (words, reason))
    if parts and test.says == "chaotic":
        return Witness(
            mapped, test, ChaosVerdict.CHAOTIC, "",
            (f"{words}: neighbours part exponentially, by e in {1 / exponent:.4g} s; the 0–1 test agrees",),
        )  # fmt: skip
    if not parts and test.says == "regular":
        settling = exponent + width < 0 and _zeros(spectrum, i) < (1 if forced else 2)
        if settling:
            longer = int(np.ceil(10 / (-exponent * spectrum.interval)))
            return Witness(
                mapped, test, ChaosVerdict.UNDECIDED, "",
                (f"{words}: it settles on a periodic motion and has not yet; raise transient by {longer} periods",),
            )  # fmt: skip
        damping = -spectrum.divergence
        if damping * spectrum.interval > UNDAMPED and width > VAGUE * damping:
            return Witness(
                mapped, test, ChaosVerdict.UNDECIDED, "",
                (
                    f"{words}: no exponent is known by that beside a damping of {damping:.4g} 1/s; "
                    f"average over {4 * len(spectrum.runs[i].growth)} periods or more",
                ),
            )  # fmt: skip
        return Witness(
            mapped, test, ChaosVerdict.REGULAR, "quasi-periodic",
            (f"{words}: neighbours do not part; the map does not repeat, and the 0–1 test finds no diffusion",),
        )  # fmt: skip
    more = 4 * len(spectrum.runs[i].growth)
    return Witness(
        mapped, test, ChaosVerdict.UNDECIDED, "",
        (
            f"{words} and the 0–1 test ({test.k:.2f}, {test.says}) do not agree: a long transient or weak chaos; "
            f"average over {more} periods or more",
        ),
    )  # fmt: skip


def _zeros(spectrum: LyapunovSpectrum, i: int) -> int:
    """How many exponents of this start are 0 to within their intervals. A torus has one without the phase of the
    forcing, and two where the direction of the motion counts."""
    value, width = spectrum.by_start[i], spectrum.by_start_half_width[i]
    size = float(np.max(np.abs(value)))
    return int(np.sum(np.abs(value) <= width + 1e-5 * size))


def _too_short(spectrum: LyapunovSpectrum, i: int) -> str:
    growth = spectrum.runs[i].growth[:, 0]
    words = f"{len(growth)} periods are too few to average over"
    if len(growth) < 4:
        return f"{words}; {FIRST} periods decide most motions"
    needed = int(np.clip((4 * growth.std() / max(abs(growth.mean()), 1e-300)) ** 2, FEWEST, 1e7))
    return f"{words}; by the scatter of what they show, about {max(needed, FEWEST_FOR_TEST)} periods would decide"


def _growing(system: System, states: Array, running: dict[int, float], turning: Array) -> Witness | None:
    """What a motion is whose ``states`` (m, n), modulo its turns, grow; None where none does.

    Clocks and angles grow by themselves. Where a state runs on and no rate grows with it, it may be an angle whose turn
    was not found.
    """
    alone = turning[np.count_nonzero(turning, axis=1) == 1]
    free = [j for j in range(system.size) if j not in running and not alone[:, j].any()]
    if len(states) < 4 * BLOCKS or not free:
        return None
    scale, length = np.asarray(system.scale), len(states) // BLOCKS
    blocks = states[len(states) - BLOCKS * length :].reshape(BLOCKS, length, -1)
    which = _rising(np.abs(blocks).max(axis=1)[:, free], scale[free])
    if not which.any():
        return None
    few = blocks[:, :: max(length // LOOKED_AT, 1)]
    rates = np.array([[_largest_rates(system, x) for x in block] for block in few]).max(axis=1)
    if _rising(rates, np.zeros(system.size)).any():
        reason = "the largest state rises from block to block of the run and does not stop"
        return Witness(None, None, ChaosVerdict.UNBOUNDED, "", (reason,))
    names = ", ".join(system.states[free[k]] for k in np.flatnonzero(which))
    reason = (
        f"{names} runs on while no rate grows, and nothing was found that repeats in it: if it is an angle, count it "
        "in radians"
    )
    return Witness(None, None, ChaosVerdict.UNDECIDED, "", (reason,))


def _rising(largest: Array, least: Array) -> Flags:
    """Which of the largest values (blocks, n) rise from block to block, by GROWN in all and beyond ``least`` (n,)."""
    rises = np.all(np.diff(largest, axis=0) > 0, axis=0)
    return np.asarray(rises & (largest[-1] > GROWN * largest[0]) & (largest[-1] > least))


def _largest_rates(system: System, state: Array) -> Array:
    rates = [system.rate_at(t, state, system.regime_at(t, state)) for t in phases(system)]
    return np.asarray(np.abs(rates).max(axis=0))


def _map(
    system: System, spectrum: LyapunovSpectrum, i: int, section: Event | None, points: int, running: dict[int, float],
    turning: Array, size: Array,
) -> PoincareMap:  # fmt: skip
    run = spectrum.runs[i]
    if section is None and system.forcing_period is not None:
        kept = run.states[-points:]
        words = f"every forcing period of {spectrum.interval:.6g} s"
        count = spectrum.transient + len(run.states) - len(kept)
        outcome = Outcome(True, "reached", f"{len(kept)} points after {count} left out")
        time = np.asarray(spectrum.interval * np.arange(len(kept)), dtype=float)
        return PoincareMap(system, kept, time, size, turning, words, count, spectrum.tolerance, outcome)
    if section is None and running:
        every = 2 * np.pi / abs(next(iter(running.values())))
        return poincare_map(
            system, points, every=every, start=run.states[-1], transient=0, tolerance=spectrum.tolerance
        )
    if section is None:
        section = usual_section(system, run.states, turning)
    longest = max(len(run.growth) * spectrum.interval, 100 * spectrum.interval)
    return poincare_map(
        system, min(points, max(len(run.growth) // 2, 1)), section=section, start=run.states[-1], transient=0,
        longest=longest, tolerance=spectrum.tolerance,
    )  # fmt: skip


def _test(system: System, mapped: PoincareMap, free: list[int], turning: Array) -> ZeroOne | None:
    """The test on the state that moves most over its scale; of an angle its sine."""
    if len(mapped.points) < FEWEST_FOR_TEST:
        return None
    points = mapped.points[-POINTS:]
    turn = {j: turn_of(j, turning) for j in free}
    columns = {j: np.sin(2 * np.pi / turn[j] * points[:, j]) if turn[j] else points[:, j] for j in free}
    scales = {j: 1.0 if turn[j] else float(np.asarray(system.scale)[j]) for j in free}
    best = max(free, key=lambda j: float(np.ptp(columns[j])) / (scales[j] + float(np.abs(columns[j]).max())))
    return zero_one_test(columns[best], scale=max(scales[best], float(mapped.size[best])) * 1e-2)


def _period(mapped: PoincareMap | None, repeat: int) -> float:
    if mapped is None or repeat == 0 or len(mapped.time) <= repeat:
        return float("nan")
    return float(mapped.time[-1] - mapped.time[-1 - repeat])
