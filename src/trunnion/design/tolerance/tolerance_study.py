"""How probable it is that a line within its tolerances is stable, by quasi-Monte Carlo, and what its worst corner is.

Points are scrambled Sobol sequences, in several independent scrambles: each gives an estimate of its own, and their
scatter the interval. Where every scramble gives the same share, none or all, the interval comes from the count alone
(Clopper and Pearson), which is wider than need be.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Codes
from trunnion.design.tolerance.checks import CheckStudy, study_checks
from trunnion.driveline.arguments import one_number, speeds_of, whole_number
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import operating_speed, speed_unit
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.errors import InputError
from trunnion.features import left_out
from trunnion.floquet.charts.chart_pixels import Pixels
from trunnion.floquet.tolerance.many_lines import FIRST, UNKNOWN, ManyLines
from trunnion.floquet.tolerance.sampling import SCRAMBLES, interval, sobol
from trunnion.floquet.tolerance.spread import (
    ZERO,
    Spread,
    Tolerances,
    numbers_at,
    read_tolerances,
    tables,
    values_in_words,
)
from trunnion.floquet.tolerance.steady_state_lines import SteadyStateLines, lines_like
from trunnion.numerics.workers import Workers, workers_of_client
from trunnion.results.chart import require_pixels
from trunnion.results.counts import counted
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, coordinate, internal, labelled, variable
from trunnion.results.finding import Finding, Gravity
from trunnion.results.result import Result
from trunnion.results.variables import Attribute, Coordinate, Variable, attributes
from trunnion.results.verdict import Verdict
from trunnion.waiting import OutOfTime, keep_time, keeps_time, limited, time_is_up, to_the_end

TOLERANCE = 1e-8
"""Error asked of monodromy matrices: radii within it of 1 count as undecided."""
GROWTH = "of every sample; where the radius is smaller than its error that of the error; NaN where it is not known"
RANKING = "parameters by the share of the scatter of the growth rate, where it is fastest, that each explains alone"
CLIMBS = 6
"""Steps of the search for the worst corner."""
STEP = 1e-4
"""Of differences, as a share of a tolerance."""
PARTS = np.array([0.01, 0.03, 0.1, 0.25, 0.5, 1.0])
"""Of the way to the corner, near ones first: where the motion is not known it is followed from the one before."""
STEPS_ASIDE, FARTHEST, NEAREST, DIRECTIONS = 24, 0.25, 1e-3, 16
"""Steps along single tolerances and in directions drawn by lot; shares of tolerances, halved where none leads on."""
STARTS, CLOSER, APART = 4, 2, 0.25
"""Samples from which a search for the fastest line begins, how many of the lines found it looks about more closely, and
the share of a tolerance by which the samples differ."""
WAY = 9
"""Lines between the middle of the tolerances and a line whose motion may have to be followed from there."""
BINS = 32
"""Classes of a parameter between which the mean growth rate is compared."""


@dataclass(frozen=True)
class Worst:
    """The line of fastest growth found within the tolerances: values by parameter, speed, growth rate, verdict; how
    many samples the search began at, and how many lines it looked at."""

    values: dict[str, float]
    speed: float
    growth_rate: float
    verdict: Verdict
    starts: int = 0
    looked: int = 0


@labelled
class ToleranceStudy(Result):
    """Probability that a line within its tolerances is stable at all speeds; undecided lines count as unstable."""

    parameters: tuple[str, ...] = coordinate("parameter")
    low: Array = variable("parameter")
    high: Array = variable("parameter")
    speeds: Array = coordinate("speed", "rad/s")
    samples: int = attribute("lines in all")
    probability: float = attribute("share of stable lines")
    interval: tuple[float, float] = attribute("of the probability")
    confidence: float = attribute("of the interval")
    undecided: float = attribute("share of lines whose radius is 1 to within its error")
    stable_share: Array = variable("speed", "1")
    growth_rate: Array = internal(GROWTH, "1/s", "speed sample")
    worst: Worst = internal("by a search from the fastest samples")
    ranking: tuple[tuple[str, float], ...] = internal(RANKING)
    unit: str = internal("of speeds in print")
    findings: tuple[Finding, ...] = internal("what was left out", default=())
    checks: CheckStudy | None = internal("the same for the checks of ``assess``, if asked for", default=None)
    ended: str = attribute("what ended the study before it was done, as a clause", default="")
    about_steady_state: bool = attribute("whether about each line's own periodic motion", default=False)

    def declared(self) -> Iterator[Variable | Attribute]:
        """Tolerances with their ranking, shares over speed, the worst line."""
        yield from super().declared()
        rank, worst = dict(self.ranking), self.worst
        yield Variable("explained", np.array([rank[p] for p in self.parameters]), "parameter", "1")
        yield Variable("worst", np.array([worst.values[p] for p in self.parameters]), "parameter")
        yield Coordinate("quantile", np.array(QUANTILES), "quantile", "1")
        growth = np.nanquantile(self.growth_rate, QUANTILES, axis=1).T
        yield Variable("growth_rate", growth, "speed quantile", "1/s")
        yield from attributes(worst_speed=worst.speed, worst_growth_rate=worst.growth_rate, worst_verdict=worst.verdict)
        if self.checks is not None:
            yield from self.checks.declared()

    def plot(self, axes: Axes | None = None) -> Axes:
        """The growth rate's distribution, and the parameters by rank; see ``pictures.design.tolerance``."""
        return drawing(self, "plot")(self, axes)

    def _lines(self) -> Iterator[str]:
        low, high = self.interval
        several = f"at {len(self.speeds)} speeds"
        yield (
            f"stable {several if len(self.speeds) > 1 else f'at {self.words.speed(float(self.speeds[0]))}'} "
            f"with probability {self.probability:.5g}, {100 * self.confidence:g} % interval "
            f"[{low:.5g}, {high:.5g}], from {self.samples} lines within {len(self.parameters)} tolerances"
            f"{f'; {self.ended}, which left out the rest' if self.ended else ''}"
        )
        if self.about_steady_state:
            yield "  each line is judged about its own periodic motion, without its excitations"
        yield (
            f"  worst line found, searched from {counted(self.worst.starts, 'sample')} over {self.worst.looked} lines "
            f"more: {self.worst.verdict}, "
            f"{'grows' if self.worst.growth_rate > 0 else 'decays'} by {abs(self.worst.growth_rate):.4g} 1/s at "
            f"{self.words.speed(self.worst.speed)}, with {values_in_words(self.worst.values)}"
        )
        yield "  what matters: " + ", ".join(f"{name} {100 * share:.0f} %" for name, share in self.ranking[:5])
        if self.undecided:
            yield (
                f"  {100 * self.undecided:.3g} % of the lines are undecided, within their error of the boundary, and "
                "count as not stable"
            )
        if self.checks is not None:
            yield str(self.checks)


