"""Pictures of a study: a chart over two parameters, slices along one, a histogram, parallel coordinates, shares."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from textwrap import fill
from typing import Any

import numpy as np

from trunnion.arrays import Array, Flags
from trunnion.driveline.parameters import SPEED
from trunnion.driveline.refusals import nearest
from trunnion.errors import ComputationError, InputError
from trunnion.pictures.boundaries import boundary
from trunnion.pictures.design import CROWDED
from trunnion.pictures.looks import LOOKS, curve
from trunnion.pictures.picture import (
    MARGIN,
    Axis,
    Band,
    Bars,
    Cells,
    ColouredGrid,
    Colours,
    Item,
    Key,
    Level,
    Line,
    Picture,
    Points,
    Texts,
    rows,
    single,
)
from trunnion.pictures.shared import axis_of, histogram, printed
from trunnion.results.counts import counted
from trunnion.results.quantity_axes import QuantityAxis
from trunnion.results.units import figures
from trunnion.results.verdict import Verdict
from trunnion.results.words import Words
from trunnion.studies.boundary import study_boundary
from trunnion.studies.design import StudyAxis
from trunnion.studies.points import DONE, FAILED, MISSING
from trunnion.studies.result import Study
from trunnion.studies.sensitivities import SobolIndices

KINDS = ("chart", "slices", "histogram", "parallel", "boundary")
"""Of the picture of a study."""
CURVES = 6
"""Slices beside one another."""
CLASSES = 5
"""Of values, lines of one colour in parallel coordinates; and of words that have colours of their own."""
LINES = 400
"""Points that parallel coordinates show."""
WITHIN = (0.05, 0.95)
"""Quantiles of the band of sampled points about their median."""


@dataclass(frozen=True)
class ShownQuantity:
    """What is shown: its axis, values in the unit of it (in the shape of the design, NaN where not known), and for
    words what its numbers mean."""

    axis: QuantityAxis
    values: Array
    words: tuple[str, ...] = ()


def study(
    result: Study, *, kind: str = "", quantity: str = "", x: str = "", y: str = "",
    at: Mapping[str, float] | None = None,
) -> Picture:  # fmt: skip
    """A quantity of a study, in the way that its points ask for.

    Parameters
    ----------
    kind : "chart" over two parameters, "slices" along one, "histogram", or "parallel" coordinates; by default a chart
        or slices of what was put on a grid, and a histogram of what was sampled. Of a study that looked for one, the
        "boundary".
    quantity : by default the first.
    x, y : parameters of chart and slices; by default the speed, then the others in order.
    at : where the other parameters stand, SI units by path; by default what the line states, at the nearest point.
    """
    chosen = kind or _usual(result)
    if chosen not in KINDS:
        raise InputError("is not a picture of a study", key="kind", value=kind, remedy=nearest(kind, KINDS))
    if chosen == "boundary":
        return _boundary(result, quantity, x, y, at)
    if result.refinement is not None:
        raise InputError("would show where points are many, not the study: they stand about a boundary", key="kind",
                         value=chosen, remedy='take "boundary"')  # fmt: skip
    shown = _shown(result, quantity)
    if chosen == "chart":
        return _chart(result, shown, x, y, at or {})
    if chosen == "slices":
        return _slices(result, shown, x, y, at or {})
    for key, value in (("x", x), ("y", y), ("at", at)):
        if value:
            raise InputError(f"belongs to chart and slices, not to {chosen}", key=key, value=value,
                             remedy='leave it out, or give kind = "slices"')  # fmt: skip
    return _histogram(result, shown) if chosen == "histogram" else _parallel(result, shown)


def _boundary(result: Study, quantity: str, x: str, y: str, at: Mapping[str, float] | None) -> Picture:
    found = study_boundary(result)
    if quantity and quantity != found.quantity:
        raise InputError("is not what changes at the boundary", key="quantity", value=quantity,
                         remedy=f'take "{found.quantity}"')  # fmt: skip
    return boundary(found, x=x, y=y, at=at)


def shares(result: SobolIndices) -> Picture:
    """What every parameter explains alone, and with all others where that is known, with intervals."""
    whole = bool(np.isfinite(result.total).any())
    order = np.argsort(-(result.total if whole else result.first), kind="stable")
    names = [result.parameter[k] for k in order]
    places = np.arange(len(names))
    items: list[Item] = []
    for j, (values, ends, words) in enumerate((
        (result.first, result.first_interval, "explained alone"),
        (result.total, result.total_interval, "left when all others are known"),
    )[: 2 if whole else 1]):  # fmt: skip
        at = places + (0.2 * (2 * j - 1) if whole else 0.0)
        items.append(Bars(at, 100 * values[order], 0.36 if whole else 0.7, f"bar {j}", words, lie=True))
        for place, (low, high) in zip(at, 100 * ends[order], strict=True):
            if np.isfinite(low + high):
                items.append(Line([low, high], [place, place], "reaches"))
    if whole:
        items.append(Key("reaches", f"{100 * result.confidence:g} % interval"))
    title = f"what {Words().parameter(result.quantity, '1').quantity} follows"
    across = Axis("share of the variance", "%")
    return single(across, rows(names), items, 7.2, 1.6 + 0.5 * len(names), title, key="below" if whole else "")


# -- what is shown ----------------------------------------------------------------------------------------------------


def _usual(result: Study) -> str:
    if result.refinement is not None:
        return "boundary"
    grids = len(_grids(result))
    return "chart" if grids > 1 else "slices" if grids else "histogram"


def _grids(result: Study) -> list[StudyAxis]:
    return [axis for axis in result.design.axes if len(axis.values) > 1]


def _shown(result: Study, path: str) -> ShownQuantity:
    known = [one.path for one in result.quantities]
    if path and path not in known:
        raise InputError("is not a quantity of the study", key="quantity", value=path, remedy=nearest(path, known))
    one = result.quantities[known.index(path) if path else 0]
    axis = result.quantity_axis(one)
    done = np.asarray(result.status == DONE)
    if not done.any():
        raise ComputationError(f"{result.store}: no point is computed yet")
    kept = result.quantity(one.path)
    if one.kind == "number":
        values = np.where(done & np.isfinite(kept), kept, np.nan) * axis.factor
        return ShownQuantity(axis, values.reshape(result.design.shape))
    texts = one.shown(result.values[one.path])
    there = list(dict.fromkeys(np.unique(texts[done]).tolist()))
    words = tuple([word for word in one.meanings if word in there] or there)
    place = {word: float(k) for k, word in enumerate(words)}
    values = np.array([place[text] if fine else np.nan for text, fine in zip(texts.tolist(), done, strict=True)])
    return ShownQuantity(axis, values.reshape(result.design.shape), words)


def _axes(result: Study, x: str, y: str, most: int) -> list[StudyAxis]:
    """The parameters of a chart or of slices: those asked for, then the speed, then the others in order."""
    grids = _grids(result)
    by_name = {one.path: one for one in grids}
    for key, path in (("x", x), ("y", y)):
        if path and path not in by_name:
            remedy = nearest(path, by_name) if by_name else 'kind = "histogram"'
            raise InputError("is not a parameter with a grid of this study", key=key, value=path, remedy=remedy)
    if x and x == y:
        raise InputError("stands on both axes", key="y", value=y, remedy="give another parameter")
    rest = sorted((one for one in grids if one.path not in (x, y)), key=lambda one: one.path != SPEED)
    found = [by_name[path] if path else rest.pop(0) if rest else None for path in (x, y)]
    return [one for one in found if one is not None][:most]


def _section(
    result: Study, values: Any, axes: list[StudyAxis], at: Mapping[str, float]
) -> tuple[Any, list[str]]:  # fmt: skip
    """Values over ``axes`` in their order, sampled rows last, and where all other parameters stand, in words."""
    names = [one.path for one in axes]
    for path in at:
        if path in names or path not in [one.path for one in result.design.axes]:
            known = [one.path for one in result.design.axes if one.path not in names]
            raise InputError("is not a parameter that stands still here", key="at", value=path,
                             remedy=nearest(path, known) if known else "leave it out")  # fmt: skip
    sampled = 1 if result.design.sampling else 0
    pick: list[Any] = [slice(None)] * sampled
    said = []
    for axis in result.design.axes:
        if axis.path in names:
            pick.append(slice(None))
            continue
        wanted = float(at.get(axis.path, axis.nominal))
        place = int(np.argmin(np.abs(axis.values - (wanted if np.isfinite(wanted) else np.median(axis.values)))))
        pick.append(place)
        said.append(_words_of(result, axis).value(float(axis.values[place])))
    picked = values[tuple(pick)]
    kept = [axis.path for axis in result.design.axes if axis.path in names]
    order = [sampled + kept.index(name) for name in names] + [0] * sampled
    return np.transpose(picked, order), said


def _words_of(result: Study, axis: StudyAxis) -> QuantityAxis:
    return Words(result.unit).parameter(axis.path, axis.unit)


def _along(result: Study, axis: StudyAxis) -> tuple[Array, Any, Axis]:
    """Values in the unit of an axis, rising; the places that they have among those of the design; the axis."""
    words, order = _words_of(result, axis), np.argsort(axis.values, kind="stable")
    values = axis.values[order] * words.factor
    shown = axis_of(words, float(axis.values.min()), float(axis.values.max()))
    if axis.grid is not None and axis.grid[3]:
        shown = shown.logarithmic(float(values[0]), float(values[-1]))
    return values, order, shown


def _reduced(shown: ShownQuantity, values: Array, sampled: bool) -> tuple[Array, ShownQuantity]:
    """One value for all sampled rows, which stand last: the median, or the share of the word that is feared."""
    if not sampled:
        return values, shown
    with np.errstate(invalid="ignore"):
        if not shown.words:
            return _quantiles(values, [0.5])[0], shown
        word = _feared(shown)
        share = 100 * (values == shown.words.index(word)).sum(axis=-1) / np.isfinite(values).sum(axis=-1)
    return np.asarray(share), ShownQuantity(QuantityAxis(f"share {word}", "%", 1.0), share)


def _feared(shown: ShownQuantity) -> str:
    for word in (str(Verdict.UNSTABLE), "yes"):
        if word in shown.words:
            return word
    return shown.words[-1]


def _quantiles(values: Array, shares: list[float]) -> Array:
    """Along the last axis; NaN where nothing is known."""
    known = np.isfinite(values).any(axis=-1)
    found = np.full((len(shares), *values.shape[:-1]), np.nan)
    if known.any():
        found[:, known] = np.nanquantile(values[known], shares, axis=-1)
    return found


# -- chart ------------------------------------------------------------------------------------------------------------


def _chart(result: Study, shown: ShownQuantity, x: str, y: str, at: Mapping[str, float]) -> Picture:
    axes = _axes(result, x, y, 2)
    if len(axes) < 2:
        raise InputError("needs two parameters with grids", key="kind", value="chart",
                         remedy='take "slices" or "histogram"')  # fmt: skip
    (across, place_x, right), (up, place_y, top) = (_along(result, axis) for axis in axes)
    values, said = _section(result, shown.values, axes, at)
    status = _section(result, result.status.reshape(result.design.shape), axes, at)[0]
    sampled = result.design.sampling is not None
    values, shown = _reduced(shown, values, sampled)
    values = np.asarray(values)[np.ix_(place_x, place_y)].T
    gone, failed = ((status == what).all(axis=-1) if sampled else status == what for what in (MISSING, FAILED))
    items: list[Item] = _words_as_cells(shown, across, up, values) if shown.words else _as_colours(
        shown, across, up, values
    )  # fmt: skip
    for where, role, words in ((failed, "failed", "failed"), (gone, "not covered", "not computed yet")):
        there = where[np.ix_(place_x, place_y)].T
        if there.any():
            items.append(Cells(across, up, there, role, words))
    return single(right, top, items, 7.0, 4.8, _title(result, shown, said), grid="")


def _as_colours(shown: ShownQuantity, x: Array, y: Array, values: Array) -> list[Item]:
    known = values[np.isfinite(values)]
    if not len(known):
        return []
    low, high = float(known.min()), float(known.max())
    palette = "amplitude"
    if low < 0 < high:  # white at 0, and as far to either side
        palette, low, high = "signed", -max(-low, high), max(-low, high)
    if not high > low:
        high = low + (abs(low) or 1.0) * 0.01
    return [ColouredGrid(x, y, values, Colours(shown.axis.label, palette, low, high))]


def _words_as_cells(shown: ShownQuantity, x: Array, y: Array, values: Array) -> list[Item]:
    return [Cells(x, y, values == k, role, word) for k, (word, role) in enumerate(_roles(shown.words))]


def _roles(words: tuple[str, ...]) -> list[tuple[str, str]]:
    """Words with their roles; what has none of its own takes one of few, the last for all others."""
    own = {str(verdict) for verdict in Verdict}
    return [
        (word or "none", word if word in own and word in LOOKS else f"basin {min(k, CLASSES - 1)}")
        for k, word in enumerate(words)
    ]


def _title(result: Study, shown: ShownQuantity, said: list[str]) -> str:
    sampled = result.design.sampling
    how = "" if sampled is None or shown.axis.quantity.startswith("share ") else "median of "
    of = f", {counted(sampled.rows, 'sampled row')}" if sampled else ""
    return f"{how}{shown.axis.quantity}{_where(said)}{of}"


def _where(said: list[str]) -> str:
    return f" at {', '.join(said)}" if said else ""


# -- slices -----------------------------------------------------------------------------------------------------------


def _slices(result: Study, shown: ShownQuantity, x: str, y: str, at: Mapping[str, float]) -> Picture:
    axes = _axes(result, x, y, 2)
    if not axes:
        raise InputError("need a parameter with a grid", key="kind", value="slices", remedy='take "histogram"')
    if result.design.sampling and not y:
        axes = axes[:1]  # the band of sampled rows is of one curve
    across, order, right = _along(result, axes[0])
    values, said = _section(result, shown.values, axes, at)
    items: list[Item] = []
    if len(axes) == 1 and result.design.sampling and not shown.words:
        low, middle, high = _quantiles(values, [WITHIN[0], 0.5, WITHIN[1]])[:, order]
        rows_of = f"{100 * WITHIN[0]:g} to {100 * WITHIN[1]:g} % of {result.design.sampling.rows} sampled rows"
        items += [Band(across, low, high, "interval 0", rows_of), Line(across, middle, curve(0), "median")]
        title = f"{shown.axis.quantity}{_where(said)}"
    else:
        values, shown = _reduced(shown, values, result.design.sampling is not None)
        title = _title(result, shown, said)
        items += _curves(result, shown, np.asarray(values)[order], axes, across)
    of = _words_of(result, axes[1]).quantity if len(axes) > 1 else ""
    return single(right, _up(shown, items), items, title=title, key_title=of)


def _curves(result: Study, shown: ShownQuantity, values: Array, axes: list[StudyAxis], across: Array) -> list[Item]:
    """A curve of every value of the second parameter, or of some of them, evenly chosen."""
    if len(axes) == 1:
        if shown.words:
            return [Points(across, values, "point")]
        return [Line(across, values, curve(0)), *_lone(across, values, curve(0))]
    words, order = _words_of(result, axes[1]), np.argsort(axes[1].values, kind="stable")
    chosen = order[np.unique(np.linspace(0, len(order) - 1, min(CURVES, len(order))).round().astype(int))]
    items: list[Item] = []
    for k, place in enumerate(chosen.tolist()):
        name = words.number(float(axes[1].values[place]), 4)
        if shown.words:
            shift = 0.5 * (k / max(len(chosen) - 1, 1) - 0.5)
            items.append(Points(across, values[:, place] + shift, f"dot {k}", name))
        else:
            items.append(Line(across, values[:, place], curve(k), name))
    return items


def _lone(across: Array, values: Array, role: str) -> list[Item]:
    """Points between gaps, of which a line shows nothing."""
    known = np.concatenate([[False], np.isfinite(values), [False]])
    alone = known[1:-1] & ~known[:-2] & ~known[2:]
    return [Points(across[alone], values[alone], "point")] if alone.any() else []


def _up(shown: ShownQuantity, items: list[Item]) -> Axis:
    if shown.words:
        names = tuple(word or "none" for word in shown.words)
        return Axis(shown.axis.quantity, "", -0.6, len(names) - 0.4, ticks=tuple(range(len(names))), names=names)
    known = shown.values[np.isfinite(shown.values)]
    if len(known) and known.min() < 0 < known.max():
        items.append(Level(0.0, "zero"))
    return Axis(shown.axis.quantity, shown.axis.unit)


# -- histogram --------------------------------------------------------------------------------------------------------


def _histogram(result: Study, shown: ShownQuantity) -> Picture:
    known = shown.values[np.isfinite(shown.values)]
    if not len(known):
        raise ComputationError(f"{shown.axis.quantity} is not finite at any point: take another quantity")
    left = result.points - len(known)
    said = [counted(len(known), "point")]
    said += [f"{left} missing, failed or not finite"] if left else []
    if shown.words:
        counts = np.array([(known == k).sum() for k in range(len(shown.words))])
        most = np.argsort(-counts, kind="stable")[:12]
        names = [shown.words[k] or "none" for k in most]
        texts = [f"{100 * counts[k] / len(known):.3g} %" for k in most]
        size = counts[most]
        items: list[Item] = [
            Bars(range(len(names)), size, 0.7, "bar", lie=True),
            Texts(size, range(len(names)), texts, beside="right"),
        ]
        across = Axis("points", "", 0.0, 1.15 * float(size.max()))
        return single(across, rows(names), items, 7.2, 1.7 + 0.4 * len(names), shown.axis.quantity,
                      remark="", key="", grid="")  # fmt: skip
    counts, ends = histogram(known, 8)
    up = Axis("points", "", 0.0, (1 + MARGIN) * float(counts.max()))
    if counts.max() > CROWDED * len(known):
        up = Axis("points, logarithmic").logarithmic(0.5, 3.0 * float(counts.max()))
    bars: list[Item] = [Bars((ends[1:] + ends[:-1]) / 2, counts, float(ends[1] - ends[0]), "counted")]
    low, high = float(known.min()), float(known.max())
    if low < 0 < high:
        bars.append(Level(0.0, "stability ends", "0", on="x"))
        said.append(f"{100 * float((known > 0).mean()):.3g} % above 0")
    across = Axis(shown.axis.quantity, shown.axis.unit)
    return single(across, up, bars, title=", ".join(said), key="", grid="")


# -- parallel coordinates ---------------------------------------------------------------------------------------------


def _parallel(result: Study, shown: ShownQuantity) -> Picture:
    """A line through every point's parameters and its quantity, each between its ends; colour by the quantity."""
    values = shown.values.ravel()
    known = np.flatnonzero(np.isfinite(values))
    if not len(known):
        raise ComputationError(f"{shown.axis.quantity} is not known at any point: take another quantity")
    by_size = known[np.argsort(values[known], kind="stable")]
    some = by_size[np.unique(np.linspace(0, len(by_size) - 1, min(LINES, len(by_size))).round().astype(int))]
    columns = [(Words(result.unit).parameter(path, unit), result.parameter(path)) for path, unit in
               zip(result.design.paths, result.design.units, strict=True)]  # fmt: skip
    shares, ends, names = [], [], []
    for words, column in columns:
        low, high = float(column.min()), float(column.max())
        shares.append(_share(column[some], low, high))
        ends.append((printed(words.number(low, 4)), printed(words.number(high, 4))))
        names.append(words.quantity)
    least, most = float(values[known].min()), float(values[known].max())
    shares.append(_share(values[some], least, most))
    unit = f" {shown.axis.unit}" if shown.axis.unit else ""
    ends.append(("", "") if shown.words else (f"{_signed(least)}{unit}", f"{_signed(most)}{unit}"))
    names.append(shown.axis.quantity)
    at = np.arange(len(names), dtype=float)
    items: list[Item] = []
    for role, name, mine in _classes(shown, values[some], unit):
        height = np.stack([share[mine] for share in shares], axis=1)
        parted = np.concatenate([height, np.full((len(height), 1), np.nan)], axis=1).ravel()
        items.append(Line(np.tile(np.append(at, np.nan), len(height)), parted, role, name))
    items += [Line([place, place], [0.0, 1.0], "base") for place in at.tolist()]
    for end, side, where in ((0, "below", 0.0), (1, "above", 1.0)):
        items.append(Texts(at, np.full(len(at), where), [pair[end] for pair in ends], "boxed words", side))
    if shown.words:
        heights = np.linspace(0, 1, len(shown.words)) if len(shown.words) > 1 else [0.5]
        items.append(Texts(np.full(len(shown.words), at[-1]), heights,
                           [word or "none" for word in shown.words], "boxed words", "right"))  # fmt: skip
    across = Axis(low=-0.35, high=len(names) - 0.45, names=[_broken(name) for name in names])
    title = counted(len(known), "point") + (f", {len(some)} of them drawn" if len(some) < len(known) else "")
    return single(across, Axis(low=-0.12, high=1.12, ticks=(0.0, 1.0), names=("", "")), items,
                  max(5.5, 1.6 * len(names)), 4.8, title, grid="")  # fmt: skip


def _classes(shown: ShownQuantity, values: Array, unit: str) -> list[tuple[str, str, Flags]]:
    """Role, name and members of classes of points, by word, or by value in classes of as many points each."""
    if shown.words:
        step = (CLASSES - 1) / max(len(shown.words) - 1, 1)
        return [(f"class {round(k * step)}", word or "none", values == k) for k, word in enumerate(shown.words)]
    edges = np.unique(np.quantile(values, np.linspace(0, 1, CLASSES + 1)))
    if len(edges) < 2:
        return [("class 0", f"{figures(float(edges[0]))}{unit}", np.ones(len(values), dtype=bool))]
    member = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, len(edges) - 2)
    step = (CLASSES - 1) / max(len(edges) - 2, 1)
    return [
        (f"class {round(k * step)}", f"{_signed(low)} to {_signed(high)}{unit}", member == k)
        for k, (low, high) in enumerate(zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True))
    ]


def _share(values: Array, low: float, high: float) -> Array:
    return (values - low) / (high - low) if high > low else np.full(len(values), 0.5)


def _broken(name: str) -> str:
    return fill(name, 19, break_long_words=False)


def _signed(value: float) -> str:
    return printed(figures(float(value)))
