"""How probable it is that every check of ``assess`` holds within the tolerances, which fail, and at which corner.

Each line is judged by ``assess`` itself, which takes tenths of a second: so the lines are few. Their number is asked
for, or as many as ``SECONDS`` allow by the time that one takes; the result says which. Worst corner and ranking follow
the gradient of the check with the least margin to spare in any line, fitted to all lines.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from time import perf_counter

import numpy as np

from trunnion.arrays import Array, Flags
from trunnion.design.assessment.assess import checks_of, subject_of
from trunnion.design.assessment.check import Check, Status
from trunnion.equations.coefficients import Assembly
from trunnion.errors import ComputationError, InputError
from trunnion.floquet.tolerance.sampling import SCRAMBLES, interval, sobol
from trunnion.floquet.tolerance.spread import Spread, numbers_at, tables, values_in_words
from trunnion.numerics.workers import Workers
from trunnion.results.fields import attribute, coordinate, internal, labelled, variable
from trunnion.results.result import Result
from trunnion.results.variables import Attribute, Coordinate, Variable, attributes
from trunnion.waiting import OutOfTime, keep_time, time_is_up, to_the_end

SECONDS = 30.0
FEWEST, MOST = 4, 256
"""Lines in each of the scrambles."""
PARTS = (1.0, 0.5)
"""How far towards the corner that the gradient points to lines are judged."""


@dataclass(frozen=True)
class WorstLine:
    """The line with the least margin to spare that was judged: values by parameter, the check and what it says."""

    values: dict[str, float]
    check: str
    spare: float
    because: str


@labelled
class CheckStudy(Result):
    """Probability that the checks of ``assess`` hold within tolerances; lines that could not be computed exceed."""

    check: tuple[str, ...] = coordinate("check")
    probability: Array = variable("check", "1", "that it is not exceeded")
    interval: Array = internal("of the probability", "1", "check end")
    judged: Array = variable("check", "1", "share of lines in which the check could be judged")
    decides: Flags = variable("check", words="whether the verdict rests on it")
    together: float = attribute("probability that no check is exceeded on which it rests", name="checks_together")
    together_interval: tuple[float, float] = attribute(name="checks_together_interval")
    confidence: float = internal("of the intervals", "1")
    lines: int = attribute("judged", name="checks_lines")
    failed: int = attribute("that could not be computed", name="checks_failed")
    chosen_by_cost: bool = internal("whether as many lines were judged as the time allowed")
    seconds: float = internal("that each line took")
    worst: WorstLine | None = internal("with the least margin to spare that was judged")
    ranking: tuple[tuple[str, float], ...] = internal("parameters by the share of the scatter of the worst margin")
    ended: str = internal("what ended the study before it was done, as a clause", default="")

    def declared(self) -> Iterator[Variable | Attribute]:
        """Probabilities by check, the worst line."""
        yield from super().declared()
        yield Variable("probability_low", self.interval[:, 0], "check", "1")
        yield Variable("probability_high", self.interval[:, 1], "check", "1")
        yield Coordinate("check_parameter", [name for name, _ in self.ranking], "check_parameter")
        yield Variable("explained_of_check", np.array([share for _, share in self.ranking]), "check_parameter", "1")
        if self.worst is not None:
            yield from attributes(checks_worst=self.worst.check, checks_worst_spare=self.worst.spare)

    def _lines(self) -> Iterator[str]:
        low, high = self.together_interval
        why = f", as many as {SECONDS:g} s allow at {self.seconds:.2g} s each" if self.chosen_by_cost else ""
        yield (
            f"every check holds with probability {self.together:.4g}, {100 * self.confidence:g} % interval "
            f"[{low:.4g}, {high:.4g}], from {self.lines} lines judged over the whole range{why}"
        )
        for k in np.argsort(self.probability, kind="stable").tolist():
            if self.probability[k] < 1:
                aside = "" if self.decides[k] else " (a guideline shown only, left aside)"
                low, high = self.interval[k]
                yield f"  {self.check[k]}: {self.probability[k]:.4g} [{low:.4g}, {high:.4g}]{aside}"
        if self.failed:
            yield f"  {self.failed} lines could not be computed and count as exceeding"
        if self.worst is not None:
            values = values_in_words(self.worst.values)
            yield f"  worst line judged: {self.worst.check}, {self.worst.because}, with {values}"
            yield "  what moves it: " + ", ".join(f"{n} {100 * s:.0f} %" for n, s in self.ranking[:5])


def study_checks(
    assembly: Assembly,
    spreads: tuple[Spread, ...],
    speeds: tuple[float, float],
    lines: int | None,
    confidence: float,
    seed: int,
    report_progress: Callable[[float], None],
    workers: Workers | None = None,
) -> CheckStudy:
    """Judge ``lines`` lines (None: as many as ``SECONDS`` allow) over ``speeds``; see ``tolerance_study``.

    Raises
    ------
    OutOfTime : the time was up before two scrambles, whose scatter is the interval, were judged.
    """
    judge = _Judge(assembly, spreads, speeds)
    judge.of(np.full(len(spreads), 0.5))  # whatever the first of all takes to get going
    begun = perf_counter()
    judge.of(np.full(len(spreads), 0.45))
    seconds = perf_counter() - begun
    wanted = SECONDS / max(seconds, 1e-6) if lines is None else lines
    each = 1 << int(np.clip(np.ceil(np.log2(wanted / SCRAMBLES)), np.log2(FEWEST), np.log2(MOST)))
    if lines is None and each > FEWEST and each * SCRAMBLES > wanted:
        each //= 2
    shares = sobol(len(spreads), each, seed)
    found: list[dict[str, Check] | None] = []
    ended = ""
    try:
        for k, checks in enumerate(_judged(judge, shares, workers)):
            found.append(checks)
            report_progress((k + 1) / len(shares))
    except OutOfTime as error:
        ended = error.why
        whole = len(found) // each
        if whole < 2:
            raise
        shares, found = shares[: whole * each], found[: whole * each]
    computed = np.array([checks is not None for checks in found])
    every = [checks or {} for checks in found]
    names = tuple(dict.fromkeys(name for checks in every for name, own in checks.items() if own.judged))
    shape = len(found), len(names)

    def matrix(read: Callable[[Check], float], otherwise: float) -> Array:
        """By line and check, of what is judged."""
        rows = [[read(c) if (c := own.get(name)) and c.judged else otherwise for name in names] for own in every]
        return np.array(rows, dtype=float).reshape(shape)

    judged = matrix(lambda check: 1.0, 0.0) > 0
    holds = matrix(lambda check: check.status is not Status.EXCEEDED, 1.0) > 0
    spare = matrix(lambda check: check.spare, np.nan)
    decides = np.array([any(own[n].decides for own in every if n in own) for n in names], dtype=bool)
    together = holds[:, decides].all(axis=1) & computed
    worst, ranking = _worst(judge, shares, spare[:, decides], np.array(names)[decides].tolist())
    grid = (len(shares) // each, each)
    return CheckStudy(
        check=names, probability=holds.mean(axis=0),
        interval=np.array([interval(column.reshape(grid), confidence) for column in holds.T]).reshape(-1, 2),
        judged=judged.mean(axis=0), decides=decides, together=float(together.mean()),
        together_interval=interval(together.reshape(grid), confidence), confidence=confidence, lines=len(shares),
        failed=int(np.count_nonzero(~computed)), chosen_by_cost=lines is None, seconds=seconds, worst=worst,
        ranking=ranking, ended=ended,
    )  # fmt: skip


def _judged(judge: _Judge, shares: Array, workers: Workers | None) -> Iterator[dict[str, Check] | None]:
    """Checks of one line after another, from workers in the order of the shares.

    Raises
    ------
    OutOfTime : the time was up before the last line was judged.
    """
    if workers is None:
        yield from map(judge.of, shares)
        return
    arrived: dict[int, dict[str, Check] | None] = {}
    given = 0
    for number, checks in workers.each(judge.of, iter(shares)):
        arrived[number] = checks
        while given in arrived:
            yield arrived.pop(given)
            given += 1
    if given < len(shares):
        keep_time()


@dataclass(frozen=True)
class _Judge:
    assembly: Assembly
    spreads: tuple[Spread, ...]
    speeds: tuple[float, float]

    def of(self, shares: Array) -> dict[str, Check] | None:
        """Checks by name of the line at shares (parameters,) of its tolerances; None where it cannot be computed."""
        row = tables(self.assembly, self.spreads, shares[None], float("nan"))[0]
        try:
            line = self.assembly.packed.line_at(row)
            return {check.name: check for check in checks_of(subject_of(line, self.speeds, None, None))}
        except (InputError, ComputationError):
            return None


def _worst(
    judge: _Judge, shares: Array, spare: Array, names: list[str]
) -> tuple[WorstLine | None, tuple[tuple[str, float], ...]]:
    """The least margin of any line, and towards the corner that its gradient points to; what moves it."""
    known = np.where(np.isfinite(spare), spare, np.inf)
    if not known.size or not np.isfinite(known).any():
        return None, ()
    at, k = np.unravel_index(int(known.argmin()), known.shape)
    own = np.isfinite(spare[:, k])
    design = shares[own] - 0.5
    slope = np.linalg.lstsq(np.column_stack([design, np.ones(len(design))]), spare[own, k], rcond=None)[0][:-1]
    candidates = [shares[at], *(shares[at] + part * (np.where(slope > 0, 0.0, 1.0) - shares[at]) for part in PARTS)]
    best: WorstLine | None = None
    for place in candidates if not time_is_up() else candidates[:1]:
        with to_the_end():
            check = (judge.of(place) or {}).get(names[k])
        if check is not None and np.isfinite(check.spare) and (best is None or check.spare < best.spare):
            best = WorstLine(numbers_at(judge.spreads, place), names[k], check.spare, check.because)
    scatter = float(spare[own, k].var())
    weight = slope**2 * design.var(axis=0) / scatter if scatter > 0 else np.zeros(len(slope))
    pairs = [(s.label, float(min(w, 1.0))) for s, w in zip(judge.spreads, weight, strict=True)]
    return best, tuple(sorted(pairs, key=lambda pair: -pair[1]))