QUANTILES = (0.0, 0.05, 0.5, 0.95, 1.0)


@keeps_time
def tolerance_study(
    line: Driveline | Assembly,
    tolerances: Tolerances | None = None,
    speeds: ArrayLike | None = None,
    *,
    checks: bool | int = False,
    samples: int = 1 << 14,
    confidence: float = 0.95,
    seed: int = 0,
    statically_twisted: bool = True,
    about_steady_state: bool = False,
    threads: int | None = None,
    client: Any = None,
    within: float | None = None,
    progress: Callable[[float], None] | None = None,
) -> ToleranceStudy:
    """The probability that a line within its tolerances is stable at every one of ``speeds`` [rad/s].

    Parameters
    ----------
    line : a ``Driveline`` or its ``Assembly``.
    tolerances : parameter path → 0.1 (uniform within ±10 %), ("range", low, high) in SI units, or ("normal", 0.03)
        (standard deviation as a share, cut at three of them), ("deviation", 0.01) in SI units; by default those that
        the description states.
    speeds : one speed or several, by default the operating speed of the description; a range is as dense as these are.
    checks : also judges lines by ``assess``, from the lowest to the highest of the speeds: True for as many as half a
        minute allows, or how many (rounded up to 16 powers of two, 64 to 4096).
    samples : lines in all, rounded up to 16 powers of two.
    confidence : of the interval of the probability.
    seed : of the scrambles; the same seed gives the same numbers.
    statically_twisted : as in ``stability``.
    about_steady_state : each line about its own periodic motion, as in ``stability_chart``; the checks judge as
        ``assess`` does, whatever this says.
    threads : default one per core.
    client : a ``distributed.Client``, whose workers judge the same lines instead, in pieces of 32 768 lines at one
        speed and of one line by the checks; lines about their own motion are judged here.
    within : seconds that it may take; the lines judged until then are counted, and ``ended`` says so.
    progress : called as progress(share done).

    Raises
    ------
    InputError : see ``read_tolerances`` and ``stability_chart``; speeds that are not positive; fewer than 256 samples.

    Examples
    --------
    >>> import trunnion as tn
    >>> line = tn.catalogue("two-shaft-cardan")
    >>> tn.tolerance_study(line, {"Shaft *.stiffness": 0.1}, [1.6], samples=256)
    <ToleranceStudy: stable at 1.6 rad/s with probability 0.71484, 95 % interval [0.68513, 0.74455], from 256 lines
      within 2 tolerances>
    """
    description = line.line if isinstance(line, Assembly) else line
    at = speeds_of(operating_speed(description, None) if speeds is None else speeds, "tn.rpm(1500)")
    if not np.all(np.isfinite(at)) or not np.all(at > 0):
        raise InputError("must be positive numbers", key="speeds", value=speeds, remedy="tn.rpm(1500)")
    samples, seed = whole_number(samples, "samples", 256), whole_number(seed, "seed", 0)
    if not isinstance(checks, bool | int | np.integer) or checks < 0:
        raise InputError("must be True, False or a number of lines", key="checks", value=checks)
    if not 0.5 <= one_number(confidence, "confidence", "0.95, say") < 1:
        raise InputError("must lie between 0.5 and 1", key="confidence", value=confidence, remedy="0.95, say")
    assembly, spreads, taken = _read(line, tolerances)
    each = 1 << int(np.ceil(np.log2(samples / SCRAMBLES)))
    require_pixels(each * SCRAMBLES, len(at))
    workers = workers_of_client(client)
    lines = lines_like(
        assembly,
        tables(assembly, spreads, np.array([[0.5], [0.0], [1.0]]) + np.zeros(len(spreads)), float(at[0])),
        statically_twisted, threads or os.cpu_count() or 1, about_steady_state=about_steady_state,
    )  # fmt: skip
    shares = sobol(len(spreads), each, seed)
    report_progress = progress or (lambda share: None)
    growth, verdict, ended = _judged(
        lines, spreads, shares, at, report_progress, None if isinstance(lines, SteadyStateLines) else workers
    )
    shares = shares[: growth.shape[1]]
    fine = np.isin(verdict, (Verdict.STABLE, Verdict.MARGINAL))
    stable, at_each = fine.all(axis=0), fine.mean(axis=1)
    undecided = np.any(~fine & (verdict != Verdict.UNSTABLE), axis=0)
    judged = None
    if checks and not ended:
        count = None if checks is True else int(checks)
        try:
            judged = study_checks(
                assembly, spreads, (float(at.min()), float(at.max())), count, confidence, seed, report_progress, workers
            )
            ended = judged.ended
        except OutOfTime as error:
            ended = error.why
    probability = float(stable.mean())
    fastest = int(np.nanmax(growth, axis=1).argmax())
    return ToleranceStudy(
        parameters=tuple(s.label for s in spreads), low=np.array([s.low for s in spreads]),
        high=np.array([s.high for s in spreads]), speeds=at, samples=len(shares), probability=probability,
        interval=interval(stable.reshape(-1, each), confidence), confidence=confidence,
        undecided=float(undecided.mean()), stable_share=at_each, growth_rate=growth,
        worst=_worst(lines, spreads, shares, growth, at), ranking=_ranking(spreads, shares, growth[fastest]),
        unit=speed_unit(assembly.line), findings=(*taken, *left_out("tolerance_study", assembly.line)), checks=judged,
        ended=ended, about_steady_state=isinstance(lines, SteadyStateLines),
    )  # fmt: skip


