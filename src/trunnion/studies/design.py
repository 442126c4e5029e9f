"""The points of a study: a product of axes, times the points of a sampling plan; each is made of its number alone.

Grids put i/(n − 1) of their range at place i, a fraction that a grid of 2n − 1 has too, to the last bit. Sobol points
are those of one scrambled sequence, whose first ones stay when more are asked for; a Saltelli design takes them in
rows (A, B, A with each column of B) one sequence point after another, so that it continues alike. A Latin hypercube
of another size is another one. A design may be some ``chosen`` ones of such points.
"""

from __future__ import annotations

import base64
import json
import warnings
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from threading import Lock
from typing import Any

import numpy as np
from scipy.stats import qmc

from trunnion.arrays import Array, Flags, Places
from trunnion.errors import InputError
from trunnion.floquet.tolerance.spread import LEAST, normal_or_even

METHODS = ("sobol", "latin", "saltelli")
MOST_LATIN = 1 << 22
"""Points of a Latin hypercube, which is made whole."""
LARGEST = 1 << 30
"""Points of a Sobol sequence, whose 30 bits then are used up."""


def in_axes(shape: Sequence[int]) -> str:
    """ " (50 × 20)", nothing for a single axis: how points stand to one another."""
    return f" ({' × '.join(map(str, shape))})" if len(shape) > 1 else ""


@dataclass(frozen=True, eq=False)
class StudyAxis:
    """A parameter that takes each of some values: those of a grid, or stated ones."""

    path: str
    unit: str
    nominal: float
    values: Array
    grid: tuple[float, float, int, bool] | None = None

    @classmethod
    def of_grid(
        cls, path: str, unit: str, nominal: float, low: float, high: float, points: int, log: bool
    ) -> StudyAxis:
        """``points`` values from ``low`` to ``high``, even, or even in their logarithm."""
        return cls(path, unit, nominal, grid_values(low, high, points, log), (low, high, points, log))

    @property
    def content(self) -> dict[str, Any]:
        """As JSON keeps it."""
        how = {"values": self.values.tolist()} if self.grid is None else {"grid": list(self.grid)}
        return {"path": self.path, "unit": self.unit, "nominal": self.nominal, **how}

    @classmethod
    def of_content(cls, content: Mapping[str, Any]) -> StudyAxis:
        """What ``content`` says."""
        path, unit, nominal = content["path"], content["unit"], content["nominal"]
        if "grid" in content:
            return cls.of_grid(path, unit, nominal, *content["grid"])
        return cls(path, unit, nominal, np.array(content["values"], dtype=float))

    def places(self, values: Array) -> Places:
        """Where ``values`` stand among those of the axis; −1 where they do not."""
        order = np.argsort(self.values, kind="stable")
        found = np.minimum(np.searchsorted(self.values[order], values), len(order) - 1)
        return np.where(self.values[order][found] == values, order[found], -1)


def grid_values(low: float, high: float, points: int, log: bool = False) -> Array:
    """Values of a grid; every other one of 2n − 1 is one of n, to the last bit."""
    if points == 1:
        return np.array([low])
    share = np.arange(points) / (points - 1)
    if log:
        values = np.exp(np.log(low) + (np.log(high) - np.log(low)) * share)
    else:
        values = low + (high - low) * share
    values[0], values[-1] = low, high
    return np.asarray(values)


@dataclass(frozen=True)
class Scattering:
    """A parameter that is sampled: evenly between two ends, or normally about ``nominal`` and cut there."""

    path: str
    unit: str
    nominal: float
    low: float
    high: float
    deviation: float | None = None

    def values(self, share: Array) -> Array:
        """Quantiles."""
        return normal_or_even(share, self.nominal, self.low, self.high, self.deviation)

    @property
    def content(self) -> dict[str, Any]:
        """As JSON keeps it."""
        return dict(vars(self))


