"""What a search for the least drive tells, whether it varies a factor of the torque or the acceleration.

Whether a line passes need not be monotone in either, so that values are sampled first. The least one is that from which
every one tried passes from every starting phase; then more are tried on both sides of it, evenly, for the nature of the
boundary.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from trunnion.arrays import Array, Flags
from trunnion.driveline.arguments import one_number, whole_number
from trunnion.errors import InputError
from trunnion.motion.passing.boundary_nature import BoundaryNature, boundary_nature
from trunnion.motion.passing.trials import Trials, passes
from trunnion.results.counts import counted
from trunnion.results.fields import attribute, coordinate, internal, labelled, variable
from trunnion.results.outcome import Outcome
from trunnion.results.result import Result
from trunnion.results.speeds import rounded_speed
from trunnion.results.variables import Attribute, Variable
from trunnion.waiting import time_is_up

MOST_POINTS = 10_000
WIDE = 8.0
"""Accuracies that the even band about the boundary reaches to either side."""


@labelled
class TriedValue:
    """Passages with one value, of which the subclass says what it is, from every starting phase."""

    share: float = variable("", "1", "of the starting phases that passed", name="passed")
    undecided: float = variable("", "1", "of the starting phases")
    worst: str = variable("", "", "how the passages ended that did not pass", name="otherwise")
    kinds: tuple[str, ...] = internal("how each ended, by starting phase")

    @property
    def passes(self) -> bool:
        """Whether the line passed from every starting phase."""
        return self.share == 1.0


@labelled
class LeastFound(Result):
    """Trials by rising value, of which the subclass says what it is."""

    phases: Array = coordinate("phase", "rad", "of the input when it begins")
    drive: str = attribute("disk that drives")
    first: float = attribute("speed at the start [rad/s]")
    last: float = attribute("speed asked for [rad/s]")
    accuracy: float = attribute("of the least value, relative")
    tolerance: float = attribute("error allowed per step")
    band: Array = internal("values, even in the logarithm, for the nature of the boundary")
    stopped: str = internal("what ended the search early")
    unit: str = internal("of speeds in print")
    WHAT: ClassVar[tuple[str, str]]
    """One, and several."""

    @property
    def _tried(self) -> tuple[Any, ...]:
        """The trials, by rising value."""
        raise NotImplementedError

    def _said(self, value: float) -> str:
        """A value in words."""
        raise NotImplementedError

    @cached_property
    def values(self) -> Array:
        """What was tried (trial,)."""
        return np.array([one.value for one in self._tried])

    @property
    def passes(self) -> Flags:
        """Whether each passed from every starting phase (trial,)."""
        return np.array([one.passes for one in self._tried], dtype=bool)

    @property
    def _place(self) -> int:
        failing = np.flatnonzero(~self.passes)
        return int(failing[-1]) + 1 if len(failing) else 0

    def _least(self) -> float:
        place = self._place
        return float(self._tried[place].value) if place < len(self._tried) else np.nan

    def _below(self) -> float:
        return float(self._tried[self._place - 1].value) if self._place else np.nan

    @property
    def passing_below(self) -> Array:
        """Values below ``below`` that pass all the same: passing is not monotone there."""
        return np.array([one.value for one in self._tried[: self._place] if one.passes])

    @cached_property
    def nature(self) -> BoundaryNature | None:
        """What the outcomes tell of the boundary; None where nothing was tried."""
        if not self._tried:
            return None
        known = {"passed": 1.0, "dwelt": 1.0, "undecided": np.nan}
        passed = np.array([[known.get(kind, 0.0) for kind in one.kinds] for one in self._tried])
        return boundary_nature(self.values, passed, self.band)

    @property
    def outcome(self) -> Outcome:
        """Whether it was found, and a sentence."""
        one, several = self.WHAT
        if self.stopped:
            return Outcome(False, "ended early", f"{self.stopped} after {len(self._tried)} {several}")
        if np.isnan(self._least()):
            return Outcome(False, "not found", f"no {one} that was tried is enough")
        return Outcome(True, "found", f"{self._said(self._least())} is enough")

    def declared(self) -> Iterator[Variable | Attribute]:
        """Trials, ends of the search, and the sentence."""
        yield from super().declared()
        yield Attribute("outcome", self.outcome.kind)
        if (nature := self.nature) is not None:
            yield Attribute("boundary", nature.kind)
            yield Attribute("boundary_searched", [*nature.band, nature.apart])
            if np.isfinite(nature.exponent):
                yield Attribute("uncertainty_exponent", nature.exponent)
        yield Attribute("says", "; ".join(self._lines()))

    def _lines(self) -> Iterator[str]:
        trials, place, several = self._tried, self._place, self.WHAT[1]
        asked = rounded_speed(self.last, self.unit)
        count = counted(len(self.phases), "starting phase")
        if not trials:
            yield f"nothing was tried: {self.stopped}"
            return
        said = self._said
        span = f"{len(trials)} {several} tried from {trials[0].value:.4g} to {said(trials[-1].value)}"
        if place == len(trials):
            yield f"none of the {span} brings the line to {asked} up to the highest"
        else:
            yield (
                f"{said(trials[place].value)} brings the line to {asked}: each of the {len(trials) - place} {several} "
                f"tried from there to {said(trials[-1].value)} passes from {count}"
            )
        if place:
            one = trials[place - 1]
            yield f"  {said(one.value)} passes from {100 * one.share:.3g} % of them, and is otherwise {one.worst}"
        else:
            yield "  nothing less was tried"
        if len(self.passing_below):
            below = ", ".join(said(one) for one in self.passing_below)
            yield f"  passing is not monotone: {below} passes too, though more does not"
        if self.nature is not None:
            for sentence in self.nature.sentences(several):
                yield f"  {sentence}"
        if len(trials) > 1:
            apart = 100 * float(np.max(self.values[1:] / self.values[:-1]) - 1)
            yield f"  {span}, up to {apart:.3g} % apart; nothing was run between them"
        if self.stopped:
            yield f"  {self.outcome}"


Found = Callable[[Sequence[tuple[float, list[str]]], Array, str], Any]
"""A result of values with their kinds, of the even band, and of what stopped the search."""


def search(
    trials: Trials, *, path: str, ends: tuple[float, float], key: str, points: int, accuracy: float, around: int,
    found: Found, progress: Callable[[float], None] | None,
) -> Any:  # fmt: skip
    """Try values of ``path`` between two ``ends``: evenly in the logarithm, then between the least and what fails below
    it, then ``around`` the boundary.

    Raises
    ------
    InputError : wrong ends, points, accuracy or around.
    """
    low, high = _range(ends, key)
    count = whole_number(points, "points", 2)
    more = whole_number(around, "around", 0)
    for name, one in (("points", count), ("around", more)):
        if one > MOST_POINTS:
            raise InputError("are too many", key=name, value=one, remedy=f"at most {MOST_POINTS}; 17, say")
    if not 1e-12 < one_number(accuracy, "accuracy", "0.01, say") < 1:
        raise InputError("must lie between 1e-12 and 1", key="accuracy", value=accuracy, remedy="0.01, say")
    report_progress = progress or (lambda share: None)
    expected = count + _halvings(low, high, count, accuracy) + more
    made: list[tuple[float, list[str]]] = []
    band = np.zeros(0)

    def between(now: LeastFound) -> list[float]:
        """The value between the least one and what does not pass below it; none where these are near enough."""
        below, least = now._below(), now._least()
        return [float(np.sqrt(below * least))] if least / below > 1 + accuracy else []

    waiting = [float(one) for one in np.geomspace(high, low, count)]
    while waiting:
        kinds = [] if time_is_up() else trials.kinds({path: waiting[0]})
        if stopped := time_is_up():
            return found(made, band, stopped)
        made.append((waiting.pop(0), kinds))
        report_progress(min(len(made) / expected, 1.0))
        if not waiting:
            now = found(made, band, "")
            waiting = between(now)
            if not waiting and more and not len(band) and np.isfinite(now._below() * now._least()):
                band = _around(now, (1 + accuracy) ** WIDE, low, high, more)
                tried = {value for value, _ in made}
                waiting = [float(one) for one in band if one not in tried]
    report_progress(1.0)
    return found(made, band, "")


def _around(now: LeastFound, reach: float, low: float, high: float, count: int) -> Array:
    """Even values about the edges of all starting phases."""
    edges = now.nature.edges if now.nature is not None else np.full((1, 2), np.nan)
    if not np.isfinite(edges).any():
        edges = np.array([[now._below(), now._least()]])
    return np.geomspace(max(float(np.nanmin(edges)) / reach, low), min(float(np.nanmax(edges)) * reach, high), count)


def summary(kinds: Sequence[str]) -> tuple[float, float, str, tuple[str, ...]]:
    """Share that passed, share undecided, how the others ended, and how each did: the fields of a ``TriedValue``."""
    other = sorted({kind for kind in kinds if not passes([kind])})
    return passes(kinds) / len(kinds), list(kinds).count("undecided") / len(kinds), " or ".join(other), tuple(kinds)


def _halvings(low: float, high: float, count: int, accuracy: float) -> int:
    """How many are expected."""
    return max(int(np.ceil(np.log2(np.log(high / low) / (count - 1) / np.log1p(accuracy)))), 0)


def _range(ends: tuple[float, float], key: str) -> tuple[float, float]:
    found = [one_number(one, key, "(0.5, 2.0), say") for one in ends]
    if len(found) != 2 or not np.all(np.isfinite(found)) or not 0 < found[0] < found[1]:
        raise InputError("must be two rising positive numbers", key=key, value=list(ends), remedy="(0.5, 2.0)")
    return found[0], found[1]