def _read(
    line: Driveline | Assembly, tolerances: Tolerances | None
) -> tuple[Assembly, tuple[Spread, ...], tuple[Finding, ...]]:
    """The line and what scatters. A share of a load that load cases alone state is one of the case that loads the line
    most, under which the line then is, as a finding says."""
    assembly = assemble(line)
    try:
        return assembly, read_tolerances(assembly, tolerances), ()
    except InputError as error:
        name, _, key = error.key.rpartition(".")
        operation = assembly.line.operation
        cases = [case.name for case in (operation.load_cases if operation else ()) if case.loads.get(name)]
        if error.problem != ZERO or key != "load_torque" or not cases:
            raise
        path = error.key
    loaded = {case: assemble(assembly.line.with_load(case)) for case in cases}
    most = max(cases, key=lambda case: abs(loaded[case].packed.value(path)))
    said = f"{path} is 0 as stated: the line is studied under load case {most}, where it is largest"
    assembly = loaded[most]
    return assembly, read_tolerances(assembly, tolerances), (Finding(Gravity.NOTE, f"{said}."),)


def _judged(
    lines: ManyLines,
    spreads: tuple[Spread, ...],
    shares: Array,
    speeds: Array,
    report_progress: Callable[[float], None],
    workers: Workers | None,
) -> tuple[Array, Codes, str]:
    """Growth rates and verdicts (speeds, samples) of all lines, or of as many scrambles as a time limit allows, and
    what ended it then, as a clause.

    Raises
    ------
    OutOfTime : the time was up before two scrambles, whose scatter is the interval, were judged.
    """
    each = len(shares) // SCRAMBLES
    size = each if limited() else len(shares)
    growth, verdict = np.empty((len(speeds), len(shares))), np.empty((len(speeds), len(shares)), dtype=np.int8)
    for speed in speeds.tolist():
        _require_known(lines.judged(tables(lines.assembly, spreads, shares[:FIRST], speed), TOLERANCE), speed)
    for first in range(0, len(shares), size):
        here = slice(first, first + size)
        try:
            for k, (table, found) in enumerate(_at_speeds(lines, spreads, shares[here], speeds, workers)):
                growth[k, here], verdict[k, here] = lines.growth(table, found), found.verdict
                report_progress((first + size * (k + 1) / len(speeds)) / (len(shares) * (1 + 1 / len(speeds))))
        except OutOfTime as error:
            if first < 2 * each:
                raise
            return growth[:, :first], verdict[:, :first], error.why
    return growth, verdict, ""


