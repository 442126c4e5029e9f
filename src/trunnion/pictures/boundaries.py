"""The boundary of a study: both sides over two parameters with the boundary between, or along a single one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from trunnion.arrays import Array, Places
from trunnion.driveline.parameters import SPEED
from trunnion.driveline.refusals import nearest
from trunnion.errors import InputError
from trunnion.pictures.looks import curve
from trunnion.pictures.picture import Axis, Cells, Item, Level, Line, Picture, Points, single
from trunnion.pictures.shared import axis_of
from trunnion.results.words import Words
from trunnion.studies.boundary import StudyBoundary
from trunnion.studies.design import StudyAxis
from trunnion.studies.refinement import UNKNOWN

CELLS = 400
"""Cells along an axis, at most, in which sides are shown; the boundary itself is drawn as fine as it is known."""
ROWS = 40
"""Sampled rows whose boundaries are drawn."""
GROWING = ("growth_rate", "spectral_radius")
"""Quantities whose high side is the unstable one."""


def boundary(result: StudyBoundary, *, x: str = "", y: str = "", at: Mapping[str, float] | None = None) -> Picture:
    """Where an answer changes, over two parameters or along one.

    Parameters
    ----------
    x, y : two of the parameters; by default the speed, then the others in order.
    at : where all other grids stand, SI units by path, at the nearest point; by default where the line does.
    """
    axes = result.lattice.design(result.halvings).axes
    grids = [axis for axis in axes if axis.path in result.parameter]
    chosen = _chosen(grids, x, y)
    place, said = _still(result, axes, [axis.path for axis in chosen], at or {})
    title = ", ".join([_title(result), *said])
    if len(chosen) == 1:
        return _along(result, chosen[0], place, title)
    return _over(result, chosen[0], chosen[1], place, title)


def _chosen(grids: list[StudyAxis], x: str, y: str) -> list[StudyAxis]:
    by_name = {one.path: one for one in grids}
    for key, path in (("x", x), ("y", y)):
        if path and path not in by_name:
            raise InputError("is not a parameter that the boundary was followed over", key=key, value=path,
                             remedy=nearest(path, by_name))  # fmt: skip
    if x and x == y:
        raise InputError("stands on both axes", key="y", value=y, remedy="give another parameter")
    rest = sorted((one for one in grids if one.path not in (x, y)), key=lambda one: one.path != SPEED)
    found = [by_name[path] if path else rest.pop(0) if rest else None for path in (x, y)]
    return [one for one in found if one is not None]


def _title(result: StudyBoundary) -> str:
    done = "" if result.whole else f", {result.halvings} of {result.asked} halvings"
    return f"{result.side}: {result.points} points in place of {result.everywhere}{done}"


def _still(
    result: StudyBoundary, axes: tuple[StudyAxis, ...], moving: list[str], at: Mapping[str, float]
) -> tuple[Places, list[str]]:  # fmt: skip
    """Places of what stands still, 0 for the rest, in the order of the lattice; and where that is, in words."""
    sampled = result.lattice.first.sampling is not None
    known = [axis.path for axis in axes if axis.path not in moving]
    for path in at:
        if path not in known:
            raise InputError("is not a parameter that stands still here", key="at", value=path,
                             remedy=nearest(path, known) if known else "leave it out")  # fmt: skip
    place, said = [0] if sampled else [], []
    for axis in axes:
        if axis.path in moving:
            place.append(0)
            continue
        wanted = float(at.get(axis.path, axis.nominal))
        wanted = wanted if np.isfinite(wanted) else float(np.median(axis.values))
        place.append(int(np.argmin(np.abs(axis.values - wanted))))
        said.append(_words(result, axis).value(float(axis.values[place[-1]])))
    return np.array(place, dtype=np.int64), said


def _words(result: StudyBoundary, axis: StudyAxis) -> Any:
    return Words(result.study.unit).parameter(axis.path, axis.unit)


def _axis(result: StudyBoundary, axis: StudyAxis) -> Axis:
    low, high = float(axis.values[0]), float(axis.values[-1])
    words = _words(result, axis)
    found = axis_of(words, low, high)
    if axis.grid is not None and axis.grid[3]:
        return found.logarithmic(low * words.factor, high * words.factor)
    return found


def _number(result: StudyBoundary, path: str) -> int:
    """Where a parameter stands in the lattice."""
    axes = result.lattice.first.axes
    return len(result.lattice.refined) - len(axes) + [axis.path for axis in axes].index(path)


def _over(result: StudyBoundary, x: StudyAxis, y: StudyAxis, place: Places, title: str) -> Picture:
    items: list[Item] = [] if result.lattice.first.sampling else _sides(result, x, y, place)
    factors = [_words(result, axis).factor for axis in (x, y)]
    parts = [_segments(result, x, y, np.append([row], place[1:]) if rows > 1 else place)
             for rows in [_rows(result)] for row in range(min(rows, ROWS))]  # fmt: skip
    found = np.concatenate(parts)
    if len(found):
        across, up = (np.append(found[:, :, k] * factors[k], np.full((len(found), 1), np.nan), axis=1) for k in (0, 1))
        items.append(Line(across.ravel(), up.ravel(), "tongue edge", "boundary"))
    more = f", {min(_rows(result), ROWS)} of {_rows(result)} sampled rows" if _rows(result) > 1 else ""
    return single(_axis(result, x), _axis(result, y), items, 7.0, 4.8, title + more, grid="")


def _rows(result: StudyBoundary) -> int:
    sampling = result.lattice.first.sampling
    return sampling.rows if sampling else 1


def _sides(result: StudyBoundary, x: StudyAxis, y: StudyAxis, place: Places) -> list[Item]:
    """Cells on both sides, as fine as they can be told apart on a screen, and those where points failed."""
    shown, centres, numbers = [], [], []
    for axis in (x, y):
        cells = len(axis.values) - 1
        step = max(1, 2 ** int(np.ceil(np.log2(cells / CELLS)))) if cells > CELLS else 1
        first = np.arange(0, cells, step)
        last = np.minimum(first + step, cells)
        shown.append((axis.values[first] + axis.values[last]) / 2 * _words(result, axis).factor)
        centres.append((first + last) // 2)
        numbers.append(_number(result, axis.path))
    across, up = np.meshgrid(*centres)
    cells_at = np.broadcast_to(place, (across.size, len(place))).copy()
    cells_at[:, numbers[0]], cells_at[:, numbers[1]] = across.ravel(), up.ravel()
    side = result.sides_of_cells(cells_at).reshape(across.shape)
    looks = _looks(result)
    found: list[Item] = [
        Cells(shown[0], shown[1], side == which, role, name) for which, (role, name) in enumerate(looks)
    ]
    if (side == UNKNOWN).any():
        found.append(Cells(shown[0], shown[1], side == UNKNOWN, "printed undecided", "both sides, or failed"))
    return found


def _looks(result: StudyBoundary) -> list[tuple[str, str]]:
    """Role and name of the sides, the one that is not asked for first."""
    refinement = result.study.refinement
    assert refinement is not None
    words = bool(refinement.value)
    other = f"another {result.quantity}" if words else result.side.replace(" > ", " ≤ ")
    if refinement.value == "unstable" or (not words and result.quantity in GROWING):
        return [("stable", other), ("unstable", result.side)]
    return [("basin 0", other), ("basin 1", result.side)]


def _segments(result: StudyBoundary, x: StudyAxis, y: StudyAxis, place: Places) -> Array:
    """Pieces (pieces, ends, parameters) of the boundary in the plane of two parameters."""
    across, up = _number(result, x.path), _number(result, y.path)
    found, lattice = result.found, result.lattice
    near = np.ones(len(found.crossed), dtype=bool)
    for k in range(len(place)):
        if k not in (across, up):
            least = place[k] - (1 if lattice.refined[k] else 0)
            near &= (found.crossed[:, k] >= least) & (found.crossed[:, k] <= place[k])
    cells = np.unique(found.crossed[near][:, [across, up]], axis=0)
    pieces: list[Any] = []
    if not len(cells):
        return np.zeros((0, 2, 2))
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    at = cells[:, None, :] + corners
    whole = np.broadcast_to(place, (*at.shape[:2], len(place))).copy()
    whole[:, :, across], whole[:, :, up] = at[:, :, 0], at[:, :, 1]
    height = result.heights(lattice.numbers(whole, found.level))
    for cell, heights in zip(at, height, strict=True):
        ends = []
        for k in range(4):
            a, b = heights[k], heights[(k + 1) % 4]
            if np.isfinite(a + b) and (a > 0) != (b > 0):
                ends.append(cell[k] + a / (a - b) * (cell[(k + 1) % 4] - cell[k]))
        pieces += [ends[k : k + 2] for k in range(0, len(ends) - 1, 2)]
    points = np.array(pieces).reshape(-1, 2, 2)
    for k, axis in enumerate((x, y)):
        points[:, :, k] = np.interp(points[:, :, k], np.arange(len(axis.values)), axis.values)
    return points


def _along(result: StudyBoundary, x: StudyAxis, place: Places, title: str) -> Picture:
    """The quantity at its points, and where it crosses."""
    study, words = result.study, _words(result, x)
    quantity = next(one for one in study.quantities if one.path == result.quantity)
    axis = study.quantity_axis(quantity)
    here = np.ones(study.points, dtype=bool)
    lattice = result.lattice
    chosen = study.design.chosen
    assert chosen is not None
    number = _number(result, x.path)
    places = lattice.places(chosen, lattice.depth)
    for k in range(len(place)):
        if k != number:
            here &= places[:, k] == place[k]
    at = study.parameter(x.path)[here] * words.factor
    items: list[Item] = []
    for value in sorted(set(result.point[:, 0])):
        items.append(Level(float(value) * words.factor, "stability ends", on="x"))
    if quantity.kind == "number":
        assert study.refinement is not None
        items.append(Level(study.refinement.level * axis.factor, "zero"))
        items.append(Line(at, np.asarray(study.values[quantity.path])[here] * axis.factor, curve(0)))
        items.append(Points(at, np.asarray(study.values[quantity.path])[here] * axis.factor, "map points"))
        return single(_axis(result, x), Axis(axis.quantity, axis.unit), items, title=title)
    texts = quantity.shown(study.values[quantity.path])[here]
    names = tuple(dict.fromkeys(texts.tolist()))
    items.append(Points(at, [names.index(text) for text in texts.tolist()], "point"))
    shown = tuple(name or "none" for name in names)
    up = Axis(axis.quantity, "", -0.6, len(shown) - 0.4, ticks=tuple(range(len(shown))), names=shown)
    return single(_axis(result, x), up, items, title=title)
