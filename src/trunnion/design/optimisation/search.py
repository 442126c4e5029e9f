"""Search for the best design: differential evolution, then Nelder and Mead's simplex from the best ones.

Both take aims as they are, with corners and jumps. A design that violates checks is worse than any that does not, and
of two such the one that violates less is better (K. Deb, Computer Methods in Applied Mechanics and Engineering 186
(2000) 311). Everything that was computed is kept, for the front of two aims.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import differential_evolution, minimize

from trunnion.arrays import Array
from trunnion.design.assessment.assessment_input import QUICK
from trunnion.design.optimisation.aims import DesignEvaluation, DesignProblem
from trunnion.design.optimisation.space import Space
from trunnion.waiting import keep_time

BROKEN, REFUSED = 1e12, 1e18
"""Merit of what violates checks, and of what cannot be computed."""
NEAR = 0.03
"""Margin of a check within which the coarse grid of the search may err: there the full one decides."""
POPULATION = 8
"""Designs of one generation, per free number."""
SIMPLEX = (0.05, 0.005)
"""Sizes of simplices, as shares of the bounds, from which the best design is improved in turn."""
CLOSE, ROUGH = (1e-5, 1e-9), (0.1, 0.01)
"""Where the last simplex ends, as shares of the bounds and of the merit; the one before, of its size and the merit."""
POLISH = 60
"""Designs of one polishing, per free number; between the ends of a front a third of that."""
SETTLED = 1e-3
"""Spread of a generation's merits, over their mean, at which the search from everywhere ends: simplices are faster."""
STALE, FALLS = 6, 0.01
"""Generations in which the best merit has to fall by this share of itself for the search from everywhere to go on."""
VALLEYS, DISTANCE = 3, 0.15
"""Designs that are improved first, and how far apart they are, as a share of the bounds."""
WEIGHTS = np.linspace(0.0, 1.0, 9)[1:-1]
"""Weights of the first aim between the two ends of a front."""
BESIDE = 1e-3
"""Weight of the sum of the aims beside the larger of them, so that no end of a front is weakly dominated."""

Merit = Callable[[Array], float]


class _KnownOptimum(Exception):
    """A simplex came to where an earlier one ended."""


@dataclass(frozen=True)
class EvaluatedDesign:
    """One design that was computed: its shares and what was answered; the largest aims count as negative."""

    shares: Array
    answer: DesignEvaluation
    losses: Array