def _at_speeds(
    lines: ManyLines, spreads: tuple[Spread, ...], shares: Array, speeds: Array, workers: Workers | None
) -> Iterator[tuple[Array, Pixels]]:
    """Numbers and pixels of the lines at ``shares`` at one speed after another.

    Raises
    ------
    OutOfTime : the time was up before all of them were judged.
    """

    def table(k: int) -> Array:
        return tables(lines.assembly, spreads, shares, float(speeds[k]))

    if workers is None:
        yield from ((own, lines.judged(own, TOLERANCE)) for own in map(table, range(len(speeds))))
        return
    found = lines.judged_by(workers, table, len(speeds), TOLERANCE)
    yield from ((table(k), one) for k, one in enumerate(found))
    if len(found) < len(speeds):
        keep_time()


def _require_known(found: Pixels, speed: float) -> None:
    """Refuse a speed at which the motion of none of the first lines is known: its share of stable lines would be 0 for
    nothing. The first few tell before many are integrated in vain."""
    if not np.any(found.error <= UNKNOWN):
        raise InputError(
            "is too slow for such stiff lines: over one turn their fastest modes make too many cycles to be followed",
            key="speeds", value=speed, remedy="leave it out, or take the stiffest parts as rigid",
        )  # fmt: skip


def _worst(lines: ManyLines, spreads: tuple[Spread, ...], shares: Array, growth: Array, speeds: Array) -> Worst:
    """The fastest line that a search finds: along the gradient from several of the fastest samples, as growth has tops
    beside each other, and closer about the fastest lines that this leads to."""
    search, known = WorstSearch(lines, spreads), np.where(np.isfinite(growth), growth, -np.inf)
    climbed = []
    for i in _starts(shares, known):
        k = int(known[:, i].argmax())
        place, best = search.along_gradient(float(speeds[k]), shares[i].copy(), float(known[k, i]))
        climbed.append((best, float(speeds[k]), place))
        if time_is_up():
            break
    climbed.sort(key=lambda one: -one[0])
    found = [(speed, *search.aside(speed, place, best)) for best, speed, place in climbed[:CLOSER]]
    speed, place, fastest = max(found, key=lambda one: one[2])
    with to_the_end():
        _, verdict = search.judged(speed, place, place[None])
    return Worst(
        numbers_at(spreads, place), speed, fastest, Verdict(int(verdict[0])), starts=len(climbed), looked=search.looked
    )


def _starts(shares: Array, growth: Array) -> list[int]:
    """Samples from which a search begins: the fastest at any speed, and others away from each other."""
    found: list[int] = []
    for i in np.argsort(-growth.max(axis=0), kind="stable").tolist():
        if all(np.abs(shares[i] - shares[k]).max() > APART for k in found):
            found.append(i)
        if len(found) == STARTS:
            break
    return found