@dataclass(frozen=True)
class Sampling:
    """Points of a sampling plan of ``scattering`` parameters; ``points`` of the sequence, each a row or several."""

    method: str
    points: int
    seed: int
    scattering: tuple[Scattering, ...]

    @property
    def rows_a_point(self) -> int:
        """Rows that a point of the sequence stands for."""
        return len(self.scattering) + 2 if self.method == "saltelli" else 1

    @property
    def rows(self) -> int:
        """In all."""
        return self.points * self.rows_a_point

    @property
    def sequence(self) -> tuple[Any, ...]:
        """What two plans share of which one continues the other."""
        whole = self.points if self.method == "latin" else 0
        return self.method, whole, self.seed, json.dumps(self.content["scattering"], sort_keys=True)

    @property
    def content(self) -> dict[str, Any]:
        """As JSON keeps it."""
        return {
            "method": self.method,
            "points": self.points,
            "seed": self.seed,
            "scattering": [one.content for one in self.scattering],
        }

    @classmethod
    def of_content(cls, content: Mapping[str, Any]) -> Sampling:
        """What ``content`` says."""
        scattering = tuple(Scattering(**one) for one in content["scattering"])
        return cls(content["method"], content["points"], content["seed"], scattering)

    def values(self, first: int, last: int) -> Array:
        """Rows ``first`` to ``last``: values (rows, parameters)."""
        shares = np.clip(self._shares(first, last), LEAST, 1 - LEAST)
        return np.stack([one.values(share) for one, share in zip(self.scattering, shares.T, strict=True)], axis=1)

    def _shares(self, first: int, last: int) -> Array:
        size = len(self.scattering)
        if self.method == "latin":
            return _latin(size, self.points, self.seed)[first:last]
        if self.method == "sobol":
            return _sobol(size, self.seed, first, last)
        each = self.rows_a_point
        begin, end = first // each, -(-last // each)
        both = _sobol(2 * size, self.seed, begin, end)
        a, b = both[:, :size], both[:, size:]
        mixed = [np.where(np.arange(size) == k, b, a) for k in range(size)]
        rows = np.stack([a, b, *mixed], axis=1).reshape(-1, size)
        return rows[first - begin * each : last - begin * each]


def _sobol(size: int, seed: int, first: int, last: int) -> Array:
    with _TURN, warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of a number that is not a power of two: these continue
        sequence = _sequence(size, seed)
        sequence.reset()
        if first:
            sequence.fast_forward(first)
        return np.asarray(sequence.random(last - first))


_TURN = Lock()
"""A sequence moves on as it is read, and workers may have several threads."""


@cache
def _sequence(size: int, seed: int) -> Any:
    return qmc.Sobol(size, scramble=True, seed=seed)


@cache
def _latin(size: int, points: int, seed: int) -> Array:
    return np.asarray(qmc.LatinHypercube(size, seed=seed).random(points))