class DesignSearch:
    """Designs of one space, each computed once."""

    def __init__(
        self, space: Space, problem: DesignProblem, most: int, seed: int, progress: Callable[[float], None] | None
    ) -> None:
        self.space, self.problem, self.most, self.seed = space, problem, most, seed
        self.progress = progress
        self.tried: dict[bytes, EvaluatedDesign] = {}
        self.signs = np.array([-1.0 if aim.largest else 1.0 for aim in problem.aims])

    def at(self, shares: Array) -> EvaluatedDesign:
        """One design, on a grid of speeds that is coarse except about the peaks."""
        shares = np.clip(np.asarray(shares, dtype=float), 0.0, 1.0)
        key = shares.tobytes()
        if key not in self.tried:
            keep_time()
            found = self._computed(shares, quick=True)
            keep_time()  # what a limit cut short is not an answer
            self.tried[key] = found
            if self.progress:
                self.progress(min(len(self.tried) / self.most, 0.99))
        return self.tried[key]

    def whole(self, shares: Array) -> EvaluatedDesign:
        """One design as ``assess`` judges it, computed anew."""
        found = self._computed(shares, quick=False)
        keep_time()
        return found

    def _computed(self, shares: Array, *, quick: bool) -> EvaluatedDesign:
        line = self.space.line(shares)
        if line is None:
            answer = DesignEvaluation(tuple(float("nan") for _ in self.signs), np.inf, ())
        else:
            answer = self.problem.answer(line, QUICK) if quick else self.problem.answer(line)
            if quick and abs(answer.spare) < NEAR:
                answer = self.problem.answer(line)
        return EvaluatedDesign(shares.copy(), answer, self.signs * np.array(answer.values))

    def best(self, merit: Callable[[Array], float]) -> EvaluatedDesign:
        """The design with the smallest ``merit(losses)`` found from everywhere within the bounds."""
        self._evolved(self._of(merit))
        return self.polished(merit, SIMPLEX, POLISH)

    def polished(self, merit: Callable[[Array], float], sizes: Sequence[float], most: int) -> EvaluatedDesign:
        """The same from the best designs that are known, by simplices of these sizes, each of so many designs per free
        number; the first from several of them that lie apart, as one may be the wrong valley."""
        function = self._of(merit)
        for place, size in enumerate(sizes):
            ordered = sorted(self.tried.values(), key=lambda one: function(one.shares))
            ends: list[Array] = []
            for start in _apart(ordered, VALLEYS if not place and len(sizes) > 1 else 1):
                self._simplex(function, start.shares, size, most, ends, last=size == sizes[-1])
        return min(self.tried.values(), key=lambda one: function(one.shares))

    def _simplex(self, function: Merit, start: Array, size: float, most: int, ends: list[Array], *, last: bool) -> None:
        """Improve one design; where it comes to what an earlier simplex ended at, that one has done the work."""
        corners = np.array([start, *(_moved(start, i, size) for i in range(len(start)))])
        near, close = CLOSE if last else (ROUGH[0] * size, ROUGH[1])

        def stop_at_known(place: Array) -> None:
            if any(np.abs(place - end).max() < size for end in ends):
                raise _KnownOptimum

        try:
            found = minimize(
                function, start, method="Nelder-Mead", bounds=[(0.0, 1.0)] * len(start), callback=stop_at_known,
                options={"initial_simplex": corners, "maxfev": most * len(start), "xatol": near,
                         "fatol": close * abs(function(start))},
            )  # fmt: skip
            ends.append(np.array(found.x))
        except _KnownOptimum:
            pass

    def _evolved(self, function: Merit) -> None:
        size = len(self.space.free)
        generation = max(5, POPULATION * size)
        generations = max(1, self.most // generation - 1)
        first = np.random.default_rng(self.seed).random((generation, size))
        first[0] = self.space.start
        seen: list[float] = [np.inf]
        best: list[float] = []

        def watched(shares: Array) -> float:
            seen.append(function(shares))
            return seen[-1]

        # Older SciPy tells a callback the place alone, not how good it is.
        def stale(place: Array, convergence: float) -> bool:
            best.append(min(seen))
            return len(best) > STALE and best[-1 - STALE] - best[-1] < FALLS * abs(best[-1])

        differential_evolution(
            watched, [(0.0, 1.0)] * size, init=first, maxiter=generations, seed=self.seed, polish=False,
            tol=SETTLED, atol=1e-14, callback=stale,
        )  # fmt: skip

    def _of(self, merit: Callable[[Array], float]) -> Merit:
        def function(shares: Array) -> float:
            one = self.at(shares)
            if not one.answer.possible:
                return REFUSED
            if one.answer.violation:
                return BROKEN * (1 + one.answer.violation)
            return merit(one.losses)

        return function


def _apart(ordered: list[EvaluatedDesign], most: int) -> list[EvaluatedDesign]:
    """The best designs of an ordered list, each farther than ``DISTANCE`` from those before it."""
    found: list[EvaluatedDesign] = []
    for one in ordered:
        if len(found) < most and all(np.abs(one.shares - other.shares).max() > DISTANCE for other in found):
            found.append(one)
    return found


def _moved(start: Array, place: int, size: float) -> Array:
    found = start.copy()
    found[place] += size if start[place] + size <= 1 else -size
    return found


def first(losses: Array) -> float:
    """The only aim."""
    return float(losses[0])


def front(search: DesignSearch) -> list[EvaluatedDesign]:
    """Designs that no other one beats in both aims, by rising first aim."""
    ends = [search.best(lambda losses, k=k: float(losses[k])) for k in range(2)]  # type: ignore[misc]
    low = np.minimum(ends[0].losses, ends[1].losses)
    span = np.maximum(np.abs(ends[0].losses - ends[1].losses), 1e-300)

    def weighed(weight: float) -> Callable[[Array], float]:
        def merit(losses: Array) -> float:
            off = (losses - low) / span * np.array([weight, 1 - weight])
            return float(off.max() + BESIDE * off.sum())

        return merit

    if all(one.answer.possible and not one.answer.violation for one in ends):
        for weight in WEIGHTS:
            search.polished(weighed(float(weight)), SIMPLEX[:1], POLISH // 3)
    return nondominated(list(search.tried.values()))


def nondominated(tried: list[EvaluatedDesign]) -> list[EvaluatedDesign]:
    """Those that hold all checks and that no other one beats in both aims, by rising first aim."""
    good = [one for one in tried if one.answer.possible and not one.answer.violation]
    good.sort(key=lambda one: tuple(one.losses))
    kept: list[EvaluatedDesign] = []
    for one in good:
        if not kept or one.losses[1] < kept[-1].losses[1]:
            kept.append(one)
    return kept


def thinned(found: list[EvaluatedDesign], most: int) -> list[EvaluatedDesign]:
    """At most ``most`` of a front, evenly along it, its ends included."""
    if len(found) <= most:
        return found
    losses = np.array([one.losses for one in found])
    span = np.maximum(np.ptp(losses, axis=0), 1e-300)
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*(np.diff(losses, axis=0) / span).T))])
    places = np.unique(np.searchsorted(along, np.linspace(0.0, along[-1], most)).clip(0, len(found) - 1))
    return [found[k] for k in places]