@dataclass
class WorstSearch:
    """Steps from a place within the tolerances (shares of them) to faster lines; ``looked``: lines judged so far."""

    lines: ManyLines
    spreads: tuple[Spread, ...]
    looked: int = 0

    def judged(self, speed: float, place: Array, points: Array) -> tuple[Array, Codes]:
        """Growth and verdict of lines at ``points`` (line, tolerance) about a ``place``; what is not known is no faster
        line."""
        way = _way_to(self.lines, place)
        table = tables(self.lines.assembly, self.spreads, np.concatenate([way, points]), speed)
        found = self.lines.judged(table, 1e-2 * TOLERANCE)
        self.looked += len(points)
        growth = self.lines.growth(table, found)[len(way) :]
        return np.where(np.isfinite(growth), growth, -np.inf), found.verdict[len(way) :]

    def along_gradient(self, speed: float, place: Array, best: float) -> tuple[Array, float]:
        """To the corner that the gradient points to, else part of the way."""
        size = len(self.spreads)
        for _ in range(0 if time_is_up() else CLIMBS):
            inside = np.clip(place, STEP, 1 - STEP)
            probes = np.concatenate([inside + STEP * np.eye(size), inside - STEP * np.eye(size)])
            try:
                found, _ = self.judged(speed, place, probes)
            except OutOfTime:  # the fastest so far stands, as the study says that it was ended
                break
            with np.errstate(invalid="ignore"):
                gradient = found[:size] - found[size:]
            corner = np.where(gradient > 0, 1.0, np.where(gradient < 0, 0.0, place))
            tried = place + PARTS[:, None] * (corner - place)
            with to_the_end():
                reached, _ = self.judged(speed, place, tried)
            top = int(np.argmax(reached))
            if not reached[top] > best:
                break
            place, best = tried[top], float(reached[top])
        return place, best

    def aside(self, speed: float, place: Array, best: float) -> tuple[Array, float]:
        """Along single tolerances, in directions drawn by lot, and on as the last steps went: between two multipliers
        that are equally large the growth rate has an edge, along which no gradient leads."""
        size, reach, rng, before = len(self.spreads), FARTHEST, np.random.default_rng(0), place
        for _ in range(0 if time_is_up() else STEPS_ASIDE):
            aside = rng.normal(size=(DIRECTIONS, size)) / np.sqrt(size)
            on = np.array([[1.0], [2.0], [4.0]]) * (place - before)
            tried = place + np.concatenate([reach * np.eye(size), -reach * np.eye(size), reach * aside, on])
            tried = np.clip(tried, 0.0, 1.0)
            try:
                reached, _ = self.judged(speed, place, tried)
            except OutOfTime:
                break
            top = int(np.argmax(reached))
            if reached[top] > best:
                before, place, best = place, tried[top], float(reached[top])
            else:
                reach, before = reach / 2, place
            if reach < NEAREST:
                break
        return place, best


def _way_to(lines: ManyLines, place: Array) -> Array:
    """Shares (step, tolerance) from the middle of all tolerances to a place: motions that swing far are not found from
    rigid shafts, but followed from line to line."""
    if not isinstance(lines, SteadyStateLines):
        return np.zeros((0, len(place)))
    return 0.5 + np.arange(WAY)[:, None] / WAY * (place - 0.5)


def _ranking(spreads: tuple[Spread, ...], shares: Array, growth: Array) -> tuple[tuple[str, float], ...]:
    """Share of the growth rate's variance between classes of each parameter, less what chance alone would make."""
    known = np.isfinite(growth)
    shares, growth = shares[known], growth[known]
    total, count = float(growth.var()), len(growth)
    found = []
    for k, one in enumerate(spreads):
        member = np.minimum((shares[:, k] * BINS).astype(int), BINS - 1)
        number = np.bincount(member, minlength=BINS)
        mean = np.bincount(member, growth, BINS) / np.maximum(number, 1)
        between = float((number * (mean - growth.mean()) ** 2).sum() / count)
        chance = (BINS - 1) / count * (total - between)
        found.append((one.label, float(np.clip((between - chance) / total, 0.0, 1.0)) if total > 0 else 0.0))
    return tuple(sorted(found, key=lambda pair: -pair[1]))
