"""Harmonic balance as one driver: a branch with so many harmonics, or with as many as its tail asks for.

What differs is the residual: of any first-order system (``harmonic_balance``), and of masses on springs
(``harmonic_balance_springs``). Own motions of free lines (``linear.free_balance``) lie on no branch: their speeds are
given, and one Newton's method takes its steps for all of them together (``numerics.continuation.newton``). Harmonics
are doubled alike, and the matrices of the balance are the same for all (``numerics.harmonics``).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Protocol, TypeVar

import numpy as np

from trunnion.arrays import Array
from trunnion.motion.orbits.branch import PeriodicBranch, Problem, collect, follow_both_ways
from trunnion.numerics import harmonics as fourier
from trunnion.numerics.continuation.arclength import CurvePoint
from trunnion.numerics.harmonics import doubled
from trunnion.numerics.threads import on_one_thread
from trunnion.results.declared import Held, Result, over, remarks
from trunnion.results.drawing import Axes
from trunnion.results.outcome import Outcome


@dataclass(frozen=True, repr=False)
class SeriesBranch(Result):
    """A branch of periodic motions as Fourier series.

    ``branch`` holds parameter, multipliers, verdicts, amplitudes and special points as ``periodic_branch`` does;
    rows (points, n, 2H + 1): mean, cosines, sines of every unknown; tail (points,): the largest of the last harmonics
    over the largest of all; periods: of the forcing in one of the motion.
    """

    branch: PeriodicBranch
    rows: Array
    tail: Array
    periods: int

    @property
    def harmonics(self) -> int:
        """H, per period of the motion."""
        return fourier.order(self.rows)

    @property
    def outcome(self) -> Outcome:
        """Where the branch ended and why."""
        return self.branch.outcome

    def declared(self) -> Iterator[Held]:
        """What the branch holds, with the series."""
        yield from self.branch.declared()
        yield over("point state coefficient", "series", self.rows, about="mean, cosines 1…H, sines 1…H")
        yield over("point", "tail", self.tail)
        yield from remarks(harmonics=self.harmonics, periods=self.periods)

    def plot(self, axes: Axes | None = None, *, curve: str = "", unit: str = "", jumps: bool = True) -> Axes:
        """Response curve with its jumps; see ``pictures.frequency_response.branch``."""
        return self.branch.plot(axes, curve=curve, unit=unit, jumps=jumps)

    @property
    def _worst(self) -> str:
        return f"tail up to {self.tail.max():.1e}"

    def __str__(self) -> str:
        if not len(self.rows):
            return str(self.branch)
        return f"harmonic balance with {self.harmonics} harmonics, {self._worst}\n{self.branch}"


S = TypeVar("S", bound=SeriesBranch)


class Balance(Problem, Protocol):
    """The balance of h harmonics as equations of a curve z = (series, parameter)."""

    h: int
    periods: int

    def first(self) -> Array:
        """A series to begin with, (n, 2h + 1)."""

    def rows(self, point: CurvePoint) -> Array:
        """The series at a point of the curve, (n, 2h + 1)."""


class Series:
    """What every balance shares."""

    h: int

    def rows(self, point: CurvePoint) -> Array:
        return point.z[:-1].reshape(-1, 2 * self.h + 1)


def balanced(
    kind: type[S],
    make: Callable[[int], Balance],
    harmonics: int | None,
    fewest: int,
    most: int,
    limit: float,
    begin: float,
    low: float,
    high: float,
    most_points: int,
) -> S:
    """The branch with ``harmonics``, or doubled from ``fewest`` until the tail is below ``limit`` everywhere."""
    *tried, last = [harmonics] if harmonics is not None else doubled(fewest, most)
    with on_one_thread():
        for h in tried:
            found = _followed(kind, make(h), begin, low, high, most_points, limit)
            if found is not None and np.all(found.tail < limit):
                return found
        found = _followed(kind, make(last), begin, low, high, most_points, np.inf)
    assert found is not None
    return found if harmonics is not None else _judged(found, limit)


def _followed(
    kind: type[S], problem: Balance, begin: float, low: float, high: float, most_points: int, limit: float
) -> S | None:
    """The branch; None as soon as a point of it needs more harmonics to keep its tail below the limit."""

    def stop(point: CurvePoint) -> bool:
        return not tail_of(problem.rows(point)) < limit

    first = np.append(problem.first().ravel(), begin)
    walk, outcome = follow_both_ways(problem, first, low, high, most_points, stop=stop)
    if outcome.kind == "stopped" and np.isfinite(limit):
        return None
    if not walk:
        near = problem.over.said(begin)
        nothing = f"no motion with {problem.h} harmonics was found near {near}; give a start"
        outcome = Outcome(False, "not found", nothing)
    shape = -1, (len(problem.scale) - 1) // (2 * problem.h + 1), 2 * problem.h + 1
    rows = np.array([problem.rows(point) for point, _ in walk]).reshape(shape)
    return kind(collect(problem, walk, outcome), rows, np.array([tail_of(row) for row in rows]), problem.periods)


def _judged(found: S, limit: float) -> S:
    """With the outcome that the tail asked for was not reached, if so."""
    worst, outcome = found.tail.max(initial=0.0), found.branch.outcome
    if worst < limit:
        return found
    words = f"{outcome.sentence}; the last of {found.harmonics} harmonics are still {worst:.1e} of the motion"
    short = Outcome(False, "tail", f"{words}: raise tail above {limit:.1g}, or give harmonics")
    return replace(found, branch=replace(found.branch, outcome=short))


def tail_of(rows: Array) -> float:
    """The last two harmonics over the largest; of all unknowns together, since those of one that hardly moves say
    nothing."""
    h = fourier.order(rows)
    size = np.hypot(rows[:, 1 : h + 1], rows[:, h + 1 :]).max(axis=0)
    return float(size[max(h - 2, 0) :].max() / max(size.max(), 1e-300))
