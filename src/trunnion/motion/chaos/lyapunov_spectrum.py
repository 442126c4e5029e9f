"""Lyapunov exponents from the variational equations: how fast neighbouring motions part.

An orthonormal frame of tangent vectors is carried along the motion by v̇ = (∂f/∂x) v and orthonormalised every
few steps; with r_ij the logarithm by which its j-th vector has grown over sample i of length Δt,

    L_j = lim (1/(N Δt)) Σ_i r_ij        [1/s], natural logarithm

(Benettin, Galgani, Giorgilli, Strelcyn 1980). Their sum is the mean divergence of the flow, exactly:

    Σ_j L_j = ⟨tr ∂f/∂x⟩.

A forced system is counted without its phase; with the phase as a state it has one exponent more, which is 0.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextvars import copy_context
from dataclasses import dataclass, replace
from itertools import repeat

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.errors import InputError
from trunnion.motion.chaos.chaos_subject import (
    as_system,
    clocks,
    failure,
    first_starts,
    tilted_frame,
    usual_time,
    whole_number,
)
from trunnion.numerics.averages import BATCHES, CONFIDENCE, average, batch_means, pooled
from trunnion.numerics.integration.integration import IntegrationEnd
from trunnion.numerics.integration.tangents import Motion, Samples
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, computed, internal, labelled, variable
from trunnion.results.of_systems import about
from trunnion.results.outcome import Outcome
from trunnion.results.result import Result
from trunnion.results.variables import Attribute, Coordinate, Variable, attributes
from trunnion.systems.maps import TimedMap
from trunnion.systems.system import System
from trunnion.waiting import time_is_up

HISTORY = 400
"""Points of a history of convergence."""
PRECISION = 0.018
"""Width of the interval of the largest exponent over its size at which the default effort is content."""
FIRST, LAST = 4096, 131072
"""Samples with which the default effort begins, and after which it gives up."""
REGULAR, RESOLVED = 2e-6, 1e-3
"""Width of an interval over the largest exponent in size with which the default effort is content where the
largest is not positive, and with which it makes do in the end."""
OTHERS = 10.0
"""How much wider than that the intervals of the other exponents may be."""
SLOW = 1e-3
"""Growth per sample below which all exponents count as this large when widths are compared to them."""
LEFT_OUT = 10
"""The default effort leaves out one in so many samples at the beginning, besides the transient."""
REPORTED = 2048
"""Samples after which the share done is reported."""
MOST = 10_000_000
"""Samples that fit into memory."""
DWARFED, MISSED = 10.0, 0.01
"""Half-width, and error of the sum, over the largest exponent in size, above which nothing has converged."""
FEWEST = 4 * BATCHES
"""Samples below which batch means say nothing."""
ROUNDING = 0.01
"""Error per sample over the tolerance, below which no interval goes: errors of steps mostly cancel."""


def shear_bound(samples: int, interval: float) -> float:
    """Twice ln N / T [1/s], N samples in time T: neighbours of a regular motion part in proportion to time where their
    frequencies differ, so that for so long they seem to part at the rate ln t / t."""
    return 2 * float(np.log(max(samples, 2))) / (max(samples, 1) * interval)


@dataclass(frozen=True)
class Run:
    """One motion: growth (samples, k) of its frame, ∫ tr ∂f/∂x dt (samples,) where it was needed, states
    (1 + samples, n) before, between and after the samples, how it ended, samples wanted."""

    growth: Array
    divergence: Array
    states: Array
    end: IntegrationEnd
    wanted: int


@labelled
class LyapunovSpectrum(Result):
    """Exponents of a system's motion, the largest first.

    Half-widths are never less than the error of the sum, nor than ``shear`` where exponents lie together at 0.
    """

    system: System = internal("that was followed")
    exponents: Array = variable("order", "1/s", "natural logarithm, of all starts together", name="exponent")
    half_width: Array = variable("order", "1/s", "of their intervals of confidence (95 %)")
    starts: Array = variable("start state", "", "where the motions begin", name="start_state")
    by_start: Array = variable("start order", "1/s", "exponents of each motion", name="exponent_of_start")
    by_start_half_width: Array = variable("start order", "1/s", "of their intervals", name="half_width_of_start")
    divergence: float = internal(
        "what the sum must be; NaN where not all exponents were asked for, or the motion jumps", "1/s"
    )
    interval: float = attribute("of a sample", "s")
    transient: int = attribute("periods or samples left out before")
    runs: tuple[Run, ...] = internal("one motion each")
    tolerance: float = attribute("error allowed per step")
    windowed: bool = internal("averaged with a smooth window, see ``numerics.averages``")
    outcome: Outcome = internal("how it ended")

    @property
    def largest(self) -> float:
        """The largest exponent [1/s]."""
        return float(self.exponents[0])

    @property
    @computed(attribute())
    def sum(self) -> float:
        """Sum of the exponents [1/s]."""
        return float(self.exponents.sum())

    @property
    def sum_error(self) -> float:
        """How far the sum is from the mean divergence [1/s]; NaN where that is not known."""
        return abs(self.sum - self.divergence)

    @property
    @computed(attribute())
    def samples(self) -> int:
        """Samples of the shortest run."""
        return min(len(run.growth) for run in self.runs)

    @property
    def positive(self) -> bool:
        """Whether the largest exponent is above 0 by more than its interval, and above what shear alone may show."""
        return bool(self.exponents[0] > max(self.half_width[0], self.shear))

    @property
    def shear(self) -> float:
        """What the largest exponent of a regular motion may seem to be [1/s] after so long; see ``shear_bound``."""
        return shear_bound(self.samples, self.interval)

    @property
    def agree(self) -> bool:
        """Whether every start gives the same exponents, to three times their intervals.

        A difference below 1e-4 of the largest exponent in size is none.
        """
        low = float(np.nanmax(np.abs(self.exponents), initial=0.0)) * 1e-4
        apart = np.abs(self.by_start - np.nanmean(self.by_start, axis=0)) if len(self.by_start) > 1 else np.zeros(1)
        allowed = 3 * self.by_start_half_width + low if len(self.by_start) > 1 else np.ones(1)
        return not bool(np.any(apart > allowed))

    @property
    def dimension(self) -> float:
        """Kaplan–Yorke dimension of the attractor, a forced system's phase not counted; NaN if not all exponents
        were asked for, or volumes do not shrink."""
        if len(self.exponents) < self.system.size:
            return float("nan")
        total = np.cumsum(self.exponents)
        if total[-1] >= 0:
            return float(self.system.size) if total[-1] <= self.half_width.sum() else float("nan")
        k = int(np.argmax(total < 0))
        return float(k + (total[k - 1] if k else 0.0) / -self.exponents[k])

    @property
    def histories(self) -> tuple[Array, Array]:
        """Times (points,) [s] and running means (starts, points, k) of the exponents up to each."""
        samples = self.samples
        if samples == 0:
            return np.empty(0), np.empty((len(self.runs), 0, len(self.exponents)))
        places = np.unique(np.geomspace(1, samples, HISTORY).astype(int))
        means = [
            np.cumsum(r.growth[:samples], axis=0)[places - 1] / (places[:, None] * self.interval) for r in self.runs
        ]
        return places * self.interval, np.array(means)

    def declared(self) -> Iterator[Variable | Attribute]:
        """What the fields hold, running means over time, the sum rule, and the system."""
        yield from super().declared()
        time, history = self.histories
        yield Coordinate("order", np.arange(1, len(self.exponents) + 1), "order")
        yield Coordinate("time", time, "time", "s")
        yield Coordinate("state", self.system.states, "state")
        yield Variable("running_mean", history, "start time order", "1/s")
        if not np.isnan(self.divergence):
            yield from attributes(divergence=self.divergence, sum_error=self.sum_error)
        yield from attributes(confidence=CONFIDENCE, averaging="windowed" if self.windowed else "plain")
        yield from about(self.system, self.outcome)

    def plot(self, axes: Axes | None = None) -> Axes:
        """Running means of the exponents over time."""
        return drawing(self, "plot")(self, axes)

    def __str__(self) -> str:
        unit = "forcing period" if self.system.forcing_period is not None else "sample"
        head = (
            f"Lyapunov exponents of {self.system.name}, natural logarithm, {len(self.runs)} × {self.samples} "
            f"{unit}s of {self.interval:.6g} s after {self.transient}"
        )
        rows = [
            f"  L{i} = {value:+.6g} ± {width:.2g} 1/s"
            for i, (value, width) in enumerate(zip(self.exponents, self.half_width, strict=True), start=1)
        ]
        rule = "not checked" if np.isnan(self.divergence) else f"{self.divergence:.10g}, off by {self.sum_error:.1e}"
        rows.append(f"  sum {self.sum:.10g} 1/s (mean divergence: {rule})")
        if np.isfinite(self.dimension) and self.outcome.ok:
            rows.append(f"  Kaplan–Yorke dimension {self.dimension:.4g}")
        return "\n".join([head, *rows, f"  {self.outcome}"])


def lyapunov_spectrum(
    subject: System | Driveline,
    periods: int | None = None,
    *,
    duration: float | None = None,
    speed: float | str | None = None,
    start: ArrayLike | None = None,
    starts: int = 2,
    exponents: int | None = None,
    transient: int | None = None,
    precision: float = PRECISION,
    tolerance: float = 1e-10,
    progress: Callable[[float], None] | None = None,
) -> LyapunovSpectrum:
    """Lyapunov exponents of a motion, each with its interval of confidence.

    Parameters
    ----------
    subject : a ``System``, or a ``Driveline`` at ``speed``.
    periods : forcing periods to average over. By default as many as it takes to know the largest exponent to
        ``precision``, from 4096 to 131072.
    duration : instead of ``periods`` [s].
    speed : input speed of a driveline [rad/s], by default its operating speed.
    start : a state (n,), or several (starts, n); by default the system's own and neighbours of it.
    starts : how many motions to follow, in parallel; they are compared.
    exponents : how many, the largest first; by default all.
    transient : periods to let pass before averaging; by default 500.
    precision : width of the interval of the largest exponent over its size, to reach where neither ``periods`` nor
        ``duration`` is given.
    tolerance : error allowed per step.
    progress : called as progress(share done).

    Returns
    -------
    LyapunovSpectrum: ``exponents`` and ``half_width`` [1/s], ``sum`` beside ``divergence``, what each start gave, the
    history of convergence, and an ``outcome``.

    Raises
    ------
    InputError : no start, a wrong count or duration, both ``periods`` and ``duration``, periods of an autonomous
        system.

    Examples
    --------
    A damped motion that settles: both exponents are half of minus the damping, 0.05.

    >>> import trunnion as tn
    >>> duffing = tn.reference_system("duffing")
    >>> found = tn.lyapunov_spectrum(duffing, 200, starts=1)
    >>> found.exponents.round(3), round(float(found.sum), 6)
    (array([-0.025, -0.025]), -0.05)
    """
    system = as_system(subject, speed)
    count = whole_number("exponents", system.size if exponents is None else exponents, 1, system.size)
    skipped = whole_number("transient", 500 if transient is None else transient, 0)
    _check(precision, tolerance)
    states = first_starts(system, start, whole_number("starts", starts, 1))
    asked, interval = _effort(system, states[0], periods, duration, tolerance)
    motions = [_motion(system, x, count, interval, tolerance) for x in states]
    traced = count == system.size and system.divergence is None
    report_progress = progress or (lambda share: None)

    with ThreadPoolExecutor(len(motions) if system.compiled else 1) as pool:
        waiting = [pool.submit(copy_context().run, motion.run, skipped) for motion in motions]
        early = [one.result() for one in waiting]
        if any(e.end is not IntegrationEnd.REACHED for e in early):
            # What does not outlive its transient is measured from the start.
            skipped, motions = 0, [_motion(system, x, count, interval, tolerance) for x in states]
            early = [m.run(0) for m in motions]
        runs = [_begun(s, count) for s in early]
        total, ended = asked or FIRST, ""
        while True:
            more = total - runs[0].wanted
            for part in _parts(more):
                if ended := time_is_up():
                    break
                runs = list(pool.map(_carry_on, motions, runs, repeat(part), repeat(traced)))
                report_progress(runs[0].wanted / (asked or LAST))
            whole = all(r.end is IntegrationEnd.REACHED for r in runs)
            late = 0 if asked or ended or not whole else total // LEFT_OUT
            result = _result(
                system, states, [_later(r, late) for r in runs], interval, skipped + late, tolerance, count
            )
            if asked or ended or not whole or total >= LAST or _known(result, precision):
                break
            total = min(LAST, int(total * _more(result, precision)))
    outcome = _outcome(system, motions, result, runs, precision if asked is None and not ended else None)
    if ended:
        outcome = replace(outcome, sentence=f"{outcome.sentence}; {ended} after {len(runs[0].growth)} samples")
    return replace(result, outcome=outcome)


def _check(precision: float, tolerance: float) -> None:
    for key, value, low, high in (("precision", precision, 1e-6, 1.0), ("tolerance", tolerance, 1e-14, 1e-3)):
        if not (np.isfinite(value) and low <= value <= high):
            raise InputError(f"must lie between {low:g} and {high:g}", key=key, value=value)


def _effort(
    system: System, state: Array, periods: int | None, duration: float | None, tolerance: float
) -> tuple[int | None, float]:
    """Samples asked for, and the length of one [s]: a forcing period, or some steps of the integrator."""
    period = system.forcing_period
    if periods is not None and duration is not None:
        raise InputError("and duration are two ways to say one thing", key="periods", remedy="leave one out")
    if periods is not None and period is None:
        raise InputError(
            "has no meaning for an autonomous system", element=system.name, key="periods", value=periods,
            remedy="give a duration",
        )  # fmt: skip
    if duration is not None and not (np.isfinite(duration) and duration > 0):
        raise InputError("must be a positive time", key="duration", value=duration)
    interval = period if period is not None else _interval(system, state, tolerance)
    if periods is not None:
        return whole_number("periods", periods, 1, MOST), interval
    if duration is None:
        return None, interval
    if duration > MOST * interval:
        raise InputError(f"makes more than {MOST} samples of {interval:.3g} s", key="duration", value=duration)
    return max(int(round(duration / interval)), 1), interval


def _interval(system: System, state: Array, tolerance: float) -> float:
    """Of an autonomous system: a turn of a phase among its states, or about a turn of the motion."""
    rates = clocks(system, state[None])
    return 2 * np.pi / max(map(abs, rates.values())) if rates else usual_time(system, state, tolerance)


def _motion(system: System, state: Array, count: int, interval: float, tolerance: float) -> Motion:
    return TimedMap.over(system, interval, tolerance=tolerance).motion(state, tilted_frame(system, count))


def _begun(early: Samples, count: int) -> Run:
    return Run(np.empty((0, count)), np.empty(0), early.states[-1:], early.end, 0)  # the first state, if any


def _carry_on(motion: Motion, run: Run, samples: int, traced: bool) -> Run:
    if run.end is not IntegrationEnd.REACHED:
        return run
    more = motion.run(samples, traced=traced)
    return Run(
        np.concatenate([run.growth, more.growth]), np.concatenate([run.divergence, more.divergence]),
        np.concatenate([run.states, more.states]), more.end, run.wanted + samples,
    )  # fmt: skip


def _parts(samples: int) -> list[int]:
    """Samples in parts, between which the share done is reported."""
    return [min(REPORTED, samples - i) for i in range(0, samples, REPORTED)]


def _later(run: Run, first: int) -> Run:
    return replace(run, growth=run.growth[first:], divergence=run.divergence[first:], states=run.states[first:])


def _result(
    system: System, states: Array, runs: list[Run], interval: float, skipped: int, tolerance: float, count: int
) -> LyapunovSpectrum:
    averages = [average(r.growth / interval) for r in runs]
    windowed = all(a.windowed for a in averages)
    batches = [batch_means(r.growth / interval, BATCHES, windowed) for r in runs]
    each = [pooled(b, windowed) for b in batches]
    whole = pooled(np.concatenate(batches), windowed) if any(len(b) for b in batches) else None
    blank = np.full(count, np.nan)
    mean = whole.mean if whole else blank
    divergence = _divergence(system, runs, interval, windowed) if count == system.size else np.nan
    total = float(mean.sum())
    error = np.fmax(2 * abs(total - divergence), ROUNDING * tolerance / interval)
    width = np.fmax(whole.half_width, error) if whole else blank
    # The frame's order is that of growth only in the limit; equal exponents may come out exchanged.
    order = np.argsort(-mean, kind="stable")
    bound = shear_bound(min(len(r.growth) for r in runs), interval)
    width[order] = np.fmax(width[order], _sheared(mean[order], bound))
    return LyapunovSpectrum(
        system=system,
        exponents=mean[order],
        half_width=width[order],
        starts=states,
        by_start=np.array([a.mean[order] if len(b) else blank for a, b in zip(each, batches, strict=True)]),
        by_start_half_width=np.array(
            [
                np.fmax(a.half_width[order], _sheared(a.mean[order], bound)) if len(b) else blank
                for a, b in zip(each, batches, strict=True)
            ]
        ),
        divergence=divergence,
        interval=interval,
        transient=skipped,
        runs=tuple(replace(r, growth=r.growth[:, order]) for r in runs),
        tolerance=tolerance,
        windowed=windowed,
        outcome=Outcome(True, "running", ""),
    )


def _sheared(exponents: Array, bound: float) -> Array:
    """Half-widths (k,) of exponents that may all be 0 and only seem to part: pairs within the bound of each other."""
    near = np.abs(exponents) <= bound
    apart = np.abs(exponents[:, None] - exponents[None, :]) <= 2 * bound
    np.fill_diagonal(apart, False)
    paired = near & (apart & near[None, :]).any(axis=1)
    return np.where(paired, bound, 0.0)


def _divergence(system: System, runs: list[Run], interval: float, windowed: bool) -> float:
    """Mean divergence along the motions, averaged by the same weights as the exponents; NaN with jumps, which
    change volumes besides."""
    if system.regimes is not None and system.equations.jump:
        return float("nan")
    if system.divergence is not None:
        return float(system.divergence(system.parameters) if callable(system.divergence) else system.divergence)
    parts = [batch_means(r.divergence[:, None] / interval, BATCHES, windowed) for r in runs if len(r.growth)]
    return float(np.concatenate(parts).mean()) if parts else float("nan")


def _size(result: LyapunovSpectrum) -> float:
    return max(float(np.max(np.abs(result.exponents))), SLOW / result.interval)


def _known(result: LyapunovSpectrum, precision: float, regular: float = REGULAR) -> bool:
    """Whether a positive exponent is known to ``precision``, or one that is not is well resolved."""
    width, widest = 2 * result.half_width[0], 2 * float(np.max(result.half_width))
    floor = 2 * result.shear if regular >= RESOLVED else 0.0  # in the end: no average knows more of shear
    resolved = width <= max(regular * _size(result), floor) and widest <= max(OTHERS * regular * _size(result), floor)
    return bool((result.positive and width <= precision * result.largest) or resolved)


def _more(result: LyapunovSpectrum, precision: float) -> float:
    """By how much to lengthen the average: the error of a chaotic one falls with the root of its length."""
    if not result.positive:
        return 2.0
    return float(np.clip(1.1 * (2 * result.half_width[0] / (precision * result.largest)) ** 2, 1.3, 4.0))


def _outcome(
    system: System, motions: list[Motion], result: LyapunovSpectrum, runs: list[Run], precision: float | None
) -> Outcome:
    failed = next((i for i, r in enumerate(runs) if r.end is not IntegrationEnd.REACHED), None)
    if failed is not None:
        return failure(
            system,
            motions[failed],
            2 * result.interval,
            f"after {len(runs[failed].growth)} samples, time counted from there: ",
        )
    samples = len(runs[0].growth)
    if samples < FEWEST:
        return Outcome(
            False, "too short",
            f"{samples} samples are too few for an interval of confidence; average over {FEWEST} periods at least",
        )  # fmt: skip
    if not result.agree:
        return Outcome(
            True, "starts differ",
            "the starts lead to motions with different exponents: several attractors, or one that takes longer to "
            "be seen whole; look at by_start",
        )  # fmt: skip
    if result.sum_error > MISSED * _size(result):
        return Outcome(
            False, "not converged",
            f"the exponents add up to {result.sum:.4g} 1/s where the mean divergence is {result.divergence:.4g} 1/s: "
            "the tangents were not resolved; give a jacobian, or a smaller tolerance",
        )  # fmt: skip
    if result.half_width[0] > DWARFED * _size(result):
        return Outcome(
            False, "not converged",
            f"after {samples} samples the interval of the largest exponent is ± {result.half_width[0]:.2g} 1/s, larger "
            "than any exponent; average over more periods",
        )  # fmt: skip
    width, largest = 2 * result.half_width[0], abs(result.exponents[0])
    if precision is not None and not _known(result, precision, RESOLVED):
        return Outcome(
            False, "not converged",
            f"after {samples} samples the interval of the largest exponent is {width:.2g} 1/s wide, "
            f"{100 * width / max(largest, 1e-300):.2g} % of it; give more periods, or accept a larger precision",
        )  # fmt: skip
    return Outcome(True, "converged", f"averaged over {len(runs)} × {samples} samples of {result.interval:.6g} s")