@dataclass(frozen=True, eq=False)
class StudyDesign:
    """All points that a study asks for: of every row of the sampling plan (slowest) all that the axes make; or the
    ``chosen`` of these, by rising numbers."""

    axes: tuple[StudyAxis, ...]
    sampling: Sampling | None = None
    chosen: Places | None = None

    @cached_property
    def paths(self) -> tuple[str, ...]:
        """Parameters, those that are sampled first."""
        return tuple(one.path for one in self._varied)

    @cached_property
    def units(self) -> tuple[str, ...]:
        """SI units of the parameters."""
        return tuple(one.unit for one in self._varied)

    @property
    def _varied(self) -> tuple[Scattering | StudyAxis, ...]:
        return (*self._scattering, *self.axes)

    @property
    def _scattering(self) -> tuple[Scattering, ...]:
        return self.sampling.scattering if self.sampling else ()

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """Rows of the sampling plan where there is one, then points along each axis; of chosen points how many."""
        if self.chosen is not None:
            return (len(self.chosen),)
        sampled = (self.sampling.rows,) if self.sampling else ()
        return (*sampled, *(len(axis.values) for axis in self.axes))

    @cached_property
    def size(self) -> int:
        """Points in all."""
        return int(np.prod([int(n) for n in self.shape], dtype=object)) if self.shape else 0

    @cached_property
    def _of_axes(self) -> int:
        return int(np.prod([len(axis.values) for axis in self.axes], dtype=object)) if self.axes else 1

    @property
    def content(self) -> dict[str, Any]:
        """As JSON keeps it."""
        sampling = self.sampling and self.sampling.content
        some = {} if self.chosen is None else {"chosen": _packed(self.chosen)}
        return {"axes": [axis.content for axis in self.axes], "sampling": sampling, **some}

    @cached_property
    def key(self) -> str:
        """A text that two designs share that are the same."""
        return json.dumps(self.content, sort_keys=True)

    @classmethod
    def of_content(cls, content: Mapping[str, Any]) -> StudyDesign:
        """What ``content`` says."""
        sampling = content["sampling"] and Sampling.of_content(content["sampling"])
        chosen = _unpacked(content["chosen"]) if "chosen" in content else None
        return cls(tuple(map(StudyAxis.of_content, content["axes"])), sampling, chosen)

    def _among_all(self, places: Places) -> Places:
        """Numbers among all points of the axes and the sampling plan."""
        return places if self.chosen is None else self.chosen[places]

    def values(self, places: Places) -> Array:
        """Values (points, parameters) of the points with these numbers, which rise."""
        columns = []
        places = self._among_all(places)
        if self.sampling:
            row, places = np.divmod(places, self._of_axes)
            first, last = int(row[0]), int(row[-1]) + 1
            columns += list(self.sampling.values(first, last)[row - first].T)
        for axis, place in zip(self.axes, self._along_axes(places), strict=True):
            columns.append(axis.values[place])
        return np.stack(columns, axis=1)

    def _along_axes(self, places: Places) -> list[Places]:
        found: list[Places] = []
        for axis in reversed(self.axes):
            places, place = np.divmod(places, len(axis.values))
            found.append(place)
        return found[::-1]

    def places(self, asked: StudyDesign, numbers: Places) -> Places:
        """Numbers here of points of another design, found by their values: −1 where there are none.

        What one design varies and the other does not is what the line states there.
        """
        numbers = asked._among_all(numbers)
        found = np.zeros(len(numbers), dtype=np.intp)
        none = np.zeros(len(numbers), dtype=bool)
        if (self.sampling is None) != (asked.sampling is None):
            none |= True
        elif self.sampling and asked.sampling:
            if self.sampling.sequence != asked.sampling.sequence:
                none |= True
            row = numbers // asked._of_axes
            none |= row >= self.sampling.rows
            found = np.where(none, 0, row)
        own = {axis.path: axis for axis in self.axes}
        along = dict(zip((a.path for a in asked.axes), asked._along_axes(numbers % asked._of_axes), strict=True))
        theirs = {axis.path: axis for axis in asked.axes}
        for path, axis in own.items():
            there = theirs.get(path)
            if there is None:
                place = np.broadcast_to(axis.places(np.array([axis.nominal])), none.shape)
            else:
                place = axis.places(there.values)[along[path]]
            none |= place < 0
            found = found * len(axis.values) + np.where(place < 0, 0, place)
        for path, axis in theirs.items():
            if path not in own:
                none |= (axis.values != axis.nominal)[along[path]]
        if self.chosen is None:
            return np.where(none, -1, found)
        if not len(self.chosen):
            return np.full(len(numbers), -1, dtype=np.intp)
        place = np.minimum(np.searchsorted(self.chosen, found), len(self.chosen) - 1)
        return np.where(none | (self.chosen[place] != found), -1, place)


def _packed(numbers: Places) -> str:
    """Rising numbers as text, of a byte or two each."""
    steps = np.diff(numbers, prepend=0).astype("<i8")
    return base64.b64encode(zlib.compress(steps.tobytes(), 6)).decode("ascii")


def _unpacked(text: str) -> Places:
    return np.cumsum(np.frombuffer(zlib.decompress(base64.b64decode(text)), dtype="<i8")).astype(np.intp)


def refuse_latin(old: Sequence[StudyDesign], new: StudyDesign) -> None:
    """Refuse a Latin hypercube of another size than one of the store: it would keep none of its points.

    Raises
    ------
    InputError : it is.
    """
    plan = new.sampling
    if plan is None or plan.method != "latin":
        return
    for one in old:
        there = one.sampling
        if there and there.method == "latin" and there.points != plan.points:
            problem = f"cannot become {plan.points} of the Latin hypercube of {there.points} points that the store has"
            remedy = f'keep {there.points}, take method = "sobol", which continues, or give another store'
            raise InputError(problem, element="sampling", key="points", value=plan.points, remedy=remedy)


def missing_from(design: StudyDesign, earlier: Sequence[StudyDesign], numbers: Places) -> Flags:
    """Which of the points with these numbers none of the ``earlier`` designs has."""
    new = np.ones(len(numbers), dtype=bool)
    for one in earlier:
        new &= one.places(design, numbers) < 0
    return new
