"""The boundary that a study has found, as a function: where it crosses a line through the parameters, and how surely.

It lies in the cells of the finest grid whose corners are on both sides. Along a line these cells stand in runs, and
where the ends of a run are on different sides the boundary is crossed between them. What is narrower than a cell that
was never halved is not seen.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np

from trunnion.arrays import Array, Integers, Places
from trunnion.driveline.refusals import nearest
from trunnion.errors import ComputationError, InputError
from trunnion.results.counts import counted
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, coordinate, internal, labelled, variable
from trunnion.results.result import Result
from trunnion.results.units import figures
from trunnion.studies.design import StudyAxis
from trunnion.studies.refinement import ABOVE, BELOW, UNKNOWN, Descent, KnownSides, Lattice, Refinement, descent
from trunnion.studies.result import Study
from trunnion.studies.rounds import sides_of

ERRATIC = 0.3
"""By how much the dimension of a boundary is less than that of its parameters at which it fills nearly all of them."""
ENOUGH = 64
"""Cells of a level whose number says something about the dimension."""


@labelled
class StudyBoundary(Result):
    """Where an answer changes: edges of the finest grid with its two points on different sides."""

    parameter: tuple[str, ...] = coordinate("parameter", "", "that the boundary was followed over")
    unit_of: tuple[str, ...] = variable("parameter", "", "SI unit", name="unit")
    error: Array = variable("parameter", "", "half the widest step of the finest grid, in that unit")
    point: Array = variable("crossing parameter", "", "where the boundary crosses, in these units")
    low: Array = variable("crossing", "", "end of the edge, along its parameter")
    high: Array = variable("crossing", "", "other end")
    along: Integers = variable("crossing", "", "number of that parameter")
    row: Integers = variable("crossing", "", "number of the sampled row and of the stated values, together")
    quantity: str = attribute("that changes")
    side: str = attribute("what is true on one side of it")
    halvings: int = attribute("of the cells that it passes, all points of which are known")
    asked: int = attribute("halvings that were asked for")
    points: int = attribute("that were computed")
    everywhere: int = attribute("points that the finest grid has in all")
    share: tuple[float, float] = attribute("of the grids on that side, at least and at most", name="share_of_side")
    dimension: float = attribute("of the boundary by how often its cells double; NaN from few cells")
    study: Study = internal("that found it")
    lattice: Lattice = internal("the grids")
    found: Descent = internal("how far it was followed")

    def plot(
        self, axes: Axes | None = None, *, x: str = "", y: str = "", at: Mapping[str, float] | None = None
    ) -> Axes:
        """Both sides over two parameters, the boundary between; see ``pictures.boundaries.boundary``."""
        return drawing(self, "plot")(self, axes, x=x, y=y, at=at)

    @property
    def whole(self) -> bool:
        """Whether it was followed as far as was asked."""
        return self.halvings == self.asked

    def crossings(
        self, along: str, at: Mapping[str, float | str] | None = None, *, row: int = 0
    ) -> Array:  # fmt: skip
        """Where a line along one parameter crosses the boundary.

        Parameters
        ----------
        along : the parameter.
        at : where all others stand, SI units or texts with a unit, by path.
        row : of sampled parameters, which row.

        Returns
        -------
        array (crossings, 3): estimate, and the ends between which it is crossed; an estimate of NaN where the line
            passes cells with both sides but its ends there are on the same one, or on none that is known: crossed
            twice, or not at all.

        Raises
        ------
        InputError : an unknown parameter, or one that is left out; a value outside its grid.
        """
        return _crossings(self, along, at or {}, row)

    def is_on_side(self, at: Mapping[str, float | str], *, row: int = 0) -> bool | None:
        """Whether ``side`` is true at values of all parameters; None within a cell that the boundary passes, or where
        points failed.

        Raises
        ------
        InputError : an unknown parameter, or one that is left out; a value outside its grid.
        """
        place, share = _place(self, at, row, "")
        found = self.sides_of_cells(place[None] + np.floor(share)[None])[0]
        return None if found == UNKNOWN else bool(found == ABOVE)

    def sides_of_cells(self, cells: Any) -> Any:
        """Sides of cells (cells, axes) of the finest grid that was reached: of the smallest cells around them that were
        computed; ``UNKNOWN`` where these have both, or points that failed."""
        cells = np.asarray(cells, dtype=np.int64)
        refined = self.lattice.refined
        most = self.lattice.cells(self.halvings) - 1
        cells = np.minimum(cells, np.where(refined, most, cells))
        sides = np.full(len(cells), UNKNOWN, dtype=np.uint8)
        is_open = np.ones(len(cells), dtype=bool)
        for level in range(self.halvings, -1, -1):
            step = np.where(refined, 2 ** (self.halvings - level), 1)
            around = cells[is_open] // step
            corners = np.stack(
                [self._known.at(self.lattice.numbers(around + corner, level)) for corner in self.lattice.corners]
            )
            there = (corners <= UNKNOWN).all(axis=0)
            same = (corners == corners[0]).all(axis=0)
            places = np.flatnonzero(is_open)[there]
            sides[places] = np.where(same[there], corners[0, there], UNKNOWN)
            is_open[places] = False
        return sides

    def heights(self, numbers: Any) -> Any:
        """How far points are over the boundary, by their numbers in the finest grid; 1 and −1 where it is one of
        words."""
        assert self.study.refinement is not None
        return _heights(self.study, self.study.refinement)(numbers)

    @cached_property
    def _known(self) -> KnownSides:
        return _known_of(self.study)

    def _lines(self) -> Iterator[str]:
        yield f"boundary of {self.side} over {', '.join(self.parameter)}"
        if not len(self.point):
            yield "  is met nowhere between the points of the first grid"
        else:
            yield f"  known to {', '.join(self._errors())}, in {counted(len(self.found.crossed), 'cell')}"
        low, high = (figures(100 * one, 3) for one in self.share)
        yield (
            f"  {self.side} in {low} to {high} % of the grid"
            if low != high
            else f"  {self.side} in {low} % of the grid"
        )
        yield f"  {counted(self.points, 'point')}; the same everywhere takes {self.everywhere}"
        if not self.whole:
            yield f"  {self.halvings} of {self.asked} halvings so far"
        if self._erratic:
            yield f"  its cells are {figures(self.dimension, 3)}-dimensional: noise about the level, or a fractal"

    @property
    def _erratic(self) -> bool:
        return bool(self.dimension > self.lattice.refined.sum() - ERRATIC)

    def _errors(self) -> Iterator[str]:
        for path, unit, error in zip(self.parameter, self.unit_of, self.error, strict=True):
            words = self.study.words.parameter(path, unit)
            yield f"±{words.number(float(error), 3)} of {path}"


def study_boundary(study: Study) -> StudyBoundary:
    """The boundary that a study with a table ``[boundary]`` has found, as far as it has come.

    Parameters
    ----------
    study : of ``study`` or ``read_study``.

    Returns
    -------
    StudyBoundary: where the answer changes, with ``crossings`` along a parameter and their errors.

    Raises
    ------
    InputError : the study looked for none.
    ComputationError : its first grid is not computed yet.

    Examples
    --------
    >>> import trunnion as tn
    >>> from pathlib import Path
    >>> from tempfile import mkdtemp
    >>> asked = {"line": "two-shaft-cardan", "analysis": "natural_frequencies", "quantities": "frequency[0]"}
    >>> asked["store"] = str(Path(mkdtemp()) / "soft.zarr")
    >>> asked["boundary"] = {"quantity": "frequency[0]", "level": 0.6, "halvings": 3}
    >>> ends = {"low": 0.5, "high": 1.5, "points": 5}
    >>> asked["parameter"] = [{"path": f"Shaft {k}.stiffness", **ends} for k in (1, 2)]
    >>> boundary = tn.study_boundary(tn.study(asked, workers=0))
    >>> estimate, low, high = boundary.crossings("Shaft 1.stiffness", {"Shaft 2.stiffness": 1.0})[0]
    >>> bool(low <= estimate <= high), round(float(high - low), 4)
    (True, 0.0312)
    """
    refinement, first = study.refinement, study.first
    if refinement is None or first is None:
        raise InputError("looked for no boundary", key="study", value=study.store,
                         remedy='write [boundary] with quantity = "verdict" and value = "unstable"')  # fmt: skip
    lattice = Lattice(first, refinement.halvings)
    found = descent(lattice, _known_of(study))
    if found.level < 0:
        raise ComputationError(f"{study.store}: {len(found.missing)} points of the first grid are not computed yet")
    return _boundary(study, refinement, lattice, found)


def _known_of(study: Study) -> KnownSides:
    assert study.refinement is not None and study.design.chosen is not None
    quantity = next(one for one in study.quantities if one.path == study.refinement.quantity)
    sides = sides_of(study.refinement, quantity, study.status, study.values[quantity.path])
    return KnownSides(study.design.chosen, sides)


def _boundary(study: Study, refinement: Refinement, lattice: Lattice, found: Descent) -> StudyBoundary:
    axes = list(lattice.design(found.level).axes)
    offset = len(lattice.refined) - len(axes)
    mine = [k for k in range(len(axes)) if lattice.refined[k + offset]]
    known = _known_of(study)
    heights = _heights(study, refinement)
    points, lows, highs, along, rows = [], [], [], [], []
    for number, k in enumerate(mine):
        begin, end = _edges(lattice, known, found, k + offset)
        if not len(begin):
            continue
        share = _shares(heights(lattice.numbers(begin, found.level)), heights(lattice.numbers(end, found.level)))
        where = np.stack([_values(axes[j], begin[:, j + offset]) for j in mine], axis=1)
        ends = _values(axes[k], begin[:, k + offset]), _values(axes[k], end[:, k + offset])
        where[:, number] = np.clip(_between(axes[k], begin[:, k + offset] + share), *ends)
        points.append(where)
        lows.append(ends[0])
        highs.append(ends[1])
        along.append(np.full(len(begin), number))
        rows.append(_row(lattice, begin))
    counts = lattice.counts(found.level)
    return StudyBoundary(
        parameter=tuple(axes[k].path for k in mine), unit_of=tuple(axes[k].unit for k in mine),
        error=np.array([np.max(np.abs(np.diff(axes[k].values))) / 2 for k in mine]),
        point=np.concatenate(points) if points else np.zeros((0, len(mine))),
        low=np.concatenate([np.zeros(0), *lows]), high=np.concatenate([np.zeros(0), *highs]),
        along=np.concatenate([np.zeros(0, dtype=np.int64), *along]),
        row=np.concatenate([np.zeros(0, dtype=np.int64), *rows]), quantity=refinement.quantity,
        side=_side(study, refinement), halvings=found.level, asked=refinement.halvings,
        points=study.done + study.failed,
        everywhere=int(np.prod(counts, dtype=object)), share=_share(lattice, found), dimension=_dimension(found),
        study=study, lattice=lattice, found=found,
    )  # fmt: skip


def _side(study: Study, refinement: Refinement) -> str:
    quantity = next(one for one in study.quantities if one.path == refinement.quantity)
    if quantity.kind != "number":
        return f"{refinement.quantity} = {refinement.value}"
    return f"{refinement.quantity} > {study.quantity_axis(quantity).number(refinement.level, 4)}"


def _edges(lattice: Lattice, known: KnownSides, found: Descent, axis: int) -> tuple[Places, Places]:
    """Places of the two points of edges along an axis that are on different sides, each once."""
    step = np.zeros(len(lattice.refined), dtype=np.int64)
    step[axis] = 1
    begins = [found.crossed + corner for corner in lattice.corners if not corner[axis]]
    begin = np.unique(np.concatenate(begins), axis=0)
    sides = [known.at(lattice.numbers(place, found.level)) for place in (begin, begin + step)]
    apart = (np.minimum(*sides) == BELOW) & (np.maximum(*sides) == ABOVE)
    return begin[apart], begin[apart] + step


def _heights(study: Study, refinement: Refinement) -> Any:
    """How far points are over the boundary, by their numbers: 1 and −1 where it is one of words."""
    quantity = next(one for one in study.quantities if one.path == refinement.quantity)
    chosen = study.design.chosen
    assert chosen is not None
    if quantity.kind == "number":
        height = np.asarray(study.values[quantity.path]) - refinement.level - refinement.noise
    else:
        height = np.where(_known_of(study).sides == ABOVE, 1.0, -1.0)
    return lambda numbers: height[np.searchsorted(chosen, numbers)]


def _shares(begin: Array, end: Array) -> Array:
    """Where between two points a straight line passes 0."""
    with np.errstate(divide="ignore", invalid="ignore"):
        share = begin / (begin - end)
    return np.where(np.isfinite(share), np.clip(share, 0.0, 1.0), 0.5)


def _values(axis: StudyAxis, places: Places) -> Array:
    return np.asarray(axis.values[places])


def _between(axis: StudyAxis, places: Array) -> Array:
    """Values of a grid at places between its points."""
    assert axis.grid is not None
    low, high, points, log = axis.grid
    share = places / (points - 1)
    if log:
        return np.asarray(np.exp(np.log(low) + (np.log(high) - np.log(low)) * share))
    return np.asarray(low + (high - low) * share)


def _row(lattice: Lattice, places: Places) -> Integers:
    """One number for the sampled row and the stated values."""
    still = ~lattice.refined
    if not still.any():
        return np.zeros(len(places), dtype=np.int64)
    shape = tuple(lattice.counts(0)[still])
    return np.asarray(np.ravel_multi_index(tuple(places[:, still].T), shape), dtype=np.int64)


def _share(lattice: Lattice, found: Descent) -> tuple[float, float]:
    """Of all that the grids enclose, as they space it."""
    refined = int(lattice.refined.sum())
    whole = float(np.prod(lattice.cells(0).astype(float)))
    sizes = [2.0 ** (-refined * level) / whole for level in range(len(found.leaves))]
    low = sum(size * above for size, (_, above, _) in zip(sizes, found.leaves, strict=True))
    below = sum(size * (known - above) for size, (known, above, _) in zip(sizes, found.leaves, strict=True))
    return low, 1.0 - below


def _dimension(found: Descent) -> float:
    counts = found.counts
    if len(counts) < 2 or counts[-2] < ENOUGH:
        return float("nan")
    return float(np.log2(counts[-1] / counts[-2])) if counts[-1] else 0.0


def _place(boundary: StudyBoundary, at: Mapping[str, float | str], row: int, along: str) -> tuple[Any, Any]:
    """Places of the stated values and of the row, 0 along refined axes; and places between points along these."""
    lattice, axes = boundary.lattice, boundary.lattice.design(boundary.halvings).axes
    names = [axis.path for axis in axes]
    if along and along not in boundary.parameter:
        raise InputError("is not a parameter that the boundary was followed over", key="along", value=along,
                         remedy=nearest(along, boundary.parameter))  # fmt: skip
    for path in at:
        if path not in names or path == along:
            rest = [name for name in names if name != along]
            raise InputError("is not a parameter that stands still here", key="at", value=path,
                             remedy=nearest(path, rest) if rest else "leave it out")  # fmt: skip
    at = boundary.study.values_at(at)
    place, share = [], []
    if lattice.first.sampling:
        rows = lattice.first.sampling.rows
        if isinstance(row, bool) or not isinstance(row, int) or not 0 <= row < rows:
            raise InputError(
                f"must be a whole number from 0 to {rows - 1}", key="row", value=row, remedy="row = 0, say"
            )
        place.append(row)
        share.append(0.0)
    for axis, refined in zip(axes, lattice.refined[len(place) :], strict=True):
        if axis.path == along:
            place.append(0)
            share.append(0.0)
            continue
        if axis.path not in at and (refined or len(axis.values) > 1):
            middle = figures(float(np.median(axis.values)))
            raise InputError("is missing: where does it stand", key="at", value=axis.path,
                             remedy=f"give at={{{axis.path!r}: {middle}}}, say")  # fmt: skip
        value = at.get(axis.path, float(axis.values[0]))
        if not axis.values.min() <= value <= axis.values.max():
            ends = f"{figures(float(axis.values.min()))} to {figures(float(axis.values.max()))} {axis.unit}"
            raise InputError(f"lies outside its values, {ends}", key="at", value=f"{axis.path} = {value:.6g}",
                             remedy="take one between, or widen the study")  # fmt: skip
        if refined:
            place.append(0)
            share.append(_place_on(axis, value))
            continue
        nearby = int(np.argmin(np.abs(axis.values - value)))
        if axis.values[nearby] != value:
            known = ", ".join(figures(float(one)) for one in axis.values[:6])
            raise InputError("is not one of the values that were stated", key="at", value=f"{axis.path} = {value:.6g}",
                             remedy=f"take one of {known}")  # fmt: skip
        place.append(nearby)
        share.append(0.0)
    return np.array(place, dtype=np.int64), np.array(share)


def _place_on(axis: StudyAxis, value: float) -> float:
    """Between which points of a grid a value lies: a whole number where it is one of them."""
    place = int(np.clip(np.searchsorted(axis.values, value, side="right") - 1, 0, len(axis.values) - 1))
    if axis.values[place] == value or place == len(axis.values) - 1:
        return float(place)
    low, high = axis.values[place], axis.values[place + 1]
    return place + min(float((value - low) / (high - low)), np.nextafter(1.0, 0.0))


def _crossings(boundary: StudyBoundary, along: str, at: Mapping[str, float | str], row: int) -> Array:
    place, share = _place(boundary, at, row, along)
    lattice, found = boundary.lattice, boundary.found
    axes = lattice.design(found.level).axes
    offset = len(lattice.refined) - len(axes)
    axis = offset + [one.path for one in axes].index(along)
    base = place + np.floor(share).astype(np.int64)
    others = [k for k in range(len(base)) if k != axis and lattice.refined[k] and share[k] != np.floor(share[k])]
    near = np.ones(len(found.crossed), dtype=bool)
    for k in range(len(base)):
        if k == axis:
            continue
        low = base[k] - (1 if lattice.refined[k] and k not in others else 0)
        near &= (found.crossed[:, k] >= low) & (found.crossed[:, k] <= base[k])
    steps = np.unique(found.crossed[near, axis])
    if not len(steps):
        return np.zeros((0, 3))
    sides, heights = _faces(boundary, base, share, axis, others, np.unique(np.concatenate([steps, steps + 1])))
    rows = []
    for first, last in _runs(steps, sides):
        ends = _values(axes[axis - offset], np.array([first, last]))
        a, b = sides[first], sides[last]
        if len(a) == 1 and len(b) == 1 and a != b and UNKNOWN not in a | b:
            rows.append((*_estimate(axes[axis - offset], heights, first, last, ends), *ends))
        else:
            rows.append((float("nan"), *ends))
    return np.array(rows).reshape(-1, 3)


def _faces(
    boundary: StudyBoundary, base: Places, share: Any, axis: int, others: list[int], steps: Places
) -> tuple[dict[int, set[int]], dict[int, float]]:  # fmt: skip
    """Of places along the line, the sides of the points around it there, and how far over the boundary it is."""
    refinement = boundary.study.refinement
    assert refinement is not None
    level, lattice = boundary.found.level, boundary.lattice
    known, height = boundary._known, _heights(boundary.study, refinement)
    sides: dict[int, set[int]] = {int(step): set() for step in steps}
    heights = dict.fromkeys(sides, 0.0)
    for ends in product((0, 1), repeat=len(others)):
        places = np.broadcast_to(base, (len(steps), len(base))).copy()
        places[:, axis] = steps
        weight = 1.0
        for k, end in zip(others, ends, strict=True):
            places[:, k] += end
            part = share[k] - np.floor(share[k])
            weight *= part if end else 1 - part
        numbers = lattice.numbers(places, level)
        these = known.at(numbers)
        there = np.where(these <= UNKNOWN, height(numbers * (these <= UNKNOWN)), np.nan)
        for step, side, over in zip(steps.tolist(), these.tolist(), there.tolist(), strict=True):
            sides[step].add(int(side))
            heights[step] += weight * over
    return sides, heights


def _runs(steps: Places, sides: dict[int, set[int]]) -> Iterator[tuple[int, int]]:
    """First and last place of stretches of cells that have both sides."""
    first = last = -1
    for step in steps.tolist():
        both = sides[step] | sides[step + 1]
        if not {BELOW, ABOVE} <= both:
            continue
        if step != last:
            if last >= 0:
                yield first, last
            first = step
        last = step + 1
    if last >= 0:
        yield first, last


def _estimate(axis: StudyAxis, heights: dict[int, float], first: int, last: int, ends: Array) -> tuple[float]:
    """Where the height, straight between places, passes 0; the middle where it does not say."""
    for step in range(first, last):
        a, b = heights[step], heights[step + 1]
        if np.isfinite(a + b) and (a > 0) != (b > 0):
            share = float(_shares(np.array(a), np.array(b)))
            return (float(np.clip(_between(axis, np.array(step + share)), *ends)),)
    return (float(ends.mean()),)
